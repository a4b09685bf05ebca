//! Ends that the exemplar does not have are joined, led to a curve beside them, or taken away.

use crate::input::CurveInput;
use crate::output::{CurveOutput, JoinedEdge, unit};
use vtex_base::geometry::plane::{PointIndex, length};

/// Rounds, and how far an end is joined to another in each, in sample distances.
const REACH: [f64; 4] = [1.8, 3.0, 4.5, 6.0];
/// Cosines of the largest angles between an end and the way to another: 40° each, or 70° for short ways.
const AHEAD: f64 = 0.766;
const AHEAD_NEAR: f64 = 0.342;
/// Largest bend of the joint in all, as a sum of two cosines short of two.
const BEND: f64 = 0.9;
/// How far an end is led to the side of a curve, in sample distances.
const ASIDE: f64 = 2.2;
/// Longest branch that is taken away, in sample distances.
const STUB: f64 = 8.0;
/// Share of the ends allowed, as against the exemplar's by length.
const ALLOWED: f64 = 1.0;

/// What was mended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurveMends {
    /// Pairs of ends joined.
    pub joined: usize,
    /// Ends led to a curve beside them.
    pub attached: usize,
    /// Samples of branches taken away.
    pub removed: usize,
}

/// A loose end: its sample and the direction in which the curve would go on.
struct LooseEnd {
    sample: u32,
    ahead: [f64; 2],
    style: u32,
}

/// The samples of one edge whose sources have more. Of given ones, those from which a curve goes on.
fn loose_ends(output: &CurveOutput, input: &CurveInput) -> Vec<LooseEnd> {
    let mut ends = Vec::new();
    for (s, at) in output.incident().iter().enumerate() {
        let source = output.source[s] as usize;
        let [only] = at[..] else { continue };
        if s < output.given() {
            let style = output.edges[only.0 as usize].style;
            ends.extend(output.ahead[s].map(|ahead| LooseEnd { sample: s as u32, ahead, style }));
            continue;
        }
        if input.graph.degree(source) > 1 || input.graph.open[source] {
            let back = unit(output.way(only));
            let style = output.edges[only.0 as usize].style;
            // Straight on, unless the source has a curve that does so more exactly.
            let like = input.graph.leaving[source].iter().map(|h| input.graph.tangent(*h));
            let on = like
                .map(|t| (-(t[0] * back[0] + t[1] * back[1]), t))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|t| t.0 > AHEAD);
            let ahead = on.map_or([-back[0], -back[1]], |t| t.1);
            ends.push(LooseEnd { sample: s as u32, ahead, style });
        }
    }
    ends
}

/// Mends loose ends, in a few rounds of growing reach.
pub(crate) fn mend(output: &mut CurveOutput, input: &CurveInput) -> CurveMends {
    let delta = input.scale.distance;
    let mut counts = CurveMends::default();
    remove_lonely(output, input, &mut counts);
    let has_sides = (0..input.len()).any(|i| input.graph.degree(i) == 3);
    for reach in REACH {
        counts.joined += join_ends(output, input, reach * delta);
    }
    if has_sides {
        counts.attached += attach(output, input, ASIDE * delta);
    }
    // A branch that is taken away may leave another end.
    for _ in 0..4 {
        let removed = remove_branches(output, input);
        counts.removed += removed;
        if removed == 0 {
            break;
        }
        counts.joined += join_ends(output, input, REACH[REACH.len() - 1] * delta);
    }
    output.improve_orientations(input);
    counts
}

/// Joins loose ends that face each other.
fn join_ends(output: &mut CurveOutput, input: &CurveInput, reach: f64) -> usize {
    let ends = loose_ends(output, input);
    let places: Vec<[f64; 2]> = ends.iter().map(|e| output.points[e.sample as usize]).collect();
    let index = PointIndex::new(output.plane, reach, &places);
    let near = 1.5 * input.scale.distance;
    let incident = output.incident();
    let mut pairs = Vec::new();
    for (a, own) in ends.iter().enumerate() {
        index.within(places[a], reach, |b, way| {
            let other = &ends[b];
            if b <= a || own.style != other.style {
                return;
            }
            let joined = incident[own.sample as usize]
                .iter()
                .any(|(e, d)| output.edges[*e as usize].ends[1 - d] == other.sample);
            let to = unit(way);
            let forth = own.ahead[0] * to[0] + own.ahead[1] * to[1];
            let back = -(other.ahead[0] * to[0] + other.ahead[1] * to[1]);
            let far = length(way);
            let least = if far < near { AHEAD_NEAR } else { AHEAD };
            // Ends that almost touch need not face each other.
            let faces = forth > least && back > least && 2.0 - forth - back < BEND || far < 0.3 * near;
            if faces && !joined {
                pairs.push((far * (1.0 + 2.0 - forth - back), a, b));
            }
        });
    }
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))));
    let mut taken = vec![false; ends.len()];
    let mut count = 0;
    for (_, a, b) in pairs {
        if !taken[a] && !taken[b] {
            (taken[a], taken[b]) = (true, true);
            let ends = [ends[a].sample, ends[b].sample];
            output.edges.push(JoinedEdge { ends, from: [None; 2], style: output.style[ends[0] as usize] });
            count += 1;
        }
    }
    output.improve_orientations(input);
    count
}

