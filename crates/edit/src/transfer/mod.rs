//! Scene × scenes → scene: the arrangement of one texture with the appearance of others (Tu, dissertation,
//! section 4.4.2 and appendix 7.4).
//!
//! Elements keep their Gaussians, that is, place, size and direction. With mean alignment they also keep
//! their shapes and take the mean colour of the other texture; with replacement each becomes an element of
//! the other texture, drawn in the frame of the one that it replaces.
//!
//! Works badly for replacement in a texture whose outlines interlock, such as cracked mud, because other
//! outlines leave other gaps.

mod donors;
#[cfg(test)]
mod figures;
mod means;
mod stylize;
#[cfg(test)]
mod tests;

pub use stylize::{Keep, StylizeParams, stylize};

use crate::edit::draw_as;
use donors::Donors;
use means::Means;
use std::collections::BTreeMap;
use vtex_base::Parameter;
use vtex_base::error::{Result, check};
use vtex_base::geometry::Point;
use vtex_base::raster::ControlMap;
use vtex_base::sampling::stream;
use vtex_scene::element::Gaussian;
use vtex_scene::scene::{
    EditRecord, Element, ElementId, LibraryId, Recorded, Repaint, Scene, Transfer, TransferMode,
};

/// How appearance is transferred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferParams {
    /// What elements take over. Default: [`TransferMode::Replace`].
    pub mode: TransferMode,
    /// Factor of the size of elements.
    pub scale: f64,
    /// Seed of random choices. Default 0.
    pub seed: u64,
}

impl TransferParams {
    /// Factor of the size of elements.
    pub const SCALE: Parameter<f64> = Parameter::new("scale", [0.01, 100.0], "").or(1.0);
}

impl Default for TransferParams {
    fn default() -> Self {
        Self { mode: TransferMode::Replace, scale: Self::SCALE.default(), seed: 0 }
    }
}

/// Numbers of elements by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct TransferReport {
    /// Elements that got the appearance of another texture.
    pub changed: usize,
    /// Elements that were removed because the other texture has none of their role.
    pub removed: usize,
    /// Elements that kept their shape because they are too thin for a frame ([`Gaussian::is_degenerate`]).
    pub thin: usize,
}

/// Gives the elements of a scene the appearance of other scenes: the reconstruction of a library
/// (`vtex::synth::reconstruct`) or any other. With several, `shares` has a map of the share of each; every
/// element takes the one with the largest share at its centre. A scene with its own appearance, not scaled,
/// stays as it is.
///
/// # Errors
/// [`vtex_base::Error::Format`] for a scene that breaks its invariants; [`vtex_base::Error::Parameter`] for a
/// parameter out of range, no appearance, or not as many maps as appearances (one appearance needs none).
pub fn transfer(
    structure: &Scene,
    appearances: &[Scene],
    shares: &[ControlMap],
    params: &TransferParams,
) -> Result<(Scene, TransferReport)> {
    for scene in appearances.iter().chain([structure]) {
        scene.check()?;
    }
    TransferParams::SCALE.check(params.scale)?;
    let count = appearances.len();
    check(count > 0, "appearance", count, "at least one")?;
    let mapped = shares.len() == count || (count == 1 && shares.is_empty());
    check(mapped, "map", shares.len(), "as many maps as appearances")?;
    if appearances.iter().all(|a| a == structure) && params.scale == 1.0 {
        return Ok((structure.clone(), TransferReport::default()));
    }
    let mut scene = structure.clone();
    let work = Work { structure, appearances, shares, params };
    let report = match params.mode {
        TransferMode::Mean => work.align(&mut scene),
        TransferMode::Replace => work.replace(&mut scene),
    };
    scene.drop_unused();
    let names = appearances.iter().flat_map(|a| &a.libraries).map(|l| l.exemplar.clone()).collect();
    let record = Transfer { appearance: names, mode: params.mode, scale: params.scale };
    scene.edits.push(EditRecord { operation: Recorded::Transfer(record), seed: params.seed });
    scene.check()?;
    Ok((scene, report))
}

/// The arguments of a transfer.
struct Work<'a> {
    structure: &'a Scene,
    appearances: &'a [Scene],
    shares: &'a [ControlMap],
    params: &'a TransferParams,
}

