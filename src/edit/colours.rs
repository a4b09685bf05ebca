//! Other colours, shading kept. All arithmetic is in Oklab.

use super::Draw;
use super::selection::Chosen;
use super::textons::{change, selected_mut};
use crate::raster::colour::Colour;
use crate::scene::{Gradient, Patch, Scene, Texton};
use std::collections::BTreeMap;

/// Mixes `amount` of a colour into those of a share of what is selected.
pub(super) fn tint(scene: &mut Scene, chosen: &Chosen, colour: Colour, amount: f64, share: f64, draw: &Draw) {
    let some = |marks: &[bool], id: &dyn Fn(usize) -> u32| -> Vec<bool> {
        let drawn = |i: usize| share >= 1.0 || draw.of("edit/tint", id(i)).chance(share);
        marks.iter().enumerate().map(|(i, chosen)| *chosen && drawn(i)).collect()
    };
    let chosen = Chosen {
        secondary: some(&chosen.secondary, &|i| scene.secondary[i].id),
        primary: some(&chosen.primary, &|i| scene.primary[i].id),
        background: some(&chosen.background, &|i| i as u32),
    };
    recolour(scene, &chosen, |_, c| c.mixed(colour, amount));
}

/// Moves colours near `from` as far as it is to `to`, those up to `reach` away less and less far.
pub(super) fn recolor(scene: &mut Scene, chosen: &Chosen, from: Colour, to: Colour, reach: f64) {
    let (from, to) = (from.to_oklab(), to.to_oklab());
    let way: [f32; 3] = std::array::from_fn(|i| to[i] - from[i]);
    recolour(scene, chosen, |_, colour| {
        let lab = colour.to_oklab();
        // All within half the reach, none from it on, smoothly between.
        let far = (2.0 * f64::from(distance(lab, from)) / reach - 1.0).clamp(0.0, 1.0);
        let share = 1.0 - far * far * (3.0 - 2.0 * far);
        if share == 0.0 { colour } else { moved(lab, way, share as f32) }
    });
}

/// Gives categories new mean colours, by rank of lightness.
pub(super) fn palette(scene: &mut Scene, chosen: &Chosen, colours: &[Colour]) {
    let means = means(scene);
    let mut ranked: Vec<(Key, [f32; 3])> = means.into_iter().collect();
    ranked.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]).then(a.0.cmp(&b.0)));
    let mut wanted: Vec<[f32; 3]> = colours.iter().map(|c| c.to_oklab()).collect();
    wanted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (count, new) = (ranked.len(), wanted.len());
    // Where there are more colours than categories, those in the middle of their share.
    let chosen_colour = |rank: usize| wanted[(2 * rank + 1) * new / (2 * count)];
    let known: BTreeMap<Key, [f32; 3]> = (ranked.iter().enumerate())
        .map(|(rank, (key, mean))| (*key, std::array::from_fn(|i| chosen_colour(rank)[i] - mean[i])))
        .collect();
    let tones: Vec<(f32, [f32; 3])> =
        ranked.iter().enumerate().map(|(rank, (_, mean))| (mean[0], chosen_colour(rank))).collect();
    let tones = joined(&tones);
    recolour(scene, chosen, |texton, colour| {
        let lab = colour.to_oklab();
        match texton.and_then(key_of).and_then(|key| known.get(&key)) {
            Some(way) => moved(lab, *way, 1.0),
            None => Colour::from_oklab(toned(&tones, lab)),
        }
    });
}

/// One tone for each run of the same colour, at the mean lightness of the run.
fn joined(tones: &[(f32, [f32; 3])]) -> Vec<(f32, [f32; 3])> {
    let runs = tones.chunk_by(|a, b| a.1 == b.1);
    runs.map(|run| (run.iter().map(|t| t.0).sum::<f32>() / run.len() as f32, run[0].1)).collect()
}

/// The colour that stands at the lightness of another, between those of rising tones.
fn toned(tones: &[(f32, [f32; 3])], lab: [f32; 3]) -> [f32; 3] {
    let above = tones.partition_point(|t| t.0 <= lab[0]);
    match (above.checked_sub(1).map(|i| tones[i]), tones.get(above)) {
        (Some((low, a)), Some(&(high, b))) => {
            let share = (lab[0] - low) / (high - low).max(1e-6);
            std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
        }
        // Beyond the ends only lightness goes on.
        (Some((tone, [l, a, b])), None) | (None, Some(&(tone, [l, a, b]))) => [l + lab[0] - tone, a, b],
        (None, None) => lab,
    }
}

