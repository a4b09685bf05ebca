//! Measures of the arrangement of primaries: overlap, repetition, and pair correlation of the centres of
//! categories.
//!
//! They work on plain data, so an exemplar and any scene are measured in the same way. On a canvas that
//! tiles, an instance stands for all its copies.
//!
//! Works badly for scenes in a domain, with a map of densities or of several libraries: [`PairCorrelations`]
//! assumes that the canvas is evenly filled.

mod correlation;
mod cycle;
mod groups;
mod overlap;
mod repetition;

pub use correlation::{CorrelationCurve, Difference, PairCorrelations, largest_categories};
pub use cycle::Cycle;
pub use groups::Groups;
pub use overlap::Overlap;
pub use repetition::{CopyDistances, Repetition};

use crate::element::{CategoryId, ElementId};
use crate::library::{ExemplarElement, Library};
use crate::scene::{LibraryId, Scene, Tile};

/// A placed primary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centre {
    /// Its library.
    pub library: LibraryId,
    /// Its index among the primaries of its library.
    pub source: ElementId,
    /// Its category there.
    pub category: CategoryId,
    /// Its centre, in pixels.
    pub at: [f64; 2],
}

/// The places of primaries in a rectangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Width and height of the rectangle, in pixels.
    pub size: [f64; 2],
    /// Along which axes it repeats.
    pub tile: Tile,
    /// The primaries; some may have their centre outside.
    pub centres: Vec<Centre>,
}

impl Layout {
    /// The exemplar's own arrangement, as library 0. Unless the exemplar tiles, a strip as wide as the mean
    /// radius of its primaries is left out all around: of primaries cut by the border, only the centre of the
    /// visible part is known.
    pub fn of_library(library: &Library) -> Self {
        let all = Self::whole(library);
        if all.tile.both() || library.primaries().is_empty() {
            return all;
        }
        let area: f64 = library.primaries().iter().map(|p| f64::from(p.area)).sum();
        let radius = libm::sqrt(area / library.primaries().len() as f64 / std::f64::consts::PI)
            / library.pixels_per_unit();
        let size = all.size;
        let strip = radius.min(size[0] / 4.0).min(size[1] / 4.0);
        all.window([strip; 2], size.map(|s| s - strip))
    }

    /// The exemplar's own arrangement, as library 0, up to its borders.
    pub fn whole(library: &Library) -> Self {
        let size = library.page();
        let wrap = library.arrangement.periodic;
        let centre = |(i, p): (usize, &ExemplarElement)| Centre {
            library: LibraryId(0),
            source: ElementId::after(i),
            category: p.category.unwrap_or_default(),
            at: p.centroid,
        };
        let centres: Vec<Centre> = library.primaries().iter().enumerate().map(centre).collect();
        Self { size, tile: Tile { x: wrap, y: wrap }, centres }
    }

    /// The primaries of a scene, which must have been validated.
    pub fn of_scene(scene: &Scene) -> Self {
        let centre = |i: &crate::scene::Instance| {
            let element = scene.element(i);
            Centre {
                library: element.library,
                source: element.source.unwrap_or_default(),
                category: element.category.unwrap_or_default(),
                at: [i.transform[4], i.transform[5]],
            }
        };
        Self {
            size: [scene.width, scene.height].map(f64::from),
            tile: scene.tile,
            centres: scene.individuals().map(centre).collect(),
        }
    }

    /// The primaries with their centre between two corners; the part does not repeat.
    pub fn window(&self, from: [f64; 2], to: [f64; 2]) -> Self {
        let inside = |c: &&Centre| (0..2).all(|k| c.at[k] >= from[k] && c.at[k] < to[k]);
        let moved = |c: &Centre| Centre { at: [c.at[0] - from[0], c.at[1] - from[1]], ..*c };
        Self {
            size: [to[0] - from[0], to[1] - from[1]],
            tile: Tile::default(),
            centres: self.centres.iter().filter(inside).map(moved).collect(),
        }
    }

    /// The size along the axes that repeat.
    fn period(&self) -> [Option<f64>; 2] {
        self.tile.periods(self.size)
    }
}

/// Mean distance between neighbouring primaries of an exemplar, in pixels. The reach of descriptors is a
/// multiple of it.
pub fn neighbour_distance(library: &Library) -> f64 {
    let pixels = f64::from(library.descriptor_half) / library.source.parameters.descriptor_reach;
    pixels.max(1.0) / library.pixels_per_unit()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::testing::{library, mosaic};

    #[test]
    fn the_strip_along_the_border_is_left_out_unless_the_exemplar_tiles() {
        let mut library = library(&mosaic(200, 15.0, 0.8, 1));
        let layout = Layout::of_library(&library);
        assert!(layout.size[0] < 192.0 && layout.size[0] > 180.0, "{:?}", layout.size);
        assert!(layout.centres.len() < library.primaries().len());
        assert!(layout.centres.iter().all(|c| (0..2).all(|k| (0.0..layout.size[k]).contains(&c.at[k]))));
        library.arrangement.periodic = true;
        let layout = Layout::of_library(&library);
        assert_eq!((layout.size, layout.centres.len()), ([200.0; 2], library.primaries().len()));
    }
}
