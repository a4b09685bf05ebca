//! Photograph → library, with the segmenter that finds its masks.

use super::common::Common;
use super::config::Parameters;
use super::failure::Failure;
use super::format;
use super::hints;
use super::input::{self, Input, note_read};
use super::layer_maps;
use super::models::{ModelFolder, sums_of_network};
use super::options::engine::{EngineArgs, engine};
use super::options::files::{ForceArgs, check_distinct, outputs};
use super::options::layers::{LayerFiles, LayerFilesArgs};
use super::options::masks::{MasksArgs, MasksFrom, SamFrom, masks_from};
use super::output::{Destination, Target, say};
use super::progress::{ElementFinder, Reporter};
use super::reading;
use super::values::Name;
use image::RgbImage;
use std::path::PathBuf;
use vtex::Progress;
use vtex::analyze::{AnalysisMemory, Exemplar, Limits, analyze_again, borders_join};
use vtex::engine::{EngineChoice, EngineOptions, NetworkSource, choose};
use vtex::import::{ImportParams, import, shows_lines};
use vtex::library::{AnalyzeParams, Library, PictureKind};
use vtex::output::file::{FileKind, Format};
use vtex::scene::{Scene, splat};
use vtex::segment::prompt::{Generator, GeneratorParams, Sam};
use vtex::segment::texton::Texton;
use vtex::segment::{
    Felzenszwalb, GivenCategory, MasksFile, OneTree, Regions, ScoredMask, Segmenter, masks_to_bytes,
};
use vtex::synth::{layer_map, reconstruct};

/// How a photograph is analyzed.
pub(crate) struct Analysis {
    /// A photograph, a drawing, a library or a scene.
    pub(crate) input: Input,
    pub(crate) masks: MasksFrom,
    pub(crate) engine: EngineOptions,
    pub(crate) save_masks: Option<Destination>,
    pub(crate) layers: LayerFiles,
    pub(crate) parameters: AnalyzeParams,
    /// Whether the exemplar tiles; `None` to find out.
    pub(crate) wrap: Option<bool>,
    /// Whether analysis tests if the borders of a photograph join.
    pub(crate) looks_at_borders: bool,
    /// Whether the elements are placed anew afterwards.
    pub(crate) places: bool,
}

impl Analysis {
    /// Fails early if masks or layers could not be saved later.
    ///
    /// # Errors
    /// As [`Destination::probe`].
    pub(crate) fn probe(&self) -> vtex::Result<()> {
        self.save_masks.as_ref().map_or(Ok(()), Destination::probe)?;
        self.layers.save.as_ref().map_or(Ok(()), |target| target.place.probe())
    }

    /// Checks the options; `outputs` are the files of results.
    pub(crate) fn new(
        input: Input,
        (masks, layers): (MasksArgs, LayerFilesArgs),
        force: &ForceArgs,
        outputs: &[PathBuf],
        parameters: &Parameters,
    ) -> Result<Self, Failure> {
        if let Some(path) = &masks.save_masks {
            format::check_masks_name(path)?;
        }
        let input_path = match &input {
            Input::File(path) => Some(path.as_path()),
            _ => None,
        };
        let mut written = self::outputs(outputs);
        written.push(("--save-masks", masks.save_masks.as_deref()));
        written.push(layers.written());
        for read in [("the photograph", input_path), ("--masks", masks.masks.as_deref()), layers.read()] {
            check_distinct(&[&[read], &written[..]].concat())?;
        }
        let save_masks = masks.save_masks.map(|path| Destination::File { path, force: force.force });
        let sam = SamFrom::new(masks.sam);
        let from = masks_from(masks.masks, parameters.segmenter, sam)?;
        let engine = engine(masks.engine, parameters.threads);
        let layers = layers.files(force.force)?;
        let (wrap, parameters) = (parameters.wrap.choice(), parameters.analyze.clone());
        Ok(Self {
            input,
            masks: from,
            engine,
            save_masks,
            layers,
            parameters,
            wrap,
            looks_at_borders: true,
            places: true,
        })
    }
}

impl Analysis {
    /// The analysis of `vtex analyze` without options.
    pub(crate) fn plain(input: Input, args: EngineArgs, parameters: &Parameters) -> Result<Self, Failure> {
        Ok(Self {
            input,
            masks: masks_from(None, parameters.segmenter, None)?,
            engine: engine(args, parameters.threads),
            save_masks: None,
            layers: LayerFiles::default(),
            parameters: parameters.analyze.clone(),
            wrap: parameters.wrap.choice(),
            looks_at_borders: true,
            places: false,
        })
    }

