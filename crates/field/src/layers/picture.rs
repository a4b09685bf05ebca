//! Reads layer maps from pictures that have one flat colour for each layer.

use super::map::{Contacts, LayerMap, MOST_LAYERS, shares};
use super::names::named;
use super::order::order;
use image::{DynamicImage, RgbaImage};
use std::collections::BTreeMap;
use vtex_base::error::{Error, Result};
use vtex_base::raster::colour::Colour;
use vtex_base::raster::{LabelMap, Limits, decode};

/// Least share of the pixels that a layer's colour covers. Rarer colours are taken for antialiased edges.
const LEAST_SHARE: f64 = 5e-4;
/// Largest share of pixels with the colours of antialiased edges.
const MOST_SOFT: f64 = 0.02;
/// Largest difference from a layer's colour, per component.
const TOLERANCE: u8 = 12;
/// Largest number of distinct colours that is counted.
const MOST_COUNTED: usize = 100_000;

/// A picture that may hold a layer map.
pub struct LayerPicture {
    name: String,
    image: RgbaImage,
    /// Colours of the palette if vtex wrote it: the layers from bottom to top.
    palette: Option<Vec<Colour>>,
}

impl LayerPicture {
    /// Decodes a picture.
    ///
    /// # Errors
    /// [`Error::Decode`] and [`Error::TooLarge`].
    pub fn from_bytes(bytes: &[u8], name: &str, limits: &Limits) -> Result<Self> {
        let (image, orientation) = decode(bytes, name, limits, 4)?;
        let mut image = DynamicImage::ImageRgba8(image.into_rgba8());
        image.apply_orientation(orientation);
        Ok(Self { name: name.into(), image: image.into_rgba8(), palette: own_palette(bytes) })
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.image.width() as usize, self.image.height() as usize]
    }

    /// Name of the file that it came from.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it has few enough flat colours to be a layer map.
    pub fn is_flat(&self) -> bool {
        let (colours, soft) = self.colours();
        colours.len() <= MOST_LAYERS && soft <= MOST_SOFT
    }

    /// The frequent colours, and the share of pixels with others.
    fn colours(&self) -> (Vec<Colour>, f64) {
        let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
        let mut uncounted = 0;
        for p in self.image.pixels() {
            let rgb = [p.0[0], p.0[1], p.0[2]];
            if counts.len() < MOST_COUNTED || counts.contains_key(&rgb) {
                *counts.entry(rgb).or_default() += 1;
            } else {
                uncounted += 1;
            }
        }
        let all = self.image.pixels().len();
        let least = libm::ceil(LEAST_SHARE * all as f64) as usize;
        let soft: usize = counts.values().filter(|&&n| n < least).sum::<usize>() + uncounted;
        let flat = counts.into_iter().filter(|&(_, n)| n >= least).map(|(rgb, _)| Colour(rgb)).collect();
        (flat, soft as f64 / all as f64)
    }

    /// Reads the layer map. Layers have the order of the palette if vtex wrote the picture, else the order
    /// with the least contact of non-consecutive layers; ties put the largest at the bottom.
    ///
    /// # Errors
    /// [`Error::Control`] if the colours are one or more than six.
    pub fn layers(&self) -> Result<LayerMap> {
        let (colours, soft) = self.colours();
        if colours.len() < 2 {
            return self.refuse("it has a single colour".into());
        }
        if colours.len() > MOST_LAYERS || soft > MOST_SOFT {
            return self.refuse(format!("it has {} colours", self.distinct()));
        }
        let (order, colours) = match &self.palette {
            Some(palette) if colours.iter().all(|c| palette.contains(c)) => {
                let kept: Vec<Colour> = palette.iter().copied().filter(|c| colours.contains(c)).collect();
                ((0..kept.len()).collect(), kept)
            }
            _ => {
                let map = self.nearest(&colours);
                let contacts = Contacts::new(&map, colours.len(), [false; 2]);
                (order(&contacts, &shares(&map, colours.len())), colours)
            }
        };
        let sorted: Vec<Colour> = order.iter().map(|&k| colours[k]).collect();
        Ok(LayerMap { labels: self.nearest(&sorted), layers: named(&sorted) })
    }

    /// The number of colours, as text.
    fn distinct(&self) -> String {
        let mut seen = std::collections::BTreeSet::new();
        for p in self.image.pixels() {
            seen.insert([p.0[0], p.0[1], p.0[2]]);
            if seen.len() > MOST_COUNTED {
                return format!("more than {MOST_COUNTED}");
            }
        }
        seen.len().to_string()
    }

    fn refuse<T>(&self, reason: String) -> Result<T> {
        Err(Error::Control {
            name: self.name.clone(),
            role: "a layer map",
            reason,
            advice: "paint each layer in one flat colour, 2 to 6 in all, without softened edges",
        })
    }

    /// For each pixel the index of the nearest of the given colours.
    fn nearest(&self, colours: &[Colour]) -> LabelMap {
        let label = |p: &image::Rgba<u8>| {
            let distance =
                |c: &Colour| -> u32 { (0..3).map(|k| u32::from(c.0[k].abs_diff(p.0[k])).pow(2)).sum() };
            let mut best = (0, u32::MAX);
            for (k, c) in colours.iter().enumerate() {
                if distance(c) < best.1 {
                    best = (k as u32, distance(c));
                }
            }
            best.0
        };
        let labels = self.image.pixels().map(label).collect();
        LabelMap { width: self.image.width(), height: self.image.height(), labels }
    }

    /// Reads the picture as a map of known layers, by their colours. Up to 2 % of the pixels may have other
    /// colours, as at antialiased edges; they take the nearest layer.
    ///
    /// # Errors
    /// [`Error::Control`] if more have, or a pixel is transparent.
    pub fn in_colours_of(&self, map: &LayerMap) -> Result<LabelMap> {
        let colours: Vec<Colour> = map.layers.iter().map(|l| l.colour).collect();
        let foreign =
            self.image.pixels().filter(|p| p.0[3] < 128 || matching(&colours, p.0).is_none()).count();
        if foreign as f64 <= MOST_SOFT * self.image.pixels().len() as f64 {
            return Ok(self.nearest(&colours));
        }
        Err(Error::Control {
            name: self.name.clone(),
            role: "a layer map",
            reason: format!(
                "{:.0} % of its pixels have none of the colours {}",
                (100.0 * foreign as f64 / self.image.pixels().len() as f64).max(1.0),
                listed(map)
            ),
            advice: "paint in these colours only, without softened edges",
        })
    }

    /// Reads the picture as a sketch in the colours of known layers. Transparent pixels, antialiased edges
    /// and, if no layer is white, white pixels are not painted.
    ///
    /// # Errors
    /// [`Error::Control`] if more than 2 % of the pixels are painted in other colours.
    pub fn sketch_in_colours_of(&self, map: &LayerMap) -> Result<Vec<Option<u32>>> {
        let colours: Vec<Colour> = map.layers.iter().map(|l| l.colour).collect();
        let blank = |p: [u8; 4]| p[3] < 128 || p[..3].iter().all(|&v| v > 255 - TOLERANCE);
        let of = |p: &image::Rgba<u8>| matching(&colours, p.0).filter(|_| p.0[3] >= 128).map(|k| k as u32);
        let sketch: Vec<Option<u32>> = self.image.pixels().map(of).collect();
        let foreign = self.image.pixels().zip(&sketch).filter(|(p, l)| l.is_none() && !blank(p.0)).count();
        if foreign as f64 <= MOST_SOFT * sketch.len() as f64 {
            return Ok(sketch);
        }
        Err(Error::Control {
            name: self.name.clone(),
            role: "a sketch of layers",
            reason: format!("it is painted in other colours than {}", listed(map)),
            advice: "paint strokes in the colours of the layers on a transparent or white background",
        })
    }
}

