//! Conversion between the pixels of an image and those of a network.

use super::export::{AxisOrder, EncoderPorts, Fit, Pixels};
use crate::engine::Tensor;
use image::RgbImage;
use vtex_base::raster::{Filter, resized};
use vtex_segment::segment::prompt::Logits;

/// Mean and standard deviation of ImageNet's pixels, with which all these networks were trained.
const MEAN: [f32; 3] = [123.675, 116.28, 103.53];
const DEVIATION: [f32; 3] = [58.395, 57.12, 57.375];

/// The position of an image in a network's square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InputFrame {
    /// Width and height of the image.
    image: [u32; 2],
    /// Width and height of the network's input, in its pixels.
    size: [usize; 2],
    /// Width and height of the image in the network's input, from the upper left corner.
    used: [usize; 2],
}

impl InputFrame {
    /// The position that an encoder requires for an image of at least one pixel.
    pub(super) fn new(encoder: &EncoderPorts, image: [u32; 2]) -> Self {
        let [width, height] = encoder.size;
        if encoder.fit == Fit::Stretched {
            return Self { image, size: encoder.size, used: encoder.size };
        }
        let scales = [width as f64 / f64::from(image[0]), height as f64 / f64::from(image[1])];
        let scale = scales[0].min(scales[1]);
        let used = [0, 1].map(|k| ((f64::from(image[k]) * scale + 0.5) as usize).clamp(1, encoder.size[k]));
        // Graphs that take height × width × 3 pad to a square themselves.
        let square = [width.max(height); 2];
        let size = if encoder.layout == AxisOrder::Planes { encoder.size } else { square };
        Self { image, size, used }
    }

    /// Pixels of the network per pixel of the image, along an axis.
    fn scale(&self, axis: usize) -> f32 {
        self.used[axis] as f32 / self.image[axis] as f32
    }

    /// Converts a point from pixels of the image to pixels of the network. In both, 0 is the outer edge of
    /// the first pixel.
    pub(super) fn point(&self, point: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|k| point[k] * self.scale(k))
    }

    /// Width and height of the network's input, in its pixels.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Width and height of the image.
    pub(super) fn image(&self) -> [u32; 2] {
        self.image
    }

    /// Logits with coordinates in the image's pixels, cropped to the image. The values cover the image if
    /// `of_image`, otherwise the network's whole input.
    pub(super) fn logits(&self, values: &[f32], width: usize, height: usize, of_image: bool) -> Logits {
        let cells = [width, height];
        let step = [0, 1].map(|k| match of_image {
            true => self.image[k] as f32 / cells[k] as f32,
            false => self.size[k] as f32 / (cells[k] as f32 * self.scale(k)),
        });
        let kept = [0, 1].map(|k| match of_image {
            true => cells[k],
            false => (self.used[k] * cells[k]).div_ceil(self.size[k]),
        });
        let rows = values.chunks_exact(width).take(kept[1]);
        let values = rows.flat_map(|row| &row[..kept[0]]).copied().collect();
        Logits { origin: [0.0; 2], step, width: kept[0], height: kept[1], values }
    }

    /// The image as the encoder's input tensor.
    pub(super) fn tensor(&self, encoder: &EncoderPorts, image: &RgbImage) -> Tensor {
        let [used_width, used_height] = self.used;
        // The triangle filter averages when it shrinks, like the networks' own preprocessing.
        let scaled = resized(image, used_width as u32, used_height as u32, Filter::Triangle);
        let [width, height] = if encoder.fit == Fit::Whole { self.used } else { encoder.size };
        let value = |channel: usize, byte: u8| match encoder.pixels {
            Pixels::Normalised => (f32::from(byte) - MEAN[channel]) / DEVIATION[channel],
            Pixels::Bytes => f32::from(byte),
            Pixels::Unit => f32::from(byte) / 255.0,
        };
        let beyond = |channel: usize| match encoder.pixels {
            Pixels::Normalised => 0.0,
            Pixels::Bytes => MEAN[channel],
            Pixels::Unit => MEAN[channel] / 255.0,
        };
        let at = |channel: usize, x: usize, y: usize| {
            if x < used_width && y < used_height {
                value(channel, scaled.get_pixel(x as u32, y as u32).0[channel])
            } else {
                beyond(channel)
            }
        };
        let mut values = Vec::with_capacity(3 * width * height);
        if encoder.layout == AxisOrder::Planes {
            for channel in 0..3 {
                for y in 0..height {
                    values.extend((0..width).map(|x| at(channel, x, y)));
                }
            }
            return Tensor::f32([1, 3, height, width], values);
        }
        for y in 0..height {
            for x in 0..width {
                values.extend([0, 1, 2].map(|channel| at(channel, x, y)));
            }
        }
        match encoder.layout {
            AxisOrder::BatchedRows => Tensor::f32([1, height, width, 3], values),
            _ => Tensor::f32([height, width, 3], values),
        }
    }
}
