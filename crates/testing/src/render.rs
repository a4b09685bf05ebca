//! Rendering of elements from front to back, so that only visible pixels are shaded.

use super::background::BackgroundParams;
use super::fills::{ElementFill, Light};
use super::noise::smoothstep;
use super::shapes::LocalOutline;
use vtex_base::raster::LabelMap;

/// Label of a pixel that nothing covers yet.
const OPEN: u32 = u32::MAX;
/// Transparency below which a pixel counts as opaque.
const OPAQUE: f32 = 1.0 / 256.0;

/// A placed shape. The parts of one element share their label; label 0 is background.
#[derive(Clone, Debug)]
pub(super) struct PlacedShape {
    pub(super) shape: LocalOutline,
    pub(super) fill: ElementFill,
    pub(super) centre: [f32; 2],
    /// Cosine and sine of its rotation.
    pub(super) turn: [f32; 2],
    pub(super) label: u32,
}

/// Parameters of the soft shadow that elements cast on lower ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct SoftShadow {
    pub(super) strength: f32,
    pub(super) offset: [f32; 2],
    /// Width of the penumbra in pixels.
    pub(super) softness: f32,
}

/// A picture being drawn.
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) colours: Vec<Light>,
    /// Remaining transparency of each pixel.
    clear: Vec<f32>,
    /// Share of light that shadows leave for lower elements.
    lit: Vec<f32>,
    labels: Vec<u32>,
    labelled: usize,
    open: usize,
    light: [f32; 3],
}

impl Canvas {
    /// An empty picture, lit from `light` (a unit vector; z points to the camera).
    pub(super) fn new(width: usize, height: usize, light: [f32; 3]) -> Self {
        let n = width * height;
        Self {
            width,
            height,
            colours: vec![[0.0; 3]; n],
            clear: vec![1.0; n],
            lit: vec![1.0; n],
            labels: vec![OPEN; n],
            labelled: 0,
            open: n,
            light,
        }
    }

    /// Share of the pixels that carry a label.
    pub(super) fn coverage(&self) -> f64 {
        self.labelled as f64 / self.labels.len() as f64
    }

    /// Share of the pixels that nothing covers yet.
    pub(super) fn openness(&self) -> f64 {
        self.open as f64 / self.labels.len() as f64
    }

    /// Whether nothing covers the pixel nearest to a point; `true` outside.
    pub(super) fn is_open(&self, p: [f32; 2]) -> bool {
        let inside = p[0] >= 0.0 && p[1] >= 0.0 && p[0] < self.width as f32 && p[1] < self.height as f32;
        !inside || self.labels[p[1] as usize * self.width + p[0] as usize] == OPEN
    }

    /// Whether an element, widened by `gap`, touches nothing drawn so far (tested on a grid).
    pub(super) fn fits(&self, element: &PlacedShape, gap: f32) -> bool {
        let stride = ((element.shape.extent[1] / 5.0) as usize).clamp(1, 6);
        let mut free = true;
        for_pixels(self.width, self.height, element, element.centre, gap, stride, |i, p| {
            if free && self.labels[i] != OPEN && element.shape.at(p).depth > -gap {
                free = false;
            }
            free
        });
        free
    }

    /// Draws an element below everything drawn so far.
    pub(super) fn draw(&mut self, element: &PlacedShape, shadow: Option<&SoftShadow>) {
        let light = into_frame(element, self.light);
        let (width, height) = (self.width, self.height);
        for_pixels(width, height, element, element.centre, 1.0, 1, |i, p| {
            let clear = self.clear[i];
            if clear < OPAQUE {
                return true;
            }
            let hit = element.shape.at(p);
            let cover = (hit.depth + 0.5).clamp(0.0, 1.0);
            if cover > 0.0 {
                self.add(i, clear * cover, element.fill.at(p, &hit, light));
                self.clear[i] = clear * (1.0 - cover);
                if cover >= 0.5 && self.labels[i] == OPEN {
                    self.labels[i] = element.label;
                    self.labelled += usize::from(element.label != 0);
                    self.open -= 1;
                }
            }
            true
        });
        if let Some(shadow) = shadow {
            self.shade(element, shadow);
        }
    }

