//! Files of masks: label PNGs, and run-length JSON.
//!
//! A label PNG holds one mask for each grey value or palette index except 0, which is background. The
//! JSON (`"format": "vtex-masks"`) also holds scores and overlapping masks.

use super::{ScoredMask, Segmenter};
use image::RgbImage;
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Deserialize, Serialize};
use std::io::{Cursor, Write};
use std::path::Path;
use vtex_base::document::{self, Document};
use vtex_base::error::{Error, Result};
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::{LabelMap, Mask, Span};

/// Name of the PNG format in errors.
const LABEL_PNG: &str = "label PNG";
/// Largest width and height, in pixels.
const LARGEST_SIDE: u32 = 1 << 14;
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Masks found in an image. They may overlap. Uncovered pixels are background.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", schemars(title = "Masks"))]
struct MasksDocument {
    /// Always `vtex-masks`.
    format: String,
    /// Version of the format; this is 1.
    version: u32,
    /// Width of the image, in pixels.
    width: u32,
    /// Height of the image, in pixels.
    height: u32,
    /// Name of the segmenter that made the masks, such as `regions`.
    segmenter: String,
    /// The masks.
    masks: Vec<StoredMask>,
}

/// A mask with a confidence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "schema", schemars(rename = "Mask"))]
struct StoredMask {
    /// Confidence, 0 to 1.
    score: f32,
    /// The pixels as horizontal runs: row, first column, last column plus one.
    runs: Vec<[u32; 3]>,
}

impl Document for MasksDocument {
    const FORMAT: &'static str = "vtex-masks";
    const VERSION: u32 = 1;

    fn validate(&self) -> std::result::Result<(), String> {
        let sides = 1..=LARGEST_SIDE;
        if !sides.contains(&self.width) || !sides.contains(&self.height) {
            return Err(format!("its size {} x {} is not 1 to {LARGEST_SIDE}", self.width, self.height));
        }
        for (i, mask) in self.masks.iter().enumerate() {
            if !(0.0..=1.0).contains(&mask.score) {
                return Err(format!("masks[{i}].score = {} is not 0 to 1", mask.score));
            }
            for &[y, x0, x1] in &mask.runs {
                if y >= self.height || x0 >= x1 || x1 > self.width {
                    return Err(format!("masks[{i}] has a run [{y}, {x0}, {x1}] outside the image"));
                }
            }
        }
        Ok(())
    }
}

/// A segmenter that returns masks read from a file.
#[derive(Clone, Debug)]
pub struct MasksFile {
    name: String,
    content: MasksContent,
}

#[derive(Clone, Debug)]
enum MasksContent {
    /// Decoded by `segment`, when the image's size is known.
    Png(Vec<u8>),
    Document(MasksDocument),
}

impl MasksFile {
    /// The JSON Schema of the run-length JSON. With the feature `schema`.
    #[cfg(feature = "schema")]
    pub fn json_schema() -> Schema {
        schema_for!(MasksDocument)
    }

    /// Reads a label PNG or run-length JSON (plain or gzip); the format is detected from the content. A
    /// PNG is decoded only by [`Segmenter::segment`].
    ///
    /// # Errors
    /// [`Error::Read`] for an unreadable file; [`Error::Format`] for a file of another format or version,
    /// or with runs out of range.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::read(path, e))?;
        let file = path.file_name().unwrap_or(path.as_os_str());
        Self::from_bytes(bytes, &file.to_string_lossy())
    }

    /// As [`MasksFile::read`], from bytes. `name` appears in errors.
    ///
    /// # Errors
    /// [`Error::Format`] for bytes of another format or version, or with runs out of range.
    pub fn from_bytes(bytes: Vec<u8>, name: &str) -> Result<Self> {
        let content = if bytes.starts_with(PNG_SIGNATURE) {
            MasksContent::Png(bytes)
        } else {
            MasksContent::Document(document::from_bytes(&bytes, name)?)
        };
        Ok(Self { name: name.into(), content })
    }
}

impl Segmenter for MasksFile {
    fn name(&self) -> String {
        format!("masks:{}", self.name)
    }

    /// # Errors
    /// [`Error::Masks`] if the sizes differ; [`Error::Format`] if a PNG is damaged or is not a grey or
    /// palette image.
    fn segment(&self, image: &RgbImage, progress: &dyn Progress) -> Result<Vec<ScoredMask>> {
        self.segment_reduced(image, [image.width(), image.height()], progress)
    }

