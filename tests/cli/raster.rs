//! `vtex raster`: pixels from pixels.

use super::support::{Folder, encode};
use image::{ImageFormat, Rgb, RgbImage};

fn open(folder: &Folder, name: &str) -> RgbImage {
    image::load_from_memory(&folder.read(name)).unwrap().into_rgb8()
}

#[test]
fn pixels_of_any_size_by_any_method() {
    let folder = Folder::new();
    for method in ["correspondence", "tsvq"] {
        folder.run(&format!("raster photo.png -o a.png --size 120x70 --tile --method {method}")).succeeds();
        assert_eq!(open(&folder, "a.png").dimensions(), (120, 70));
    }
    folder.run("raster photo.png --seed 1").succeeds();
    assert_eq!(open(&folder, "photo.raster.png").dimensions(), (96, 80));
    folder.run("raster photo.png -o x.svg").fails(2, "cannot tell the format");
    folder.run("raster photo.png -o photo.png").fails(2, "name the same file");
    folder.run("raster photo.png -o x.png --size 20000").fails(1, "is too large");
}

#[test]
fn maps_say_where_what_is() {
    let folder = Folder::new();
    let (red, blue) = ([200u8, 40, 30], [30u8, 40, 200]);
    let halves = |grain: u8| {
        RgbImage::from_fn(80, 80, move |x, y| {
            let noise = (x * 7 + y * 13 + x * y) as u8 % 20 * grain;
            Rgb(if x < 40 { red } else { blue }.map(|v| v + noise))
        })
    };
    folder.write("photo.png", encode(&halves(1).into(), ImageFormat::Png));
    folder.write("known.png", encode(&halves(0).into(), ImageFormat::Png));
    let wanted = RgbImage::from_fn(100, 60, |_, y| Rgb(if y < 30 { red } else { blue }));
    folder.write("wanted.png", encode(&wanted.into(), ImageFormat::Png));
    folder.run("raster photo.png -o out.png --control known.png wanted.png --seed 1").succeeds();
    let out = open(&folder, "out.png");
    assert_eq!(out.dimensions(), (100, 60));
    let right = out.enumerate_pixels().filter(|(_, y, p)| (p.0[0] > p.0[2]) == (*y < 30)).count();
    assert!(right > 100 * 60 * 97 / 100, "{right}");
    let control = "--control known.png wanted.png --seed 1";
    folder.run(&format!("raster photo.png -o scanned.png {control} --method tsvq")).succeeds();
    let scanned = open(&folder, "scanned.png");
    assert!(scanned.enumerate_pixels().all(|(_, y, p)| (p.0[0] > p.0[2]) == (y < 30)));
    let small = RgbImage::from_fn(20, 20, |x, _| Rgb(if x < 9 { red } else { blue }));
    folder.write("small.png", encode(&small.into(), ImageFormat::Png));
    folder.run("raster photo.png -o x.png --control small.png wanted.png").fails(1, "it has 20 x 20 pixels");
    folder
        .run("raster photo.png -o x.png --control known.png photo.png")
        .fails(1, "have none of the colours");
    folder.run("raster photo.png -o x.png --control known.png").fails(2, "2 values");
}

#[test]
fn holes_and_borders_are_filled() {
    let folder = Folder::new();
    let photo = open(&folder, "photo.png");
    let in_hole = |x: u32, y: u32| (30..50).contains(&x) && (20..45).contains(&y);
    let hole = RgbImage::from_fn(96, 80, |x, y| Rgb([if in_hole(x, y) { 255 } else { 0 }; 3]));
    folder.write("hole.png", encode(&hole.clone().into(), ImageFormat::Png));
    folder.run("raster photo.png -o filled.png --method tsvq --hole hole.png --seed 1").succeeds();
    let filled = open(&folder, "filled.png");
    assert!(filled.enumerate_pixels().all(|(x, y, p)| in_hole(x, y) || p == photo.get_pixel(x, y)));
    assert!(filled.enumerate_pixels().any(|(x, y, p)| p != photo.get_pixel(x, y)));

    folder.run("raster photo.png -o wide.png --extend 10,0,20,5 --seed 1").succeeds();
    let wide = open(&folder, "wide.png");
    assert_eq!(wide.dimensions(), (126, 85));
    assert!(photo.enumerate_pixels().all(|(x, y, p)| p == wide.get_pixel(x + 10, y)));

    folder.write("small.png", encode(&RgbImage::new(9, 9).into(), ImageFormat::Png));
    folder.run("raster photo.png -o x.png --hole small.png").fails(1, "'small.png' has 9 x 9 pixels");
    folder.write("none.png", encode(&RgbImage::new(96, 80).into(), ImageFormat::Png));
    folder.run("raster photo.png -o x.png --hole none.png").fails(1, "it is empty");
    let all = RgbImage::from_pixel(96, 80, Rgb([255; 3]));
    folder.write("all.png", encode(&all.into(), ImageFormat::Png));
    folder.run("raster photo.png -o x.png --hole all.png").fails(1, "it leaves 0 neighbourhoods");
    folder.run("raster photo.png -o x.png --extend 1,2").fails(2, "expected 40, or 40,0,40,0");
    folder.run("raster photo.png -o x.png --extend 20000").fails(2, "expected 40, or 40,0,40,0");
    folder.run("raster photo.png -o x.png --extend 5 --hole hole.png").fails(2, "cannot be used with");
    folder.run("raster photo.png -o x.png --extend 5 --size 90").fails(2, "cannot be used with");
    let run = folder.run("raster photo.png -o x.png --method correspondence --hole hole.png");
    run.fails(2, "--hole is for --method tsvq");
}

#[test]
fn codebooks_have_parameters() {
    let folder = Folder::new();
    folder.run("raster photo.png -o a.png --method tsvq --seed 1 --size 40").succeeds();
    folder.run("raster photo.png -o b.png --neighbourhood 7 --codebook 4096 --seed 1 --size 40").succeeds();
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
    for other in ["--levels 1", "--neighborhood 5", "--codebook 9"] {
        folder.run(&format!("raster photo.png -o c.png --seed 1 --size 40 {other}")).succeeds();
        assert_ne!(folder.read("a.png"), folder.read("c.png"), "{other}");
    }
    let run = folder.run("raster photo.png -o d.png --levels 8 --size 40").succeeds();
    assert!(run.stderr.contains("in place of 8"), "{}", run.stderr);
    folder.run("raster photo.png -o x.png --neighbourhood 6").fails(2, "an odd number, 3 to 15 px");
    folder.run("raster photo.png -o x.png --neighbourhood 21").fails(2, "expected 3 to 15 px");
    folder.run("raster photo.png -o x.png --levels 9").fails(2, "expected 1 to 8");
    folder.run("raster photo.png -o x.png --codebook 0").fails(2, "expected 1 to 65536");
    folder
        .run("raster photo.png -o x.png --codebook 9 --method correspondence")
        .fails(2, "--codebook is for");
}
