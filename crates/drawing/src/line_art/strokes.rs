//! Centre lines as strokes that run on through junctions, each with its width and colour.

use super::ink::InkOfPicture;
use image::RgbImage;
use std::collections::BTreeMap;
use vtex_base::disjoint_sets::DisjointSets;
use vtex_base::error::Result;
use vtex_base::geometry::plane::{along, length};
use vtex_base::raster::colour::{self, Colour, oklab, squared_distance};
use vtex_base::raster::{Ink, centre_lines, squared_distance as squared_distances};

/// How far beyond the page lines are led, in cells.
const RIM: usize = 32;
/// Length over which the direction at an end is taken, in widths.
const ENDING: f64 = 2.0;
/// Longest piece between two junctions that are one crossing, in widths.
const ONE_CROSSING: f64 = 1.6;
/// Cosine of the largest turn with which a stroke runs on through a junction: 40°.
const RUNS_ON: f64 = 0.766;
/// Largest ratio of the widths of lines that are one stroke.
const SAME_WIDTH: f64 = 1.7;
/// Shortest stroke, in widths. What is shorter is a dot.
const SHORTEST: f64 = 1.0;
/// Ratio from one width to the next that is told apart.
const WIDTH_STEP: f64 = 1.35;
/// Least difference of colours that are told apart, in Oklab.
const COLOUR_STEP: f32 = 0.15;

/// A stroke of a picture, in pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PictureStroke {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) closed: bool,
    pub(super) width: f64,
    pub(super) colour: Colour,
}

