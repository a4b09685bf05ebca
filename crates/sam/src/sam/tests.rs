//! Every supported export, with graphs of the same signature whose masks are known; see
//! `tools/sam/make_test_networks.py`.

use super::*;
use crate::engine::testing::{engines, network};
use image::Rgb;
use vtex_segment::segment::prompt::{Logits, Prompter};

/// Red left of `middle`, blue right of it.
fn picture(width: u32, height: u32, middle: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, _| if x < middle { Rgb([255, 0, 0]) } else { Rgb([0, 0, 255]) })
}

/// Normalised red of a red and of a blue pixel.
const RED: f32 = (255.0 - 123.675) / 58.395;
const BLUE: f32 = -123.675 / 58.395;

fn open(files: &[&str], options: &EngineOptions) -> Result<Sam> {
    let paths: Vec<_> = files.iter().map(|name| network(name)).collect();
    let sources: Vec<NetworkSource<'_>> = paths.iter().map(|path| NetworkSource::File(path)).collect();
    Sam::open(&sources, options)
}

/// Checks the masks at one point. `scales` are the network's pixels per pixel of the image.
fn check(
    masks: &[PromptMask],
    point: [f32; 2],
    size: [u32; 2],
    middle: u32,
    scales: [f32; 2],
    slack: f32,
    what: &str,
) {
    let expected: &[(f32, f32)] = match masks.len() {
        3 => &[(60.0, 0.7), (120.0, 0.8), (240.0, 1.0)],
        1 => &[(120.0, 0.8)],
        n => panic!("{what}: {n} masks"),
    };
    for (mask, (radius, score)) in masks.iter().zip(expected) {
        assert_eq!(mask.predicted_iou, *score, "{what}");
        let Logits { origin, step, width, height, values } = &mask.logits;
        assert_eq!(values.len(), width * height, "{what}");
        // The grid covers the image and extends less than a cell beyond it.
        for (k, cells) in [width, height].into_iter().enumerate() {
            let end = origin[k] + step[k] * *cells as f32;
            assert!(origin[k] == 0.0 && end > size[k] as f32 - 0.01, "{what}: {end} of {size:?}");
            assert!(end - step[k] < size[k] as f32, "{what}: {end} of {size:?}");
        }
        let (mut inside, mut compared) = (0, 0);
        for j in 0..*height {
            for i in 0..*width {
                let at = [origin[0] + step[0] * (i as f32 + 0.5), origin[1] + step[1] * (j as f32 + 0.5)];
                // Cells at the border of red and blue, and at the end of the image, are mixed.
                let blurred = 24.0 / scales[0] + 1.0;
                if (at[0] - middle as f32).abs() < blurred
                    || at[0] > size[0] as f32 - blurred
                    || at[1] > size[1] as f32 - (24.0 / scales[1] + 1.0)
                {
                    continue;
                }
                let away = [0, 1].map(|k| (at[k] - point[k]) * scales[k]);
                let square = away[0] * away[0] + away[1] * away[1];
                let disc = radius * radius - square;
                let colour = 100.0 * if at[0] < middle as f32 { RED } else { BLUE };
                // Interpolation rounds corners where masks meet, and at the image's border.
                let edge = at[0] * scales[0] < 4.0 || at[1] * scales[1] < 4.0;
                if slack > 1.0 && (edge || (disc - colour).abs() < 8.0 * 2.0 * square.sqrt()) {
                    continue;
                }
                let wanted = disc.min(colour);
                let found = values[j * width + i];
                let error = (found - wanted).abs();
                assert!(error <= slack + 2e-4 * wanted.abs(), "{what} at {at:?}: {found}, not {wanted}");
                compared += 1;
                inside += usize::from(found > 0.0);
            }
        }
        assert!(inside > 100 && inside < compared, "{what}: {inside} of {compared} inside");
    }
}

/// Files, whether the image is stretched, and how exact the logits are: those that the graph scales to
/// the image are interpolated.
const PAIRS: [(&[&str], bool, f32); 10] = [
    (&["sam_encoder", "sam_decoder"], false, 0.1),
    (&["sam_decoder", "sam_encoder_rows"], false, 0.1),
    (&["sam_encoder_bytes", "sam_decoder"], false, 0.1),
    (&["sam_encoder", "sam_decoder_single"], false, 10.0),
    (&["optimum_encoder", "optimum_decoder"], false, 0.1),
    (&["efficient_encoder", "efficient_decoder"], true, 0.1),
    (&["efficient_both"], true, 10.0),
    (&["sam2_encoder", "sam2_decoder"], true, 0.1),
    (&["sam2_encoder", "sam2_decoder_alone"], true, 0.1),
    (&["sam2_decoder", "sam2_encoder"], true, 0.1),
];