    /// The kind of segmenter, for the estimate of the progress bar.
    pub(crate) fn finder(&self) -> ElementFinder {
        match self.masks {
            MasksFrom::Auto | MasksFrom::Texton | MasksFrom::Sam(_) => ElementFinder::Texton,
            MasksFrom::File(_) | MasksFrom::Regions | MasksFrom::OneTree | MasksFrom::Felzenszwalb => {
                ElementFinder::Regions
            }
        }
    }

    /// The source of masks; [`MasksFrom::Auto`] is resolved.
    pub(crate) fn masks(&self) -> MasksFrom {
        sam_from(&self.masks).map_or_else(|| self.masks.clone(), MasksFrom::Sam)
    }
}

/// Photograph or drawing → library; saves the masks if requested.
pub(crate) fn analyze(common: &Common, analysis: &Analysis, reporter: &Reporter) -> anyhow::Result<Library> {
    reporter.stage("reading")?;
    library_of(common, analysis, analysis.input.read()?, KnownBefore::default(), reporter)
}

/// Any texture as a scene: a scene is unchanged; a library, and the library made of a photograph or drawing,
/// gives the reconstruction of its exemplar.
pub(crate) fn texture(common: &Common, analysis: &Analysis, reporter: &Reporter) -> anyhow::Result<Scene> {
    let bytes = analysis.input.read()?;
    if matches!(input::InputKind::of(&bytes), input::InputKind::Image | input::InputKind::Svg) {
        return Ok(reconstruct(&library_of(common, analysis, bytes, KnownBefore::default(), reporter)?));
    }
    reading::texture_of(bytes, &analysis.input)
}

/// What is known of a photograph before its analysis.
#[derive(Default)]
pub(crate) struct KnownBefore<'a> {
    /// Its masks.
    pub(crate) masks: Option<Box<dyn Segmenter>>,
    /// What its last analysis left.
    pub(crate) memory: Option<&'a mut AnalysisMemory>,
}

/// The library of the bytes of a photograph or a drawing.
pub(crate) fn library_of(
    common: &Common,
    analysis: &Analysis,
    bytes: Vec<u8>,
    known: KnownBefore<'_>,
    reporter: &Reporter,
) -> anyhow::Result<Library> {
    let as_it_is = AsItIs(reporter);
    let progress: &dyn Progress = if analysis.places { reporter } else { &as_it_is };
    let wanted = [input::InputKind::Image, input::InputKind::Svg, input::InputKind::Unknown];
    let kind = input::InputKind::expect(&bytes, &analysis.input, &wanted)?;
    let name = match &analysis.input {
        Input::Stdin => "-".into(),
        Input::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy(),
    };
    if kind == input::InputKind::Svg || analysis.parameters.kind == PictureKind::Curves {
        check_drawing(analysis)?;
        let params = ImportParams { wrap: analysis.wrap, analyze: analysis.parameters.clone() };
        let mut library = import(&bytes, &analysis.input.name(), &params, progress)?;
        library.source.file = name.into_owned();
        return Ok(library);
    }
    // Errors name the file as the user wrote it.
    let is_no_tile = !analysis.looks_at_borders || analysis.wrap == Some(false);
    let read = if is_no_tile { Exemplar::from_bytes } else { Exemplar::tile_from_bytes };
    let mut exemplar = read(&bytes, &analysis.input.name(), &Limits::default())?;
    exemplar.file = name.into_owned();
    drop(bytes);
    if shows_lines(&exemplar.image) {
        reporter.warn("the picture shows lines on paper: --kind curves reads it as a drawing of strokes");
    }
    let size = <[u32; 2]>::from(exemplar.image.dimensions());
    let by = match analysis.parameters.max_pixels {
        0 => 1.0,
        most => libm::sqrt(f64::from(most) / (f64::from(size[0]) * f64::from(size[1]))).min(1.0),
    };
    reporter.learn(size, size.map(|side| (f64::from(side) * by).max(1.0) as u32));
    if let Some(painted) = &analysis.layers.painted {
        exemplar.layers = Some(layer_maps::read(painted)?.layers()?);
    }
    let segmenter = match known.masks {
        Some(found) => found,
        None => segmenter(common, analysis, reporter)?,
    };
    let saving = Saving { segmenter, place: analysis.save_masks.as_ref() };
    let repeated = exemplar.copies != [1; 2];
    let joins = || repeated || (analysis.looks_at_borders && borders_join(&exemplar.image));
    let wrap = analysis.wrap.unwrap_or_else(joins);
    let parameters = AnalyzeParams { wrap, ..analysis.parameters.clone() };
    let library = match known.memory {
        Some(memory) => analyze_again(&exemplar, &saving, &parameters, memory, progress)?,
        None => vtex::analyze::analyze(&exemplar, &saving, &parameters, progress)?,
    };
    reporter.picture("gaussians", &|| splat(&reconstruct(&library)));
    if let Some(save) = &analysis.layers.save {
        save.write(&layer_map(&library), [library.arrangement.periodic; 2], None)?;
    }
    // A tiny picture is repeated whether or not its borders join.
    let is_tiny = (0..2).any(|k| size[k] / exemplar.copies[k] < Exemplar::SMALLEST_SIDE);
    if wrap && analysis.wrap.is_none() && !is_tiny {
        reporter.hint(
            "opposite borders of the photograph join, so elements may cross them; to treat them as borders, give --wrap=off",
        );
    }
    if let Some(hint) = hints::of_library(&library) {
        reporter.hint(hint);
    }
    Ok(library)
}

