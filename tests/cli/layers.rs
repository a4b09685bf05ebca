//! `vtex layers`: maps found, made anew and given.

use super::support::{Folder, encode};
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma, Rgb, RgbImage};
use serde_json::json;

const COLOURS: [[u8; 3]; 3] = [[190, 190, 185], [150, 90, 50], [60, 110, 60]];

/// A label from 0 to 2, in rings and blobs some 60 pixels across.
fn label(x: u32, y: u32) -> usize {
    let [x, y] = [f64::from(x), f64::from(y)];
    let v = libm::sin(x / 23.0) + libm::sin(y / 19.0 + x / 60.0) + libm::cos((x - y) / 37.0);
    (((v + 3.0) / 2.0) as usize).min(2)
}

/// A folder with `rust.png`, a photograph of 200 × 180 pixels in `count` layers with grain, and
/// `painted.png`, its layers.
fn surface(count: usize) -> Folder {
    let folder = Folder::new();
    let of = |x, y| COLOURS[label(x, y).min(count - 1)];
    let photo = RgbImage::from_fn(200, 180, |x, y| {
        let noise = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503_000)) >> 20 & 31;
        Rgb(of(x, y).map(|v| v + noise as u8))
    });
    folder.write("rust.png", encode(&photo.into(), ImageFormat::Png));
    let painted = RgbImage::from_fn(200, 180, |x, y| Rgb(of(x, y)));
    folder.write("painted.png", encode(&painted.into(), ImageFormat::Png));
    folder
}

fn open(folder: &Folder, name: &str) -> RgbImage {
    image::load_from_memory(&folder.read(name)).unwrap().into_rgb8()
}

#[test]
fn a_photograph_becomes_a_map_of_any_size() {
    let folder = surface(2);
    let run = folder.run("layers rust.png -o map.png --size 300x250 --seed 1 --save-layers found.png --json");
    let summary = run.succeeds().json();
    assert_eq!(summary["size"], json!([300, 250]));
    let layers = &summary["layers"];
    assert_eq!(layers["names"].as_array().unwrap().len(), 2, "{layers}");
    assert!(layers["why"].is_string());
    for (wanted, got) in layers["wanted"].as_array().unwrap().iter().zip(layers["got"].as_array().unwrap()) {
        assert!((wanted.as_f64().unwrap() - got.as_f64().unwrap()).abs() < 0.02, "{layers}");
    }
    // The saved map and the result can be read as layer maps.
    let found = open(&folder, "found.png");
    let same = found.enumerate_pixels().filter(|(x, y, p)| (p.0[2] > 120) == (label(*x, *y) == 0)).count();
    assert!(same > 200 * 180 * 9 / 10, "{same}");
    folder.run("layers found.png -o again.svg --size 300x250 --seed 1 --tile").succeeds();
    folder.run("layers map.png -o again.json --seed 1").succeeds();
    let json: serde_json::Value = serde_json::from_slice(&folder.read("again.json")).unwrap();
    assert_eq!((&json["format"], &json["width"]), (&json!("vtex-layers"), &json!(300)));
    let told = folder.run("layers rust.png -o map.png --seed 1 -v").succeeds().stderr;
    assert!(told.contains("layers from bottom to top: ") && told.contains("reach far"), "{told}");
}

#[test]
fn layers_are_counted_ordered_and_painted() {
    let folder = surface(2);
    let names = |rest: &str| {
        let json = folder.run(&format!("layers rust.png -o - --json --seed 1 {rest}")).succeeds().stderr;
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        json["layers"]["names"].as_array().unwrap().clone()
    };
    let plain = names("--layers 2");
    let turned = names("--layers 2 --layer-order 1,0");
    assert_eq!([&plain[0], &plain[1]], [&turned[1], &turned[0]]);
    assert_eq!(names("--layer-map painted.png").len(), 2);
    let refused = |rest: &str, code, message: &str| {
        folder.run(&format!("layers rust.png -o x.png {rest}")).fails(code, message);
        assert!(!folder.path("x.png").exists());
    };
    refused("--layers 7", 2, "expected auto, or 1 to 6");
    refused("--layers 1", 1, "has a single layer");
    refused("--layers 2 --layer-order 0,2", 2, "layer-order = 0,2 is out of range");
    refused("--layers 2 --layer-map painted.png", 2, "cannot be used with");
    let flat = RgbImage::from_fn(200, 180, |x, _| Rgb([if x < 90 { 40 } else { 200 }; 3]));
    folder.write("flat.png", encode(&flat.into(), ImageFormat::Png));
    folder.run("layers flat.png --layers 4 -o x.png").fails(1, "has 2 flat colours, not 4 layers");
}

