//! Pictures of lines drawn, lit unevenly and made noisy, then read.

use super::{read, shows_lines};
use image::{Rgb, RgbImage};
use kurbo::{BezPath, Circle, Point, Shape};
use resvg::usvg;
use std::f64::consts::TAU;
use tiny_skia::{Paint, Pixmap, Stroke, Transform};
use vtex_base::error::Error;
use vtex_base::raster::squared_distance;
use vtex_base::sampling::stream;

const SIZE: [u32; 2] = [320, 240];
const INK: [u8; 3] = [40, 36, 60];

/// Lines that wave across the page and fall by a share of their way.
fn waves(fall: f64) -> Vec<(BezPath, f64)> {
    let wave = |k: usize| {
        let mut path = BezPath::new();
        for x in 0..=66 {
            let at = f64::from(x) * 5.0 - 5.0;
            let y = 30.0 + 22.0 * k as f64 + fall * at + 6.0 * libm::sin(at / 80.0 * TAU);
            if x == 0 { path.move_to(Point::new(at, y)) } else { path.line_to(Point::new(at, y)) }
        }
        (path, 2.0)
    };
    (0..5).map(wave).collect()
}

/// Waves, a line across them all, a ring and a thick line: paths with their widths.
fn lines() -> Vec<(BezPath, f64)> {
    let mut all = waves(0.03);
    let line = |from: [f64; 2], to: [f64; 2]| {
        let mut path = BezPath::new();
        path.move_to(Point::new(from[0], from[1]));
        path.line_to(Point::new(to[0], to[1]));
        path
    };
    all.push((line([150.0, 12.0], [170.0, 140.0]), 2.0));
    all.push((Circle::new(Point::new(80.0, 190.0), 28.0).to_path(0.01), 2.0));
    all.push((line([150.0, 200.0], [290.0, 180.0]), 6.0));
    all
}

fn drawn(lines: &[(BezPath, f64)]) -> RgbImage {
    let mut picture = Pixmap::new(SIZE[0], SIZE[1]).unwrap();
    picture.fill(tiny_skia::Color::WHITE);
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(INK[0], INK[1], INK[2], 255);
    for (path, width) in lines {
        let mut builder = tiny_skia::PathBuilder::new();
        kurbo::flatten(path.iter(), 0.05, |e| match e {
            kurbo::PathEl::MoveTo(p) => builder.move_to(p.x as f32, p.y as f32),
            kurbo::PathEl::ClosePath => builder.close(),
            e => e.end_point().into_iter().for_each(|p| builder.line_to(p.x as f32, p.y as f32)),
        });
        let stroke = Stroke { width: *width as f32, ..Stroke::default() };
        picture.stroke_path(&builder.finish().unwrap(), &paint, &stroke, Transform::identity(), None);
    }
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let c = picture.pixel(x, y).unwrap();
        Rgb([c.red(), c.green(), c.blue()])
    })
}

/// The picture on paper that darkens to one side by a third, with noise.
fn scanned(picture: &RgbImage) -> RgbImage {
    let mut random = stream(5, "scan", 0);
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let light = 1.0 - 0.33 * f64::from(x) / f64::from(SIZE[0]);
        let noise = 10.0 * (random.unit() - 0.5);
        Rgb(picture.get_pixel(x, y).0.map(|v| (f64::from(v) * light + noise).clamp(0.0, 255.0) as u8))
    })
}

