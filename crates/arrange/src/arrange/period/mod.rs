//! Placement by the period of a drawing: the exemplar's own period repeated, its elements exchanged
//! and moved.
//!
//! A regular or interlocking drawing is repeated exactly. In a loose one, elements that touch no other are free
//! to move: they walk at random, move apart until they are spread as evenly as in the drawing, and exchange
//! places with others of similar size. No two come nearer to each other than elements of the drawing. Similar
//! elements are kept apart. The number of elements stays, and the area by category nearly so: elements at the border
//! of the canvas hardly move. Elements that are equal up to rotation, reflection and size are one element of the
//! scene. Motifs take part as wholes; then their parts move as far as the drawing's own copies of the motif differ.
//!
//! Where nothing has room to move, elements of one shape in several colours change places ([`alike`]).
//!
//! Works badly for other packed drawings: they are repeated exactly. [`Repeated::repeating`] is then 1.

mod alike;
mod canvas;
mod exchange;
mod order;
mod parts;
mod relations;
mod spread;
#[cfg(test)]
mod tests;

use crate::arrange::motifs::{DrawnElement, MotifUnits, PaintingOrder};
use alike::AlikeShapes;
use canvas::{MOST_PIXELS, OccupiedCanvas};
use parts::TakenApart;
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::{Affine, Rect, Vec2};
use vtex_base::progress::{Progress, advance};
use vtex_scene::element::SimilarTo;
use vtex_scene::library::Library;
use vtex_scene::scene::SynthParams;

use relations::ElementRelations;
use std::collections::BTreeMap;

/// Places that differ by at most this are the same, in pixels.
const SAME: f64 = 2.0;

/// The result of placement.
pub(crate) struct Repeated {
    /// All elements on the canvas, and those beside it that change places with them.
    pub(crate) placed: Vec<DrawnElement>,
    /// The class of equal elements that each element of the library belongs to.
    pub(crate) equal: Vec<SimilarTo>,
    /// Bounds of each element of the library, in the exemplar.
    pub(crate) bounds: Vec<Rect>,
    /// Share of the canvas that each category covers.
    pub(crate) covered: Vec<f64>,
    /// Share of the free elements that were moved, 0 to 1.
    pub(crate) variation: f64,
    /// Share of the places whose element also occurs one period before, along either axis.
    pub(crate) repeating: Option<f64>,
}

/// Repeats the period of a library on a canvas.
///
/// # Errors
/// [`Error::TooLarge`] for too many copies; [`Error::Interrupted`].
pub(crate) fn place(library: &Library, params: &SynthParams, progress: &dyn Progress) -> Result<Repeated> {
    place_within(library, params, MOST_PIXELS, progress)
}

/// [`place`]; on a canvas of more than `most` pixels no element moves.
fn place_within(
    library: &Library,
    params: &SynthParams,
    most: u64,
    progress: &dyn Progress,
) -> Result<Repeated> {
    check_copies(library, params)?;
    let go_on = || advance(progress, "primaries", 0, 2);
    go_on()?;
    // Motifs are placed as wholes and then taken apart.
    let units = MotifUnits::new(library);
    let drawing = units.as_ref().map_or(library, |u| &u.library);
    let mut relations = ElementRelations::new(drawing, &go_on)?;
    if let Some(units) = &units {
        relations.follow(units);
    }
    let alike = AlikeShapes::new(drawing, &relations);
    if relations.regular && !alike.is_empty() {
        // Whatever else moved would be seen to.
        relations.free.fill(false);
    }
    let is_kept = relations.regular && alike.is_empty();
    let mut variation = params.variation.unwrap_or(if is_kept { 0.0 } else { 1.0 });
    let mut placed = repeated(drawing, params, &relations);
    // On a canvas too large for the map, coverage is taken from the exemplar.
    let mut covered = None;
    let go_on = || advance(progress, "primaries", 1, 2);
    if let Some(mut canvas) = OccupiedCanvas::new(drawing, params, &relations, most) {
        if variation > 0.0 {
            alike.exchange(&mut placed, |p| canvas.zone(p), (variation, params.seed));
            canvas.write_all(&placed, go_on)?;
            go_on()?;
            canvas.vary(&mut placed, variation, params.seed, go_on)?;
        }
        if units.is_none() {
            covered = Some(canvas.covered(&placed, go_on)?);
        }
    } else if variation > 0.0 {
        variation = 0.0;
        progress
            .warn("the texture is too large for elements to change places: the drawing is repeated as it is");
    }
    if let Some(units) = &units {
        relations = ElementRelations::new(library, &go_on)?;
        let mut apart = TakenApart::new(units, &placed);
        if let Some(mut canvas) = OccupiedCanvas::new(library, params, &relations, most) {
            if variation > 0.0 {
                canvas.write_all(&apart.placed, go_on)?;
                apart.vary(&mut canvas, units, variation, params.seed, go_on)?;
            }
            covered = Some(canvas.covered(&apart.placed, go_on)?);
        }
        placed = apart.placed;
    }
    advance(progress, "primaries", 2, 2)?;
    let covered = covered.unwrap_or_else(|| library.categories.iter().map(|c| c.coverage).collect());
    let repeating = repeating(library, params, &placed, &relations);
    let ElementRelations { equal, bounds, .. } = relations;
    Ok(Repeated { placed, equal, bounds, covered, variation, repeating })
}

