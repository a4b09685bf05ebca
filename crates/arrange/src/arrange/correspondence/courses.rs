//! Courses: elements of one row, such as bricks, laid so that the joints between them are as wide as in the exemplar.
//!
//! Whole elements stand for what the field brings, and are a little longer or shorter than that: joints would open
//! here and close there. Neighbours of one row therefore meet half-way, and each element is stretched gently along the
//! row to fill its place.

use super::mapped::{Moments, STRETCH};
use super::rows::{Ends, Rows};
use crate::arrange::grid::Grid;
use crate::arrange::model::{Content, PlaceableId, PlacementModel, VariantId};
use vtex_scene::lattice::{Lattice, Phases};

/// An element belongs to a row if it is so thick, in periods of the rows, and at least so long, in thicknesses.
const THICKNESS: [f64; 2] = [0.4, 1.1];
const LEAST_LENGTH: f64 = 0.4;
/// Least share of the area of an exemplar's primaries that belongs to rows.
const LEAST_SHARE: f64 = 0.7;
/// Greatest distance between two neighbours, and greatest overlap, as a share of the usual length.
const NEIGHBOURS: f64 = 0.4;
/// Rounds in which what one element cannot fill is taken up by the next.
const ROUNDS: usize = 8;
/// Stretches nearer to 1 are not worth a map of their own.
const LEAST_STRETCH: f64 = 0.015;

/// The rows of a library's elements.
pub(super) struct Courses<'a> {
    canvas: &'a Phases,
    library: usize,
    /// In pixels.
    rows: Rows,
    /// Phase of their middles.
    middle: f64,
    /// Usual width of the joints between elements of a row, and their usual length, in pixels.
    joint: f64,
    length: f64,
}

/// An element in a row: its ends along it, in pixels.
#[derive(Clone, Copy, Debug)]
struct Laid {
    /// Index among the elements.
    index: usize,
    row: i64,
    ends: [f64; 2],
    /// The ends that it takes.
    new: [f64; 2],
    /// Whether it stays as it is.
    fixed: bool,
}

