//! New maps by boundary optimisation: without a start and within a hole. Borders look like the exemplar's.

use super::boundary::{Job, Start, nested};
use super::carried::LayerExemplar;
use super::map::{LayerMap, LayerRegion};
use super::regions::{Depths, depth};
use vtex_base::error::{Error, Result};
use vtex_base::progress::Progress;
use vtex_base::raster::blur::Plane;
use vtex_base::raster::{LabelMap, check_size};

impl LayerExemplar<'_> {
    /// Makes a new map of `size` pixels by the paper's boundary optimisation. The map repeats along the
    /// axes of `wrap`. Areas are those of the exemplar. Colours are not used.
    ///
    /// # Errors
    /// As [`LayerExemplar::carried`].
    pub fn optimised(
        &self,
        size: [usize; 2],
        wrap: [bool; 2],
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<LayerMap> {
        self.check()?;
        check_size(size)?;
        let own = self.regions();
        let shares = cumulative(&self.map.shares());
        let cells = size.map(|v| v.div_ceil(self.cell()));
        let job = Job { exemplar: &own, size: cells, wrap, shares: &shares, start: Start::Random, seed };
        let made = nested(&job, progress)?;
        let labels =
            on_canvas(&made, size, wrap).labels(&self.map.shares(), self.most_distant(), self.speck());
        Ok(self.map.with(labels))
    }

    /// Takes a map made by hand, with its own labels and areas. Where non-consecutive layers touch more than
    /// in the exemplar, thin strips of the layers between them are inserted.
    ///
    /// # Errors
    /// [`Error::Control`] if the exemplar's map has one layer; a size out of range.
    pub fn controlled(&self, map: &LabelMap, wrap: [bool; 2]) -> Result<LayerMap> {
        check_size([map.width as usize, map.height as usize])?;
        self.separated(map, wrap)
    }

    /// [`LayerExemplar::controlled`] without a limit of size.
    pub fn separated(&self, map: &LabelMap, wrap: [bool; 2]) -> Result<LayerMap> {
        self.check()?;
        let size = [map.width as usize, map.height as usize];
        let given = self.map.with(map.clone());
        let planes = (1..given.layers.len()).map(|k| depth(&given.region(k, wrap))).collect();
        let labels =
            Depths { size, wrap, grid: size, planes }.labels(&given.shares(), self.most_distant(), 0);
        Ok(self.map.with(labels))
    }

    /// Fills a hole in `keep` anew. Pixels outside the hole do not change. Areas in the hole are those of
    /// the exemplar.
    ///
    /// # Errors
    /// [`Error::Control`] if the hole has another size, is empty, or leaves nothing to keep;
    /// [`Error::Interrupted`].
    pub fn filled(
        &self,
        keep: &LabelMap,
        hole: &[bool],
        wrap: [bool; 2],
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<LayerMap> {
        self.check()?;
        let size = [keep.width as usize, keep.height as usize];
        check_size(size)?;
        let open = hole.iter().filter(|&&h| h).count();
        let refuse = |reason: String, advice| {
            Err(Error::Control { name: "the hole".into(), role: "the part of a map to fill", reason, advice })
        };
        if hole.len() != keep.labels.len() {
            return refuse("it has another size than the map".into(), "make both of the same size");
        }
        if open == 0 {
            return refuse("it is empty".into(), "paint what is to be filled white on black");
        }
        if open == hole.len() {
            return refuse("it covers everything".into(), "leave some of the map, or make a new one");
        }
        let count = self.map.layers.len();
        let own = self.regions();
        let cells = size.map(|v| v.div_ceil(self.cell()));
        let regions = regions_of(keep, count, cells, wrap);
        // A cell may change if the hole touches it.
        let free: Vec<bool> = (0..cells[0] * cells[1]).map(|i| touched(hole, size, cells, i)).collect();
        let outside =
            |region: &LayerRegion| (0..free.len()).filter(|&i| !free[i] && region.inside[i]).count();
        let open = free.iter().filter(|&&f| f).count();
        let shares: Vec<f64> = cumulative(&self.map.shares())
            .iter()
            .zip(&regions)
            .map(|(share, region)| (outside(region) as f64 + share * open as f64) / free.len() as f64)
            .collect();
        let start = Start::Hole { regions: &regions, free: &free };
        let job = Job { exemplar: &own, size: cells, wrap, shares: &shares, start, seed };
        let made = nested(&job, progress)?;
        let depths = on_canvas(&made, size, wrap);
        let made = depths.labels(&shares_of(&made), 1.0, 0);
        Ok(self.map.with(joined(keep, hole, &made, count, self.cell(), wrap)))
    }

    /// The regions from S_1 up, by cell.
    pub(super) fn regions(&self) -> Vec<LayerRegion> {
        let cells = self.map.size().map(|v| (v / self.cell()).max(1));
        regions_of(&self.map.labels, self.map.layers.len(), cells, [false; 2])
    }
}

/// The regions from S_1 up of a map of `count` layers, by cell.
pub(super) fn regions_of(
    map: &LabelMap,
    count: usize,
    cells: [usize; 2],
    wrap: [bool; 2],
) -> Vec<LayerRegion> {
    let size = [map.width as usize, map.height as usize];
    let labels: Vec<Option<u32>> = map.labels.iter().map(|&l| Some(l)).collect();
    (1..count).map(|k| covered(&labels, size, (cells, 2), wrap, k as u32)).collect()
}

/// Share of each layer and all above it, from S_1 up.
fn cumulative(shares: &[f64]) -> Vec<f64> {
    (1..shares.len()).map(|k| shares[k..].iter().sum()).collect()
}

/// Share of each layer, computed from regions.
fn shares_of(regions: &[LayerRegion]) -> Vec<f64> {
    let cells = regions.first().map_or(1, |r| r.inside.len()) as f64;
    let mut all = vec![1.0];
    all.extend(regions.iter().map(|r| r.area() as f64 / cells));
    (0..all.len()).map(|k| all[k] - all.get(k + 1).copied().unwrap_or(0.0)).collect()
}

/// The ranges of pixels that a cell covers along both axes.
fn pixels(size: [usize; 2], cells: [usize; 2], cell: usize) -> [std::ops::Range<usize>; 2] {
    let at = [cell % cells[0], cell / cells[0]];
    [0, 1].map(|k| at[k] * size[k] / cells[k]..((at[k] + 1) * size[k]).div_ceil(cells[k]))
}

/// The cells in which at least one of `parts` pixels has a label of `least` or more.
pub(super) fn covered(
    labels: &[Option<u32>],
    size: [usize; 2],
    (cells, parts): ([usize; 2], usize),
    wrap: [bool; 2],
    least: u32,
) -> LayerRegion {
    let inside = (0..cells[0] * cells[1])
        .map(|cell| {
            let [xs, ys] = pixels(size, cells, cell);
            let all = xs.len() * ys.len();
            let inside = ys.flat_map(|y| xs.clone().map(move |x| y * size[0] + x));
            parts * inside.filter(|&i| labels[i].is_some_and(|l| l >= least)).count() >= all
        })
        .collect();
    LayerRegion { size: cells, wrap, inside }
}

/// Whether any pixel of a cell is set.
fn touched(set: &[bool], size: [usize; 2], cells: [usize; 2], cell: usize) -> bool {
    let [xs, ys] = pixels(size, cells, cell);
    ys.into_iter().any(|y| set[y * size[0]..][xs.clone()].contains(&true))
}

/// Depths of regions of cells on a canvas of pixels.
pub(super) fn on_canvas(regions: &[LayerRegion], size: [usize; 2], wrap: [bool; 2]) -> Depths {
    let grid = regions.first().map_or([1; 2], |r| r.size);
    Depths { size, wrap, grid, planes: regions.iter().map(soft_depth).collect() }
}

/// The depth of each cell in a region, without the steps of cells.
pub(super) fn soft_depth(region: &LayerRegion) -> Vec<f32> {
    Plane { size: region.size, values: depth(region) }.blurred(0.6, region.wrap).values
}

/// Combines `keep` outside a hole with `made` inside, and smooths the transition.
fn joined(
    keep: &LabelMap,
    hole: &[bool],
    made: &LabelMap,
    count: usize,
    cell: usize,
    wrap: [bool; 2],
) -> LabelMap {
    let size = [keep.width as usize, keep.height as usize];
    let mut labels: Vec<u32> =
        (0..hole.len()).map(|i| if hole[i] { made.labels[i] } else { keep.labels[i] }).collect();
    for _ in 0..2 {
        let level = |k: usize| {
            let values = labels.iter().map(|&l| if l as usize >= k { 1.0 } else { 0.0 }).collect();
            Plane { size, values }.blurred(cell as f32 / 2.0, wrap).values
        };
        let levels: Vec<Vec<f32>> = (1..count).map(level).collect();
        for i in (0..hole.len()).filter(|&i| hole[i]) {
            labels[i] = levels.iter().filter(|plane| plane[i] > 0.5).count() as u32;
        }
    }
    LabelMap { labels, ..*keep }
}

#[cfg(test)]
mod tests {
    use super::super::map::{Contacts, MapLayer};
    use super::super::names::named;
    use super::super::testing::nested as painted;
    use super::*;
    use vtex_base::raster::colour::Colour;

    fn layers(count: u8) -> Vec<MapLayer> {
        named(&(0..count).map(|k| Colour([40 + 60 * k, 90, 60])).collect::<Vec<_>>())
    }

    fn exemplar(count: u8, seed: u64) -> LayerMap {
        LayerMap { labels: painted([128, 128], usize::from(count), seed), layers: layers(count) }
    }

    #[test]
    fn optimised_maps_keep_areas_and_order() {
        let map = exemplar(3, 1);
        let made =
            LayerExemplar { map: &map, photograph: None }.optimised([192, 188], [true; 2], 2, &()).unwrap();
        for (own, theirs) in made.shares().iter().zip(map.shares()) {
            assert!((own - theirs).abs() < 0.02, "{:?}", made.shares());
        }
        let own = Contacts::new(&made.labels, 3, [true; 2]).distant();
        assert!(own <= LayerExemplar { map: &map, photograph: None }.most_distant(), "{own}");
    }

    #[test]
    fn a_map_made_by_hand_stays_but_for_strips() {
        let map = exemplar(3, 4);
        let exemplar = LayerExemplar { map: &map, photograph: None };
        let sound = painted([90, 80], 3, 7);
        assert_eq!(exemplar.controlled(&sound, [false; 2]).unwrap().labels, sound);
        let mut rough = LabelMap::filled(90, 80, 0);
        (20..60).for_each(|y| (20..60).for_each(|x| rough.set(x, y, 2)));
        (0..80).for_each(|y| (0..8).for_each(|x| rough.set(x, y, 1)));
        let mended = exemplar.controlled(&rough, [false; 2]).unwrap().labels;
        assert!(Contacts::new(&mended, 3, [false; 2]).distant() <= exemplar.most_distant());
        assert_eq!(mended.areas(), rough.areas());
    }

    #[test]
    fn outside_a_hole_nothing_changes() {
        let map = exemplar(3, 3);
        let keep = painted([180, 150], 3, 4);
        let hole: Vec<bool> = (0..180 * 150)
            .map(|i| (i as i64 % 180 - 90).pow(2) + (i as i64 / 180 - 70).pow(2) < 1300)
            .collect();
        let exemplar = LayerExemplar { map: &map, photograph: None };
        let made = exemplar.filled(&keep, &hole, [false; 2], 5, &()).unwrap();
        assert!((0..hole.len()).all(|i| hole[i] || made.labels.labels[i] == keep.labels[i]));
        let filled: Vec<u32> = (0..hole.len()).filter(|&i| hole[i]).map(|i| made.labels.labels[i]).collect();
        assert!((0..3).all(|l| filled.contains(&l)), "one layer is missing");
        assert!(Contacts::new(&made.labels, 3, [false; 2]).distant() < 0.03);
        for (hole, what) in [
            (vec![true; hole.len()], "everything"),
            (vec![false; hole.len()], "empty"),
            (vec![true; 3], "size"),
        ] {
            let error = exemplar.filled(&keep, &hole, [false; 2], 5, &()).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
