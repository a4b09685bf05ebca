//! Colourways: the main colours of the selection become those of a palette.
//!
//! The colours that are seen, weighted by the area that they cover, are divided into as many groups as the palette has
//! colours; differences of hue count more than those of lightness. From dark to light, groups take the colours of the
//! palette. The difference of a colour from the mean of its group stays as shading. Between groups, colours move by a
//! mixture. Equal colours stay equal, whatever element or category shows them.

use super::colours::recolour;
use super::selection::Chosen;
use super::textons::selected;
use std::collections::BTreeMap;
use vtex_base::kmeans;
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::stream;
use vtex_scene::scene::{Element, Instance, Scene, Shape};

/// Factor of differences of hue and chroma against those of lightness.
const HUE: f64 = 2.0;
/// Least share of an element's first shape, and of the canvas's background, that is seen.
const SEEN: f64 = 0.15;
/// Area of a soft ellipse at which it shows its colour, as a share.
const SOFT: f64 = 0.4;
/// Binary digits of a component by which colours are put together before they are grouped.
const DIGITS: u32 = 5;

/// Gives the selected elements and points the colours of a palette.
pub(super) fn palette(scene: &mut Scene, chosen: &Chosen, colours: &[Colour]) {
    let moves = Moves::new(&seen(scene, chosen), colours);
    recolour(scene, chosen, |element, colour| {
        // A soft rim is a mixture of its element and the ground, whose lightness may be that of a third colour.
        let rim =
            element.map(Element::base).filter(|base| base.rim.as_ref().is_some_and(|r| r.colour == colour));
        rim.map_or_else(|| moves.of(colour), |base| moves.along(base.colour, colour))
    });
}

/// The selected colours, and the area that each covers, in square pixels.
fn seen(scene: &Scene, chosen: &Chosen) -> Vec<(Colour, f64)> {
    let mut colours = SeenColours::default();
    let mut sizes = vec![0.0; scene.elements.len()];
    let mut bare = vec![0.0; scene.elements.len()];
    let mut covered = 0.0;
    let visible: Vec<f64> = vtex_base::parallel::map(&scene.elements, |element| {
        let area = element.base().area() * softness(element.base());
        let hidden: f64 = element.details().iter().map(|d| d.area() * d.opacity * softness(d)).sum();
        (area - hidden).max(SEEN * area) * element.base().opacity
    });
    let mut own = |instance: &Instance| {
        let index = instance.element.index();
        let size = instance.affine().determinant().abs();
        sizes[index] += size;
        covered += size * visible[index];
        match instance.colour {
            Some(colour) => colours.add(colour, size * visible[index]),
            None => bare[index] += size * visible[index],
        }
    };
    selected(scene, chosen).for_each(&mut own);
    for ((element, size), bare) in scene.elements.iter().zip(&sizes).zip(&bare).filter(|e| *e.0.1 > 0.0) {
        colours.add_shape(element.base(), *bare);
        for detail in element.details() {
            colours.add_shape(detail, size * detail.area() * detail.opacity * softness(detail));
        }
    }
    let canvas = f64::from(scene.width) * f64::from(scene.height);
    let fields = scene.layers.iter().zip(&chosen.layers).filter_map(|(l, c)| Some((l.field.as_ref()?, c)));
    let points: Vec<Colour> = fields
        .flat_map(|(field, chosen)| {
            let own = field.points.iter().zip(&chosen.points).filter(|p| *p.1).map(|p| p.0.colour);
            let fallback = (chosen.fallback && field.points.is_empty()).then_some(field.fallback);
            own.chain(fallback)
        })
        .collect();
    let each = (canvas - covered).max(SEEN * canvas) / points.len().max(1) as f64;
    points.into_iter().for_each(|colour| colours.add(colour, each));
    colours.means()
}

/// The share of a shape's area at which its colour is seen.
fn softness(shape: &Shape) -> f64 {
    if shape.is_soft() { SOFT } else { 1.0 }
}

/// Sums of similar colours, by their first binary digits.
#[derive(Default)]
struct SeenColours(BTreeMap<[u8; 3], ([f64; 3], f64)>);

impl SeenColours {
    fn add(&mut self, colour: Colour, area: f64) {
        if area > 0.0 {
            let (sums, all) = self.0.entry(colour.0.map(|v| v >> (8 - DIGITS))).or_default();
            sums.iter_mut().zip(colour.to_f64()).for_each(|(sum, v)| *sum += area * v);
            *all += area;
        }
    }

    /// The colour of a shape, or both ends of its gradient.
    fn add_shape(&mut self, shape: &Shape, area: f64) {
        match &shape.gradient {
            Some(gradient) => {
                [gradient.start, gradient.end].into_iter().for_each(|c| self.add(c, area / 2.0))
            }
            None => self.add(shape.colour, area),
        }
    }

    fn means(self) -> Vec<(Colour, f64)> {
        let mean = |(sums, all): ([f64; 3], f64)| (Colour::from_f64(sums.map(|sum| sum / all)), all);
        self.0.into_values().map(mean).collect()
    }
}

/// How colours move: the means of groups, and the way of each, in Oklab.
struct Moves(Vec<([f64; 3], [f64; 3])>);

