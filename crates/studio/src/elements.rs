//! The elements of a photograph as masks, and how a user mends them.

use serde::Deserialize;
use vtex_base::geometry::{FittedMap, PathText, PlanarMap, write_path};
use vtex_base::raster::{Connectivity, LabelMap, Mask, Span, components_of_mask};
use vtex_scene::library::Library;
use vtex_segment::segment::ScoredMask;

/// Masks of elements that do not overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ElementMasks {
    /// Width and height of the photograph, in pixels.
    size: [u32; 2],
    masks: Vec<Mask>,
}

/// What a user does to elements. Places are pixels of the photograph; elements are counted from 0.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Mending {
    /// Elements become background.
    Delete {
        /// Which.
        elements: Vec<usize>,
    },
    /// Elements become one, which takes the place of the first.
    Merge {
        /// Which, at least two.
        elements: Vec<usize>,
    },
    /// What a brush touches becomes background.
    Erase {
        /// The way of the brush.
        path: Vec<[f64; 2]>,
        /// Half its width.
        radius: f64,
    },
    /// What a line encloses becomes an element, taken from others where they lie there.
    Draw {
        /// The line; its ends join.
        path: Vec<[f64; 2]>,
    },
    /// An element is divided along a line.
    Split {
        /// Which.
        element: usize,
        /// The line.
        path: Vec<[f64; 2]>,
    },
    /// Elements grow by a number of pixels, up to their neighbours, or shrink if it is negative.
    Grow {
        /// Which.
        elements: Vec<usize>,
        /// The number, -20 to 20.
        by: i32,
    },
}

/// Pieces of fewer pixels are background.
const LEAST: u32 = 5;
/// Most points of a line, and most pixels along it.
const LONGEST: (usize, f64) = (8192, 200_000.0);
/// Largest radius of the brush, in pixels.
const WIDEST: f64 = 500.0;
/// Half the width of a cut, in pixels: enough to part what touches across corners.
const CUT: f64 = 0.8;
/// Largest growth, in pixels.
const MOST_GROWTH: i32 = 20;

impl ElementMasks {
    /// The primaries of a photograph.
    pub fn of_library(library: &Library) -> Self {
        let map = library.arrangement.to_labels();
        let size = [library.source.width, library.source.height];
        let masks = Mask::all_of_labels(&map, library.primaries().len() + 1);
        let masks = masks.iter().skip(1).map(|mask| mask.stretched([map.width, map.height], size));
        Self { size, masks: masks.collect() }
    }

    /// Masks of a photograph of a width and a height. Where they overlap, pixels belong to the later one.
    pub fn new(size: [u32; 2], masks: impl IntoIterator<Item = Mask>) -> Self {
        let mut elements = Self { size, masks: Vec::new() };
        for mask in masks {
            elements.put(mask);
        }
        elements.masks.retain(|mask| !mask.is_empty());
        elements
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.masks.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.masks.is_empty()
    }

    /// The masks, as a segmenter gives them.
    pub fn scored(&self) -> Vec<ScoredMask> {
        self.masks.iter().map(|mask| ScoredMask { mask: mask.clone(), score: 1.0 }).collect()
    }

    /// Smooth outlines of the elements, in their order, as path data of SVG.
    pub fn outlines(&self) -> Vec<String> {
        let [width, height] = self.size;
        let mut map = LabelMap { width, height, labels: vec![0; width as usize * height as usize] };
        for (mask, label) in self.masks.iter().zip(1..) {
            for span in mask.spans() {
                let row = span.y as usize * width as usize;
                map.labels[row + span.x0 as usize..row + span.x1 as usize].fill(label);
            }
        }
        let count = self.masks.len();
        let traced = PlanarMap::trace(width, height, &map.labels);
        let fitted = FittedMap::new(traced, TOLERANCE, count, count, |label| label);
        let outlines = fitted.outlines(count, |label| label);
        outlines.iter().skip(1).map(|o| write_path(o.path(), PathText { precision: 1 })).collect()
    }

    /// A place within each element, in the middle of its widest row.
    pub fn places(&self) -> Vec<[f64; 2]> {
        let place = |mask: &Mask| {
            let widest = mask.spans().iter().rev().max_by_key(|span| span.len());
            widest.map_or([0.0; 2], |s| [f64::from(s.x0 + s.x1) / 2.0, f64::from(s.y) + 0.5])
        };
        self.masks.iter().map(place).collect()
    }