    fn shade(&mut self, element: &PlacedShape, shadow: &SoftShadow) {
        let centre = [element.centre[0] + shadow.offset[0], element.centre[1] + shadow.offset[1]];
        let soft = shadow.softness.max(0.5);
        for_pixels(self.width, self.height, element, centre, soft, 1, |i, p| {
            if self.clear[i] >= OPAQUE {
                let depth = element.shape.smooth(p).depth;
                self.lit[i] *= 1.0 - shadow.strength * smoothstep(-soft, soft, depth);
            }
            true
        });
    }

    fn add(&mut self, i: usize, share: f32, colour: Light) {
        let share = share * self.lit[i].max(0.12);
        for (sum, c) in self.colours[i].iter_mut().zip(colour) {
            *sum += share * c;
        }
    }

    /// Fills the remaining transparency with the background.
    pub(super) fn fill(&mut self, background: &BackgroundParams) {
        for i in 0..self.clear.len() {
            if self.clear[i] >= OPAQUE {
                let (x, y) = ((i % self.width) as f32 + 0.5, (i / self.width) as f32 + 0.5);
                self.add(i, self.clear[i], background.at(x, y, self.light));
            }
        }
    }

    /// The instance map: labels renumbered from 1 without gaps, row by row.
    pub(super) fn instances(&self) -> LabelMap {
        let largest = self.labels.iter().filter(|&&l| l != OPEN).max().copied().unwrap_or(0);
        let mut names = vec![0; largest as usize + 1];
        let mut next = 0;
        let mut map = LabelMap::filled(self.width as u32, self.height as u32, 0);
        for (new, &old) in map.labels.iter_mut().zip(&self.labels) {
            if old != OPEN && old != 0 {
                let name = &mut names[old as usize];
                if *name == 0 {
                    next += 1;
                    *name = next;
                }
                *new = *name;
            }
        }
        map
    }
}

/// The light vector in the frame of a rotated element.
fn into_frame(element: &PlacedShape, light: [f32; 3]) -> [f32; 3] {
    let [c, s] = element.turn;
    [c * light[0] + s * light[1], c * light[1] - s * light[0], light[2]]
}

/// Calls `f(pixel, point in the element's frame)` for every `stride`-th pixel of the element's box,
/// centred at `centre` and widened by `margin`, until `f` returns `false`.
#[inline]
fn for_pixels(
    width: usize,
    height: usize,
    element: &PlacedShape,
    centre: [f32; 2],
    margin: f32,
    stride: usize,
    mut f: impl FnMut(usize, [f32; 2]) -> bool,
) {
    let [c, s] = element.turn;
    let [ex, ey] = element.shape.extent.map(|e| e + margin);
    let [cx, cy] = centre;
    let tall = (ex * s).abs() + (ey * c).abs();
    let clamp = |v: f32, limit: usize| v.clamp(0.0, limit as f32) as usize;
    for row in (clamp(cy - tall, height)..clamp(cy + tall + 1.0, height)).step_by(stride) {
        let dy = row as f32 + 0.5 - cy;
        let (mut low, mut high) = (-(ex + ey), ex + ey);
        // The part of the row between two pairs of parallel sides: |k dx + m| <= e.
        for (k, m, e) in [(c, s * dy, ex), (-s, c * dy, ey)] {
            if k.abs() > 1e-4 {
                let (a, b) = ((-e - m) / k, (e - m) / k);
                (low, high) = (low.max(a.min(b)), high.min(a.max(b)));
            }
        }
        for column in (clamp(cx + low, width)..clamp(cx + high + 1.0, width)).step_by(stride) {
            let dx = column as f32 + 0.5 - cx;
            if !f(row * width + column, [c * dx + s * dy, c * dy - s * dx]) {
                return;
            }
        }
    }
}
