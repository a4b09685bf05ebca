//! Measures agree with stored values of metrics.py on numpy, scipy, scikit-image, POT and PyIQA.

use super::*;
use std::path::Path;

/// Reference values for one pair of pictures, in the order of [`exact`]; random ones with their standard
/// deviation over the draws.
struct Case {
    exemplar: (&'static str, [u32; 4]),
    result: (&'static str, [u32; 4]),
    window: usize,
    exact: [f64; 11],
    ms_ssim: Option<f64>,
    levels: [(f64, f64); 4],
    /// Coherence and completeness.
    patches: [(f64, f64); 2],
}

const CASES: [Case; 3] = [
    Case {
        exemplar: ("pebbles", [0, 0, 193, 180]),
        result: ("pebbles", [300, 250, 190, 201]),
        window: 176,
        exact: [
            14.713_321,
            6.242_818,
            0.354_636,
            0.639_120,
            0.001_026_918,
            0.075_137_5,
            181.374_230,
            178.294_266,
            0.226_504_8,
            0.265_379_6,
            0.243_794_7,
        ],
        ms_ssim: Some(0.129_865_9),
        levels: [
            (0.028_497, 0.000_705),
            (0.097_305, 0.003_619),
            (0.095_117, 0.004_385),
            (0.418_584, 0.013_405),
        ],
        patches: [(1.027_379, 0.008_865), (1.041_262, 0.002_881)],
    },
    Case {
        exemplar: ("terrazzo", [10, 20, 120, 100]),
        result: ("leaves", [200, 40, 97, 150]),
        window: 96,
        exact: [
            75.322_179,
            49.789_208,
            1.191_808,
            1.474_171,
            0.021_454_8,
            7.680_151,
            476.335_722,
            228.182_146,
            0.405_631,
            0.293_246,
            0.199_846,
        ],
        ms_ssim: None,
        levels: [
            (0.840_740, 0.010_169),
            (0.962_349, 0.019_350),
            (1.488_933, 0.022_876),
            (4.640_643, 0.118_821),
        ],
        patches: [(4.237_706, 0.030_781), (4.112_100, 0.040_049)],
    },
    // Pictures smaller than a window.
    Case {
        exemplar: ("concrete", [50, 60, 64, 62]),
        result: ("flowers", [7, 9, 70, 80]),
        window: 64,
        exact: [
            87.543_580,
            43.098_887,
            1.663_093,
            1.838_149,
            0.069_830_1,
            56.163_738,
            143.276_040,
            302.957_553,
            0.232_086,
            0.287_372,
            0.199_998,
        ],
        ms_ssim: None,
        levels: [
            (1.134_375, 0.014_775),
            (3.030_795, 0.068_797),
            (5.324_583, 0.044_343),
            (18.799_437, 0.456_601),
        ],
        patches: [(10.732_654, 0.242_111), (10.264_812, 0.232_334)],
    },
];

/// The measures of [`Case::exact`] and MS-SSIM.
fn exact(a: &RgbImage, b: &RgbImage, window: usize) -> ([(&'static str, f64); 11], Option<f64>) {
    let (x, y) = (Channel::grey(a), Channel::grey(b));
    assert_eq!(spectrum::window(&x, &y), window);
    let [psd_radial, psd_2d] = spectrum::psd(&x, &y, window);
    let (ssim, ms_ssim) = similarity::ssim(&x, &y);
    let measures = [
        ("emd_rgb", colour::emd_rgb(a, b)),
        ("emd_lab", colour::emd_lab(a, b)),
        ("psd_radial", psd_radial),
        ("psd_2d", psd_2d),
        ("lbp", local_patterns::lbp(&x, &y)),
        ("fb_frechet", filter_bank::frechet(&Channel::lab(a), &Channel::lab(b))),
        ("lapvar_exemplar", sharpness::lapvar(&x)),
        ("lapvar_result", sharpness::lapvar(&y)),
        ("acf_peak_exemplar", spectrum::acf_peak(&x)),
        ("acf_peak_result", spectrum::acf_peak(&y)),
        ("ssim", ssim),
    ];
    (measures, ms_ssim)
}

fn part((name, [x, y, width, height]): (&str, [u32; 4])) -> RgbImage {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/exemplars");
    let image = image::open(folder.join(name).with_extension("png")).unwrap().into_rgb8();
    image::imageops::crop_imm(&image, x, y, width, height).to_image()
}

/// Whether two values agree within 0.001, relative to the wanted value if that exceeds 1.
fn close(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() <= 1e-3 * wanted.abs().clamp(1e-3, 1.0)
}

#[test]
fn measures_are_those_of_another_program() {
    for case in CASES {
        let (found, ms_ssim) = exact(&part(case.exemplar), &part(case.result), case.window);
        for ((name, value), wanted) in found.into_iter().zip(case.exact) {
            assert!(close(value, wanted), "{name} of {}: {value}, not {wanted}", case.exemplar.0);
        }
        match (ms_ssim, case.ms_ssim) {
            (Some(a), Some(b)) => assert!(close(a, b), "{a} {b}"),
            (a, b) => assert_eq!(a, b),
        }
    }
}

#[test]
fn what_is_drawn_at_random_is_near() {
    // Other draws of the same measures: five standard deviations. Uses the smallest pair for speed.
    let case = &CASES[2];
    let (a, b) = (Channel::lab(&part(case.exemplar)), Channel::lab(&part(case.result)));
    for (value, (mean, deviation)) in patches::swd(&a, &b).into_iter().zip(case.levels) {
        assert!((value - mean).abs() < 5.0 * deviation, "{value}, not {mean}");
    }
    let found = patches::completeness(&a, &b).unwrap();
    for (value, (mean, deviation)) in [found.coherence, found.completeness].into_iter().zip(case.patches) {
        assert!((value - mean).abs() < 5.0 * deviation, "{found:?}");
    }
}

#[test]
fn a_picture_is_at_no_distance_from_itself() {
    let picture = part(("leaves", [0, 0, 64, 50]));
    let m = compare(&picture, &picture, &()).unwrap();
    let zeros = [m.emd_rgb, m.emd_lab, m.psd_radial, m.psd_2d, m.lbp, m.lapvar_logratio];
    assert_eq!(zeros, [0.0; 6]);
    assert!(m.fb_frechet < 1e-6 && (m.ssim - 1.0).abs() < 1e-9, "{m:?}");
    // The remainder is sampling noise.
    assert!(m.swd < 0.1, "{m:?}");
    assert_eq!((m.acf_peak_exemplar, m.coherence), (m.acf_peak_result, None));
}

#[test]
fn flat_pictures_give_numbers_too() {
    let flat = RgbImage::from_pixel(60, 60, image::Rgb([90, 90, 90]));
    let found = compare(&flat, &part(("leaves", [0, 0, 60, 60])), &()).unwrap();
    for (name, value) in serde_json::to_value(found).unwrap().as_object().unwrap() {
        // Pictures have no contours to enlarge, and these are too small for `ms_ssim`.
        assert!(!value.is_null() || ["ms_ssim", "contours"].contains(&name.as_str()), "{name}");
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let [small, good, huge] = [[31, 90], [32, 40], [4097, 4096]]
        .map(|[w, h]| RgbImage::from_fn(w, h, |x, y| image::Rgb([x as u8, y as u8, 7])));
    assert!(matches!(compare(&good, &small, &()), Err(Error::Unusable { .. })));
    assert!(matches!(compare(&huge, &good, &()), Err(Error::TooLarge { .. })));
    assert!(matches!(compare(&good, &good, &vtex_testing::StopAtOnce), Err(Error::Interrupted)));
    assert!(matches!(scaled(good.clone(), 0.0), Err(Error::Parameter { .. })));
    assert!(matches!(scaled(good.clone(), f64::NAN), Err(Error::Parameter { .. })));
    assert!(matches!(scaled(huge.clone(), 0.5), Err(Error::TooLarge { .. })));
    assert_eq!(scaled(good.clone(), 2.0).unwrap().dimensions(), (16, 20));
    assert_eq!(reduced([good.clone(), good.clone()], &()), [good.clone(), good.clone()]);
    // By one factor, so that both still show the texture at one scale.
    let [large, small] = reduced([huge, RgbImage::new(2048, 1024)], &());
    let pixels = |image: &RgbImage| u64::from(image.width()) * u64::from(image.height());
    assert!((MOST_PIXELS - 3_000..=MOST_PIXELS).contains(&pixels(&large)), "{:?}", large.dimensions());
    assert_eq!(small.dimensions(), (632, 316));
}