    /// Mends the elements.
    ///
    /// # Errors
    /// What cannot be done, in a sentence. The elements then stay as they were.
    pub fn mend(&mut self, mending: &Mending) -> Result<(), String> {
        match mending {
            Mending::Delete { elements } => {
                self.check(elements, 1)?;
                elements.iter().for_each(|&i| self.masks[i] = Mask::default());
            }
            Mending::Merge { elements } => {
                let all = self.check(elements, 2)?;
                let spans = all.iter().flat_map(|&i| std::mem::take(&mut self.masks[i]).spans().to_vec());
                self.masks[elements[0]] = Mask::from_spans(spans.collect());
            }
            Mending::Erase { path, radius } => {
                check_path(path, 1)?;
                if !(0.5..=WIDEST).contains(radius) {
                    return Err(format!("the brush is not 1 to {} pixels wide", 2.0 * WIDEST));
                }
                let erased = self.stroke(path, *radius);
                self.masks.iter_mut().for_each(|mask| take(mask, &erased));
            }
            Mending::Draw { path } => {
                check_path(path, 3)?;
                let drawn = self.enclosed(path);
                if drawn.area() < LEAST {
                    return Err("the line encloses too little to be an element".into());
                }
                self.put(drawn);
            }
            Mending::Split { element, path } => {
                self.check(&[*element], 1)?;
                check_path(path, 2)?;
                let parts = self.divided(*element, path);
                let [first, others @ ..] = &parts[..] else { return Err(NOT_DIVIDED.into()) };
                if others.is_empty() {
                    return Err(NOT_DIVIDED.into());
                }
                self.masks[*element] = first.clone();
                self.masks.extend_from_slice(others);
            }
            Mending::Grow { elements, by } => {
                let all = self.check(elements, 1)?;
                if *by == 0 || by.unsigned_abs() > MOST_GROWTH.unsigned_abs() {
                    return Err(format!("elements grow or shrink by 1 to {MOST_GROWTH} pixels"));
                }
                all.iter().for_each(|&i| self.grow(i, *by));
            }
        }
        self.masks.retain(|mask| !mask.is_empty());
        Ok(())
    }

    /// The elements without those named twice, if there are at least so many and all exist.
    fn check(&self, elements: &[usize], least: usize) -> Result<Vec<usize>, String> {
        let mut all = elements.to_vec();
        all.sort_unstable();
        all.dedup();
        if all.len() < least {
            return Err(
                if least == 1 { "no element is selected" } else { "select at least two elements" }.into()
            );
        }
        if all.last().is_some_and(|&last| last >= self.masks.len()) {
            return Err("an element that is selected is no longer there".into());
        }
        Ok(all)
    }

    /// Adds an element, taken from those that lie where it lies.
    fn put(&mut self, mask: Mask) {
        let [w, h] = self.size.map(|side| side as i32);
        let mask = mask.within([0, 0], [w, h]);
        self.masks.iter_mut().for_each(|other| take(other, &mask));
        self.masks.push(mask);
    }

    fn grow(&mut self, element: usize, by: i32) {
        let [w, h] = self.size.map(|side| side as i32);
        let mut mask = std::mem::take(&mut self.masks[element]);
        for _ in 0..by.abs() {
            mask = if by < 0 { mask.interior() } else { wider(&mask).within([0, 0], [w, h]) };
        }
        if by > 0 {
            mask = self.masks.iter().fold(mask, |rest, other| rest.without(other));
        }
        self.masks[element] = mask;
    }

    /// The parts of an element on the sides of a line, if it divides it.
    fn divided(&self, element: usize, path: &[[f64; 2]]) -> Vec<Mask> {
        let whole = &self.masks[element];
        let cut = self.stroke(path, CUT).intersection(whole);
        let mut parts = components_of_mask(&whole.without(&cut), Connectivity::Four);
        parts.retain(|part| part.area() >= LEAST);
        // What the cut took away goes to the parts beside it.
        let mut left = cut;
        for _ in 0..2 {
            for part in &mut parts {
                let gained = wider(part).intersection(&left);
                left = left.without(&gained);
                *part = joined(part, &gained);
            }
        }
        parts
    }

    /// What a brush of a radius touches.
    fn stroke(&self, path: &[[f64; 2]], radius: f64) -> Mask {
        let ends = path.windows(2).map(|pair| [pair[0], pair[1]]);
        let dot = path.first().map(|&at| [at, at]);
        Mask::from_spans(dot.into_iter().chain(ends).flat_map(|[a, b]| self.capsule(a, b, radius)).collect())
    }