#[test]
fn strokes_stay_where_they_are() {
    let folder = surface(3);
    folder.run("layers painted.png -o map.png --seed 1").succeeds();
    let json = folder.run("layers painted.png -o map.json --seed 1 --json").succeeds().json();
    let top = json["layers"]["colours"][2].as_str().unwrap().to_owned();
    let rgb: Vec<u8> = (0..3).map(|c| u8::from_str_radix(&top[2 * c + 1..2 * c + 3], 16).unwrap()).collect();
    let top = Rgb([rgb[0], rgb[1], rgb[2]]);
    let stroke = |x: u32, y: u32| (60..90).contains(&x) && (20..150).contains(&y);
    let sketch = RgbImage::from_fn(240, 170, |x, y| if stroke(x, y) { top } else { Rgb([255; 3]) });
    folder.write("sketch.png", encode(&sketch.into(), ImageFormat::Png));
    folder.run("layers painted.png -o out.png --sketch sketch.png --seed 2").succeeds();
    let out = open(&folder, "out.png");
    assert_eq!(out.dimensions(), (240, 170));
    let count = |f: &dyn Fn(bool, bool) -> bool| {
        out.enumerate_pixels().filter(|(x, y, p)| f(**p == top, stroke(*x, *y))).count() as f64
    };
    let overlap = count(&|a, b| a && b) / count(&|a, b| a || b);
    assert!(overlap >= 0.7, "{overlap}");
    folder
        .run("layers painted.png -o x.png --sketch sketch.png --size 100")
        .fails(1, "'sketch.png' has 240 x 170 pixels, --size asks for 100 x 100");
    let blank = RgbImage::from_pixel(50, 50, Rgb([255; 3]));
    folder.write("blank.png", encode(&blank.into(), ImageFormat::Png));
    folder.run("layers painted.png -o x.png --sketch blank.png").fails(1, "nothing is painted");
    folder
        .run("layers painted.png -o x.png --sketch rust.png")
        .fails(1, "it is painted in other colours than");
}

#[test]
fn outside_a_hole_every_pixel_stays() {
    let folder = surface(3);
    folder.run("layers painted.png -o old.png --seed 1").succeeds();
    let inside = |x: u32, y: u32| (x as i32 - 100).pow(2) + (y as i32 - 80).pow(2) < 1600;
    let hole = GrayImage::from_fn(200, 180, |x, y| Luma([if inside(x, y) { 255 } else { 0 }]));
    folder.write("hole.png", encode(&hole.into(), ImageFormat::Png));
    folder.run("layers painted.png -o new.png --keep old.png --hole hole.png --seed 3").succeeds();
    let [old, new] = ["old.png", "new.png"].map(|name| open(&folder, name));
    let changed = |within: bool| {
        old.enumerate_pixels()
            .filter(|(x, y, p)| inside(*x, *y) == within && *p != new.get_pixel(*x, *y))
            .count()
    };
    assert_eq!(changed(false), 0);
    assert!(changed(true) > 200, "{}", changed(true));
    for (name, value, size, message) in [
        ("all.png", 255, (200, 180), "it covers everything"),
        ("none.png", 0, (200, 180), "it is empty"),
        ("small.png", 255, (20, 18), "'small.png' has 20 x 18 pixels, 'old.png' has 200 x 180"),
    ] {
        folder.write(
            name,
            encode(&GrayImage::from_pixel(size.0, size.1, Luma([value])).into(), ImageFormat::Png),
        );
        folder.run(&format!("layers painted.png -o x.png --keep old.png --hole {name}")).fails(1, message);
    }
    folder.run("layers painted.png -o x.png --keep old.png").fails(2, "--hole");
    folder.run("layers painted.png -o old.png --keep old.png --hole hole.png").fails(2, "name the same file");
}