fn encoded(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Which pixels are more ink than paper.
fn inked(picture: &RgbImage) -> Vec<bool> {
    picture.pixels().map(|p| p.0.iter().map(|v| u32::from(*v)).sum::<u32>() < 3 * 150).collect()
}

/// The share of the inked pixels of one picture that lie within two pixels of those of another.
fn found(of: &[bool], other: &[bool]) -> f64 {
    let far = squared_distance(SIZE[0] as usize, SIZE[1] as usize, |i| other[i]);
    let all = of.iter().filter(|v| **v).count();
    let near = of.iter().zip(far).filter(|p| *p.0 && p.1 <= 4.0).count();
    near as f64 / all as f64
}

#[test]
fn lines_become_strokes_along_their_middle() {
    let clean = drawn(&lines());
    let art = read(&encoded(&scanned(&clean)), "scan.png", None, &()).unwrap();
    let tree = usvg::Tree::from_str(&art.svg, &usvg::Options::default()).unwrap();
    let mut again = Pixmap::new(SIZE[0], SIZE[1]).unwrap();
    resvg::render(&tree, Transform::identity(), &mut again.as_mut());
    let again = RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let c = again.pixel(x, y).unwrap();
        Rgb([c.red(), c.green(), c.blue()])
    });
    let (clean, again) = (inked(&clean), inked(&again));
    let (recall, precision) = (found(&clean, &again), found(&again, &clean));
    assert!(recall > 0.98 && precision > 0.98, "recall {recall}, precision {precision}");
    // What crosses runs on, so each line is one stroke.
    let strokes: Vec<&str> = art.svg.split("<path ").skip(1).collect();
    assert_eq!(strokes.len(), lines().len(), "{}", art.svg);
    let widths: Vec<f64> = strokes
        .iter()
        .map(|s| s.split("stroke-width=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap())
        .collect();
    assert!(widths.iter().all(|w| (w - 2.0).abs() < 0.6 || (w - 6.0).abs() < 0.8), "{widths:?}");
    assert_eq!(widths.iter().filter(|w| **w > 4.0).count(), 1);
    // One pen drew them all.
    let colours: std::collections::BTreeSet<&str> =
        strokes.iter().map(|s| s.split('"').nth(1).unwrap()).collect();
    assert_eq!(colours.len(), 1, "{colours:?}");
    assert_eq!(art.svg.matches("z\"").count(), 1, "the ring is closed");
}

#[test]
fn lines_go_on_across_borders_that_join() {
    let read =
        |fall: f64, wrap| read(&encoded(&scanned(&drawn(&waves(fall)))), "waves.png", wrap, &()).unwrap();
    let [level, falling] = [read(0.0, None), read(0.03, None)];
    assert!(level.wrap && !falling.wrap);
    assert!(read(0.03, Some(true)).wrap && !read(0.0, Some(false)).wrap);
    // Each is one line round the page, drawn at both borders that it crosses.
    let paths = level.svg.matches("<path ").count();
    assert!((5..=10).contains(&paths), "{paths}");
    assert_eq!(falling.svg.matches("<path ").count(), 5);
}

#[test]
fn light_lines_on_dark_paper_are_read() {
    let mut picture = scanned(&drawn(&lines()));
    picture.pixels_mut().for_each(|p| p.0 = p.0.map(|v| 255 - v));
    let art = read(&encoded(&picture), "negative.png", None, &()).unwrap();
    assert_eq!(art.svg.matches("<path ").count(), lines().len());
}

#[test]
fn what_holds_no_lines_is_refused() {
    let mut random = stream(6, "noise", 0);
    let paper = RgbImage::from_pixel(200, 200, Rgb([250; 3]));
    let noise = RgbImage::from_fn(200, 200, |_, _| Rgb([245 - (12.0 * random.unit()) as u8; 3]));
    let small = RgbImage::from_pixel(20, 200, Rgb([250; 3]));
    for (what, picture) in [("paper", paper), ("noise", noise), ("small", small)] {
        let error = read(&encoded(&picture), what, None, &()).err();
        assert!(matches!(error, Some(Error::Unusable { .. })), "{what}: {error:?}");
    }
    assert!(matches!(read(b"no picture", "text", None, &()), Err(Error::Decode { .. })));
}

#[test]
fn specks_are_left_out_and_counted() {
    let mut picture = drawn(&lines());
    for k in 0..7 {
        picture.put_pixel(20 + 30 * k, 228, Rgb(INK));
    }
    let art = read(&encoded(&picture), "specks.png", None, &()).unwrap();
    assert_eq!(art.warnings, ["specks and dots left out (7)"]);
    assert_eq!(art.svg.matches("<path ").count(), lines().len());
}

#[test]
fn scans_of_lines_are_recognised_and_things_are_not() {
    let clean = drawn(&lines());
    for (what, picture) in
        [("clean", clean.clone()), ("scanned", scanned(&clean)), ("waves", drawn(&waves(0.03)))]
    {
        assert!(shows_lines(&picture), "{what}");
    }
    let mut negative = scanned(&clean);
    negative.pixels_mut().for_each(|p| p.0 = p.0.map(|v| 255 - v));
    assert!(shows_lines(&negative));
    let mut random = stream(6, "noise", 0);
    let noise = RgbImage::from_fn(200, 200, |_, _| Rgb([(255.0 * random.unit()) as u8; 3]));
    let dots = RgbImage::from_fn(300, 300, |x, y| {
        let [x, y] = [x, y].map(|v| v as i32 % 12 - 6);
        Rgb([if x * x + y * y < 10 { 30 } else { 240 }; 3])
    });
    let small = RgbImage::from_pixel(20, 20, Rgb([250; 3]));
    for (what, picture) in [("noise", noise), ("dots", dots), ("small", small)] {
        assert!(!shows_lines(&picture), "{what}");
    }
}

#[test]
fn no_photograph_shows_lines() {
    let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut count = 0;
    for folder in ["examples/exemplars", "../shared/exemplars", "../shared/exemplars/grains"] {
        for entry in std::fs::read_dir(here.join(folder)).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.to_string_lossy().into_owned();
            let is_picture = [".jpg", ".png"].iter().any(|ending| name.ends_with(ending));
            if is_picture && !name.contains(".mask.") {
                assert!(!shows_lines(&image::open(&path).unwrap().into_rgb8()), "{name}");
                count += 1;
            }
        }
    }
    assert!(count >= 5, "{count} pictures");
}
