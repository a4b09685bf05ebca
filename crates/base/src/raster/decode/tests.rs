use super::super::decode_over_white;
use super::super::profile::tests::of_inks;
use super::*;
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder, tiff::TiffEncoder, webp::WebPEncoder};
use image::{ImageEncoder, Rgb};
use moxcms::ColorProfile;

const SIZE: [u32; 2] = [48, 32];
const STORED: [u8; 3] = [184, 56, 42];
/// What [`STORED`] is in Display P3.
const P3: [u8; 3] = [200, 40, 30];

fn flat(rgb: [u8; 3]) -> DynamicImage {
    RgbImage::from_pixel(SIZE[0], SIZE[1], Rgb(rgb)).into()
}

/// A picture in a format, with an ICC profile and EXIF data.
fn encoded(
    image: &DynamicImage,
    format: ImageFormat,
    icc: Option<Vec<u8>>,
    exif: Option<Vec<u8>>,
) -> Vec<u8> {
    fn write(mut to: impl ImageEncoder, image: &DynamicImage, icc: Option<Vec<u8>>, exif: Option<Vec<u8>>) {
        if let Some(icc) = icc {
            to.set_icc_profile(icc).unwrap();
        }
        if let Some(exif) = exif {
            to.set_exif_metadata(exif).unwrap();
        }
        to.write_image(image.as_bytes(), image.width(), image.height(), image.color().into()).unwrap();
    }
    let mut bytes = Cursor::new(Vec::new());
    match format {
        ImageFormat::Png => write(PngEncoder::new(&mut bytes), image, icc, exif),
        ImageFormat::Jpeg => write(JpegEncoder::new_with_quality(&mut bytes, 100), image, icc, exif),
        ImageFormat::Tiff => write(TiffEncoder::new(&mut bytes), image, icc, exif),
        ImageFormat::WebP => write(WebPEncoder::new_lossless(&mut bytes), image, icc, exif),
        other => image.write_to(&mut bytes, other).unwrap(),
    }
    bytes.into_inner()
}

/// A TIFF of [`SIZE`] with further tags, of samples of 8 bits.
fn tiff(photometric: u16, samples: u16, tags: &[(u16, Vec<u8>)], pixel: &[u8]) -> Vec<u8> {
    let short = |v: u16| v.to_le_bytes().to_vec();
    let data = pixel.repeat((SIZE[0] * SIZE[1]) as usize);
    let bits = [8u8, 0].repeat(usize::from(samples));
    let mut all = vec![
        (256, 3, short(SIZE[0] as u16)),
        (257, 3, short(SIZE[1] as u16)),
        (258, 3, bits),
        (259, 3, short(1)),
        (262, 3, short(photometric)),
        (273, 4, 8u32.to_le_bytes().to_vec()),
        (277, 3, short(samples)),
        (278, 3, short(SIZE[1] as u16)),
        (279, 4, (data.len() as u32).to_le_bytes().to_vec()),
    ];
    // Profiles are bytes, all others are short numbers.
    all.extend(tags.iter().map(|(tag, value)| (*tag, if *tag == 34675 { 7 } else { 3 }, value.clone())));
    all.sort_by_key(|entry| entry.0);
    let (mut beside, mut entries) = (Vec::new(), Vec::new());
    for (tag, kind, value) in &all {
        let each = [1, 1, 1, 2, 4, 8, 1, 1][*kind as usize];
        entries.extend([tag.to_le_bytes(), (*kind as u16).to_le_bytes()].concat());
        entries.extend(((value.len() / each) as u32).to_le_bytes());
        if value.len() <= 4 {
            entries.extend([&value[..], &[0; 4]].concat()[..4].to_vec());
        } else {
            entries.extend(((8 + data.len() + beside.len()) as u32).to_le_bytes());
            beside.extend(value);
            beside.resize(beside.len().next_multiple_of(2), 0);
        }
    }
    let directory = (8 + data.len() + beside.len()) as u32;
    let count = (all.len() as u16).to_le_bytes();
    [b"II*\0", &directory.to_le_bytes()[..], &data, &beside, &count, &entries, &[0; 4]].concat()
}