#[test]
fn masks_of_every_export_are_those_computed_by_hand() {
    for (i, options) in engines().iter().enumerate() {
        for (j, (files, stretched, slack)) in PAIRS.into_iter().enumerate() {
            let sam = open(files, options).unwrap();
            // One image is wide, the other tall.
            let (size, middle) = [([90, 60], 50), ([60, 150], 30)][(i + j) % 2];
            let what = format!("{files:?} {size:?} by {:?}", options.runtime);
            // The longer side becomes 1024; the other is rounded.
            let longest = size[0].max(size[1]) as f32;
            let seen =
                |k: usize| if stretched { 1024.0 } else { (size[k] as f32 * 1024.0 / longest).round() };
            let scales = [0, 1].map(|k| seen(k) / size[k] as f32);
            let embedded = sam.embed(&picture(size[0], size[1], middle)).unwrap();
            let points = [[20.0, 30.25], [26.5, 24.0], [14.0, 38.0]];
            let masks = embedded.masks(&points).unwrap();
            assert_eq!(masks.len(), points.len());
            for (masks, point) in masks.iter().zip(points) {
                check(masks, point, size, middle, scales, slack, &what);
            }
        }
    }
}

#[test]
fn points_are_asked_for_together_only_where_that_works() {
    for options in engines() {
        for (files, batches) in [
            (["sam_encoder", "sam_decoder"], [1, 1]),
            (["optimum_encoder", "optimum_decoder"], [16, 16]),
            (["efficient_encoder", "efficient_decoder"], [16, 16]),
            (["sam2_encoder", "sam2_decoder"], [16, 16]),
            // The axis is free, but every point gets the masks of the first.
            (["sam2_encoder", "sam2_decoder_alone"], [16, 1]),
        ] {
            let sam = open(&files, &options).unwrap();
            let embedded = sam.embed(&picture(64, 48, 40)).unwrap();
            let before = embedded.batch();
            let points: Vec<[f32; 2]> = (0..18).map(|i| [6.0 + i as f32, 40.0 - i as f32]).collect();
            let all = embedded.masks(&points).unwrap();
            assert_eq!([before, embedded.batch()], batches, "{files:?}");
            assert_eq!(embedded.masks(&[]).unwrap(), Vec::<Vec<PromptMask>>::new());
            for (i, point) in points.iter().enumerate().step_by(5) {
                assert_eq!(embedded.masks(&[*point]).unwrap()[0], all[i], "{files:?} {point:?}");
            }
        }
    }
}

#[test]
fn images_of_any_shape_can_be_shown() {
    let options = &engines()[0];
    for (files, ..) in [PAIRS[0], PAIRS[1], PAIRS[2], PAIRS[5], PAIRS[7]] {
        let sam = open(files, options).unwrap();
        for size in [[1, 1], [2000, 3], [3, 2000], [1500, 1100]] {
            let embedded = sam.embed(&picture(size[0], size[1], size[0].div_ceil(2))).unwrap();
            for point in [[0.5, 0.5], [size[0] as f32, size[1] as f32], [0.0, 0.0]] {
                let masks = embedded.masks(&[point]).unwrap();
                let logits = &masks[0][0].logits;
                assert!(logits.width > 0 && logits.height > 0, "{files:?} {size:?}");
                assert_eq!(logits.values.len(), logits.width * logits.height);
            }
        }
        assert!(matches!(sam.embed(&RgbImage::new(0, 5)), Err(Error::Network { .. })));
    }
}

#[test]
fn files_that_do_not_go_together_are_named() {
    for options in engines() {
        for (files, message) in [
            (&["sam_encoder", "sam2_decoder"][..], "do not go together"),
            (&["optimum_encoder", "sam_decoder"], "is an encoder of SAM by Optimum"),
            (&["sam_encoder", "sam_encoder_rows"], "it is a second encoder"),
            (&["sam_encoder"], "the decoder is missing"),
            (&["sam2_decoder"], "the encoder is missing"),
            (&["efficient_both", "efficient_decoder"], "it is a second decoder"),
            (&[], "the encoder is missing"),
            (&["sam_encoder", "product"], "Its signature is\n  a [?×300], b [300×?] -> product"),
        ] {
            let Err(error) = open(files, &options) else { panic!("{files:?} pass") };
            let said = error.to_string();
            assert!(said.contains(message) && error.hint().is_some(), "{files:?}: {said}");
            assert_eq!(said.contains("Those known are"), files.contains(&"product"), "{said}");
        }
    }
}

#[test]
fn roles_are_told_from_the_graph() {
    let options = &engines()[0];
    for (name, role) in [
        ("sam_encoder_bytes", (SamRole::Encoder, "SAM")),
        ("sam_decoder_single", (SamRole::Decoder, "SAM")),
        ("optimum_encoder", (SamRole::Encoder, "SAM by Optimum")),
        ("efficient_both", (SamRole::Both, "EfficientSAM")),
        ("sam2_decoder", (SamRole::Decoder, "SAM 2")),
    ] {
        let loaded = engine::load(NetworkSource::File(&network(name)), options).unwrap();
        assert_eq!(recognise(loaded.as_ref(), name).unwrap(), role, "{name}");
    }
}
