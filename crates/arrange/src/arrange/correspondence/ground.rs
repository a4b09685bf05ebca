//! Ground where a primary was to be: the field there points at primaries, and the secondaries and the colours of the
//! ground would be missing.
//!
//! Where no primary was placed, because the one of the field was moved, replaced by one of another shape or left out,
//! cells take their source anew: from the exemplar's ground, where primaries are as far away and on the same sides. A
//! joint that whole tiles leave open is thus filled from a joint. Sources are chosen like the pixels of Ashikhmin
//! ("Synthesizing Natural Textures", 2001): mostly those that continue the sources of adjacent cells.

use super::Correspondence;
use super::pages::border_distances;
use crate::arrange::model::PlacementModel;
use crate::arrange::occupancy::Occupancy;
use vtex_base::parallel;
use vtex_base::raster::LabelMap;
use vtex_base::sampling::stream;
use vtex_field::correspondence::CellSource;
use vtex_scene::library::Library;

/// A cell is ground if at least this share of it is.
const GROUND: f32 = 0.25;
/// Distances to borders are clamped to this, in cells.
const FARTHEST: f32 = 3.0;
/// Radius of the neighbourhoods whose distances are compared, in cells.
const REACH: i32 = 2;
/// Most cells of the ground of an exemplar that are compared with a cell, if none that continue others are good: those
/// whose cost is at most this.
const MOST_COMPARED: usize = 300;
const GOOD: f32 = 0.12;
/// Cost of a source that continues no adjacent one, as a mean difference of distances.
const ALONE: f32 = 0.15;
/// Weight of the colours where a source does not continue that of an adjacent cell.
const SEAM: f32 = 0.02;
/// Passes over all cells.
const PASSES: usize = 2;

const AROUND: [[i32; 2]; 8] = [[-1, 0], [1, 0], [0, -1], [0, 1], [-1, -1], [1, -1], [-1, 1], [1, 1]];

/// Ground and borders of a canvas or of a page, by cell.
struct Layout {
    /// In cells.
    size: [i32; 2],
    /// Share of ground.
    ground: Vec<f32>,
    /// Mean distance to the nearest border of a primary: up to 1 within primaries, down to -1 on the ground.
    distance: Vec<f32>,
    wrap: [bool; 2],
}

impl Layout {
    /// `place` gives the pixel of the map for a pixel of the layout.
    fn new(
        labels: &LabelMap,
        cell: i32,
        size: [i32; 2],
        wrap: [bool; 2],
        place: impl Fn([i32; 2]) -> Option<[i32; 2]> + Sync,
    ) -> Self {
        let borders = border_distances(labels, cell as f32 * FARTHEST);
        let of = |&i: &usize| {
            let first = [i as i32 % size[0], i as i32 / size[0]].map(|v| v * cell);
            let (mut ground, mut sum, mut count) = (0.0, 0.0, 0.0f32);
            for [u, v] in (0..cell).flat_map(|v| (0..cell).map(move |u| [u, v])) {
                let Some([x, y]) = place([first[0] + u, first[1] + v]) else { continue };
                let k = y as usize * labels.width as usize + x as usize;
                ground += f32::from(u8::from(labels.labels[k] == 0));
                sum += borders[k];
                count += 1.0;
            }
            (ground / count.max(1.0), sum / count.max(1.0))
        };
        let cells: Vec<usize> = (0..(size[0] * size[1]) as usize).collect();
        let (ground, distance) = parallel::map(&cells, of).into_iter().unzip();
        Self { size, ground, distance, wrap }
    }

    fn index(&self, at: [i32; 2]) -> Option<usize> {
        let at = [0, 1].map(|k| if self.wrap[k] { at[k].rem_euclid(self.size[k]) } else { at[k] });
        let inside = (0..2).all(|k| (0..self.size[k]).contains(&at[k]));
        inside.then(|| (at[1] * self.size[0] + at[0]) as usize)
    }

