//! The figures of docs/measurements/composable.md, measured on libraries and scenes in a folder.

use crate::edit::{Action, Files, Operation, Within, apply};
use crate::transfer::tests::{mean, median_shift};
use crate::transfer::{TransferParams, transfer};
use std::path::PathBuf;
use vtex_arrange::synth::reconstruct;
use vtex_base::geometry::{Interior, Outline, Point};
use vtex_scene::element::Gaussian;
use vtex_scene::library::Library;
use vtex_scene::scene::{Role, Scene, TransferMode};

/// Samples in a standard deviation.
const FINE: f64 = 15.0;

/// Covariance of an outline by counting samples, and the overlap (intersection over union) of the outline
/// with its ellipse of two standard deviations.
fn counted(outline: &Outline, gaussian: &Gaussian) -> ([f64; 3], f64) {
    let region = Interior::new(outline);
    let bounds = outline.bounds().inflate(gaussian.deviations()[0], gaussian.deviations()[0]);
    let mut sums = [0.0; 6];
    let [mut both, mut any] = [0.0; 2];
    let step = gaussian.deviations()[1] / FINE;
    let steps =
        |from: f64, to: f64| (0..((to - from) / step) as usize).map(move |k| from + (k as f64 + 0.5) * step);
    for y in steps(bounds.y0, bounds.y1) {
        for x in steps(bounds.x0, bounds.x1) {
            let p = Point::new(x, y);
            let (inside, within) = (region.contains(p), gaussian.at(p) >= libm::exp(-4.0));
            both += f64::from(u8::from(inside && within));
            any += f64::from(u8::from(inside || within));
            if inside {
                let (x, y) = (x - gaussian.mean.x, y - gaussian.mean.y);
                let parts = [1.0, x, y, x * x, x * y, y * y];
                sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            }
        }
    }
    let [n, x, y, xx, xy, yy] = sums;
    let (x, y) = (x / n, y / n);
    ([xx / n - x * x, xy / n - x * y, yy / n - y * y], both / any)
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The area of an outline as a share of that of its convex hull.
fn solidity(outline: &Outline) -> f64 {
    let mut points: Vec<Point> = outline.polygons(0.1).into_iter().flatten().collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut hull: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = hull[..]
                && (b - a).cross(p - b) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull
    };
    let [lower, upper] = [chain(&mut points.iter().copied()), chain(&mut points.iter().rev().copied())];
    let hull: Vec<Point> = lower.into_iter().chain(upper).collect();
    let pairs = hull.iter().zip(hull.iter().cycle().skip(1));
    let area = pairs.map(|(a, b)| a.to_vec2().cross(b.to_vec2())).sum::<f64>() / 2.0;
    outline.area().abs() / area
}

fn edited(scene: &Scene, action: Action) -> Scene {
    let operation = Operation { layer: Some("primary".into()), ..action.into() };
    apply(scene.clone(), &[operation], &Files::default(), Some(1)).unwrap().0
}

/// The medians of the primaries.
fn medians(scene: &Scene) -> Vec<[f32; 3]> {
    let roles = scene.roles();
    roles.zip(scene.appearances()).filter(|(r, _)| *r == Role::Primary).map(|(_, a)| a.median).collect()
}

fn variance(scene: &Scene) -> f64 {
    let (all, mean) = (medians(scene), mean(scene, &[Role::Primary]));
    let square = |lab: &[f32; 3]| (0..3).map(|k| f64::from(lab[k]) - mean[k]).map(|d| d * d).sum::<f64>();
    all.iter().map(square).sum::<f64>() / all.len() as f64
}

fn vary(colour: Option<f64>, shape: Option<f64>) -> Action {
    Action::Vary { colour: colour.map(Into::into), shape: shape.map(Into::into), within: Within::Layer }
}

