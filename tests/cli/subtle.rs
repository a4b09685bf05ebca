//! Pictures of little contrast, and tiles of a few pixels.

use super::support::{Folder, encode};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use serde_json::{Value, json};

/// Bricks of some steps of lightness on joints of a lightness, a little yellow.
fn bricks(side: u32, joints: f64, steps: f64) -> RgbImage {
    RgbImage::from_fn(side, side, |x, y| {
        let (course, along) = (y / 16, x + y / 16 * 17);
        let brick = y % 16 > 2 && along % 34 > 2;
        let shade = f64::from((course * 7 + along / 34 * 5) % 4) / 8.0;
        let light = if brick { 0.4 + shade } else { 0.0 };
        Rgb([0.0, -6.0, -22.0].map(|v| (joints + v + steps * light) as u8))
    })
}

fn png(image: RgbImage) -> Vec<u8> {
    encode(&DynamicImage::from(image), ImageFormat::Png)
}

/// Mean and deviation of the lightness of a picture.
fn lightness(image: &RgbImage) -> [f64; 2] {
    let light =
        |p: &Rgb<u8>| 0.2126 * f64::from(p.0[0]) + 0.7152 * f64::from(p.0[1]) + 0.0722 * f64::from(p.0[2]);
    let count = f64::from(image.width() * image.height());
    let mean = image.pixels().map(light).sum::<f64>() / count;
    let variance = image.pixels().map(|p| (light(p) - mean) * (light(p) - mean)).sum::<f64>() / count;
    [mean, variance.sqrt()]
}

fn library(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).unwrap()
}

#[test]
fn a_subtle_picture_keeps_its_colours_and_its_contrast() {
    let folder = Folder::new();
    let image = bricks(240, 236.0, 10.0);
    folder.write("pale.png", png(image.clone()));
    let analyze = "analyze pale.png --segmenter regions --seed 1";
    let run = folder.run(&format!("{analyze} -o auto.lib.json")).succeeds();
    assert!(run.stderr.contains("the contrast was stretched 10.0 times"), "{}", run.stderr);
    let found = library(&folder, "auto.lib.json");
    assert_eq!(found["source"]["contrast"], 10.0);
    assert_eq!(found["source"]["parameters"].get("contrast"), None);
    let told = folder.run("inspect auto.lib.json").succeeds();
    assert!(told.text().contains("the contrast was stretched 10.0 times"), "{}", told.text());
    assert_eq!(folder.run("inspect auto.lib.json --json").succeeds().json()["contrast"], 10.0);
    folder.run("synth auto.lib.json -o out.png --size 240 --seed 3").succeeds();
    let made = image::load_from_memory(&folder.read("out.png")).unwrap().to_rgb8();
    let ([mean, deviation], [made_mean, made_deviation]) = (lightness(&image), lightness(&made));
    assert!((made_mean - mean).abs() < 1.0, "{made_mean} for {mean}");
    assert!((0.8..1.2).contains(&(made_deviation / deviation)), "{made_deviation} for {deviation}");

    let run = folder.run(&format!("{analyze} --contrast off -o off.lib.json")).succeeds();
    assert!(!run.stderr.contains("contrast"), "{}", run.stderr);
    let plain = library(&folder, "off.lib.json");
    assert_eq!(
        (plain["source"].get("contrast"), &plain["source"]["parameters"]["contrast"]),
        (None, &json!("off"))
    );
    folder.run(&format!("{analyze} --contrast 4 -o by.lib.json")).succeeds();
    assert_eq!(library(&folder, "by.lib.json")["source"]["contrast"], 4.0);
    folder.write("c.toml", "[analyze]\ncontrast = 2.5\n");
    folder.run(&format!("{analyze} --config c.toml -o set.lib.json")).succeeds();
    assert_eq!(library(&folder, "set.lib.json")["source"]["contrast"], 2.5);
    for wrong in ["0.5", "11", "on", "NaN"] {
        folder.run(&format!("{analyze} --contrast {wrong}")).fails(2, "auto, off, or 1 to 10");
    }
    // An ordinary picture says nothing of it.
    folder.write("plain.png", png(bricks(240, 100.0, 120.0)));
    folder.run("analyze plain.png --segmenter regions --seed 1 -o plain.lib.json").succeeds();
    assert_eq!(library(&folder, "plain.lib.json")["source"].get("contrast"), None);
}

#[test]
fn a_small_tile_is_repeated_and_keeps_its_period() {
    let folder = Folder::new();
    let ring = |x: u32, y: u32| {
        let [dx, dy] = [f64::from(x) - 6.0, f64::from(y) - 5.0];
        (4.0..16.0).contains(&(dx * dx + dy * dy))
    };
    let tile = RgbImage::from_fn(13, 10, |x, y| Rgb(if ring(x, y) { [200, 120, 60] } else { [40, 50, 80] }));
    folder.write("tile.png", png(tile.clone()));
    let run = folder.run("analyze tile.png --segmenter regions --seed 1").succeeds();
    assert!(run.stderr.contains("the tile of 13 x 10 px was repeated"), "{}", run.stderr);
    let source = &library(&folder, "tile.lib.json")["source"];
    assert_eq!(
        (&source["copies"], &source["width"], &source["height"]),
        (&json!([8, 10]), &json!(104), &json!(100))
    );
    assert_eq!(library(&folder, "tile.lib.json")["lattice"]["vectors"], json!([[13.0, 0.0], [0.0, 10.0]]));
    folder.run("synth tile.lib.json -o out.png --size 260x200 --seed 2 --tile").succeeds();
    let made = image::load_from_memory(&folder.read("out.png")).unwrap().to_rgb8();
    let apart =
        |a: &Rgb<u8>, b: &Rgb<u8>| (0..3).map(|c| f64::from(a.0[c].abs_diff(b.0[c]))).sum::<f64>() / 3.0;
    let mean = |other: &dyn Fn(u32, u32) -> Rgb<u8>| {
        made.enumerate_pixels().map(|(x, y, p)| apart(p, &other(x, y))).sum::<f64>() / (260.0 * 200.0)
    };
    let own = mean(&|x, y| *tile.get_pixel(x % 13, y % 10));
    let beside = mean(&|x, y| *made.get_pixel((x + 26) % 260, (y + 10) % 200));
    assert!(own < 16.0 && beside < 4.0, "{own} {beside}");
    folder.run("texture tile.png --wrap=off").fails(1, "it has 13 x 10 pixels, at least 32 x 32 are needed");
    folder.write("dots.png", png(image::imageops::crop_imm(&tile, 0, 0, 3, 3).to_image()));
    folder.run("texture dots.png").fails(1, "it has 3 x 3 pixels, at least 4 x 4 are needed");
}
