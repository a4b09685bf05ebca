//! Properties of fields of correspondences.

use super::*;
use vtex_base::sampling::{Stream, stream};

/// A page of soft clouds some ten cells across, with fine grain.
fn clouds(size: [usize; 2], seed: u64) -> ExemplarPage {
    let mut random = stream(seed, "correspondence test", 0);
    let centres: Vec<([f64; 2], f64)> = (0..24)
        .map(|_| {
            let at = [random.range(0.0, size[0] as f64), random.range(0.0, size[1] as f64)];
            (at, if random.chance(0.5) { 1.0 } else { -1.0 })
        })
        .collect();
    let value = |x: usize, y: usize, random: &mut Stream| {
        let cloud: f64 = centres
            .iter()
            .map(|(c, sign)| {
                let [dx, dy] = [x as f64 - c[0], y as f64 - c[1]];
                let d2 = dx * dx + dy * dy;
                sign * libm::exp(-d2 / 60.0)
            })
            .sum();
        let light = (1.6 * cloud + random.range(-0.3, 0.3)) as f32;
        [light, 0.3 * light, 0.0, if light > 0.5 { 0.6 } else { -0.6 }, 0.0, 0.0]
    };
    let features = (0..size[1])
        .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
        .map(|(x, y)| value(x, y, &mut random))
        .collect();
    ExemplarPage { group: 0, groups: None, size, features, inside: None, periods: None }
}

fn request<'a>(pages: &'a [ExemplarPage], size: [usize; 2], wrap: [bool; 2], seed: u64) -> CanvasRequest<'a> {
    CanvasRequest { pages, size, wrap, groups: None, active: None, seed }
}

fn light(pages: &[ExemplarPage], s: CellSource) -> f32 {
    let page = &pages[usize::from(s.page)];
    page.features[usize::from(s.at[1]) * page.size[0] + usize::from(s.at[0])][0]
}

/// Standard deviation of the means of blocks.
fn spread(size: [usize; 2], block: usize, value: impl Fn(usize, usize) -> f32) -> f64 {
    let mut means = Vec::new();
    for by in 0..size[1] / block {
        for bx in 0..size[0] / block {
            let cells = (0..block * block).map(|k| value(bx * block + k % block, by * block + k / block));
            means.push(f64::from(cells.sum::<f32>()) / (block * block) as f64);
        }
    }
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    libm::sqrt(means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / means.len() as f64)
}

/// Share of the cells whose right neighbour, across the seam too, continues their source.
fn continued(field: &CorrespondenceField, columns: std::ops::Range<usize>) -> f64 {
    let [w, h] = field.size;
    let (mut all, mut same) = (0, 0);
    for y in 0..h {
        for x in columns.clone() {
            let (a, b) = (field.sources[y * w + x], field.sources[y * w + (x + 1) % w]);
            all += 1;
            same += usize::from(a.page == b.page && a.at[0] + 1 == b.at[0] && a.at[1] == b.at[1]);
        }
    }
    same as f64 / all as f64
}

#[test]
fn islands_are_whole_and_large_contrast_is_kept() {
    for seed in 1..4 {
        let pages = [clouds([120, 100], seed)];
        let field = find(&request(&pages, [150, 130], [false; 2], seed), &()).unwrap();
        assert_eq!(field.sources.len(), 150 * 130);
        assert!(field.sources.iter().all(|s| usize::from(s.at[0]) < 120 && usize::from(s.at[1]) < 100));
        assert!(continued(&field, 0..149) > 0.75, "{}", continued(&field, 0..149));
        let islands = Islands::new(&field);
        assert_eq!(islands.sizes.iter().sum::<u32>(), 150 * 130);
        for block in [8, 16] {
            let own = spread([150, 130], block, |x, y| light(&pages, field.sources[y * 150 + x]));
            let theirs = spread([120, 100], block, |x, y| pages[0].features[y * 120 + x][0]);
            assert!((0.7..1.4).contains(&(own / theirs)), "seed {seed}: blocks of {block}: {}", own / theirs);
        }
    }
}

