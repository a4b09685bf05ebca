//! Loading of photographs: the right pixels, or an error that describes the fault.

use image::{DynamicImage, ImageFormat, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use vtex::Error;
use vtex::analyze::{Exemplar, Limits};

/// A picture of 40 × 32 pixels whose halves stay distinct under any conversion.
fn halves() -> RgbImage {
    RgbImage::from_fn(40, 32, |x, _| Rgb(if x < 20 { [200, 40, 30] } else { [30, 60, 190] }))
}

fn encode(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn load(bytes: &[u8]) -> vtex::Result<Exemplar> {
    Exemplar::from_bytes(bytes, "photo", &Limits::default())
}

/// Whether the pixels near two places are about red and blue.
#[track_caller]
fn assert_red_and_blue(image: &RgbImage, red: (u32, u32), blue: (u32, u32), tolerance: i32) {
    for ((x, y), wanted) in [(red, [200, 40, 30]), (blue, [30, 60, 190])] {
        let got = image.get_pixel(x, y).0;
        let near = got.iter().zip(wanted).all(|(a, b)| (i32::from(*a) - b).abs() <= tolerance);
        assert!(near, "{got:?} at {x}, {y}, not {wanted:?}");
    }
}

#[test]
fn lossless_formats_keep_every_pixel() {
    for format in [ImageFormat::Png, ImageFormat::Tiff, ImageFormat::Bmp, ImageFormat::Pnm, ImageFormat::WebP]
    {
        let exemplar = load(&encode(halves(), format)).unwrap_or_else(|e| panic!("{format:?}: {e}"));
        assert_eq!(exemplar.image, halves(), "{format:?}");
        assert!(exemplar.warnings.is_empty());
    }
    // The checksum is that of the file, as other tools compute it.
    let empty_sum = load(b"").unwrap_err();
    assert!(matches!(empty_sum, Error::Decode { .. }));
    let png = encode(halves(), ImageFormat::Png);
    let exemplar = load(&png).unwrap();
    assert_eq!(exemplar.sha256.len(), 64);
    assert_ne!(exemplar.sha256, load(&encode(halves(), ImageFormat::Bmp)).unwrap().sha256);
}

#[test]
fn an_image_in_memory_is_what_its_file_would_be() {
    let image = Exemplar::from_image(halves().into(), "photo").unwrap();
    let file = [&b"P6\n40 32\n255\n"[..], halves().as_raw()].concat();
    assert!(image == load(&file).unwrap());
    let clear = RgbaImage::from_fn(40, 32, |x, _| Rgba([9, 9, 9, if x < 20 { 0 } else { 255 }]));
    let flat = Exemplar::from_image(clear.into(), "photo").unwrap();
    assert_eq!((flat.image.get_pixel(0, 0).0, flat.warnings.len()), ([255; 3], 1));
    let small = Exemplar::from_image(RgbImage::new(20, 40).into(), "photo");
    assert!(matches!(small, Err(Error::Unusable { .. })));
    let wide = Exemplar::from_image(RgbImage::new(16_385, 40).into(), "photo");
    assert!(matches!(wide, Err(Error::TooLarge { .. })));
}

#[test]
fn jpeg_in_rgb_cmyk_and_turned_by_exif() {
    let plain = load(&encode(halves(), ImageFormat::Jpeg)).unwrap();
    assert_red_and_blue(&plain.image, (8, 16), (32, 16), 12);
    let cmyk = load(include_bytes!("data/cmyk.jpg")).unwrap();
    assert_red_and_blue(&cmyk.image, (8, 16), (32, 16), 25);
    // Orientation 6: the left side of the stored picture is displayed on top.
    let turned = load(include_bytes!("data/turned.jpg")).unwrap();
    assert_eq!(turned.image.dimensions(), (32, 40));
    assert_red_and_blue(&turned.image, (16, 8), (16, 32), 12);
}

#[test]
fn grey_deep_and_palette_images_become_rgb() {
    let grey = image::GrayImage::from_fn(40, 32, |x, _| Luma([if x < 20 { 7 } else { 250 }]));
    let exemplar = load(&encode(grey, ImageFormat::Png)).unwrap();
    assert_eq!((exemplar.image.get_pixel(0, 0).0, exemplar.image.get_pixel(39, 0).0), ([7; 3], [250; 3]));
    type Deep = image::ImageBuffer<Rgb<u16>, Vec<u16>>;
    let deep =
        Deep::from_fn(40, 32, |x, _| Rgb(if x < 20 { [200 * 257, 40 * 257, 30 * 257] } else { [0; 3] }));
    let exemplar = load(&encode(deep, ImageFormat::Png)).unwrap();
    assert_eq!(exemplar.image.get_pixel(3, 3).0, [200, 40, 30]);
    let palette = load(include_bytes!("data/palette.png")).unwrap();
    assert_red_and_blue(&palette.image, (8, 16), (32, 16), 2);
    let first_frame = load(include_bytes!("data/animated.gif")).unwrap();
    assert_red_and_blue(&first_frame.image, (8, 16), (32, 16), 2);
}

#[test]
fn what_is_transparent_is_laid_over_white_with_a_warning() {
    let alpha = |x: u32| match x {
        0..10 => 0,
        10..20 => 127,
        _ => 255,
    };
    let rgba = RgbaImage::from_fn(40, 32, |x, _| Rgba([100, 0, 200, alpha(x)]));
    let exemplar = load(&encode(rgba, ImageFormat::Png)).unwrap();
    let at = |x| exemplar.image.get_pixel(x, 0).0;
    assert_eq!((at(0), at(15), at(30)), ([255; 3], [178, 128, 228], [100, 0, 200]));
    assert_eq!(exemplar.warnings.len(), 1);
    let opaque = RgbaImage::from_fn(40, 32, |x, _| Rgba([x as u8, 0, 0, 255]));
    assert!(load(&encode(opaque, ImageFormat::Png)).unwrap().warnings.is_empty());
    let grey = image::GrayAlphaImage::from_fn(40, 32, |x, _| image::LumaA([9, alpha(x)]));
    let exemplar = load(&encode(grey, ImageFormat::Png)).unwrap();
    assert_eq!(exemplar.image.get_pixel(0, 0).0, [255; 3]);
    assert_eq!(exemplar.warnings.len(), 1);
}

#[test]
fn images_too_small_or_of_one_colour_are_unusable() {
    for (w, h) in [(1, 1), (31, 200), (200, 31)] {
        let image = RgbImage::from_fn(w, h, |x, y| Rgb([(x * 7 + y) as u8, 0, 0]));
        let error = load(&encode(image, ImageFormat::Png)).unwrap_err();
        assert!(matches!(error, Error::Unusable { .. }), "{error}");
        assert!(error.to_string().contains(&format!("{w} x {h}")), "{error}");
        assert!(error.hint().is_some());
    }
    let mut flat = RgbImage::from_pixel(32, 32, Rgb([1, 2, 3]));
    let error = load(&encode(flat.clone(), ImageFormat::Png)).unwrap_err();
    assert!(matches!(error, Error::Unusable { .. }) && error.to_string().contains("#010203"), "{error}");
    flat.put_pixel(31, 31, Rgb([1, 2, 4]));
    load(&encode(flat, ImageFormat::Png)).unwrap();
}

#[test]
fn an_image_cut_short_is_damaged_in_every_format() {
    let noise = RgbImage::from_fn(64, 64, |x, y| {
        let v = x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519);
        Rgb([(v >> 8) as u8, (v >> 16) as u8, (v >> 24) as u8])
    });
    for format in [
        ImageFormat::Png,
        ImageFormat::Jpeg,
        ImageFormat::Tiff,
        ImageFormat::Bmp,
        ImageFormat::Pnm,
        ImageFormat::WebP,
        ImageFormat::Gif,
    ] {
        let whole = encode(noise.clone(), format);
        load(&whole).unwrap_or_else(|e| panic!("{format:?}: {e}"));
        for eighths in 1..8 {
            match load(&whole[..whole.len() * eighths / 8]) {
                Err(Error::Decode { .. }) => {}
                other => panic!("{format:?}, {eighths}/8: {:?}", other.map(|e| e.image.dimensions())),
            }
        }
    }
}

#[test]
fn a_thumbnail_does_not_hide_that_a_jpeg_is_cut_short() {
    let whole = encode(halves(), ImageFormat::Jpeg);
    // A whole JPEG within an APP1 segment, as cameras write it.
    let segment = [&[0xff, 0xe1][..], &(whole.len() as u16 + 2).to_be_bytes(), &whole].concat();
    let with_thumbnail = [&whole[..2], &segment, &whole[2..]].concat();
    load(&with_thumbnail).unwrap();
    let error = load(&with_thumbnail[..with_thumbnail.len() - 20]).unwrap_err();
    assert!(error.to_string().contains("ends in the middle"), "{error}");
}

/// The header of a PNG of the given size, without image data.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([16, 6, 0, 0, 0]);
    let mut crc = !0u32;
    for byte in &chunk {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 * (crc & 1));
        }
    }
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(chunk);
    bytes.extend((!crc).to_be_bytes());
    bytes.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    bytes
}

