//! The built-in texton network as a [`Prompter`]. `tools/texton` describes it and its training.
//!
//! The decoder is a formula, evaluated only for the cells that a mask can reach. That is twenty times as
//! fast as running the exported graph over windows.

use super::encoder::{ALIGN, CENTRE, CHANNELS, TextonEncoder, UNIT};
use super::maps::FeatureMaps;
use crate::segment::prompt::{Embedded, Logits, PromptMask, Prompter};
use image::RgbImage;
use vtex_base::error::Result;
use vtex_base::parallel::map;

/// Side of an embedding's cell, in pixels of the image.
pub(super) const CELL: usize = 2;
/// Channels of the embedding, in the order of `tools/texton/network.py`.
const HEADS: usize = 3;
const HEAD: usize = 18;
const TEXTON: usize = 30;
const BORDER: usize = 31;
/// Longest side encoded in one piece, and the overlap of adjacent pieces, in pixels.
const TILE: usize = 1536;
const OVERLAP: usize = 256;
/// Cells with logits below minus this are far from a mask's border.
const MARGIN: f32 = 2.0;
/// Logit of cells that are not evaluated.
const FAR: f32 = -8.0;
/// Largest mask, in cells, unless a quarter of all cells is more. Larger masks are rejected.
const MOST_CELLS: usize = 1 << 14;
/// Weight of the texton logit in a mask's logit, as trained.
const TEXTON_WEIGHT: f32 = 1.5833;

/// The built-in texton network, a promptable network for textures.
pub struct TextonNetwork {
    encoder: TextonEncoder,
}

impl TextonNetwork {
    /// Reads the network, which is part of this crate.
    ///
    /// # Errors
    /// [`vtex_base::Error::Network`] if it is damaged.
    pub fn built_in() -> Result<Self> {
        Ok(Self { encoder: TextonEncoder::built_in()? })
    }

    /// Embeds an image. Masks with an expected IoU below `least_iou` are not decoded.
    pub(super) fn view(&self, image: &RgbImage, least_iou: f32) -> EmbeddedImage {
        EmbeddedImage::new(self.encode(image), least_iou)
    }

    /// The embedding of an image. Large images are encoded in pieces, which bounds memory.
    fn encode(&self, image: &RgbImage) -> Embedding {
        let (w, h) = (image.width() as usize, image.height() as usize);
        let (width, height) = (w.div_ceil(ALIGN) * ALIGN / CELL, h.div_ceil(ALIGN) * ALIGN / CELL);
        let (rows, columns) = (pieces(height * CELL), pieces(width * CELL));
        if rows.len() * columns.len() == 1 {
            return Embedding::of(self.encoder.encode(image, [0, 0], [width * CELL, height * CELL]));
        }
        let mut all = Embedding::of(FeatureMaps::zeros(CHANNELS, width, height));
        for &(y, tall) in &rows {
            for &(x, wide) in &columns {
                let piece = self.encoder.encode(image, [x, y], [wide, tall]);
                all.paste(&piece, [x / CELL, y / CELL]);
            }
        }
        all
    }
}

/// Start and length of each piece of a side; all are multiples of [`ALIGN`].
fn pieces(length: usize) -> Vec<(usize, usize)> {
    if length <= TILE {
        return vec![(0, length)];
    }
    let count = (length - OVERLAP).div_ceil(TILE - OVERLAP);
    let side = (length + (count - 1) * OVERLAP).div_ceil(count).next_multiple_of(ALIGN);
    (0..count).map(|k| ((length - side) * k / (count - 1) / ALIGN * ALIGN, side)).collect()
}

/// The encoder's output for an image: channels for each cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Embedding {
    /// Number of columns of cells.
    pub(super) width: usize,
    /// Number of rows of cells.
    pub(super) height: usize,
    /// The channels of each cell, cells in rows.
    values: Vec<f32>,
}

impl Embedding {
    /// Range of the channels of appearance.
    pub(super) const APPEARANCE: std::ops::Range<usize> = 0..CENTRE;
    /// Range of the channels of the predicted centre, in units of [`UNIT`] pixels.
    pub(super) const CENTRE_RANGE: std::ops::Range<usize> = CENTRE..CENTRE + 2;

    fn of(maps: FeatureMaps) -> Self {
        Self { width: maps.width, height: maps.height, values: maps.into_values() }
    }

    fn cells(&self) -> &[[f32; CHANNELS]] {
        self.values.as_chunks().0
    }

