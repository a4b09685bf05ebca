//! Signatures of the common ONNX exports of Segment Anything. An export is recognised by the names and
//! shapes of its inputs and outputs, never by its file name.
//!
//! | export | image encoder | prompt decoder |
//! |---|---|---|
//! | SAM: Meta's script, MobileSAM, samexporter | image → embedding | `image_embeddings`, `point_coords`, `point_labels`, `mask_input`, `has_mask_input`, `orig_im_size` → `low_res_masks` or `masks`, `iou_predictions` |
//! | SAM by Hugging Face Optimum | `pixel_values` → `image_embeddings`, `image_positional_embeddings` | both, `input_points`, `input_labels` → `pred_masks`, `iou_scores` |
//! | EfficientSAM | `batched_images` → `image_embeddings` | `image_embeddings`, `batched_point_coords`, `batched_point_labels`, `orig_im_size` → `output_masks`, `iou_predictions` |
//! | EfficientSAM in one file | | `batched_images` in place of `image_embeddings` |
//! | SAM 2: samexporter | image → `image_embed`, `high_res_feats_0`, `high_res_feats_1` | all three, the rest as SAM → `masks`, `iou_predictions` |
//!
//! Encoders of SAM differ in their preprocessing. An input of height × width × 3 takes 8-bit values as
//! floats; the graph normalises and pads them. An input of 1 × 3 × height × width takes normalised,
//! padded values, unless both sides are free. Then the graph itself must pad, because the network
//! takes only one size, and it also normalises.

use crate::engine::Port;

/// A family of exports whose encoders and decoders fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    Sam,
    Optimum,
    Efficient,
    Sam2,
}

impl Family {
    /// Name for messages.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Sam => "SAM",
            Self::Optimum => "SAM by Optimum",
            Self::Efficient => "EfficientSAM",
            Self::Sam2 => "SAM 2",
        }
    }
}

/// Order of the axes of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxisOrder {
    /// 1 × 3 × height × width.
    Planes,
    /// height × width × 3.
    Rows,
    /// 1 × height × width × 3.
    BatchedRows,
}

/// The values that represent a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pixels {
    /// Minus the mean and divided by the standard deviation of ImageNet's pixels.
    Normalised,
    /// 0 to 255.
    Bytes,
    /// 0 to 1.
    Unit,
}

/// How an image is fitted to the network's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// Scaled uniformly; the rest at the right or below is filled with the mean colour.
    Padded,
    /// Scaled uniformly; the graph fills the rest.
    Whole,
    /// Stretched to the full size.
    Stretched,
}

/// Inputs and outputs of an encoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct EncoderPorts {
    pub(super) family: Family,
    /// Name of its input.
    pub(super) input: String,
    pub(super) layout: AxisOrder,
    pub(super) pixels: Pixels,
    pub(super) fit: Fit,
    /// Width and height of its input image. Unused if `fit` is [`Fit::Whole`].
    pub(super) size: [usize; 2],
    /// Names of each output that the decoder needs: in the encoder, and in the decoder.
    pub(super) features: Vec<(String, String)>,
}

/// Inputs and outputs of a decoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Decoder {
    pub(super) family: Family,
    pub(super) points: String,
    pub(super) labels: String,
    /// Whether points and labels have an image axis before the prompt axis.
    pub(super) nested: bool,
    /// Number of prompts per run, if the graph fixes it.
    pub(super) prompts: Option<usize>,
    /// Number of points per prompt; those after the first are padding.
    pub(super) points_each: usize,
    /// Names of inputs that only decoders of SAM and SAM 2 have; the first with the size of a mask.
    pub(super) mask_input: Option<(String, [usize; 2])>,
    pub(super) has_mask: Option<String>,
    pub(super) image_size: Option<String>,
    pub(super) masks: String,
    pub(super) scores: String,
    /// Whether masks cover the image rather than the network's square.
    pub(super) of_image: bool,
}