#[test]
fn bombs_are_refused_before_they_are_decoded() {
    for (w, h) in [(16_385, 40), (40, 16_385), (1_000_000, 1_000_000), (u32::MAX >> 1, 2)] {
        let error = load(&png_header(w, h)).unwrap_err();
        assert!(matches!(error, Error::TooLarge { .. } | Error::Decode { .. }), "{error}");
    }
    // A limit of memory also applies: 2000² pixels of 8 bytes exceed 30 MiB.
    let limits = Limits { memory: 30 << 20, ..Limits::default() };
    let error = Exemplar::from_bytes(&png_header(2000, 2000), "photo", &limits).unwrap_err();
    assert!(matches!(&error, Error::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("the limit is 30 MiB of memory"), "{error}");
    // The largest permitted image fails because its data are missing, not because of its size.
    let limits = Limits::default();
    let needed = 16_384 * 16_384 * (8 + 3);
    assert!(needed <= limits.memory);
}

#[test]
fn files_that_are_no_images_are_told_so() {
    for bytes in [
        &b""[..],
        b"\0",
        b"hello, world",
        b"<svg/>",
        &[0xff; 100],
        b"\x89PNG\r\n\x1a\n",
        b"BM",
        b"GIF89a",
        b"P6\n",
    ] {
        let error = load(bytes).unwrap_err();
        assert!(matches!(error, Error::Decode { .. }), "{bytes:?}: {error}");
    }
    let missing = Exemplar::open(std::path::Path::new("/no/such/photo.png"), &Limits::default()).unwrap_err();
    assert!(matches!(missing, Error::Read { .. }), "{missing}");
}