fn size_of(library: &Library) -> [f64; 2] {
    [library.source.width, library.source.height].map(f64::from)
}

/// Refuses a canvas that is to repeat along an axis and is not, when rounded to pixels, a whole number of periods of a page
/// long there.
///
/// # Errors
/// [`Error::DrawingPeriods`].
pub(crate) fn check_periods([w, h]: [f64; 2], params: &SynthParams) -> Result<()> {
    let whole = |size: u32, period: f64| {
        let count = libm::round(f64::from(size) / period).max(1.0);
        libm::round(count * period) as u32
    };
    let near = |tile: bool, size: u32, period: f64| if tile { whole(size, period) } else { size };
    let [width, height] = [near(params.tile.x, params.width, w), near(params.tile.y, params.height, h)];
    if [width, height] == [params.width, params.height] {
        return Ok(());
    }
    let period = [w, h].map(|v| libm::round(v * 100.0) / 100.0);
    Err(Error::DrawingPeriods { size: [params.width, params.height], period, near: [width, height] })
}

/// Most copies of elements on a canvas, and most pixels that all of them together may cover.
const MOST_COPIES: f64 = 4e6;
const MOST_PAINTED: f64 = 1e10;

/// Refuses a canvas of too many copies.
fn check_copies(library: &Library, params: &SynthParams) -> Result<()> {
    let tile = [params.tile.x, params.tile.y];
    let (copies, painted) = copies(library, [params.width, params.height].map(f64::from), tile);
    if copies <= MOST_COPIES && painted <= MOST_PAINTED {
        return Ok(());
    }
    if self::copies(library, [1.0; 2], [false; 2]).1 > MOST_PAINTED {
        return Err(Error::Control {
            name: library.source.file.clone(),
            role: "a drawing",
            reason: "its elements are so much larger than its page that their copies cover it without end"
                .into(),
            advice: "make its strokes narrower, and leave out what lies far outside the page",
        });
    }
    let (found, limit, unit) = if copies > MOST_COPIES {
        (copies / 1e6, MOST_COPIES / 1e6, "million copies of the drawing's elements")
    } else {
        (painted / 1e6, MOST_PAINTED / 1e6, "megapixels in all copies of the drawing's elements")
    };
    let [found, limit] = [libm::ceil(found), limit].map(|count| format!("{count:.0} {unit}"));
    Err(Error::TooLarge { what: Large::Canvas, name: "size".into(), found, limit })
}

/// Copies of elements on a canvas, and pixels that all of them together may cover.
fn copies(library: &Library, canvas: [f64; 2], tile: [bool; 2]) -> (f64, f64) {
    let period = size_of(library);
    let (mut copies, mut painted) = (0.0, 0.0);
    for instance in library.layers.iter().flat_map(|layer| &layer.instances) {
        let element = &library.elements[instance.element.index()];
        let own = vtex_scene::element::bounds(&element.shapes);
        let bounds = Affine::new(instance.transform).transform_rect_bbox(own);
        let side = [bounds.width(), bounds.height()];
        // Copies beside the canvas are within a period and a half of it.
        let along =
            |k: usize| (canvas[k] + if tile[k] { 0.0 } else { side[k] + 4.0 * period[k] }) / period[k];
        copies += along(0) * along(1);
        // Endless elements are marked all at once.
        if !element.clipped {
            painted += along(0) * along(1) * side[0].max(1.0) * side[1].max(1.0);
        }
    }
    (copies, painted)
}