/// The colour in the middle of a picture over white, and the warnings.
fn middle(bytes: &[u8]) -> ([u8; 3], Vec<String>) {
    let mut warnings = Vec::new();
    let image = decode_over_white(bytes, "photo", &Limits::default(), &mut warnings).unwrap();
    (image.get_pixel(image.width() / 2, image.height() / 2).0, warnings)
}

#[track_caller]
fn assert_near(found: [u8; 3], wanted: [u8; 3], by: u8) {
    assert!(found.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= by), "{found:?}, not {wanted:?}");
}

#[test]
fn profiles_are_applied_in_every_format() {
    let [p3, srgb] = [ColorProfile::new_display_p3(), ColorProfile::new_srgb()].map(|p| p.encode().unwrap());
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Tiff, ImageFormat::WebP] {
        let by = if format == ImageFormat::Jpeg { 2 } else { 1 };
        let bytes = encoded(&flat(STORED), format, Some(p3.clone()), None);
        let (found, warnings) = middle(&bytes);
        assert_near(found, P3, by);
        assert!(warnings.is_empty(), "{warnings:?}");
        // Data stay as they are.
        let (data, _) = decode(&bytes, "map", &Limits::default(), 3).unwrap();
        assert_near(data.into_rgb8().get_pixel(9, 9).0, STORED, by);
        // So do colours that are sRGB, to the last bit.
        let plain = encoded(&flat(STORED), format, None, None);
        let same = encoded(&flat(STORED), format, Some(srgb.clone()), None);
        assert_eq!(middle(&plain), middle(&same), "{format:?}");
    }
}

#[test]
fn profiles_that_cannot_be_applied_are_a_warning() {
    let grey = ColorProfile::new_gray_with_gamma(1.8).encode().unwrap();
    for (icc, says) in [(of_inks(), "is for CMYK"), (grey, "is for grey"), (vec![9; 200], "is damaged")] {
        let (found, warnings) = middle(&encoded(&flat(STORED), ImageFormat::Tiff, Some(icc), None));
        assert_eq!(found, STORED);
        assert!(warnings.len() == 1 && warnings[0].contains(says), "{warnings:?}");
    }
}

/// A PNG with chunks before its data.
fn png_with(chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let plain = encoded(&flat(STORED), ImageFormat::Png, None, None);
    let mut bytes = plain[..33].to_vec();
    for (kind, content) in chunks {
        let body = [&kind[..], content].concat();
        let mut sum = flate2::Crc::new();
        sum.update(&body);
        bytes.extend([&(content.len() as u32).to_be_bytes()[..], &body, &sum.sum().to_be_bytes()].concat());
    }
    bytes.extend(&plain[33..]);
    bytes
}

#[test]
fn pngs_say_their_colours_in_chunks() {
    let numbers = |all: &[u32]| all.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    let gamma = |v: u32| (b"gAMA", numbers(&[v]));
    let p3 = || (b"cHRM", numbers(&[31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000]));
    assert_near(middle(&png_with(&[gamma(45455), p3()])).0, P3, 1);
    assert_near(middle(&png_with(&[(b"cICP", vec![12, 13, 0, 1])])).0, P3, 1);
    // An exponent that is not that of sRGB: 255 · encoded((v / 255)^(1 / exponent)).
    assert_near(middle(&png_with(&[gamma(100_000)])).0, [221, 129, 113], 1);
    for plain in [
        vec![],
        vec![gamma(45455)],
        vec![p3()],
        vec![(b"sRGB", vec![0]), gamma(100_000)],
        vec![(b"cICP", vec![1, 13, 0, 1]), gamma(100_000)],
    ] {
        assert_eq!(middle(&png_with(&plain)), (STORED, vec![]));
    }
    let (found, warnings) = middle(&png_with(&[(b"cICP", vec![9, 16, 0, 1])]));
    assert!(found == STORED && warnings[0].contains("high dynamic range"), "{warnings:?}");
}

