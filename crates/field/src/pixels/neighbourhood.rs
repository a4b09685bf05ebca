//! Neighbourhoods of pixels, and the codebook of those of an exemplar.

use super::pyramid::PictureLevel;
use super::tsvq::Codebook;
use vtex_base::error::Result;

/// Radius on the next coarser level, and of the labels in steps of the radius on the level.
const AROUND: i64 = 1;
/// Number of pixels within that radius.
const NINE: usize = ((2 * AROUND + 1) * (2 * AROUND + 1)) as usize;
/// Distance of two labels, in standard deviations of colour.
const LABEL: f32 = 1.0;
/// Most vectors that a codebook is made of, and most values of all of them.
const MOST_VECTORS: usize = 1 << 16;
const MOST_VALUES: usize = 12 << 20;

/// The neighbourhoods of a level: the pixels around a pixel, 3 × 3 pixels of the next coarser level, and
/// 3 × 3 labels.
pub(super) struct Neighbourhood {
    /// Radius on the level, in pixels.
    reach: i64,
    /// Offsets to the pixels of the level.
    offsets: Vec<[i64; 2]>,
    /// Number of labels; 0 without labels.
    labels: u32,
    /// The value of the label that a pixel has; that of others is 0.
    label_value: f32,
}

/// A neighbourhood as a vector.
#[derive(Default)]
pub(super) struct NeighbourhoodVector {
    pub(super) values: Vec<f32>,
    /// For each value 1 if it is known, else 0.
    pub(super) known: Vec<f32>,
}

impl NeighbourhoodVector {
    /// The flags, if a value is not known.
    pub(super) fn gaps(&self) -> Option<&[f32]> {
        self.known.contains(&0.0).then_some(&self.known[..])
    }
}

impl Neighbourhood {
    /// Those of an exemplar's level.
    pub(super) fn new(exemplar: &PictureLevel, reach: i64) -> Self {
        let all = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| [dx, dy]));
        let count = exemplar.known.iter().filter(|known| **known).count().max(1) as f64;
        let known = || (0..exemplar.pixels.len()).filter(|&i| exemplar.known[i]).map(|i| exemplar.pixels[i]);
        let variance = |c: usize| {
            let mean = known().map(|p| f64::from(p[c])).sum::<f64>() / count;
            known().map(|p| (f64::from(p[c]) - mean) * (f64::from(p[c]) - mean)).sum::<f64>() / count
        };
        let largest = exemplar.labels.as_ref().map(|map| map.labels.iter().copied().max().unwrap_or(0));
        Self {
            reach,
            offsets: all.filter(|&offset| offset != [0, 0]).collect(),
            labels: largest.map_or(0, |largest| largest + 1),
            label_value: LABEL * libm::sqrt((0..3).map(variance).sum::<f64>()) as f32,
        }
    }

    /// Number of values.
    fn length(&self, has_coarser: bool) -> usize {
        3 * (self.offsets.len() + if has_coarser { NINE } else { 0 }) + self.labels as usize * NINE
    }

    /// Whether a colour of a vector is known.
    pub(super) fn has_colour(&self, vector: &NeighbourhoodVector) -> bool {
        vector.known[..vector.known.len() - self.labels as usize * NINE].contains(&1.0)
    }

    /// Reads the neighbourhood of a pixel.
    pub(super) fn read(
        &self,
        level: &PictureLevel,
        coarser: Option<&PictureLevel>,
        [x, y]: [i64; 2],
        to: &mut NeighbourhoodVector,
    ) {
        to.values.clear();
        to.known.clear();
        let mut add = |level: &PictureLevel, i: usize| {
            to.values.extend(level.pixels[i]);
            to.known.extend([f32::from(u8::from(level.known[i])); 3]);
        };
        self.offsets.iter().for_each(|[dx, dy]| add(level, level.index([x + dx, y + dy])));
        let around = (-AROUND..=AROUND).flat_map(|dy| (-AROUND..=AROUND).map(move |dx| [dx, dy]));
        if let Some(coarser) = coarser {
            around.clone().for_each(|[dx, dy]| add(coarser, coarser.index([x / 2 + dx, y / 2 + dy])));
        }
        if self.labels > 0 {
            for [dx, dy] in around {
                let own = level.label(level.index([x + dx * self.reach, y + dy * self.reach]));
                to.values.extend((0..self.labels).map(|l| if l == own { self.label_value } else { 0.0 }));
            }
            to.known.resize(to.values.len(), 1.0);
        }
    }
}

