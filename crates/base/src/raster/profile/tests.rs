use super::*;
use image::{GrayImage, Luma, Rgb, Rgba, RgbaImage};
use moxcms::{LutDataType, LutStore, LutType, Matrix3d};

/// A profile of inks in sixteen colours: those of `lab` for cyan, magenta, yellow and black, mixed by multiplication.
pub(in crate::raster) fn of_inks() -> Vec<u8> {
    // Light that is left of red, green and blue.
    let left = [[0.05, 0.55, 0.8], [0.8, 0.1, 0.45], [0.95, 0.85, 0.1], [0.12, 0.11, 0.1]];
    let clut = (0..16u32).flat_map(|corner| {
        let has = |ink: u32| corner >> (3 - ink) & 1 == 1;
        let light = |k: usize| (0..4).filter(|i| has(*i)).map(|i| left[i as usize][k]).product::<f64>();
        // Roughly Lab, in the encoding of 16 bits.
        let [r, g, b] = [light(0), light(1), light(2)];
        let lab = [100.0 * libm::cbrt(g), 60.0 * (r - g), 60.0 * (g - b)];
        let shares = [lab[0] / 100.0 * 65280.0, (lab[1] + 128.0) * 256.0, (lab[2] + 128.0) * 256.0];
        shares.map(|v| libm::round(v.clamp(0.0, 65535.0)) as u16)
    });
    let straight = |count: usize| LutStore::Store16([0, 65535].repeat(count));
    let lut = LutDataType {
        num_input_channels: 4,
        num_output_channels: 3,
        num_clut_grid_points: 2,
        matrix: Matrix3d { v: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] },
        num_input_table_entries: 2,
        num_output_table_entries: 2,
        input_table: straight(4),
        clut_table: LutStore::Store16(clut.collect()),
        output_table: straight(3),
        lut_type: LutType::Lut16,
    };
    let mut profile = ColorProfile::new_srgb();
    (profile.red_trc, profile.green_trc, profile.blue_trc, profile.cicp) = (None, None, None, None);
    (profile.color_space, profile.pcs) = (DataColorSpace::Cmyk, DataColorSpace::Lab);
    profile.profile_class = moxcms::ProfileClass::OutputDevice;
    profile.lut_a_to_b_perceptual = Some(LutWarehouse::Lut(lut));
    let mut bytes = profile.encode().unwrap();
    // The second version, in which black is that of the inks.
    bytes[8..12].copy_from_slice(&[2, 0x40, 0, 0]);
    bytes
}

fn of(profile: &ColorProfile) -> ColourProfile {
    ColourProfile::from_icc(&profile.encode().unwrap()).unwrap()
}

/// A picture of one pixel, converted.
fn pixel(profile: &ColourProfile, rgb: [u8; 3]) -> [u8; 3] {
    let mut image = DynamicImage::from(RgbImage::from_pixel(1, 1, Rgb(rgb)));
    profile.converted(&mut image).unwrap();
    image.into_rgb8().get_pixel(0, 0).0
}

#[track_caller]
fn near(found: [u8; 3], wanted: [u8; 3], by: u8) {
    assert!(found.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= by), "{found:?}, not {wanted:?}");
}

#[test]
fn rgb_is_that_of_another_program() {
    // By Little CMS.
    let p3 = of(&ColorProfile::new_display_p3());
    for (stored, wanted) in [
        ([184, 56, 42], [200, 40, 30]),
        ([255, 0, 0], [255, 0, 0]),
        ([10, 200, 30], [0, 204, 0]),
        ([128, 128, 128], [128, 128, 128]),
        ([250, 240, 20], [252, 240, 0]),
        ([0, 0, 0], [0, 0, 0]),
        ([255, 255, 255], [255, 255, 255]),
    ] {
        near(pixel(&p3, stored), wanted, 1);
    }
    let adobe = of(&ColorProfile::new_adobe_rgb());
    for (stored, wanted) in
        [([184, 56, 42], [213, 53, 37]), ([100, 150, 100], [66, 151, 97]), ([10, 200, 30], [0, 201, 0])]
    {
        near(pixel(&adobe, stored), wanted, 1);
    }
}

#[test]
fn srgb_is_recognised() {
    assert!(of(&ColorProfile::new_srgb()).is_srgb());
    assert!(ColourProfile::of_primaries(Curve::srgb(), None).unwrap().is_srgb());
    for other in [ColorProfile::new_display_p3(), ColorProfile::new_adobe_rgb(), ColorProfile::new_bt2020()] {
        assert!(!of(&other).is_srgb());
    }
    assert!(!of(&ColorProfile::new_gray_with_gamma(1.8)).is_srgb());
    assert!(!ColourProfile::from_icc(&of_inks()).unwrap().is_srgb());
}