    /// Mean difference of the distances around two cells; what is beyond a border does not count. Infinite above `most`.
    fn difference(&self, at: [i32; 2], other: &Self, there: [i32; 2], most: f32) -> f32 {
        const SIDE: i32 = 2 * REACH + 1;
        let (mut sum, mut count) = (0.0, 0);
        let all_there =
            |layout: &Self, at: [i32; 2]| (0..2).all(|k| at[k] >= REACH && at[k] + REACH < layout.size[k]);
        let inner = all_there(self, at) && all_there(other, there);
        for dy in -REACH..=REACH {
            if inner {
                let row =
                    |layout: &'_ Self, [x, y]: [i32; 2]| ((y + dy) * layout.size[0] + x - REACH) as usize;
                let [a, b] = [row(self, at), row(other, there)];
                let pairs =
                    self.distance[a..][..SIDE as usize].iter().zip(&other.distance[b..][..SIDE as usize]);
                sum += pairs.map(|(a, b)| (a - b).abs()).sum::<f32>();
                count += SIDE;
            } else {
                for dx in -REACH..=REACH {
                    let [a, b] = [(self, at), (other, there)]
                        .map(|(layout, at)| layout.index([at[0] + dx, at[1] + dy]));
                    let (Some(a), Some(b)) = (a, b) else { continue };
                    sum += (self.distance[a] - other.distance[b]).abs();
                    count += 1;
                }
            }
            if sum > most * (SIDE * SIDE) as f32 {
                return f32::INFINITY;
            }
        }
        sum / count.max(1) as f32
    }
}

impl Correspondence {
    /// Takes cells without a primary from the ground of their exemplar.
    pub(in crate::arrange) fn take_ground(&mut self, libraries: &[Library], map: &Occupancy<'_>, seed: u64) {
        let cell = self.pages.cell;
        let [width, height] = map.grid.canvas().map(|v| v as u32);
        let label = |i: usize| {
            let at = [0, 1].map(|k| [i as u32 % width, i as u32 / width][k] as i32 + map.grid.margin[k]);
            map.grid.cell(at).map_or(0, |i| map.owner[i].as_placed().map_or(0, |id| id.0 + 1))
        };
        let labels = (0..(width * height) as usize).map(label).collect();
        let canvas = LabelMap { width, height, labels };
        let size = self.field.size.map(|v| v as i32);
        let margin = self.margin;
        let on_canvas = |at: [i32; 2]| {
            let at = [0, 1].map(|k| at[k] - margin[k] * cell);
            let on_canvas = (0..2).all(|k| (0..[width, height][k] as i32).contains(&at[k]));
            // What is not to be filled is not bare.
            (on_canvas && map.inside([0, 1].map(|k| at[k] + map.grid.margin[k]))).then_some(at)
        };
        let canvas = Layout::new(&canvas, cell, size, self.field.wrap, on_canvas);
        for (number, library) in libraries.iter().enumerate() {
            self.take_ground_of(library, number, map.model(), &canvas, seed);
        }
    }

