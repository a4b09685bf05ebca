//! Pixels → shapes: outlines and colours of primaries, details and secondaries.
//!
//! All pieces except specks share one planar map, so each border is fitted once. The details of a
//! primary are painted from the largest to the smallest. Each extends a little underneath those
//! painted after it. The largest is the base, painted with the primary's whole outline.

use super::edges::Edges;
use super::grid::{Cells, SubpixelGrid, to_four_digits};
use super::ground::GroundSpot;
use super::joining;
use super::painted::PaintedPicture;
use super::palette::Palette;
use super::partition::{ElementShapes, Partition};
use super::patches::{FlatPatch, median};
use super::pursuit::Shade;
use super::rate_distortion::RateDistortion;
use super::rims::{self, RIM_BYTES};
use std::collections::{BTreeMap, BTreeSet};
use vtex_base::geometry::{Affine, FittedMap, Outline, PlanarMap, Scale};
use vtex_base::parallel;
use vtex_base::raster::colour::Colour;
use vtex_base::raster::{LabelMap, Mask, Span};
use vtex_scene::library::{CategoryId, ExemplarElement, Shape};

/// Largest secondary that is traced on its own, in cells. Such specks have only the shape of their
/// cells, so equal ones have identical outlines and are stored once. Larger ones are often parts of
/// stems and rims; traced separately they would look like beads.
const SPECK: u32 = 5;

/// Distance that a detail extends underneath later details of its primary, in pixels.
const UNDERLAP: f64 = 0.6;
/// Distance that a secondary extends into its neighbours, in pixels. It prevents hairlines of
/// background between adjacent secondaries.
const SIDE_UNDERLAP: f64 = 0.15;

/// All pieces of an exemplar, disjoint.
pub(super) struct ExemplarPieces {
    /// The details of each primary, which tile it.
    pub(super) details: Vec<Vec<Cells<Mask>>>,
    /// The soft ellipses on them.
    pub(super) shades: Vec<Vec<Shade>>,
    /// The secondaries with outlines.
    pub(super) secondaries: Vec<FlatPatch>,
    /// The soft ones, below them.
    pub(super) spots: Vec<GroundSpot>,
    /// The cost that a piece must save.
    pub(super) cost: RateDistortion,
    /// What is painted with all of these. `None` if borders are crisp, whatever the photograph shows.
    pub(super) painted: Option<PaintedPicture>,
    /// The colours of all pieces, if these are limited.
    pub(super) palette: Palette,
}

/// Traces and fits all outlines. Colours are taken from the cells of the partition, edges from its photograph.
pub(super) fn outlines(partition: &Partition<'_>, pieces: &ExemplarPieces) -> ElementShapes {
    let (grid, image) = (partition.grid, &partition.clean);
    let (width, height) = image.dimensions();
    let mut map = LabelMap::filled(width, height, 0);
    // Labels of one primary form a group; every secondary is a group of its own.
    let mut groups = vec![0u32];
    // The details of each primary, with the label of the first.
    let mut ordered: Vec<(usize, Vec<&Cells<Mask>>)> = Vec::new();
    for (k, details) in pieces.details.iter().enumerate() {
        let mut details: Vec<&Cells<Mask>> = details.iter().collect();
        details.sort_by_key(|m| std::cmp::Reverse(m.area()));
        let first = groups.len();
        for mask in &details {
            map.fill(mask, groups.len() as u32);
            groups.push(k as u32 + 1);
        }
        ordered.push((first, details));
    }
    let first_secondary = groups.len();
    let primary_count = pieces.details.len();
    for (k, patch) in pieces.secondaries.iter().enumerate() {
        map.fill(&patch.mask, groups.len() as u32);
        groups.push((primary_count + k) as u32 + 1);
    }
    let all: Vec<&Cells<Mask>> = ordered.iter().flat_map(|(_, details)| details).copied().collect();
    let (planar, medians) = parallel::join(
        || PlanarMap::trace(width, height, &map.labels),
        || parallel::map(&all, |m| median(image, m)),
    );
    let of_patches = pieces.secondaries.iter().map(|p| p.colour);
    let colours = [None].into_iter().chain(medians.iter().copied().chain(of_patches).map(Some)).collect();
    let group = |label: u32| groups.get(label as usize).copied().unwrap_or(0);
    let (count, group_count) = (groups.len() - 1, primary_count + pieces.secondaries.len());
    drop(map);
    let edges = Edges::new(&partition.image, colours);
    let scale = Scale { tolerance: partition.params.fidelity, cells: grid.along() };
    let fitted = FittedMap::with_edges(planar, scale, count, group_count, group, |at, normal, l, r| {
        edges.distance(at, normal, l, r)
    });
    let is_detail = |label: u32| (label as usize) < first_secondary;
    let whole = fitted.outlines(primary_count, |label| if is_detail(label) { group(label) } else { 0 });
    let stacked = |own: u32| {
        fitted.stacked_outline(own, |other| match (is_detail(own), group(own) == group(other)) {
            (true, true) if own < other => UNDERLAP,
            // Both pieces extend, so the joint is covered whichever is painted first.
            (false, _) if own < other || is_detail(other) => SIDE_UNDERLAP,
            _ => 0.0,
        })
    };
    // Errors are sums over pixels.
    let least_of_rim = pieces.cost.error_per_byte / grid.area() * RIM_BYTES;
    let whole = &whole[1..=primary_count];
    let rims = match &pieces.painted {
        Some(painted) => rims::rims(&partition.image, &partition.labels, painted, whole, least_of_rim),
        None => vec![None; primary_count],
    };
    let parts: Vec<_> = ordered.iter().zip(&pieces.shades).zip(whole.iter().zip(rims)).collect();
    let primaries = parallel::map(&parts, |(((first, details), shades), (outline, rim))| {
        let mask = Cells(Mask::from_spans(details.iter().flat_map(|m| m.spans()).copied().collect()));
        let colours: Vec<Colour> =
            medians[first - 1..].iter().take(details.len()).map(|&m| pieces.palette.nearest(m)).collect();
        let base = colours.first().copied().unwrap_or_default();
        let gradients: Vec<_> =
            details.iter().map(|m| joining::gradient(image, m, pieces.cost, grid).map(Box::new)).collect();
        let base_gradient = gradients.first().cloned().flatten();
        let compactness = to_four_digits(outline.compactness());
        let base_shape = Shape { gradient: base_gradient.clone(), ..Shape::new((*outline).clone(), base) };
        let mut painted = vec![Shape { rim: rim.map(Box::new), ..base_shape }];
        for (i, &colour) in colours.iter().enumerate().skip(1) {
            if colour == base && gradients[i].is_none() && base_gradient.is_none() {
                continue;
            }
            let outline = stacked((first + i) as u32);
            if !outline.is_empty() {
                painted.push(Shape { gradient: gradients[i].clone(), ..Shape::new(outline, colour) });
            }
        }
        painted.extend(shades.iter().filter_map(|s| Shape::of_ellipse(s.ellipse, s.colour)));
        ExemplarElement {
            category: Some(CategoryId(0)),
            colour: median(image, &mask),
            difference: None,
            area: grid.pixel_area(&mask),
            centroid: grid.centroid(&mask),
            compactness: Some(compactness),
            clipped: false,
            silhouette: None,
            shapes: painted,
        }
    });
    let specks = Specks::new(&pieces.secondaries, grid);
    let labelled: Vec<(usize, &FlatPatch)> = (first_secondary..).zip(&pieces.secondaries).collect();
    let secondaries = parallel::map(&labelled, |&(label, FlatPatch { mask, colour, difference })| {
        let outline = specks.outline(mask).unwrap_or_else(|| stacked(label as u32));
        let colour = pieces.palette.nearest(*colour);
        ExemplarElement {
            category: None,
            colour,
            difference: Some(*difference),
            area: grid.pixel_area(mask),
            centroid: grid.centroid(mask),
            compactness: None,
            clipped: false,
            silhouette: None,
            shapes: vec![Shape::new(outline, colour)],
        }
    });
    let spots = pieces.spots.iter().filter_map(GroundSpot::element);
    let outlined = secondaries.into_iter().filter(|s| !s.outline().is_empty());
    ElementShapes { secondaries: spots.chain(outlined).collect(), primaries }
}