impl<'a> Courses<'a> {
    /// The rows of an exemplar; `None` if its elements do not lie in rows.
    pub(super) fn find(
        model: &PlacementModel,
        library: usize,
        (lattice, canvas): &'a (Lattice, Phases),
    ) -> Option<Self> {
        let rows = Rows::of(lattice, 1.0)?;
        let mut this = Self { canvas, library, rows, middle: 0.0, joint: 0.0, length: 0.0 };
        let (mut all, mut in_rows, mut sum) = (0.0, 0.0, [0.0; 2]);
        let mut laid = Vec::new();
        for id in model.sources[library].elements.clone() {
            let element = &model.elements[id as usize];
            let mask = &model.plain(PlaceableId(id)).mask;
            let Some(moments) = Moments::of(mask) else { continue };
            let area = f64::from(mask.area());
            all += area;
            if element.clipped || !this.is_in_a_row(&moments) {
                continue;
            }
            in_rows += area;
            let place = [0, 1].map(|k| moments.middle[k] + f64::from(element.origin[k]));
            let [_, phase] = rows.place(place);
            let (sine, cosine) = libm::sincos(std::f64::consts::TAU * phase);
            sum = [sum[0] + area * cosine, sum[1] + area * sine];
            laid.push((phase, this.ends(&moments, place)));
        }
        if in_rows < LEAST_SHARE * all {
            return None;
        }
        this.middle = libm::atan2(sum[1], sum[0]) / std::f64::consts::TAU;
        let row = |phase: f64| libm::round(phase - this.middle) as i64;
        let mut laid: Vec<(i64, [f64; 2])> =
            laid.into_iter().map(|(phase, ends)| (row(phase), ends)).collect();
        laid.sort_by(|a, b| a.0.cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])));
        this.length = median(laid.iter().map(|(_, ends)| ends[1] - ends[0]).collect())?;
        let next_to = laid.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        let gaps = next_to.map(|pair| pair[1].1[0] - pair[0].1[1]);
        this.joint = median(gaps.filter(|gap| gap.abs() <= NEIGHBOURS * this.length).collect())?;
        Some(this)
    }

    fn is_in_a_row(&self, moments: &Moments) -> bool {
        let [length, thickness] = self.sides(moments);
        let thick = thickness / self.rows.period;
        (THICKNESS[0]..=THICKNESS[1]).contains(&thick) && length >= LEAST_LENGTH * thickness
    }

    /// Length along the rows and thickness of the rectangle that has the same moments, in pixels.
    fn sides(&self, moments: &Moments) -> [f64; 2] {
        let [x, y] = self.rows.along;
        [[x, y], [-y, x]].map(|way| libm::sqrt(12.0 * moments.variance(way)))
    }

    /// The ends of an element along the rows, with its middle at a place.
    fn ends(&self, moments: &Moments, place: [f64; 2]) -> [f64; 2] {
        let [length, _] = self.sides(moments);
        let [along, _] = self.rows.place(place);
        [along - 0.5 * length, along + 0.5 * length]
    }

    /// Lays the elements of the library anew along their rows. Those that are stretched are added to the model.
    pub(super) fn lay(
        &self,
        elements: &mut [(VariantId, [i32; 2])],
        model: &mut PlacementModel,
        grid: &Grid,
        wrap: [bool; 2],
    ) {
        let wave = self.canvas.waves[0];
        let Some(canvas) = Ends::of(&self.rows, wave, grid.canvas(), wrap) else { return };
        let place_of = |moments: &Moments, at: [i32; 2]| {
            [0, 1].map(|k| moments.middle[k] + f64::from(at[k] - grid.margin[k]))
        };
        let mut laid = Vec::new();
        for (index, &(variant, at)) in elements.iter().enumerate() {
            let element = model.element(variant);
            let Some(moments) = Moments::of(&model.shape(variant).mask) else { continue };
            if element.library != self.library || !self.is_in_a_row(&moments) {
                continue;
            }
            let place = place_of(&moments, at);
            let row = canvas.row(libm::round(place[0] * wave[0] + place[1] * wave[1] - self.middle));
            let ends = self.ends(&moments, place);
            let fixed = matches!(element.content, Content::Fused(_)) || element.clipped;
            laid.push(Laid { index, row, ends, new: ends, fixed });
        }
        laid.sort_by(|a, b| {
            a.row.cmp(&b.row).then(a.ends[0].total_cmp(&b.ends[0])).then(a.index.cmp(&b.index))
        });
        for row in laid.chunk_by_mut(|a, b| a.row == b.row) {
            for _ in 0..ROUNDS {
                self.meet(row, canvas.around);
            }
        }
        for one in laid.iter().filter(|one| !one.fixed) {
            let (variant, at) = elements[one.index];
            let [before, after] =
                [one.ends, one.new].map(|ends| [ends[1] - ends[0], 0.5 * (ends[0] + ends[1])]);
            let (stretch, moved) = (after[0] / before[0], after[1] - before[1]);
            let way = self.rows.along.map(|c| c * moved);
            if libm::fabs(stretch - 1.0) < LEAST_STRETCH {
                elements[one.index].1 = [0, 1].map(|k| at[k] + libm::round(way[k]) as i32);
                continue;
            }
            let element = *model.element(variant);
            let [x, y] = self.rows.along;
            let longer = stretch - 1.0;
            let map = match element.content {
                Content::Mapped(map) => model.maps[map as usize],
                _ => *model.variation(variant),
            };
            let map = map.then([1.0 + longer * x * x, longer * x * y, 1.0 + longer * y * y]);
            let known = PlaceableId(model.sources[element.library].elements.start + element.index);
            let mask = map.of_mask(&model.plain(known).mask);
            let [Some(old), Some(new)] = [&model.shape(variant).mask, &mask].map(Moments::of) else {
                continue;
            };
            let at =
                [0, 1].map(|k| libm::round(f64::from(at[k]) + old.middle[k] + way[k] - new.middle[k]) as i32);
            elements[one.index] = (model.add_mapped(variant, mask, map), at);
        }
    }

    /// Moves the ends of neighbours to where they leave a joint between them, as far as they may be stretched.
    /// `around` is the length of a row whose last element is beside its first.
    fn meet(&self, row: &mut [Laid], around: Option<f64>) {
        let count = row.len();
        let mut wanted: Vec<[f64; 2]> = row.iter().map(|one| one.new).collect();
        for i in 0..count {
            let (j, beyond) = match (i + 1 < count, around) {
                (true, _) => (i + 1, 0.0),
                (false, Some(around)) if count > 1 => (0, around),
                _ => continue,
            };
            let (end, begin) = (row[i].new[1], row[j].new[0] + beyond);
            if libm::fabs(begin - end - self.joint) > NEIGHBOURS * self.length {
                continue;
            }
            let middle = match (row[i].fixed, row[j].fixed) {
                (true, true) => continue,
                (true, false) => end + 0.5 * self.joint,
                (false, true) => begin - 0.5 * self.joint,
                (false, false) => 0.5 * (begin + end),
            };
            wanted[i][1] = middle - 0.5 * self.joint;
            wanted[j][0] = middle + 0.5 * self.joint - beyond;
        }
        for (one, ends) in row.iter_mut().zip(wanted).filter(|(one, _)| !one.fixed) {
            let own = one.ends[1] - one.ends[0];
            let length = (ends[1] - ends[0]).clamp(STRETCH[0] * own, STRETCH[1] * own);
            let middle = 0.5 * (ends[0] + ends[1]);
            one.new = [middle - 0.5 * length, middle + 0.5 * length];
        }
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