/// `VTEX_FIGURES=folder cargo test --release -p vtex-edit figures -- --ignored --nocapture`, with a NAME.lib.json
/// and a NAME.scene.json for each exemplar.
#[test]
#[ignore = "reads libraries and scenes from a folder"]
fn figures() {
    let folder = PathBuf::from(std::env::var("VTEX_FIGURES").unwrap());
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .filter_map(|e| Some(e.unwrap().file_name().to_str()?.strip_suffix(".lib.json")?.to_owned()))
        .collect();
    names.sort();
    let scene = |name: &str| Scene::read(&folder.join(format!("{name}.scene.json"))).unwrap();
    let library = |name: &str| Library::read(&folder.join(format!("{name}.lib.json"))).unwrap();
    for (k, name) in names.iter().enumerate() {
        let (own, library) = (scene(name), library(&names[(k + 1) % names.len()]));
        let elements = own.individuals().map(|i| own.element(i)).take(200);
        let pairs =
            elements.filter_map(|e| Some((e.outline(), e.gaussian()?))).filter(|(_, g)| !g.is_degenerate());
        let counts: Vec<(f64, (f64, bool))> = pairs
            .map(|(outline, g)| {
                let (counted, overlap) = counted(outline, &g);
                let trace = g.covariance[0] + g.covariance[2];
                let off = counted.iter().zip(g.covariance).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                (off / trace, (overlap, solidity(outline) >= 0.9))
            })
            .collect();
        let (off, overlaps): (Vec<f64>, Vec<(f64, bool)>) = counts.into_iter().unzip();
        let of =
            |solid: bool| -> Vec<f64> { overlaps.iter().filter(|o| o.1 == solid).map(|o| o.0).collect() };
        println!(
            "{name}: N1 moments differ by {:.4} (median) and {:.4} (at most), overlap with the ellipse {:.3}; \
             of {} shapes that fill their hull {:.3}, of {} others {:.3}",
            middle(off.clone()),
            off.iter().copied().fold(0.0, f64::max),
            middle(overlaps.iter().map(|o| o.0).collect()),
            of(true).len(),
            middle(of(true)),
            of(false).len(),
            middle(of(false))
        );
        let shuffled = edited(&own, Action::Shuffle { within: Within::Layer, share: 1.0, outlines: false });
        let same_outlines = own.instances().zip(shuffled.instances()).all(|(a, b)| {
            own.element(a).outline() == shuffled.element(b).outline() && a.transform == b.transform
        });
        let changed = medians(&own).iter().zip(medians(&shuffled)).filter(|(a, b)| **a != *b).count();
        let share = changed as f64 / medians(&own).len() as f64;
        println!(
            "  N4 outlines equal {same_outlines}, appearance changed {share:.3}, mean colours apart {:.4}",
            median_shift(&own, &shuffled)
        );
        for factor in [0.0, 0.5, 1.5, 2.0] {
            let ratio = variance(&edited(&own, vary(Some(factor), None))) / variance(&own);
            println!("  N9 factor {factor}: variance {ratio:.4}, wanted {:.4}", factor * factor);
        }
        let alike = edited(&own, vary(None, Some(0.0)));
        let all: Vec<[f64; 3]> = individual(&alike).iter().flatten().map(|g| g.covariance).collect();
        let trace = all[0][0] + all[0][2];
        // Elements that are too thin do not change.
        let sound: Vec<bool> = individual(&own).iter().map(Option::is_some).collect();
        let kept = individual(&alike);
        let spread = kept
            .iter()
            .zip(&sound)
            .filter(|(_, s)| **s)
            .filter_map(|(g, _)| *g)
            .map(|g| (0..3).map(|k| (g.covariance[k] - all[0][k]).abs()).fold(0.0, f64::max) / trace);
        println!("  N10 factor 0: covariances differ by {:.5} at most", spread.fold(0.0, f64::max));
        let other = reconstruct(&library);
        for mode in [TransferMode::Mean, TransferMode::Replace] {
            let params = TransferParams { mode, ..TransferParams::default() };
            let (after, report) = transfer(&own, std::slice::from_ref(&other), &[], &params).unwrap();
            let (got, wanted) = (mean(&after, &[Role::Primary]), mean(&other, &[Role::Primary]));
            let far: f64 = (0..3).map(|k| got[k] - wanted[k]).map(|d| d * d).sum();
            println!(
                "  N5 {mode:?} from {}: mean colours apart {:.4}, {report:?}",
                library.source.file,
                libm::sqrt(far)
            );
        }
        let area = |s: &Scene| individual(s).iter().flatten().map(Gaussian::size).sum::<f64>();
        for scale in [2.0 / 3.0, 4.0 / 9.0] {
            let params = TransferParams { scale, ..TransferParams::default() };
            let after = transfer(&own, std::slice::from_ref(&other), &[], &params).unwrap().0;
            println!(
                "  N8 scale {scale:.3}: areas {:.3}, wanted {:.3}",
                area(&after) / area(&own),
                scale * scale
            );
        }
    }
}

/// The Gaussians of the primaries.
fn individual(scene: &Scene) -> Vec<Option<Gaussian>> {
    let roles = scene.roles();
    roles.zip(scene.gaussians()).filter(|(r, _)| *r == Role::Primary).map(|(_, g)| g).collect()
}
