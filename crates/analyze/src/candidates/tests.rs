//! Selection among overlapping masks, on scenes whose true instances are known.

use super::*;
use vtex_base::raster::Span;
use vtex_base::sampling::stream;
use vtex_testing::{SceneParams, generate};

/// True masks of at least 30 px with a score.
fn truth(instances: &LabelMap) -> Vec<ScoredMask> {
    let count = instances.labels.iter().max().map_or(0, |m| *m as usize) + 1;
    let masks = Mask::all_of_labels(instances, count).into_iter().skip(1);
    let largest =
        masks.filter_map(|m| components_of_mask(&m, Connectivity::Four).into_iter().max_by_key(Mask::area));
    largest.filter(|m| m.area() >= 30).map(|mask| ScoredMask { mask, score: 0.9 }).collect()
}

/// The pixels of a box as a mask.
fn block(x0: i32, y0: i32, x1: i32, y1: i32) -> Mask {
    Mask::from_spans((y0..y1).map(|y| Span { y, x0, x1 }).collect())
}

/// Share of the true masks found with IoU of at least 0.7.
fn found(truth: &[ScoredMask], map: &LabelMap) -> f64 {
    let count = map.labels.iter().max().map_or(0, |m| *m as usize) + 1;
    let got = Mask::all_of_labels(map, count);
    let hit = truth.iter().filter(|t| {
        got.iter().skip(1).any(|g| {
            let common = f64::from(t.mask.overlap(g));
            common >= 0.7 * (f64::from(t.mask.area()) + f64::from(g.area()) - common)
        })
    });
    hit.count() as f64 / truth.len() as f64
}

#[test]
fn stray_masks_do_not_swallow_true_ones() {
    let (mut sum, mut scenes, mut covered, mut background_area) = (0.0, 0.0, 0, 0);
    for seed in 0..60 {
        let scene = generate(&SceneParams::random(900 + seed, 160, 160)).unwrap();
        let truth = truth(&scene.instances);
        if truth.len() < 8 {
            continue;
        }
        let mut random = stream(seed, "test/candidates", 0);
        let mut masks = truth.clone();
        // A segmenter that tries every point also finds the background with and without the objects,
        // patches of background with objects, clumps, halves, and slightly enlarged objects.
        let background = Mask::from_labels(&scene.instances, |l| l == 0);
        masks.push(ScoredMask { mask: background.clone(), score: 0.95 });
        masks.push(ScoredMask { mask: block(0, 0, 160, 160), score: 0.95 });
        masks.push(ScoredMask { mask: block(20, 20, 140, 140), score: 0.95 });
        for _ in 0..4 {
            let (x, y) = (random.below(90) as i32, random.below(90) as i32);
            masks.push(ScoredMask { mask: block(x + 3, y + 3, x + 60, y + 60), score: 0.95 });
        }
        for t in truth.iter().step_by(3) {
            let half: Vec<Span> = t.mask.spans()[..t.mask.spans().len() / 2].to_vec();
            masks.push(ScoredMask { mask: Mask::from_spans(half), score: 0.7 });
            let grown = t.mask.spans().iter().flat_map(|s| {
                let (x0, x1) = ((s.x0 - 1).max(0), (s.x1 + 1).min(160));
                [-1, 0, 1].map(|dy| Span { y: (s.y + dy).clamp(0, 159), x0, x1 })
            });
            masks.push(ScoredMask { mask: Mask::from_spans(grown.collect()), score: 0.7 });
        }
        let map = select(&scene.image, &masks, 5);
        let on_background = background.pixels().filter(|&(x, y)| map.get(x as u32, y as u32) != 0).count();
        covered += on_background;
        background_area += background.area();
        sum += found(&truth, &map);
        scenes += 1.0;
    }
    assert!(scenes >= 40.0);
    let (recall, background) = (sum / scenes, covered as f64 / f64::from(background_area));
    assert!(recall >= 0.93, "true textons kept: {recall}");
    assert!(background <= 0.12, "background taken for textons: {background}");
}

#[test]
fn a_flower_is_kept_over_its_petals() {
    // Five white petals around a disc on green.
    let mut image = RgbImage::from_pixel(80, 80, image::Rgb([40, 110, 30]));
    let mut parts = Vec::new();
    for k in 0..5 {
        let angle = f64::from(k) * std::f64::consts::TAU / 5.0;
        let (cx, cy) = (40.0 + 11.0 * libm::cos(angle), 40.0 + 11.0 * libm::sin(angle));
        let disc = |x: i32, y: i32| libm::hypot(f64::from(x) - cx, f64::from(y) - cy) < 8.5;
        let spans = (0..80)
            .flat_map(|y| (0..80).filter(move |&x| disc(x, y)).map(move |x| Span { y, x0: x, x1: x + 1 }));
        parts.push(Mask::from_spans(spans.collect()));
    }
    let whole = Mask::from_spans(parts.iter().flat_map(|m| m.spans()).copied().collect());
    for (k, part) in parts.iter().enumerate() {
        for (x, y) in part.pixels() {
            let tone = 225 + 5 * k as u8;
            image.put_pixel(x as u32, y as u32, image::Rgb([tone, tone, tone - 10]));
        }
    }
    let masks: Vec<ScoredMask> =
        parts.iter().chain([&whole]).map(|mask| ScoredMask { mask: mask.clone(), score: 0.9 }).collect();
    let map = select(&image, &masks, 5);
    assert_eq!(map.labels.iter().max(), Some(&1));
    let taken = map.labels.iter().filter(|&&l| l == 1).count();
    assert!(taken as f64 > 0.9 * f64::from(whole.area()));
}

#[test]
fn pieces_are_filled_and_crumbs_dropped() {
    let mut spans = block(10, 10, 30, 30).spans().to_vec();
    spans.retain(|s| s.y != 20);
    spans.extend([
        Span { y: 20, x0: 10, x1: 19 },
        Span { y: 20, x0: 21, x1: 30 },
        Span { y: 35, x0: 2, x1: 9 },
    ]);
    let scored = ScoredMask { mask: Mask::from_spans(spans), score: 1.0 };
    let pieces = pieces(&scored, 5, 60, 60);
    assert_eq!(pieces.len(), 1);
    assert_eq!(pieces[0].0, block(10, 10, 30, 30));
}
