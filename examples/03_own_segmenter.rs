//! 3. A custom segmenter: any method that finds masks can replace the built-in one.
//!
//! This one suits backgrounds of one colour: every pixel of another colour belongs to an element.
//!
//! `cargo run --release --example 03_own_segmenter [PHOTO]`

use image::RgbImage;
use std::error::Error;
use std::path::PathBuf;
use vtex::Progress;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::raster::{Connectivity, LabelMap, Mask, colour, components};
use vtex::segment::{Regions, ScoredMask, Segmenter};

/// Finds pixels whose colour differs from the median colour by more than a threshold.
struct UnlikeTheBackground {
    /// Distance in Oklab, 0 to 1.
    threshold: f32,
}

impl Segmenter for UnlikeTheBackground {
    fn name(&self) -> String {
        "unlike-the-background".into()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> vtex::Result<Vec<ScoredMask>> {
        // Report the stage, and stop if asked to.
        if !progress.advance("segmentation", 0, 1) {
            return Err(vtex::Error::Interrupted);
        }
        // The median colour of all pixels is taken for the background.
        let background = colour::median(image.pixels().map(|p| p.0)).unwrap_or_default().to_oklab();
        let differs = |rgb: [u8; 3]| {
            let lab = colour::oklab(rgb);
            let square: f32 = (0..3).map(|c| (lab[c] - background[c]) * (lab[c] - background[c])).sum();
            square.sqrt() > self.threshold
        };
        let labels = image.pixels().map(|p| u32::from(differs(p.0))).collect();
        let map = LabelMap { width: image.width(), height: image.height(), labels };

        // Connected pieces become masks. Masks may overlap and contain one another: analysis selects the
        // best disjoint ones by score, among other criteria.
        let (pieces, labels) = components(&map, Connectivity::Four);
        let masks = Mask::all_of_labels(&pieces, labels.len());
        let elements = masks.into_iter().zip(labels).filter(|(mask, label)| *label == 1 && mask.area() >= 30);
        Ok(elements.map(|(mask, _)| ScoredMask { mask, score: 1.0 }).collect())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let photo = std::env::args_os().nth(1).map(PathBuf::from);
    let photo = photo.unwrap_or("examples/exemplars/concrete.png".into());
    let exemplar = Exemplar::open(&photo, &Limits::default())?;
    let own = UnlikeTheBackground { threshold: 0.12 };
    let segmenters: [&dyn Segmenter; 2] = [&own, &Regions];
    for segmenter in segmenters {
        let library = analyze(&exemplar, segmenter, &AnalyzeParams::default(), &())?;
        println!(
            "{}: {} primaries cover {:.0} %",
            segmenter.name(),
            library.primaries().len(),
            100.0 * library.coverage,
        );
    }
    Ok(())
}
