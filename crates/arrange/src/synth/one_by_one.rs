//! Textures of elements placed one by one, by correspondences or descriptors: arrangement and density
//! ([`arrange`](crate::arrange)), background, secondaries.

use super::compose::{self, Arranged};
use super::methods::PlacementMethod;
use super::report::SynthReport;
use super::strata::CanvasStrata;
use super::{background, secondaries, taken_apart};
use crate::arrange::correspondence::no_guide;
use crate::arrange::model::PlacementModel;
use crate::arrange::motifs::MotifUnits;
use crate::arrange::{Plan, arrange};
use std::borrow::Cow;
use vtex_base::error::Result;
use vtex_base::progress::{Progress, advance};
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Layer, Method, Role, Scene};

/// Placement by correspondences or descriptors, as the plan says.
pub(super) struct OneByOne {
    /// The motifs of a drawing, which descriptors place as wholes.
    units: Option<MotifUnits>,
}

impl PlacementMethod for OneByOne {
    fn fits(plan: &Plan<'_>, _: &dyn Progress) -> Result<Self> {
        match (plan.params.method, &*plan.libraries) {
            (Method::Correspondence, all) if all.iter().any(|l| l.guide.is_none()) => Err(no_guide()),
            (Method::Descriptor, [library]) => Ok(Self { units: MotifUnits::new(library) }),
            _ => Ok(Self { units: None }),
        }
    }

    fn arrange(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
        let Some(units) = &self.units else { return placed(plan, progress) };
        let closed = Plan { libraries: Cow::Owned(vec![units.closed()]), ..plan.clone() };
        Ok(taken_apart::taken_apart(units, &plan.libraries[0], placed(&closed, progress)?))
    }
}

fn placed(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>> {
    let mut model = PlacementModel::new(&plan.libraries, &plan.params);
    let arrangement = arrange(&mut model, plan, &[], progress)?;

    advance(progress, "background field", 0, 2)?;
    let field = background::field(plan, &arrangement);
    let interpolant = Interpolant::new(&field, plan.params.width, plan.params.height, plan.params.tile);
    advance(progress, "background field", 1, 2)?;
    let secondaries = secondaries::place(plan, &arrangement, &interpolant);
    advance(progress, "background field", 2, 2)?;

    let strata = CanvasStrata::new(plan, &arrangement, &field)?;
    let layers = match &strata {
        Some(strata) => strata.layers(),
        None => Scene::three_layers(field),
    };
    let below = secondaries.iter().map(|p| {
        let stratum = strata.as_ref().map_or(0, |strata| strata.of_secondary(p));
        compose::secondary(plan, &arrangement, p, CanvasStrata::layer(stratum, Role::Secondary))
    });
    let above = arrangement.placed.iter().map(|p| {
        let of = |strata: &CanvasStrata| strata.of_primary(&plan.libraries[0], &arrangement, p.element, p.at);
        let stratum = strata.as_ref().map_or(0, of);
        compose::primary(&arrangement, p, CanvasStrata::layer(stratum, Role::Primary))
    });
    let placements = below.chain(above).collect();
    let strata = strata.map_or_else(Vec::new, |strata| strata.report);
    let report = SynthReport { strata, ..SynthReport::of_arrangement(plan, &arrangement) };
    Ok(Arranged::new(compose::blank(plan, layers), placements, report))
}

/// The primaries alone, and the share of the canvas that each category covered before the density was corrected.
///
/// # Errors
/// Those of `progress`.
pub(crate) fn primaries(plan: &Plan<'_>, progress: &dyn Progress) -> Result<(Arranged<'static>, Vec<f64>)> {
    let mut model = PlacementModel::new(&plan.libraries, &plan.params);
    let arrangement = arrange(&mut model, plan, &[], progress)?;
    let canvas = f64::from(plan.params.width) * f64::from(plan.params.height);
    let covered = arrangement.covered_before.iter().map(|&cells| cells as f64 / canvas).collect();
    let placements = arrangement.placed.iter().map(|p| compose::primary(&arrangement, p, 0)).collect();
    let blank = compose::blank(plan, vec![Layer::new(Role::Primary)]);
    Ok((Arranged::new(blank, placements, SynthReport::of_arrangement(plan, &arrangement)), covered))
}
