use super::*;
use std::sync::Mutex;
use vtex_scene::library::testing::{library, mosaic};

/// Collects warnings.
#[derive(Default)]
struct Warnings(Mutex<Vec<String>>);

impl Progress for Warnings {
    fn warn(&self, message: &str) {
        self.0.lock().unwrap().push(message.into());
    }
}

fn drawing() -> Library {
    let mut library = library(&mosaic(160, 30.0, 0.3, 5)).without_secondaries();
    library.elements.iter_mut().for_each(|e| e.clipped = false);
    library
}

fn moved(placed: &[DrawnElement], still: &[DrawnElement]) -> usize {
    placed.iter().zip(still).filter(|(a, b)| a.map != b.map).count()
}

#[test]
fn nothing_changes_places_on_a_canvas_beyond_the_limit_and_that_is_said() {
    let library = drawing();
    let params = SynthParams { width: 320, height: 320, variation: Some(1.0), ..SynthParams::default() };
    let warnings = Warnings::default();
    let small = place_within(&library, &params, MOST_PIXELS, &warnings).unwrap();
    assert!(warnings.0.lock().unwrap().is_empty());
    let large = place_within(&library, &params, 320 * 320, &warnings).unwrap();
    assert_eq!(warnings.0.lock().unwrap().len(), 1);
    let still = SynthParams { variation: Some(0.0), ..params };
    let still = place_within(&library, &still, MOST_PIXELS, &()).unwrap();
    assert_eq!((large.variation, moved(&large.placed, &still.placed)), (0.0, 0));
    assert!(small.variation == 1.0 && 2 * moved(&small.placed, &still.placed) > still.placed.len());
}

#[test]
fn pixels_of_elements_follow_all_of_a_map() {
    let library = drawing();
    let params = SynthParams { width: 320, height: 320, ..SynthParams::default() };
    let relations = ElementRelations::new(&library, &|| Ok(())).unwrap();
    let area = |map: Affine| {
        let mut canvas = OccupiedCanvas::new(&library, &params, &relations, MOST_PIXELS).unwrap();
        let p = DrawnElement { element: 0, map, order: PaintingOrder::default(), motif: None };
        canvas.write(&p, 1, 0);
        canvas.covered(&[p], || Ok(())).unwrap().iter().sum::<f64>() * 320.0 * 320.0
    };
    let to_middle = Affine::translate((160.0, 160.0));
    let home = Affine::translate(-relations.bounds[0].center().to_vec2());
    let plain = area(to_middle * home);
    let tall = area(to_middle * Affine::scale_non_uniform(1.0, 3.0) * home);
    assert!((tall / plain - 3.0).abs() < 0.1, "{plain} {tall}");
}

#[test]
fn changing_places_stops_wherever_it_is_asked_to() {
    let library = drawing();
    let params = SynthParams { width: 320, height: 320, variation: Some(1.0), ..SynthParams::default() };
    let free = ElementRelations::new(&library, &|| Ok(())).unwrap().free.iter().filter(|f| **f).count();
    // Each element walks six times, moves apart at least once, and is exchanged.
    vtex_testing::StopAfter::check(4 * free, |progress| place(&library, &params, progress));
}

#[test]
fn a_drawing_of_elements_without_end_is_blamed_itself() {
    let mut library = drawing();
    let params = SynthParams { width: 320, height: 320, ..SynthParams::default() };
    for instance in library.layers.iter_mut().flat_map(|layer| &mut layer.instances) {
        instance.transform = [3000.0, 0.0, 0.0, 3000.0, 0.0, 0.0];
    }
    let error = place(&library, &params, &()).err().unwrap();
    assert!(matches!(&error, Error::Control { role: "a drawing", .. }), "{error}");
}
