//! Pictures → control maps: density, and shares of several libraries.

use super::picture;
use image::RgbaImage;
use std::collections::BTreeMap;
use vtex_base::error::{Error, Result};
use vtex_base::raster::ControlMap;

/// Largest number of colours in a picture whose colours denote libraries.
const MOST_COLOURS: usize = 1 << 16;
/// Least share of pixels for a colour to denote a library, in a picture with too many colours. Rarer
/// colours are blends along soft borders.
const LEAST_SHARE: f64 = 0.005;

/// Reads a map of density relative to the exemplar's, linear in the grey value: black 0, middle grey
/// 1, white 2. Transparent pixels mean 1. `name` appears in errors.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`].
pub fn density(bytes: &[u8], name: &str) -> Result<ControlMap> {
    let grey = picture::grey(&picture::read(bytes, name)?);
    let value = |x, y| {
        let [level, opacity] = grey.get_pixel(x, y).0.map(|v| f32::from(v) / f32::from(u16::MAX));
        1.0 + opacity * (2.0 * level - 1.0)
    };
    picture::map(grey.width(), grey.height(), value).ok_or_else(|| empty(name, "a density map"))
}

/// Reads a map of values from 0 (black) to 1 (white), linear in the grey value. Transparent pixels
/// mean 0. `name` appears in errors.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`].
pub fn level(bytes: &[u8], name: &str) -> Result<ControlMap> {
    let grey = picture::grey(&picture::read(bytes, name)?);
    picture::map(grey.width(), grey.height(), share_of(&grey)).ok_or_else(|| empty(name, "a map"))
}

/// Reads one map of shares (0 to 1) for each of `libraries` libraries. `pictures` holds the name and
/// the content of each picture:
///
/// * as many pictures as libraries: each gives one library's share, white 1 and black 0; transparent
///   pixels mean 0;
/// * one grey picture for two libraries: black is the first, white the second, grey a mixture;
///   transparent pixels mean the first;
/// * one picture with one colour per library, in the order of its palette, or from dark to light
///   if it has none; transparency counts as the first colour. Soft borders between colours are
///   allowed.
///
/// # Errors
/// [`Error::Decode`], [`Error::TooLarge`]; [`Error::Control`] if the number of pictures or colours
/// does not fit.
pub fn shares(pictures: &[(&str, &[u8])], libraries: usize) -> Result<Vec<ControlMap>> {
    if let (&[(name, bytes)], true) = (pictures, libraries > 1) {
        return one_for_all(bytes, name, libraries);
    }
    if pictures.len() != libraries {
        let (name, count) = (pictures.last().map_or("map", |p| p.0), pictures.len());
        let reason = format!("it is one of {count} maps for {libraries} libraries");
        return Err(fail(name, reason, "give one map for all libraries, or one for each"));
    }
    pictures
        .iter()
        .map(|(name, bytes)| {
            let grey = picture::grey(&picture::read(bytes, name)?);
            picture::map(grey.width(), grey.height(), share_of(&grey)).ok_or_else(|| empty(name, ROLE))
        })
        .collect()
}

const ROLE: &str = "a map of libraries";

fn fail(name: &str, reason: String, advice: &'static str) -> Error {
    Error::Control { name: name.into(), role: ROLE, reason, advice }
}

fn empty(name: &str, role: &'static str) -> Error {
    Error::Control {
        name: name.into(),
        role,
        reason: "it has no pixels".into(),
        advice: "is the file complete?",
    }
}

/// Grey value times opacity, 0 to 1.
fn share_of(grey: &picture::Grey) -> impl Fn(u32, u32) -> f32 {
    |x, y| {
        let [level, opacity] = grey.get_pixel(x, y).0.map(|v| f32::from(v) / f32::from(u16::MAX));
        level * opacity
    }
}

fn one_for_all(bytes: &[u8], name: &str, libraries: usize) -> Result<Vec<ControlMap>> {
    let image = picture::read(bytes, name)?;
    let (width, height) = (image.width(), image.height());
    let none = || empty(name, ROLE);
    let colours = picture::colours(&image);
    if libraries == 2 && colours.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]) {
        let grey = picture::grey(&image);
        let second = share_of(&grey);
        let first = picture::map(width, height, |x, y| 1.0 - second(x, y)).ok_or_else(none)?;
        return Ok(vec![first, picture::map(width, height, second).ok_or_else(none)?]);
    }
    drop(image);
    let all = count(&colours);
    let main = main_colours(&all, libraries, palette(bytes).as_deref())
        .map_err(|reason| fail(name, reason, COLOURS))?;
    let nearest: BTreeMap<Option<[u8; 3]>, u8> = all.into_keys().map(|c| (c, nearest(&main, c))).collect();
    let mut labels = Vec::with_capacity(width as usize * height as usize);
    let mut last = (None, nearest.get(&None).copied().unwrap_or(0));
    for pixel in colours.pixels() {
        let colour = colour(pixel);
        if colour != last.0 {
            last = (colour, nearest.get(&colour).copied().unwrap_or(0));
        }
        labels.push(last.1);
    }
    drop(colours);
    let share = |library: usize| {
        picture::map(width, height, |x, y| {
            let label = labels[y as usize * width as usize + x as usize];
            f32::from(u8::from(usize::from(label) == library))
        })
    };
    (0..libraries).map(|library| share(library).ok_or_else(none)).collect()
}

