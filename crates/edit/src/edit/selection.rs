//! The elements of a scene, and the points of its fields, that an operation applies to.

use super::Files;
use super::textons::measured;
use vtex_base::error::EditFault;
use vtex_base::geometry::{Interior, Point, SecondMoments};
use vtex_scene::scene::{
    Action, CategoryId, Condition, Identity, Instance, Layer, LibraryId, Operation, Quantity, Scene,
};

/// A condition, with the shape or the categories that it names.
type Test<'a> = (&'a Condition, Meaning<'a>);

/// What a name in a condition denotes.
enum Meaning<'a> {
    Nothing,
    Shape(&'a Interior),
    Categories(Vec<(LibraryId, CategoryId)>),
}

impl<'a> Meaning<'a> {
    fn new(condition: &Condition, scene: &Scene, files: &'a Files) -> Result<Self, EditFault> {
        Ok(match condition {
            Condition::Place { shape, .. } => Self::Shape(files.shape(shape)?),
            Condition::Named { categories, .. } => Self::Categories(named(scene, categories)?),
            Condition::Among { .. } | Condition::Compare { .. } => Self::Nothing,
        })
    }

    /// Whether a point lies in the shape.
    fn contains(&self, at: Point) -> Option<bool> {
        match self {
            Self::Shape(shape) => Some(shape.contains(at)),
            Self::Nothing | Self::Categories(_) => None,
        }
    }
}

/// The categories of some names or numbers, in all libraries that have them.
fn named(scene: &Scene, categories: &[String]) -> Result<Vec<(LibraryId, CategoryId)>, EditFault> {
    let mut found = Vec::new();
    for name in categories {
        let libraries = scene.libraries.iter().enumerate();
        let own = libraries.filter_map(|(k, library)| {
            CategoryId::find(&library.categories, name).map(|category| (LibraryId(k as u32), category))
        });
        let before = found.len();
        found.extend(own);
        if found.len() == before {
            let mut known: Vec<String> = Vec::new();
            for other in scene.libraries.iter().flat_map(|library| &library.categories) {
                if !known.contains(other) {
                    known.push(other.clone());
                }
            }
            return Err(EditFault::NoCategory { name: name.clone(), known });
        }
    }
    Ok(found)
}

/// The selected elements of each layer of a scene.
#[derive(Clone)]
pub(super) struct Chosen {
    pub(super) layers: Vec<ChosenLayer>,
}

/// Whether each instance of a layer and each point of its field is selected, by index.
#[derive(Clone)]
pub(super) struct ChosenLayer {
    pub(super) instances: Vec<bool>,
    pub(super) points: Vec<bool>,
    /// Whether the colour of a field without points is selected.
    pub(super) fallback: bool,
}

impl Chosen {
    pub(super) fn new(scene: &Scene, operation: &Operation, files: &Files) -> Result<Self, EditFault> {
        let conditions = operation.conditions.iter().map(|c| Ok((c, Meaning::new(c, scene, files)?)));
        let conditions = conditions.collect::<Result<Vec<Test<'_>>, EditFault>>()?;
        let measures = |(c, _): &Test<'_>| {
            matches!(c, Condition::Compare { quantity: Quantity::Area | Quantity::Elongation, .. })
        };
        let moments = if conditions.iter().any(measures) { measured(scene) } else { Vec::new() };
        let asked = operation.layer.as_deref();
        let is_asked = |layer: &Layer| asked.is_none_or(|name| is_called(layer, name));
        if let Some(name) = asked.filter(|_| !scene.layers.iter().any(is_asked)) {
            let known = scene.layers.iter().map(|layer| layer.name.clone()).collect();
            return Err(EditFault::NoLayer { name: name.into(), known });
        }
        let chosen = |layer: &Layer| {
            let is_asked = is_asked(layer);
            let fits = |i: &Instance| is_asked && conditions.iter().all(|c| holds(c, scene, i, &moments));
            // Fields are selected only if their layer is named, or for a palette, which is for all that is seen.
            let is_for_all = matches!(operation.action, Action::Palette { .. });
            let field = layer.field.as_ref().filter(|_| is_asked && (asked.is_some() || is_for_all));
            let points = layer.field.iter().flat_map(|f| &f.points).map(|p| {
                let at = scene.on_canvas(Point::new(p.x, p.y));
                field.is_some() && conditions.iter().all(|c| holds_of_point(c, at))
            });
            ChosenLayer {
                instances: layer.instances.iter().map(fits).collect(),
                points: points.collect(),
                fallback: field.is_some() && conditions.is_empty(),
            }
        };
        Ok(Self { layers: scene.layers.iter().map(chosen).collect() })
    }

    /// Whether each instance of the scene is selected, in painting order.
    pub(super) fn instances(&self) -> impl Iterator<Item = bool> {
        self.layers.iter().flat_map(|layer| &layer.instances).copied()
    }

    /// Restricts the selection to instances that satisfy `instance`, and to points of fields that satisfy
    /// `point`, given by the index of the layer and of the point.
    pub(super) fn only(
        &self,
        scene: &Scene,
        instance: impl Fn(&Instance) -> bool,
        point: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let layers = self.layers.iter().zip(&scene.layers).enumerate().map(|(k, (chosen, layer))| {
            let pairs = chosen.instances.iter().zip(&layer.instances);
            ChosenLayer {
                instances: pairs.map(|(chosen, i)| *chosen && instance(i)).collect(),
                points: chosen.points.iter().enumerate().map(|(i, chosen)| *chosen && point(k, i)).collect(),
                fallback: chosen.fallback,
            }
        });
        Self { layers: layers.collect() }
    }

    /// Number of selected elements and points.
    pub(super) fn count(&self) -> usize {
        let of = |layer: &ChosenLayer| {
            let all = layer.instances.iter().chain(&layer.points).filter(|chosen| **chosen).count();
            all + usize::from(layer.fallback && layer.points.is_empty())
        };
        self.layers.iter().map(of).sum()
    }
}