    fn take_ground_of(
        &mut self,
        library: &Library,
        number: usize,
        model: &PlacementModel,
        canvas: &Layout,
        seed: u64,
    ) {
        let cell = self.pages.cell;
        // What was left out of the arrangement hides the ground of the exemplar, too.
        let mut labels = self.pages.labels[number].clone();
        if let Some(vacated) = library.arrangement.vacated_labels() {
            let most = labels.labels.iter().max().copied().unwrap_or(0);
            for (label, out) in labels.labels.iter_mut().zip(&vacated.labels) {
                *label = if *out > 0 { most + 1 } else { *label };
            }
        }
        let strata = library.is_layered().then(|| library.strata_labels());
        let Some(page) = self.pages.sheets.iter().position(|sheet| sheet.library == number) else { return };
        let stratum = |page: usize, at: [i32; 2]| {
            let place = self.pages.sheets[page].exemplar(model, at.map(|v| v * cell + cell / 2));
            let of = |map: &LabelMap, [x, y]: [i32; 2]| map.at(i64::from(x), i64::from(y)).unwrap_or(0);
            strata.as_ref().zip(place).map_or(0, |(map, place)| of(map, place))
        };
        let layouts: Vec<Option<Layout>> = (self.pages.sheets.iter().zip(&self.pages.pages))
            .map(|(sheet, page)| {
                let size = page.size.map(|v| v as i32);
                let layout = || Layout::new(&labels, cell, size, [false; 2], |at| sheet.exemplar(model, at));
                (sheet.library == number).then(layout)
            })
            .collect();
        let exemplar = layouts[page].as_ref().expect("it is of the library");
        let is_source = |k: usize| {
            exemplar.ground[k] >= GROUND
                && self.pages.pages[page].inside.as_ref().is_none_or(|inside| inside[k])
        };
        let place = |k: usize, width: i32| [k as i32 % width, k as i32 / width];
        let sources =
            (0..exemplar.ground.len()).filter(|&k| is_source(k)).map(|k| place(k, exemplar.size[0]));
        let sources: Vec<([i32; 2], u32)> = sources.map(|at| (at, stratum(page, at))).collect();
        let [width, height] = canvas.size;
        let is_bare = |i: usize| {
            let source = self.field.sources[i];
            let Some(layout) = &layouts[usize::from(source.page)] else { return false };
            let there = layout.index(source.at.map(i32::from)).map_or(0.0, |k| layout.ground[k]);
            canvas.ground[i] - there >= GROUND
        };
        let bare: Vec<usize> = (0..(width * height) as usize).filter(|&i| is_bare(i)).collect();
        if bare.is_empty() || sources.is_empty() {
            return;
        }
        let step = sources.len().div_ceil(MOST_COMPARED);
        // The cost and the place of the source that is most like a cell, alone.
        let alone = |i: usize, own: u32, most: f32| {
            let first = stream(seed, "correspondence/ground", i as u64).index(step);
            let mut best = (most, None);
            for (there, of) in sources.iter().skip(first).step_by(step) {
                let difference = canvas.difference(place(i, width), exemplar, *there, best.0);
                if *of == own && difference < best.0 {
                    best = (difference, Some(*there));
                }
            }
            best
        };
        let own: Vec<u32> = bare
            .iter()
            .map(|&i| {
                let source = self.field.sources[i];
                stratum(usize::from(source.page), source.at.map(i32::from))
            })
            .collect();
        let features = &self.pages.pages[page].features;
        let mut field = self.field.sources.clone();
        let mut settled = vec![true; field.len()];
        bare.iter().for_each(|&i| settled[i] = false);
        for pass in 0..PASSES {
            for k in 0..bare.len() {
                let k = if pass % 2 == 0 { k } else { bare.len() - 1 - k };
                let (i, at, own) = (bare[k], place(bare[k], width), own[k]);
                // Places of the page that continue the sources around.
                let around: Vec<[i32; 2]> = AROUND
                    .iter()
                    .filter_map(|d| {
                        let j = canvas.index([at[0] + d[0], at[1] + d[1]]).filter(|&j| settled[j])?;
                        let source = field[j];
                        (usize::from(source.page) == page)
                            .then(|| [0, 1].map(|k| i32::from(source.at[k]) - d[k]))
                    })
                    .collect();
                let seam = |there: [i32; 2]| {
                    let here = exemplar.index(there).map(|k| features[k]);
                    let apart = around.iter().filter(|other| **other != there).filter_map(|other| {
                        let (here, other) = (here?, features[exemplar.index(*other)?]);
                        Some((0..3).map(|c| (here[c] - other[c]).abs()).sum::<f32>())
                    });
                    SEAM * apart.sum::<f32>()
                };
                let mut best = (f32::INFINITY, None);
                if settled[i] && usize::from(field[i].page) == page {
                    let there = field[i].at.map(i32::from);
                    let cost = canvas.difference(at, exemplar, there, f32::INFINITY) + seam(there);
                    best = (cost + if around.contains(&there) { 0.0 } else { ALONE }, Some(there));
                }
                for &there in &around {
                    let suits = exemplar.index(there).is_some_and(is_source) && stratum(page, there) == own;
                    if suits {
                        let seam = seam(there);
                        let cost = canvas.difference(at, exemplar, there, best.0 - seam) + seam;
                        if cost < best.0 {
                            best = (cost, Some(there));
                        }
                    }
                }
                if best.0 > GOOD && !settled[i] {
                    let (difference, there) = alone(i, own, best.0 - ALONE);
                    best = there.map_or(best, |there| (difference + ALONE, Some(there)));
                }
                if let Some(there) = best.1 {
                    field[i] = CellSource { page: page as u16, at: there.map(|v| v as u16) };
                    settled[i] = true;
                }
            }
        }
        self.field.sources = field;
    }
}