/// The role of a graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum GraphRole {
    Encoder(EncoderPorts),
    Decoder(Decoder),
    /// Both in one graph: the encoder's input is one of the decoder's.
    Both(EncoderPorts, Decoder),
}

/// Side of the network's square, if the graph does not fix it.
const SIDE: usize = 1024;

/// Side of the masks before the graph scales them up.
pub(super) const MASK_SIDE: usize = 256;

/// Recognises a graph by its inputs and outputs; `None` if no signature matches.
pub(super) fn recognise(inputs: &[Port], outputs: &[Port]) -> Option<GraphRole> {
    let decoder = decoder(inputs, outputs);
    let encoder = encoder(inputs, outputs, decoder.is_some());
    match (encoder, decoder) {
        (Some(encoder), Some(decoder)) => Some(GraphRole::Both(encoder, decoder)),
        (Some(encoder), None) => Some(GraphRole::Encoder(encoder)),
        (None, Some(decoder)) => Some(GraphRole::Decoder(decoder)),
        (None, None) => None,
    }
}

fn port<'a>(ports: &'a [Port], name: &str) -> Option<&'a Port> {
    ports.iter().find(|port| port.name == name)
}

fn has_all(ports: &[Port], names: &[&str]) -> bool {
    names.iter().all(|name| port(ports, name).is_some())
}

/// Length of an axis; `None` if the graph does not fix it.
fn length(port: &Port, axis: usize) -> Option<usize> {
    (*port.shape.as_ref()?.get(axis)?).filter(|n| *n > 0)
}

fn encoder(inputs: &[Port], outputs: &[Port], decodes: bool) -> Option<EncoderPorts> {
    let same = |names: &[&str]| names.iter().map(|n| ((*n).to_owned(), (*n).to_owned())).collect();
    let image = if let Some(image) = port(inputs, "batched_images") {
        image
    } else if let ([image], false) = (inputs, decodes) {
        image
    } else {
        return None;
    };
    let (layout, size) = layout(image)?;
    let fixed = [size[0].unwrap_or(SIDE), size[1].unwrap_or(SIDE)];
    let planes = |family, pixels, fit, features| {
        let input = image.name.clone();
        (layout == AxisOrder::Planes).then_some(EncoderPorts {
            family,
            input,
            layout,
            pixels,
            fit,
            size: fixed,
            features,
        })
    };
    if image.name == "batched_images" {
        let features = if decodes { Vec::new() } else { same(&["image_embeddings"]) };
        let complete = decodes || port(outputs, "image_embeddings").is_some();
        return planes(Family::Efficient, Pixels::Unit, Fit::Stretched, features).filter(|_| complete);
    }
    let sam2 = ["image_embed", "high_res_feats_0", "high_res_feats_1"];
    if has_all(outputs, &sam2) {
        return planes(Family::Sam2, Pixels::Normalised, Fit::Stretched, same(&sam2));
    }
    let optimum = ["image_embeddings", "image_positional_embeddings"];
    if image.name == "pixel_values" && has_all(outputs, &optimum) {
        return planes(Family::Optimum, Pixels::Normalised, Fit::Padded, same(&optimum));
    }
    // An embedding has 64 × 64 cells; this excludes networks that output masks directly.
    let embedding = port(outputs, "image_embeddings").or(match outputs {
        [only] if length(only, 1) == Some(256) && only.shape.as_ref().is_some_and(|s| s.len() == 4) => {
            Some(only)
        }
        _ => None,
    })?;
    let free = size == [None, None];
    let (pixels, fit) = match layout {
        AxisOrder::Planes if !free => (Pixels::Normalised, Fit::Padded),
        _ if free => (Pixels::Bytes, Fit::Whole),
        _ => (Pixels::Bytes, Fit::Padded),
    };
    Some(EncoderPorts {
        family: Family::Sam,
        input: image.name.clone(),
        layout,
        pixels,
        fit,
        size: fixed,
        features: vec![(embedding.name.clone(), "image_embeddings".to_owned())],
    })
}

