//! Fits the judge of `--segmenter texton` to procedural scenes and to photographs labelled by hand, and writes it as Rust
//! source.
//!
//! `cargo run --release --example fit_texton -- crates/segment/src/segment/texton/weights.rs PHOTO_DIR [scenes] [passes]`
//!
//! To be run again whenever the network in `tools/texton` changes. Candidates are the network's
//! masks and the nodes of the region tree. Seeds start at 5 000 000: neither the network's training
//! nor any test or evaluation uses them. Of the labels in `tests/labels`, only the list that choices are made on
//! is used.

use std::collections::BTreeMap;
use std::path::Path;
use vtex::segment::texton::{FEATURES, Judge, MaskCandidate, Texton};

mod fitting;
mod labelled;

use fitting::Sample;
use labelled::{LabelledCrop, UNSURE, areas_known, crops};

const FIRST_SEED: u64 = 5_000_000;
/// Weight of a candidate in a photograph, relative to one of a scene.
const OF_PHOTOGRAPH: f32 = 16.0;
/// Share of a candidate that the crop must hold.
const WITHIN: f32 = 0.9;
/// Share of unsure pixels from which a candidate tells nothing.
const DOUBTFUL: f32 = 0.33;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: fit_texton OUT.rs PHOTO_DIR [scenes] [passes]";
    let [path, photos] = [arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?];
    let scenes: u64 = arguments.next().map_or(Ok(400), |n| n.parse())?;
    let passes: usize = arguments.next().map_or(Ok(10), |n| n.parse())?;
    let segmenter = Texton::new()?;
    let crops = crops(Path::new(&photos), "Chosen on")?;
    let mut samples = fitting::samples(FIRST_SEED, scenes, |image| {
        let found = segmenter.candidates(image, &()).expect("nothing interrupts");
        found.into_iter().map(|c| (c.mask, c.features)).collect()
    });
    for crop in &crops {
        let (found, areas) = (segmenter.candidates(&crop.photo, &())?, areas_known(&crop.truth));
        let before = samples.len();
        samples.extend(found.iter().filter_map(|candidate| of_crop((crop, &areas), candidate)));
        println!("{}: {} samples", crop.name, samples.len() - before);
    }
    let judge: Judge = fitting::fit(&mut samples, passes);
    let made_by = format!(
        "fitted by `tools/fit_texton.rs` to {scenes} procedural scenes and\n//! {} labelled crops of photographs in \
         {passes} passes",
        crops.len()
    );
    std::fs::write(path, fitting::source(&judge, &made_by, "super::Judge"))?;
    Ok(())
}

/// A candidate in a labelled crop, whose elements have some areas, as a sample; `None` if too little is known about it.
fn of_crop((crop, areas): (&LabelledCrop, &[u32]), candidate: &MaskCandidate) -> Option<Sample<FEATURES>> {
    let inside = crop.clip(&candidate.mask);
    let area = inside.area() as f32;
    if area == 0.0 || area < WITHIN * candidate.mask.area() as f32 {
        return None;
    }
    let mut shared: BTreeMap<u32, u32> = BTreeMap::new();
    for (x, y) in inside.pixels() {
        *shared.entry(crop.truth.get(x as u32, y as u32)).or_default() += 1;
    }
    if shared.remove(&UNSURE).is_some_and(|n| n as f32 > DOUBTFUL * area) {
        return None;
    }
    let iou = |(&label, &n): (&u32, &u32)| n as f32 / (area + areas[label as usize] as f32 - n as f32);
    let best = shared.iter().filter(|s| *s.0 > 0).map(iou).fold(0.0, f32::max);
    Some(Sample {
        features: candidate.features,
        target: fitting::target(best),
        weight: OF_PHOTOGRAPH * area.sqrt(),
    })
}
