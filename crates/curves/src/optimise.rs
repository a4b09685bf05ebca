//! The synthesis from coarse to fine.

use crate::context::{CurveContext, GivenLines};
use crate::edges::improve_edges;
use crate::existence::improve_existence;
use crate::graph::CurveGraph;
use crate::initial::{noise, patches};
use crate::input::{CurveInput, CurveScale};
use crate::measures::CurveMeasures;
use crate::mend::{CurveMends, mend};
use crate::output::CurveOutput;
use crate::positions::improve_positions;
use crate::search::search;
use crate::trace::{ShownPart, TracedCurve, traced, traced_beside};
use vtex_base::error::{Error, Large, Result};
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex};

/// Long side of the exemplar in the lengths of the paper, and its finest sample distance.
const SIDE: f64 = 400.0;
const FINEST: f64 = 25.0;
/// Longest sample distance, in mean distances between curves.
const SPACING: f64 = 0.8;
/// Sample distances of the levels as multiples of the finest (table 5.1: 40, 30, 25).
const LEVELS: [f64; 3] = [1.6, 1.2, 1.0];
/// Samples in a neighbourhood.
const NEIGHBOURS: f64 = 22.0;
/// Iterations of a level at most, and the change of energy below which it ends earlier.
const ITERATIONS: usize = 7;
const SETTLED: f64 = 0.01;
/// Least share of the edges that a level keeps.
const KEPT: f64 = 0.9;
/// Most samples that are optimised, and that are made at all.
const MOST_OPTIMISED: f64 = 8_000.0;
const MOST_SAMPLES: f64 = 1_000_000.0;
/// Most points looked at to find the neighbours of all samples: a crowd stays as it is.
const MOST_LOOKED_AT: u64 = 20_000_000;
/// Most samples of the exemplar.
const MOST_INPUT: f64 = 60_000.0;
/// Least length of curves by area, relative to the exemplar's; the most is as far beyond it.
const LEAST_LENGTH: f64 = 0.6;
/// How far curves lead beyond the canvas, in radii of neighbourhoods.
const BEYOND: f64 = 0.4;
/// Largest change of the exemplar's period for one that fits a tile.
const STRETCH: f64 = 0.1;

/// What is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveParams {
    /// Width and height of the canvas, in the unit of the exemplar.
    pub size: [f64; 2],
    /// The axes along which the canvas repeats without a seam.
    pub tile: [bool; 2],
    /// Seed of all random choices.
    pub seed: u64,
    /// How readily the exemplar is rearranged, 0 to 1. With 0 it goes on as it is wherever it can.
    pub variation: f64,
    /// Largest deviation of a path from its curve, in the unit of the exemplar.
    pub tolerance: f64,
    /// Parts that are left out.
    pub without: CurveParts,
}

/// Parts of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurveParts {
    /// Edges do not count where neighbourhoods are compared.
    pub no_edge: bool,
    /// Neighbourhoods are compared without outliers: samples without a match cost more than any match.
    pub no_robust: bool,
    /// Lines are straight between samples.
    pub no_orientation: bool,
    /// Samples are neither added nor removed.
    pub no_existence: bool,
    /// The first arrangement is noise instead of patches.
    pub no_patches: bool,
    /// Loose ends stay.
    pub no_mend: bool,
}

/// What a level did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurveLevel {
    /// Samples of the exemplar, and of the result at the end.
    pub samples: [usize; 2],
    /// Energy of each iteration, for each neighbourhood and sample.
    pub energies: Vec<f64>,
    /// Samples added, and removed.
    pub changed: [usize; 2],
    /// Whether its result was given up, since it had more loose ends than before or much fewer edges.
    pub undone: bool,
    /// Distance of samples, in the unit of the exemplar.
    pub distance: f64,
    /// Places of the samples at the end, with the number of edges at each.
    pub output: Vec<([f64; 2], usize)>,
    /// The edges at the end: where each begins, and the way to its end.
    pub edges: Vec<[[f64; 2]; 2]>,
}

/// An element of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedCurveElement {
    /// Its place, in the unit of the exemplar.
    pub at: [f64; 2],
    /// The number of the exemplar's element that it is a copy of.
    pub element: u32,
}

/// The result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurveResult {
    /// The curves.
    pub curves: Vec<TracedCurve>,
    /// The elements between them.
    pub elements: Vec<PlacedCurveElement>,
    /// The levels, from coarse to fine; fewer for large canvases.
    pub levels: Vec<CurveLevel>,
    /// Loose ends mended.
    pub mended: CurveMends,
    /// Measures of the exemplar and of the result; beside a context, of its region.
    pub measures: [CurveMeasures; 2],
    /// Ends of the lines of a context that lead into its region, and how many of them are continued.
    pub continued: [usize; 2],
}

