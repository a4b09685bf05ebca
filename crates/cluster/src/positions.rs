//! Places of samples by least squares: every matched pair asks for the way between its matches (equation 18 of the
//! paper).
//!
//! The unknowns are displacements, so a torus needs no care. The normal equations are solved by conjugate gradients.

use crate::input::InputSamples;
use crate::matching::NONE;
use crate::output::OutputSamples;
use crate::search::Matches;
use vtex_base::error::Result;

/// Most steps of the solver, and the residual that ends it, as a share of the first.
const STEPS: usize = 40;
const RESIDUAL: f64 = 1e-3;
/// Weight of staying, as a share of a sample's own equations: without it the whole may drift.
const STAY: f64 = 1e-3;

/// Moves samples to where matched neighbourhoods want them.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn improve_positions(
    output: &mut OutputSamples,
    input: &InputSamples,
    matches: &Matches,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let near = &matches.near;
    let count = near.len();
    let mut degree = vec![0.0; count];
    let mut right = vec![[0.0; 2]; count];
    for s in 0..count {
        let source = input.points[output.source[s] as usize];
        for k in near.range(s).filter(|&k| matches.matched[k] != NONE) {
            let (other, way) = (near.ids[k] as usize, near.ways[k]);
            let wanted = input.plane.between(source, input.points[matches.matched[k] as usize]);
            degree[s] += 1.0;
            degree[other] += 1.0;
            for i in 0..2 {
                let off = wanted[i] - way[i];
                right[other][i] += off;
                right[s][i] -= off;
            }
        }
    }
    let diagonal: Vec<f64> = degree.iter().map(|d| d * (1.0 + STAY) + STAY).collect();
    let product = |of: &[[f64; 2]], to: &mut Vec<[f64; 2]>| {
        for s in 0..count {
            to[s] = [diagonal[s] * of[s][0], diagonal[s] * of[s][1]];
        }
        for s in 0..count {
            let mut own = [0.0; 2];
            for k in near.range(s).filter(|&k| matches.matched[k] != NONE) {
                let other = near.ids[k] as usize;
                for i in 0..2 {
                    own[i] += of[other][i];
                    to[other][i] -= of[s][i];
                }
            }
            (0..2).for_each(|i| to[s][i] -= own[i]);
        }
    };
    let dot = |a: &[[f64; 2]], b: &[[f64; 2]]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum()
    };
    let scaled = |v: &[[f64; 2]]| -> Vec<[f64; 2]> {
        v.iter().zip(&diagonal).map(|(v, d)| [v[0] / d, v[1] / d]).collect()
    };
    let mut moved = vec![[0.0; 2]; count];
    let mut rest = right;
    let mut direction = scaled(&rest);
    let mut size = dot(&rest, &direction);
    let enough = size * RESIDUAL * RESIDUAL;
    let mut image = vec![[0.0; 2]; count];
    for _ in 0..STEPS {
        if size <= enough || size <= 1e-12 {
            break;
        }
        go_on()?;
        product(&direction, &mut image);
        let step = size / dot(&direction, &image).max(1e-300);
        for s in 0..count {
            for i in 0..2 {
                moved[s][i] += step * direction[s][i];
                rest[s][i] -= step * image[s][i];
            }
        }
        let next = scaled(&rest);
        let now = dot(&rest, &next);
        let turn = now / size;
        for s in 0..count {
            (0..2).for_each(|i| direction[s][i] = next[s][i] + turn * direction[s][i]);
        }
        size = now;
    }
    for (p, by) in output.points.iter_mut().zip(&moved) {
        *p = output.plane.wrapped([p[0] + by[0], p[1] + by[1]]);
    }
    Ok(())
}