    /// The pixels whose centres are within a radius of the line between two places.
    fn capsule(&self, a: [f64; 2], b: [f64; 2], radius: f64) -> Vec<Span> {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let length = (dx * dx + dy * dy).sqrt();
        let side = if length > 0.0 { [-dy * radius / length, dx * radius / length] } else { [0.0; 2] };
        let corners = [
            [a[0] + side[0], a[1] + side[1]],
            [b[0] + side[0], b[1] + side[1]],
            [b[0] - side[0], b[1] - side[1]],
            [a[0] - side[0], a[1] - side[1]],
        ];
        let row = |y: i32| {
            let centre = f64::from(y) + 0.5;
            let disc = |at: [f64; 2]| {
                let up = centre - at[1];
                let reach = radius * radius - up * up;
                (reach >= 0.0).then(|| [at[0] - reach.sqrt(), at[0] + reach.sqrt()])
            };
            let edges = (0..4).filter_map(|i| {
                let x = crossing(corners[i], corners[(i + 1) % 4], centre)?;
                Some([x, x])
            });
            // The shape is convex, so each row has one run.
            let all = [disc(a), disc(b)].into_iter().flatten().chain(edges);
            let [x0, x1] = all.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])?;
            self.run(y, x0, x1)
        };
        self.rows([a[1].min(b[1]) - radius, a[1].max(b[1]) + radius]).filter_map(row).collect()
    }

    /// The pixels whose centres a closed line goes round.
    fn enclosed(&self, path: &[[f64; 2]]) -> Mask {
        let ys = || path.iter().map(|at| at[1]);
        let [top, bottom] = [ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max)];
        let mut spans = Vec::new();
        for y in self.rows([top, bottom]) {
            let centre = f64::from(y) + 0.5;
            let sides = path.iter().zip(path.iter().cycle().skip(1));
            let mut crossings: Vec<(f64, i32)> = sides
                .filter_map(|(&a, &b)| Some((crossing(a, b, centre)?, if a[1] < b[1] { 1 } else { -1 })))
                .collect();
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut turns = 0;
            for pair in crossings.windows(2) {
                turns += pair[0].1;
                if turns != 0 {
                    spans.extend(self.run(y, pair[0].0, pair[1].0));
                }
            }
        }
        Mask::from_spans(spans)
    }

    /// The rows of the photograph whose centres lie between two heights.
    fn rows(&self, [top, bottom]: [f64; 2]) -> std::ops::Range<i32> {
        let bound = |y: f64| y.clamp(0.0, f64::from(self.size[1]));
        bound((top - 0.5).ceil()) as i32..bound((bottom - 0.5).floor() + 1.0) as i32
    }

    /// The run of the pixels of a row whose centres lie between two places.
    fn run(&self, y: i32, x0: f64, x1: f64) -> Option<Span> {
        let bound = |x: f64| x.clamp(0.0, f64::from(self.size[0])) as i32;
        let span = Span { y, x0: bound((x0 - 0.5).ceil()), x1: bound((x1 - 0.5).floor() + 1.0) };
        (!span.is_empty()).then_some(span)
    }
}

const NOT_DIVIDED: &str = "the line does not divide the element: draw it right across";

/// Distance of drawn outlines from those of masks, in pixels.
const TOLERANCE: f64 = 0.5;