#[test]
fn maps_that_are_none_are_refused() {
    let folder = surface(2);
    let many = RgbImage::from_fn(200, 180, |x, y| Rgb([(x / 10 * 12) as u8, (y / 12 * 16) as u8, 0]));
    folder.write("many.png", encode(&many.into(), ImageFormat::Png));
    folder.write("one.png", encode(&RgbImage::from_pixel(200, 180, Rgb([9; 3])).into(), ImageFormat::Png));
    folder.write(
        "small.png",
        encode(&RgbImage::from_fn(20, 18, |x, _| Rgb([x as u8 / 10 * 90; 3])).into(), ImageFormat::Png),
    );
    let refused = |rest: &str, code, message: &str| {
        folder.run(&format!("layers rust.png -o x.png {rest}")).fails(code, message);
        assert!(!folder.path("x.png").exists());
    };
    refused("--layer-map many.png", 1, "it has 300 colours");
    refused("--layer-map one.png", 1, "it has a single colour");
    refused("--layer-map small.png", 1, "it has 20 x 18 pixels, the photograph 200 x 180");
    refused("--control many.png", 1, "of its pixels have none of the colours");
    refused("--size 20000", 1, "is too large");
    refused("--size 0", 2, "1 to 100000 px");
    folder.run("layers one.png -o x.png").fails(1, "it has a single colour");
    folder.run("layers rust.png -o x.svg --continuous").fails(2, ".png only");
    folder.run("layers rust.png -o x.pdf").fails(2, "cannot tell the format");
    folder.run("layers rust.png -o rust.png").fails(2, "name the same file");
    folder.run("layers missing.png").fails(1, "cannot read");
    folder.run("layers").fails(2, "<INPUT>");
    // Grain has no layers, and the message gives the reason.
    let grain = |x: u32, y: u32| {
        (x.wrapping_mul(x ^ 0x9e37) ^ y.wrapping_mul(y ^ 0x79b9)).wrapping_mul(2_654_435_761)
    };
    let grain = RgbImage::from_fn(200, 180, |x, y| Rgb([(grain(x, y) >> 24) as u8; 3]));
    folder.write("grain.png", encode(&grain.into(), ImageFormat::Png));
    folder.run("layers grain.png -o x.png").fails(1, "has a single layer: ");
}

#[test]
fn a_map_made_by_hand_is_kept() {
    let folder = surface(3);
    folder.run("layers painted.png -o map.png --seed 1").succeeds();
    folder.run("layers painted.png -o same.png --control map.png --seed 1").succeeds();
    assert_eq!(open(&folder, "same.png"), open(&folder, "map.png"));
}

#[test]
fn values_rise_within_layers() {
    let folder = surface(2);
    folder.run("layers painted.png -o map.png --seed 1").succeeds();
    folder.run("layers painted.png -o rise.png --continuous --seed 1").succeeds();
    let rise = image::load_from_memory(&folder.read("rise.png")).unwrap();
    assert_eq!(rise.color(), image::ColorType::L16);
    let (rise, map) = (rise.into_luma16(), open(&folder, "map.png"));
    let upper = rise.enumerate_pixels().find(|(.., p)| p.0[0] >= 32768).unwrap();
    let colour = *map.get_pixel(upper.0, upper.1);
    for (x, y, p) in rise.enumerate_pixels() {
        assert_eq!(p.0[0] >= 32768, *map.get_pixel(x, y) == colour, "{x} {y}");
    }
}

