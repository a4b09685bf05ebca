//! Which textons of a scene, and which points of its background, an operation is for.

use super::Files;
use super::textons::measured;
use crate::error::EditFault;
use crate::geometry::{Point, Region, SecondMoments, wrapped};
use crate::scene::{Condition, Identity, Instance, Layers, Operation, Quantity, Scene};

/// A condition and the shape that it names.
type Test<'a> = (&'a Condition, Option<&'a Region>);

/// Whether each texton and each point of the background is selected, by their places in the scene.
pub(super) struct Chosen {
    pub(super) secondary: Vec<bool>,
    pub(super) primary: Vec<bool>,
    pub(super) background: Vec<bool>,
    /// Whether the colour of a background without points is.
    pub(super) fallback: bool,
}

impl Chosen {
    pub(super) fn new(scene: &Scene, operation: &Operation, files: &Files) -> Result<Self, EditFault> {
        let layers = operation.layers;
        let conditions = operation.conditions.iter().map(|condition| {
            let shape = match condition {
                Condition::Place { shape, .. } => Some(files.shape(shape)?),
                Condition::Among { .. } | Condition::Compare { .. } => None,
            };
            Ok((condition, shape))
        });
        let conditions = conditions.collect::<Result<Vec<Test<'_>>, EditFault>>()?;
        let measures = |(c, _): &Test<'_>| {
            matches!(c, Condition::Compare { quantity: Quantity::Area | Quantity::Elongation, .. })
        };
        let moments = if conditions.iter().any(measures) { measured(scene) } else { Vec::new() };
        let among = |instances: &[Instance], asked: bool| {
            let fits = |i: &Instance| conditions.iter().all(|c| holds(*c, scene, i, &moments));
            instances.iter().map(|i| asked && fits(i)).collect()
        };
        let of_background = layers == Layers::Background;
        let points = scene.background.points.iter();
        Ok(Self {
            secondary: among(&scene.secondary, matches!(layers, Layers::Secondary | Layers::All)),
            primary: among(&scene.primary, matches!(layers, Layers::Primary | Layers::All)),
            background: points
                .map(|p| {
                    let at = on_canvas(scene, Point::new(p.x, p.y));
                    of_background && conditions.iter().all(|c| holds_of_point(*c, at))
                })
                .collect(),
            fallback: of_background && conditions.is_empty(),
        })
    }

    /// Those of them for which the place of a secondary, a primary or a point of the background fulfils
    /// something.
    pub(super) fn only(
        &self,
        secondary: impl Fn(usize) -> bool,
        primary: impl Fn(usize) -> bool,
        background: impl Fn(usize) -> bool,
    ) -> Self {
        let some = |marks: &[bool], fits: &dyn Fn(usize) -> bool| -> Vec<bool> {
            marks.iter().enumerate().map(|(i, chosen)| *chosen && fits(i)).collect()
        };
        Self {
            secondary: some(&self.secondary, &secondary),
            primary: some(&self.primary, &primary),
            background: some(&self.background, &background),
            fallback: self.fallback,
        }
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        let all = [&self.secondary, &self.primary, &self.background];
        let points = all.into_iter().flatten().filter(|chosen| **chosen).count();
        points + usize::from(self.fallback && self.background.is_empty())
    }
}

/// Where the centre of a texton lies: its origin, on the canvas where the scene repeats.
pub(super) fn place(scene: &Scene, instance: &Instance) -> Point {
    let [.., x, y] = instance.transform;
    on_canvas(scene, Point::new(x, y))
}

fn on_canvas(scene: &Scene, p: Point) -> Point {
    let [width, height] = scene.periods();
    Point::new(wrapped(p.x, width), wrapped(p.y, height))
}

fn holds(
    (condition, shape): Test<'_>,
    scene: &Scene,
    instance: &Instance,
    moments: &[SecondMoments],
) -> bool {
    let texton = &scene.textons[instance.texton as usize];
    let moments = || moments[instance.texton as usize].moved(instance.affine());
    match condition {
        Condition::Among { identity, numbers, wanted } => {
            let number = match identity {
                Identity::Category => texton.category.map(u32::from),
                Identity::Library => Some(texton.library),
                Identity::Id => Some(instance.id),
            };
            number.is_some_and(|n| numbers.contains(&n)) == *wanted
        }
        Condition::Compare { quantity, comparison, limit } => {
            let value = match quantity {
                Quantity::Area => moments().area,
                Quantity::Elongation => moments().elongation(),
                Quantity::X => place(scene, instance).x,
                Quantity::Y => place(scene, instance).y,
            };
            comparison.holds(value, *limit)
        }
        Condition::Place { inside, .. } => {
            shape.is_some_and(|shape| shape.contains(place(scene, instance)) == *inside)
        }
    }
}

/// A point of the background has a place and nothing else.
fn holds_of_point((condition, shape): Test<'_>, at: Point) -> bool {
    match condition {
        Condition::Compare { quantity: Quantity::X, comparison, limit } => comparison.holds(at.x, *limit),
        Condition::Compare { quantity: Quantity::Y, comparison, limit } => comparison.holds(at.y, *limit),
        Condition::Place { inside, .. } => shape.is_some_and(|shape| shape.contains(at) == *inside),
        Condition::Among { .. } | Condition::Compare { .. } => false,
    }
}
