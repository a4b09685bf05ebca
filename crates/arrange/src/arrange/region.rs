//! Where elements are wanted: the shape to fill, local density, and the part of each library. Nothing is
//! stored if there are no maps.
//!
//! Density is corrected by *zones*: sets of cells whose density lies in the same step. Each zone is then
//! corrected as a canvas of constant density is. Zones of half to 1.25 times the exemplar's density are
//! filled along the correspondence field and then thinned or filled up. Others are placed by descriptors.

use super::controls::Controls;
use super::grid::Grid;
use super::model::PlacementModel;
use vtex_base::geometry;
use vtex_base::parallel;
use vtex_base::sampling::Stream;
use vtex_scene::scene::Edge;

/// Zone of a cell that is not to be filled.
const OUTSIDE: u8 = u8::MAX;
/// Steps of density; zone k stands for k / STEP.
const STEP: f64 = 8.0;
/// Densities that correspondence fields serve, relative to the exemplar's.
const CARRIED: std::ops::RangeInclusive<f64> = 0.5..=1.25;
/// Largest wanted coverage as a share of the canvas, whatever the density.
const FULLEST: f64 = 0.95;
/// A library has no part in a cell where its share is smaller.
const LEAST_SHARE: f64 = 0.04;

/// The shape to fill, the density and the share of each library at each place.
pub(crate) struct PlacementRegion<'a> {
    controls: &'a Controls,
    canvas: [f64; 2],
    /// Treatment of elements at the edge.
    pub(crate) edge: Edge,
    /// Zone of each cell; `None` if the canvas is one zone.
    zones: Option<Vec<u8>>,
    /// Libraries that have a part in each cell, a bit each; `None` for one library.
    parts: Option<Vec<u16>>,
    /// Pixels of each zone that belong to each library.
    areas: Vec<Vec<f64>>,
    /// Whether elements are carried along a correspondence field.
    carried: bool,
}

impl<'a> PlacementRegion<'a> {
    /// The region of the cells of a grid. `carried` tells whether a correspondence field places elements.
    pub(crate) fn new(grid: &Grid, controls: &'a Controls, edge: Edge, carried: bool) -> Self {
        let canvas = grid.canvas();
        let libraries = controls.shares.len().max(1);
        let zone_count = if controls.density.is_some() { (Controls::DENSEST * STEP) as usize + 1 } else { 1 };
        // Without a domain, the canvas is the domain.
        let bounded = controls.domain.is_some() || edge != Edge::Clip;
        let mut region = Self {
            controls,
            canvas,
            edge,
            zones: None,
            parts: None,
            areas: vec![vec![0.0; libraries]; zone_count],
            carried,
        };
        if controls.density.is_some() || bounded {
            region.zones = Some(region.zones(grid));
        }
        if libraries > 1 {
            let mut parts = vec![0u16; grid.len()];
            let this = &region;
            parallel::for_chunks(&mut parts, grid.width as usize, |y, row| {
                for (x, part) in row.iter_mut().enumerate() {
                    let shares = this.shares(grid.point([x as i32, y as i32]));
                    let has = |k: &usize| shares[*k] >= LEAST_SHARE;
                    *part = (0..libraries).filter(has).map(|k| 1 << k).sum();
                }
            });
            region.parts = Some(parts);
        }
        region.areas = region.measured(grid, zone_count, libraries);
        region
    }

    /// The region of a band of rows, which may reach across a seam.
    pub(crate) fn band(&self, grid: &Grid, rows: &std::ops::Range<i32>) -> Self {
        let zones = self.zones.as_ref().map(|z| grid.rows_of(z, rows));
        let parts = self.parts.as_ref().map(|l| grid.rows_of(l, rows));
        Self { zones, parts, areas: self.areas.clone(), ..*self }
    }

    /// The zone of every cell.
    fn zones(&self, grid: &Grid) -> Vec<u8> {
        let mut zones = vec![0u8; grid.len()];
        let domain = self.controls.domain.as_ref().map(geometry::Interior::new);
        parallel::for_chunks(&mut zones, grid.width as usize, |y, row| {
            let [_, py] = grid.point([0, y as i32]);
            let inside = domain.as_ref().map(|d| d.intervals(py));
            for (x, zone) in row.iter_mut().enumerate() {
                let [px, _] = grid.point([x as i32, 0]);
                let on_canvas = px > 0.0 && py > 0.0 && px < self.canvas[0] && py < self.canvas[1];
                let within = inside.as_ref().is_none_or(|i| i.iter().any(|[a, b]| (*a..*b).contains(&px)));
                *zone = if on_canvas && within {
                    (self.density([px, py]) * STEP + 0.5) as u8 * u8::from(self.controls.density.is_some())
                } else {
                    OUTSIDE
                };
            }
        });
        zones
    }

