//! The background as a grid of colours, which all writers paint.
//!
//! Rows lie at equal distances. Within a row colours change linearly between stops, between rows linearly
//! from one to the next. Gradients can paint exactly this, so the field is approximated here once and every
//! writer paints the same.
//!
//! The field is sampled finely. For each row, given its neighbours, `samples` computes the range of colours
//! that keep the strips above and below within a bound of the field; `stops` finds few stops within these
//! ranges. Even rows are fitted first, then odd rows, which correct the remaining errors.
//!
//! If the scene tiles, the grid is periodic: a row's last stop has the colour of its first, and the last row
//! equals the first.

mod samples;
mod stops;
#[cfg(test)]
mod tests;

use samples::FieldSamples;
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::{Field, Scene, field::Interpolant};

/// Distance of rows, as a share of the distance between control points.
const ROW: f64 = 0.32;
/// Distance of samples along a row, as a share of the distance between control points.
const SAMPLE: f64 = 0.1;
/// Number of samples per column, so that a stop's offset has at most three digits.
const COLUMN: usize = 200;

/// Largest number of stops per square whose side is the distance between control points. At 25 pixels it
/// gives 300 kB of SVG for 1000 × 1000. A field that would need more is fitted again with wider bounds.
const STOPS: f64 = 3.75;
/// Factors by which the bounds are widened, one after another, until few enough stops are left.
const SLACK: [f64; 5] = [1.12, 1.25, 1.45, 1.75, 2.2];

/// The background of a scene, ready to paint.
pub(super) struct PreparedBackground {
    /// Distance of rows, in pixels. The first lies at y = 0, the last at the lower border.
    pub(super) row_height: f64,
    /// Where columns begin, in pixels; the last entry is the right border.
    pub(super) columns: Vec<f64>,
    /// Width of a whole column, in pixels; the last column may be narrower.
    pub(super) column_width: f64,
    /// The rows, each with the stops of each column. A column's first stop lies at its beginning,
    /// its last at the beginning of the next.
    pub(super) rows: Vec<Vec<Vec<RowStop>>>,
    /// The colour of a background of a single colour.
    pub(super) flat: Option<Colour>,
}

/// A colour at a place of a row.
#[derive(Clone, Copy)]
pub(super) struct RowStop {
    /// Pixels from the left border.
    pub(super) x: f64,
    pub(super) colour: Colour,
}

impl PreparedBackground {
    /// Samples and fits a field on the canvas of a scene.
    pub(super) fn new(scene: &Scene, own: &Field) -> Self {
        let field = Interpolant::new(own, scene.width, scene.height, scene.tile);
        let (width, height) = (f64::from(scene.width), f64::from(scene.height));
        if own.points.is_empty() {
            return Self::flat(width, height, own.fallback);
        }
        let spacing = own.spacing.clamp(5.0, 1000.0);
        // Whole and half pixels are short in text.
        let step = libm::round(spacing * SAMPLE * 2.0) / 2.0;
        let last = libm::ceil(width / step) as usize;
        let xs: Vec<f64> = (0..=last).map(|i| (i as f64 * step).min(width)).collect();
        let row_count = libm::ceil(height / (spacing * ROW)).max(1.0) as usize;
        let mut samples = FieldSamples::new(&field, &xs, height, row_count, scene.tile.y);

        let starts: Vec<usize> = (0..last).step_by(COLUMN).collect();
        let most = STOPS * width * height / (spacing * spacing) + (2 * (row_count + 1) * starts.len()) as f64;
        let mut rows = fit(&samples, &xs, &starts);
        for slack in SLACK {
            if rows.iter().flatten().map(Vec::len).sum::<usize>() as f64 <= most {
                break;
            }
            samples.slack = slack;
            rows = fit(&samples, &xs, &starts);
        }
        let mut columns: Vec<f64> = starts.iter().map(|&i| xs[i]).collect();
        columns.push(width);
        let row_height = height / row_count as f64;
        Self { row_height, columns, column_width: step * COLUMN as f64, rows, flat: None }
    }

    /// The grid of a single colour.
    fn flat(width: f64, height: f64, colour: Colour) -> Self {
        let row = vec![vec![RowStop { x: 0.0, colour }, RowStop { x: width, colour }]];
        Self {
            row_height: height,
            columns: vec![0.0, width],
            column_width: width,
            rows: vec![row; 2],
            flat: Some(colour),
        }
    }

    /// sRGB components (0 to 255) of row `k` at each of the ascending places `xs`, in pixels.
    pub(super) fn row(&self, k: usize, xs: &[f64]) -> Vec<[f32; 3]> {
        let stops: Vec<RowStop> = self.rows[k].iter().flatten().copied().collect();
        let mut at = 0;
        xs.iter()
            .map(|&x| {
                while at + 2 < stops.len() && stops[at + 1].x <= x {
                    at += 1;
                }
                let (a, b) = (stops[at], stops[at + 1]);
                let t = if b.x > a.x { ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0) } else { 1.0 };
                let (a, b) = (a.colour.to_f64(), b.colour.to_f64());
                [0, 1, 2].map(|c| (a[c] + (b[c] - a[c]) * t) as f32)
            })
            .collect()
    }
}

/// The stops of all rows and columns; columns begin at the samples `starts`.
fn fit(samples: &FieldSamples, xs: &[f64], starts: &[usize]) -> Vec<Vec<Vec<RowStop>>> {
    let last = xs.len() - 1;
    let mut values = samples.balanced_rows();
    let mut rows = vec![Vec::new(); values.len()];
    for parity in 0..2 {
        let fitted = samples.improve(&mut values, parity, |corridor| {
            let mut line = vec![[0.0; 3]; xs.len()];
            let columns: Vec<Vec<RowStop>> = starts
                .iter()
                .map(|&from| {
                    let to = (from + COLUMN).min(last);
                    stops::fit(&xs[from..=to], &corridor[from..=to], &mut line[from..=to])
                })
                .collect();
            (line, columns)
        });
        for (k, stops) in fitted {
            rows[k] = stops;
        }
    }
    rows
}
