//! Ground of the canvas whose source in the exemplar lies below a primary that was not placed.
//!
//! Secondaries come along the correspondence field with their islands. What the exemplar hides below a primary has
//! none. Where such a primary is cut at the border of an island and left out, or is of a category that is not placed, the
//! ground would stay bare.

use crate::arrange::correspondence::Correspondence;
use crate::arrange::occupancy::Occupancy;
use vtex_base::parallel;
use vtex_base::raster::LabelMap;
use vtex_scene::library::Library;

/// The vacated cells of a canvas, in cells of the correspondence field.
pub(super) struct VacatedGround {
    cell: i32,
    columns: i32,
    rows: i32,
    /// The library of each vacated cell.
    libraries: Vec<Option<usize>>,
}

impl VacatedGround {
    /// Finds the ground that primaries have left. Narrow strips beside placed ones do not count.
    pub(super) fn new(libraries: &[Library], map: &Occupancy<'_>, correspondence: &Correspondence) -> Self {
        let left_out: Vec<Option<LabelMap>> =
            libraries.iter().map(|library| library.arrangement.vacated_labels()).collect();
        let cell = correspondence.cell();
        let [columns, rows] = map.grid.canvas().map(|side| (side as u32).div_ceil(cell as u32) as i32);
        let mut bare = vec![None; (columns * rows) as usize];
        parallel::for_chunks(&mut bare, columns as usize, |y, row| {
            for (x, library) in row.iter_mut().enumerate() {
                *library = bare_library(map, correspondence, &left_out, [x as i32 * cell, y as i32 * cell]);
            }
        });
        let around = |i: usize| {
            let [x, y] = [i as i32 % columns, i as i32 / columns];
            let near = (y - 1..=y + 1).flat_map(move |v| (x - 1..=x + 1).map(move |u| [u, v]));
            near.filter(|&[u, v]| (0..columns).contains(&u) && (0..rows).contains(&v))
        };
        let bare_at = |[u, v]: [i32; 2]| bare[(v * columns + u) as usize].is_some();
        let is_inner = |i: usize| around(i).all(bare_at);
        let inner: Vec<bool> = (0..bare.len()).map(is_inner).collect();
        let is_vacated = |i: usize| around(i).any(|[u, v]| inner[(v * columns + u) as usize]);
        let libraries = (0..bare.len()).map(|i| bare[i].filter(|_| is_vacated(i))).collect();
        Self { cell, columns, rows, libraries }
    }

    /// Whether no ground was vacated.
    pub(super) fn is_empty(&self) -> bool {
        self.libraries.iter().all(Option::is_none)
    }

    /// Whether a place of the canvas is ground vacated by a primary of a library.
    pub(super) fn holds(&self, at: [i32; 2], library: usize) -> bool {
        let [x, y] = at.map(|v| v.div_euclid(self.cell));
        let is_on_canvas = (0..self.columns).contains(&x) && (0..self.rows).contains(&y);
        is_on_canvas && self.libraries[(y * self.columns + x) as usize] == Some(library)
    }

    /// Whether such a place is within `reach` pixels along both axes.
    pub(super) fn is_near(&self, at: [i32; 2], reach: i32, library: usize) -> bool {
        let range = |v: i32, count: i32| {
            (v - reach).div_euclid(self.cell).max(0)..(v + reach).div_euclid(self.cell).min(count - 1) + 1
        };
        let (columns, mut rows) = (range(at[0], self.columns), range(at[1], self.rows));
        rows.any(|y| {
            columns.clone().any(|x| self.libraries[(y * self.columns + x) as usize] == Some(library))
        })
    }
}

/// The library of a cell, given by its corner, that shows no primary but comes from one.
fn bare_library(
    map: &Occupancy<'_>,
    correspondence: &Correspondence,
    left_out: &[Option<LabelMap>],
    corner: [i32; 2],
) -> Option<usize> {
    let cell = correspondence.cell();
    let middle = corner.map(|v| f64::from(v + cell / 2));
    let (library, place) = correspondence.origin(map.model(), middle);
    let is_covered = |labels: &LabelMap| labels.at(place[0] as i64, place[1] as i64).is_some_and(|l| l != 0);
    let comes_from_primary =
        is_covered(&correspondence.labels()[library]) || left_out[library].as_ref().is_some_and(is_covered);
    let is_free = |[x, y]: [i32; 2]| {
        let at = [corner[0] + x + map.grid.margin[0], corner[1] + y + map.grid.margin[1]];
        map.inside(at) && map.grid.cell(at).is_some_and(|i| !map.taken(i))
    };
    let half = cell / 2;
    let is_bare = comes_from_primary && [[0, 0], [half, half], [cell - 1, cell - 1]].into_iter().all(is_free);
    is_bare.then_some(library)
}