#[test]
fn terrain_has_sixteen_bits_in_and_out() {
    let folder = Folder::new();
    let height = |x: u32, y: u32| {
        let [x, y] = [f64::from(x), f64::from(y)];
        (20_000.0 + 9_000.0 * (libm::sin(x / 17.0) + libm::cos(y / 23.0 + x / 50.0))) as u16
    };
    let terrain = ImageBuffer::from_fn(160, 140, |x, y| Luma([height(x, y)]));
    folder.write("terrain.png", encode(&DynamicImage::ImageLuma16(terrain.clone()), ImageFormat::Png));
    folder.run("layers --heights terrain.png -o new.png --size 300x200 --tile --seed 4").succeeds();
    let new = image::load_from_memory(&folder.read("new.png")).unwrap();
    assert_eq!((new.color(), new.width(), new.height()), (image::ColorType::L16, 300, 200));
    let quantiles = |mut all: Vec<u16>| {
        all.sort_unstable();
        (0..200).map(|k| f64::from(all[k * all.len() / 200])).collect::<Vec<_>>()
    };
    let [own, theirs] = [new.into_luma16().into_raw(), terrain.into_raw()].map(quantiles);
    let distance: f64 = own.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).sum::<f64>() / 200.0;
    assert!(distance / 36_000.0 < 0.05, "{distance}");
    let flat = ImageBuffer::from_pixel(64, 64, Luma([500u16]));
    folder.write("flat.png", encode(&DynamicImage::ImageLuma16(flat), ImageFormat::Png));
    folder.run("layers --heights flat.png -o x.png").fails(1, "all heights are equal");
    let unsound = ImageBuffer::from_fn(64, 64, |x, _| Rgb([if x == 9 { f32::NAN } else { x as f32 }; 3]));
    folder.write("nan.tiff", encode(&DynamicImage::ImageRgb32F(unsound), ImageFormat::Tiff));
    folder.run("layers --heights nan.tiff -o x.png").fails(1, "64 of its heights are not numbers");
    folder.run("layers --heights terrain.png -o x.svg").fails(2, ".png only");
    folder.run("layers photo.png --heights terrain.png -o x.png").fails(2, "cannot be used with");
    folder.run("layers --heights terrain.png --layers 2 -o x.png").fails(2, "cannot be used with");
}

#[test]
fn other_files_are_told_apart() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o out.scene.json --size 60").succeeds();
    folder.run("layers out.scene.json -o x.png").fails(1, "contains a scene");
    folder.run("layers photo.lib.json -o x.png").fails(1, "give --layers 2 or a painted");
}

/// A folder with `rust.png` and its library of two layers.
fn analyzed() -> Folder {
    let folder = surface(2);
    // The spots of paint are elements here, so layers must be requested.
    let arguments = "analyze rust.png --segmenter regions --layers 2 --seed 1 --save-layers found.png --json";
    let summary = folder.run(arguments).succeeds().json();
    assert_eq!(summary["layers"]["names"].as_array().unwrap().len(), 2, "{summary}");
    assert_eq!(summary["layers"]["why"], json!("as asked"));
    folder
}

#[test]
fn textures_have_the_layers_of_their_photograph() {
    let folder = analyzed();
    let synth = "synth rust.lib.json --size 260x200 --seed 3 -f";
    let summary = folder.run(&format!("{synth} -o a.svg -o a.scene.json --json")).succeeds().json();
    let layers = &summary["layers"];
    for (wanted, got) in layers["wanted"].as_array().unwrap().iter().zip(layers["got"].as_array().unwrap()) {
        assert!((wanted.as_f64().unwrap() - got.as_f64().unwrap()).abs() < 0.03, "{layers}");
    }
    let name = layers["names"][1].as_str().unwrap();
    let svg = String::from_utf8(folder.read("a.svg")).unwrap();
    for role in ["", " secondary", " primary"] {
        let label = format!("inkscape:label=\"{}{}{role}\"", name[..1].to_uppercase(), &name[1..]);
        assert!(svg.contains(&label), "{label}");
    }
    folder.run(&format!("{synth} -o b.svg --threads 1")).succeeds();
    assert_eq!(folder.read("a.svg"), folder.read("b.svg"));
    // The name of a stratum denotes all its layers.
    let operation = format!("tint #00f --layer '{name}'");
    let edit = folder.command("edit a.scene.json -o c.svg --op").arg(operation).output().unwrap();
    assert!(edit.status.success(), "{}", String::from_utf8_lossy(&edit.stderr));
    assert_ne!(folder.read("c.svg"), folder.read("a.svg"));
    // A new map can be made of a library's layers; a library without layers has one.
    folder.run("layers rust.lib.json -o map.png --size 150 --seed 1").succeeds();
    assert_eq!(open(&folder, "map.png").dimensions(), (150, 150));
    folder.run("analyze rust.png --segmenter regions --layers off -o one.lib.json").succeeds();
    folder.run("layers one.lib.json -o map.png -f").fails(1, "single layer");
    folder.run("layers rust.lib.json -o map.png -f --layers 3").fails(2, "has its layers already");
}

