//! Layers below the primaries: secondaries and the background's control points, moved with the warp.

use super::carried;
use super::{Bend, NO_STRETCH};
use crate::arrange::Plan;
use crate::arrange::correspondence::SecondaryPlace;
use crate::arrange::occupancy::Occupancy;
use crate::arrange::sites::Sites;
use crate::synth::background;
use crate::synth::secondaries::{self, CELL, PlacedSecondary, SecondaryFinder};
use std::collections::BTreeMap;
use vtex_base::sampling::{Area, Stream, poisson_disk, stream};
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{ControlPoint, Field, Instance, Role, Scene, Tile, joined};

/// Moved points closer to each other than the first share of their usual distance are dropped. New points
/// are added where the nearest is farther than the second share.
const CROWDED: f64 = 0.6;
const SPARSE: f64 = 0.9;
/// The first share for control points, of which fewer suffice.
const CROWDED_POINTS: f64 = 0.8;
/// Width of the margin of control points around the canvas, in spacings.
const MARGIN: f64 = 2.0;

/// A secondary of the result.
pub(super) enum WarpedSecondary<'s> {
    /// An instance of the scene at its new place.
    Carried { instance: &'s Instance, place: [f64; 2] },
    /// A new one that fills a gap.
    New(PlacedSecondary),
}

/// The scene's control points at their new places, and new ones in the gaps.
pub(super) fn field(scene: &Scene, plan: &Plan<'_>, map: &Occupancy<'_>, bend: &Bend) -> Field {
    let palettes = background::palettes(&plan.libraries);
    let fields = scene.layers.iter().filter_map(|l| Some((l.region.as_ref(), l.field.as_ref()?)));
    let old = joined(&fields.collect::<Vec<_>>());
    let old = old.as_deref().unwrap_or(&palettes[0]);
    let spacing = old.spacing;
    let mut field = Field { points: Vec::new(), ..old.clone() };
    let held: Vec<&ControlPoint> = old.points.iter().filter(|p| bend.holds([p.x, p.y])).collect();
    let places: Vec<[f64; 2]> = held.iter().map(|p| bend.point([p.x, p.y])).collect();
    for i in spaced(&places, CROWDED_POINTS * spacing) {
        let [x, y] = places[i].map(|v| libm::round(v * 100.0) / 100.0);
        field.points.push(ControlPoint { x, y, colour: held[i].colour });
    }
    let stretched = held.iter().any(|p| bend.stretch([p.x, p.y]) > NO_STRETCH);
    if !stretched {
        return field;
    }
    let carried: Vec<[i32; 2]> = field.points.iter().map(|p| whole([p.x, p.y])).collect();
    let canvas = map.grid.canvas();
    let near = Sites::new(carried, spacing, canvas, Tile::default());
    let mut random = stream(plan.params.seed, "synth/warp/background", 0);
    for point in scattered(canvas, MARGIN * spacing, spacing, &mut random) {
        if !near.any_within(whole(point), SPARSE * spacing) {
            let [x, y] = point.map(|v| libm::round(v * 100.0) / 100.0);
            let colour = background::colour(&palettes, &map.region, [x, y], &mut random);
            field.points.push(ControlPoint { x, y, colour });
        }
    }
    field
}