impl Work<'_> {
    /// The appearance that holds at a point.
    fn region(&self, at: Point) -> usize {
        let canvas = [f64::from(self.structure.width), f64::from(self.structure.height)];
        let share = |k: usize| self.shares[k].at([at.x, at.y], canvas);
        // Ties go to the first.
        (0..self.shares.len()).rev().max_by(|&a, &b| share(a).total_cmp(&share(b))).unwrap_or(0)
    }

    /// The appearance that holds for each instance, in painting order.
    fn regions(&self) -> Vec<usize> {
        self.structure.instances().map(|i| self.region(self.structure.place(i))).collect()
    }

    /// The covariance that an element is to have.
    fn target(&self, own: &Gaussian) -> Gaussian {
        let square = self.params.scale * self.params.scale;
        Gaussian { covariance: own.covariance.map(|v| v * square), ..*own }
    }

    /// Colours moved so that their means are those of the appearance.
    fn align(&self, scene: &mut Scene) -> TransferReport {
        let regions = self.regions();
        let means = Means::new(self.structure, self.appearances, &regions);
        let gaussians = self.structure.gaussians();
        let periods = scene.periods();
        let mut elements = std::mem::take(&mut scene.elements);
        let (mut repaint, mut thin) = (Repaint::default(), 0);
        let mut index = 0;
        for layer in &mut scene.layers {
            for instance in &mut layer.instances {
                repaint.paint(&mut elements, instance, &means.of_element(regions[index], layer.role));
                match &gaussians[index] {
                    Some(own) if self.params.scale != 1.0 => {
                        let was = instance.clone();
                        draw_as(instance, &was, own, &self.target(own), periods);
                    }
                    Some(_) => {}
                    None => thin += usize::from(self.params.scale != 1.0),
                }
                index += 1;
            }
        }
        scene.elements = elements;
        self.align_fields(scene, &means);
        TransferReport { changed: index, removed: 0, thin }
    }

    /// Fields moved likewise.
    fn align_fields(&self, scene: &mut Scene, means: &Means) {
        let middle = Point::new(f64::from(scene.width) / 2.0, f64::from(scene.height) / 2.0);
        for field in scene.layers.iter_mut().filter_map(|layer| layer.field.as_mut()) {
            field.fallback = means.of_field(self.region(middle)).of(field.fallback);
            for point in &mut field.points {
                point.colour = means.of_field(self.region(Point::new(point.x, point.y))).of(point.colour);
            }
        }
    }

    /// Elements of the appearance in place of those of the structure.
    fn replace(&self, scene: &mut Scene) -> TransferReport {
        let regions = self.regions();
        let means = Means::new(self.structure, self.appearances, &regions);
        let gaussians = self.structure.gaussians();
        let donors: Vec<Donors<'_>> = self.appearances.iter().map(Donors::new).collect();
        let first = add_libraries(scene, self.appearances);
        let mut elements = std::mem::take(&mut scene.elements);
        let (mut known, mut repaint) = (BTreeMap::new(), Repaint::default());
        let periods = scene.periods();
        let mut report = TransferReport::default();
        let mut index = 0;
        for layer in &mut scene.layers {
            let role = layer.role;
            layer.instances.retain_mut(|instance| {
                let (region, own) = (regions[index], gaussians[index]);
                index += 1;
                let Some(own) = own else {
                    repaint.paint(&mut elements, instance, &means.of_element(region, role));
                    report.thin += 1;
                    return true;
                };
                let random = stream(self.params.seed, "transfer/replace", instance.id.0.into());
                let Some(donor) = donors[region].draw(role, &own, random) else {
                    report.removed += 1;
                    return false;
                };
                instance.element = *known.entry((region, donor.instance.element)).or_insert_with(|| {
                    elements.push(moved(self.appearances[region].element(donor.instance), first[region]));
                    ElementId::after(elements.len() - 1)
                });
                instance.colour = donor.instance.colour;
                draw_as(instance, donor.instance, &donor.gaussian, &self.target(&own), periods);
                report.changed += 1;
                true
            });
        }
        scene.elements = elements;
        self.align_fields(scene, &means);
        report
    }
}

/// Adds the libraries of appearances to the list of a scene. Returns the index of the first library of each.
fn add_libraries(scene: &mut Scene, appearances: &[Scene]) -> Vec<u32> {
    let mut first = Vec::with_capacity(appearances.len());
    for appearance in appearances {
        first.push(scene.libraries.len() as u32);
        scene.libraries.extend(appearance.libraries.iter().cloned());
    }
    first
}

/// An element with its library's index shifted by `first`.
fn moved(element: &Element, first: u32) -> Element {
    Element { library: LibraryId(element.library.0 + first), ..element.clone() }
}
