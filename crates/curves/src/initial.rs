//! The first arrangement: patches of the exemplar side by side, and the edges between them (§2.5.2).
//!
//! The paper copies patches from random places without edges. Here the place of a patch is chosen of many by how well
//! the exemplar goes on around it: samples along the border must lie on the curves of the patches beside it, with their
//! directions and styles. Curves that cross a border are then joined. Lines that are given count as patches that are
//! there already; the patches nearest to them come first.

use crate::context::GivenLines;
use crate::existence::ON_LINE;
use crate::input::CurveInput;
use crate::joints::{Patch, join};
use crate::output::CurveOutput;
use std::collections::BTreeMap;
use vtex_base::error::Result;
use vtex_base::geometry::plane::{PeriodicPlane, PointIndex, length};
use vtex_base::parallel;
use vtex_base::sampling::{Stream, stream};

/// Places tried for a patch, besides those that go on from its neighbours.
const TRIED: usize = 40;
/// Width of the band around a patch that is compared, in radii of neighbourhoods.
const BAND: f64 = 0.7;
/// Cosine of the largest angle between curves that are laid on one another: 15°.
const ALIGNED: f64 = 0.966;
/// Weight of a distance along a curve, as against one across.
const ALONG: f64 = 0.2;
/// Mean misfit, in sample distances, up to which a patch may come from elsewhere although the exemplar could go on.
const CHANGE: f64 = 0.22;
/// The same for a page that repeats: patches of regular drawings that are out of step are seen at once.
const CHANGE_REGULAR: f64 = 0.04;
/// Distance of ways from given samples to their sources that count as one, in sample distances, and most ways that are
/// tried for a patch.
const SAME: f64 = 0.6;
const COMMON: usize = 4;
/// Most pairs of samples that are compared for one place: in a crowd only some samples are.
const MOST_COMPARED: usize = 400_000;
/// Most samples that are remembered as alike, some 64 MB.
const MOST_KNOWN: usize = 1 << 24;

/// Samples near a patch that are there already.
struct Rim {
    /// Place, source.
    samples: Vec<([f64; 2], u32)>,
    /// How many of them, the first ones, are given.
    given: usize,
    index: PointIndex,
}

/// Scatters as many samples as the exemplar has, from random places, without edges, beside those there are.
pub(crate) fn noise(
    input: &CurveInput,
    mut output: CurveOutput,
    seed: u64,
    given: Option<&GivenLines>,
) -> CurveOutput {
    let plane = output.plane;
    let mut random = stream(seed, "curves/noise", 0);
    let real: Vec<u32> = (0..input.len() as u32).filter(|i| !input.graph.open[*i as usize]).collect();
    if real.is_empty() {
        return output;
    }
    let count = real.len() as f64 * plane.area() / input.graph.plane.area();
    for _ in 0..libm::round(count) as usize {
        let at = [random.range(0.0, plane.size[0]), random.range(0.0, plane.size[1])];
        let source = real[random.index(real.len())];
        if is_made(input, at, given) {
            output.push(at, source, input);
        }
    }
    output
}

/// Whether a sample may be made at a place.
fn is_made(input: &CurveInput, at: [f64; 2], given: Option<&GivenLines>) -> bool {
    given.is_none_or(|given| given.is_free(at) && !given.is_on_line(at, ON_LINE * input.scale.distance))
}

/// Fills a canvas with patches beside the samples there are. `variation`, 0 to 1, says how readily patches come from
/// elsewhere; with 0 the exemplar goes on as it is wherever it can.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn patches(
    input: &CurveInput,
    output: CurveOutput,
    (variation, seed): (f64, u64),
    given: Option<&GivenLines>,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<CurveOutput> {
    let change = variation * if input.graph.plane.wraps == [true; 2] { CHANGE_REGULAR } else { CHANGE };
    let side = 2.0 * input.scale.radius;
    let rule = PatchRule { change, tried: TRIED, is_elsewhere: false, side, seed };
    let (mut output, patches) = laid(input, output, rule, given, go_on)?;
    join(&mut output, &patches, input);
    Ok(output)
}

