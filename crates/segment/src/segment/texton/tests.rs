//! The texton network compared with its exported graph, and the segmenter on generated scenes and unusual
//! images.

use super::*;
use crate::segment::prompt::Embedded;
use rten::{Model, NodeId, Value, ValueOrView};
use rten_tensor::Tensor;
use rten_tensor::prelude::*;
use vtex_base::raster::{Connectivity, LabelMap, components_of_mask};
use vtex_testing::{SceneKind, SceneParams, generate};

const ENCODER: &[u8] = include_bytes!("../../../../../models/texton/encoder.onnx");
const DECODER: &[u8] = include_bytes!("../../../../../models/texton/decoder.onnx");

/// What an exported graph gives for its inputs, run by rten.
fn outputs<const N: usize>(graph: &[u8], inputs: &[(&str, &Tensor)], names: [&str; N]) -> [Tensor; N] {
    let model = Model::load(graph.to_vec()).unwrap();
    let inputs = inputs.iter().map(|(name, tensor)| {
        (model.find_node(name).unwrap(), ValueOrView::from(Value::FloatTensor((*tensor).clone())))
    });
    let wanted: [NodeId; N] = names.map(|name| model.find_node(name).unwrap());
    let values = model.run_n(inputs.collect(), wanted, None).unwrap();
    values.map(|value| value.try_into().unwrap())
}

fn scene(side: u32, seed: u64, kind: SceneKind) -> vtex_testing::GeneratedExemplar {
    generate(&SceneParams { width: side, height: side, seed, kind, ..SceneParams::default() }).unwrap()
}

/// The encoder in Rust agrees with the exported graph.
#[test]
fn encoding_agrees_with_the_graph() {
    let image = scene(112, 5, SceneKind::Gravel).image;
    let (w, h) = (112, 96);
    let mut pixels = Vec::new();
    for c in 0..3 {
        let rows = image.enumerate_pixels().filter(|(_, y, _)| *y < h as u32);
        pixels.extend(rows.map(|(_, _, pixel)| f32::from(pixel.0[c]) / 255.0));
    }
    let input = Tensor::from_data(&[1, 3, h, w], pixels);
    let [out] = outputs(ENCODER, &[("image", &input)], ["image_embeddings"]);
    let image = image::imageops::crop_imm(&image, 0, 0, w as u32, h as u32).to_image();
    let seen = TextonNetwork::built_in().unwrap().view(&image, 0.0).embedding;
    assert_eq!([seen.height, seen.width], out.shape()[2..]);
    let (cells, expected) = (seen.width * seen.height, out.data().unwrap());
    for channel in 0..out.shape()[1] {
        for cell in 0..cells {
            let (a, b) = (seen.cell(cell)[channel], expected[channel * cells + cell]);
            assert!((a - b).abs() < 1e-3 * (1.0 + b.abs()), "channel {channel}, cell {cell}: {a} {b}");
        }
    }
}

/// The decoder in Rust agrees with the exported graph.
#[test]
fn decoding_agrees_with_the_graph() {
    let network = TextonNetwork::built_in().unwrap();
    let seen = network.view(&scene(64, 3, SceneKind::Terrazzo).image, 0.0);
    let e = &seen.embedding;
    let (w, h) = (e.width, e.height);
    let mut window = Vec::new();
    for c in 0..e.cell(0).len() {
        window.extend((0..w * h).map(|i| e.cell(i)[c]));
    }
    let embedding = Tensor::from_data(&[1, window.len() / (w * h), h, w], window);
    let mut compared = 0;
    for point in [[11.0, 9.0], [40.0, 22.0], [31.0, 55.0]] {
        let at = Tensor::from_data(&[1, 1, 2], point.map(|v: f32| (v / 2.0).floor()).to_vec());
        let inputs = [("image_embeddings", &embedding), ("point_coords", &at)];
        let [logits, ious] = outputs(DECODER, &inputs, ["low_res_masks", "iou_predictions"]);
        let (logits, ious) = (logits.data().unwrap(), ious.data().unwrap());
        for mask in seen.masks(&[point]).unwrap().remove(0) {
            let same = |head: &usize| (mask.predicted_iou - ious[*head]).abs() < 1e-4;
            let head = (0..ious.len()).find(same).unwrap();
            let l = mask.logits;
            let corner = l.origin.map(|v| (v / 2.0) as usize);
            for y in 0..l.height {
                for x in 0..l.width {
                    let (here, there) = (
                        l.values[y * l.width + x],
                        logits[head * w * h + (corner[1] + y) * w + corner[0] + x],
                    );
                    // Cells far from the mask are not evaluated, so they are not compared.
                    if here > -7.9 {
                        assert!((here - there).abs() < 2e-3 * (1.0 + there.abs()), "{here} {there}");
                        compared += 1;
                    }
                }
            }
        }
    }
    assert!(compared > 200, "{compared} cells");
}