    /// The channels of a cell.
    pub(super) fn cell(&self, i: usize) -> &[f32; CHANNELS] {
        &self.cells()[i]
    }

    /// Logits of texton against background, row by row.
    pub(super) fn texton(&self) -> impl Iterator<Item = f32> + '_ {
        self.cells().iter().map(|c| c[TEXTON])
    }

    /// Logits of borders, row by row.
    pub(super) fn border(&self) -> impl Iterator<Item = f32> + '_ {
        self.cells().iter().map(|c| c[BORDER])
    }

    /// Largest logit of the predicted IoU over the heads.
    pub(super) fn quality(&self, i: usize) -> f32 {
        (0..HEADS).map(|k| self.cell(i)[HEAD + 4 * k + 3]).fold(f32::NEG_INFINITY, f32::max)
    }

    fn at(&self, point: [f32; 2]) -> [usize; 2] {
        let at = |v: f32, n: usize| ((v / CELL as f32).max(0.0) as usize).min(n - 1);
        [at(point[0], self.width), at(point[1], self.height)]
    }

    /// Inserts a piece whose first cell is given. In an overlap, each piece supplies its inner half.
    fn paste(&mut self, piece: &FeatureMaps, [x0, y0]: [usize; 2]) {
        let margin = OVERLAP / CELL / 2;
        let from = |start: usize| if start == 0 { 0 } else { margin };
        let (begin, end) = (from(x0), piece.width.min(self.width - x0));
        for y in from(y0)..piece.height.min(self.height - y0) {
            let row = (y0 + y) * self.width + x0;
            let cells = &mut self.values.as_chunks_mut::<CHANNELS>().0[row + begin..row + end];
            for (x, cell) in (begin..end).zip(cells) {
                cell.copy_from_slice(piece.cell(x, y));
                // Predicted centres are relative to the corner of the piece.
                for (value, from) in cell[CENTRE..].iter_mut().zip([x0, y0]) {
                    *value += (from * CELL) as f32 / UNIT;
                }
            }
        }
    }
}

/// An embedded image.
pub(super) struct EmbeddedImage {
    pub(super) embedding: Embedding,
    /// The term of each cell in the logits, which is the same for all masks.
    texton: Vec<f32>,
    /// Least predicted IoU of a mask.
    least_iou: f32,
}

/// The decoder at one prompt. It computes the same as `models/texton/decoder.onnx`, but only for the
/// cells that a mask can reach, and only the heads that may give a mask.
struct Prompt<'a> {
    view: &'a EmbeddedImage,
    at: &'a [f32; CHANNELS],
    heads: Vec<Head>,
}

/// A head at a prompt.
struct Head {
    predicted_iou: f32,
    /// Decrease of the logit with the distance in appearance, and with that of centres.
    slopes: [f32; 2],
    offset: f32,
}

impl Head {
    fn logit(&self, look: f32, place: f32, texton: f32) -> f32 {
        self.offset - self.slopes[0] * look - self.slopes[1] * place + texton
    }
}

impl<'a> Prompt<'a> {
    fn new(view: &'a EmbeddedImage, cell: usize) -> Self {
        let at = view.embedding.cell(cell);
        let softplus = |v: f32| if v > 20.0 { v } else { libm::log1pf(libm::expf(v)) };
        let heads = (0..HEADS).filter_map(|k| {
            let h = &at[HEAD + 4 * k..];
            let predicted_iou = 1.0 / (1.0 + libm::expf(-h[3]));
            // The heads' initial offsets range from tight to loose.
            let offset = h[2] + 3.0 + k as f32 - (HEADS - 1) as f32 / 2.0;
            // A NaN fails both conditions.
            let may_be = predicted_iou >= view.least_iou && offset + view.texton[cell] > 0.0;
            let slopes = || [softplus(h[0]), softplus(h[1] + 1.0)];
            may_be.then(|| Head { predicted_iou, slopes: slopes(), offset })
        });
        Self { view, at, heads: heads.collect() }
    }

    /// The logits of a cell; those of heads that are not wanted are [`FAR`].
    fn logits(&self, cell: usize) -> [f32; HEADS] {
        let e = self.view.embedding.cell(cell);
        let apart = |range: std::ops::Range<usize>| -> f32 {
            e[range.clone()].iter().zip(&self.at[range]).map(|(a, b)| (a - b) * (a - b)).sum()
        };
        let (look, place) = (apart(Embedding::APPEARANCE), apart(Embedding::CENTRE_RANGE));
        let mut logits = [FAR; HEADS];
        for (logit, head) in logits.iter_mut().zip(&self.heads) {
            *logit = head.logit(look, place, self.view.texton[cell]);
        }
        logits
    }
}

