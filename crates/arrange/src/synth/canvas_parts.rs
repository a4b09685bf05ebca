//! Drawings beside other libraries on one canvas: each drawing has its own part of the canvas, and so have
//! all photographs together.
//!
//! Textures of photographs blend where they meet. Flat colours do not blend, and descriptors of photographs
//! do not apply to elements of a drawing. So one texture is made for each drawing and one for all
//! photographs. Each is made for the whole canvas and kept only in its part. Drawings lie below photographs,
//! because elements of a drawing may extend beyond their part.

use super::compose;
use super::report::{CategoryReport, SynthReport};
use super::texture::Texture;
use crate::arrange::Plan;
use crate::arrange::controls::Controls;
use std::borrow::Cow;
use vtex_base::error::Result;
use vtex_base::geometry::{Outline, Point, Rect};
use vtex_base::progress::Progress;
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::Colour;
use vtex_field::layers::{LayerMap, MapLayer};
use vtex_scene::library::{Library, SourceKind};
use vtex_scene::scene::{
    Element, ElementId, Field, Instance, InstanceId, Layer, LibraryId, Role, Scene, SynthParams, joined,
};

/// Distance of the places of an element's box that are tested for a part of the canvas, in pixels.
const PLACE_DISTANCE: f64 = 12.0;
/// Least and largest number of these places along a side.
const PLACES: [usize; 2] = [6, 64];

/// The textures of a canvas that drawings share with other libraries.
pub(super) struct CanvasParts {
    /// The indices of the libraries of each.
    groups: Vec<Vec<usize>>,
    /// The part of each pixel, and the share of the canvas that each has.
    map: LayerMap,
    shares: Vec<f64>,
    /// The parts that are seen, from bottom to top.
    parts: Vec<CanvasPart>,
}