/// Synthesises curves like those of an exemplar, given as their graph. `go_on` is asked between parts of the work. An
/// exemplar without curves gives none.
///
/// # Errors
/// [`Error::TooLarge`] for too many curves, [`Error::Parameter`] for curves that cannot go on where parts of the exemplar
/// are put together, and those of `go_on`.
pub fn curves(
    exemplar: &CurveGraph,
    params: &CurveParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<CurveResult> {
    let total = exemplar.length();
    if total <= 0.0 {
        return Ok(CurveResult::default());
    }
    let own = exemplar.stretched(stretch(exemplar.plane, params.size, params.tile));
    let scales = LevelScales::new(&own);
    let input = repeated(&own, 4.5 * scales.coarsest().radius, scales.finest)?;
    let plane = canvas(own.plane, (params.size, params.tile), scales.coarsest().radius);
    let used = scales.levels(plane.area())?;
    let shown = ShownPart { size: params.size, tile: params.tile, margin: BEYOND * scales.coarsest().radius };
    let wanted = scales.density * plane.area();
    let task = CurveTask { input: &input, coarsest: scales.coarsest(), plane, params, given: None };
    let MadeCurves { output, samples, graph, mut result, has_length } = task.made(used, wanted, go_on)?;
    if has_length {
        for (at, number) in output.elements(&samples) {
            let element = samples.graph.elements[number].element;
            let places = shown.places(at, plane).into_iter();
            result.elements.extend(places.map(|at| PlacedCurveElement { at, element }));
        }
        result.measures = [&samples.graph, &graph].map(CurveMeasures::of);
        result.curves = traced(&graph, shown, params.tolerance);
        return Ok(result);
    }
    Err(Error::Parameter {
        name: "method",
        value: "curves".into(),
        allowed:
            "for a drawing whose lines go on where parts of it are put together; those of this one end there, or double"
                .into(),
    })
}

/// Synthesises curves in a region beside lines that stand, and goes on from these. The result holds the new curves alone.
/// `params.tile` must be false. The region must reach onto the canvas.
///
/// # Errors
/// [`Error::TooLarge`] for too many curves, and those of `go_on`.
pub fn curves_beside(
    exemplar: &CurveGraph,
    context: &CurveContext,
    params: &CurveParams,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<CurveResult> {
    if exemplar.length() <= 0.0 {
        return Ok(CurveResult::default());
    }
    let scales = LevelScales::new(exemplar);
    let coarsest = scales.coarsest();
    let input = repeated(exemplar, 4.5 * coarsest.radius, scales.finest)?;
    let lines = GivenLines::new(context, params.size, (coarsest, scales.finest));
    let used = scales.levels(lines.window.plane.area())?;
    let wanted = scales.density * lines.free_area(scales.spacing);
    let task = CurveTask { input: &input, coarsest, plane: lines.window.plane, params, given: Some(&lines) };
    let MadeCurves { output, samples, graph, mut result, .. } = task.made(used, wanted, go_on)?;
    let in_region = CurveMeasures::of_part(&output.graph(&samples, false), |p| lines.is_shown(p, 0.0));
    result.measures = [CurveMeasures::of(&samples.graph), in_region];
    let is_continued = |s: &usize| output.made_edges().iter().any(|e| e.ends.contains(&(*s as u32)));
    let ends: Vec<usize> = (0..output.given()).filter(|s| output.ahead[*s].is_some()).collect();
    result.continued = [ends.len(), ends.iter().filter(|s| is_continued(s)).count()];
    for (at, number) in output.elements(&samples).into_iter().filter(|e| lines.is_shown(e.0, 0.0)) {
        let at = [at[0] + lines.window.low[0], at[1] + lines.window.low[1]];
        let element = samples.graph.elements[number].element;
        result.elements.push(PlacedCurveElement { at, element });
    }
    let margin = BEYOND * coarsest.radius;
    result.curves = traced_beside(&graph, (&lines, &output.ahead), (margin, params.tolerance));
    // Levels are reported on the canvas.
    for level in &mut result.levels {
        let moved = |p: &mut [f64; 2]| *p = [p[0] + lines.window.low[0], p[1] + lines.window.low[1]];
        level.output.iter_mut().for_each(|o| moved(&mut o.0));
        level.edges.iter_mut().for_each(|e| moved(&mut e[0]));
    }
    Ok(result)
}

/// The lengths of all levels.
pub(crate) struct LevelScales {
    pub(crate) finest: f64,
    /// Length of curves by area, and its inverse, the mean distance between curves.
    density: f64,
    spacing: f64,
}

impl LevelScales {
    pub(crate) fn new(exemplar: &CurveGraph) -> Self {
        let page = exemplar.plane;
        let total = exemplar.length();
        let (density, spacing) = (total / page.area(), page.area() / total);
        let long = page.size[0].max(page.size[1]);
        Self { finest: (FINEST / SIDE * long).min(SPACING * spacing), density, spacing }
    }

    fn of(&self, level: f64) -> CurveScale {
        let distance = level * self.finest;
        let radius = libm::sqrt(NEIGHBOURS * distance * self.spacing / std::f64::consts::PI);
        CurveScale { distance, radius: radius.max(1.6 * distance) }
    }

    pub(crate) fn coarsest(&self) -> CurveScale {
        self.of(LEVELS[0])
    }

    /// The levels on which a canvas of an area is optimised.
    fn levels(&self, area: f64) -> Result<Vec<CurveScale>> {
        let expected = |level: f64| self.density * area / (level * self.finest);
        if expected(1.0) > MOST_SAMPLES {
            return Err(Error::TooLarge {
                what: Large::Canvas,
                name: "size".into(),
                found: format!("curves of about {:.0} million samples", libm::ceil(expected(1.0) / 1e6)),
                limit: format!("{:.0} million", MOST_SAMPLES / 1e6),
            });
        }
        Ok(LEVELS.iter().filter(|l| expected(**l) <= MOST_OPTIMISED).map(|l| self.of(*l)).collect())
    }
}

/// Curves to be made on a plane.
struct CurveTask<'a> {
    input: &'a CurveGraph,
    coarsest: CurveScale,
    plane: PeriodicPlane,
    params: &'a CurveParams,
    /// Lines that stand there already.
    given: Option<&'a GivenLines>,
}

/// What an attempt has made.
struct MadeCurves {
    output: CurveOutput,
    /// The samples of the exemplar on the last level.
    samples: CurveInput,
    /// The curves; beside given lines, the new ones alone.
    graph: CurveGraph,
    /// Without curves and measures.
    result: CurveResult,
    /// Whether the curves are about as long as those of the exemplar, or this is not asked for.
    has_length: bool,
}

impl CurveTask<'_> {
    /// Curves optimised on levels; patches alone where the optimisation loses them. They should be `wanted` long.
    fn made(
        &self,
        levels: Vec<CurveScale>,
        wanted: f64,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<MadeCurves> {
        let made = self.attempt(&levels, wanted, go_on)?;
        if made.has_length || levels.is_empty() {
            return Ok(made);
        }
        self.attempt(&[], wanted, go_on)
    }

    /// Samples and edges that are optimised on the given levels, or patches of the coarsest scale if there are none.
    fn attempt(
        &self,
        levels: &[CurveScale],
        wanted: f64,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<MadeCurves> {
        let &Self { input, params, given, .. } = self;
        let mut result = CurveResult::default();
        let mut settled = |output: CurveOutput, input: &CurveInput| {
            go_on()?;
            if levels.is_empty() || is_crowded(&output, input.scale.radius) {
                return Ok(output);
            }
            let (output, level) = level_of(output, input, (params, given), go_on)?;
            result.levels.push(level);
            Ok::<_, Error>(output)
        };
        let sampled = |scale: CurveScale| -> Result<CurveInput> {
            let mut samples = CurveInput::new(input, scale, go_on)?;
            samples.with_edges = !params.without.no_edge;
            samples.is_robust = !params.without.no_robust;
            Ok(samples)
        };
        let standing = |samples: &CurveInput| match given {
            Some(given) => given.samples(samples, go_on),
            None => Ok(CurveOutput::new(self.plane)),
        };
        let mut last = sampled(levels.first().copied().unwrap_or(self.coarsest))?;
        let start = standing(&last)?;
        let start = match params.without.no_patches {
            true => noise(&last, start, params.seed, given),
            false => patches(&last, start, (params.variation, params.seed), given, go_on)?,
        };
        let mut output = settled(start, &last)?;
        for scale in levels.iter().skip(1) {
            let finer = sampled(*scale)?;
            output = settled(output.resampled(&last, &finer, standing(&finer)?), &finer)?;
            last = finer;
        }
        if !params.without.no_mend {
            result.mended = mend(&mut output, &last);
        }
        go_on()?;
        if params.without.no_orientation {
            output.edges.iter_mut().for_each(|edge| edge.from = [None; 2]);
        }
        let graph = output.graph(&last, given.is_some());
        let lengths = LEAST_LENGTH..=1.0 / LEAST_LENGTH;
        let has_length = params.without.no_patches || lengths.contains(&(graph.length() / wanted.max(1e-9)));
        Ok(MadeCurves { output, samples: last, graph, result, has_length })
    }
}

/// Whether to find the samples near each sample takes too long.
fn is_crowded(output: &CurveOutput, radius: f64) -> bool {
    let index = PointIndex::new(output.plane, radius, &output.points);
    index.looked_at(&output.points, radius) > MOST_LOOKED_AT
}

/// Factors of the exemplar's sides with which a whole number of its periods fits a tile.
pub(crate) fn stretch(page: PeriodicPlane, size: [f64; 2], tile: [bool; 2]) -> [f64; 2] {
    [0, 1].map(|k| {
        let times = libm::round(size[k] / page.size[k]).max(1.0);
        let factor = size[k] / (times * page.size[k]);
        if page.wraps[k] && tile[k] && (factor - 1.0).abs() <= STRETCH { factor } else { 1.0 }
    })
}

/// The exemplar repeated along its periods until neighbourhoods do not meet themselves.
pub(crate) fn repeated(own: &CurveGraph, least: f64, finest: f64) -> Result<CurveGraph> {
    let page = own.plane;
    let times = [0, 1].map(|k| if page.wraps[k] { libm::ceil(least / page.size[k]).max(1.0) } else { 1.0 });
    let samples = (own.length() / finest + own.points.len() as f64) * times[0] * times[1];
    if samples > MOST_INPUT {
        return Err(Error::TooLarge {
            what: Large::Drawing,
            name: "the drawing".into(),
            found: format!("lines of about {samples:.0} samples"),
            limit: format!("{MOST_INPUT:.0}"),
        });
    }
    Ok(own.repeated(times.map(|t| t as usize)))
}

/// The canvas with a margin along axes that do not repeat. It always repeats: what is beside it on one side is beside it
/// on the other.
pub(crate) fn canvas(page: PeriodicPlane, (size, tile): ([f64; 2], [bool; 2]), radius: f64) -> PeriodicPlane {
    let size = [0, 1].map(|k| {
        let size = size[k];
        if tile[k] {
            return size;
        }
        let wanted = size + 2.0 * radius;
        // A whole number of periods leaves a regular exemplar as it is.
        if page.wraps[k] { libm::ceil(wanted / page.size[k] - 1e-9) * page.size[k] } else { wanted }
    });
    PeriodicPlane { size, wraps: [true; 2] }
}

/// The iterations of one level. If they leave more loose ends than there were, or much fewer edges, the samples stay as
/// they were.
pub(crate) fn level_of(
    mut output: CurveOutput,
    input: &CurveInput,
    (params, given): (&CurveParams, Option<&GivenLines>),
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(CurveOutput, CurveLevel)> {
    let mut level = CurveLevel::default();
    let before = output.clone();
    for iteration in 1..=ITERATIONS {
        let matches = search(&mut output, input, go_on)?;
        let energy = matches.energy();
        let last = level.energies.last().copied();
        level.energies.push(energy);
        let mut changes = 0;
        improve_positions(&mut output, input, &matches, go_on)?;
        improve_edges(&mut output, input, &matches);
        go_on()?;
        if !params.without.no_existence {
            let (keep, added) = improve_existence(&output, input, &matches, given);
            let removed = keep.iter().filter(|k| !**k).count();
            level.changed = [level.changed[0] + added.len(), level.changed[1] + removed];
            changes = removed + added.len();
            output.retain(&keep);
            for missed in added {
                output.push(missed.at, missed.source, input);
            }
        }
        output.improve_orientations(input);
        let settled = last.is_some_and(|b: f64| (b - energy).abs() <= SETTLED * b);
        if energy <= 1e-9 && changes == 0 || settled && iteration > 2 {
            break;
        }
    }
    let ends = |of: &CurveOutput| {
        let few = of.incident().into_iter().enumerate().filter(|(_, at)| at.len() < 2);
        few.filter(|(s, _)| !of.is_element(*s, input)).count()
    };
    let fewer = (output.made_edges().len() as f64) < KEPT * before.made_edges().len() as f64;
    if !params.without.no_patches && (fewer || ends(&output) > ends(&before)) {
        output = before;
        level.undone = true;
    }
    level.samples = [input.len(), output.len()];
    level.distance = input.scale.distance;
    level.output = output.points.iter().copied().zip(output.incident().iter().map(Vec::len)).collect();
    let edges = output.edges.iter().zip(0..);
    level.edges = edges.map(|(edge, e)| [output.points[edge.ends[0] as usize], output.way((e, 0))]).collect();
    Ok((output, level))
}
