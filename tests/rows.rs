//! Rows of a photograph in its textures: joints run on, and those between the elements of a row stay as wide as they are.

use image::{Rgb, RgbImage};
use vtex::Progress;
use vtex::analyze::{AnalyzeParams, Exemplar, analyze};
use vtex::library::Library;
use vtex::output::png;
use vtex::raster::Mask;
use vtex::sampling::{Stream, stream};
use vtex::scene::SynthParams;
use vtex::segment::{ScoredMask, Segmenter};
use vtex::synth::synthesize;

const SIDE: u32 = 400;

/// A segmenter that knows the elements.
struct Known(Vec<Mask>);

impl Segmenter for Known {
    fn name(&self) -> String {
        "known".into()
    }

    fn segment(&self, _: &RgbImage, _: &dyn Progress) -> vtex::Result<Vec<ScoredMask>> {
        Ok(self.0.iter().map(|mask| ScoredMask { mask: mask.clone(), score: 1.0 }).collect())
    }
}

/// A picture of rectangles, each left, top, width, height and colour, over a colour with grain.
fn picture(ground: [u8; 3], rectangles: &[([u32; 4], [u8; 3])], random: &mut Stream) -> Library {
    let mut grained = |colour: [u8; 3]| {
        let grain = random.range(-9.0, 9.0);
        Rgb(colour.map(|c| (f64::from(c) + grain).clamp(0.0, 255.0) as u8))
    };
    let mut image = RgbImage::from_fn(SIDE, SIDE, |_, _| grained(ground));
    let mut masks = Vec::new();
    for &([left, top, width, height], colour) in rectangles {
        let [right, bottom] = [left + width, top + height].map(|v| v.min(SIDE));
        let pixels = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
        pixels.for_each(|(x, y)| image.put_pixel(x, y, grained(colour)));
        let spans =
            (top..bottom).map(|y| vtex::raster::Span { y: y as i32, x0: left as i32, x1: right as i32 });
        masks.push(Mask::from_spans(spans.collect()));
    }
    let exemplar = Exemplar::from_image(image.into(), "rows").unwrap();
    analyze(&exemplar, &Known(masks), &AnalyzeParams::default(), &()).unwrap()
}

/// The lightness of a texture's picture, row by row.
fn drawn(library: &Library, size: [u32; 2], seed: u64) -> Vec<Vec<u8>> {
    let params = SynthParams { width: size[0], height: size[1], seed, ..SynthParams::default() };
    let picture = png::over_white(&png::render(&synthesize(library, &params, &()).unwrap(), 1.0).unwrap());
    picture.rows().map(|row| row.map(|p| p.0[1]).collect()).collect()
}

#[test]
fn gaps_between_planks_run_on() {
    let mut random = stream(1, "planks", 0);
    let mut gaps = Vec::new();
    // Uneven rows, gaps in pieces, half of them faint.
    for k in 0..7u32 {
        let (top, mut left) = (26 + 57 * k + [0, 4, 1, 5, 2, 3, 0][k as usize], 0);
        let colour = if k % 2 == 0 { [14, 12, 10] } else { [44, 40, 36] };
        while left < SIDE {
            let length = random.range(70.0, 130.0) as u32;
            gaps.push(([left, top, length, 6], colour));
            left += length + 2;
        }
    }
    let library = picture([150, 160, 170], &gaps, &mut random);
    let lattice = library.lattice.as_ref().expect("rows are seen");
    assert!(lattice.vectors.len() == 1 && (lattice.vectors[0][1].abs() - 57.0).abs() < 1.5, "{lattice:?}");
    let picture = drawn(&library, [700, 400], 3);
    // The middle of each gap in each column; gaps are at the rows that are darkest on average.
    let dark = |x: usize, y: usize| picture[y][x] < 100;
    let middle = |x: usize, around: usize| {
        let rows: Vec<usize> = (around - 14..around + 14).filter(|&y| dark(x, y)).collect();
        (!rows.is_empty()).then(|| rows.iter().sum::<usize>() as f64 / rows.len() as f64)
    };
    let share = |y: usize| (0..700).filter(|&x| dark(x, y)).count();
    let mut gaps: Vec<usize> = Vec::new();
    for y in 20..380 {
        let most = (y - 14..=y + 14).map(&share).max().unwrap();
        if share(y) == most && most > 200 && gaps.last().is_none_or(|last| y - last > 20) {
            gaps.push(y);
        }
    }
    assert!((5..=7).contains(&gaps.len()), "{gaps:?}");
    for gap in gaps {
        let columns: Vec<Option<f64>> = (0..700).map(|x| middle(x, gap)).collect();
        let missing = columns.iter().filter(|middle| middle.is_none()).count();
        let steps =
            columns.windows(2).filter(|pair| matches!(pair, [Some(a), Some(b)] if (a - b).abs() > 1.5));
        // Pieces are 2 px apart in the photograph: some 2 % of the columns. Runs meet once in 700 px.
        assert!(missing < 40 && steps.count() <= 3, "{gap}: {missing} columns are empty");
    }
}

#[test]
fn joints_between_bricks_stay_as_wide_as_they_are() {
    let mut random = stream(2, "bricks", 0);
    let mut bricks = Vec::new();
    for k in 0..10u32 {
        let mut left = (random.unit() * 40.0) as u32;
        while left < SIDE {
            let length = random.range(40.0, 80.0) as u32;
            let tone = random.range(-30.0, 30.0);
            bricks.push(([left, 4 + 40 * k, length, 35], [130.0, 70.0, 50.0].map(|c| (c + tone) as u8)));
            left += length + 5;
        }
    }
    let library = picture([225, 220, 210], &bricks, &mut random);
    assert_eq!(library.lattice.as_ref().map(|lattice| lattice.vectors.len()), Some(1));
    let picture = drawn(&library, [600, 600], 4);
    // Runs of light pixels along the middles of rows, which are darkest on average.
    let light = |x: usize, y: usize| picture[y][x] > 150;
    let mut widths = Vec::new();
    for y in 0..600 {
        let lights: Vec<bool> = (0..600).map(|x| light(x, y)).collect();
        if lights.iter().filter(|light| **light).count() > 120 {
            continue;
        }
        widths.extend(lights.chunk_by(|a, b| a == b).filter(|run| run[0]).map(<[bool]>::len));
    }
    let even = widths.iter().filter(|width| (3..=8).contains(*width)).count();
    assert!(widths.len() > 2000 && even as f64 > 0.8 * widths.len() as f64, "{even} of {}", widths.len());
}