    /// The masks may have the size of the photograph before or after it was reduced.
    ///
    /// # Errors
    /// As [`MasksFile::segment`].
    fn segment_reduced(
        &self,
        image: &RgbImage,
        whole: [u32; 2],
        progress: &dyn Progress,
    ) -> Result<Vec<ScoredMask>> {
        advance(progress, "segmentation", 0, 1)?;
        let reduced = [image.width(), image.height()];
        let check = |found: [u32; 2]| {
            if found == reduced { Ok(found) } else { same_size(&self.name, found, whole).map(|()| found) }
        };
        let (size, mut masks) = match &self.content {
            MasksContent::Document(document) => {
                let size = check([document.width, document.height])?;
                let span = |&[y, x0, x1]: &[u32; 3]| Span { y: y as i32, x0: x0 as i32, x1: x1 as i32 };
                let masks = document.masks.iter().map(|m| ScoredMask {
                    mask: Mask::from_spans(m.runs.iter().map(span).collect()),
                    score: m.score,
                });
                (size, masks.collect::<Vec<_>>())
            }
            MasksContent::Png(bytes) => {
                let map = read_png(bytes, &self.name, check)?;
                let count = map.labels.iter().max().map_or(0, |&n| n as usize);
                let masks = Mask::all_of_labels(&map, count + 1).into_iter().skip(1);
                ([map.width, map.height], masks.map(|mask| ScoredMask { mask, score: 1.0 }).collect())
            }
        };
        if size != reduced {
            masks.iter_mut().for_each(|m| m.mask = m.mask.stretched(size, reduced));
        }
        masks.retain(|m| !m.mask.is_empty());
        advance(progress, "segmentation", 1, 1)?;
        Ok(masks)
    }
}

fn same_size(name: &str, found: [u32; 2], image: [u32; 2]) -> Result<()> {
    if found == image {
        return Ok(());
    }
    let ([fw, fh], [w, h]) = (found, image);
    Err(Error::Masks(format!("'{name}' is {fw} x {fh} pixels, the image {w} x {h}")))
}

fn read_png(bytes: &[u8], name: &str, check: impl Fn([u32; 2]) -> Result<[u32; 2]>) -> Result<LabelMap> {
    let fail = |reason: String| Error::Format { name: name.into(), format: LABEL_PNG, reason };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(|e| fail(e.to_string()))?;
    let (info, bits) = (reader.info(), reader.info().bit_depth as usize);
    check([info.width, info.height])?;
    if !matches!(info.color_type, png::ColorType::Grayscale | png::ColorType::Indexed) {
        return Err(fail("it holds colours; labels must be grey values or palette indices".into()));
    }
    let length = reader.output_buffer_size().ok_or_else(|| fail("its size overflows".into()))?;
    let mut data = vec![0; length];
    let frame = reader.next_frame(&mut data).map_err(|e| fail(e.to_string()))?;
    let (width, height) = (frame.width as usize, frame.height as usize);
    let mut labels = Vec::with_capacity(width * height);
    for row in data.chunks_exact(frame.line_size).take(height) {
        for x in 0..width {
            labels.push(match bits {
                16 => u32::from(u16::from_be_bytes([row[2 * x], row[2 * x + 1]])),
                8 => u32::from(row[x]),
                _ => {
                    let at = x * bits;
                    u32::from(row[at / 8] >> (8 - bits - at % 8)) & ((1 << bits) - 1)
                }
            });
        }
    }
    if labels.len() != width * height {
        return Err(fail("it holds fewer rows than it says".into()));
    }
    Ok(LabelMap { width: frame.width, height: frame.height, labels })
}