/// Leads loose ends to the nearest sample ahead, which becomes a junction.
fn attach(output: &mut CurveOutput, input: &CurveInput, reach: f64) -> usize {
    let index = PointIndex::new(output.plane, reach, &output.points);
    let incident = output.incident();
    let mut count = 0;
    for end in loose_ends(output, input) {
        let at = output.points[end.sample as usize];
        let mut best: Option<(f64, u32)> = None;
        index.within(at, reach, |t, way| {
            let to = unit(way);
            let forth = end.ahead[0] * to[0] + end.ahead[1] * to[1];
            let known = |of: usize| {
                incident[of].iter().any(|(e, d)| output.edges[*e as usize].ends[1 - d] == end.sample)
            };
            let degree = incident[t].len();
            let given = t.max(end.sample as usize) < output.given();
            let free = t != end.sample as usize && !known(t) && !given && (degree == 2 || degree == 1);
            let cost = length(way) * (2.0 - forth);
            if free && forth > AHEAD && best.is_none_or(|b| (cost, t as u32) < b) {
                best = Some((cost, t as u32));
            }
        });
        if let Some((_, t)) = best {
            output.edges.push(JoinedEdge { ends: [end.sample, t], from: [None; 2], style: end.style });
            count += 1;
        }
    }
    output.improve_orientations(input);
    count
}

/// Takes away samples without edges, unless the exemplar has such.
fn remove_lonely(output: &mut CurveOutput, input: &CurveInput, counts: &mut CurveMends) {
    let keep: Vec<bool> = output
        .incident()
        .iter()
        .enumerate()
        .map(|(s, at)| {
            s < output.given() || !at.is_empty() || input.graph.degree(output.source[s] as usize) == 0
        })
        .collect();
    counts.removed += keep.iter().filter(|k| !**k).count();
    output.retain(&keep);
}

/// Takes away short branches from loose ends to the next junction or end, the shortest first, where the exemplar has
/// fewer ends. Given curves, and those that go on from them, stay.
fn remove_branches(output: &mut CurveOutput, input: &CurveInput) -> usize {
    let delta = input.scale.distance;
    let incident = output.incident();
    let density = (0..input.len()).filter(|i| input.graph.degree(*i) == 1 && !input.graph.open[*i]).count()
        as f64
        / input.graph.length().max(1e-9);
    let made = output.given_edges as u32..output.edges.len() as u32;
    let total: f64 = made.map(|e| length(output.way((e, 0)))).sum();
    let now = incident.iter().skip(output.given()).filter(|at| at.len() == 1).count();
    let surplus = now.saturating_sub((ALLOWED * density * total) as usize);
    let mut branches = Vec::new();
    for end in loose_ends(output, input).into_iter().filter(|e| e.sample as usize >= output.given()) {
        let mut branch = vec![end.sample];
        let (mut at, mut walked) = (end.sample, 0.0);
        let mut before = u32::MAX;
        while let Some(&(e, d)) = incident[at as usize].iter().find(|(e, _)| *e != before) {
            walked += length(output.way((e, d)));
            at = output.edges[e as usize].ends[1 - d];
            before = e;
            if (at as usize) < output.given() {
                let goes_on = output.ahead(at).is_some();
                walked = if goes_on { f64::INFINITY } else { walked };
                break;
            }
            if incident[at as usize].len() > 2 || walked > STUB * delta {
                break;
            }
            branch.push(at);
        }
        if walked <= STUB * delta {
            branches.push((walked, branch));
        }
    }
    branches.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut keep = vec![true; output.len()];
    let mut count = 0;
    for (_, branch) in branches.into_iter().take(surplus) {
        for s in branch {
            count += usize::from(std::mem::replace(&mut keep[s as usize], false));
        }
    }
    output.retain(&keep);
    count
}
