//! Scene → scene whose SVG stays within a number of bytes.
//!
//! Reductions form a ladder, the least visible first: fewer decimals; outlines with fewer segments, at a
//! small tolerance; the least visible details and secondaries, a share of all at a time, with larger and
//! larger tolerances, the largest without soft rims. A bisection finds the first step of the ladder whose file
//! fits. Primaries and the background always stay as they are.

mod visibility;

use super::svg::SvgOptions;
use serde::Serialize;
use std::borrow::Cow;
use visibility::Ranks;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::Outline;
use vtex_base::parallel;
use vtex_scene::scene::{Element, Scene, Shape};

/// The ladder after the decimals: the tolerance of outlines, in pixels, and the share of details and
/// secondaries that is left out before the next step. Measured on textures of stones and of grass as mean
/// difference per byte saved: a fit within 0.1 px costs least, then the least visible third of details and
/// secondaries; from there on both cost about the same.
const LADDER: [(f64, usize); 5] = [(0.1, 20), (0.15, 30), (0.2, 40), (0.3, 50), (0.5, 60)];
/// Tolerance from which soft rims are left out. Left out first, a picture of pebbles at nine tenths of its bytes differed
/// by 2 steps of 8 bits in the mean, nearly twice as much as is permitted.
const WITHOUT_RIMS: f64 = 0.5;
/// Number of steps in which details and secondaries are left out.
const SHARES: usize = 60;

/// Reductions that made a file small enough.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GivenUp {
    /// Digits after the decimal point that are left.
    pub decimals: u8,
    /// Tolerance of simplified outlines, in pixels; 0 if outlines are unchanged. Those of .5 px have no soft rims.
    pub tolerance: f64,
    /// Details left out, on all primaries of the canvas.
    pub details: usize,
    /// Secondaries left out.
    pub elements: usize,
}

/// A scene of which the file fits.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedScene<'a> {
    /// The scene to write.
    pub scene: Cow<'a, Scene>,
    /// How to write it.
    pub options: SvgOptions,
    /// Its reductions; `None` if the scene fits unchanged.
    pub given_up: Option<GivenUp>,
}

/// Finds the first step of the ladder at which `measure`, the number of bytes of the file, is at most `most`.
/// The same scene, options and measure give the same result.
///
/// # Errors
/// [`Error::Format`] for a scene that breaks its invariants; [`Error::MaxBytes`] if even the last
/// step is too large; those of `measure`.
pub fn to_fit<'a, E: From<Error>>(
    scene: &'a Scene,
    options: &SvgOptions,
    most: u64,
    measure: impl Fn(&Scene, &SvgOptions) -> Result<u64, E>,
) -> Result<ReducedScene<'a>, E> {
    scene.check()?;
    if measure(scene, options)? <= most {
        return Ok(ReducedScene { scene: Cow::Borrowed(scene), options: *options, given_up: None });
    }
    let steps = ladder(options.precision);
    let mut refits = Refits { scene, last: None };
    let mut ranks = None;
    let mut at = |step: &ReductionStep| -> Result<(ReducedScene<'a>, u64), E> {
        let mut result = refits.at(step.tolerance, step.decimals).clone();
        let mut given_up =
            GivenUp { decimals: step.decimals, tolerance: step.tolerance, ..GivenUp::default() };
        if step.left_out > 0 {
            let ranks: &Ranks = ranks.get_or_insert_with(|| Ranks::new(scene));
            (given_up.details, given_up.elements) =
                ranks.leave_out(&mut result, ranks.len() * step.left_out / SHARES);
        }
        let options = SvgOptions { precision: step.decimals, ..*options };
        let bytes = measure(&result, &options)?;
        Ok((ReducedScene { scene: Cow::Owned(result), options, given_up: Some(given_up) }, bytes))
    };
    let (mut best, smallest) = at(&steps[steps.len() - 1])?;
    if smallest > most {
        return Err(Error::MaxBytes { most, smallest }.into());
    }
    // All steps before `low` are too large, `high` fits.
    let (mut low, mut high) = (0, steps.len() - 1);
    while low < high {
        let middle = (low + high) / 2;
        let (found, bytes) = at(&steps[middle])?;
        if bytes <= most {
            (best, high) = (found, middle);
        } else {
            low = middle + 1;
        }
    }
    Ok(best)
}

/// A step of the ladder.
struct ReductionStep {
    decimals: u8,
    tolerance: f64,
    /// Share of details and secondaries left out, in units of one [`SHARES`]th.
    left_out: usize,
}

/// The steps, each coarser than the one before in one respect.
fn ladder(precision: u8) -> Vec<ReductionStep> {
    let last = precision.min(1);
    let decimals =
        (last..precision).rev().map(|decimals| ReductionStep { decimals, tolerance: 0.0, left_out: 0 });
    let begin = |i: usize| if i == 0 { 0 } else { LADDER[i - 1].1 };
    let refits = LADDER.iter().enumerate().flat_map(|(i, &(tolerance, end))| {
        (begin(i)..=end).map(move |left_out| ReductionStep { decimals: last, tolerance, left_out })
    });
    decimals.chain(refits).collect()
}

