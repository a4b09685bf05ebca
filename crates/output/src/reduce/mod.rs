//! Scene → scene whose file stays within a number of bytes.
//!
//! Reductions form a ladder, the least visible first: fewer decimals; no names for editors; outlines with fewer segments,
//! at larger and larger tolerances; the least visible details and secondaries; a coarser background; no soft rims. Then
//! colours are rounded, so that shapes share them, and what shows least of all elements is left out, details of large
//! elements last where they are seen. The first step of the ladder whose file fits is sought, between steps of known
//! sizes.

mod coarser;
mod visibility;

use super::svg::SvgOptions;
use coarser::{coarser, rounded};
use serde::Serialize;
use std::borrow::Cow;
use visibility::Ranks;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::Outline;
use vtex_base::parallel;
use vtex_scene::scene::{Element, Scene, Shape};

/// The ladder after the decimals and names: the tolerance of outlines, in pixels; how many times farther the control points of the
/// background lie apart; and the share of details and secondaries that is left out before the next step. Measured on
/// textures of stones and of grass as mean difference per byte saved: a fit within 0.1 px costs least, then the least
/// visible third of details and secondaries; from there on both cost about the same.
const LADDER: [(f64, f64, usize); 5] =
    [(0.1, 1.0, 20), (0.15, 1.0, 30), (0.2, 1.5, 38), (0.3, 2.0, 46), (0.5, 3.0, 52)];
/// The ladder after that: tolerance and background as before, the step to which colours are rounded, in Oklab, and the
/// number of steps, in each of which a share of [`LEFT`] of all elements and details stays, of [`FIRST_LEFT`] before.
const LAST_LADDER: [(f64, f64, f32, i32); 4] =
    [(0.5, 3.0, 0.03, 12), (0.7, 3.0, 0.04, 24), (1.0, 4.0, 0.05, 40), (1.5, 5.0, 0.06, 64)];
const FIRST_LEFT: f64 = 0.2;
const LEFT: f64 = 0.93;
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
    /// Whether an SVG has no names of elements, which editors list.
    pub names: bool,
    /// Tolerance of simplified outlines, in pixels; 0 if outlines are unchanged. Those of .5 px and more have no soft
    /// rims.
    pub tolerance: f64,
    /// Details left out, on all primaries of the canvas.
    pub details: usize,
    /// Secondaries left out.
    pub elements: usize,
    /// Primaries left out.
    pub primaries: usize,
    /// How many times farther apart colours of the background are; 1 if it is unchanged.
    pub background: f64,
    /// Step to which lightness and the two axes of colour are rounded, in Oklab, and gradients of elements are one
    /// colour; 0 if colours are unchanged.
    pub colours: f32,
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
    let whole = measure(scene, options)?;
    if whole <= most {
        return Ok(ReducedScene { scene: Cow::Borrowed(scene), options: *options, given_up: None });
    }
    let steps = ladder(options.precision);
    let ranks = Ranks::new(scene);
    let at = |step: &ReductionStep| -> Result<(ReducedScene<'a>, u64), E> {
        let (scene, options, given_up) = step.of(scene, &ranks, options);
        let bytes = measure(&scene, &options)?;
        Ok((ReducedScene { scene: Cow::Owned(scene), options, given_up: Some(given_up) }, bytes))
    };
    let (mut best, smallest) = at(&steps[steps.len() - 1])?;
    if smallest > most {
        return Err(Error::MaxBytes { file: "file", most, smallest }.into());
    }
    // All steps up to `low` are too large, the whole scene being the step before the first, and `high` fits.
    let (mut low, mut high) = ((0, whole), (steps.len(), smallest));
    while high.0 - low.0 > 1 {
        let middle = between(low, high, most);
        let (found, bytes) = at(&steps[middle - 1])?;
        if bytes <= most {
            (best, high) = (found, (middle, bytes));
        } else {
            low = (middle, bytes);
        }
    }
    Ok(best)
}

/// The step between two of known sizes that is tried next: where the size would be `most` if its logarithm fell evenly,
/// but at least a fifth of the way from either.
fn between(low: (usize, u64), high: (usize, u64), most: u64) -> usize {
    let log = |bytes: u64| libm::log(bytes.max(1) as f64);
    let fall = log(low.1) - log(high.1);
    let share = if fall > 0.0 { (log(low.1) - log(most)) / fall } else { 0.5 };
    let steps = (high.0 - low.0) as f64;
    low.0 + (libm::round(share.clamp(0.2, 0.8) * steps) as usize).clamp(1, high.0 - low.0 - 1)
}

