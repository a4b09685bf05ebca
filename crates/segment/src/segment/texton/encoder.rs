//! The encoder of the texton network: image → embedding. `tools/texton/network.py` is its definition, and
//! `encoder.onnx` holds its weights, with normalisation folded in.
//!
//! It needs no engine, so masks do not depend on installed software. Tests compare it with the exported
//! graph.

use super::convolution::Convolution;
use super::maps::{FeatureMaps, WIDE};
use super::winograd::TILE;
use image::RgbImage;
use rten_onnx::onnx::{GraphProto, ModelProto, NodeProto};
use vtex_base::error::Error;

/// Channels of the embedding, in the order of `network.py`.
pub(super) const CHANNELS: usize = 32;
/// The first of the two channels of the predicted centre.
pub(super) const CENTRE: usize = 16;
/// Unit of predicted centres, and their largest distance, in pixels.
pub(super) const UNIT: f32 = 16.0;
const REACH: f32 = 96.0;

const FILE: &[u8] = include_bytes!("../../../../../models/texton/encoder.onnx");
/// Number of reductions to half the size, the first of which joins the pixels of a cell.
const REDUCTIONS: u32 = 4;
/// The encoder requires sides that are multiples of this.
pub(super) const ALIGN: usize = 1 << REDUCTIONS;

/// Rows of cells of which the last convolutions are computed together.
const BAND: usize = 16 * TILE;

/// `x + b(a(x))`, rectified.
struct Residual {
    a: Convolution,
    b: Convolution,
}

impl Residual {
    fn apply(&self, maps: &mut FeatureMaps) {
        let inner = self.a.of(maps);
        self.b.add_to(&inner, maps);
    }
}

/// A convolution to half the size, then residuals.
struct Down {
    first: Convolution,
    then: Vec<Residual>,
}

impl Down {
    fn of(&self, maps: &FeatureMaps) -> FeatureMaps {
        let mut maps = self.first.of(maps);
        self.then.iter().for_each(|residual| residual.apply(&mut maps));
        maps
    }
}

/// Enlarges maps to twice the size and joins them with earlier maps of that size.
struct Up {
    narrow: Convolution,
    join: Residual,
}

impl Up {
    fn join(&self, small: FeatureMaps, large: &mut FeatureMaps) {
        let narrow = self.narrow.of(&small);
        drop(small);
        large.add_enlarged(&narrow);
        drop(narrow);
        self.join.apply(large);
    }
}

/// The encoder with its weights.
pub(super) struct TextonEncoder {
    first: Convolution,
    stem: Residual,
    down: [Down; 3],
    up: [Up; 3],
    last: Convolution,
    out: Convolution,
}

impl TextonEncoder {
    /// The network that is part of this crate.
    ///
    /// # Errors
    /// [`Error::Network`] if it is damaged.
    pub(super) fn built_in() -> vtex_base::Result<Self> {
        Self::read(FILE).map_err(|reason| Error::Network {
            name: "texton encoder".into(),
            reason,
            advice: "",
        })
    }

    fn read(file: &[u8]) -> Result<Self, String> {
        let model = ModelProto::parse_buf(file).map_err(|e| e.to_string())?;
        let graph = model.graph.as_ref().ok_or("it has no graph")?;
        // In the order of the graph, which is that of the calculation.
        let nodes = graph.node.iter().filter(|node| node.op_type.as_deref() == Some("Conv"));
        let layers: Vec<Convolution> =
            nodes.map(|node| convolution(graph, node)).collect::<Result<_, _>>()?;
        let mut layers = layers.into_iter();
        let mut next = || layers.next().ok_or("layers are missing");
        let mut encoder = Self {
            first: next()?,
            stem: residual(&mut next)?,
            down: [down(&mut next, 2)?, down(&mut next, 2)?, down(&mut next, 3)?],
            up: [up(&mut next)?, up(&mut next)?, up(&mut next)?],
            last: next()?,
            out: next()?,
        };
        encoder.out = encoder.out.linear();
        Ok(encoder)
    }

