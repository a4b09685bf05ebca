//! The subject of the tests' pages: a small photograph, its library and a scene.

use std::io::Cursor;
use std::sync::OnceLock;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::report::{self, Named, Photo, Subject};
use vtex::scene::{Scene, SynthParams};
use vtex::segment::Regions;

/// A name that breaks the page unless it is escaped everywhere.
pub(crate) const NAME: &str = "</script><script>alert(1)</script> \"it's\" & <!-- ]]> {{data}}.png";

/// Everything that a page can show.
pub(crate) struct Made {
    pub(crate) photo: Vec<u8>,
    pub(crate) libraries: Vec<Named<Library>>,
    pub(crate) scene: Named<Scene>,
}

/// Analysis and synthesis of the middle of a generated exemplar, done once.
pub(crate) fn made() -> &'static Made {
    static MADE: OnceLock<Made> = OnceLock::new();
    MADE.get_or_init(|| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars/pebbles.png");
        let whole = image::open(path).unwrap();
        let crop = whole.crop_imm(170, 170, 160, 160).into_rgb8();
        let mut bytes = Cursor::new(Vec::new());
        crop.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let photo = bytes.into_inner();
        let exemplar = Exemplar::from_bytes(&photo, NAME, &Limits::default()).unwrap();
        let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &()).unwrap();
        let params = SynthParams { width: 240, height: 200, seed: 7, ..SynthParams::default() };
        let scene = vtex::synth::synthesize(&library, &params, &()).unwrap();
        Made {
            photo,
            libraries: vec![Named { name: "photo.lib.json".into(), content: library }],
            scene: Named { name: "out.scene.json".into(), content: scene },
        }
    })
}

impl Made {
    /// The photograph, as found beside the library.
    pub(crate) fn photos(&self) -> Vec<Photo> {
        vec![Photo::new(NAME, self.photo.clone(), false)]
    }
}

/// The page and its warnings.
pub(crate) fn page(
    libraries: &[Named<Library>],
    scene: Option<&Named<Scene>>,
    photos: &[Photo],
) -> (String, Vec<String>) {
    let mut bytes = Vec::new();
    let warnings =
        report::write(&Subject { libraries, scene, photos, ask: "Ask the owner." }, &mut bytes).unwrap();
    (String::from_utf8(bytes).unwrap(), warnings)
}
