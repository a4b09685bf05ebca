use super::*;
use crate::segment::{Regions, Segmenter};
use image::Rgb;
use vtex_base::raster::Span;
use vtex_base::sampling::stream;

const SIZE: i32 = 400;
/// Length and height of a brick with its joint, and the width of a joint.
const LENGTH: i32 = 80;
const HEIGHT: i32 = 40;
const JOINT: i32 = 8;

/// The first pixel of a brick of a row.
fn start(row: i32, brick: i32) -> [i32; 2] {
    [brick * LENGTH + (row % 2) * LENGTH / 2 - LENGTH, row * HEIGHT]
}

fn rectangle([x, y]: [i32; 2], width: i32, height: i32) -> Mask {
    let spans = (y..y + height).map(|y| Span { y, x0: x.clamp(0, SIZE), x1: (x + width).clamp(0, SIZE) });
    Mask::from_spans(spans.collect())
}

fn bricks() -> Vec<Mask> {
    let places =
        (0..SIZE / HEIGHT).flat_map(|row| (0..=SIZE / LENGTH + 1).map(move |brick| start(row, brick)));
    let masks = places.map(|place| rectangle(place, LENGTH - JOINT, HEIGHT - JOINT));
    masks.filter(|mask| !mask.is_empty()).collect()
}

/// A wall in which each brick has a dark and a bright half of any colours, and its patches as masks: both halves of each
/// brick, and pieces of joints.
fn wall() -> (RgbImage, Vec<ScoredMask>) {
    let mut random = stream(3, "courses", 0);
    let mut noise = |v: i32| Rgb([0, 1, 2].map(|_| (v + random.index(9) as i32) as u8));
    let mut picture = RgbImage::from_fn(SIZE as u32, SIZE as u32, |_, _| noise(118));
    let mut masks = Vec::new();
    let mut random = stream(4, "courses", 0);
    let mut add = |mask: Mask| masks.push(ScoredMask { mask, score: 0.5 });
    for row in 0..SIZE / HEIGHT {
        add(rectangle([30 * (row % 5), row * HEIGHT + HEIGHT - JOINT], 200, JOINT));
        for brick in 0..=SIZE / LENGTH + 1 {
            let [x, y] = start(row, brick);
            let first = 20 + random.index(30) as i32;
            let halves = [(x, first), (x + first, LENGTH - JOINT - first)];
            for (half, (x, width)) in halves.into_iter().enumerate() {
                let mask = rectangle([x, y], width, HEIGHT - JOINT);
                let base = [140 + 60 * (1 - half as i32), 40 + random.index(60) as i32, 30];
                for (px, py) in mask.pixels() {
                    let colour = base.map(|v| (v + random.index(30) as i32) as u8);
                    picture.put_pixel(px as u32, py as u32, Rgb(colour));
                }
                if !mask.is_empty() {
                    add(mask);
                }
            }
        }
    }
    (picture, masks)
}

fn are_bricks(found: &[ScoredMask]) {
    let bricks = bricks();
    let iou = |a: &Mask, b: &Mask| {
        let both = f64::from(a.overlap(b));
        both / (f64::from(a.area() + b.area()) - both)
    };
    let whole = |brick: &&Mask| found.iter().any(|one| iou(&one.mask, brick) > 0.85);
    let count = bricks.iter().filter(whole).count();
    assert!(count * 10 >= bricks.len() * 9, "{count} of {}", bricks.len());
    assert!(found.len() <= bricks.len() + 3, "{} of {}", found.len(), bricks.len());
}

#[test]
fn bricks_of_two_colours_are_one_element_each() {
    let (picture, patches) = wall();
    assert!(patches.len() > bricks().len() + 3);
    are_bricks(&whole_cells(patches, &picture));
}

#[test]
fn segmenters_give_whole_bricks() {
    are_bricks(&Regions.segment(&wall().0, &()).unwrap());
}

#[test]
fn pictures_without_rows_or_without_clear_joints_keep_their_masks() {
    let (mut picture, patches) = wall();
    let mut random = stream(5, "courses", 0);
    let plain =
        RgbImage::from_fn(SIZE as u32, SIZE as u32, |_, _| Rgb([0; 3].map(|_: u8| random.index(256) as u8)));
    assert!(whole_cells(patches.clone(), &plain) == patches);
    // Joints of as many colours as bricks.
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        if (y as i32 % HEIGHT) >= HEIGHT - JOINT {
            let tone = (x / 7 * 37 + y / 40 * 91) % 200;
            *pixel = Rgb([tone as u8, 220 - tone as u8, (tone / 2) as u8]);
        }
    }
    assert!(whole_cells(patches.clone(), &picture) == patches);
}

#[test]
fn plates_between_wide_gaps_are_no_bricks() {
    // Discs in rows: what lies between them is no joint of a wall.
    let mut random = stream(6, "courses", 0);
    let mut picture =
        RgbImage::from_fn(SIZE as u32, SIZE as u32, |_, _| Rgb([100 + random.index(9) as u8; 3]));
    let mut masks = Vec::new();
    for k in 0..50 {
        let [x, y] = [40 * (k % 5) * 2 + 40, 40 * (k / 5) + 12];
        let spans = (-12..=12i32).map(|dy| {
            let half = f64::from(144 - dy * dy).sqrt() as i32;
            Span { y: y + dy, x0: x - half, x1: x + half + 1 }
        });
        let mask = Mask::from_spans(spans.collect()).within([0, 0], [SIZE, SIZE]);
        let tone = 20 + (k * 53 % 200) as u8;
        mask.pixels().for_each(|(x, y)| picture.put_pixel(x as u32, y as u32, Rgb([tone, tone / 2, 10])));
        masks.push(ScoredMask { mask, score: 0.5 });
    }
    assert!(whole_cells(masks.clone(), &picture) == masks);
}