/// For each pixel of an exemplar's level whether its neighbourhood of radius `reach` is complete: within the
/// picture, and known.
pub(super) fn complete(level: &PictureLevel, coarser: Option<&PictureLevel>, reach: i64) -> Vec<bool> {
    let [w, h] = level.size.map(|v| v as i64);
    let (own, above) = (UnknownSums::new(level), coarser.map(UnknownSums::new));
    let is_complete = |i: usize| {
        let [x, y] = level.place(i);
        let inside = x >= reach && x < w - reach && y >= reach && y < h - reach;
        inside
            && own.around([x, y], reach) == 0
            && above.as_ref().is_none_or(|above| above.around([x / 2, y / 2], AROUND) == 0)
    };
    (0..level.pixels.len()).map(is_complete).collect()
}

/// Numbers of unknown pixels above and left of each place.
struct UnknownSums {
    size: [i64; 2],
    sums: Vec<u32>,
}

impl UnknownSums {
    fn new(level: &PictureLevel) -> Self {
        let [w, h] = level.size;
        let mut sums = vec![0; (w + 1) * (h + 1)];
        for y in 0..h {
            let mut row = 0;
            for x in 0..w {
                row += u32::from(!level.known[y * w + x]);
                sums[(y + 1) * (w + 1) + x + 1] = sums[y * (w + 1) + x + 1] + row;
            }
        }
        Self { size: [w as i64, h as i64], sums }
    }

    /// Number of unknown pixels within `reach` of a pixel, along both axes.
    fn around(&self, [x, y]: [i64; 2], reach: i64) -> u32 {
        let [w, h] = self.size;
        let from = [x, y].map(|v| (v - reach).max(0));
        let to = [(x + reach + 1).min(w), (y + reach + 1).min(h)];
        let at = |x: i64, y: i64| self.sums[(y * (w + 1) + x) as usize];
        at(to[0], to[1]) + at(from[0], from[1]) - at(from[0], to[1]) - at(to[0], from[1])
    }
}

/// The codebook of an exemplar's neighbourhoods around pixels of one label.
pub(super) struct KnownNeighbourhoods {
    pub(super) vectors: Vec<f32>,
    /// The pixel at the centre of each.
    pub(super) middles: Vec<u32>,
    pub(super) book: Codebook,
}

impl KnownNeighbourhoods {
    /// Reads the complete neighbourhoods, of very many an even sample. Where none around the label is
    /// complete, those at the border are taken, and where no pixel has the label, all. `go_on` may stop the
    /// work.
    pub(super) fn new(
        form: &Neighbourhood,
        level: &PictureLevel,
        coarser: Option<&PictureLevel>,
        complete: &[bool],
        label: u32,
        codewords: usize,
        go_on: &mut dyn FnMut() -> Result<()>,
    ) -> Result<Self> {
        let of = |suits: &dyn Fn(usize) -> bool| -> Vec<usize> {
            (0..complete.len()).filter(|&i| level.known[i] && suits(i)).collect()
        };
        let own = |i: usize| level.label(i) == label;
        let places = [of(&|i| complete[i] && own(i)), of(&own), of(&|_| true)];
        let places = places.into_iter().find(|places| !places.is_empty()).unwrap_or_default();
        let (mut vectors, mut middles) = (Vec::new(), Vec::new());
        let mut vector = NeighbourhoodVector::default();
        let length = form.length(coarser.is_some());
        let step = places.len().div_ceil((MOST_VALUES / length).min(MOST_VECTORS)).max(1);
        for &i in places.iter().step_by(step) {
            form.read(level, coarser, level.place(i), &mut vector);
            vectors.extend(&vector.values);
            middles.push(i as u32);
        }
        let book = Codebook::new(&vectors, length, codewords, go_on)?;
        Ok(Self { vectors, middles, book })
    }
}
