//! Differences between mean colours.

use vtex_base::raster::colour::Colour;
use vtex_base::raster::oklab_map::OklabMap;
use vtex_scene::scene::{Role, Scene};

/// Number of corrections of a difference for colours outside sRGB.
const ROUNDS: usize = 6;

/// Differences between the mean colours of a structure and those of appearances: of elements by role, and of
/// fields.
pub(super) struct Means {
    elements: Vec<Vec<(Role, OklabMap)>>,
    fields: Vec<OklabMap>,
}

impl Means {
    /// The differences between a structure and its appearances; `regions` gives the appearance of each
    /// instance.
    pub(super) fn new(structure: &Scene, appearances: &[Scene], regions: &[usize]) -> Self {
        let roles: Vec<Role> = structure.roles().collect();
        let colours = medians(structure);
        let own = |k: usize, role: Role| -> Vec<[f32; 3]> {
            let all = roles.iter().zip(regions).zip(&colours);
            all.filter(|((r, region), _)| **r == role && **region == k).map(|(_, lab)| *lab).collect()
        };
        let mut all: Vec<Role> = roles.clone();
        all.sort_unstable();
        all.dedup();
        let elements = appearances.iter().enumerate().map(|(k, appearance)| {
            let colours = medians(appearance);
            let of = |role: Role| {
                let wanted: Vec<[f32; 3]> = appearance
                    .roles()
                    .zip(&colours)
                    .filter(|(r, _)| *r == role)
                    .map(|(_, lab)| *lab)
                    .collect();
                // A role that the appearance lacks takes the colours of all its elements.
                let wanted = mean(if wanted.is_empty() { &colours } else { &wanted });
                (role, between(&own(k, role), wanted))
            };
            all.iter().map(|role| of(*role)).collect()
        });
        let ground = field(structure);
        let fields = appearances.iter().map(|appearance| between(&ground, mean(&field(appearance))));
        Self { elements: elements.collect(), fields: fields.collect() }
    }

    /// The change of colours of an element in the region of an appearance.
    pub(super) fn of_element(&self, region: usize, role: Role) -> OklabMap {
        let found = self.elements[region].iter().find(|(known, _)| *known == role);
        found.map_or(OklabMap::IDENTITY, |(_, map)| *map)
    }

    /// The change of colours of a field in the region of an appearance.
    pub(super) fn of_field(&self, region: usize) -> OklabMap {
        self.fields[region]
    }
}

fn medians(scene: &Scene) -> Vec<[f32; 3]> {
    scene.appearances().iter().map(|a| a.median).collect()
}

/// The colours of all fields of a scene.
fn field(scene: &Scene) -> Vec<[f32; 3]> {
    let fields = scene.layers.iter().filter_map(|layer| layer.field.as_ref());
    let colours = fields.flat_map(|field| {
        let plain = field.points.is_empty().then_some(field.fallback);
        field.points.iter().map(|p| p.colour).chain(plain)
    });
    colours.map(Colour::to_oklab).collect()
}

/// `None` without colours.
fn mean(colours: &[[f32; 3]]) -> Option<[f64; 3]> {
    let mut sum = [0.0; 3];
    colours.iter().for_each(|lab| (0..3).for_each(|k| sum[k] += f64::from(lab[k])));
    (!colours.is_empty()).then(|| sum.map(|v| v / colours.len() as f64))
}

/// The shift that gives colours the wanted mean, although some colours reach the border of sRGB.
fn between(colours: &[[f32; 3]], wanted: Option<[f64; 3]>) -> OklabMap {
    let (Some(mut now), Some(wanted)) = (mean(colours), wanted) else { return OklabMap::IDENTITY };
    let mut by = [0.0; 3];
    for _ in 0..ROUNDS {
        (0..3).for_each(|k| by[k] += wanted[k] - now[k]);
        let shifted = |lab: &[f32; 3]| {
            let lab = std::array::from_fn(|k| lab[k] + by[k] as f32);
            Colour::from_oklab(lab).to_oklab()
        };
        let shown: Vec<[f32; 3]> = colours.iter().map(shifted).collect();
        now = mean(&shown).unwrap_or(wanted);
    }
    OklabMap::shift(by.map(|v| v as f32))
}
