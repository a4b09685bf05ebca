//! Composes scenes of what a method has arranged.

use super::covered::covered;
use super::report::SynthReport;
use super::secondaries::PlacedSecondary;
use super::strata::CanvasStrata;
use crate::arrange::correspondence::SecondaryPlace;
use crate::arrange::model::Content;
use crate::arrange::variation::Variation;
use crate::arrange::{PlacedElement, PlacementResult, Plan};
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::Colour;
use vtex_scene::library::{ExemplarLayer, Library};
use vtex_scene::reconstruct::Listing;
use vtex_scene::scene::{
    Domain, Element, ElementId, Instance, InstanceId, Layer, LibraryId, Role, Scene, SynthParams,
};

/// A placed element.
pub(crate) struct Placement<'a> {
    pub(crate) what: What<'a>,
    /// From the coordinates of the element to those of the canvas.
    pub(crate) transform: [f64; 6],
    /// Index of the layer.
    pub(crate) layer: usize,
    /// Number of the motif of which it is a part.
    pub(crate) motif: Option<u32>,
    /// Its height, where copies are stacked.
    pub(crate) height: i32,
}

/// The content of a placement.
pub(crate) enum What<'a> {
    /// An element of the plan's libraries, with another colour if it has one. Until motifs are taken apart, each is one
    /// element.
    Known(LibraryId, ElementId, Option<Colour>),
    /// An element made for this scene.
    Made(Box<Element>),
    /// An instance of an earlier scene, which keeps its identity, element, colour and effects.
    Kept(&'a Instance),
}

/// What a method has arranged.
pub(crate) struct Arranged<'a> {
    /// The scene without instances.
    pub(crate) blank: Scene,
    /// Number of the first new instance.
    pub(crate) first: InstanceId,
    /// The elements, in their order within each layer.
    pub(crate) placements: Vec<Placement<'a>>,
    /// What the method has to say.
    pub(crate) report: SynthReport,
    /// The stage in which it is counted what the categories of a drawing cover; `None` if the report says so.
    pub(crate) counted: Option<&'static str>,
}

impl<'a> Arranged<'a> {
    /// What is arranged on a blank scene, whose coverage the report says.
    pub(crate) fn new(blank: Scene, placements: Vec<Placement<'a>>, report: SynthReport) -> Self {
        Self { blank, first: InstanceId(0), placements, report, counted: None }
    }

    /// What is arranged for a drawing, in its layers; beside a drawing that stays, in one layer.
    pub(super) fn of_drawing(
        plan: &Plan<'_>,
        variation: f64,
        mut placements: Vec<Placement<'a>>,
        report: SynthReport,
    ) -> Self {
        let layers = if plan.controls.context.is_some() {
            placements.iter_mut().for_each(|placement| placement.layer = 0);
            vec![Layer { name: Layer::PREDICTED.into(), predicted: true, ..Layer::new(Role::Primary) }]
        } else {
            let own = plan.libraries[0].layers.iter();
            let layer = |own: &ExemplarLayer| Layer {
                name: own.name.clone(),
                field: own.field.clone(),
                ..Layer::new(own.role)
            };
            own.map(layer).collect()
        };
        let mut blank = blank(plan, layers);
        blank.parameters = blank.parameters.map(|p| SynthParams { variation: Some(variation), ..p });
        Self::new(blank, placements, report)
    }

    /// For each placement the number of the thing of which it is all or a part: a motif is one thing.
    pub(super) fn thing_numbers(&self) -> Vec<usize> {
        let mut of_motif = BTreeMap::new();
        let mut numbers = 0..;
        let mut next = || numbers.next().unwrap_or_default();
        let number = |placement: &Placement<'_>| match placement.motif {
            Some(motif) => *of_motif.entry(motif).or_insert_with(&mut next),
            None => next(),
        };
        self.placements.iter().map(number).collect()
    }

    /// The scene, and all that is to be said of it.
    ///
    /// # Errors
    /// Those of `progress`.
    pub(crate) fn composed(self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<(Scene, SynthReport)> {
        let Self { blank, first, placements, mut report, counted } = self;
        let mut scene = compose(blank, first, &plan.libraries, placements);
        if !report.strata.is_empty() {
            scene.layers = CanvasStrata::drop_empty(std::mem::take(&mut scene.layers));
        }
        if let Some(stage) = counted {
            let found = covered(&plan.libraries[0], &scene, || advance(progress, stage, 2, 2))?;
            report.categories.iter_mut().zip(found).for_each(|(category, found)| category.got = found);
        }
        let report = report.of_scene(&plan.libraries, &scene);
        Ok((scene, report))
    }
}