/// Encodes masks of an image. The extension of `path` selects the format. `.png`: labels 1, 2, … in
/// the order of the masks, as 8-bit grey, or 16-bit above 255 masks; smaller masks are painted over
/// larger ones. `.json`, `.json.gz`: run-length JSON, lossless. The same masks give the same bytes.
///
/// # Errors
/// [`Error::Format`] for another extension or more than 65535 masks in a PNG; [`Error::Masks`] for a
/// mask that extends beyond the image, or a score outside 0 to 1.
pub fn masks_to_bytes(
    path: &Path,
    segmenter: &str,
    width: u32,
    height: u32,
    masks: &[ScoredMask],
) -> Result<Vec<u8>> {
    let runs = |m: &ScoredMask| {
        m.mask.spans().iter().map(|s| [s.y as u32, s.x0 as u32, s.x1 as u32]).collect::<Vec<_>>()
    };
    let stored = masks.iter().map(|m| StoredMask { score: m.score, runs: runs(m) }).collect();
    let document = MasksDocument {
        format: MasksDocument::FORMAT.into(),
        version: MasksDocument::VERSION,
        width,
        height,
        segmenter: segmenter.into(),
        masks: stored,
    };
    document.validate().map_err(Error::Masks)?;
    let name = path.to_string_lossy().to_lowercase();
    let fail = |format, reason: &str| Error::Format {
        name: path.display().to_string(),
        format,
        reason: reason.into(),
    };
    if name.ends_with(".png") {
        write_png(&document).map_err(|e| fail(LABEL_PNG, &e))
    } else if name.ends_with(".json") {
        Ok(document::to_json(&document))
    } else if name.ends_with(".json.gz") {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        let written = encoder.write_all(&document::to_json(&document));
        written.and_then(|()| encoder.finish()).map_err(|e| Error::write(path, e))
    } else {
        Err(fail(MasksDocument::FORMAT, "masks are written as .png, .json or .json.gz"))
    }
}