/// The embedding of a large image does not depend on the pieces in which it is encoded.
#[test]
fn pieces_join_without_a_seam() {
    let network = TextonNetwork::built_in().unwrap();
    // There is one row of pieces, and the middle is far from their borders.
    let image =
        generate(&SceneParams { width: 2000, height: 32, seed: 4, ..SceneParams::default() }).unwrap().image;
    let whole = network.view(&image, 0.0).embedding;
    let middle = image::imageops::crop_imm(&image, 640, 0, 720, 32).to_image();
    let part = network.view(&middle, 0.0).embedding;
    let (mut apart, mut n) = (0.0f32, 0.0f32);
    for y in 0..part.height {
        for x in 130..230 {
            let (a, b) = (part.cell(y * part.width + x), whole.cell(y * whole.width + x + 320));
            apart += (a[30] - b[30]).abs();
            // Predicted centres are measured from the corner of the image, in units of 16 px.
            assert!((a[16] + 40.0 - b[16]).abs() < 1.0, "{} {}", a[16], b[16]);
            n += 1.0;
        }
    }
    assert!(apart / n < 0.2, "texton logits differ by {} in the mean", apart / n);
}

#[test]
fn images_of_any_size_are_read() {
    let texton = Texton::new().unwrap();
    for (w, h) in [(0, 0), (1, 1), (1, 70), (17, 16), (64, 48)] {
        let image = RgbImage::from_pixel(w, h, image::Rgb([120, 90, 30]));
        assert_eq!(texton.segment(&image, &()).unwrap(), [], "{w} x {h}");
    }
}

#[test]
fn most_chips_of_a_terrazzo_are_found() {
    let scene = scene(128, 77, SceneKind::Terrazzo);
    let masks = Texton::new().unwrap().segment(&scene.image, &()).unwrap();
    let areas = scene.instances.areas();
    let truth = Mask::all_of_labels(&scene.instances, areas.len());
    let large: Vec<&Mask> = truth.iter().skip(1).filter(|m| m.area() >= 60).collect();
    let found = large.iter().filter(|t| {
        masks.iter().any(|m| {
            let both = t.overlap(&m.mask);
            f64::from(both) >= 0.7 * f64::from(t.area() + m.mask.area() - both)
        })
    });
    let (found, all) = (found.count(), large.len());
    assert!(all > 5 && 10 * found >= 8 * all, "{found} of {all}");
    // The masks are disjoint pieces.
    let mut taken = LabelMap::filled(128, 128, 0);
    for scored in &masks {
        assert_eq!(components_of_mask(&scored.mask, Connectivity::Four).len(), 1);
        assert!(scored.mask.pixels().all(|(x, y)| taken.get(x as u32, y as u32) == 0));
        taken.fill(&scored.mask, 1);
    }
}

#[test]
fn masks_do_not_depend_on_threads() {
    let image = scene(96, 5, SceneKind::Gravel).image;
    let masks = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Texton::new().unwrap().segment(&image, &()).unwrap())
    };
    let one = masks(1);
    assert!(!one.is_empty());
    assert_eq!(one, masks(3));
}

#[test]
fn work_can_be_interrupted() {
    let answer = Texton::new().unwrap().segment(&RgbImage::new(40, 40), &vtex_testing::StopAtOnce);
    assert!(matches!(answer, Err(vtex_base::Error::Interrupted)));
}

/// The indices of features that the segmenter uses are those of the candidate's source.
#[test]
fn nodes_have_a_score_and_masks_a_prediction() {
    let image = scene(128, 5, SceneKind::Terrazzo).image;
    let (mut nodes, mut masks) = (0, 0);
    for MaskCandidate { features, .. } in Texton::new().unwrap().candidates(&image, &()).unwrap() {
        let [predicted, stability, region] = [PREDICTED, STABILITY, REGION].map(|k| features[k]);
        if predicted == 0.0 {
            assert!(stability == 0.0 && (LEAST_NODE_SCORE..=1.0).contains(&region), "{stability} {region}");
            assert!(score(0.0, &features) == REGION_SHARE * region);
            nodes += 1;
        } else {
            assert!((0.3..=1.0).contains(&predicted) && (0.3..=1.0).contains(&stability));
            assert!(score(0.0, &features) > 0.0 && score(1.0, &features) <= 1.0);
            masks += 1;
        }
    }
    assert!(nodes > 10 && masks > 10, "{nodes} {masks}");
}
