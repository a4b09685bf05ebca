//! Prompts → masks: the inputs of an export's decoder, and the interpretation of its outputs.
//!
//! All these networks measure points from the centre of the first pixel. For each point they give
//! three masks, from part to whole. Some put a mask for several points before them, which is skipped.

use super::Shown;
use super::export::{Family, MASK_SIDE};
use crate::engine::{Engine, Tensor};
use std::sync::atomic::{AtomicU8, Ordering};
use vtex_base::error::{Error, Result};
use vtex_segment::segment::prompt::PromptMask;

/// Points per run if the export allows any number. More of them take more memory than they save time.
const BATCH: usize = 16;

/// Whether several points can be decoded in one run. Some graphs accept several points but give wrong
/// masks, so the first answer for several is compared with that for a single point.
pub(super) struct Batching {
    /// Number of points per run, if the graph fixes it.
    fixed: Option<usize>,
    state: AtomicU8,
}

const UNTRIED: u8 = 0;
const WORKS: u8 = 1;
const FAILS: u8 = 2;

impl Batching {
    /// For a graph with a fixed number of points per run, or any number.
    pub(super) fn new(fixed: Option<usize>) -> Self {
        Self { fixed, state: AtomicU8::new(UNTRIED) }
    }

    /// Number of points per run.
    pub(super) fn batch(&self) -> usize {
        match self.fixed {
            Some(n) => n,
            None if self.state.load(Ordering::Acquire) == FAILS => 1,
            None => BATCH,
        }
    }
}

impl Shown<'_> {
    /// The masks at each point.
    pub(super) fn decode(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>> {
        let together = &self.sam.together;
        let mut masks = Vec::with_capacity(points.len());
        while masks.len() < points.len() {
            let rest = &points[masks.len()..];
            let batch = &rest[..together.batch().min(rest.len())];
            if batch.len() > 1
                && together.fixed.is_none()
                && together.state.load(Ordering::Acquire) == UNTRIED
            {
                let last = self.run(&batch[batch.len() - 1..])?;
                match self.run(batch) {
                    Ok(answers)
                        if answers.last().zip(last.first()).is_some_and(|(a, b)| nearly_equal(a, b)) =>
                    {
                        together.state.store(WORKS, Ordering::Release);
                        masks.extend(answers);
                    }
                    _ => together.state.store(FAILS, Ordering::Release),
                }
            } else {
                masks.extend(self.run(batch)?);
            }
        }
        Ok(masks)
    }

    /// The masks at the points of one run.
    fn run(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>> {
        let (sam, decoder) = (self.sam, &self.sam.decoder);
        // A fixed number is padded with the last point.
        let count = decoder.prompts.unwrap_or(points.len());
        let filled = || points.iter().chain(points.last().into_iter().cycle()).take(count);
        let network: &dyn Engine = sam.decoding.as_deref().unwrap_or(sam.encoding.as_ref());

        let size = self.frame.size();
        // The size to which the graph scales masks, and in whose pixels EfficientSAM measures points.
        let asked = match (decoder.of_image, decoder.family, &decoder.image_size) {
            (true, ..) => self.frame.image().map(|n| n as usize),
            (_, Family::Efficient, None) => size,
            _ => [MASK_SIDE; 2],
        };
        let each = decoder.points_each;
        let (mut places, mut labels) = (Vec::new(), Vec::new());
        for point in filled() {
            let seen = self.frame.point(*point);
            let unit = |k: usize| match decoder.family {
                Family::Efficient => asked[k] as f32 / size[k] as f32,
                _ => 1.0,
            };
            places.extend([0, 1].map(|k| (seen[k] - 0.5).max(0.0) * unit(k)));
            labels.push(1.0);
            for _ in 1..each {
                places.extend([0.0, 0.0]);
                labels.push(-1.0);
            }
        }
        let shape =
            |last: &[usize]| [if decoder.nested { &[1][..] } else { &[] }, &[count, each], last].concat();
        let mut extra = vec![
            (&decoder.points, Tensor::f32(shape(&[2]), places)),
            (&decoder.labels, Tensor::f32(shape(&[]), labels)),
        ];
        if let Some((name, [width, height])) = &decoder.mask_input {
            extra.push((name, Tensor::f32([count, 1, *height, *width], vec![0.0; count * width * height])));
        }
        if let Some(name) = &decoder.has_mask {
            extra.push((name, Tensor::f32([1], vec![0.0])));
        }
        if let Some(name) = &decoder.image_size {
            extra.push((name, Tensor::f32([2], vec![asked[1] as f32, asked[0] as f32])));
        }
        let inputs: Vec<(&str, &Tensor)> = self
            .features
            .iter()
            .map(|(name, tensor)| (name.as_str(), tensor))
            .chain(extra.iter().map(|(name, tensor)| (name.as_str(), tensor)))
            .collect();
        let answers = network.run(&inputs, &[&decoder.masks, &decoder.scores])?;
        let mut masks = self.masks(&answers, count)?;
        masks.truncate(points.len());
        Ok(masks)
    }

    /// Masks by prompt, from all masks and scores of a run.
    fn masks(&self, answers: &[Tensor], count: usize) -> Result<Vec<Vec<PromptMask>>> {
        let odd = |masks: &Tensor, scores: &Tensor| Error::Network {
            name: "sam".into(),
            reason: format!(
                "for {count} points it gave masks of shape {:?} and scores of shape {:?}",
                masks.shape, scores.shape
            ),
            advice: "report it with where the network is from",
        };
        let [masks, scores] = answers else {
            return Err(Error::Network { name: "sam".into(), reason: "it gave no masks".into(), advice: "" });
        };
        let (logits, ious) = (masks.floats(), scores.floats());
        let [.., height, width] = masks.shape[..] else { return Err(odd(masks, scores)) };
        let each = ious.len() / count;
        if each == 0
            || each * count != ious.len()
            || width * height == 0
            || logits.len() != ious.len() * width * height
        {
            return Err(odd(masks, scores));
        }
        let skipped = usize::from(each == 4);
        let one = |index: usize| PromptMask {
            // An infinite or NaN score counts as 0.
            predicted_iou: if ious[index].is_finite() { ious[index].clamp(0.0, 1.0) } else { 0.0 },
            logits: self.frame.logits(
                &logits[index * width * height..][..width * height],
                width,
                height,
                self.sam.decoder.of_image,
            ),
        };
        let of_prompt = |prompt: usize| (skipped..each).map(|k| one(prompt * each + k)).collect();
        Ok((0..count).map(of_prompt).collect())
    }
}

/// Whether two answers are equal up to rounding.
fn nearly_equal(a: &[PromptMask], b: &[PromptMask]) -> bool {
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| {
            let same = |x: f32, y: f32| (x - y).abs() <= 1e-2 * (1.0 + x.abs().max(y.abs()));
            same(a.predicted_iou, b.predicted_iou)
                && a.logits.values.len() == b.logits.values.len()
                && a.logits.values.iter().zip(&b.logits.values).all(|(x, y)| same(*x, *y))
        })
}