/// How patches are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatchRule {
    /// Mean misfit, in sample distances, up to which a patch may come from elsewhere although the exemplar could go on.
    pub(crate) change: f64,
    /// Places tried for a patch, besides those that go on from its neighbours.
    pub(crate) tried: usize,
    /// Whether the exemplar as it goes on, a period away, is no other place.
    pub(crate) is_elsewhere: bool,
    /// Longest side of a patch.
    pub(crate) side: f64,
    pub(crate) seed: u64,
}

/// Patches side by side, and their samples beside those there are, not joined across the borders.
///
/// # Errors
/// Those of `go_on`.
pub(crate) fn laid(
    input: &CurveInput,
    mut output: CurveOutput,
    rule: PatchRule,
    given: Option<&GivenLines>,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<(CurveOutput, Vec<Patch>)> {
    let (page, plane) = (input.graph.plane, output.plane);
    let most = [0, 1].map(|k| if page.wraps[k] { 0.45 } else { 0.6 } * page.size[k]);
    let count = [0, 1].map(|k| libm::ceil(plane.size[k] / rule.side.min(most[k])).max(1.0) as usize);
    let size = [0, 1].map(|k| plane.size[k] / count[k] as f64);
    let mut alike = AlikeSamples { input, known: BTreeMap::new() };
    let mut patches: Vec<Patch> = Vec::with_capacity(count[0] * count[1]);
    for j in 0..count[1] {
        for i in 0..count[0] {
            let low = [i as f64 * size[0], j as f64 * size[1]];
            patches.push(Patch { low, size, offset: None, samples: Vec::new() });
        }
    }
    for p in order(&patches, &output) {
        go_on()?;
        let [i, j] = [p % count[0], p / count[0]];
        let mut beside: Vec<usize> = Vec::new();
        for (dx, dy) in [(-1, 0), (0, -1), (1, 0), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)] {
            let at = |v: usize, d: i64, k: usize| {
                let (v, n) = (v as i64 + d, count[k] as i64);
                (plane.wraps[k] || (0..n).contains(&v)).then(|| v.rem_euclid(n) as usize)
            };
            let (Some(row), Some(column)) = (at(j, dy, 1), at(i, dx, 0)) else { continue };
            let other = row * count[0] + column;
            if other != p && patches[other].offset.is_some() && !beside.contains(&other) {
                beside.push(other);
            }
        }
        let rim = rim(&output, &patches, (p, &beside), input);
        let copied = given.and_then(|lines| lines.copied).filter(|way| fits(page, &patches[p], *way));
        let mut going_on: Vec<[f64; 2]> = beside.iter().filter_map(|b| patches[*b].offset).collect();
        going_on.extend(common_offsets(input, &output, &patches[p]));
        let mut random = stream(rule.seed, "curves/patches", p as u64);
        let known = given.map(|lines| KnownPlaces { lines, patches: &patches, count, size });
        let around = PatchSurroundings { patch: &patches[p], rim: &rim, plane, known };
        let chosen = || choose(&mut alike, &around, &going_on, (rule, &mut random));
        let offset = copied.unwrap_or_else(chosen);
        let patch = &mut patches[p];
        patch.offset = Some(offset);
        for (at, source) in within(input, patch, offset, 0.0) {
            if !is_made(input, at, given) {
                continue;
            }
            let sample = output.push(at, source, input);
            patch.samples.push((source, sample));
        }
        patch.samples.sort_unstable();
    }
    Ok((output, patches))
}

/// The order in which patches are laid: from one end to the other, or by their distances from given samples.
fn order(patches: &[Patch], output: &CurveOutput) -> Vec<usize> {
    let mut order: Vec<usize> = (0..patches.len()).collect();
    let given = &output.points[..output.given()];
    if given.is_empty() {
        return order;
    }
    let far = |patch: &Patch| {
        let middle = patch.middle();
        let apart = given.iter().map(|p| length(output.plane.between(middle, *p)));
        apart.fold(f64::INFINITY, f64::min)
    };
    let far = parallel::map(patches, far);
    order.sort_by(|a, b| far[*a].total_cmp(&far[*b]).then(a.cmp(b)));
    order
}

