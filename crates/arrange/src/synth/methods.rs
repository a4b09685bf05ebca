//! The methods of placement, and the choice of one.

#[cfg(feature = "clustered")]
use super::clustered::Clustered;
use super::compose::Arranged;
#[cfg(feature = "curves")]
use super::curves::Curves;
use super::one_by_one::OneByOne;
use super::period::Periodic;
use super::refusal::{if_fits, refusal};
use crate::arrange::Plan;
use crate::arrange::context::DrawnContext;
use vtex_base::error::Result;
use vtex_base::progress::Progress;
use vtex_scene::library::Library;
use vtex_scene::scene::{Ablation, Method, Weights};

/// A method of placement that is made ready for a plan.
pub(super) trait PlacementMethod {
    /// What the method has to recognise in the libraries of a plan.
    ///
    /// # Errors
    /// [`vtex_base::Error::Parameter`] that says why the method is not for the plan; those of `progress`.
    fn fits(plan: &Plan<'_>, progress: &dyn Progress) -> Result<Self>
    where
        Self: Sized;

    /// Arranges elements. The plan is that of `fits`, but its canvas may have been fitted to periods, and its context
    /// cleared.
    ///
    /// # Errors
    /// Those of the method, and of `progress`.
    fn arrange(&self, plan: &Plan<'_>, progress: &dyn Progress) -> Result<Arranged<'static>>;

    /// The context without what its drawing has in the region, on a canvas in the units of the context.
    fn cleared(&self, context: &DrawnContext, canvas: [u32; 2]) -> DrawnContext {
        context.without_lines(canvas)
    }
}

/// Chooses the method of a plan, and sets it in the parameters.
///
/// # Errors
/// [`vtex_base::Error::Parameter`] that says why the method asked for is not for the plan; those of `progress`.
pub(super) fn chosen(plan: &mut Plan<'_>, progress: &dyn Progress) -> Result<Box<dyn PlacementMethod>> {
    match plan.params.method {
        Method::Auto => suited(plan, progress),
        method => named(method, plan, progress),
    }
}

/// A method by its name.
fn named(method: Method, plan: &mut Plan<'_>, progress: &dyn Progress) -> Result<Box<dyn PlacementMethod>> {
    refuse_controls(method, plan)?;
    plan.params.method = method;
    Ok(match method {
        Method::Period => Box::new(Periodic::fits(plan, progress)?),
        #[cfg(feature = "clustered")]
        Method::Clustered => Box::new(Clustered::fits(plan, progress)?),
        #[cfg(feature = "curves")]
        Method::Curves => Box::new(Curves::fits(plan, progress)?),
        Method::Auto | Method::Correspondence | Method::Descriptor => {
            let made = OneByOne::fits(plan, progress)?;
            keep_apart(plan);
            Box::new(made)
        }
        #[cfg(not(all(feature = "clustered", feature = "curves")))]
        method => return Err(not_built(method)),
    })
}

/// The method that suits a plan.
fn suited(plan: &mut Plan<'_>, progress: &dyn Progress) -> Result<Box<dyn PlacementMethod>> {
    let guided = plan.libraries.iter().all(|l| l.guide.is_some());
    // Ablations that correspondences support.
    let of_both = |part: &Ablation| *part == Ablation::Secondary;
    let plain = plan.params.weights == Weights::default() && plan.params.ablate.iter().all(of_both);
    // Lines go on from what is drawn, other elements fit to it.
    if plan.controls.context.is_some() {
        #[cfg(feature = "curves")]
        let run_on = plan.libraries.iter().any(super::curves::runs_on);
        #[cfg(not(feature = "curves"))]
        let run_on = false;
        let curves_first = [Method::Curves, Method::Clustered];
        let [first, second] = if run_on { curves_first } else { [Method::Clustered, Method::Curves] };
        let made = if_fits(named(first, plan, progress))?;
        return made.map_or_else(|| named(second, plan, progress), Ok);
    }
    // Nothing else makes more of lines on paper that run on.
    #[cfg(feature = "curves")]
    if plan.libraries.iter().all(|library| library.is_line_art() && super::curves::runs_on(library))
        && let Some(made) = if_fits(named(Method::Curves, plan, progress))?
    {
        return Ok(made);
    }
    if plan.controls.structure.is_some() {
        let method = if guided && plain { Method::Correspondence } else { Method::Auto };
        return named(method, plan, progress);
    }
    if plain {
        // The period of irregular cells would be seen.
        #[cfg(feature = "curves")]
        if let Some(cells) = Curves::of_rearranged_cells(plan, progress)? {
            plan.params.method = Method::Curves;
            return Ok(Box::new(cells));
        }
        if let Some(made) = if_fits(named(Method::Period, plan, progress))? {
            return Ok(made);
        }
        // Distances and neighbours are those of the drawing.
        #[cfg(feature = "clustered")]
        if super::clustered::suits(plan)
            && let Some(made) = if_fits(named(Method::Clustered, plan, progress))?
        {
            return Ok(made);
        }
    }
    // Islands would cut a drawing and lose elements along every border.
    let is_copied = guided && plain && !plan.libraries.iter().all(Library::is_drawing);
    named(if is_copied { Method::Correspondence } else { Method::Descriptor }, plan, progress)
}

/// Refuses a method beside controls that it does not follow.
fn refuse_controls(method: Method, plan: &Plan<'_>) -> Result<()> {
    if plan.controls.context.is_some() && !matches!(method, Method::Curves | Method::Clustered) {
        let allowed = "without a drawing that stays; beside one, auto, curves and clustered do";
        return Err(refusal(method, allowed));
    }
    let guided = plan.libraries.iter().all(|l| l.guide.is_some());
    if plan.controls.structure.is_some() && !(method == Method::Correspondence && guided) {
        return Err(refusal(
            method,
            "without a map of layers or a guide to follow; correspondence follows them, with a library that has a \
             guide, and without weights or ablation",
        ));
    }
    Ok(())
}

/// The method stands behind a feature of its name.
#[cfg(not(all(feature = "clustered", feature = "curves")))]
fn not_built(method: Method) -> vtex_base::Error {
    refusal(method, format!("where vtex was built with the feature `{method:?}`").to_lowercase())
}

/// Refuses overlaps if all exemplars are drawings without touching elements.
fn keep_apart(plan: &mut Plan<'_>) {
    let apart = |l: &Library| l.is_drawing() && !l.arrangement.to_labels().any_touch();
    if plan.libraries.iter().all(apart) && !plan.params.without(Ablation::Overlap) {
        plan.params.ablate.push(Ablation::Overlap);
    }
}