/// The strokes of a picture.
///
/// # Errors
/// Those of `go_on`.
pub(super) fn strokes(
    image: &RgbImage,
    ink: &InkOfPicture,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Vec<PictureStroke>> {
    let (lines, width) = centre_lines(&ink.cells, RIM, go_on)?;
    let fine = ink.fine as f64;
    let distances = distance_to_paper(&ink.cells);
    go_on()?;
    let lines = lines.into_iter().filter(|l| l.0.len() > 1);
    let measured = lines.map(|(points, closed)| {
        let wide = width_of(&points, &distances, ink.cells.size).unwrap_or(width);
        LinePiece { points, closed, width: wide }
    });
    let joined = joined(measured.collect(), width);
    go_on()?;
    let stroke = |piece: LinePiece| {
        let points: Vec<[f64; 2]> = piece.points.iter().map(|p| p.map(|v| v / fine)).collect();
        let colour = colour_of(&points, image, &ink.difference);
        PictureStroke { points, closed: piece.closed, width: piece.width / fine, colour }
    };
    let mut strokes: Vec<PictureStroke> = joined.into_iter().map(stroke).collect();
    strokes.retain(|s| along(&s.points) >= SHORTEST * s.width);
    even_out(&mut strokes);
    Ok(strokes)
}

/// A line or part of one, in cells.
#[derive(Clone)]
struct LinePiece {
    points: Vec<[f64; 2]>,
    closed: bool,
    width: f64,
}

/// Distance of each cell to the paper, squared. Beyond the page there is none.
fn distance_to_paper(cells: &Ink) -> Vec<f32> {
    squared_distances(cells.size[0], cells.size[1], |i| !cells.cells[i])
}

/// The median width along a line, on the page.
fn width_of(points: &[[f64; 2]], distances: &[f32], size: [usize; 2]) -> Option<f64> {
    let at = |p: &[f64; 2]| {
        let [x, y] = p.map(libm::floor);
        let on_page = (0.0..size[0] as f64).contains(&x) && (0.0..size[1] as f64).contains(&y);
        on_page.then(|| distances[y as usize * size[0] + x as usize])
    };
    let mut found: Vec<f32> = points.iter().filter_map(at).filter(|d| d.is_finite() && *d > 0.0).collect();
    let middle = found.len() / 2;
    (!found.is_empty()).then(|| {
        let median = *found.select_nth_unstable_by(middle, f32::total_cmp).1;
        // Distances are between middles of cells: the first cell of the paper lies half a cell beyond the border.
        2.0 * libm::sqrt(f64::from(median)) - 1.0
    })
}

/// The median colour of the darkest half of the pixels along a line, which are least mixed with paper.
fn colour_of(points: &[[f64; 2]], image: &RgbImage, difference: &[f32]) -> Colour {
    let (width, height) = image.dimensions();
    let pixel = |p: &[f64; 2]| {
        let [x, y] = p.map(libm::floor);
        let on_page = x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(height);
        on_page.then_some((x as u32, y as u32))
    };
    let mut pixels: Vec<(u32, u32)> = points.iter().filter_map(pixel).collect();
    pixels.dedup();
    pixels.sort_by(|a, b| {
        let [a, b] = [a, b].map(|p| difference[p.1 as usize * width as usize + p.0 as usize]);
        b.total_cmp(&a)
    });
    pixels.truncate(pixels.len().div_ceil(2));
    colour::median(pixels.iter().map(|p| image.get_pixel(p.0, p.1).0)).unwrap_or(Colour([0; 3]))
}

/// An end of a piece: its number, and whether it is the last point.
type PieceEnd = (usize, bool);

/// Pieces that run on into one another as one, so that a pen is lifted rarely. `width` is the usual one of lines.
fn joined(mut pieces: Vec<LinePiece>, width: f64) -> Vec<LinePiece> {
    let nodes = nodes(&mut pieces, ONE_CROSSING * width);
    let reach = ENDING * width;
    let mut next: BTreeMap<PieceEnd, PieceEnd> = BTreeMap::new();
    for ends in nodes {
        let ways: Vec<[f64; 2]> = ends.iter().map(|e| inward(&pieces[e.0], e.1, reach)).collect();
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for a in 0..ends.len() {
            for b in a + 1..ends.len() {
                // 1 where one goes straight on in the other.
                let straight = -(ways[a][0] * ways[b][0] + ways[a][1] * ways[b][1]);
                let [wide, thin] = [ends[a], ends[b]].map(|e| pieces[e.0].width);
                let alike = wide.max(thin) <= SAME_WIDTH * wide.min(thin);
                if ends.len() == 2 || straight >= RUNS_ON && alike {
                    pairs.push((straight, a, b));
                }
            }
        }
        pairs.sort_by(|x, y| y.0.total_cmp(&x.0));
        for (_, a, b) in pairs {
            if !next.contains_key(&ends[a]) && !next.contains_key(&ends[b]) {
                next.insert(ends[a], ends[b]);
                next.insert(ends[b], ends[a]);
            }
        }
    }
    let mut done = vec![false; pieces.len()];
    let mut all = Vec::new();
    // Pieces with a free end first; those left are rings.
    for rings in [false, true] {
        for k in 0..pieces.len() {
            if done[k] {
                continue;
            }
            let free = [false, true].into_iter().find(|last| !next.contains_key(&(k, *last)));
            if pieces[k].closed {
                done[k] = true;
                all.push(pieces[k].clone());
            } else if rings || free.is_some() {
                all.push(run(&pieces, &next, (k, free.unwrap_or(false)), (width, &mut done)));
            }
        }
    }
    all
}

/// The ends of pieces that meet, place by place. Pieces between two junctions that are shorter than `least` are taken
/// away: lines that cross at a slant meet at two places.
fn nodes(pieces: &mut Vec<LinePiece>, least: f64) -> Vec<Vec<PieceEnd>> {
    let key = |p: [f64; 2]| p.map(|v| libm::round(64.0 * v) as i64);
    let ends = |piece: &LinePiece| [0, piece.points.len() - 1].map(|k| key(piece.points[k]));
    let mut counts: BTreeMap<[i64; 2], usize> = BTreeMap::new();
    pieces.iter().filter(|p| !p.closed).flat_map(ends).for_each(|e| *counts.entry(e).or_default() += 1);
    let number: BTreeMap<[i64; 2], usize> = counts.keys().copied().zip(0..).collect();
    let mut sets = DisjointSets::new(number.len());
    pieces.retain(|piece| {
        let [a, b] = ends(piece);
        let is_inner =
            !piece.closed && counts[&a] > 2 && counts[&b] > 2 && a != b && along(&piece.points) < least;
        if is_inner {
            sets.join(number[&a], number[&b]);
        }
        !is_inner
    });
    let mut nodes: BTreeMap<usize, Vec<PieceEnd>> = BTreeMap::new();
    for (k, piece) in pieces.iter().enumerate().filter(|p| !p.1.closed) {
        for (end, last) in ends(piece).into_iter().zip([false, true]) {
            nodes.entry(sets.root(number[&end])).or_default().push((k, last));
        }
    }
    nodes.into_values().collect()
}

/// The pieces that follow from an end on, as one. Where two do not meet exactly, a width of each is left out.
fn run(
    pieces: &[LinePiece],
    next: &BTreeMap<PieceEnd, PieceEnd>,
    from: PieceEnd,
    (width, done): (f64, &mut [bool]),
) -> LinePiece {
    let (mut points, mut area, mut total): (Vec<[f64; 2]>, f64, f64) = (Vec::new(), 0.0, 0.0);
    let mut end = from;
    let closed = loop {
        let piece = &pieces[end.0];
        done[end.0] = true;
        let long = along(&piece.points).max(1e-9);
        (area, total) = (area + long * piece.width, total + long);
        let mut own = piece.points.clone();
        if end.1 {
            own.reverse();
        }
        match points.last() {
            Some(last) if length([own[0][0] - last[0], own[0][1] - last[1]]) > 0.5 => {
                points.reverse();
                shorten(&mut points, width);
                points.reverse();
                shorten(&mut own, width);
            }
            _ => _ = points.pop(),
        }
        points.append(&mut own);
        match next.get(&(end.0, !end.1)) {
            Some(on) if *on == from => break true,
            Some(on) if !done[on.0] => end = *on,
            _ => break false,
        }
    };
    LinePiece { points, closed, width: area / total }
}

/// Leaves out the beginning of a course, but for its last two points.
fn shorten(course: &mut Vec<[f64; 2]>, by: f64) {
    let first = course[0];
    let far = course.iter().position(|p| length([p[0] - first[0], p[1] - first[1]]) >= by);
    course.drain(..far.unwrap_or(course.len()).min(course.len().saturating_sub(2)));
}

/// The direction from an end into a piece, of length 1.
fn inward(piece: &LinePiece, last: bool, reach: f64) -> [f64; 2] {
    let n = piece.points.len();
    let at = |k: usize| piece.points[if last { n - 1 - k } else { k }];
    let from = at(0);
    let way = |k: usize| [at(k)[0] - from[0], at(k)[1] - from[1]];
    let far = (1..n).find(|k| length(way(*k)) >= reach).unwrap_or(n - 1);
    let (way, size) = (way(far), length(way(far)));
    if size > 0.0 { way.map(|v| v / size) } else { [0.0; 2] }
}

/// Gives strokes of about the same width the same, and those of about the same colour the same: means by length.
fn even_out(strokes: &mut [PictureStroke]) {
    let lengths: Vec<f64> = strokes.iter().map(|s| along(&s.points).max(1e-9)).collect();
    let total: f64 = lengths.iter().sum();
    let mean = strokes.iter().zip(&lengths).map(|(s, l)| l * s.width).sum::<f64>() / total.max(1e-9);
    let step = |width: f64| {
        let steps = libm::log(width.max(1e-3) / mean.max(1e-3)) / libm::log(WIDTH_STEP);
        libm::round(steps) as i64
    };
    let mut classes: BTreeMap<i64, [f64; 2]> = BTreeMap::new();
    for (stroke, long) in strokes.iter().zip(&lengths) {
        let class = classes.entry(step(stroke.width)).or_default();
        *class = [class[0] + long * stroke.width, class[1] + long];
    }
    for stroke in strokes.iter_mut() {
        let [sum, weight] = classes[&step(stroke.width)];
        stroke.width = sum / weight;
    }
    // The colours of the longest strokes are those that others are like.
    let mut order: Vec<usize> = (0..strokes.len()).collect();
    order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]));
    let mut leaders: Vec<([f32; 3], Vec<usize>)> = Vec::new();
    for k in order {
        let own = oklab(strokes[k].colour.0);
        let far = |leader: &[f32; 3]| squared_distance(*leader, own);
        let nearest = leaders.iter_mut().min_by(|a, b| far(&a.0).total_cmp(&far(&b.0)));
        match nearest {
            Some((leader, members)) if far(leader) < COLOUR_STEP * COLOUR_STEP => members.push(k),
            _ => leaders.push((own, vec![k])),
        }
    }
    for (_, members) in leaders {
        let weight: f64 = members.iter().map(|k| lengths[*k]).sum();
        let mut sum = [0.0; 3];
        for k in &members {
            let own = oklab(strokes[*k].colour.0);
            (0..3).for_each(|c| sum[c] += lengths[*k] / weight * f64::from(own[c]));
        }
        let colour = Colour::from_oklab(sum.map(|v| v as f32));
        members.iter().for_each(|k| strokes[*k].colour = colour);
    }
}