impl CanvasParts {
    /// The parts of a plan's canvas; `None` unless a drawing is among several libraries.
    ///
    /// # Errors
    /// As [`Texture::new`].
    pub(super) fn of(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Option<Self>> {
        let Plan { libraries, controls, params, .. } = plan;
        let applies = libraries.len() > 1 && controls.structure.is_none();
        if !applies || !libraries.iter().any(Library::is_drawing) {
            return Ok(None);
        }
        let groups = groups(libraries);
        let map = parts(&groups, params, controls);
        let (outlines, shares) = (map.outlines([params.tile.x, params.tile.y]), map.shares());
        let is_seen = |g: &usize| shares[*g] > 0.0 && (*g == 0 || !outlines[g - 1].is_empty());
        let part = |number: usize| {
            let group = &groups[number];
            let own = group.iter().map(|&k| libraries[k].clone()).collect();
            let several = group.iter().filter(|_| group.len() > 1);
            let own_shares = several.map(|&k| controls.shares[k].clone()).collect();
            let steered = Cow::Owned(Controls { shares: own_shares, ..Controls::clone(controls) });
            let texture = Texture::new(Cow::Owned(own), params.clone(), steered, None, progress)?;
            let region = number.checked_sub(1).map(|below| outlines[below].clone());
            Ok(CanvasPart { number, region, texture })
        };
        let parts = (0..groups.len()).filter(is_seen).map(part).collect::<Result<_>>()?;
        Ok(Some(Self { groups, map, shares, parts }))
    }

    /// The scene of all parts, and its report.
    ///
    /// # Errors
    /// As [`Texture::scene`].
    pub(super) fn joined(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<(Scene, SynthReport)> {
        let mut whole = JoinedScene { scene: compose::blank(plan, Vec::new()), map: &self.map };
        let mut reports = Vec::new();
        for part in &self.parts {
            let (scene, report) = part.texture.scene(progress)?;
            // A texture that repeats its period exactly may be cut; others keep elements whole.
            let still = scene.parameters.as_ref().is_some_and(|p| p.variation == Some(0.0));
            let is_cut = still && report.period.is_some();
            whole.add(scene, &self.groups[part.number], part, is_cut);
            reports.push((part.number, report));
        }
        let report = self.joined_report(&plan.libraries, &reports, &whole.scene);
        Ok((whole.scene, report))
    }

    /// The report of the whole canvas: shares are averaged over parts by area, counts are added.
    fn joined_report(
        &self,
        libraries: &[Library],
        reports: &[(usize, SynthReport)],
        scene: &Scene,
    ) -> SynthReport {
        let Self { groups, shares, .. } = self;
        let sum = |of: fn(&SynthReport) -> f64| reports.iter().map(|(g, r)| shares[*g] * of(r)).sum::<f64>();
        let count = |of: fn(&SynthReport) -> u64| reports.iter().map(|(_, r)| of(r)).sum::<u64>();
        let none = |l: &Library| vec![CategoryReport::default(); l.categories.len()];
        let mut categories: Vec<Vec<CategoryReport>> = libraries.iter().map(none).collect();
        for (g, report) in reports {
            let own =
                groups[*g].iter().flat_map(|&k| (0..libraries[k].categories.len()).map(move |c| (k, c)));
            for ((k, c), found) in own.zip(&report.categories) {
                let [wanted, got] = [found.wanted, found.got].map(|v| shares[*g] * v);
                categories[k][c] = CategoryReport { wanted, got };
            }
        }
        let last = reports.last().map(|(_, report)| report);
        let report = SynthReport { categories: categories.concat(), ..SynthReport::default() };
        SynthReport {
            coverage_wanted: sum(|r| r.coverage_wanted),
            coverage: sum(|r| r.coverage),
            attempts: count(|r| r.attempts),
            refused: count(|r| r.refused),
            removed: count(|r| r.removed),
            added: count(|r| r.added),
            method: last.map_or_else(Default::default, |r| r.method),
            structure: last.and_then(|r| r.structure),
            ..report.of_scene(libraries, scene)
        }
    }
}

/// The libraries of each texture: one drawing each, then all photographs.
fn groups(libraries: &[Library]) -> Vec<Vec<usize>> {
    let of = |kind: SourceKind| (0..libraries.len()).filter(move |&k| libraries[k].source.kind == kind);
    let mut groups: Vec<Vec<usize>> = of(SourceKind::Drawing).map(|k| vec![k]).collect();
    let photographs: Vec<usize> = of(SourceKind::Photograph).collect();
    if !photographs.is_empty() {
        groups.push(photographs);
    }
    groups
}

/// The group of each pixel of the canvas: the one with the largest share there.
fn parts(groups: &[Vec<usize>], params: &SynthParams, controls: &Controls) -> LayerMap {
    let canvas = [params.width, params.height].map(f64::from);
    let rows: Vec<u32> = (0..params.height).collect();
    let row = |&y: &u32| {
        let label = |x: u32| {
            let at = [x, y].map(|v| f64::from(v) + 0.5);
            let share = |g: usize| groups[g].iter().map(|&k| controls.shares[k].at(at, canvas)).sum::<f64>();
            let largest = (0..groups.len()).max_by(|&a, &b| share(a).total_cmp(&share(b)).then(b.cmp(&a)));
            largest.unwrap_or(0) as u32
        };
        (0..params.width).map(label).collect::<Vec<u32>>()
    };
    let labels = vtex_base::parallel::map(&rows, row).concat();
    let layer = |g: usize| MapLayer { name: g.to_string(), colour: Colour([g as u8; 3]) };
    LayerMap {
        labels: LabelMap { width: params.width, height: params.height, labels },
        layers: (0..groups.len()).map(layer).collect(),
    }
}

/// A part of the canvas.
struct CanvasPart {
    /// Its number in the map of parts.
    number: usize,
    /// Its outline; `None` for the lowest part, which needs none.
    region: Option<Outline>,
    /// Its texture, on the whole canvas.
    texture: Texture<'static>,
}

/// The scene of all parts, and the part of each pixel.
struct JoinedScene<'a> {
    scene: Scene,
    map: &'a LayerMap,
}

impl JoinedScene<'_> {
    /// Adds the elements of a texture within its part, cut at its border or whole; `group` are its libraries.
    fn add(&mut self, scene: Scene, group: &[usize], part: &CanvasPart, is_cut: bool) {
        let CanvasPart { number, region, .. } = part;
        self.scene.tile = scene.tile;
        self.scene.domain = scene.domain.clone();
        self.scene.parameters = scene.parameters.clone();
        let first = self.scene.elements.len();
        let motifs = self.scene.instances().filter_map(|i| i.motif).max().map_or(0, |m| m + 1);
        let own = |e: &Element| Element { library: LibraryId(group[e.library.index()] as u32), ..e.clone() };
        self.scene.elements.extend(scene.elements.iter().map(own));
        let title = self.scene.libraries[group[0]].exemplar.clone();
        let title = title.split('.').next().unwrap_or_default().to_owned();
        let background =
            Layer { field: field(&scene), region: region.clone(), ..Layer::new(Role::Background) };
        let elements = scene.layers.iter().filter(|layer| !layer.instances.is_empty());
        for layer in std::iter::once(&background).chain(elements) {
            let kept = layer.instances.iter().filter(|i| {
                let bounds = i.affine().transform_rect_bbox(scene.element(i).bounds());
                if is_cut {
                    self.reaches(bounds, *number)
                } else {
                    self.part_at(bounds.center()) == *number as u32
                }
            });
            let mut next = self.scene.count() as u32;
            let renumbered = |i: &Instance| {
                next += 1;
                let element = ElementId::after(first + i.element.index());
                let motif = i.motif.map(|m| m + motifs);
                Instance { id: InstanceId(next - 1), element, motif, ..i.clone() }
            };
            let instances: Vec<Instance> = kept.map(renumbered).collect();
            let clip = if is_cut || layer.field.is_some() { region.clone() } else { None };
            let name = self.free_name(&title, &layer.name);
            let (role, field) = (layer.role, layer.field.clone());
            self.scene.layers.push(Layer { name, region: clip, field, instances, ..Layer::new(role) });
        }
        self.scene.drop_unused();
    }