/// The cells that a search has visited, reused by successive searches.
struct VisitedCells {
    turns: Vec<u32>,
    turn: u32,
    reached: Vec<(u32, [f32; HEADS])>,
}

impl EmbeddedImage {
    fn new(embedding: Embedding, least_iou: f32) -> Self {
        let texton = embedding.texton().map(|v| TEXTON_WEIGHT * libm::tanhf(v / 3.0)).collect();
        Self { embedding, texton, least_iou }
    }

    /// The masks at a cell, evaluated over all cells connected to it that the loosest head reaches, and
    /// their neighbours. None if they exceed [`MOST_CELLS`].
    fn decode(&self, [x, y]: [usize; 2], seen: &mut VisitedCells) -> Vec<PromptMask> {
        let e = &self.embedding;
        let prompt = Prompt::new(self, y * e.width + x);
        if prompt.heads.is_empty() {
            return Vec::new();
        }
        let most = MOST_CELLS.max(e.cells().len() / 4);
        seen.turn += 1;
        let VisitedCells { turns, turn, reached } = seen;
        reached.clear();
        reached.push(((y * e.width + x) as u32, prompt.logits(y * e.width + x)));
        turns[y * e.width + x] = *turn;
        let (mut x0, mut x1, mut y0, mut y1) = (x, x + 1, y, y + 1);
        let mut next = 0;
        while next < reached.len() {
            let (cell, logits) = reached[next];
            next += 1;
            if logits.iter().all(|&v| v <= -MARGIN) {
                continue;
            }
            let (x, y) = (cell as usize % e.width, cell as usize / e.width);
            let mut visit = |x: usize, y: usize| {
                let cell = y * e.width + x;
                if turns[cell] != *turn {
                    turns[cell] = *turn;
                    reached.push((cell as u32, prompt.logits(cell)));
                    (x0, x1, y0, y1) = (x0.min(x), x1.max(x + 1), y0.min(y), y1.max(y + 1));
                }
            };
            if x > 0 {
                visit(x - 1, y)
            }
            if x + 1 < e.width {
                visit(x + 1, y)
            }
            if y > 0 {
                visit(x, y - 1)
            }
            if y + 1 < e.height {
                visit(x, y + 1)
            }
            if reached.len() > most {
                return Vec::new();
            }
        }
        let (width, height) = (x1 - x0, y1 - y0);
        let masks = prompt.heads.iter().enumerate().map(|(k, head)| {
            let mut values = vec![FAR; width * height];
            for &(cell, logits) in &*reached {
                let (x, y) = (cell as usize % e.width, cell as usize / e.width);
                values[(y - y0) * width + x - x0] = logits[k];
            }
            let origin = [(x0 * CELL) as f32, (y0 * CELL) as f32];
            let logits = Logits { origin, step: [CELL as f32; 2], width, height, values };
            PromptMask { predicted_iou: head.predicted_iou, logits }
        });
        masks.collect()
    }
}

impl Embedded for EmbeddedImage {
    fn expected_iou(&self, points: &[[f32; 2]]) -> Option<Vec<f32>> {
        let expected_iou = |&p: &[f32; 2]| {
            let [x, y] = self.embedding.at(p);
            1.0 / (1.0 + libm::expf(-self.embedding.quality(y * self.embedding.width + x)))
        };
        Some(points.iter().map(expected_iou).collect())
    }

    fn batch(&self) -> usize {
        1024
    }

    fn masks(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>> {
        let part = |points: &&[[f32; 2]]| -> Vec<Vec<PromptMask>> {
            let turns = vec![0; self.embedding.cells().len()];
            let mut seen = VisitedCells { turns, turn: 0, reached: Vec::new() };
            points.iter().map(|point| self.decode(self.embedding.at(*point), &mut seen)).collect()
        };
        let parts: Vec<&[[f32; 2]]> = points.chunks(256).collect();
        Ok(map(&parts, part).concat())
    }
}

impl Prompter for TextonNetwork {
    fn name(&self) -> String {
        "texton".into()
    }

    fn embed<'a>(&'a self, image: &RgbImage) -> Result<Box<dyn Embedded + 'a>> {
        Ok(Box::new(self.view(image, 0.0)))
    }
}