    /// Pixels of each zone and library.
    fn measured(&self, grid: &Grid, zones: usize, libraries: usize) -> Vec<Vec<f64>> {
        let mut areas = vec![vec![0.0; libraries]; zones];
        if self.zones.is_none() && libraries == 1 {
            areas[0][0] = self.canvas[0] * self.canvas[1];
            return areas;
        }
        let rows: Vec<i32> = (0..grid.height).collect();
        let sums = parallel::map(&rows, |&y| {
            let mut sums = vec![vec![0.0; libraries]; zones];
            for x in 0..grid.width {
                let zone = grid.canvas_cell([x, y]).and_then(|i| self.zone(i));
                if let Some(zone) = zone {
                    let shares = if libraries > 1 { self.shares(grid.point([x, y])) } else { [1.0; 16] };
                    (0..libraries).for_each(|k| sums[zone][k] += shares[k]);
                }
            }
            sums
        });
        for row in sums {
            for (total, sum) in areas.iter_mut().flatten().zip(row.iter().flatten()) {
                *total += sum;
            }
        }
        areas
    }

    /// Number of zones.
    pub(crate) fn zone_count(&self) -> usize {
        self.areas.len()
    }

    /// The zone of a cell of the canvas; `None` for one that is not to be filled.
    pub(crate) fn zone(&self, i: usize) -> Option<usize> {
        match &self.zones {
            None => Some(0),
            Some(zones) => (zones[i] != OUTSIDE).then(|| usize::from(zones[i])),
        }
    }

    /// Whether all of the canvas is one zone.
    pub(crate) fn is_plain(&self) -> bool {
        self.zones.is_none()
    }

    /// Whether a library has a part in a cell.
    pub(crate) fn admits(&self, i: usize, library: usize) -> bool {
        self.parts.as_ref().is_none_or(|parts| parts[i] >> library & 1 == 1)
    }

    /// Whether there is more than one library.
    pub(crate) fn is_shared(&self) -> bool {
        self.parts.is_some()
    }

    /// Pixels wanted of each category, zone by zone.
    pub(crate) fn wanted(&self, model: &PlacementModel) -> Vec<Vec<f64>> {
        let zone = |(zone, areas): (usize, &Vec<f64>)| {
            let density = self.level(zone);
            let category = |source: usize, categories: std::ops::Range<usize>| {
                let whole: f64 = model.wanted[categories.clone()].iter().sum();
                let most = if density * whole > FULLEST { (FULLEST / whole).max(1.0) } else { density };
                let area = areas[source];
                model.wanted[categories].iter().map(move |share| share * most * area).collect::<Vec<f64>>()
            };
            let sources = model.sources.iter().enumerate();
            sources.flat_map(|(k, s)| category(k, s.categories.clone())).collect()
        };
        self.areas.iter().enumerate().map(zone).collect()
    }

    /// Whether a correspondence field places the elements of a zone. It does where density is near the
    /// exemplar's: carried elements can be removed and a few added, but no more.
    pub(crate) fn is_carried(&self, zone: usize) -> bool {
        self.carried && CARRIED.contains(&self.level(zone))
    }

    /// [`PlacementRegion::is_carried`] of all zones.
    pub(crate) fn all_carried(&self) -> bool {
        (0..self.zone_count()).all(|zone| self.is_carried(zone))
    }

    /// [`PlacementRegion::is_carried`] of a cell of the canvas.
    pub(crate) fn cell_is_carried(&self, i: usize) -> bool {
        self.zone(i).is_some_and(|zone| self.is_carried(zone))
    }

    /// Whether the coverage of a zone needs no correction.
    pub(crate) fn is_settled(&self, zone: usize) -> bool {
        self.carried && self.level(zone) == 1.0
    }

    /// Density relative to the exemplar's in a zone.
    pub(crate) fn level(&self, zone: usize) -> f64 {
        if self.controls.density.is_some() { zone as f64 / STEP } else { 1.0 }
    }

    /// Pixels of a zone that belong to a library.
    pub(crate) fn area(&self, zone: usize, library: usize) -> f64 {
        self.areas[zone][library]
    }

