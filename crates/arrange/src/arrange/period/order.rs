//! Order in a periodic drawing, which moved elements would destroy: common offsets, rows, bands, and lines of elements.

use std::collections::BTreeMap;
use vtex_base::geometry::{NearPoints, Point, Rect, Vec2, shortest_offset};
use vtex_scene::library::{CategoryId, ExemplarElement};

/// Least share of the elements of a regular drawing that have an element of similar size at one common offset.
const REGULAR: f64 = 0.75;
/// Largest difference of sizes and places in a regular order, as a share of the period.
const TOLERANCE: f64 = 0.02;

/// Whether the drawing is so regular that by default no element moves.
pub(super) fn is_regular(elements: &[ExemplarElement], bounds: &[Rect], size: [i32; 2]) -> bool {
    is_ruled(elements) || repeats(elements, bounds, size) || is_in_rows(elements, bounds, size)
}

/// Whether endless elements, which leave no room to move between them, make up more than a quarter of the area.
fn is_ruled(elements: &[ExemplarElement]) -> bool {
    let area = |e: &ExemplarElement| f64::from(e.area);
    let endless: f64 = elements.iter().filter(|e| e.clipped).map(area).sum();
    4.0 * endless > elements.iter().map(area).sum::<f64>()
}

/// Whether most elements have an element of similar size at one common offset.
fn repeats(elements: &[ExemplarElement], bounds: &[Rect], size: [i32; 2]) -> bool {
    let size = size.map(f64::from);
    let side = libm::sqrt(size[0] * size[1]);
    let same_size = |a: usize, b: usize| have_same_size(&bounds[a], &bounds[b], side) == [true; 2];
    let offset_of = |a: usize, b: usize| offset(&bounds[a], &bounds[b], size);
    let n = elements.len().min(400);
    // An offset that is common to most elements is also one between elements of the commonest size.
    let count = |a: usize| (0..n).filter(|&b| same_size(a, b)).count();
    let Some(first) = (0..n).max_by_key(|&a| (count(a), n - a)) else { return true };
    let offsets = (0..n).filter(|&b| b != first && same_size(first, b)).map(|b| offset_of(first, b)).take(60);
    let share_with_partner = |common: [f64; 2]| {
        let has_partner = |a: usize| {
            (0..n).any(|b| {
                let d = offset_of(a, b);
                let difference = [wrapped(d[0] - common[0], size[0]), wrapped(d[1] - common[1], size[1])];
                same_size(a, b) && difference.iter().all(|v| v.abs() <= TOLERANCE * side)
            })
        };
        (0..n).filter(|&a| has_partner(a)).count() as f64 / n as f64
    };
    let is_far = |o: &[f64; 2]| o[0].abs().max(o[1].abs()) > 0.05 * side;
    offsets.filter(is_far).any(|offset| share_with_partner(offset) >= REGULAR)
}

/// Elements of equal size across a row whose centres differ there by at most this share of the period lie in one row.
const IN_ROW: f64 = 0.005;
/// Least number of pairs of elements in rows, in numbers that chance makes, and how many of its deviations it is beyond.
const BEYOND_CHANCE: [f64; 2] = [2.0, 3.0];
/// Least share of elements that lie in a row with another.
const ROWED: f64 = 0.35;
/// Largest number of elements that are compared.
const COMPARED: usize = 1000;

