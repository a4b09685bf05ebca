//! Crops of photographs whose elements were outlined by hand (`tests/labels`).

use std::path::Path;
use vtex::raster::{LabelMap, Mask, Span};

/// Label of pixels that may or may not belong to an element.
pub(crate) const UNSURE: u32 = u32::MAX;

type Failure = Box<dyn std::error::Error>;

/// A photograph of whose crop all elements are known.
pub(crate) struct LabelledCrop {
    pub(crate) name: String,
    pub(crate) photo: image::RgbImage,
    /// The elements in the crop, numbered; later ones lie on top.
    pub(crate) truth: LabelMap,
    /// Corner, width and height of the crop in the photograph.
    crop: [i32; 4],
}

/// The crops of one list of the labels' README, with their photographs from a folder.
pub(crate) fn crops(photos: &Path, title: &str) -> Result<Vec<LabelledCrop>, Failure> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/labels");
    let readme = std::fs::read_to_string(folder.join("README.md"))?;
    let start = format!("- **{title}**: ");
    // The list ends with its sentence.
    let list = readme.lines().find_map(|l| l.strip_prefix(start.as_str())?.split_once('.'));
    let (names, _) = list.ok_or(format!("tests/labels/README.md has no list '{title}'"))?;
    names.split(", ").map(|name| LabelledCrop::read(&folder, name, photos)).collect()
}

impl LabelledCrop {
    fn read(folder: &Path, name: &str, photos: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(folder.join(format!("{name}.json")))?;
        let labels: serde_json::Value = serde_json::from_str(&text)?;
        let photo = labels["photo"].as_str().ok_or("a label file names its photo")?;
        let photo = image::open(photos.join(photo))?.to_rgb8();
        let number = |v: &serde_json::Value| v.as_f64().ok_or("labels hold numbers");
        let crop = labels["crop"].as_array().ok_or("a label file has a crop")?;
        let crop: Vec<i32> = crop.iter().map(|v| number(v).map(|v| v as i32)).collect::<Result<_, _>>()?;
        let crop = crop.try_into().map_err(|_| "a crop has four numbers")?;
        Ok(Self { name: name.into(), photo, truth: truth(&labels, crop)?, crop })
    }

    /// The part of a mask of the photograph inside the crop, relative to the crop's corner.
    pub(crate) fn clip(&self, mask: &Mask) -> Mask {
        let [x0, y0, w, h] = self.crop;
        let spans = mask.spans().iter().filter(|s| s.y >= y0 && s.y < y0 + h).map(|s| Span {
            y: s.y - y0,
            x0: (s.x0 - x0).max(0),
            x1: (s.x1 - x0).min(w),
        });
        Mask::from_spans(spans.collect())
    }
}

/// The areas of the elements of a label map, without unsure pixels; nothing is of label 0.
pub(crate) fn areas_known(truth: &LabelMap) -> Vec<u32> {
    let known = truth.labels.iter().filter(|&&l| l != UNSURE);
    let mut areas = vec![0; known.clone().max().map_or(0, |&l| l as usize) + 1];
    known.for_each(|&l| areas[l as usize] += 1);
    areas[0] = 0;
    areas
}

fn truth(labels: &serde_json::Value, [x0, y0, w, h]: [i32; 4]) -> Result<LabelMap, Failure> {
    let mut map = LabelMap::filled(w as u32, h as u32, 0);
    let mut next = 0;
    for texton in labels["textons"].as_array().ok_or("a label file has textons")? {
        let sure = texton["sure"].as_bool().unwrap_or(true);
        next += u32::from(sure);
        let corner =
            |v: &serde_json::Value| Some([v[0].as_f64()? - f64::from(x0), v[1].as_f64()? - f64::from(y0)]);
        let corners = texton["polygon"].as_array().ok_or("a texton has a polygon")?;
        let corners: Vec<[f64; 2]> =
            corners.iter().map(corner).collect::<Option<_>>().ok_or("corners are pairs")?;
        for y in 0..h {
            for x in 0..w {
                if inside(&corners, [f64::from(x) + 0.5, f64::from(y) + 0.5]) {
                    map.set(x as u32, y as u32, if sure { next } else { UNSURE });
                }
            }
        }
    }
    Ok(map)
}

fn inside(corners: &[[f64; 2]], p: [f64; 2]) -> bool {
    let mut odd = false;
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) {
            odd = !odd;
        }
    }
    odd
}