const COLOURS: &str = "give a picture with one flat colour for each library, best a PNG, or a map for each; \
                       for two libraries a grey picture will do";

/// The colour of a pixel; `None` if it is transparent.
fn colour(pixel: &image::Rgba<u8>) -> Option<[u8; 3]> {
    let [r, g, b, opacity] = pixel.0;
    (opacity >= 128).then_some([r, g, b])
}

/// Number of pixels of each colour. Counting stops when there are too many colours.
fn count(image: &RgbaImage) -> BTreeMap<Option<[u8; 3]>, u64> {
    let mut found: BTreeMap<_, u64> = BTreeMap::new();
    for pixel in image.pixels() {
        *found.entry(colour(pixel)).or_default() += 1;
        if found.len() > MOST_COLOURS {
            break;
        }
    }
    found
}

/// The colours that denote libraries, in order.
fn main_colours(
    found: &BTreeMap<Option<[u8; 3]>, u64>,
    libraries: usize,
    palette: Option<&[[u8; 3]]>,
) -> std::result::Result<Vec<Option<[u8; 3]>>, String> {
    let wanted = format!("{libraries} are needed for {libraries} libraries");
    if found.len() > MOST_COLOURS {
        return Err(format!("it has more than {MOST_COLOURS} colours; {wanted}"));
    }
    let least = LEAST_SHARE * found.values().sum::<u64>() as f64;
    let main: Vec<_> = found.iter().filter(|(_, n)| **n as f64 >= least).map(|(c, _)| *c).collect();
    let mut chosen = if found.len() == libraries { found.keys().copied().collect() } else { main };
    if found.len() < libraries || chosen.len() != libraries {
        let colours = if found.len() == 1 { "colour" } else { "colours" };
        let main = match chosen.len() {
            main if main == found.len() => String::new(),
            main => format!(", {main} of them over half a per cent of the picture"),
        };
        return Err(format!("it has {} {colours}{main}; {wanted}", found.len()));
    }
    let luminance = |[r, g, b]: [u8; 3]| 2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b);
    chosen.sort_by_key(|c| {
        let place = |c| palette.and_then(|p| p.iter().position(|entry| *entry == c));
        c.map(|c| (place(c).unwrap_or(usize::MAX), luminance(c), c))
    });
    Ok(chosen)
}

/// Index of the nearest of some colours; ties go to the first.
fn nearest(main: &[Option<[u8; 3]>], colour: Option<[u8; 3]>) -> u8 {
    let distance = |c: &Option<[u8; 3]>| match (*c, colour) {
        (None, None) => 0,
        (Some(a), Some(b)) => (0..3).map(|i| u32::from(a[i].abs_diff(b[i])).pow(2)).sum(),
        _ => u32::MAX,
    };
    let index = (0..main.len()).min_by_key(|&i| distance(&main[i])).unwrap_or(0);
    u8::try_from(index).unwrap_or(u8::MAX)
}