#[test]
fn all_of_the_exemplar_is_used() {
    let pages = [clouds([100, 100], 5)];
    let field = find(&request(&pages, [200, 200], [false; 2], 5), &()).unwrap();
    let mut used = [0u32; 25];
    for s in &field.sources {
        used[usize::from(s.at[1] / 20) * 5 + usize::from(s.at[0] / 20)] += 1;
    }
    // Each of the 25 has about its share: none is missing and none dominates.
    let share = |n: &u32| f64::from(*n) * 25.0 / 40_000.0;
    assert!(used.iter().all(|n| (0.2..2.6).contains(&share(n))), "{used:?}");
}

#[test]
fn a_torus_has_no_seam() {
    let pages = [clouds([110, 100], 3)];
    // Sizes that no level divides evenly.
    let field = find(&request(&pages, [77, 61], [true, true], 3), &()).unwrap();
    let (across, inside) = (continued(&field, 76..77), continued(&field, 0..76));
    assert!(across > 0.5 * inside, "{across} {inside}");
}

#[test]
fn cells_take_their_source_from_their_group() {
    let mut pages = [clouds([80, 80], 1), clouds([60, 90], 2)];
    pages[1].group = 1;
    let groups: Vec<u8> = (0..100 * 60).map(|i| u8::from(i % 100 >= 50)).collect();
    let field =
        find(&CanvasRequest { groups: Some(groups), ..request(&pages, [100, 60], [false; 2], 4) }, &());
    for (i, s) in field.unwrap().sources.iter().enumerate() {
        assert_eq!(usize::from(s.page), usize::from(i % 100 >= 50), "cell {i}");
    }
}

#[test]
fn parts_of_pages_that_are_no_sources_are_left_out() {
    let mut pages = [clouds([90, 90], 7)];
    let inside = |i: usize| (i % 90).abs_diff(45) + (i / 90).abs_diff(45) < 40;
    pages[0].inside = Some((0..90 * 90).map(inside).collect());
    let field = find(&request(&pages, [70, 70], [false; 2], 1), &()).unwrap();
    let outside = field.sources.iter().filter(|s| !inside(usize::from(s.at[1]) * 90 + usize::from(s.at[0])));
    assert_eq!(outside.count(), 0);
}

#[test]
fn the_same_for_one_seed_and_another_for_another() {
    let pages = [clouds([64, 64], 2)];
    let sources = |seed| find(&request(&pages, [80, 50], [true, false], seed), &()).unwrap().sources;
    assert_eq!(sources(1), sources(1));
    assert_ne!(sources(1), sources(2));
}

#[test]
fn any_size_is_filled() {
    for (page, size) in [([1, 1], [1, 1]), ([3, 40], [9, 2]), ([40, 3], [1, 70]), ([700, 6], [30, 30])] {
        for wrap in [[false; 2], [true; 2]] {
            let pages = [clouds(page, 1)];
            let field = find(&request(&pages, size, wrap, 1), &()).unwrap();
            assert_eq!(field.sources.len(), size[0] * size[1]);
            let within = |s: &CellSource| (0..2).all(|k| usize::from(s.at[k]) < page[k]);
            assert!(field.sources.iter().all(within), "{page:?} {size:?}");
        }
    }
}

#[test]
fn what_is_not_active_changes_little_of_the_rest() {
    let pages = [clouds([100, 90], 6)];
    let active: Vec<bool> = (0..120 * 80).map(|i| i % 120 < 60).collect();
    let field =
        find(&CanvasRequest { active: Some(active), ..request(&pages, [120, 80], [false; 2], 1) }, &())
            .unwrap();
    assert!(continued(&field, 0..58) > 0.7, "{}", continued(&field, 0..58));
    let own = spread([56, 80], 8, |x, y| light(&pages, field.sources[y * 120 + x]));
    let theirs = spread([100, 90], 8, |x, y| pages[0].features[y * 100 + x][0]);
    assert!((0.6..1.5).contains(&(own / theirs)), "{}", own / theirs);
}