/// Library and category.
type Key = (u32, Option<u16>);

/// The group of a texton that belongs to a category.
fn key_of(texton: &Texton) -> Option<Key> {
    texton.category.map(|c| (texton.library, Some(c)))
}

/// The mean colour of each category, by area; of all textons together where there is no category.
fn means(scene: &Scene) -> BTreeMap<Key, [f32; 3]> {
    let any = scene.textons.iter().any(|t| t.category.is_some());
    let mut sums: BTreeMap<Key, [f64; 4]> = BTreeMap::new();
    let means: Vec<[f32; 3]> = crate::parallel::map(&scene.textons, |t| mean(t).to_oklab());
    let areas: Vec<f64> = scene.textons.iter().map(|t| t.outline.area()).collect();
    for instance in scene.primary.iter().chain(&scene.secondary) {
        let index = instance.texton as usize;
        let key = match key_of(&scene.textons[index]) {
            Some(key) => key,
            None if any => continue,
            None => (0, None),
        };
        let lab = instance.colour.map_or(means[index], Colour::to_oklab);
        let area = areas[index] * instance.affine().determinant().abs() + 1e-6;
        let sum = sums.entry(key).or_default();
        (0..3).for_each(|i| sum[i] += area * f64::from(lab[i]));
        sum[3] += area;
    }
    sums.into_iter().map(|(key, [l, a, b, area])| (key, [l, a, b].map(|v| (v / area) as f32))).collect()
}

/// The mean colour of a texton, details included: those painted later hide what lies below them, and
/// what they hide is taken to be the base first.
pub(super) fn mean(texton: &Texton) -> Colour {
    let whole = texton.outline.area();
    let mut sum = [0.0; 3];
    let mut add = |colour: Colour, gradient: Option<&Gradient>, area: f64| {
        let [a, b] = gradient.map_or([colour; 2], |g| [g.start, g.end]).map(Colour::to_oklab);
        (0..3).for_each(|i| sum[i] += area * f64::from(a[i] + b[i]) / 2.0);
    };
    let mut covered = 0.0;
    for detail in &texton.details {
        let area = detail.outline.area();
        add(detail.colour, detail.gradient.as_ref(), area);
        covered += area;
    }
    let base = (whole - covered).max(0.0);
    add(texton.colour, texton.gradient.as_ref(), base);
    let all = covered + base;
    if all > 0.0 { Colour::from_oklab(sum.map(|v| (v / all) as f32)) } else { texton.colour }
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let squares: f32 = (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum();
    libm::sqrtf(squares)
}

fn moved(lab: [f32; 3], way: [f32; 3], share: f32) -> Colour {
    Colour::from_oklab(std::array::from_fn(|i| lab[i] + share * way[i]))
}

/// Gives all colours of what is selected new ones. `new` gets the texton, none for the background.
fn recolour(
    scene: &mut Scene,
    chosen: &Chosen,
    new: impl Fn(Option<&Texton>, Colour) -> Colour + Sync + Send,
) {
    // The instances' own first, as long as they know the textons as they were.
    let own: Vec<Option<Colour>> = super::textons::selected(scene, chosen)
        .map(|i| i.colour.map(|c| new(Some(&scene.textons[i.texton as usize]), c)))
        .collect();
    selected_mut(scene, chosen).zip(own).for_each(|(instance, colour)| instance.colour = colour);
    change(scene, chosen, |texton, _| {
        let new = |c: Colour| new(Some(texton), c);
        let shaded = |g: Option<Gradient>| g.map(|g| Gradient { start: new(g.start), end: new(g.end), ..g });
        Texton {
            colour: new(texton.colour),
            gradient: shaded(texton.gradient),
            details: (texton.details.iter())
                .map(|d| Patch {
                    outline: d.outline.clone(),
                    colour: new(d.colour),
                    gradient: shaded(d.gradient),
                })
                .collect(),
            outline: texton.outline.clone(),
            ..*texton
        }
    });
    let field = &mut scene.background;
    if chosen.background.contains(&true) && !chosen.background.contains(&false) {
        field.fallback = new(None, field.fallback);
    }
    for (point, _) in field.points.iter_mut().zip(&chosen.background).filter(|(_, chosen)| **chosen) {
        point.colour = new(None, point.colour);
    }
}