#[test]
fn deep_samples_keep_their_depth_and_opacity_stays() {
    let p3 = of(&ColorProfile::new_display_p3());
    for rgb in [[184, 56, 42], [3, 2, 1], [90, 200, 130]] {
        let shallow = pixel(&p3, rgb);
        let deep = image::ImageBuffer::from_pixel(
            1,
            1,
            Rgba([rgb[0], rgb[1], rgb[2], 77].map(|v| u16::from(v) * 257)),
        );
        let mut deep = DynamicImage::ImageRgba16(deep);
        p3.converted(&mut deep).unwrap();
        let DynamicImage::ImageRgba16(deep) = deep else { panic!("another depth") };
        let [r, g, b, alpha] = deep.get_pixel(0, 0).0;
        assert_eq!(alpha, 77 * 257);
        near([r, g, b].map(|v| libm::round(f64::from(v) / 257.0) as u8), shallow, 0);
        let clear = RgbaImage::from_pixel(1, 1, Rgba([rgb[0], rgb[1], rgb[2], 77]));
        let mut clear = DynamicImage::from(clear);
        p3.converted(&mut clear).unwrap();
        assert_eq!(clear.into_rgba8().get_pixel(0, 0).0, [shallow[0], shallow[1], shallow[2], 77]);
    }
}

#[test]
fn grey_stays_grey_and_follows_profiles_of_rgb() {
    let grey = || DynamicImage::from(GrayImage::from_fn(256, 1, |x, _| Luma([x as u8])));
    let mut by_grey = grey();
    of(&ColorProfile::new_gray_with_gamma(1.8)).converted(&mut by_grey).unwrap();
    let by_grey = by_grey.as_luma8().unwrap();
    // 255 · encoded((64 / 255)^1.8).
    assert_eq!([0, 64, 255].map(|x| by_grey.get_pixel(x, 0).0[0]), [0, 81, 255]);
    let mut by_rgb = grey();
    of(&ColorProfile::new_display_p3()).converted(&mut by_rgb).unwrap();
    for (x, _, p) in by_rgb.into_rgb8().enumerate_pixels() {
        near(p.0, [x as u8; 3], 1);
    }
}

#[test]
fn inks_become_colours() {
    let profile = ColourProfile::from_icc(&of_inks()).unwrap();
    for (inks, wanted) in INKS {
        let deep = inks.map(|v| u16::from(v) * 257);
        near(profile.of_inks(&inks, [1, 1]).get_pixel(0, 0).0, wanted, 2);
        near(profile.of_inks(&deep, [1, 1]).get_pixel(0, 0).0, wanted, 2);
    }
    // Some pieces of pixels, each in its place.
    let many: Vec<u8> = (0..40_000u32).flat_map(|i| [(i / 157) as u8, 0, 0, 0]).collect();
    let image = profile.of_inks(&many, [200, 200]);
    assert!(
        image
            .pixels()
            .zip(many.chunks(4))
            .all(|(p, inks)| { p.0 == profile.of_inks(inks, [1, 1]).get_pixel(0, 0).0 })
    );
}

/// Inks and their colours by Little CMS.
const INKS: [([u8; 4], [u8; 3]); 6] = [
    ([0, 0, 0, 0], [255, 255, 255]),
    ([255, 255, 255, 255], [0, 0, 0]),
    ([0, 0, 0, 255], [109, 107, 106]),
    ([255, 0, 0, 0], [108, 220, 230]),
    ([30, 60, 90, 20], [215, 201, 196]),
    ([128, 100, 90, 50], [146, 163, 169]),
];

#[test]
fn what_does_not_fit_is_an_error() {
    let mut colours = DynamicImage::from(RgbImage::new(1, 1));
    assert!(of(&ColorProfile::new_gray_with_gamma(1.8)).converted(&mut colours).is_err());
    assert!(ColourProfile::from_icc(&of_inks()).unwrap().converted(&mut colours).is_err());
    let mut floats = DynamicImage::ImageRgb32F(image::ImageBuffer::new(1, 1));
    assert!(of(&ColorProfile::new_display_p3()).converted(&mut floats).is_err());
    assert!(ColourProfile::from_icc(&ColorProfile::new_lab().encode().unwrap()).is_err());
    assert!(ColourProfile::from_icc(b"").is_err() && ColourProfile::from_icc(&[7; 300]).is_err());
}

#[test]
fn damaged_profiles_are_errors_or_profiles() {
    let whole = [ColorProfile::new_display_p3().encode().unwrap(), of_inks()];
    let mut random = crate::sampling::stream(58, "profile/tests", 0);
    let mut read = 0;
    for i in 0..3000 {
        let mut bytes = whole[i % 2].clone();
        for _ in 0..1 + random.index(6) {
            let at = random.index(bytes.len());
            bytes[at] = random.bits() as u8;
        }
        bytes.truncate(bytes.len() - if i % 5 == 0 { random.index(bytes.len()) } else { 0 });
        let Ok(profile) = ColourProfile::from_icc(&bytes) else { continue };
        read += 1;
        profile.is_srgb();
        if profile.is_for_inks() {
            profile.of_inks(&[0u8, 99, 255, 7], [1, 1]);
        } else {
            let _ = profile.converted(&mut DynamicImage::from(RgbImage::from_pixel(1, 1, Rgb([9, 99, 255]))));
        }
    }
    assert!(read > 500, "{read}");
}