    /// The part that a place belongs to: that of the nearest pixel of the canvas.
    fn part_at(&self, p: Point) -> u32 {
        let labels = &self.map.labels;
        let along = |v: f64, size: u32, repeats: bool| {
            let v = libm::floor(v) as i64;
            let size = i64::from(size);
            (if repeats { v.rem_euclid(size) } else { v.clamp(0, size - 1) }) as u32
        };
        let tile = self.scene.tile;
        labels.get(along(p.x, labels.width, tile.x), along(p.y, labels.height, tile.y))
    }

    /// Whether a box reaches into a part.
    fn reaches(&self, b: Rect, part: usize) -> bool {
        let count = |side: f64| ((side / PLACE_DISTANCE) as usize + 2).clamp(PLACES[0], PLACES[1]);
        let [columns, rows] = [b.width(), b.height()].map(count);
        let place = |k: usize, count: usize, low: f64, side: f64| low + k as f64 / (count - 1) as f64 * side;
        let mut at = (0..columns * rows).map(|k| {
            let [column, row] = [k % columns, k / columns];
            Point::new(place(column, columns, b.x0, b.width()), place(row, rows, b.y0, b.height()))
        });
        at.any(|p| self.part_at(p) == part as u32)
    }

    /// A name that no layer has.
    fn free_name(&self, title: &str, name: &str) -> String {
        let own = format!("{title} {name}");
        let known = |name: &str| self.scene.layers.iter().any(|layer| layer.name == name);
        if !known(&own) {
            return own;
        }
        let numbered = (2..).map(|n| format!("{own} {n}")).find(|name| !known(name));
        numbered.unwrap_or(own)
    }
}

/// The colours beneath all elements of a scene, as one field.
fn field(scene: &Scene) -> Option<Field> {
    let fields: Vec<_> =
        scene.layers.iter().filter_map(|l| Some((l.region.as_ref(), l.field.as_ref()?))).collect();
    joined(&fields).map(|field| field.into_owned())
}