/// The places that an operation is restricted to.
pub(super) struct ChosenPlaces<'a> {
    conditions: Vec<Test<'a>>,
}

impl<'a> ChosenPlaces<'a> {
    /// Samples of the canvas along each axis.
    const SAMPLES: u32 = 256;

    /// The places of an operation; `None` if it has no condition about places.
    pub(super) fn new(operation: &'a Operation, files: &'a Files) -> Result<Option<Self>, EditFault> {
        let conditions = operation.conditions.iter().filter_map(|condition| match condition {
            Condition::Place { shape, .. } => {
                Some(files.shape(shape).map(|shape| (condition, Meaning::Shape(shape))))
            }
            Condition::Compare { quantity: Quantity::X | Quantity::Y, .. } => {
                Some(Ok((condition, Meaning::Nothing)))
            }
            Condition::Among { .. } | Condition::Named { .. } | Condition::Compare { .. } => None,
        });
        let conditions = conditions.collect::<Result<Vec<Test<'_>>, EditFault>>()?;
        Ok((!conditions.is_empty()).then_some(Self { conditions }))
    }

    /// Whether a point of the canvas is one of the places.
    pub(super) fn hold(&self, at: Point) -> bool {
        self.conditions.iter().all(|c| holds_of_point(c, at))
    }

    /// Their share of a canvas of this size, 0 to 1.
    pub(super) fn share(&self, size: [f64; 2]) -> f64 {
        let count = Self::SAMPLES;
        let at = |k: usize, i: u32| (f64::from(i) + 0.5) * size[k] / f64::from(count);
        let rows = (0..count).flat_map(|y| (0..count).map(move |x| [x, y]));
        let held = rows.filter(|[x, y]| self.hold(Point::new(at(0, *x), at(1, *y)))).count();
        held as f64 / f64::from(count * count)
    }
}

/// Whether a name denotes a layer: its own name, that of its role, or that of its stratum. The name of a
/// layer is that of its stratum with its role appended. Case does not matter, because editors show names with
/// a capital letter.
fn is_called(layer: &Layer, name: &str) -> bool {
    let (own, name, role) = (layer.name.to_lowercase(), name.to_lowercase(), layer.role.name());
    let ends = |rest: &str| rest.is_empty() || rest.strip_prefix(' ') == Some(role);
    name == role || own.strip_prefix(&name).is_some_and(ends)
}

fn holds(
    (condition, meaning): &Test<'_>,
    scene: &Scene,
    instance: &Instance,
    moments: &[SecondMoments],
) -> bool {
    let element = scene.element(instance);
    let moments = || moments[instance.element.index()].moved(instance.affine());
    match condition {
        Condition::Among { identity, numbers, wanted } => {
            let number = match identity {
                Identity::Category => element.category.map(|c| u32::from(c.0)),
                Identity::Library => Some(element.library.0),
                Identity::Id => Some(instance.id.0),
                Identity::Motif => instance.motif,
            };
            number.is_some_and(|n| numbers.contains(&n)) == *wanted
        }
        Condition::Named { wanted, .. } => {
            let own = element.category.map(|category| (element.library, category));
            let is_one = |own| matches!(meaning, Meaning::Categories(named) if named.contains(&own));
            own.is_some_and(is_one) == *wanted
        }
        Condition::Compare { quantity, comparison, limit } => {
            let value = match quantity {
                Quantity::Area => moments().area,
                Quantity::Elongation => moments().elongation(),
                Quantity::X => scene.place(instance).x,
                Quantity::Y => scene.place(instance).y,
            };
            comparison.holds(value, *limit)
        }
        Condition::Place { inside, .. } => meaning.contains(scene.place(instance)) == Some(*inside),
    }
}

/// A point of a field has no property besides its place.
fn holds_of_point((condition, meaning): &Test<'_>, at: Point) -> bool {
    match condition {
        Condition::Compare { quantity: Quantity::X, comparison, limit } => comparison.holds(at.x, *limit),
        Condition::Compare { quantity: Quantity::Y, comparison, limit } => comparison.holds(at.y, *limit),
        Condition::Place { inside, .. } => meaning.contains(at) == Some(*inside),
        Condition::Among { .. } | Condition::Named { .. } | Condition::Compare { .. } => false,
    }
}