#[test]
fn inks_with_a_profile_become_its_colours() {
    let inks = [30, 60, 90, 20];
    let wanted = ColourProfile::from_icc(&of_inks()).unwrap().of_inks(&inks, [1, 1]).get_pixel(0, 0).0;
    let with = tiff(5, 4, &[(34675, of_inks())], &inks);
    assert_eq!(middle(&with), (wanted, vec![]));
    let without = middle(&tiff(5, 4, &[], &inks)).0;
    assert_ne!(wanted, without);
    // Those of a JPEG are stored as their complement.
    let jpeg = include_bytes!("../../../../../tests/data/cmyk.jpg");
    let icc = [b"ICC_PROFILE\0\x01\x01", &of_inks()[..]].concat();
    let segment = [b"\xff\xe2", &((icc.len() + 2) as u16).to_be_bytes()[..], &icc].concat();
    let with = [&jpeg[..2], &segment, &jpeg[2..]].concat();
    let mut warnings = Vec::new();
    let mut left = |bytes: &[u8]| {
        let image = decode_over_white(bytes, "photo", &Limits::default(), &mut warnings).unwrap();
        image.get_pixel(8, 16).0
    };
    let (with, without) = (left(&with), left(jpeg));
    // By Little CMS.
    assert_near(with, [159, 95, 110], 2);
    assert_ne!(with, without);
    assert!(warnings.is_empty());
    let p3 = ColorProfile::new_display_p3().encode().unwrap();
    let (found, warnings) = middle(&tiff(5, 4, &[(34675, p3)], &inks));
    assert!(found == middle(&tiff(5, 4, &[], &inks)).0 && warnings[0].contains("CMYK"), "{warnings:?}");
}

#[test]
fn colours_multiplied_by_their_opacity_are_divided_by_it() {
    let kind = |v: u8| [(338, vec![v, 0])];
    let (associated, one) = middle(&tiff(2, 4, &kind(1), &[100, 50, 25, 128]));
    let (unassociated, other) = middle(&tiff(2, 4, &kind(2), &[199, 100, 50, 128]));
    assert_near(associated, [227, 177, 152], 1);
    assert_near(associated, unassociated, 1);
    assert_eq!(one, other);
    let clear = middle(&tiff(2, 4, &kind(1), &[100, 50, 25, 0])).0;
    assert_eq!(clear, [255; 3]);
}

/// EXIF data that say how a picture is turned.
fn exif(orientation: u8) -> Vec<u8> {
    let entry = [0x12, 1, 3, 0, 1, 0, 0, 0, orientation, 0, 0, 0];
    [&b"II*\0\x08\0\0\0\x01\0"[..], &entry, &[0; 4]].concat()
}

#[test]
fn pictures_are_turned_as_exif_says() {
    const CORNERS: [[u8; 3]; 4] = [[230, 30, 30], [30, 200, 30], [30, 30, 220], [220, 220, 30]];
    let [w, h] = SIZE;
    let quarter = |x: u32, y: u32| (usize::from(y >= h / 2)) * 2 + usize::from(x >= w / 2);
    let image = RgbImage::from_fn(w, h, |x, y| Rgb(CORNERS[quarter(x, y)])).into();
    for format in [ImageFormat::Jpeg, ImageFormat::Png, ImageFormat::WebP, ImageFormat::Tiff] {
        for orientation in 1..=8 {
            let bytes = if format == ImageFormat::Tiff {
                // The tag of the TIFF itself, in a picture of one colour but for its first pixel.
                let mut bytes = tiff(2, 3, &[(274, vec![orientation, 0])], &[9, 9, 9]);
                for (at, corner) in [(0, 0), (w - 1, 1), (w * (h - 1), 2), (w * h - 1, 3)] {
                    bytes[8 + 3 * at as usize..][..3].copy_from_slice(&CORNERS[corner]);
                }
                bytes
            } else {
                encoded(&image, format, None, Some(exif(orientation)))
            };
            let shown = decode_over_white(&bytes, "photo", &Limits::default(), &mut Vec::new()).unwrap();
            assert_eq!(shown.dimensions(), if orientation < 5 { (w, h) } else { (h, w) });
            for (corner, (x, y)) in [(0, 0), (w - 1, 0), (0, h - 1), (w - 1, h - 1)].into_iter().enumerate() {
                let (far_x, far_y) = (w - 1 - x, h - 1 - y);
                let (x, y) = match orientation {
                    1 => (x, y),
                    2 => (far_x, y),
                    3 => (far_x, far_y),
                    4 => (x, far_y),
                    5 => (y, x),
                    6 => (far_y, x),
                    7 => (far_y, far_x),
                    _ => (y, far_x),
                };
                assert_near(shown.get_pixel(x, y).0, CORNERS[corner], 40);
            }
        }
    }
}