/// The scene's secondaries, in small neighbourhoods that move as one where there is room. Neighbourhoods of
/// the exemplar and single secondaries fill the gaps.
pub(super) fn secondaries<'s>(
    scene: &'s Scene,
    plan: &Plan<'_>,
    map: &Occupancy<'_>,
    interpolant: &Interpolant,
    bend: &Bend,
) -> Vec<WarpedSecondary<'s>> {
    let (libraries, params) = (&*plan.libraries, &plan.params);
    let finders: Vec<Option<SecondaryFinder<'_, '_>>> = libraries
        .iter()
        .enumerate()
        .map(|(k, library)| SecondaryFinder::new(k, library, map, params))
        .collect();
    let reaches = finders.iter().flatten().map(|f| CELL * f.radius());
    let reach = reaches.fold(f64::INFINITY, f64::min);
    if !reach.is_finite() {
        return Vec::new();
    }
    let mut random = stream(params.seed, "synth/warp/secondaries", 0);
    // Centres of neighbourhoods before and after the warp.
    let old_canvas = [scene.width, scene.height].map(f64::from);
    let centres = scattered(old_canvas, reach, reach, &mut random);
    let bent: Vec<[f64; 2]> = centres.iter().map(|&c| bend.point(c)).collect();
    let kept = spaced(&bent, CROWDED * reach);
    let before: Vec<[i32; 2]> = kept.iter().map(|&i| whole(centres[i])).collect();
    let mut after: Vec<[i32; 2]> = kept.iter().map(|&i| whole(bent[i])).collect();
    let carried_cells = after.len();
    let canvas = map.grid.canvas();
    let near = Sites::new(after.clone(), reach, canvas, Tile::default());
    let new = scattered(canvas, reach, reach, &mut random).into_iter().map(whole);
    after.extend(new.filter(|&c| !near.any_within(c, SPARSE * reach)));
    let from = Sites::new(before.clone(), reach, old_canvas, Tile::default());
    let to = Sites::new(after.clone(), reach, canvas, Tile::default());

    let mut found: Vec<(WarpedSecondary<'s>, PlacedSecondary)> = Vec::new();
    let mut standing: Vec<Vec<[i32; 2]>> = vec![Vec::new(); libraries.len()];
    for instance in scene.of_role(Role::Secondary) {
        let element = scene.element(instance);
        let [.., x, y] = instance.transform;
        let Some(cell) = from.owner(whole([x, y])) else { continue };
        let centre = before[cell];
        let [dx, dy] = [0, 1].map(|k| [x, y][k] - f64::from(centre[k]));
        let place = [f64::from(after[cell][0]) + dx, f64::from(after[cell][1]) + dy];
        let library = element.library.index();
        let first = libraries[library].primaries().len();
        let Some(number) = element.source.and_then(|s| s.index().checked_sub(first)) else { continue };
        let variation = carried::variation(map.model(), instance);
        let placed = PlacedSecondary {
            library,
            place: SecondaryPlace { secondary: number as u32, at: whole(place), variation },
            colour: instance.colour.unwrap_or(element.base().colour),
        };
        let seen = finders[library].as_ref().is_some_and(|f| f.is_visible(&placed.place));
        if bend.holds([x, y]) && to.owner(placed.place.at) == Some(cell) && seen {
            standing[library].push(placed.place.at);
            found.push((WarpedSecondary::Carried { instance, place }, placed));
        }
    }
    let mut fresh = Vec::new();
    for cell in carried_cells..after.len() {
        let library = map.region.draw_library(after[cell].map(f64::from), &mut random);
        if let Some(finder) = &finders[library] {
            let own = to.cell(cell);
            let found = finder.neighbourhood(after[cell], |at| own.owns(at), &mut random);
            standing[library].extend(found.iter().map(|p| p.place.at));
            fresh.extend(found);
        }
    }
    for (library, finder) in finders.iter().enumerate() {
        if let Some(finder) = finder {
            fresh.extend(finder.fill_gaps(std::mem::take(&mut standing[library])));
        }
    }
    let painted = secondaries::painted(plan, fresh, interpolant);
    found.extend(painted.into_iter().map(|p| (WarpedSecondary::New(p), p)));
    found.sort_by_key(|(_, placed)| placed.painting_key(plan));
    found.into_iter().map(|f| f.0).collect()
}

/// A point rounded to whole pixels.
fn whole(point: [f64; 2]) -> [i32; 2] {
    point.map(|v| libm::round(v) as i32)
}

/// Points of a Poisson-disk set over a canvas and a margin around it.
fn scattered(canvas: [f64; 2], margin: f64, radius: f64, random: &mut Stream) -> Vec<[f64; 2]> {
    let area = Area::plane(canvas[0] + 2.0 * margin, canvas[1] + 2.0 * margin);
    poisson_disk(area, radius, random).into_iter().map(|p| p.map(|v| v - margin)).collect()
}

/// Indices of points that are at least `distance` apart. A point is dropped if it is too near an earlier
/// one that is kept.
fn spaced(points: &[[f64; 2]], distance: f64) -> Vec<usize> {
    let mut cells: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    let mut kept = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let [x, y] = p.map(|v| libm::floor(v / distance) as i64);
        let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        let close = |&k: &usize| {
            let [dx, dy] = [0, 1].map(|c| points[k][c] - p[c]);
            dx * dx + dy * dy < distance * distance
        };
        if !near.filter_map(|cell| cells.get(&cell)).flatten().any(close) {
            cells.entry([x, y]).or_default().push(i);
            kept.push(i);
        }
    }
    kept
}
