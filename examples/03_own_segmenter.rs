//! 3. Your own segmenter: whatever finds masks can take the place of the built-in one.
//!
//! This one is for ground of one colour: whatever has another colour is an element.
//!
//! `cargo run --release --example 03_own_segmenter [PHOTO]`

use image::RgbImage;
use std::error::Error;
use std::path::PathBuf;
use vtex::Progress;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::raster::{Connectivity, LabelMap, Mask, colour, components};
use vtex::segment::{Regions, ScoredMask, Segmenter};

/// What differs from the most common colour by more than a threshold.
struct UnlikeTheGround {
    /// Distance in Oklab, 0 to 1.
    threshold: f32,
}

impl Segmenter for UnlikeTheGround {
    fn name(&self) -> String {
        "unlike-the-ground".into()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> vtex::Result<Vec<ScoredMask>> {
        // Say what happens, and stop when asked to.
        if !progress.advance("segmentation", 0, 1) {
            return Err(vtex::Error::Interrupted);
        }
        // The median of all pixels stands for the ground.
        let ground = colour::median(image.pixels().map(|p| p.0)).unwrap_or_default().to_oklab();
        let differs = |rgb: [u8; 3]| {
            let lab = colour::oklab(rgb);
            let square: f32 = (0..3).map(|c| (lab[c] - ground[c]) * (lab[c] - ground[c])).sum();
            square.sqrt() > self.threshold
        };
        let labels = image.pixels().map(|p| u32::from(differs(p.0))).collect();
        let map = LabelMap { width: image.width(), height: image.height(), labels };

        // Connected pieces become masks. Masks may overlap and contain one another: analysis picks
        // the best disjoint ones, and the score helps it to choose.
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
    let own = UnlikeTheGround { threshold: 0.12 };
    let segmenters: [&dyn Segmenter; 2] = [&own, &Regions];
    for segmenter in segmenters {
        let library = analyze(&exemplar, segmenter, &AnalyzeParams::default(), &())?;
        println!(
            "{}: {} primaries cover {:.0} %",
            segmenter.name(),
            library.primaries.len(),
            100.0 * library.coverage,
        );
    }
    Ok(())
}