/// Index of the nearest colour within the tolerance.
fn matching(colours: &[Colour], p: [u8; 4]) -> Option<usize> {
    let off = |c: &Colour| (0..3).map(|k| c.0[k].abs_diff(p[k])).max().unwrap_or(0);
    let best = (0..colours.len()).min_by_key(|&k| off(&colours[k]))?;
    (off(&colours[best]) <= TOLERANCE).then_some(best)
}

/// The colours and names of layers, as text.
fn listed(map: &LayerMap) -> String {
    let each: Vec<String> = map.layers.iter().map(|l| format!("{} ({})", l.colour, l.name)).collect();
    each.join(", ")
}

/// The palette of a PNG written by vtex.
fn own_palette(bytes: &[u8]) -> Option<Vec<Colour>> {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    let info = reader.info();
    let ours = |t: &png::text_metadata::TEXtChunk| t.keyword == "Software" && t.text.starts_with("vtex ");
    if !info.uncompressed_latin1_text.iter().any(ours) {
        return None;
    }
    let palette = info.palette.as_ref()?;
    Some(palette.chunks_exact(3).map(|c| Colour([c[0], c[1], c[2]])).collect())
}

/// The pixels of a hole: white ones (grey value at least half) or, in a picture with transparency, opaque
/// ones.
///
/// # Errors
/// [`Error::Decode`] and [`Error::TooLarge`].
pub fn hole(bytes: &[u8], name: &str, limits: &Limits) -> Result<([usize; 2], Vec<bool>)> {
    let picture = LayerPicture::from_bytes(bytes, name, limits)?;
    let by_alpha = picture.image.pixels().any(|p| p.0[3] < 255);
    let inside = |p: &image::Rgba<u8>| {
        let [r, g, b, a] = p.0.map(u32::from);
        if by_alpha { a >= 128 } else { 2126 * r + 7152 * g + 722 * b >= 128 * 10_000 }
    };
    Ok((picture.size(), picture.image.pixels().map(inside).collect()))
}

