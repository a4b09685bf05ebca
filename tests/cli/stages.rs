//! All stages on unusual photographs.

use super::support::{Folder, encode};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage, Rgba, RgbaImage};

#[test]
fn unusable_photographs_get_a_clear_answer() {
    let folder = Folder::new();
    let image = |w, h| DynamicImage::from(RgbImage::from_pixel(w, h, Rgb([9, 10, 11])));
    folder.write("one.png", encode(&image(1, 1), ImageFormat::Png));
    folder.write("flat.png", encode(&image(64, 64), ImageFormat::Png));
    folder.run("texture one.png").fails(1, "it has 1 x 1 pixels, at least 4 x 4 are needed");
    let run = folder.run("texture flat.png").fails(1, "every pixel has the colour #090a0b");
    assert!(run.stderr.contains("hint: use a photograph that shows more than one colour"), "{}", run.stderr);
    assert_eq!(folder.names(), ["flat.png", "one.png", "photo.png"]);
}

#[test]
fn a_photograph_without_textons_still_gives_a_ground() {
    let folder = Folder::new();
    // A soft slope from one colour to another.
    let slope = RgbImage::from_fn(80, 80, |x, y| Rgb([100 + (x / 4) as u8, 100 + (y / 4) as u8, 90]));
    folder.write("slope.png", encode(&slope.into(), ImageFormat::Png));
    folder.write("none.masks.png", encode(&image::GrayImage::new(80, 80).into(), ImageFormat::Png));
    let run = folder.run("texture slope.png --masks none.masks.png -o a.svg --size 70").succeeds();
    assert!(run.stderr.contains("warning: no primary element was found"), "{}", run.stderr);
    assert!(run.stderr.contains("hint: --segmenter finds elements in other ways"), "{}", run.stderr);
    let svg = String::from_utf8(folder.read("a.svg")).unwrap();
    assert!(svg.contains("id=\"background\""));
    let library = folder.run("analyze slope.png --masks none.masks.png --json").succeeds().json();
    assert_eq!(library["warnings"].as_array().unwrap().len(), 1);
    // Warnings are stored, and `inspect` prints them.
    let text = folder.run("inspect slope.lib.json").succeeds().text().to_owned();
    assert!(text.contains("warning: no primary element"), "{text}");
}

#[test]
fn transparency_is_warned_of() {
    let folder = Folder::new();
    let photo = image::load_from_memory(&folder.read("photo.png")).unwrap().into_rgb8();
    let clear = RgbaImage::from_fn(96, 80, |x, y| {
        let [r, g, b] = photo.get_pixel(x, y).0;
        Rgba([r, g, b, if x < 9 { 0 } else { 255 }])
    });
    folder.write("clear.png", encode(&clear.into(), ImageFormat::Png));
    let run = folder.run("analyze clear.png").succeeds();
    assert!(run.stderr.contains("warning: the picture is partly transparent"), "{}", run.stderr);
}

#[test]
fn masks_of_another_size_are_refused() {
    let folder = Folder::new();
    folder.write("m.png", encode(&image::GrayImage::new(10, 10).into(), ImageFormat::Png));
    folder.run("analyze photo.png --masks m.png").fails(1, "the masks do not fit the image");
}