/// The place where a line crosses a height, of which its upper end is part.
fn crossing(a: [f64; 2], b: [f64; 2], y: f64) -> Option<f64> {
    let crosses = (a[1] <= y) != (b[1] <= y);
    crosses.then(|| a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
}

/// Takes pixels from an element, and crumbs that are left of it too.
fn take(mask: &mut Mask, taken: &Mask) {
    if mask.overlap(taken) == 0 {
        return;
    }
    let rest = components_of_mask(&mask.without(taken), Connectivity::Eight);
    let kept = rest.iter().filter(|part| part.area() >= LEAST);
    *mask = Mask::from_spans(kept.flat_map(|part| part.spans().to_vec()).collect());
}

fn joined(a: &Mask, b: &Mask) -> Mask {
    Mask::from_spans(a.spans().iter().chain(b.spans()).copied().collect())
}

/// A mask with the four neighbours of all its pixels.
fn wider(mask: &Mask) -> Mask {
    let spans = mask.spans().iter().flat_map(|s| {
        let beside = Span { x0: s.x0 - 1, x1: s.x1 + 1, ..*s };
        [beside, Span { y: s.y - 1, ..*s }, Span { y: s.y + 1, ..*s }]
    });
    Mask::from_spans(spans.collect())
}

/// Refuses lines that are too short or too long, and places that are no numbers.
fn check_path(path: &[[f64; 2]], least: usize) -> Result<(), String> {
    if path.len() < least {
        return Err("the line is too short".into());
    }
    let length = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).abs() + (pair[1][1] - pair[0][1]).abs();
    let whole: f64 = path.windows(2).map(length).sum();
    let near = path.iter().flatten().all(|v| v.abs() <= 1e6);
    if path.len() > LONGEST.0 || !near || whole > LONGEST.1 {
        return Err("the line is too long".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square(x: i32, y: i32, side: i32) -> Mask {
        Mask::from_spans((y..y + side).map(|y| Span { y, x0: x, x1: x + side }).collect())
    }

    fn three() -> ElementMasks {
        ElementMasks::new([60, 40], [square(2, 2, 10), square(20, 2, 10), square(40, 20, 15)])
    }

    fn areas(elements: &ElementMasks) -> Vec<u32> {
        elements.masks.iter().map(Mask::area).collect()
    }

    fn mended(mending: &str) -> Result<Vec<u32>, String> {
        let mut elements = three();
        elements.mend(&serde_json::from_str(mending).unwrap()).map(|()| areas(&elements))
    }

    #[test]
    fn elements_are_deleted_merged_and_grown() {
        assert_eq!(mended(r#"{"do":"delete","elements":[1]}"#), Ok(vec![100, 225]));
        assert_eq!(mended(r#"{"do":"merge","elements":[1,0,1]}"#), Ok(vec![200, 225]));
        assert_eq!(mended(r#"{"do":"grow","elements":[0],"by":1}"#), Ok(vec![140, 100, 225]));
        assert_eq!(mended(r#"{"do":"grow","elements":[0],"by":-2}"#), Ok(vec![36, 100, 225]));
        // Growth ends at neighbours and at the border.
        assert_eq!(mended(r#"{"do":"grow","elements":[0],"by":20}"#).unwrap()[1], 100);
        for bad in [
            r#"{"do":"delete","elements":[]}"#,
            r#"{"do":"delete","elements":[3]}"#,
            r#"{"do":"merge","elements":[2,2]}"#,
            r#"{"do":"grow","elements":[0],"by":21}"#,
            r#"{"do":"erase","path":[],"radius":2}"#,
            r#"{"do":"erase","path":[[1,1]],"radius":0}"#,
            r#"{"do":"erase","path":[[1e300,1]],"radius":3}"#,
            r#"{"do":"draw","path":[[1,1],[2,2]]}"#,
            r#"{"do":"split","element":0,"path":[[50,0],[50,40]]}"#,
        ] {
            assert!(mended(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_brush_erases_and_a_lasso_draws() {
        assert_eq!(mended(r#"{"do":"erase","path":[[7,-5],[7,30]],"radius":2}"#), Ok(vec![60, 100, 225]));
        assert_eq!(mended(r#"{"do":"erase","path":[[7,7]],"radius":30}"#).unwrap(), [225]);
        // It takes what it encloses from others.
        let drawn = mended(r#"{"do":"draw","path":[[7,0],[25,0],[25,12],[7,12]]}"#).unwrap();
        assert_eq!(drawn, [50, 50, 225, 18 * 12]);
        let disc = mended(r#"{"do":"erase","path":[[47.5,27.5]],"radius":5}"#).unwrap()[2];
        assert!((140..155).contains(&disc), "{disc}");
    }

    #[test]
    fn a_line_divides_an_element_and_keeps_its_pixels() {
        let halves = mended(r#"{"do":"split","element":2,"path":[[45,10],[45,39]]}"#).unwrap();
        assert_eq!((halves.len(), halves[2] + halves[3]), (4, 225));
        assert!(halves[2].min(halves[3]) >= 60, "{halves:?}");
    }

    #[test]
    fn outlines_go_round_the_elements() {
        let outlines = three().outlines();
        assert_eq!(outlines.len(), 3);
        assert!(outlines.iter().all(|path| path.starts_with('m') && path.ends_with('z')), "{outlines:?}");
        assert!(ElementMasks::new([5, 5], []).outlines().is_empty());
        assert_eq!(three().places(), [[7.0, 2.5], [25.0, 2.5], [47.5, 20.5]]);
    }

    proptest! {
        #[test]
        fn elements_never_overlap_or_leave_the_photograph(
            path in prop::collection::vec([-20.0..80.0f64, -20.0..60.0f64], 3..9),
            radius in 0.5..9.0f64, which in 0..3usize, by in -20..20i32,
        ) {
            let mut elements = three();
            for mending in [
                Mending::Draw { path: path.clone() },
                Mending::Split { element: which, path: path.clone() },
                Mending::Grow { elements: vec![which], by },
                Mending::Erase { path, radius },
            ] {
                let _ = elements.mend(&mending);
                let all: u32 = areas(&elements).iter().sum();
                let union = elements.masks.iter().fold(Mask::default(), |all, mask| joined(&all, mask));
                prop_assert_eq!(union.area(), all);
                prop_assert_eq!(union.within([0, 0], [60, 40]).area(), all);
                prop_assert!(elements.masks.iter().all(|mask| !mask.is_empty()));
            }
        }
    }
}
