//! `vtex raster`: pixels from pixels.

use super::support::{Folder, encode};
use image::{ImageFormat, Rgb, RgbImage};

fn open(folder: &Folder, name: &str) -> RgbImage {
    image::load_from_memory(&folder.read(name)).unwrap().into_rgb8()
}

#[test]
fn pixels_of_any_size_by_any_method() {
    let folder = Folder::new();
    for method in ["correspondence", "tsvq", "tsvq-soft"] {
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
    let small = RgbImage::from_fn(20, 20, |x, _| Rgb(if x < 9 { red } else { blue }));
    folder.write("small.png", encode(&small.into(), ImageFormat::Png));
    folder.run("raster photo.png -o x.png --control small.png wanted.png").fails(1, "it has 20 x 20 pixels");
    folder
        .run("raster photo.png -o x.png --control known.png photo.png")
        .fails(1, "have none of the colours");
    folder.run("raster photo.png -o x.png --control known.png").fails(2, "2 values");
}