#[cfg(test)]
mod tests {
    use super::super::testing::nested;
    use super::*;
    use image::{Rgba, RgbaImage};

    const COLOURS: [[u8; 3]; 3] = [[180, 180, 170], [140, 80, 40], [60, 110, 50]];

    fn picture(image: RgbaImage) -> LayerPicture {
        LayerPicture { name: "map.png".into(), image, palette: None }
    }

    fn painted() -> (LabelMap, RgbaImage) {
        let map = nested([60, 50], 3, 1);
        let image = RgbaImage::from_fn(60, 50, |x, y| {
            let [r, g, b] = COLOURS[map.get(x, y) as usize];
            Rgba([r, g, b, 255])
        });
        (map, image)
    }

    #[test]
    fn a_painted_map_is_read_in_the_order_of_contact() {
        let (map, image) = painted();
        assert!(picture(image.clone()).is_flat());
        let read = picture(image.clone()).layers().unwrap();
        let turned = read.layers[0].colour == Colour(COLOURS[2]);
        let labels: Vec<u32> = map.labels.iter().map(|&l| if turned { 2 - l } else { l }).collect();
        assert_eq!(read.labels.labels, labels);
        let palette = Some([COLOURS[1], COLOURS[0], COLOURS[2]].map(Colour).to_vec());
        let own = LayerPicture { palette, ..picture(image) }.layers().unwrap();
        assert_eq!(own.layers[0].colour, Colour(COLOURS[1]));
    }

    #[test]
    fn softened_edges_are_no_layers() {
        let (map, mut image) = painted();
        for i in 0..40 {
            image.put_pixel(i, i, Rgba([100 + i as u8, 100, 90, 255]));
        }
        let read = picture(image.clone()).layers().unwrap();
        assert_eq!(read.layers.len(), 3);
        let same = picture(image).in_colours_of(&read).unwrap();
        assert_eq!(same, read.labels);
        assert_eq!((same.width, same.height), (map.width, map.height));
    }

    #[test]
    fn too_few_and_too_many_colours_are_refused() {
        let one = picture(RgbaImage::from_pixel(20, 20, Rgba([9, 9, 9, 255])));
        let error = one.layers().unwrap_err().to_string();
        assert!(error.contains("a single colour"), "{error}");
        let many = picture(RgbaImage::from_fn(60, 50, |x, y| Rgba([(x * 5) as u8, (y % 5) as u8, 0, 255])));
        let error = many.layers().unwrap_err().to_string();
        assert!(error.contains("it has 260 colours") || error.contains("it has 300 colours"), "{error}");
        assert!(!many.is_flat());
        let (_, image) = painted();
        let map = picture(image).layers().unwrap();
        let error = many.in_colours_of(&map).unwrap_err().to_string();
        assert!(error.contains("of its pixels have none of the colours"), "{error}");
        assert!(many.sketch_in_colours_of(&map).is_err());
    }

    #[test]
    fn what_is_not_painted_is_free() {
        let (_, image) = painted();
        let map = picture(image).layers().unwrap();
        let [r, g, b] = map.layers[2].colour.0;
        let sketch = RgbaImage::from_fn(30, 10, |x, _| match x {
            0..10 => Rgba([255; 4]),
            10..20 => Rgba([r, g, b, 0]),
            _ => Rgba([r, g, b, 255]),
        });
        let sketch = picture(sketch).sketch_in_colours_of(&map).unwrap();
        assert_eq!(sketch.iter().filter(|l| **l == Some(2)).count(), 100);
        assert_eq!(sketch.iter().filter(|l| l.is_none()).count(), 200);
    }
}