    /// Density relative to the exemplar's at a point of the canvas, 0 to 2.
    pub(crate) fn density(&self, point: [f64; 2]) -> f64 {
        self.controls.density_at(point, self.canvas)
    }

    /// Share of each library at a point of the canvas; they add up to 1. Where all maps are black, the first
    /// library has the whole share.
    pub(crate) fn shares(&self, point: [f64; 2]) -> [f64; Controls::MOST_LIBRARIES] {
        let mut shares = [0.0; Controls::MOST_LIBRARIES];
        for (share, map) in shares.iter_mut().zip(&self.controls.shares) {
            *share = map.at(point, self.canvas).max(0.0);
        }
        let sum: f64 = shares.iter().sum();
        if sum > 0.0 {
            shares.iter_mut().for_each(|s| *s /= sum);
        } else {
            shares[0] = 1.0;
        }
        shares
    }

    /// A library drawn by its share at a point of the canvas. A single library needs no draw.
    pub(crate) fn draw_library(&self, point: [f64; 2], random: &mut Stream) -> usize {
        if !self.is_shared() {
            return 0;
        }
        let shares = self.shares(point).map(|s| if s < LEAST_SHARE { 0.0 } else { s });
        random.weighted(shares.iter().copied()).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::geometry::{Outline, parse_path};
    use vtex_base::raster::ControlMap;
    use vtex_scene::scene::Tile;

    #[test]
    fn a_frame_is_filled_between_its_squares() {
        let outline = Outline::new(&parse_path("M10 10H90V90H10ZM40 40V60H60V40Z").unwrap()).unwrap();
        let controls = Controls { domain: Some(outline), ..Controls::default() };
        let grid = Grid::new([100, 100], Tile::default(), 5);
        let region = PlacementRegion::new(&grid, &controls, Edge::Clip, false);
        let filled = (0..grid.len()).filter(|&i| region.zone(i).is_some()).count();
        assert_eq!((filled, region.areas[0][0]), (6000, 6000.0));
        let at = |x: i32, y: i32| region.zone(grid.index(x + 5, y + 5));
        assert_eq!([at(50, 50), at(9, 50), at(10, 50), at(39, 50)], [None, None, Some(0), Some(0)]);
    }

    #[test]
    fn margins_are_outside_where_textons_keep_off_the_border() {
        let grid = Grid::new([40, 30], Tile { x: true, y: false }, 6);
        let plain = Controls::default();
        assert!(PlacementRegion::new(&grid, &plain, Edge::Clip, false).is_plain());
        let region = PlacementRegion::new(&grid, &plain, Edge::Avoid, false);
        assert_eq!((0..grid.len()).filter(|&i| region.zone(i).is_some()).count(), 40 * 30);
    }

    #[test]
    fn areas_add_up_by_zone_and_library() {
        let map = |values: Vec<f32>| ControlMap::new(2, 1, values).unwrap();
        let controls = Controls {
            density: Some(map(vec![0.0, 2.0])),
            shares: vec![map(vec![1.0, 0.0]), map(vec![0.0, 3.0])],
            ..Controls::default()
        };
        let grid = Grid::new([200, 50], Tile::default(), 10);
        let region = PlacementRegion::new(&grid, &controls, Edge::Clip, false);
        let by_library = |k: usize| region.areas.iter().map(|a| a[k]).sum::<f64>();
        assert!((by_library(0) + by_library(1) - 10_000.0).abs() < 1e-6);
        assert_eq!(region.zone_count(), 17);
        // The left quarter is empty and the part of the first, the right one full and the part of the second.
        assert!((region.areas[0][0] - 2500.0).abs() < 200.0 && region.areas[0][1] < 60.0);
        assert!((region.areas[16][1] - 2500.0).abs() < 200.0 && region.areas[16][0] < 60.0);
        let cell = |x: i32| grid.index(x + 10, 30);
        assert!(region.admits(cell(20), 0) && !region.admits(cell(20), 1) && region.admits(cell(180), 1));
        assert!(region.admits(cell(100), 0) && region.admits(cell(100), 1));
        let mut random = vtex_base::sampling::stream(1, "region test", 0);
        assert!((0..50).all(|_| region.draw_library([10.0, 5.0], &mut random) == 0));
        let second = (0..400).filter(|_| region.draw_library([100.0, 5.0], &mut random) == 1).count();
        assert!((230..370).contains(&second), "{second}");
    }
}