#[test]
fn maps_and_pictures_lead_a_texture() {
    let folder = analyzed();
    let colours: Vec<Rgb<u8>> = {
        let mut all: Vec<_> = open(&folder, "found.png").pixels().copied().collect();
        all.sort_by_key(|p| p.0);
        all.dedup();
        all
    };
    let map = RgbImage::from_fn(40, 30, |x, _| colours[usize::from(x >= 20)]);
    folder.write("map.png", encode(&map.into(), ImageFormat::Png));
    let synth = "synth rust.lib.json --size 240x180 --seed 2 -f";
    folder.run(&format!("{synth} -o led.png --control map.png")).succeeds();
    let led = open(&folder, "led.png");
    let near = |p: &Rgb<u8>, c: &Rgb<u8>| (0..3).map(|k| p.0[k].abs_diff(c.0[k]) as u32).sum::<u32>();
    let right = led.enumerate_pixels().filter(|(x, _, p)| {
        let own = usize::from(*x >= 120);
        near(p, &colours[own]) < near(p, &colours[1 - own])
    });
    let right = right.count() as f64 / (240.0 * 180.0);
    assert!(right > 0.9, "{right}");
    let ramp = GrayImage::from_fn(30, 30, |_, y| Luma([y as u8 * 8]));
    folder.write("ramp.png", encode(&DynamicImage::from(ramp), ImageFormat::Png));
    folder.run(&format!("{synth} -o guided.png --guide ramp.png")).succeeds();
    let guided = open(&folder, "guided.png");
    let light = |rows: std::ops::Range<u32>| {
        let rows = rows.flat_map(|y| (0..240).map(move |x| (x, y)));
        rows.map(|(x, y)| u64::from(guided.get_pixel(x, y).0[1])).sum::<u64>()
    };
    assert!(light(120..180) > light(0..60) + 60 * 240 * 20);

    for (arguments, code, wanted) in [
        ("--control ramp.png", 1, "none of the colours"),
        ("--control rust.lib.json", 1, "a layer map is a picture"),
        ("--control none.png", 1, "none.png"),
        ("--control map.png --guide ramp.png", 2, "cannot be used with"),
        ("--control map.png --method descriptor", 2, "by correspondences"),
        ("--guide rust.lib.json", 1, "picture"),
    ] {
        folder.run(&format!("{synth} -o x.png {arguments}")).fails(code, wanted);
    }
    folder.run("analyze rust.png --segmenter regions --layers off -o one.lib.json").succeeds();
    folder.run("synth one.lib.json -o x.png --control map.png").fails(1, "give --layers 2 or a painted");
}

#[test]
fn painted_layers_take_the_place_of_those_found() {
    let folder = surface(3);
    let analyze = "analyze rust.png --segmenter regions --seed 1 -f";
    let summary = folder.run(&format!("{analyze} --layer-map painted.png --json")).succeeds().json();
    assert_eq!(summary["layers"]["why"], json!("as painted"));
    assert_eq!(summary["layers"]["names"].as_array().unwrap().len(), 3);
    let names = |arguments: &str| {
        folder.run(&format!("{analyze} {arguments} --json")).succeeds().json()["layers"]["names"].clone()
    };
    let (found, turned) = (names("--layers 3"), names("--layers 3 --layer-order 2,1,0"));
    assert_eq!(found[0], turned[2], "{found} {turned}");
    let small = RgbImage::from_fn(20, 20, |x, _| Rgb(COLOURS[usize::from(x > 9)]));
    folder.write("small.png", encode(&small.into(), ImageFormat::Png));
    for (arguments, code, wanted) in [
        ("--layer-map small.png", 1, "it has 20 x 20 pixels, the photograph 200 x 180"),
        ("--layer-map rust.png", 1, "colours"),
        ("--layers 7", 2, "expected auto, off, or 1 to 6"),
        ("--layers 2 --layer-order 0,2", 2, "every layer is listed once"),
        ("--layers 2 --layer-map painted.png", 2, "cannot be used with"),
        ("--save-layers found.txt", 2, ".png, .svg or .json"),
    ] {
        folder.run(&format!("{analyze} {arguments}")).fails(code, wanted);
    }
}
