//! Files of masks: label PNGs, and run-length JSON.
//!
//! A label PNG holds one mask for each grey value or palette index except 0, which is background. The
//! JSON (`"format": "vtex-masks"`) also holds scores and overlapping masks.

mod label_png;

use super::{GivenCategory, ScoredMask, Segmenter};
use image::RgbImage;
use label_png::{read_png, write_png};
#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Deserialize, Serialize};
use std::io::Write;
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
    /// Names of the categories that a user has given to masks, all different. Default: none, so that analysis finds
    /// categories.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    categories: Vec<String>,
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
    /// Index of its category. Default: the one that it resembles most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    category: Option<u16>,
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
        GivenCategory::check_names(self.categories.iter().map(String::as_str))?;
        for (i, mask) in self.masks.iter().enumerate() {
            if let Some(category) = mask.category.filter(|&c| usize::from(c) >= self.categories.len()) {
                let count = self.categories.len();
                return Err(format!("masks[{i}].category is {category}, there are {count} categories"));
            }
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

impl MasksDocument {
    /// Indices of the masks, the largest first.
    fn smaller_last(&self) -> Vec<usize> {
        let area = |m: &StoredMask| m.runs.iter().map(|r| u64::from(r[2] - r[1])).sum::<u64>();
        let areas: Vec<u64> = self.masks.iter().map(area).collect();
        let mut order: Vec<usize> = (0..areas.len()).collect();
        order.sort_by_key(|&i| (std::cmp::Reverse(areas[i]), i));
        order
    }

    /// The pixels of each category. Where masks overlap, pixels are those of the smaller one.
    fn given_categories(&self) -> Vec<GivenCategory> {
        if self.categories.is_empty() {
            return Vec::new();
        }
        let mut map = LabelMap::filled(self.width, self.height, 0);
        for i in self.smaller_last() {
            let StoredMask { category, runs, .. } = &self.masks[i];
            map.fill(&mask_of(runs), category.map_or(0, |category| u32::from(category) + 1));
        }
        let masks = Mask::all_of_labels(&map, self.categories.len() + 1).into_iter().skip(1);
        self.categories.iter().cloned().zip(masks).map(|(name, mask)| GivenCategory { name, mask }).collect()
    }
}

fn mask_of(runs: &[[u32; 3]]) -> Mask {
    let span = |&[y, x0, x1]: &[u32; 3]| Span { y: y as i32, x0: x0 as i32, x1: x1 as i32 };
    Mask::from_spans(runs.iter().map(span).collect())
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
                let masks =
                    document.masks.iter().map(|m| ScoredMask { mask: mask_of(&m.runs), score: m.score });
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

    fn categories(&self, size: [u32; 2]) -> Vec<GivenCategory> {
        let MasksContent::Document(document) = &self.content else { return Vec::new() };
        let mut categories = document.given_categories();
        let own = [document.width, document.height];
        if own != size {
            categories.iter_mut().for_each(|category| category.mask = category.mask.stretched(own, size));
        }
        categories
    }
}

fn same_size(name: &str, found: [u32; 2], image: [u32; 2]) -> Result<()> {
    if found == image {
        return Ok(());
    }
    let ([fw, fh], [w, h]) = (found, image);
    Err(Error::Masks(format!("'{name}' is {fw} x {fh} pixels, the image {w} x {h}")))
}

/// Encodes masks of an image. The extension of `path` selects the format. `.png`: labels 1, 2, … in
/// the order of the masks, as 8-bit grey, or 16-bit above 255 masks; smaller masks are painted over
/// larger ones. `.json`, `.json.gz`: run-length JSON, lossless. The same masks give the same bytes.
/// `categories` are those that a user has given, or none; a mask is stored with the one that holds most of it, in
/// JSON only.
///
/// # Errors
/// [`Error::Format`] for another extension or more than 65535 masks in a PNG; [`Error::Masks`] for a
/// mask that extends beyond the image, a score outside 0 to 1, or names of categories that are none.
pub fn masks_to_bytes(
    path: &Path,
    segmenter: &str,
    width: u32,
    height: u32,
    masks: &[ScoredMask],
    categories: &[GivenCategory],
) -> Result<Vec<u8>> {
    let runs = |m: &ScoredMask| {
        m.mask.spans().iter().map(|s| [s.y as u32, s.x0 as u32, s.x1 as u32]).collect::<Vec<_>>()
    };
    let categories_of = GivenCategory::of_all(masks, categories);
    let stored = masks.iter().zip(categories_of).map(|(m, category)| StoredMask {
        score: m.score,
        category: category.map(|category| category as u16),
        runs: runs(m),
    });
    let document = MasksDocument {
        format: MasksDocument::FORMAT.into(),
        version: MasksDocument::VERSION,
        width,
        height,
        segmenter: segmenter.into(),
        categories: categories.iter().map(|category| category.name.clone()).collect(),
        masks: stored.collect(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn segment(bytes: Vec<u8>, width: u32, height: u32) -> Result<Vec<ScoredMask>> {
        MasksFile::from_bytes(bytes, "m")?.segment(&RgbImage::new(width, height), &())
    }

    fn encode(name: &str, masks: &[ScoredMask]) -> Result<Vec<u8>> {
        masks_to_bytes(Path::new(name), "regions", 13, 9, masks, &[])
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
    fn categories_are_kept_by_name_and_stretched() {
        let row = |y, x0, x1| Mask::from_spans(vec![Span { y, x0, x1 }]);
        let given = [("moss", row(2, 0, 9)), ("stone", row(4, 0, 6))];
        let given = given.map(|(name, mask)| GivenCategory { name: name.into(), mask });
        let masks = [row(4, 1, 5), row(2, 0, 9), row(7, 0, 3)].map(|mask| ScoredMask { mask, score: 1.0 });
        let bytes = masks_to_bytes(Path::new("a.json"), "studio", 13, 9, &masks, &given).unwrap();
        let file = MasksFile::from_bytes(bytes, "a.json").unwrap();
        let read = file.categories([13, 9]);
        assert_eq!(read.iter().map(|c| &c.name[..]).collect::<Vec<_>>(), ["moss", "stone"]);
        assert_eq!([&read[0].mask, &read[1].mask], [&row(2, 0, 9), &row(4, 1, 5)]);
        let twice = file.categories([26, 18]);
        assert_eq!(twice[1].mask.area(), 4 * read[1].mask.area());
        // A mask within another one keeps its own category.
        let nested = [row(2, 0, 9), row(2, 3, 5)];
        let own = nested.clone().map(|mask| ScoredMask { mask, score: 1.0 });
        let [outer, inner] = nested;
        let given = [("outer", outer.without(&inner)), ("inner", inner.clone())];
        let given = given.map(|(name, mask)| GivenCategory { name: name.into(), mask });
        let bytes = masks_to_bytes(Path::new("a.json"), "studio", 13, 9, &own, &given).unwrap();
        assert_eq!(MasksFile::from_bytes(bytes, "a").unwrap().categories([13, 9]), given);
        assert!(
            MasksFile::from_bytes(encode("a.json", &own).unwrap(), "a")
                .unwrap()
                .categories([13, 9])
                .is_empty()
        );
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
        let unknown = "\"categories\":[\"a\"],\"masks\":[{\"score\":1,\"category\":1,\"runs\":[]}]";
        assert!(with("\"masks\":[]", unknown).contains("category is 1"));
        assert!(with("\"masks\":[]", "\"categories\":[\"a\",\"a\"],\"masks\":[]").contains("'a'"));
        let mut colour = Cursor::new(Vec::new());
        RgbImage::new(13, 9).write_to(&mut colour, image::ImageFormat::Png).unwrap();
        assert!(segment(colour.into_inner(), 13, 9).unwrap_err().to_string().contains("colours"));
        assert!(matches!(segment(Vec::new(), 13, 9), Err(Error::Format { .. })));
        assert!(encode("a.txt", &[]).is_err());
        let outside = Mask::from_spans(vec![Span { y: 0, x0: -1, x1: 2 }]);
        assert!(encode("a.png", &[ScoredMask { mask: outside, score: 0.5 }]).is_err());
    }
}
