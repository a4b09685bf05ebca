//! The background field in PDF: rectangles of one colour, blended by two masks.
//!
//! In PDF every stop of a gradient takes some 200 bytes before they are packed. So the field is sampled at the nodes of
//! a lattice and interpolated between them. Each node has a cell that reaches to the nodes beside it. Along x, the cells
//! of odd nodes are painted over those of even nodes through a mask that is opaque at odd nodes, transparent at even ones
//! and linear between. Along y, the odd rows are painted over the even rows in the same way. The result is bilinear
//! between nodes. Borders between cells are not visible: those of even cells lie under opaque paint, those of odd cells
//! are transparent. The only gradients are those of the masks, one for each odd column and row; the cells are plain
//! rectangles in a packed stream.

use super::PreparedBackground;
use super::content::ContentStream;
use super::file::File;
use super::paint::{set_gradient, set_mask};
use pdf_writer::Ref;
use vtex_base::geometry::{Affine, Rect};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Stop;
use vtex_scene::scene::Gradient;

/// Distance by which cells overlap one another, and the outermost ones the border of the canvas, in pixels.
const OVERLAP: f64 = 1.0;

/// Paints the background.
pub(super) fn draw(background: &PreparedBackground, content: &mut ContentStream, file: &mut File) {
    let lattice = FieldNodes::new(background);
    let masks = [lattice.mask(file, ShadingAxis::X), lattice.mask(file, ShadingAxis::Y)];
    lattice.draw_rows(content, file, 0, masks[0]);
    let mut odd = ContentStream::new();
    lattice.draw_rows(&mut odd, file, 1, masks[0]);
    let odd = odd.group(file, lattice.bounds());
    draw_masked(content, file, masks[1], odd);
}

/// Draws a form through a mask.
fn draw_masked(content: &mut ContentStream, file: &mut File, mask: Ref, form: Ref) {
    content.within(|c| {
        set_mask(c, file, mask);
        c.draw(form);
    });
}

#[derive(Clone, Copy)]
enum ShadingAxis {
    X,
    Y,
}

/// The colours of the field at equally spaced nodes.
struct FieldNodes {
    /// Distance of nodes along x and y, in pixels. The first node lies at 0, the last at the opposite border.
    step: [f64; 2],
    /// Colours of the nodes by row; all rows have equally many.
    rows: Vec<Vec<Colour>>,
}

impl FieldNodes {
    /// Samples the rows of the background; nodes along x are about as far apart as the rows.
    fn new(background: &PreparedBackground) -> Self {
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

    /// Index of the last node along an axis.
    fn last(&self, axis: ShadingAxis) -> usize {
        match axis {
            ShadingAxis::X => self.rows[0].len() - 1,
            ShadingAxis::Y => self.rows.len() - 1,
        }
    }

    /// Begin and end of the cell of a node, in pixels: the places of the nodes beside it, and the overlap.
    fn cell_extent(&self, axis: ShadingAxis, node: usize) -> [f64; 2] {
        let (last, step) = (self.last(axis), self.step[axis as usize]);
        let from = if node < 2 { -OVERLAP } else { (node - 1) as f64 * step };
        [from, (node + 1).min(last) as f64 * step + OVERLAP]
    }

    /// Width and height, in pixels.
    fn size(&self) -> [f64; 2] {
        [ShadingAxis::X, ShadingAxis::Y].map(|axis| self.last(axis) as f64 * self.step[axis as usize])
    }

    /// Bounds of everything painted.
    fn bounds(&self) -> Rect {
        let [width, height] = self.size();
        Rect::new(0.0, 0.0, width, height).inset(OVERLAP)
    }

    /// Draws every second row: the even ones if `first` is 0, the odd ones if it is 1.
    fn draw_rows(&self, content: &mut ContentStream, file: &mut File, first: usize, mask: Ref) {
        self.draw_cells(content, first, 0);
        let mut odd = ContentStream::new();
        self.draw_cells(&mut odd, first, 1);
        let odd = odd.group(file, self.bounds());
        draw_masked(content, file, mask, odd);
    }

    /// Draws every second cell of every second row, beginning with `first_row` and `first`. Successive cells of
    /// one colour are one rectangle.
    fn draw_cells(&self, content: &mut ContentStream, first_row: usize, first: usize) {
        let mut current = None;
        for (k, row) in self.rows.iter().enumerate().skip(first_row).step_by(2) {
            let [top, bottom] = self.cell_extent(ShadingAxis::Y, k);
            let mut i = first;
            while i < row.len() {
                let [left, mut right] = self.cell_extent(ShadingAxis::X, i);
                let colour = row[i];
                i += 2;
                while i < row.len() && row[i] == colour {
                    right = self.cell_extent(ShadingAxis::X, i)[1];
                    i += 2;
                }
                if current != Some(colour) {
                    content.fill_with(colour);
                }
                current = Some(colour);
                content.fill_rectangle(Rect::new(left, top, right, bottom));
            }
        }
    }

    /// The mask along an axis: white at odd nodes, black at even ones, linear between.
    fn mask(&self, file: &mut File, axis: ShadingAxis) -> Ref {
        let ([width, height], step) = (self.size(), self.step[axis as usize]);
        // A tent is black at both ends and white in the middle. One form, moved, draws all tents; the last may
        // end beyond the canvas.
        let (direction, bounds) = match axis {
            ShadingAxis::X => ([1.0, 0.0], Rect::new(0.0, -OVERLAP, 2.0 * step, height + OVERLAP)),
            ShadingAxis::Y => ([0.0, 1.0], Rect::new(-OVERLAP, 0.0, width + OVERLAP, 2.0 * step)),
        };
        let [black, white] = [0, 255].map(|light| Colour([light; 3]));
        let mut gradient = Gradient::linear([0.0; 2], direction.map(|v| v * 2.0 * step), [black; 2]);
        gradient.between = vec![Stop { offset: 0.5, colour: white, opacity: 1.0 }];
        let mut tent = ContentStream::new();
        set_gradient(&mut tent, file, &gradient, bounds);
        tent.fill_rectangle(bounds);
        let tent = tent.form(file, bounds);
        let mut content = ContentStream::new();
        for node in (1..=self.last(axis)).step_by(2) {
            let from = (node - 1) as f64 * step;
            content.within(|c| {
                c.transform(Affine::translate((direction[0] * from, direction[1] * from)));
                c.draw(tent);
            });
        }
        content.group(file, self.bounds())
    }
}