/// A step of the ladder.
#[derive(Clone, Copy)]
struct ReductionStep {
    decimals: u8,
    /// Whether elements have names in editors.
    names: bool,
    tolerance: f64,
    /// Factor of the distance between control points of fields.
    background: f64,
    /// Step to which colours are rounded; 0 for none.
    colours: f32,
    /// Share of details and secondaries that is left out, and share of these and primaries, 0 to 1.
    left_out: [f64; 2],
}

impl ReductionStep {
    /// The reduced scene, how it is written, and what was given up.
    fn of(&self, whole: &Scene, ranks: &Ranks, options: &SvgOptions) -> (Scene, SvgOptions, GivenUp) {
        let mut scene = whole.clone();
        let left_out = ranks.leave_out(&mut scene, self.left_out);
        scene.drop_unused();
        if self.background > 1.0 {
            let [width, height] = [scene.width, scene.height].map(f64::from);
            let fields = scene.layers.iter_mut().filter_map(|layer| layer.field.as_mut());
            fields.for_each(|field| *field = coarser(field, [width, height], self.background));
        }
        if self.colours > 0.0 {
            scene = rounded(scene, self.colours);
        }
        if self.tolerance > 0.0 {
            scene = refitted(scene, self.tolerance, self.decimals);
        }
        let options = SvgOptions { precision: self.decimals, names: self.names, ..*options };
        let given_up = GivenUp {
            decimals: self.decimals,
            names: !self.names,
            tolerance: self.tolerance,
            details: left_out.details,
            elements: left_out.secondaries,
            primaries: left_out.primaries,
            background: self.background,
            colours: self.colours,
        };
        (scene, options, given_up)
    }
}

/// The steps, each coarser than the one before in one respect at least.
fn ladder(precision: u8) -> Vec<ReductionStep> {
    let last = precision.min(1);
    let plain = ReductionStep {
        decimals: last,
        names: true,
        tolerance: 0.0,
        background: 1.0,
        colours: 0.0,
        left_out: [0.0; 2],
    };
    let decimals = (last..precision).rev().map(|decimals| ReductionStep { decimals, ..plain });
    let plain = ReductionStep { names: false, ..plain };
    let share = |count: usize| count as f64 / SHARES as f64;
    let begin = |i: usize| if i == 0 { 0 } else { LADDER[i - 1].2 };
    let small = LADDER.iter().enumerate().flat_map(|(i, &(tolerance, background, end))| {
        let left_out = (begin(i)..=end).map(move |count| [share(count), 0.0]);
        left_out.map(move |left_out| ReductionStep { tolerance, background, left_out, ..plain })
    });
    let most = share(LADDER[LADDER.len() - 1].2);
    let begin = |i: usize| if i == 0 { 0 } else { LAST_LADDER[i - 1].3 };
    let all = LAST_LADDER.iter().enumerate().flat_map(|(i, &(tolerance, background, colours, end))| {
        let left_out = (begin(i)..=end).map(move |k| [most, 1.0 - FIRST_LEFT * libm::pow(LEFT, k.into())]);
        left_out.map(move |left_out| ReductionStep { tolerance, background, colours, left_out, ..plain })
    });
    decimals.chain([plain]).chain(small).chain(all).collect()
}

/// The scene with simplified outlines, within `tolerance` pixels in their own coordinates, from
/// [`WITHOUT_RIMS`] on without soft rims.
fn refitted(scene: Scene, tolerance: f64, decimals: u8) -> Scene {
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
    Scene { elements, ..scene }
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
            assert!(now.primaries >= last.primaries && now.background >= last.background, "{last:?} {now:?}");
            last = now;
        }
        assert!(last.primaries > 0 && last.colours > 0.0, "{last:?}");
        assert!(last.elements > scene.of_role(Role::Secondary).count() * 8 / 10, "{last:?}");
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
        assert!(smallest(&rimmed) <= smallest(&bare) * 21 / 20);
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
                assert!(pair[1].tolerance >= pair[0].tolerance && pair[1].background >= pair[0].background);
                assert!(pair[1].colours >= pair[0].colours && (pair[0].names || !pair[1].names));
                assert!((0..2).all(|k| pair[1].left_out[k] >= pair[0].left_out[k]));
            }
        }
    }
}