/// Whether elements of equal height lie in rows, or those of equal width in columns, much more often than by chance,
/// whatever their places within these.
fn is_in_rows(elements: &[ExemplarElement], bounds: &[Rect], size: [i32; 2]) -> bool {
    let size = size.map(f64::from);
    let side = libm::sqrt(size[0] * size[1]);
    let whole = elements.iter().zip(bounds).filter(|(e, _)| !e.clipped).map(|(_, bounds)| bounds);
    let bounds: Vec<&Rect> = whole.take(COMPARED).collect();
    let mut pairs = [0.0; 2];
    let mut seen = [0.0; 2];
    let mut in_row = vec![[false; 2]; bounds.len()];
    for (a, one) in bounds.iter().enumerate() {
        for (b, other) in bounds[..a].iter().enumerate() {
            let near = offset(one, other, size).map(|d| d.abs() <= IN_ROW * side);
            // Those at one place are parts of one thing.
            if near == [true; 2] {
                continue;
            }
            let same = have_same_size(one, other, side);
            for k in (0..2).filter(|k| same[*k]) {
                pairs[k] += 1.0;
                if near[k] {
                    seen[k] += 1.0;
                    (in_row[a][k], in_row[b][k]) = (true, true);
                }
            }
        }
    }
    (0..2).any(|k| {
        let by_chance = pairs[k] * 2.0 * IN_ROW * side / size[k];
        let [times, deviations] = BEYOND_CHANCE;
        let rowed = in_row.iter().filter(|row| row[k]).count();
        seen[k] > 0.0
            && seen[k] >= times * by_chance
            && seen[k] >= by_chance + deviations * libm::sqrt(by_chance)
            && rowed as f64 >= ROWED * bounds.len() as f64
    })
}

/// Whether two bounds have the same width, and the same height.
fn have_same_size(a: &Rect, b: &Rect, side: f64) -> [bool; 2] {
    [a.width() - b.width(), a.height() - b.height()].map(|d| d.abs() <= TOLERANCE * side)
}

/// The way from the centre of bounds to that of others, on a page that repeats.
fn offset(a: &Rect, b: &Rect, size: [f64; 2]) -> [f64; 2] {
    let d = b.center() - a.center();
    [wrapped(d.x, size[0]), wrapped(d.y, size[1])]
}

fn wrapped(v: f64, size: f64) -> f64 {
    v - size * libm::round(v / size)
}

/// Mean number of elements in a band that is counted, and least and largest number of bands.
const IN_BAND: f64 = 5.0;
const BANDS: [usize; 2] = [6, 24];
/// Least deviation of the numbers in bands from their mean, as a share of it, and how many deviations of chance their
/// squares are beyond it.
const UNEVEN: [f64; 2] = [0.5, 5.0];

/// Whether every category is spread evenly along x, and along y: else elements that move across bands would blur them.
pub(super) fn is_even(elements: &[ExemplarElement], centres: &[Point], size: [i32; 2]) -> [bool; 2] {
    let members = members(elements);
    [0, 1].map(|axis| {
        let length = f64::from(size[axis]);
        let place = |k: &usize| [centres[*k].x, centres[*k].y][axis].rem_euclid(length) / length;
        !members.values().any(|members| is_banded(members.iter().map(place)))
    })
}

/// The elements of each category that are not endless.
fn members(elements: &[ExemplarElement]) -> BTreeMap<Option<CategoryId>, Vec<usize>> {
    let mut members: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (k, element) in elements.iter().enumerate().filter(|(_, element)| !element.clipped) {
        members.entry(element.category).or_default().push(k);
    }
    members
}

/// Whether places along an axis, 0 to 1, lie in bands: their numbers in equal intervals differ by much more than by
/// chance.
fn is_banded(places: impl ExactSizeIterator<Item = f64>) -> bool {
    let count = places.len() as f64;
    let bands = (count / IN_BAND) as usize;
    if bands < BANDS[0] {
        return false;
    }
    let mut numbers = vec![0.0; bands.min(BANDS[1])];
    let last = numbers.len() - 1;
    let per_place = numbers.len() as f64;
    places.for_each(|place| numbers[((place * per_place) as usize).min(last)] += 1.0);
    let mean = count / per_place;
    let squares: f64 = numbers.iter().map(|n| (n - mean) * (n - mean)).sum();
    let [share, deviations] = UNEVEN;
    // By chance, squares / mean is about the number of bands less 1, with a variance of twice that.
    let freedom = last as f64;
    squares >= (share * mean) * (share * mean) * per_place
        && squares / mean >= freedom + deviations * libm::sqrt(2.0 * freedom)
}

/// Least number of elements in a line.
const IN_LINE: usize = 6;
/// Largest distance of an element of a line from where the two before it point to, in steps of the line.
const OFF_LINE: f64 = 0.2;
/// Longest step of a line, in mean distances between elements of its category.
const STEP: f64 = 1.5;
/// Neighbours of an element to which lines are begun, the nearest ones, and most elements among which lines are sought.
const BEGUN: usize = 8;
const MOST_IN_LINES: usize = 4_000;

