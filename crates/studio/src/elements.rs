//! The elements of a photograph as masks, and how a user mends them.

mod categories;
mod lines;

pub use categories::{categories_of_library, renumbered};

use lines::check_path;
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
    /// Names of the categories that a user has given, each of which has elements; none if analysis finds them.
    names: Vec<String>,
    /// The category of each element among these.
    of: Vec<Option<usize>>,
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
        let masks: Vec<Mask> = masks.collect();
        Self { size, of: vec![None; masks.len()], masks, names: Vec::new() }
    }

    /// Masks of a photograph of a width and a height. Where they overlap, pixels belong to the later one.
    pub fn new(size: [u32; 2], masks: impl IntoIterator<Item = Mask>) -> Self {
        let mut elements = Self { size, masks: Vec::new(), names: Vec::new(), of: Vec::new() };
        for mask in masks {
            elements.put(mask);
        }
        elements.drop_empty();
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
        let map = self.labels();
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
                self.of.resize(self.masks.len(), self.of[*element]);
            }
            Mending::Grow { elements, by } => {
                let all = self.check(elements, 1)?;
                if *by == 0 || by.unsigned_abs() > MOST_GROWTH.unsigned_abs() {
                    return Err(format!("elements grow or shrink by 1 to {MOST_GROWTH} pixels"));
                }
                self.grow(&all, *by);
            }
        }
        self.drop_empty();
        Ok(())
    }

    /// Drops elements without pixels.
    fn drop_empty(&mut self) {
        let kept: Vec<bool> = self.masks.iter().map(|mask| !mask.is_empty()).collect();
        let mut of = kept.iter();
        self.of.retain(|_| of.next() == Some(&true));
        self.masks.retain(|mask| !mask.is_empty());
        self.drop_unused_names(None);
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
        self.of.push(None);
    }

    fn grow(&mut self, elements: &[usize], by: i32) {
        let [w, h] = self.size.map(|side| side as i32);
        if by < 0 {
            for &i in elements {
                let shrunk = (by..0).fold(std::mem::take(&mut self.masks[i]), |mask, _| mask.interior());
                self.masks[i] = shrunk;
            }
            return;
        }
        let mut map = self.labels();
        for (&i, label) in elements.iter().zip(elements.iter().map(|i| *i as u32 + 1)) {
            let own = std::mem::take(&mut self.masks[i]);
            let wide = (0..by).fold(own, |mask, _| wider(&mask).within([0, 0], [w, h]));
            // What belongs to no other element.
            let mut free = Vec::new();
            for &Span { y, x0, x1 } in wide.spans() {
                let first = map.index(0, y as u32);
                let is_free = |x: &i32| [0, label].contains(&map.labels[first + *x as usize]);
                // Pixels beside one another become one run.
                free.extend((x0..x1).filter(is_free).map(|x| Span { y, x0: x, x1: x + 1 }));
            }
            let grown = Mask::from_spans(free);
            map.fill(&grown, label);
            self.masks[i] = grown;
        }
    }

    /// A label for each element, 0 between them.
    fn labels(&self) -> LabelMap {
        let mut map = LabelMap::filled(self.size[0], self.size[1], 0);
        for (mask, label) in self.masks.iter().zip(1..) {
            map.fill(mask, label);
        }
        map
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
}

const NOT_DIVIDED: &str = "the line does not divide the element: draw it right across";

/// Distance of drawn outlines from those of masks, in pixels.
const TOLERANCE: f64 = 0.5;

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
