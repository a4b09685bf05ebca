//! Existence of samples: those that most neighbourhoods leave alone are removed, those that most miss are added
//! (§2.4.3.4 and algorithm 1).

use crate::input::CurveInput;
use crate::output::CurveOutput;
use crate::search::CurveMatches;
use vtex_base::geometry::plane::{PointIndex, length};
use vtex_base::parallel;

/// Share of the neighbourhoods that decide.
const MAJORITY: f64 = 0.5;

/// Says which samples stay, and which are missing: their places and their samples of the exemplar.
pub(crate) fn improve_existence(
    output: &CurveOutput,
    input: &CurveInput,
    matches: &CurveMatches,
) -> (Vec<bool>, Vec<([f64; 2], u32)>) {
    let mut held = vec![0u32; matches.near.len()];
    let mut wanted = vec![0u32; matches.near.len()];
    for s in 0..matches.near.len() {
        for k in matches.near.range(s) {
            let other = matches.near.ids[k] as usize;
            held[other] += 1;
            wanted[other] += u32::from(matches.matched[k] != u32::MAX);
        }
    }
    let keep = held.iter().zip(&wanted).map(|(h, w)| f64::from(*w) >= MAJORITY * f64::from(*h)).collect();
    (keep, missing(output, input, matches))
}

/// The samples that most neighbourhoods around a place miss.
fn missing(output: &CurveOutput, input: &CurveInput, matches: &CurveMatches) -> Vec<([f64; 2], u32)> {
    let delta = input.scale.distance;
    let rim = input.scale.radius - 0.5 * delta;
    let all: Vec<usize> = (0..matches.near.len()).collect();
    let of_neighbourhood = |&s: &usize| -> Vec<([f64; 2], u32)> {
        let (own, centre) = (matches.near.range(s), output.points[s]);
        let there = input.near.range(output.source[s] as usize);
        let inner = there.take_while(|k| length(input.near.ways[*k]) < rim);
        inner
            .filter(|k| {
                let i = input.near.ids[*k];
                !input.graph.open[i as usize] && !matches.matched[own.clone()].contains(&i)
            })
            .map(|k| {
                let way = input.near.ways[k];
                ([centre[0] + way[0], centre[1] + way[1]], input.near.ids[k])
            })
            .collect()
    };
    let found: Vec<([f64; 2], u32)> = parallel::map(&all, of_neighbourhood).into_iter().flatten().collect();
    if found.is_empty() {
        return found;
    }
    let places: Vec<[f64; 2]> = found.iter().map(|m| m.0).collect();
    let index = PointIndex::new(output.plane, 0.5 * delta, &places);
    let standing = PointIndex::new(output.plane, rim, &output.points);
    let alike = |a: usize, style: u32| input.style[found[a].1 as usize] == style;
    let together = |m: usize| {
        let mut group = Vec::new();
        let style = input.style[found[m].1 as usize];
        index.within(places[m], 0.5 * delta, |k, way| {
            if alike(k, style) {
                group.push((k, way));
            }
        });
        group.sort_by_key(|g| g.0);
        group
    };
    let counted: Vec<usize> = (0..found.len()).collect();
    let counts = parallel::map(&counted, |&m| together(m).len());
    let mut order = counted;
    order.sort_by_key(|&m| (std::cmp::Reverse(counts[m]), m));
    let mut taken = vec![false; found.len()];
    let mut added: Vec<([f64; 2], u32)> = Vec::new();
    for m in order {
        if taken[m] {
            continue;
        }
        let group = together(m);
        group.iter().for_each(|g| taken[g.0] = true);
        let style = input.style[found[m].1 as usize];
        let (mut around, mut occupied) = (0u32, false);
        standing.within(places[m], rim, |s, way| {
            around += 1;
            occupied |= length(way) < 0.5 * delta && output.style[s] == style;
        });
        let close = |(at, source): &([f64; 2], u32)| {
            input.style[*source as usize] == style
                && length(output.plane.between(*at, places[m])) < 0.7 * delta
        };
        if occupied || (group.len() as f64) <= MAJORITY * f64::from(around) || added.iter().any(close) {
            continue;
        }
        let part = 1.0 / group.len() as f64;
        let off = group.iter().fold([0.0; 2], |sum, (_, w)| [sum[0] + part * w[0], sum[1] + part * w[1]]);
        added.push(([places[m][0] + off[0], places[m][1] + off[1]], found[m].1));
    }
    added
}