/// The scene with its outlines drawn again, kept while the tolerance stays.
struct Refits<'a> {
    scene: &'a Scene,
    last: Option<(f64, Scene)>,
}

impl Refits<'_> {
    fn at(&mut self, tolerance: f64, decimals: u8) -> &Scene {
        if tolerance == 0.0 {
            return self.scene;
        }
        if self.last.as_ref().is_some_and(|(known, _)| *known != tolerance) {
            self.last = None;
        }
        &self.last.get_or_insert_with(|| (tolerance, refitted(self.scene, tolerance, decimals))).1
    }
}

/// The scene with simplified outlines, within `tolerance` pixels in their own coordinates, from
/// [`WITHOUT_RIMS`] on without soft rims.
fn refitted(scene: &Scene, tolerance: f64, decimals: u8) -> Scene {
    let refit = |outline: &Outline| outline.refitted(tolerance, decimals);
    let simpler = |shape: &Shape| {
        let refitted = shape.with_outline(refit(&shape.outline));
        if tolerance < WITHOUT_RIMS { refitted } else { Shape { rim: None, ..refitted } }
    };
    let elements = parallel::map(&scene.elements, |element| Element {
        silhouette: element.silhouette.as_ref().map(refit),
        shapes: element.shapes.iter().map(simpler).collect(),
        ..*element
    });
    Scene { elements, ..scene.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{svg, testing};
    use std::io;
    use vtex_scene::scene::Role;

    fn bytes(scene: &Scene, options: &SvgOptions) -> io::Result<u64> {
        svg::write(scene, options, io::sink()).map(|s| s.bytes)
    }

    fn fit(scene: &Scene, most: u64) -> io::Result<ReducedScene<'_>> {
        to_fit(scene, &SvgOptions::default(), most, bytes)
    }

    #[test]
    fn what_fits_stays_as_it_is() {
        let scene = testing::scene(300, 200, 1);
        let whole = bytes(&scene, &SvgOptions::default()).unwrap();
        let reduced = fit(&scene, whole).unwrap();
        assert_eq!((reduced.scene.as_ref(), reduced.given_up), (&scene, None));
        assert!(fit(&scene, whole - 1).unwrap().given_up.is_some());
    }

    #[test]
    fn smaller_files_give_up_more_and_fit() {
        let scene = testing::scene(500, 300, 2);
        let whole = bytes(&scene, &SvgOptions::default()).unwrap();
        let Ok(Error::MaxBytes { smallest, .. }) = fit(&scene, 1).unwrap_err().downcast() else {
            panic!("nothing is that small")
        };
        let mut last = GivenUp { decimals: 2, ..GivenUp::default() };
        for k in 1..=10 {
            let most = whole - (whole - smallest) * k / 10;
            let reduced = fit(&scene, most).unwrap();
            assert!(bytes(&reduced.scene, &reduced.options).unwrap() <= most);
            let now = reduced.given_up.unwrap();
            assert!(now.decimals <= last.decimals && now.tolerance >= last.tolerance, "{last:?} {now:?}");
            assert!(now.details >= last.details && now.elements >= last.elements, "{last:?} {now:?}");
            last = now;
        }
        assert_eq!(last.elements, scene.of_role(Role::Secondary).count());
        assert_eq!(fit(&scene, smallest).unwrap(), fit(&scene, smallest).unwrap());
    }

    #[test]
    fn rims_are_given_up_with_the_largest_tolerance() {
        let bare = testing::scene(300, 200, 3);
        let rimmed = testing::rimmed(bare.clone());
        let smallest = |scene: &Scene| match fit(scene, 1).unwrap_err().downcast() {
            Ok(Error::MaxBytes { smallest, .. }) => smallest,
            other => panic!("{other:?}"),
        };
        assert_eq!(smallest(&rimmed), smallest(&bare));
        let whole = bytes(&rimmed, &SvgOptions::default()).unwrap();
        let least = smallest(&rimmed);
        let mut found = [false; 2];
        for k in 1..=20 {
            let reduced = fit(&rimmed, whole - (whole - least) * k / 20).unwrap();
            let has_rims = reduced.scene.elements.iter().any(|e| e.base().rim.is_some());
            assert_eq!(has_rims, reduced.given_up.unwrap().tolerance < WITHOUT_RIMS);
            found[usize::from(has_rims)] = true;
        }
        assert_eq!(found, [true; 2]);
    }

    #[test]
    fn the_ladder_only_descends() {
        for precision in 0..=6 {
            for pair in ladder(precision).windows(2) {
                assert!(pair[1].decimals <= pair[0].decimals);
                assert!(pair[1].tolerance >= pair[0].tolerance && pair[1].left_out >= pair[0].left_out);
            }
        }
    }
}