/// The commonest ways from given samples around a patch to their sources.
fn common_offsets(input: &CurveInput, output: &CurveOutput, patch: &Patch) -> Vec<[f64; 2]> {
    let page = input.graph.plane;
    // Each way with the samples that have about the same.
    let mut found: Vec<([f64; 2], Vec<usize>)> = Vec::new();
    let offset = |s: usize| {
        let (at, to) = (output.points[s], input.graph.points[output.source[s] as usize]);
        [to[0] - at[0], to[1] - at[1]]
    };
    for s in 0..output.given() {
        if depth(patch, output.plane, output.points[s]) > BAND * input.scale.radius {
            continue;
        }
        let own = offset(s);
        match found.iter_mut().find(|f| length(page.between(f.0, own)) < SAME * input.scale.distance) {
            Some(known) => known.1.push(s),
            None => found.push((own, vec![s])),
        }
    }
    found.sort_by_key(|f| std::cmp::Reverse(f.1.len()));
    found.truncate(COMMON);
    // Samples stand anywhere along their curves, so only the way across the curves counts: the mean way solves normal
    // equations of a symmetric matrix.
    let exact = |(about, samples): ([f64; 2], Vec<usize>)| {
        let (mut xx, mut xy, mut yy, mut right) = (1e-3, 0.0, 1e-3, [0.0; 2]);
        for s in samples {
            let [x, y] = page.between(about, offset(s));
            let along = match input.graph.leaving[output.source[s] as usize][..] {
                [first, _] => input.graph.tangent(first),
                _ => [0.0; 2],
            };
            // The projection across the curve.
            let across = [1.0 - along[0] * along[0], -along[0] * along[1], 1.0 - along[1] * along[1]];
            (xx, xy, yy) = (xx + across[0], xy + across[1], yy + across[2]);
            right[0] += across[0] * x + across[1] * y;
            right[1] += across[1] * x + across[2] * y;
        }
        let size = xx * yy - xy * xy;
        let more = [right[0] * yy - right[1] * xy, right[1] * xx - right[0] * xy].map(|v| v / size);
        [about[0] + more[0], about[1] + more[1]]
    };
    found.into_iter().map(exact).collect()
}

/// The exemplar's samples in a patch and up to `band` around it, at their places on the canvas.
fn within(input: &CurveInput, patch: &Patch, offset: [f64; 2], band: f64) -> Vec<([f64; 2], u32)> {
    let half = patch.size.map(|s| 0.5 * s + band);
    let middle = patch.middle();
    let mut found = Vec::new();
    let centre = [middle[0] + offset[0], middle[1] + offset[1]];
    input.index.within(centre, length(half), |i, way| {
        let inside = (0..2).all(|k| -half[k] <= way[k] && way[k] < half[k]);
        if inside && !input.graph.open[i] {
            found.push(([middle[0] + way[0], middle[1] + way[1]], i as u32));
        }
    });
    found.sort_unstable_by_key(|f| f.1);
    found
}

/// The samples of the patches beside a patch, and those given around and in it.
fn rim(output: &CurveOutput, patches: &[Patch], (p, beside): (usize, &[usize]), input: &CurveInput) -> Rim {
    let mut samples = Vec::new();
    for s in 0..output.given() {
        if depth(&patches[p], output.plane, output.points[s]) < 2.0 * input.scale.radius {
            samples.push((output.points[s], output.source[s]));
        }
    }
    let given = samples.len();
    for b in beside {
        for (source, sample) in &patches[*b].samples {
            samples.push((output.points[*sample as usize], *source));
        }
    }
    let places: Vec<[f64; 2]> = samples.iter().map(|s| s.0).collect();
    // A rim is small beside the canvas: wide cells are soon made.
    Rim { index: PointIndex::new(output.plane, 2.0 * input.scale.radius, &places), samples, given }
}

/// What a patch must fit to.
struct PatchSurroundings<'a> {
    patch: &'a Patch,
    rim: &'a Rim,
    plane: PeriodicPlane,
    /// The places beside given lines at which it is known what is there.
    known: Option<KnownPlaces<'a>>,
}

/// The places where patches are, and those where only given lines are.
#[derive(Clone, Copy)]
struct KnownPlaces<'a> {
    lines: &'a GivenLines,
    patches: &'a [Patch],
    count: [usize; 2],
    size: [f64; 2],
}

