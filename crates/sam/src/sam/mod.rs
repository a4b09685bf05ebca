//! Segment Anything in ONNX, in all common exports ([`export`]): an image encoder and a prompt decoder, in
//! two files or one.
//!
//! [`export`] recognises an export by names and shapes, as data; [`frame`] brings the image into the
//! network's square and logits back into its pixels; [`decode`] makes the prompts. A further export is a
//! case in [`export`] and a graph in `tools/sam/make_test_networks.py`.

mod decode;
mod export;
mod frame;

use crate::engine::{self, Engine, EngineOptions, NetworkSource, Tensor};
use decode::Batching;
use export::{Decoder, EncoderPorts, GraphRole};
use frame::InputFrame;
use image::RgbImage;
use vtex_base::error::{Error, Result};
use vtex_segment::segment::prompt::{Embedded, PromptMask, Prompter};

/// Segment Anything: SAM, MobileSAM, EfficientSAM or SAM 2.
///
/// The image is scaled to the network's square, 1024 px for most. Larger images therefore lose detail.
/// Masks have a quarter of the square's resolution.
pub struct Sam {
    encoder: EncoderPorts,
    decoder: Decoder,
    encoding: Box<dyn Engine>,
    /// `None` if the encoder's graph also decodes.
    decoding: Option<Box<dyn Engine>>,
    together: Batching,
}

/// The role of a file of Segment Anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamRole {
    /// Takes an image and gives its embedding.
    Encoder,
    /// Takes an embedding and points and gives masks.
    Decoder,
    /// Takes an image and points and gives masks.
    Both,
}

/// Recognises the part and the export of a network, such as `(SamRole::Encoder, "SAM 2")`. `name` appears
/// in errors.
///
/// # Errors
/// [`Error::Network`] if it is no known export; the message lists its signature and the known ones.
pub fn recognise(network: &dyn Engine, name: &str) -> Result<(SamRole, &'static str)> {
    Ok(match part(network, name)? {
        GraphRole::Encoder(encoder) => (SamRole::Encoder, encoder.family.title()),
        GraphRole::Decoder(decoder) => (SamRole::Decoder, decoder.family.title()),
        GraphRole::Both(_, decoder) => (SamRole::Both, decoder.family.title()),
    })
}

fn part(network: &dyn Engine, name: &str) -> Result<GraphRole> {
    export::recognise(network.inputs(), network.outputs()).ok_or_else(|| Error::Network {
        name: name.to_owned(),
        reason: format!(
            "it is no export of Segment Anything known here. Its signature is\n  {}\nThose known are\n  {}",
            export::signature(network.inputs(), network.outputs()),
            export::KNOWN
        ),
        advice: "export it again in one of these forms, or report it with its signature and where it is from",
    })
}

impl Sam {
    /// Loads the two files of an export in any order, or a single file with both parts.
    ///
    /// # Errors
    /// [`Error::Network`] if a file is not recognised or the two do not fit together; errors of
    /// [`engine::load`].
    pub fn open(files: &[NetworkSource<'_>], options: &EngineOptions) -> Result<Self> {
        let (mut encoder, mut decoder) = (None, None);
        let mut titles = Vec::new();
        for file in files {
            let network = engine::load(*file, options)?;
            let name = file.name();
            let twice = |role: &str| Error::Network {
                name: name.clone(),
                reason: format!("it is a second {role}"),
                advice: "give one encoder and one decoder, or one file that contains both",
            };
            match part(network.as_ref(), &name)? {
                GraphRole::Encoder(part) => {
                    titles.push(format!("'{name}' is an encoder of {}", part.family.title()));
                    if encoder.replace((part, network)).is_some() {
                        return Err(twice("encoder"));
                    }
                }
                GraphRole::Decoder(part) => {
                    titles.push(format!("'{name}' is a decoder of {}", part.family.title()));
                    if decoder.replace((part, Some(network))).is_some() {
                        return Err(twice("decoder"));
                    }
                }
                GraphRole::Both(first, second) => {
                    if encoder.replace((first, network)).is_some()
                        || decoder.replace((second, None)).is_some()
                    {
                        return Err(twice("encoder and decoder"));
                    }
                }
            }
        }
        let wrong = |reason: String| Error::Network {
            name: "sam".into(),
            reason,
            advice: "encoder and decoder must be from the same export of the same network",
        };
        let missing = if encoder.is_some() { "decoder" } else { "encoder" };
        let (Some((encoder, encoding)), Some((decoder, decoding))) = (encoder, decoder) else {
            let given = if titles.is_empty() { "no network is given".into() } else { titles.join(", ") };
            return Err(wrong(format!("the {missing} is missing ({given})")));
        };
        if encoder.family != decoder.family {
            return Err(wrong(format!("the files do not go together: {}", titles.join(", "))));
        }
        let together = Batching::new(decoder.prompts);
        Ok(Self { encoder, decoder, encoding, decoding, together })
    }

    /// The export, such as `SAM 2`.
    pub fn kind(&self) -> &'static str {
        self.decoder.family.title()
    }

    /// The export and its engine, such as `SAM 2, run by rten`.
    pub fn title(&self) -> String {
        format!("{}, run by {}", self.kind(), self.encoding.runtime())
    }
}

impl Prompter for Sam {
    fn name(&self) -> String {
        "sam".into()
    }

    fn embed<'a>(&'a self, image: &RgbImage) -> Result<Box<dyn Embedded + 'a>> {
        let size = [image.width(), image.height()];
        if size.contains(&0) {
            let reason = "it cannot be shown an image without pixels".into();
            return Err(Error::Network { name: "sam".into(), reason, advice: "" });
        }
        let frame = InputFrame::new(&self.encoder, size);
        let shown = frame.tensor(&self.encoder, image);
        let features = if self.decoding.is_none() {
            // A single graph takes the image again with every prompt.
            vec![(self.encoder.input.clone(), shown)]
        } else {
            let wanted: Vec<&str> = self.encoder.features.iter().map(|(from, _)| from.as_str()).collect();
            let found = self.encoding.run(&[(&self.encoder.input, &shown)], &wanted)?;
            self.encoder.features.iter().map(|(_, to)| to.clone()).zip(found).collect()
        };
        Ok(Box::new(Shown { sam: self, frame, features }))
    }
}

/// An embedded image.
struct Shown<'a> {
    sam: &'a Sam,
    frame: InputFrame,
    /// Inputs of the decoder that are the same for all points.
    features: Vec<(String, Tensor)>,
}

impl Embedded for Shown<'_> {
    fn expected_iou(&self, _: &[[f32; 2]]) -> Option<Vec<f32>> {
        None
    }

    fn batch(&self) -> usize {
        self.sam.together.batch()
    }

    fn masks(&self, points: &[[f32; 2]]) -> Result<Vec<Vec<PromptMask>>> {
        self.decode(points)
    }
}

#[cfg(test)]
mod tests;
