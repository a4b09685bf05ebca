//! Reduces a scene to a few flat colours.

use crate::scene::Scene;
use std::collections::BTreeMap;
use vtex_base::raster::colour::{Colour, squared_distance};

/// Largest number of colours that are clustered: those with the largest areas. All others are first merged
/// with the nearest of these.
const COMPARED: usize = 256;

/// A colour, the sum of its components by area, and its area in pixels.
#[derive(Clone, Copy)]
struct PaletteEntry {
    sum: [f64; 3],
    area: f64,
}

impl PaletteEntry {
    fn colour(&self) -> Colour {
        Colour::from_f64(self.sum.map(|v| v / self.area))
    }

    fn and(&self, other: &Self) -> Self {
        Self { sum: [0, 1, 2].map(|k| self.sum[k] + other.sum[k]), area: self.area + other.area }
    }
}

/// Squared distance in Oklab.
fn distance(a: Colour, b: Colour) -> f64 {
    f64::from(squared_distance(a.to_oklab(), b.to_oklab()))
}

/// Reduces a scene to at most `most` flat colours. Each field becomes one colour, and gradients and soft
/// rims are removed. Colours are merged at the least cost, by distance in Oklab and by area.
pub(super) fn limit_colours(scene: &mut Scene, most: usize) {
    for shape in scene.elements.iter_mut().flat_map(|e| &mut e.shapes) {
        (shape.gradient, shape.rim) = (None, None);
    }
    for field in scene.layers.iter_mut().filter_map(|l| l.field.as_mut()).filter(|f| !f.points.is_empty()) {
        let count = field.points.len() as f64;
        let sum = |k: usize| field.points.iter().map(|p| p.colour.to_f64()[k]).sum::<f64>();
        field.fallback = Colour::from_f64([0, 1, 2].map(|k| sum(k) / count));
        field.points.clear();
    }
    let map = joined(areas(scene), most.max(1));
    let of = |colour: &mut Colour| *colour = map.get(&colour.0).copied().unwrap_or(*colour);
    for shape in scene.elements.iter_mut().flat_map(|e| &mut e.shapes) {
        of(&mut shape.colour);
    }
    for layer in &mut scene.layers {
        layer.field.iter_mut().for_each(|field| of(&mut field.fallback));
        layer.instances.iter_mut().filter_map(|i| i.colour.as_mut()).for_each(of);
    }
}

/// All colours with their areas. A covered part counts for both colours.
fn areas(scene: &Scene) -> BTreeMap<[u8; 3], f64> {
    let mut areas: BTreeMap<[u8; 3], f64> = BTreeMap::new();
    let mut add = |colour: Colour, area: f64| *areas.entry(colour.0).or_default() += area.max(1.0);
    for element in &scene.elements {
        add(element.base().colour, 0.0);
    }
    let mut covered = 0.0;
    for instance in scene.instances() {
        let element = scene.element(instance);
        let details: f64 = element.details().iter().map(|detail| detail.area()).sum();
        let area = element.base().outline.area();
        covered += area;
        add(instance.colour.unwrap_or(element.base().colour), area - details);
        element.details().iter().for_each(|detail| add(detail.colour, detail.area()));
    }
    let rest = f64::from(scene.width) * f64::from(scene.height) - covered;
    for field in scene.layers.iter().filter_map(|layer| layer.field.as_ref()) {
        add(field.fallback, rest);
    }
    areas
}

/// The replacement of each colour, with at most `most` different ones.
fn joined(areas: BTreeMap<[u8; 3], f64>, most: usize) -> BTreeMap<[u8; 3], Colour> {
    let mut all: Vec<(Colour, f64)> = areas.into_iter().map(|(rgb, area)| (Colour(rgb), area)).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.0.cmp(&b.0.0)));
    let entry =
        |&(colour, area): &(Colour, f64)| PaletteEntry { sum: colour.to_f64().map(|v| v * area), area };
    let kept: Vec<Colour> = all.iter().take(COMPARED.max(most)).map(|(colour, _)| *colour).collect();
    let mut entries: Vec<Option<PaletteEntry>> =
        all.iter().take(kept.len()).map(|c| Some(entry(c))).collect();
    // Index of the entry that holds each colour.
    let mut entry_of: Vec<usize> = (0..kept.len()).collect();
    for other in &all[kept.len()..] {
        let near = |k: &usize| distance(kept[*k], other.0);
        let nearest = (0..kept.len()).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap_or(0);
        entry_of.push(nearest);
        entries[nearest] = entries[nearest].map(|e| e.and(&entry(other)));
    }
    while entries.iter().flatten().count() > most {
        let mut best = (f64::INFINITY, 0, 0);
        for (a, first) in entries.iter().enumerate() {
            let Some(first) = first else { continue };
            for (b, second) in entries.iter().enumerate().skip(a + 1) {
                let Some(second) = second else { continue };
                // Increase of the sum of squares when two clusters are merged (Ward 1963).
                let share = first.area * second.area / (first.area + second.area);
                let cost = share * distance(first.colour(), second.colour());
                if cost < best.0 {
                    best = (cost, a, b);
                }
            }
        }
        let (_, a, b) = best;
        let (Some(first), Some(second)) = (entries[a], entries[b].take()) else { break };
        entries[a] = Some(first.and(&second));
        entry_of.iter_mut().filter(|h| **h == b).for_each(|h| *h = a);
    }
    let colour = |k: usize| entries[entry_of[k]].map_or(all[k].0, |e| e.colour());
    (0..all.len()).map(|k| (all[k].0.0, colour(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_colours_are_joined_and_large_areas_weigh_more() {
        let of = |list: &[([u8; 3], f64)], most| joined(list.iter().copied().collect(), most);
        let list = [([200, 0, 0], 10.0), ([210, 0, 0], 30.0), ([0, 0, 200], 5.0)];
        let map = of(&list, 2);
        assert_eq!(map[&[200, 0, 0]], map[&[210, 0, 0]]);
        assert_eq!((map[&[200, 0, 0]].0[0], map[&[0, 0, 200]].0), (208, [0, 0, 200]));
        assert_eq!(of(&list, 3).len(), 3);
        assert!(of(&list, 3).iter().all(|(from, to)| *from == to.0), "few enough stay as they are");
        let many: Vec<([u8; 3], f64)> = (0..900u32).map(|i| ([i as u8, (i / 7) as u8, 9], 1.0)).collect();
        for most in [1, 7] {
            let mut left: Vec<[u8; 3]> = of(&many, most).values().map(|c| c.0).collect();
            left.sort_unstable();
            left.dedup();
            assert!(left.len() <= most, "{left:?}");
        }
    }
}
