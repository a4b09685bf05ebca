//! The background field in PDF: flat cells mixed by two masks.
//!
//! A gradient with many stops, as in SVG, takes an object of some 200 bytes for every stop, which
//! no filter packs. So the field is taken at the nodes of a lattice, and what lies between is mixed:
//! along x, cells around the odd nodes lie over cells around the even ones under a mask that is
//! opaque at odd nodes, clear at even ones and linear between; along y the odd rows lie over the
//! even rows in the same way. The result is bilinear between nodes. No joint of cells can show: it
//! lies where what is over it is opaque, or where it is itself clear. The masks are all there is of
//! gradients, one for each odd column and row; the cells are plain rectangles in a packed stream.

use super::Background;
use crate::raster::colour::Colour;
use krilla::geom::{PathBuilder, Transform};
use krilla::mask::{Mask, MaskType};
use krilla::num::NormalizedF32;
use krilla::paint::{LinearGradient, SpreadMethod, Stop};
use krilla::stream::Stream;
use krilla::surface::Surface;

/// How far a cell reaches beneath the next, and the outermost beyond the canvas, in pixels.
const OVERLAP: f64 = 1.0;

/// Paints the background.
pub(super) fn draw(background: &Background, surface: &mut Surface<'_>) {
    let lattice = Lattice::new(background);
    let masks = [lattice.mask(surface, Axis::X), lattice.mask(surface, Axis::Y)];
    lattice.draw_rows(surface, 0, &masks[0]);
    surface.push_mask(Mask::new(masks[1].clone(), MaskType::Luminosity));
    lattice.draw_rows(surface, 1, &masks[0]);
    surface.pop();
}

#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
}

/// The field at equal distances.
struct Lattice {
    /// Distance of nodes along x and y, in pixels. The first lie at 0, the last at the far border.
    step: [f64; 2],
    /// Colours of the nodes by row; every row has as many.
    rows: Vec<Vec<Colour>>,
}

impl Lattice {
    /// From the rows of the background, with nodes along x as far apart as the rows are.
    fn new(background: &Background) -> Self {
        let width = background.columns.last().copied().unwrap_or_default();
        let count = libm::ceil(width / background.row_height).max(1.0) as usize;
        let step = width / count as f64;
        let xs: Vec<f64> = (0..=count).map(|i| i as f64 * step).collect();
        let colours = |k| {
            let row: Vec<[f32; 3]> = background.row(k, &xs);
            row.into_iter().map(|c| Colour::from_f64(c.map(f64::from))).collect()
        };
        let rows = (0..background.rows.len()).map(colours).collect();
        Self { step: [step, background.row_height], rows }
    }

    /// Number of the last node along an axis.
    fn last(&self, axis: Axis) -> usize {
        match axis {
            Axis::X => self.rows[0].len() - 1,
            Axis::Y => self.rows.len() - 1,
        }
    }

    /// From where to where the cell of a node reaches, in pixels: to the next nodes.
    fn reach(&self, axis: Axis, node: usize) -> [f64; 2] {
        let (last, step) = (self.last(axis), self.step[axis as usize]);
        let from = if node < 2 { -OVERLAP } else { (node - 1) as f64 * step };
        [from, (node + 1).min(last) as f64 * step + OVERLAP]
    }

    /// The even rows, or with `first` 1 the odd ones.
    fn draw_rows(&self, surface: &mut Surface<'_>, first: usize, mask: &Stream) {
        self.draw_cells(surface, first, 0);
        surface.push_mask(Mask::new(mask.clone(), MaskType::Luminosity));
        self.draw_cells(surface, first, 1);
        surface.pop();
    }

    /// Every second cell of every second row. Neighbours of one colour are one rectangle.
    fn draw_cells(&self, surface: &mut Surface<'_>, first_row: usize, first: usize) {
        for (k, row) in self.rows.iter().enumerate().skip(first_row).step_by(2) {
            let [top, bottom] = self.reach(Axis::Y, k);
            let mut i = first;
            while i < row.len() {
                let [left, mut right] = self.reach(Axis::X, i);
                let colour = row[i];
                i += 2;
                while i < row.len() && row[i] == colour {
                    right = self.reach(Axis::X, i)[1];
                    i += 2;
                }
                if let Some(path) = rectangle(left, top, right, bottom) {
                    super::fill(surface, &path, super::flat(colour));
                }
            }
        }
    }

    /// White at odd nodes, black at even ones, linear between.
    fn mask(&self, surface: &mut Surface<'_>, axis: Axis) -> Stream {
        let length = |axis| self.last(axis) as f64 * self.step[axis as usize];
        let (width, height, step) = (length(Axis::X), length(Axis::Y), self.step[axis as usize]);
        let stop = |offset: f32, light: u8| Stop {
            offset: NormalizedF32::new(offset).unwrap_or(NormalizedF32::ZERO),
            color: krilla::color::luma::Color::new(light).into(),
            opacity: NormalizedF32::ONE,
        };
        let mut builder = surface.stream_builder();
        let mut inner = builder.surface();
        // All are one form, moved. The last may end beyond the canvas.
        let (end, path) = match axis {
            Axis::X => ([1.0, 0.0], rectangle(0.0, -OVERLAP, 2.0 * step, height + OVERLAP)),
            Axis::Y => ([0.0, 1.0], rectangle(-OVERLAP, 0.0, width + OVERLAP, 2.0 * step)),
        };
        let gradient = LinearGradient {
            x1: 0.0,
            y1: 0.0,
            x2: (end[0] * 2.0 * step) as f32,
            y2: (end[1] * 2.0 * step) as f32,
            transform: Transform::identity(),
            spread_method: SpreadMethod::Pad,
            stops: vec![stop(0.0, 0), stop(0.5, 255), stop(1.0, 0)],
            anti_alias: false,
        };
        let tent = super::layer(&mut inner, |s| {
            if let Some(path) = &path {
                super::fill(s, path, gradient.into());
            }
        });
        for node in (1..=self.last(axis)).step_by(2) {
            let from = (node - 1) as f64 * step;
            let [x, y] = end.map(|v| (v * from) as f32);
            inner.push_transform(&Transform::from_translate(x, y));
            inner.draw_graphic(tent.clone());
            inner.pop();
        }
        inner.finish();
        builder.finish()
    }
}

fn rectangle(left: f64, top: f64, right: f64, bottom: f64) -> Option<krilla::geom::Path> {
    let [left, top, right, bottom] =
        [left, top, right, bottom].map(|v| (libm::round(v * 1000.0) / 1000.0) as f32);
    let mut builder = PathBuilder::new();
    builder.move_to(left, top);
    builder.line_to(right, top);
    builder.line_to(right, bottom);
    builder.line_to(left, bottom);
    builder.close();
    builder.finish()
}