    /// The channels of each cell of the part of an image that begins at a pixel. Its sides are multiples of
    /// [`ALIGN`]; beyond the image's border the image is mirrored.
    pub(super) fn encode(&self, image: &RgbImage, [x0, y0]: [usize; 2], [w, h]: [usize; 2]) -> FeatureMaps {
        // The four pixels of a cell, each with its three channels.
        let mut maps = FeatureMaps::zeros(WIDE, w / 2, h / 2);
        let last = [image.width(), image.height()].map(|n| (n as usize).saturating_sub(1));
        let at = |v: usize, last: usize| if v <= last { v } else { (2 * last).saturating_sub(v) } as u32;
        maps.for_rows(1, |y, row| {
            for (x, cell) in row.chunks_exact_mut(WIDE).enumerate() {
                for (k, pixel) in cell.chunks_exact_mut(3).take(4).enumerate() {
                    let (x, y) = (at(x0 + 2 * x + k % 2, last[0]), at(y0 + 2 * y + k / 2, last[1]));
                    let bytes = image.get_pixel(x, y).0;
                    pixel
                        .iter_mut()
                        .zip(bytes)
                        .for_each(|(v, byte)| *v = (f32::from(byte) / 255.0 - 0.45) * 4.0);
                }
            }
        });
        let [down1, down2, down3] = &self.down;
        let [up3, up2, up1] = &self.up;
        let mut x1 = self.first.of(&maps);
        drop(maps);
        self.stem.apply(&mut x1);
        let mut x2 = down1.of(&x1);
        let mut x3 = down2.of(&x2);
        let x4 = down3.of(&x3);
        up3.join(x4, &mut x3);
        up2.join(x3, &mut x2);
        up1.join(x2, &mut x1);
        // The last two convolutions are computed together, in bands, because they take the most memory.
        let mut out = FeatureMaps::zeros(CHANNELS, x1.width, x1.height);
        for first in (0..out.height).step_by(BAND) {
            let rows = first..out.height.min(first + BAND);
            out.set_rows(first, self.out.of(&self.last.of_rows(&x1, rows)));
        }
        drop(x1);
        out.for_rows(1, |y, row| {
            for (x, cell) in row.chunks_exact_mut(CHANNELS).enumerate() {
                for (value, at) in cell[CENTRE..].iter_mut().zip([x, y]) {
                    // From the corner of the part, in units of 16 px, as are the logits that become steps.
                    *value = ((2 * at + 1) as f32 + REACH * libm::tanhf(*value * (8.0 / REACH))) / UNIT;
                }
            }
        });
        out
    }
}

type Layers<'a> = dyn FnMut() -> Result<Convolution, &'static str> + 'a;

fn residual(next: &mut Layers<'_>) -> Result<Residual, &'static str> {
    Ok(Residual { a: next()?, b: next()? })
}

fn down(next: &mut Layers<'_>, residuals: usize) -> Result<Down, &'static str> {
    Ok(Down { first: next()?, then: (0..residuals).map(|_| residual(next)).collect::<Result<_, _>>()? })
}

fn up(next: &mut Layers<'_>) -> Result<Up, &'static str> {
    Ok(Up { narrow: next()?, join: residual(next)? })
}

/// The convolution of a node.
fn convolution(graph: &GraphProto, node: &NodeProto) -> Result<Convolution, String> {
    let number = |name: &str| {
        let attribute = node.attribute.iter().find(|a| a.name.as_deref() == Some(name));
        attribute.and_then(|a| a.ints.first()).map_or(1, |&n| n as usize)
    };
    let values = |input: usize| -> Option<Vec<f32>> {
        let name = node.input.get(input)?;
        let tensor = graph.initializer.iter().find(|t| t.name.as_ref() == Some(name))?;
        let bytes = tensor.raw_data.as_ref()?.borrow();
        Some(bytes.as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect())
    };
    let (Some(weights), Some(bias)) = (values(1), values(2)) else {
        return Err("a convolution has no weights".into());
    };
    let [side, step, dilation] = ["kernel_shape", "strides", "dilations"].map(number);
    Ok(Convolution::new(&weights, &bias, side, step, dilation))
}