/// Order of an image's axes, and its width and height where fixed.
fn layout(image: &Port) -> Option<(AxisOrder, [Option<usize>; 2])> {
    let shape = image.shape.as_ref()?;
    match shape[..] {
        [_, Some(3), height, width] => Some((AxisOrder::Planes, [width, height])),
        [_, height, width, Some(3)] => Some((AxisOrder::BatchedRows, [width, height])),
        [height, width, Some(3)] => Some((AxisOrder::Rows, [width, height])),
        // A graph that does not even fix the number of channels.
        [_, None, height, width] => Some((AxisOrder::Planes, [width, height])),
        _ => None,
    }
}

fn decoder(inputs: &[Port], outputs: &[Port]) -> Option<Decoder> {
    let known = |more: &[&str]| {
        let always = ["point_coords", "point_labels", "mask_input", "has_mask_input", "orig_im_size"];
        inputs.iter().all(|p| always.contains(&p.name.as_str()) || more.contains(&p.name.as_str()))
    };
    let sam2 = ["image_embed", "high_res_feats_0", "high_res_feats_1"];
    let (family, points, labels, masks, scores) = if has_all(inputs, &["image_embeddings", "point_coords"])
        && known(&["image_embeddings"])
    {
        let low = has_all(outputs, &["low_res_masks"]);
        let masks = if low { "low_res_masks" } else { "masks" };
        (Family::Sam, "point_coords", "point_labels", masks, "iou_predictions")
    } else if has_all(inputs, &sam2) && known(&sam2) {
        let low = has_all(outputs, &["low_res_masks"]);
        let masks = if low { "low_res_masks" } else { "masks" };
        (Family::Sam2, "point_coords", "point_labels", masks, "iou_predictions")
    } else if inputs.len() == 4 && has_all(inputs, &["image_embeddings", "image_positional_embeddings"]) {
        (Family::Optimum, "input_points", "input_labels", "pred_masks", "iou_scores")
    } else if has_all(inputs, &["image_embeddings", "orig_im_size"]) && inputs.len() == 4
        || has_all(inputs, &["batched_images"]) && inputs.len() == 3
    {
        (Family::Efficient, "batched_point_coords", "batched_point_labels", "output_masks", "iou_predictions")
    } else {
        return None;
    };
    let nested = matches!(family, Family::Optimum | Family::Efficient);
    let coordinates = port(inputs, points)?;
    port(inputs, labels)?;
    port(outputs, masks)?;
    port(outputs, scores)?;
    let axis = usize::from(nested);
    // Meta's decoder needs a padding point if there is no box; the others add it themselves.
    let usual = if family == Family::Sam { 2 } else { 1 };
    let named = |name: &str| port(inputs, name).map(|p| p.name.clone());
    let mask_input = port(inputs, "mask_input").map(|p| {
        let side = |axis| length(p, axis).unwrap_or(MASK_SIDE);
        (p.name.clone(), [side(3), side(2)])
    });
    Some(Decoder {
        family,
        points: points.to_owned(),
        labels: labels.to_owned(),
        nested,
        prompts: length(coordinates, axis),
        points_each: length(coordinates, axis + 1).unwrap_or(usual),
        mask_input,
        has_mask: named("has_mask_input"),
        image_size: named("orig_im_size"),
        masks: masks.to_owned(),
        scores: scores.to_owned(),
        of_image: family == Family::Sam && masks == "masks",
    })
}