impl Moves {
    fn new(seen: &[(Colour, f64)], colours: &[Colour]) -> Self {
        let points: Vec<[f64; 3]> = seen.iter().map(|s| stretched(lab(s.0))).collect();
        let weights: Vec<f64> = seen.iter().map(|s| s.1).collect();
        let found =
            kmeans::cluster(&points, &weights, colours.len(), |start| stream(0, "edit/palette", start));
        let mut sums = vec![([0.0; 3], 0.0); found.centres.len()];
        for ((colour, area), group) in seen.iter().zip(&found.of) {
            let (sum, all) = &mut sums[*group];
            sum.iter_mut().zip(lab(*colour)).for_each(|(sum, v)| *sum += area * v);
            *all += area;
        }
        sums.retain(|(_, all)| *all > 0.0);
        let mut means: Vec<[f64; 3]> = sums.into_iter().map(|(sum, all)| sum.map(|v| v / all)).collect();
        let mut wanted: Vec<[f64; 3]> = colours.iter().map(|c| lab(*c)).collect();
        let by_lightness = |a: &[f64; 3], b: &[f64; 3]| a[0].total_cmp(&b[0]);
        means.sort_by(by_lightness);
        wanted.sort_by(by_lightness);
        let (count, new) = (means.len(), wanted.len());
        // With more colours than groups, the palette is divided evenly among groups, and each gets the middle colour of
        // its part.
        let way = |(rank, mean): (usize, &[f64; 3])| {
            let target = wanted[(2 * rank + 1) * new / (2 * count)];
            (*mean, std::array::from_fn(|k| target[k] - mean[k]))
        };
        Self(means.iter().enumerate().map(way).collect())
    }

    /// The new colour: moved as the groups are, the nearer the more.
    fn of(&self, colour: Colour) -> Colour {
        self.along(colour, colour)
    }

    /// A colour moved as another one.
    fn along(&self, other: Colour, colour: Colour) -> Colour {
        let own = lab(other);
        let (mut sum, mut all) = ([0.0; 3], 0.0);
        for (mean, way) in &self.0 {
            let [a, b] = [stretched(own), stretched(*mean)];
            let far: f64 = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>() + 1e-7;
            let share = 1.0 / (far * far * far);
            sum.iter_mut().zip(way).for_each(|(sum, v)| *sum += share * v);
            all += share;
        }
        if all == 0.0 {
            return colour;
        }
        let moved = lab(colour);
        Colour::from_oklab(std::array::from_fn(|k| (moved[k] + sum[k] / all) as f32))
    }
}

fn lab(colour: Colour) -> [f64; 3] {
    colour.to_oklab().map(f64::from)
}

fn stretched([l, a, b]: [f64; 3]) -> [f64; 3] {
    [l, HUE * a, HUE * b]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAVES: [Colour; 2] = [Colour([20, 40, 15]), Colour([40, 70, 30])];
    const PETALS: Colour = Colour([235, 235, 230]);
    const HEARTS: Colour = Colour([200, 160, 20]);

    fn moved(palette: &[Colour]) -> [Colour; 4] {
        let seen = [(LEAVES[0], 300.0), (LEAVES[1], 300.0), (PETALS, 300.0), (HEARTS, 30.0)];
        let moves = Moves::new(&seen, palette);
        [LEAVES[0], LEAVES[1], PETALS, HEARTS].map(|colour| moves.of(colour))
    }

    fn is_near(a: Colour, b: Colour) -> bool {
        let [a, b] = [a, b].map(lab);
        (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>() < 0.01
    }

    #[test]
    fn petals_hearts_and_leaves_each_take_a_colour() {
        let [navy, coral, cream] = [Colour([20, 30, 80]), Colour([230, 90, 70]), Colour([250, 235, 200])];
        let [dark, light, petals, hearts] = moved(&[coral, cream, navy]);
        assert!(is_near(petals, cream) && is_near(hearts, coral), "{petals:?} {hearts:?}");
        assert!(is_near(dark, navy) && is_near(light, navy), "{dark:?} {light:?}");
        // Shading stays: lighter leaves are lighter.
        assert!(lab(light)[0] > lab(dark)[0] + 0.05);
    }

    #[test]
    fn rims_move_with_their_element() {
        let palette = [Colour([20, 30, 80]), Colour([230, 60, 70]), Colour([250, 235, 200])];
        let seen = [(LEAVES[0], 300.0), (Colour([130; 3]), 30.0), (PETALS, 300.0)];
        let moves = Moves::new(&seen, &palette);
        let [alone, along] = [moves.of(Colour([131; 3])), moves.along(LEAVES[0], Colour([131; 3]))];
        assert!(is_near(alone, palette[1]) && along.0[2] > along.0[0], "{alone:?} {along:?}");
    }

    #[test]
    fn a_palette_of_more_colours_than_there_are_is_spread() {
        let greys: Vec<Colour> = (0..8).map(|k| Colour([30 * k + 20; 3])).collect();
        let moves = Moves::new(&[(PETALS, 1.0), (LEAVES[0], 1.0)], &greys);
        assert_eq!([moves.of(LEAVES[0]), moves.of(PETALS)], [greys[2], greys[6]]);
        assert_eq!(Moves::new(&[], &greys).of(PETALS), PETALS);
    }
}