/// The palette of a palette PNG.
fn palette(bytes: &[u8]) -> Option<Vec<[u8; 3]>> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    let info = decoder.read_header_info().ok()?;
    if info.color_type != png::ColorType::Indexed {
        return None;
    }
    let reader = decoder.read_info().ok()?;
    let entries = reader.info().palette.as_ref()?.chunks_exact(3);
    Some(entries.map(|e| [e[0], e[1], e[2]]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::picture::testing::{at, encode};
    use image::{DynamicImage, GrayImage, Luma, LumaA, Rgb, RgbImage, Rgba};

    #[test]
    fn density_is_linear_in_the_grey_value() {
        let wide = image::ImageBuffer::from_fn(3, 1, |x, _| Luma([(x * 32_768).min(65_535) as u16]));
        let map = density(&encode(wide.into()), "d.png").unwrap();
        assert_eq!([at(&map, 0, 0), at(&map, 2, 0)], [0.0, 2.0]);
        assert!((at(&map, 1, 0) - 1.0).abs() < 1e-4);
        // Transparent black and white do not change the density; half transparent do half.
        let pixels = [[0, 0], [255, 0], [255, 51]];
        let clear = image::ImageBuffer::from_fn(3, 1, |x, _| LumaA::<u8>(pixels[x as usize]));
        let map = density(&encode(clear.into()), "d.png").unwrap();
        assert_eq!([at(&map, 0, 0), at(&map, 1, 0)], [1.0, 1.0]);
        assert!((at(&map, 2, 0) - 1.2).abs() < 1e-6);
    }

    #[test]
    fn one_grey_map_mixes_two_libraries() {
        let ramp = encode(GrayImage::from_fn(256, 2, |x, _| Luma([x as u8])).into());
        let maps = shares(&[("m.png", &ramp)], 2).unwrap();
        for x in [0, 51, 255] {
            let second = f64::from(x) / 255.0;
            assert!((at(&maps[1], x, 1) - second).abs() < 1e-6);
            assert!((at(&maps[0], x, 1) + at(&maps[1], x, 1) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_map_for_each_library() {
        let level = |v: u8| encode(GrayImage::from_pixel(2, 2, Luma([v])).into());
        let (black, half, white) = (level(0), level(51), level(255));
        let maps = shares(&[("a", &black), ("b", &half), ("c", &white)], 3).unwrap();
        let values: Vec<f64> = maps.iter().map(|m| at(m, 0, 0)).collect();
        assert!(values[0] == 0.0 && (values[1] - 0.2).abs() < 1e-6 && values[2] == 1.0, "{values:?}");
        let error = shares(&[("a", &black), ("b", &half)], 3).unwrap_err();
        assert!(error.to_string().contains("2 maps for 3 libraries"), "{error}");
    }

    const LOGO: [[u8; 3]; 3] = [[200, 30, 30], [20, 30, 90], [250, 240, 230]];

    /// Three stripes, with soft borders between.
    fn stripes() -> RgbImage {
        RgbImage::from_fn(300, 40, |x, y| {
            let (a, b) = (LOGO[(x / 100) as usize], LOGO[((x + 1) / 100).min(2) as usize]);
            let mixed =
                std::array::from_fn(|i| ((u32::from(a[i]) * y + u32::from(b[i]) * (40 - y)) / 40) as u8);
            Rgb(if x % 100 == 99 { mixed } else { a })
        })
    }

    /// The library that fills each of the three stripes.
    fn order(maps: &[ControlMap]) -> [usize; 3] {
        [50, 150, 250].map(|x| maps.iter().position(|m| at(m, x, 20) == 1.0).unwrap())
    }

    #[test]
    fn colours_stand_for_libraries_from_dark_to_light() {
        let maps = shares(&[("logo.png", &encode(stripes().into()))], 3).unwrap();
        assert_eq!(order(&maps), [1, 0, 2]);
        for x in 0..300 {
            let sum: f64 = maps.iter().map(|m| at(m, x, 7)).sum();
            assert_eq!(sum, 1.0);
        }
        let clear = image::RgbaImage::from_fn(300, 40, |x, y| {
            let [r, g, b] = stripes().get_pixel(x, y).0;
            Rgba([r, g, b, if x < 100 { 0 } else { 255 }])
        });
        let maps = shares(&[("logo.png", &encode(DynamicImage::from(clear)))], 3).unwrap();
        assert_eq!(order(&maps), [0, 1, 2]);
    }

    #[test]
    fn a_palette_has_its_own_order() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 300, 1);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette([LOGO[2], LOGO[0], LOGO[1]].concat());
        let data: Vec<u8> = (0..300).map(|x| (x / 100) as u8).collect();
        encoder.write_header().unwrap().write_image_data(&data).unwrap();
        assert_eq!(order(&shares(&[("index.png", &bytes)], 3).unwrap()), [0, 1, 2]);
    }

    #[test]
    fn a_wrong_number_of_colours_is_told() {
        let photo =
            RgbImage::from_fn(300, 300, |x, y| Rgb([x as u8, y as u8, (x / 256 + y / 256 * 2) as u8]));
        for (picture, libraries, message) in [
            (stripes(), 2, "it has 81 colours, 3 of them over half a per cent of the picture; 2 are needed"),
            (stripes(), 4, "4 are needed for 4 libraries"),
            (RgbImage::new(9, 9), 3, "it has 1 colour; 3 are needed"),
            (photo, 3, "it has more than 65536 colours; 3 are needed"),
        ] {
            let error = shares(&[("map.png", &encode(picture.into()))], libraries).unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
            assert!(error.hint().is_some());
        }
    }
}