/// Progress of the analysis of a picture whose elements stay where they are.
struct AsItIs<'a>(&'a Reporter);

impl Progress for AsItIs<'_> {
    fn advance(&self, stage: &'static str, done: u64, total: u64) -> bool {
        self.0.advance(stage, done, total)
    }

    fn warn(&self, message: &str) {
        self.0.warn(message);
    }

    fn warn_of_placing(&self, _: &str) {}

    fn picture(&self, name: &str, draw: &dyn Fn() -> RgbImage) {
        self.0.picture(name, draw);
    }
}

/// Refuses files that apply to photographs only.
fn check_drawing(analysis: &Analysis) -> Result<(), Failure> {
    let LayerFiles { painted, save } = &analysis.layers;
    let masks = analysis.save_masks.is_some() || matches!(analysis.masks, MasksFrom::File(_));
    if !masks && painted.is_none() && save.is_none() {
        return Ok(());
    }
    Err(Failure::usage("a drawing has neither masks nor layer maps")
        .hint("leave out --masks, --save-masks, --layer-map and --save-layers"))
}

/// Loads the segmenter.
pub(crate) fn segmenter(
    common: &Common,
    analysis: &Analysis,
    reporter: &Reporter,
) -> anyhow::Result<Box<dyn Segmenter>> {
    match &analysis.masks {
        MasksFrom::File(path) => {
            note_read(path);
            return Ok(Box::new(MasksFile::read(path)?));
        }
        MasksFrom::Felzenszwalb => return Ok(Box::new(Felzenszwalb::default())),
        MasksFrom::Regions => return Ok(Box::new(Regions)),
        MasksFrom::OneTree => return Ok(Box::new(OneTree)),
        MasksFrom::Auto | MasksFrom::Texton | MasksFrom::Sam(_) => {}
    }
    reporter.stage("loading")?;
    let Some(from) = sam_from(&analysis.masks) else {
        return Ok(Box::new(Texton::new()?));
    };
    let sam = sam(&from, &analysis.engine)?;
    if common.verbosity > 0 && !common.json {
        say(&format!("{}{}", sam.title(), why_not(&analysis.engine)));
    }
    Ok(Box::new(Generator::new(Box::new(sam), GeneratorParams::default())?))
}

/// The network of Segment Anything, if the segmenter uses it.
fn sam_from(masks: &MasksFrom) -> Option<SamFrom> {
    match masks {
        MasksFrom::Sam(from) => Some(from.clone()),
        // Without a folder of models there is no model.
        MasksFrom::Auto => {
            let any = ModelFolder::open().is_ok_and(|s| s.names().is_ok_and(|names| !names.is_empty()));
            any.then_some(SamFrom::Model(None))
        }
        MasksFrom::File(_)
        | MasksFrom::Texton
        | MasksFrom::Regions
        | MasksFrom::OneTree
        | MasksFrom::Felzenszwalb => None,
    }
}