/// The format of a picture that is not read.
fn other(bytes: &[u8]) -> String {
    assert!(is_picture(bytes));
    match decode(bytes, "photo", &Limits::default(), 3) {
        Err(Error::OtherFormat { format, .. }) => format,
        found => panic!("{found:?}"),
    }
}

#[test]
fn formats_that_are_not_read_are_named() {
    let heif = |brands: &str| {
        let length = (8 + brands.len()) as u32;
        [&length.to_be_bytes()[..], b"ftyp", brands.as_bytes(), &[0; 40]].concat()
    };
    for (bytes, says) in [
        (heif("heic\0\0\0\0mif1heic"), "a HEIC picture"),
        (heif("mif1\0\0\0\0mif1heic"), "a HEIC picture"),
        (heif("avif\0\0\0\0mif1"), "an AVIF picture"),
        (heif("mif1\0\0\0\0mif1avif"), "an AVIF picture"),
        (heif("crx \0\0\0\0"), "Canon"),
        (b"\0\0\0\x0cjP  \r\n\x87\n....".to_vec(), "JPEG 2000"),
        (b"8BPS\0\x01".to_vec(), "Photoshop"),
        (b"\xff\x0a....".to_vec(), "JPEG XL"),
        (b"II*\0\x10\0\0\0CR\x02\0".to_vec(), "CR2"),
        (b"FUJIFILMCCD-RAW 0201".to_vec(), "RAF"),
    ] {
        assert!(other(&bytes).contains(says), "{} {says}", other(&bytes));
    }
    // A film is no picture.
    assert!(!is_picture(&heif("isom\0\0\0\0mp41")));
}

#[test]
fn kinds_of_jpeg_and_tiff_that_are_not_read_are_named() {
    let jpeg = encoded(&flat(STORED), ImageFormat::Jpeg, None, None);
    let frame = jpeg.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    for (kind, says) in [(0xc9, "arithmetic-coded"), (0xca, "arithmetic-coded"), (0xc3, "lossless")] {
        let mut bytes = jpeg.clone();
        bytes[frame + 1] = kind;
        assert!(other(&bytes).contains(says), "{says}");
    }
    let mut deep = jpeg.clone();
    deep[frame + 4] = 12;
    assert!(other(&deep).contains("12 bits"));
    assert!(other(&tiff(6, 3, &[], &[1, 2, 3])).contains("YCbCr"));
    assert!(other(&tiff(1, 2, &[], &[1, 2])).contains("transparent grey"));
    assert!(other(&tiff(3, 1, &[(320, vec![0; 1536])], &[1])).contains("palette"));
    assert!(
        other(&tiff(2, 3, &[(254, vec![1, 0]), (330, vec![8, 0])], &[1, 2, 3])).contains("raw photograph")
    );
    let error = decode(&tiff(6, 3, &[], &[1, 2, 3]), "a.tif", &Limits::default(), 3).unwrap_err();
    assert_eq!(error.to_string(), "'a.tif' is a TIFF with YCbCr colours, which vtex does not read");
    assert_eq!(error.hint().as_deref(), Some("export it as JPEG or PNG"));
}