#[test]
fn a_field_does_not_depend_on_what_was_prepared_before() {
    let pages = [2, 3].map(|seed| [clouds([64, 64], seed)]);
    let memory = PagesMemory::default();
    for (k, size) in [(0, [80, 50]), (0, [40, 60]), (1, [80, 50]), (0, [80, 50])] {
        let request = request(&pages[k], size, [true, false], 7);
        let remembered = find_again(&request, Some(&memory), &()).unwrap();
        assert_eq!(remembered.sources, find(&request, &()).unwrap().sources);
        let stopped = find_again(&request, Some(&memory), &vtex_testing::StopAtOnce);
        assert!(matches!(stopped, Err(vtex_base::Error::Interrupted)));
    }
}

#[test]
fn it_can_be_stopped() {
    let pages = [clouds([64, 64], 2)];
    let stopped = find(&request(&pages, [50, 50], [false; 2], 1), &vtex_testing::StopAtOnce);
    assert!(matches!(stopped, Err(vtex_base::Error::Interrupted)));
}

#[test]
fn offsets_keep_to_periods() {
    // A page of stripes 9 cells apart, on uneven ground.
    let stripes = |seed: u64| {
        let mut page = clouds([120, 100], seed);
        for (i, feature) in page.features.iter_mut().enumerate() {
            feature[2] = if (i / 120) % 9 < 2 { 2.0 } else { 0.0 };
        }
        page
    };
    let waves = [[0.0, 1.0 / 9.0], [0.0; 2]];
    let periods = Periods {
        vectors: [[0.0, 9.0], [0.0; 2]],
        page: waves,
        canvas: waves,
        margin: [0.0; 2],
        tolerance: 0.0,
    };
    let off = |page: ExemplarPage| {
        let pages = [page];
        let field = find(&request(&pages, [130, 110], [false; 2], 4), &()).unwrap();
        let misses = |(i, s): (usize, &CellSource)| {
            let d = (i32::from(s.at[1]) - (i / 130) as i32).rem_euclid(9);
            d.min(9 - d) > 1
        };
        field.sources.iter().enumerate().filter(|&p| misses(p)).count() as f64 / field.sources.len() as f64
    };
    let bound = ExemplarPage { periods: Some(periods), ..stripes(4) };
    assert!(off(bound) < 0.01);
}

#[test]
fn places_come_back_less_near_themselves() {
    // Uniform ground: all places are equally good.
    let mut page = clouds([160, 140], 9);
    let mut random = stream(9, "correspondence test", 1);
    page.features.iter_mut().for_each(|f| *f = [random.range(-1.0, 1.0) as f32, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let pages = [page];
    let field = find(&request(&pages, [140, 120], [false; 2], 2), &()).unwrap();
    // Pairs of cells in a row, 4 to 20 cells apart, whose sources are equal or adjacent.
    let [w, h] = field.size;
    let mut pairs = 0;
    for y in 0..h {
        for x in 0..w - 20 {
            let own = field.sources[y * w + x].at;
            let near = |d: usize| {
                let other = field.sources[y * w + x + d].at;
                own[0].abs_diff(other[0]) <= 1 && own[1].abs_diff(other[1]) <= 1
            };
            pairs += usize::from((4..20).any(near));
        }
    }
    let share = pairs as f64 / (w * h) as f64;
    assert!(share < 0.05, "{share}");
}

#[test]
fn a_canvas_no_larger_than_the_exemplar_shows_few_places_twice() {
    let (side, near) = (250, 38);
    let (mut copies, mut cells) = (0, 0);
    for seed in 1..3 {
        let pages = [clouds([side, side], seed)];
        let field = find(&request(&pages, [side, side], [false; 2], seed), &()).unwrap();
        let mut by_source = vec![Vec::new(); side * side];
        for (i, s) in field.sources.iter().enumerate() {
            by_source[usize::from(s.at[1]) * side + usize::from(s.at[0])].push([i % side, i / side]);
        }
        let is_near = |a: [usize; 2], b: [usize; 2]| a != b && (0..2).all(|k| a[k].abs_diff(b[k]) < near);
        let twice = by_source.iter().flat_map(|at| at.iter().filter(|&&a| at.iter().any(|&b| is_near(a, b))));
        copies += twice.count();
        cells += side * side;
    }
    assert!(100 * copies < 28 * cells, "{copies} of {cells}");
}