/// The scene of a plan, with layers but without elements.
pub(crate) fn blank(plan: &Plan<'_>, layers: Vec<Layer>) -> Scene {
    let references = plan.libraries.iter().map(Library::reference).collect();
    let params = &plan.params;
    Scene {
        parameters: Some(params.clone()),
        page: params.page,
        tile: params.tile,
        domain: plan.controls.domain.clone().map(|outline| Domain { outline, edge: params.edge }),
        ..Scene::new([params.width, params.height], references, layers)
    }
}

/// Adds placements to the layers of a scene, in their order. Elements are listed in the order of their first
/// instance, after those that the scene lists already; of these, the ones without an instance are left out. New
/// instances are numbered from `first` on.
fn compose(
    mut scene: Scene,
    first: InstanceId,
    libraries: &[Library],
    placements: Vec<Placement<'_>>,
) -> Scene {
    let listing = |(k, library)| Listing::of(LibraryId(k as u32), library, &scene);
    let mut listings: Vec<Listing<'_>> = libraries.iter().enumerate().map(listing).collect();
    let mut ids = (first.0..=u32::MAX).chain(0..first.0).map(InstanceId);
    let mut fresh = |element| Instance::new(ids.next().unwrap_or(first), element);
    for Placement { what, transform, layer, motif, height } in placements {
        let instance = match what {
            What::Known(library, source, colour) => {
                let element = listings[library.index()].element(&mut scene, source);
                Instance { transform, motif, colour, height, ..fresh(element) }
            }
            What::Made(element) => {
                let element = scene.add(*element);
                Instance { transform, motif, height, ..fresh(element) }
            }
            What::Kept(instance) => Instance { transform, ..instance.clone() },
        };
        scene.layers[layer].instances.push(instance);
    }
    scene.drop_unused();
    scene
}

/// A placed primary in a layer.
pub(crate) fn primary(
    arrangement: &PlacementResult<'_>,
    placed: &PlacedElement,
    layer: usize,
) -> Placement<'static> {
    let model = arrangement.cells.model();
    let element = &model[placed.element];
    let known = What::Known(LibraryId(element.library as u32), ElementId(element.index), None);
    let (what, transform) = match element.content {
        // A fused element is stored with its variation applied.
        Content::Fused(fused) => {
            let made = model.fused[fused as usize].clone();
            (What::Made(Box::new(made)), at(&Variation::default(), placed.at))
        }
        Content::Mapped(map) => (known, at(&model.maps[map as usize], placed.at)),
        Content::Known => (known, at(&model.variations[usize::from(placed.variation)], placed.at)),
    };
    Placement { what, transform, layer, motif: None, height: 0 }
}

/// A placed secondary in a layer.
pub(crate) fn secondary(
    plan: &Plan<'_>,
    arrangement: &PlacementResult<'_>,
    placed: &PlacedSecondary,
    layer: usize,
) -> Placement<'static> {
    let SecondaryPlace { secondary, at, variation } = placed.place;
    let source = plan.libraries[placed.library].secondary_id(secondary);
    let variation = &arrangement.cells.model().variations[usize::from(variation)];
    let what = What::Known(LibraryId(placed.library as u32), source, Some(placed.colour));
    Placement { what, transform: self::at(variation, at), layer, motif: None, height: 0 }
}

/// The transform of a variation at a place of the canvas.
pub(crate) fn at(variation: &Variation, at: [i32; 2]) -> [f64; 6] {
    // Five decimals are precise to a hundredth of a pixel at a distance of a thousand, and short.
    let [a, b, c, d] = variation.matrix.map(|v| libm::round(v * 1e5) / 1e5);
    [a, b, c, d, f64::from(at[0]), f64::from(at[1])]
}
