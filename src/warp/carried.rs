//! What a scene knows of the libraries that it was made from.

use super::Bend;
use crate::arrange::model::{ElementId, Model, VariantId};
use crate::error::{Error, Result};
use crate::library::{Library, Primary};
use crate::raster::ControlMap;
use crate::scene::{Instance, Scene, Texton, pixels};
use crate::synth::compose;
use std::collections::VecDeque;

/// Longer side of the map of parts, in its own pixels.
const PARTS_SIDE: u32 = 256;

/// The libraries in the scene's order.
pub(super) fn matched(scene: &Scene, libraries: Vec<Library>) -> Result<Vec<Library>> {
    let fail = |name: &str, reason: String| Error::Control {
        name: name.into(),
        role: "a library of the scene",
        reason,
        advice: "give the libraries that the scene was made from; 'vtex inspect' lists them",
    };
    let mut left: Vec<Option<Library>> = libraries.into_iter().map(Some).collect();
    let mut found = Vec::with_capacity(scene.libraries.len());
    for reference in &scene.libraries {
        let fits = |l: &&mut Option<Library>| l.as_ref().is_some_and(|l| l.source.sha256 == reference.sha256);
        let library = left.iter_mut().find(fits).and_then(Option::take);
        let missing = || fail(&reference.exemplar, "the scene has textons of it, and it is not given".into());
        found.push(library.ok_or_else(missing)?);
    }
    if let Some(foreign) = left.into_iter().flatten().next() {
        return Err(fail(&foreign.source.file, "the scene was made without it".into()));
    }
    // The same photograph may have been analysed in another way since.
    for instance in &scene.primary {
        let texton = &scene.textons[instance.texton as usize];
        let library = &found[texton.library as usize];
        let known =
            library.primaries.get(texton.source as usize).filter(|p| Some(p.category.0) == texton.category);
        let same =
            |p: &Primary| texton.fragment || compose::translated(&p.outline, p.origin()) == texton.outline;
        if !known.is_some_and(same) {
            return Err(fail(&library.source.file, "its textons are not those of the scene".into()));
        }
    }
    for instance in &scene.secondary {
        let texton = &scene.textons[instance.texton as usize];
        let library = &found[texton.library as usize];
        if texton.source as usize >= library.secondaries.textons.len() {
            return Err(fail(&library.source.file, "its textons are not those of the scene".into()));
        }
    }
    Ok(found)
}

/// A primary of the scene as the model knows it: its variation is the nearest that there is.
pub(super) fn variant(model: &Model, instance: &Instance, texton: &Texton) -> VariantId {
    model.in_variation(element(model, texton), variation(model, instance))
}

/// The element of one of the scene's textons.
fn element(model: &Model, texton: &Texton) -> ElementId {
    ElementId(model.sources[texton.library as usize].elements.start + texton.source)
}

/// The variant of each of a scene's textons that is a fragment, which the model then knows.
pub(super) fn fragments(model: &mut Model, scene: &Scene) -> Vec<Option<VariantId>> {
    let known = |texton: &Texton| {
        texton.fragment.then(|| {
            let whole = model.in_variation(element(model, texton), 0);
            model.add_fragment(whole, pixels::mask(&texton.outline), texton.clone())
        })
    };
    scene.textons.iter().map(known).collect()
}

/// The variation nearest to that of an instance; the first of equals.
pub(super) fn variation(model: &Model, instance: &Instance) -> u16 {
    let far = |k: usize| {
        let matrix = &model.variations[k].matrix;
        (0..4).map(|i| (matrix[i] - instance.transform[i]).abs()).sum::<f64>()
    };
    let mut best = 0;
    for k in 1..model.variations.len() {
        if far(k) < far(best) {
            best = k;
        }
    }
    best as u16
}

/// Which library has which part after the bend: that of the nearest texton.
pub(super) fn parts(scene: &Scene, bend: &Bend, libraries: usize) -> Vec<ControlMap> {
    let canvas = bend.canvas();
    let longer = canvas[0].max(canvas[1]);
    let [width, height] =
        canvas.map(|side| (u64::from(side) * u64::from(PARTS_SIDE) / u64::from(longer)).max(1) as usize);
    let mut part: Vec<Option<u32>> = vec![None; width * height];
    let mut queue = VecDeque::new();
    for instance in scene.primary.iter().chain(&scene.secondary) {
        let texton = &scene.textons[instance.texton as usize];
        let Some([x, y]) = bend.texton(instance, texton) else { continue };
        let (x, y) = (x / f64::from(canvas[0]), y / f64::from(canvas[1]));
        if (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) {
            let cell = (y * height as f64) as usize * width + (x * width as f64) as usize;
            if part[cell].is_none() {
                part[cell] = Some(texton.library);
                queue.push_back(cell);
            }
        }
    }
    while let Some(cell) = queue.pop_front() {
        let (x, y) = (cell % width, cell / width);
        let beside = [
            (x > 0).then(|| cell - 1),
            (x + 1 < width).then_some(cell + 1),
            (y > 0).then(|| cell - width),
            (y + 1 < height).then_some(cell + width),
        ];
        for next in beside.into_iter().flatten() {
            if part[next].is_none() {
                part[next] = part[cell];
                queue.push_back(next);
            }
        }
    }
    let share = |library: usize| {
        let values = part.iter().map(|l| f32::from(u8::from(*l == Some(library as u32)))).collect();
        ControlMap::new(width as u32, height as u32, values)
    };
    (0..libraries).filter_map(share).collect()
}
