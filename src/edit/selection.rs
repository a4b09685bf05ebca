//! Which textons of a scene, and which points of its background, an operation is for.

use super::operation::{Condition, Identity, Layers, Operation, Quantity};
use super::textons::measured;
use crate::geometry::{Point, SecondMoments, wrapped};
use crate::scene::{Instance, Scene};

/// Whether each texton and each point of the background is selected, by their places in the scene.
pub(super) struct Chosen {
    pub(super) secondary: Vec<bool>,
    pub(super) primary: Vec<bool>,
    pub(super) background: Vec<bool>,
    /// Whether the colour of a background without points is.
    pub(super) fallback: bool,
}

impl Chosen {
    pub(super) fn new(scene: &Scene, operation: &Operation) -> Self {
        let layers = operation.layers;
        let conditions = &operation.conditions;
        let measures = |c: &Condition| {
            matches!(c, Condition::Compare { quantity: Quantity::Area | Quantity::Elongation, .. })
        };
        let moments = if conditions.iter().any(measures) { measured(scene) } else { Vec::new() };
        let among = |instances: &[Instance], asked: bool| {
            let fits = |i: &Instance| conditions.iter().all(|c| holds(c, scene, i, &moments));
            instances.iter().map(|i| asked && fits(i)).collect()
        };
        let of_background = layers == Layers::Background;
        let points = scene.background.points.iter();
        Self {
            secondary: among(&scene.secondary, matches!(layers, Layers::Secondary | Layers::All)),
            primary: among(&scene.primary, matches!(layers, Layers::Primary | Layers::All)),
            background: points
                .map(|p| {
                    let at = on_canvas(scene, Point::new(p.x, p.y));
                    of_background && conditions.iter().all(|c| holds_of_point(c, at))
                })
                .collect(),
            fallback: of_background && conditions.is_empty(),
        }
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

fn holds(condition: &Condition, scene: &Scene, instance: &Instance, moments: &[SecondMoments]) -> bool {
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
        Condition::Place { region, inside } => region.contains(place(scene, instance)) == *inside,
    }
}

/// A point of the background has a place and nothing else.
fn holds_of_point(condition: &Condition, at: Point) -> bool {
    match condition {
        Condition::Compare { quantity: Quantity::X, comparison, limit } => comparison.holds(at.x, *limit),
        Condition::Compare { quantity: Quantity::Y, comparison, limit } => comparison.holds(at.y, *limit),
        Condition::Place { region, inside } => region.contains(at) == *inside,
        Condition::Among { .. } | Condition::Compare { .. } => false,
    }
}