/// Text that identifies what masks depend on besides the photograph and the parameters: the segmenter,
/// checksums of files, the engine.
pub(crate) fn finds_masks(masks: &MasksFrom, options: &EngineOptions) -> anyhow::Result<String> {
    Ok(match (masks, sam_from(masks)) {
        (_, Some(from)) => {
            let sums = match &from {
                SamFrom::Files(files) => {
                    let sums: Vec<Vec<String>> =
                        files.iter().map(|path| sums_of_network(path)).collect::<vtex::Result<_>>()?;
                    sums.concat()
                }
                SamFrom::Model(name) => {
                    let store = ModelFolder::open()?;
                    store.sums(&model_name(&store, name.as_ref())?)?
                }
            };
            let engine = match choose(options)? {
                EngineChoice::OnnxRuntime { version, .. } => format!("ONNX Runtime {version}"),
                EngineChoice::Rten { .. } => "rten".to_owned(),
            };
            format!("sam {} {engine}", sums.join(" "))
        }
        (MasksFrom::Regions, None) => "regions".into(),
        (MasksFrom::OneTree, None) => "one-tree".into(),
        (MasksFrom::Felzenszwalb, None) => "felzenszwalb".into(),
        (MasksFrom::File(path), None) => format!("file {}", sums_of_network(path)?.join(" ")),
        (MasksFrom::Auto | MasksFrom::Texton | MasksFrom::Sam(_), None) => "texton".into(),
    })
}

/// Loads Segment Anything.
fn sam(from: &SamFrom, engine: &EngineOptions) -> anyhow::Result<Sam> {
    let files = match from {
        SamFrom::Files(files) => files.clone(),
        SamFrom::Model(name) => {
            let store = ModelFolder::open()?;
            store.networks(&model_name(&store, name.as_ref())?)?
        }
    };
    let files: Vec<NetworkSource<'_>> = files.iter().map(|path| NetworkSource::File(path)).collect();
    Ok(Sam::open(&files, engine)?)
}

/// The named model, or the only one.
fn model_name(store: &ModelFolder, name: Option<&Name>) -> anyhow::Result<String> {
    let names = store.names()?;
    match (name, &names[..]) {
        (Some(name), _) => Ok(name.as_str().to_owned()),
        (None, [only]) => Ok(only.clone()),
        (None, []) => {
            let failure = Failure::failed("there is no model of Segment Anything");
            let hint = "add one with 'vtex models add', or name its files with --encoder and --decoder";
            Err(failure.hint(hint).into())
        }
        (None, several) => {
            let message = format!("there are several models: {}", several.join(", "));
            Err(Failure::usage(message).hint("choose one with --model").into())
        }
    }
}

/// The reason why ONNX Runtime is not used although it is permitted.
fn why_not(engine: &EngineOptions) -> String {
    match choose(engine) {
        Ok(EngineChoice::Rten { because: Some(reason) }) => format!(" ({reason})"),
        _ => String::new(),
    }
}

/// A segmenter that also saves its masks.
struct Saving<'a> {
    segmenter: Box<dyn Segmenter>,
    place: Option<&'a Destination>,
}

impl Segmenter for Saving<'_> {
    fn name(&self) -> String {
        self.segmenter.name()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> vtex::Result<Vec<ScoredMask>> {
        self.segment_reduced(image, [image.width(), image.height()], progress)
    }

    fn segment_reduced(
        &self,
        image: &RgbImage,
        whole: [u32; 2],
        progress: &dyn Progress,
    ) -> vtex::Result<Vec<ScoredMask>> {
        let masks = self.segmenter.segment_reduced(image, whole, progress)?;
        if let Some(place) = self.place {
            // Packed by the writer of files, like all output.
            let path = place.path();
            let gzip = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
            let plain = if gzip { path.with_extension("") } else { path.to_owned() };
            // Saved masks have the size of the photograph, so that they can be corrected on top of it.
            let reduced = [image.width(), image.height()];
            let stretched = |m: &ScoredMask| ScoredMask { mask: m.mask.stretched(reduced, whole), ..*m };
            let saved = if reduced == whole { masks.clone() } else { masks.iter().map(stretched).collect() };
            let bytes =
                masks_to_bytes(&plain, &self.name(), whole[0], whole[1], &saved, &self.categories(whole))?;
            let kind = FileKind { format: Format::Library, gzip };
            Target { place: place.clone(), kind }.write_bytes(&bytes)?;
        }
        Ok(masks)
    }

    fn categories(&self, size: [u32; 2]) -> Vec<GivenCategory> {
        self.segmenter.categories(size)
    }

    fn seeks_elements(&self) -> bool {
        self.segmenter.seeks_elements()
    }
}