impl KnownPlaces<'_> {
    /// Whether it is known what is at a place.
    fn hold(&self, at: [f64; 2]) -> bool {
        if !self.lines.is_free(at) {
            return self.lines.window.is_on_canvas(at, 0.0);
        }
        let [i, j] = [0, 1].map(|k| ((at[k] / self.size[k]) as usize).min(self.count[k] - 1));
        self.patches[j * self.count[0] + i].offset.is_some()
    }
}

/// Whether a page holds what a patch would copy. One that repeats always does.
fn fits(page: PeriodicPlane, patch: &Patch, offset: [f64; 2]) -> bool {
    (0..2).all(|k| {
        let low = patch.low[k] + offset[k];
        page.wraps[k] || low >= -1e-6 && low + patch.size[k] <= page.size[k] + 1e-6
    })
}

/// The way from the canvas to the exemplar for a patch.
fn choose(
    alike: &mut AlikeSamples<'_>,
    around: &PatchSurroundings<'_>,
    going_on: &[[f64; 2]],
    (rule, random): (PatchRule, &mut Stream),
) -> [f64; 2] {
    let &PatchSurroundings { patch, rim, plane, .. } = around;
    let input = alike.input;
    let page = input.graph.plane;
    let near: Vec<usize> = (0..rim.samples.len())
        .filter(|n| depth(patch, plane, rim.samples[*n].0) < BAND * input.scale.radius)
        .collect();
    let mut tried: Vec<[f64; 2]> = going_on.iter().copied().filter(|way| fits(page, patch, *way)).collect();
    let known = tried.len();
    for _ in 0..8 * rule.tried {
        if tried.len() >= known + rule.tried {
            break;
        }
        let offset = if near.is_empty() {
            let at = [0, 1].map(|k| {
                let room = if page.wraps[k] { page.size[k] } else { page.size[k] - patch.size[k] };
                random.range(0.0, room.max(1e-9))
            });
            [at[0] - patch.low[0], at[1] - patch.low[1]]
        } else {
            // A curve of the exemplar on a curve beside the patch.
            let (at, source) = rim.samples[near[random.index(near.len())]];
            let like = alike.to(source);
            // Nothing may stand for a given line at the border of a page.
            let Some(to) = like.get(random.index(like.len())) else { continue };
            let to = input.graph.points[*to as usize];
            let middle = patch.middle();
            let way = plane.between(middle, at);
            [0, 1].map(|k| to[k] - (middle[k] + way[k]))
        };
        let goes_on = |way: &[f64; 2]| length(input.graph.page.between(*way, offset)) < input.scale.distance;
        if fits(page, patch, offset) && !(rule.is_elsewhere && tried[..known].iter().any(goes_on)) {
            tried.push(offset);
        }
    }
    let costs = parallel::map(&tried, |offset| misfit(input, around, *offset, &near));
    let best = |range: std::ops::Range<usize>| range.min_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    match (best(0..known), best(known..tried.len())) {
        (Some(on), Some(other)) if costs[other] < costs[on] || costs[other] <= rule.change => tried[other],
        (Some(on), _) => tried[on],
        (None, Some(other)) => tried[other],
        (None, None) => [0, 1]
            .map(|k| if page.wraps[k] { 0.0 } else { 0.5 * (page.size[k] - patch.size[k]) - patch.low[k] }),
    }
}

/// How far a place is outside a patch.
fn depth(patch: &Patch, plane: PeriodicPlane, at: [f64; 2]) -> f64 {
    let way = plane.between(patch.middle(), at);
    (0..2).map(|k| way[k].abs() - 0.5 * patch.size[k]).fold(f64::MIN, f64::max)
}

/// Samples of the exemplar that are alike.
struct AlikeSamples<'a> {
    input: &'a CurveInput,
    known: BTreeMap<u32, Vec<u32>>,
}

impl AlikeSamples<'_> {
    /// The samples that may stand where a sample does.
    fn to(&mut self, source: u32) -> &[u32] {
        let input = self.input;
        if self.known.len() * input.len() > MOST_KNOWN {
            self.known.clear();
        }
        self.known.entry(source).or_insert_with(|| {
            let may_stand = |i: &u32| !input.graph.open[*i as usize] && alike(input, source, *i);
            (0..input.len() as u32).filter(may_stand).collect()
        })
    }
}