fn write_png(document: &MasksDocument) -> std::result::Result<Vec<u8>, String> {
    let count = document.masks.len();
    if count > usize::from(u16::MAX) {
        return Err(format!("{count} masks are more than a PNG can tell apart; write .json"));
    }
    let width = document.width as usize;
    let mut labels = vec![0u16; width * document.height as usize];
    let area = |m: &StoredMask| m.runs.iter().map(|r| u64::from(r[2] - r[1])).sum::<u64>();
    let mut order: Vec<(u64, usize)> = document.masks.iter().map(area).zip(0..).collect();
    order.sort_unstable_by_key(|&(area, i)| (std::cmp::Reverse(area), i));
    for (_, i) in order {
        for &[y, x0, x1] in &document.masks[i].runs {
            let row = y as usize * width;
            labels[row + x0 as usize..row + x1 as usize].fill(i as u16 + 1);
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, document.width, document.height);
    encoder.set_color(png::ColorType::Grayscale);
    let wide = count > usize::from(u8::MAX);
    encoder.set_depth(if wide { png::BitDepth::Sixteen } else { png::BitDepth::Eight });
    let data: Vec<u8> = if wide {
        labels.iter().flat_map(|l| l.to_be_bytes()).collect()
    } else {
        labels.iter().map(|&l| l as u8).collect()
    };
    // Marks the file as written by vtex; editors do not keep this chunk.
    encoder.add_text_chunk("Software".into(), vtex_base::PROGRAM.into()).map_err(|e| e.to_string())?;
    let write = |encoder: png::Encoder<'_, _>| {
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&data)?;
        writer.finish()
    };
    write(encoder).map_err(|e: png::EncodingError| e.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn segment(bytes: Vec<u8>, width: u32, height: u32) -> Result<Vec<ScoredMask>> {
        MasksFile::from_bytes(bytes, "m")?.segment(&RgbImage::new(width, height), &())
    }

    fn encode(name: &str, masks: &[ScoredMask]) -> Result<Vec<u8>> {
        masks_to_bytes(Path::new(name), "regions", 13, 9, masks)
    }

    fn scored() -> impl Strategy<Value = Vec<ScoredMask>> {
        let mask = prop::collection::vec((0..9i32, 0..13i32, 1..9i32), 1..8).prop_map(|runs| {
            let span = |&(y, x0, n): &(i32, i32, i32)| Span { y, x0, x1: (x0 + n).min(13) };
            Mask::from_spans(runs.iter().map(span).collect())
        });
        prop::collection::vec((mask, 0.0..=1.0f32), 0..12)
            .prop_map(|v| v.into_iter().map(|(mask, score)| ScoredMask { mask, score }).collect())
    }

    proptest! {
        #[test]
        fn json_round_trips_byte_for_byte(masks in scored()) {
            for name in ["a.json", "a.JSON.gz"] {
                let bytes = encode(name, &masks).unwrap();
                let read = segment(bytes.clone(), 13, 9).unwrap();
                prop_assert_eq!(&read, &masks);
                prop_assert_eq!(encode(name, &read).unwrap(), bytes);
            }
        }

        #[test]
        fn png_round_trips_what_does_not_overlap(
            labels in prop::collection::vec(0..400u32, 13 * 9), small: bool,
        ) {
            let labels = labels.into_iter().map(|l| if small { l % 7 } else { l }).collect();
            let map = LabelMap { width: 13, height: 9, labels };
            let masks: Vec<_> = Mask::all_of_labels(&map, 400).into_iter().skip(1)
                .filter(|m| !m.is_empty())
                .map(|mask| ScoredMask { mask, score: 1.0 })
                .collect();
            let bytes = encode("a.png", &masks).unwrap();
            let read = segment(bytes.clone(), 13, 9).unwrap();
            prop_assert_eq!(&read, &masks);
            prop_assert_eq!(encode("a.png", &read).unwrap(), bytes);
        }

        #[test]
        fn damage_gives_errors_or_masks_that_fit(
            masks in scored(), png: bool, at in any::<prop::sample::Index>(), byte: u8, cut: bool,
        ) {
            let mut bytes = encode(if png { "a.png" } else { "a.json" }, &masks).unwrap();
            let at = at.index(bytes.len());
            if cut { bytes.truncate(at) } else { bytes[at] = byte }
            for scored in segment(bytes, 13, 9).unwrap_or_default() {
                let (x0, y0, x1, y1) = scored.mask.bounds().unwrap();
                prop_assert!(x0 >= 0 && y0 >= 0 && x1 <= 13 && y1 <= 9);
            }
        }
    }

    #[test]
    fn smaller_masks_lie_over_larger_ones() {
        let mask = |n| Mask::from_spans(vec![Span { y: 2, x0: 1, x1: 1 + n }]);
        let masks = [3, 9].map(|n| ScoredMask { mask: mask(n), score: 0.5 });
        let read = segment(encode("a.png", &masks).unwrap(), 13, 9).unwrap();
        assert_eq!(read[0].mask, masks[0].mask);
        assert_eq!(read[1].mask.area(), 6);
    }

    #[test]
    fn palettes_and_few_bits_are_read_by_value() {
        for colour in [png::ColorType::Grayscale, png::ColorType::Indexed] {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 5, 2);
            encoder.set_color(colour);
            encoder.set_depth(png::BitDepth::Two);
            encoder.set_palette(vec![7; 12]);
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(&[0b0001_1011, 0b0100_0000, 0b0101_0000, 0]).unwrap();
            writer.finish().unwrap();
            let areas: Vec<u32> = segment(bytes, 5, 2).unwrap().iter().map(|m| m.mask.area()).collect();
            assert_eq!(areas, [4, 1, 1]);
        }
    }

    #[test]
    fn errors_say_what_is_wrong() {
        let good = String::from_utf8(encode("a.json", &[]).unwrap()).unwrap();
        let with = |from: &str, to: &str| {
            assert!(good.contains(from), "{good}");
            segment(good.replace(from, to).into_bytes(), 13, 9).unwrap_err().to_string()
        };
        assert!(with("vtex-masks", "vtex-scene").contains("vtex-scene"));
        assert!(with("\"version\":1", "\"version\":2").contains("version 2"));
        assert!(with("\"width\":13", "\"width\":14").contains("14 x 9"));
        assert!(with("\"width\":13", "\"width\":4000000000").contains("4000000000"));
        let bad_run = "\"masks\":[{\"score\":0.5,\"runs\":[[3,5,14]]}]";
        assert!(with("\"masks\":[]", bad_run).contains("[3, 5, 14]"));
        assert!(with("\"masks\":[]", "\"masks\":[{\"score\":2,\"runs\":[]}]").contains("score"));
        assert!(with("\"masks\":[]", "\"masks\":[],\"more\":1").contains("more"));
        let mut colour = Cursor::new(Vec::new());
        RgbImage::new(13, 9).write_to(&mut colour, image::ImageFormat::Png).unwrap();
        assert!(segment(colour.into_inner(), 13, 9).unwrap_err().to_string().contains("colours"));
        assert!(matches!(segment(Vec::new(), 13, 9), Err(Error::Format { .. })));
        assert!(encode("a.txt", &[]).is_err());
        let outside = Mask::from_spans(vec![Span { y: 0, x0: -1, x1: 2 }]);
        assert!(encode("a.png", &[ScoredMask { mask: outside, score: 0.5 }]).is_err());
    }
}