/// The outlines of specks. Those of the same cells differ by whole pixels only and are traced once.
struct Specks {
    grid: SubpixelGrid,
    outlines: BTreeMap<Vec<Span>, Outline>,
}

impl Specks {
    fn new(patches: &[FlatPatch], grid: SubpixelGrid) -> Self {
        let specks = patches.iter().filter_map(|patch| Some(Self::at_origin(&patch.mask, grid)?.0));
        let distinct: BTreeSet<Vec<Span>> = specks.map(|mask| mask.spans().to_vec()).collect();
        let distinct: Vec<Vec<Span>> = distinct.into_iter().collect();
        let outlines = parallel::map(&distinct, |spans| alone(&Cells(Mask::from_spans(spans.clone())), grid));
        Self { grid, outlines: distinct.into_iter().zip(outlines).collect() }
    }

    /// A speck moved to the first pixel, and by how many pixels; `None` for larger masks.
    fn at_origin(mask: &Mask, grid: SubpixelGrid) -> Option<(Mask, [i32; 2])> {
        let (x0, y0, ..) = mask.bounds().filter(|_| mask.area() <= SPECK)?;
        let cells = grid.along() as i32;
        let pixels = [x0, y0].map(|v| v.div_euclid(cells));
        Some((mask.shifted(-pixels[0] * cells, -pixels[1] * cells), pixels))
    }

    /// The outline of a mask that is a speck.
    fn outline(&self, mask: &Mask) -> Option<Outline> {
        let (mask, pixels) = Self::at_origin(mask, self.grid)?;
        let to = Affine::translate((f64::from(pixels[0]), f64::from(pixels[1])));
        Some(Outline::new(&(to * self.outlines.get(mask.spans())?.path())).unwrap_or_default())
    }
}

/// The outline of a mask traced on its own, scaled to the mask's area.
fn alone(mask: &Cells<Mask>, grid: SubpixelGrid) -> Outline {
    let Some((x0, y0, x1, y1)) = mask.bounds() else { return Outline::default() };
    let mut map = LabelMap::filled((x1 - x0 + 2) as u32, (y1 - y0 + 2) as u32, 0);
    let corner = (1 - x0, 1 - y0);
    map.fill(&mask.shifted(corner.0, corner.1), 1);
    let planar = PlanarMap::trace(map.width, map.height, &map.labels);
    let scale = Scale { tolerance: 0.5, cells: grid.along() };
    let fitted = FittedMap::with_edges(planar, scale, 1, 1, |l| l, |_, _, _, _| 0.0);
    let outline = fitted.outlines(1, |l| l).swap_remove(1);
    // Rounding the corners of a few pixels removes much of their area, and contrast with it.
    let grow = libm::sqrt(f64::from(mask.area()) / grid.area() / outline.area().max(0.1)).min(1.4);
    let [cx, cy] = grid.centroid(mask);
    let about = Affine::translate((cx, cy)) * Affine::scale(grow) * Affine::translate((-cx, -cy));
    let back = Affine::translate((-f64::from(corner.0) / grid.along(), -f64::from(corner.1) / grid.along()));
    Outline::new(&(about * back * outline.path())).unwrap_or_default()
}
