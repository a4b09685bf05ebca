//! Soft rims under operations.

use super::tests::{edited, on, outline, scene};
use super::*;
use vtex_base::raster::colour::Colour;
use vtex_scene::element::SoftRim;
use vtex_scene::scene::{ThinOrder, Within};

const RIM: SoftRim = SoftRim { width: 4.0, colour: Colour([150, 80, 60]), opacity: 0.8 };

/// Bars with a rim each, the second wider.
fn rimmed() -> Scene {
    let mut scene = scene();
    for (element, width) in scene.elements.iter_mut().zip([4.0, 6.0]) {
        element.shapes[0].rim = Some(Box::new(SoftRim { width, ..RIM }));
    }
    scene
}

fn after(action: Action) -> Scene {
    let (scene, _) = edited(&rimmed(), &[on("primary", action)]);
    scene.validate().unwrap();
    scene
}

fn rim(scene: &Scene, index: usize) -> Option<SoftRim> {
    scene.element(&scene.primary()[index]).base().rim.as_deref().copied()
}

#[test]
fn rims_have_the_colours_that_elements_get() {
    let red = after(Action::Tint { colour: Colour([255, 0, 0]).into(), amount: 1.0, share: 1.0 });
    assert_eq!(rim(&red, 0), Some(SoftRim { colour: Colour([255, 0, 0]), ..RIM }));
    let [from, to] = [Colour([180, 60, 50]), Colour([60, 80, 180])];
    let blue = after(Action::Recolor { from, to, reach: 0.6, keep: Keep::Nothing });
    let Colour([r, _, b]) = rim(&blue, 0).unwrap().colour;
    assert!(b > r, "{r} {b}");
}

#[test]
fn rims_go_with_their_elements() {
    // Instances are scaled and turned; widths are those of elements.
    let large = after(Action::Scale { factor: 2.0.into() });
    assert_eq!((rim(&large, 0), large.elements), (Some(RIM), rimmed().elements));
    let jittered = after(Action::Rotate { angle: 30.0.into() });
    assert_eq!(rim(&jittered, 0), Some(RIM));
    let few = after(Action::Thin { keep: Some(0.5), order: ThinOrder::Random, minimum_area: Some(30.0) });
    assert_eq!(few.primary().len(), 30);
    assert!((0..30).all(|k| rim(&few, k).is_some()));
    assert!(few.elements.iter().all(|e| e.category.is_none() || e.details().is_empty()));
    let none = after(Action::Delete);
    assert!(none.primary().is_empty());
    let simple = after(Action::Simplify { tolerance: 0.5 });
    assert_eq!(rim(&simple, 0), Some(RIM));
}

#[test]
fn what_is_flat_has_no_rim() {
    let flat = after(Action::Flatten);
    assert!((0..60).all(|k| rim(&flat, k).is_none()));
}

#[test]
fn an_exchange_of_appearance_takes_the_rim_along() {
    let mut scene = rimmed();
    scene.elements[0].shapes[0].rim = None;
    // A quarter longer than the first, on which its rim is narrower.
    scene.elements[1].shapes[0].outline = outline("M-12.5-3.75h25v7.5h-25z");
    let shuffle = Action::Shuffle { within: Within::Layer, share: 1.0, outlines: false };
    let (scene, _) = edited(&scene, &[on("primary", shuffle)]);
    scene.validate().unwrap();
    let widths: Vec<f64> = (0..40).filter_map(|k| Some(rim(&scene, k)?.width)).collect();
    assert!(!widths.is_empty() && widths.iter().all(|w| (w - 4.8).abs() < 0.1), "{widths:?}");
    let bare = (40..60).filter(|k| rim(&scene, *k).is_none()).count();
    assert_eq!(bare, widths.len());
    let own: Vec<f64> = (40..60).filter_map(|k| Some(rim(&scene, k)?.width)).collect();
    assert!(own.iter().all(|w| *w == 6.0), "{own:?}");
}