/// Lines of elements of one category that follow each other at equal distances and turn little, such as dotted lines.
pub(super) fn lines(elements: &[ExemplarElement], centres: &[Point], size: [i32; 2]) -> Vec<Vec<usize>> {
    let few = IN_LINE..=MOST_IN_LINES;
    let members = members(elements).into_values().filter(|members| few.contains(&members.len()));
    members.flat_map(|members| lines_within(centres, &members, size.map(f64::from))).collect()
}

fn lines_within(centres: &[Point], members: &[usize], size: [f64; 2]) -> Vec<Vec<usize>> {
    let reach = STEP * libm::sqrt(size[0] * size[1] / members.len() as f64);
    let periods = size.map(Some);
    let places: Vec<Point> = members.iter().map(|&k| centres[k]).collect();
    let near = NearPoints::new(&places, periods, reach);
    let way = |from: usize, to: usize| shortest_offset(places[from], places[to], periods);
    // The element nearest to where the last step leads again.
    let next = |at: usize, step: Vec2| {
        let mut best = (OFF_LINE * step.hypot(), None);
        near.each(places[at] + step, |k| {
            let off = (way(at, k) - step).hypot();
            if k != at && off < best.0 {
                best = (off, Some(k));
            }
        });
        best.1
    };
    let mut found = Vec::new();
    for first in 0..members.len() {
        let mut seconds: Vec<(f64, usize)> = Vec::new();
        near.each(places[first], |k| {
            let step = way(first, k).hypot();
            if step > 0.0 && step <= reach {
                seconds.push((step, k));
            }
        });
        seconds.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, second) in seconds.into_iter().take(BEGUN) {
            let mut line = vec![first, second];
            let mut step = way(first, second);
            while let Some(k) = next(line[line.len() - 1], step).filter(|k| !line.contains(k)) {
                step = way(line[line.len() - 1], k);
                line.push(k);
            }
            if line.len() >= IN_LINE {
                found.push(line.into_iter().map(|k| members[k]).collect());
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    #[test]
    fn bands_differ_from_even_and_from_random_places() {
        let mut random = stream(1, "order", 0);
        let mut places =
            |f: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..200).map(|_| f(random.unit())).collect() };
        let (even, banded) = (places(&|v| v), places(&|v| libm::floor(v * 3.0) / 3.0 + v / 8.0));
        assert!(!is_banded(even.into_iter()) && is_banded(banded.into_iter()));
        assert!(!is_banded((0..200).map(|k| f64::from(k) / 200.0)));
        // Too few to tell.
        assert!(!is_banded(vec![0.5; 20].into_iter()));
    }

    #[test]
    fn dotted_lines_are_found_among_random_dots() {
        let size = [300.0; 2];
        let mut random = stream(2, "order", 0);
        let mut dots: Vec<Point> =
            (0..200).map(|_| Point::new(random.range(0.0, 300.0), random.range(0.0, 300.0))).collect();
        let all: Vec<usize> = (0..dots.len()).collect();
        let by_chance = lines_within(&dots, &all, size).len();
        // An arc across the border of the page.
        let arc = |k: i32| {
            let angle = 0.08 * f64::from(k);
            Point::new((250.0 + 100.0 * libm::sin(angle)).rem_euclid(300.0), 100.0 * libm::cos(angle) + 20.0)
        };
        dots.extend((0..10).map(arc));
        let all: Vec<usize> = (0..dots.len()).collect();
        let found = lines_within(&dots, &all, size);
        let is_arc = |line: &Vec<usize>| (200..210).all(|k| line.contains(&k));
        assert!(found.iter().any(is_arc), "{found:?}");
        assert!(by_chance <= 4, "{by_chance}");
        // Of dots in one place, lines are begun to few.
        let heap: Vec<Point> =
            (0..900).map(|_| Point::new(random.range(0.0, 2.0), random.range(0.0, 2.0))).collect();
        let all: Vec<usize> = (0..heap.len()).collect();
        assert!(lines_within(&heap, &all, size).len() <= BEGUN * heap.len());
    }
}