/// All copies of all elements that reach the canvas or its margin; along axes that repeat, each once.
fn repeated(library: &Library, params: &SynthParams, relations: &ElementRelations) -> Vec<DrawnElement> {
    let period = size_of(library);
    let canvas = [params.width, params.height].map(f64::from);
    let tile = [params.tile.x, params.tile.y];
    let margin = relations.margin;
    let mut placed = Vec::new();
    for (l, layer) in library.layers.iter().enumerate() {
        for (n, instance) in layer.instances.iter().enumerate() {
            let own = Affine::new(instance.transform);
            let b = own.transform_rect_bbox(relations.bounds[instance.element.index()]);
            let range = |k: usize, low: f64, high: f64| {
                if tile[k] {
                    return 0..(canvas[k] / period[k]) as i64;
                }
                let first = libm::ceil((-margin - high) / period[k]) as i64;
                first..libm::floor((canvas[k] + margin - low) / period[k]) as i64 + 1
            };
            for j in range(1, b.y0, b.y1) {
                for i in range(0, b.x0, b.x1) {
                    let shift = Vec2::new(i as f64 * period[0], j as f64 * period[1]);
                    let map = Affine::translate(shift) * own;
                    let order = PaintingOrder { layer: l, instance: n, later: 0 };
                    placed.push(DrawnElement {
                        element: instance.element.index(),
                        map,
                        order: order.of_copy(&library.source, [i as i32, j as i32]),
                        motif: None,
                    });
                }
            }
        }
    }
    placed
}

/// Share of the places whose element also occurs one period before, along either axis.
fn repeating(
    library: &Library,
    params: &SynthParams,
    placed: &[DrawnElement],
    relations: &ElementRelations,
) -> Option<f64> {
    let period = size_of(library);
    let size = [f64::from(params.width), f64::from(params.height)];
    let at = |p: &DrawnElement| {
        let SimilarTo { first, map } = relations.equal[p.element];
        let map = p.map * map;
        (first, map, map * relations.bounds[first].center())
    };
    let all: Vec<_> = placed.iter().map(at).collect();
    let cell = |x: f64, y: f64| [x, y].map(|v| libm::floor(v / (2.0 * SAME)) as i64);
    let mut by_place: BTreeMap<(usize, [i64; 2]), Vec<usize>> = BTreeMap::new();
    for (i, (first, _, centre)) in all.iter().enumerate() {
        by_place.entry((*first, cell(centre.x, centre.y))).or_default().push(i);
    }
    let (mut pairs, mut same) = (0u64, 0u64);
    for (first, map, centre) in &all {
        for axis in 0..2 {
            let mut wanted = [centre.x, centre.y];
            let on_canvas = (0..2).all(|k| (0.0..size[k]).contains(&wanted[k]));
            wanted[axis] -= period[axis];
            if !on_canvas || wanted[axis] < 0.0 {
                continue;
            }
            pairs += 1;
            let turned = |other: &Affine| {
                let (a, b) = (map.as_coeffs(), other.as_coeffs());
                (0..4).all(|k| (a[k] - b[k]).abs() < 0.02)
            };
            let there = |&&i: &&usize| {
                let other = &all[i];
                (other.2.x - wanted[0]).abs() <= SAME
                    && (other.2.y - wanted[1]).abs() <= SAME
                    && turned(&other.1)
            };
            let [cx, cy] = cell(wanted[0], wanted[1]);
            let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| [cx + i, cy + j]));
            let mut near = around.filter_map(|cell| by_place.get(&(*first, cell))).flatten();
            same += u64::from(near.any(|i| there(&i)));
        }
    }
    (pairs > 0).then(|| same as f64 / pairs as f64)
}