/// Whether two samples of the exemplar have edges in about the same directions.
fn alike(input: &CurveInput, a: u32, b: u32) -> bool {
    let [m, n] = [&input.graph.leaving[a as usize], &input.graph.leaving[b as usize]];
    if m.is_empty() || n.is_empty() {
        return input.style[a as usize] == input.style[b as usize];
    }
    a == b
        || m.len() == n.len()
            && m.iter().all(|h| {
                let own = input.graph.tangent(*h);
                n.iter().any(|g| {
                    let other = input.graph.tangent(*g);
                    own[0] * other[0] + own[1] * other[1] > ALIGNED
                        && input.graph.edge(*h).style == input.graph.edge(*g).style
                })
            })
}

/// Mean misfit of a patch to what is there, in sample distances: how far the exemplar's samples around the patch, and
/// in it where nothing is made, are from the curves there, and the other way round.
fn misfit(input: &CurveInput, around: &PatchSurroundings<'_>, offset: [f64; 2], near: &[usize]) -> f64 {
    let &PatchSurroundings { patch, rim, plane, known } = around;
    let (delta, band) = (input.scale.distance, BAND * input.scale.radius);
    let page = input.graph.plane;
    // Samples of which it is not known yet whether they fit come last: only given ones are compared with them.
    let (mut expected, own): (Vec<([f64; 2], u32)>, Vec<_>) = within(input, patch, offset, band)
        .into_iter()
        .partition(|e| known.map_or(depth(patch, plane, e.0) > 0.0, |known| known.hold(e.0)));
    let outer = expected.len();
    if known.is_some() {
        expected.extend(own);
    }
    let places: Vec<[f64; 2]> = expected.iter().map(|e| plane.wrapped(e.0)).collect();
    let apart = |own: u32, other: u32, way: [f64; 2]| {
        let mut cost: f64 = 1.0;
        if [own, other].iter().any(|s| input.graph.leaving[*s as usize].is_empty()) {
            let like = input.style[own as usize] == input.style[other as usize];
            return if like { cost.min(length(way) / delta) } else { cost };
        }
        let along = input.graph.leaving[own as usize].first().map_or([0.0; 2], |h| input.graph.tangent(*h));
        let forth = (along[0] * way[0] + along[1] * way[1]).abs();
        let across = (along[0] * way[1] - along[1] * way[0]).abs();
        let far = (across + ALONG * forth) / delta;
        let like = input.style[own as usize] == input.style[other as usize];
        let turn = input.graph.leaving[other as usize].iter().map(|h| {
            let there = input.graph.tangent(*h);
            (along[0] * there[1] - along[1] * there[0]).abs()
        });
        let turn = turn.fold(1.0, f64::min);
        let degrees =
            if input.ways[own as usize].len() == input.ways[other as usize].len() { 0.0 } else { 0.2 };
        if like {
            cost = cost.min(far + turn + degrees);
        }
        cost
    };
    let (mut sum, mut count) = (0.0, 0.0f64);
    let step = (near.len() * expected.len()).div_ceil(MOST_COMPARED).max(1);
    for (at, source) in expected[..outer].iter().step_by(step) {
        // Where no neighbour is yet, nothing is expected of it.
        let mut best: Option<f64> = None;
        rim.index.within(*at, delta, |n, way| {
            let cost = apart(*source, rim.samples[n].1, way);
            best = Some(best.map_or(cost, |b: f64| b.min(cost)));
        });
        if known.is_some() || best.is_some() || rim.index.any(*at, 2.0 * input.scale.radius) {
            sum += best.unwrap_or(1.0);
            count += 1.0;
        }
    }
    for &n in near.iter().step_by(step) {
        let (at, source) = rim.samples[n];
        let there = {
            let middle = patch.middle();
            let way = plane.between(middle, at);
            [0, 1].map(|k| middle[k] + way[k] + offset[k])
        };
        if (0..2).any(|k| !page.wraps[k] && !(0.0..page.size[k]).contains(&there[k])) {
            continue;
        }
        let mut best: f64 = 1.0;
        let compared = if n < rim.given { expected.len() } else { outer };
        for (place, (_, other)) in places.iter().zip(&expected).take(compared) {
            let way = plane.between(at, *place);
            if way[0] * way[0] + way[1] * way[1] < delta * delta {
                best = best.min(apart(source, *other, way));
            }
        }
        sum += best;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