/// The known signatures, one per line, for the error about an unknown one.
pub(super) const KNOWN: &str = "\
  SAM encoder: one image [1×3×1024×1024] or [?×?×3] -> image_embeddings
  SAM decoder: image_embeddings, point_coords, point_labels, mask_input, has_mask_input, orig_im_size -> low_res_masks or masks, iou_predictions
  Optimum encoder: pixel_values -> image_embeddings, image_positional_embeddings
  Optimum decoder: input_points, input_labels, image_embeddings, image_positional_embeddings -> pred_masks, iou_scores
  EfficientSAM encoder: batched_images -> image_embeddings
  EfficientSAM decoder: image_embeddings (or batched_images, in one file), batched_point_coords, batched_point_labels, orig_im_size -> output_masks, iou_predictions
  SAM 2 encoder: one image [1×3×1024×1024] -> image_embed, high_res_feats_0, high_res_feats_1
  SAM 2 decoder: image_embed, high_res_feats_0, high_res_feats_1, point_coords, point_labels, mask_input, has_mask_input -> masks, iou_predictions";

/// A graph's inputs and outputs, in one line.
pub(super) fn signature(inputs: &[Port], outputs: &[Port]) -> String {
    let list = |ports: &[Port]| ports.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    format!("{} -> {}", list(inputs), list(outputs))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ports(all: &[(&str, &[usize])]) -> Vec<Port> {
        let axis = |n: &usize| (*n > 0).then_some(*n);
        let one = |(name, shape): &(&str, &[usize])| Port {
            name: (*name).to_owned(),
            shape: Some(shape.iter().map(axis).collect()),
        };
        all.iter().map(one).collect()
    }

    #[test]
    fn forms_of_the_encoder_of_sam() {
        let embedding = ports(&[("image_embeddings", &[1, 256, 64, 64])]);
        for (shape, layout, pixels, fit, size) in [
            (&[1, 3, 1024, 1024][..], AxisOrder::Planes, Pixels::Normalised, Fit::Padded, [1024, 1024]),
            (&[0, 3, 512, 512], AxisOrder::Planes, Pixels::Normalised, Fit::Padded, [512, 512]),
            (&[1, 3, 0, 0], AxisOrder::Planes, Pixels::Bytes, Fit::Whole, [1024, 1024]),
            (&[0, 0, 3], AxisOrder::Rows, Pixels::Bytes, Fit::Whole, [1024, 1024]),
            (&[684, 1024, 3], AxisOrder::Rows, Pixels::Bytes, Fit::Padded, [1024, 684]),
            (&[1, 1024, 1024, 3], AxisOrder::BatchedRows, Pixels::Bytes, Fit::Padded, [1024, 1024]),
        ] {
            let Some(GraphRole::Encoder(found)) = recognise(&ports(&[("any", shape)]), &embedding) else {
                panic!("{shape:?} is not recognised")
            };
            assert_eq!(
                (found.layout, found.pixels, found.fit, found.size),
                (layout, pixels, fit, size),
                "{shape:?}"
            );
        }
    }

    #[test]
    fn what_is_close_is_not_taken_for_the_thing() {
        let image: &[usize] = &[1, 3, 1024, 1024];
        let points: &[usize] = &[1, 0, 2];
        for (inputs, outputs) in [
            // A classifier, and a detector.
            (vec![("image", image)], vec![("logits", &[1, 1000][..])]),
            (vec![("image", image)], vec![("boxes", &[1, 0, 4]), ("scores", &[1, 0])]),
            // A decoder that needs more than points, and one that gives no scores.
            (
                vec![
                    ("image_embeddings", &[1, 256, 64, 64][..]),
                    ("point_coords", points),
                    ("point_labels", &[1, 0]),
                    ("interm_embeddings", &[4]),
                ],
                vec![("masks", &[]), ("iou_predictions", &[])],
            ),
            (
                vec![
                    ("image_embeddings", &[1, 256, 64, 64]),
                    ("point_coords", points),
                    ("point_labels", &[1, 0]),
                ],
                vec![("masks", &[])],
            ),
            (vec![], vec![]),
        ] {
            assert_eq!(recognise(&ports(&inputs), &ports(&outputs)), None, "{inputs:?}");
        }
    }
}
