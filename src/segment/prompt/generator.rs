//! Masks of a whole image from a promptable segmenter: a grid of points.

use super::{PromptMask, Prompter};
use crate::error::Result;
use crate::progress::{Progress, advance};
use crate::raster::{Mask, Span};
use crate::segment::{ScoredMask, Segmenter};
use image::RgbImage;

/// How an image is searched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GeneratorParams {}

/// Asks a [`Prompter`] for masks at many points.
pub struct Generator {
    prompter: Box<dyn Prompter>,
}

impl Generator {
    /// A generator for a network.
    pub fn new(prompter: Box<dyn Prompter>, _: GeneratorParams) -> Self {
        Self { prompter }
    }
}

impl Segmenter for Generator {
    fn name(&self) -> String {
        self.prompter.name()
    }

    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        advance(progress, "embedding", 0, 0)?;
        let embedded = self.prompter.embed(image)?;
        let (width, height) = image.dimensions();
        let steps = |side: u32| (0..side.div_ceil(24)).map(|i| i as f32 * 24.0 + 12.0);
        let points: Vec<[f32; 2]> = steps(height).flat_map(|y| steps(width).map(move |x| [x, y])).collect();
        let mut masks = Vec::new();
        for (i, batch) in points.chunks(embedded.batch()).enumerate() {
            advance(progress, "prompting", (i * embedded.batch()) as u64, points.len() as u64)?;
            for found in embedded.masks(batch)?.into_iter().flatten().filter(|m| m.predicted_iou > 0.5) {
                let mask = pixels(&found, width, height);
                if !mask.is_empty() {
                    masks.push(ScoredMask { mask, score: found.predicted_iou });
                }
            }
        }
        Ok(masks)
    }
}

/// The pixels whose cell is above 0.
fn pixels(mask: &PromptMask, width: u32, height: u32) -> Mask {
    let logits = &mask.logits;
    let cell = |at: u32, k: usize, most: usize| {
        (((at as f32 + 0.5 - logits.origin[k]) / logits.step[k]) as usize).min(most - 1)
    };
    let mut spans = Vec::new();
    for y in 0..height {
        let row = cell(y, 1, logits.height) * logits.width;
        for x in 0..width {
            if logits.values[row + cell(x, 0, logits.width)] > 0.0 {
                spans.push(Span { y: y as i32, x0: x as i32, x1: x as i32 + 1 });
            }
        }
    }
    Mask::from_spans(spans)
}
