//! The elements of an appearance, indexed by role and elongation.

use vtex_base::sampling::Stream;
use vtex_scene::element::Gaussian;
use vtex_scene::scene::{Instance, Role, Scene};

/// Share of the donors, the nearest in elongation, of which one is drawn. A small share deforms elements
/// little; a large one repeats them less.
const NEAREST: f64 = 0.25;
/// Least number of donors to draw from.
const FEWEST: usize = 12;

/// An element of an appearance with its instance.
pub(super) struct Donor<'a> {
    pub(super) instance: &'a Instance,
    pub(super) gaussian: Gaussian,
}

/// All donors of one appearance.
pub(super) struct Donors<'a> {
    /// Donors by role, sorted by the logarithm of the elongation.
    of_role: Vec<(Role, Vec<(f64, Donor<'a>)>)>,
}

impl<'a> Donors<'a> {
    /// All elements of a scene that are not degenerate. Elements that a border of the scene may have cut are
    /// left out, unless their layer has very few.
    pub(super) fn new(scene: &'a Scene) -> Self {
        let gaussians = scene.gaussians();
        let mut of_role: Vec<(Role, Vec<(f64, Donor<'a>)>)> = Vec::new();
        let mut rest = &gaussians[..];
        for layer in &scene.layers {
            let (own, others) = rest.split_at(layer.instances.len());
            rest = others;
            let donor = |(instance, gaussian): (&'a Instance, &Option<Gaussian>)| {
                let gaussian = (*gaussian)?;
                Some((elongation(&gaussian), Donor { instance, gaussian }))
            };
            let own = layer.instances.iter().zip(own);
            let whole: Vec<_> = own.clone().filter(|(i, _)| is_whole(scene, i)).filter_map(donor).collect();
            let donors = if whole.len() >= FEWEST { whole } else { own.filter_map(donor).collect() };
            match of_role.iter().position(|(role, _)| *role == layer.role) {
                Some(known) => of_role[known].1.extend(donors),
                None => of_role.push((layer.role, donors)),
            }
        }
        for (_, donors) in &mut of_role {
            donors.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Self { of_role }
    }

    /// Whether there are donors of a role.
    pub(super) fn has(&self, role: Role) -> bool {
        self.of_role.iter().any(|(known, donors)| *known == role && !donors.is_empty())
    }

    /// A donor for an element, drawn from those of its role with a similar elongation. `None` if there is
    /// none of its role.
    pub(super) fn draw(&self, role: Role, own: &Gaussian, mut random: Stream) -> Option<&Donor<'a>> {
        let alike = self.of_elongation(role, own)?;
        Some(&alike[random.index(alike.len())].1)
    }

    /// The nearest of the donors with a similar elongation; ties go to the first.
    pub(super) fn nearest(
        &self,
        role: Role,
        own: &Gaussian,
        distance: impl Fn(&Instance) -> f32,
    ) -> Option<&Donor<'a>> {
        let alike = self.of_elongation(role, own)?.iter().map(|(_, donor)| (distance(donor.instance), donor));
        alike.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, donor)| donor)
    }

    /// The donors of a role with an elongation similar to an element's; `None` if there are none.
    fn of_elongation(&self, role: Role, own: &Gaussian) -> Option<&[(f64, Donor<'a>)]> {
        let (_, donors) = self.of_role.iter().find(|(known, donors)| *known == role && !donors.is_empty())?;
        let wanted = elongation(own);
        let count = (libm::ceil(donors.len() as f64 * NEAREST) as usize).max(FEWEST).min(donors.len());
        let at = donors.partition_point(|(e, _)| *e < wanted);
        let first = at.saturating_sub(count / 2).min(donors.len() - count);
        Some(&donors[first..first + count])
    }
}

fn elongation(gaussian: &Gaussian) -> f64 {
    let [long, short] = gaussian.deviations();
    libm::log(long / short)
}

/// Whether an element is complete: not a part of one, and not cut by a border of the canvas that does not
/// repeat.
fn is_whole(scene: &Scene, instance: &Instance) -> bool {
    const MARGIN: f64 = 1.0;
    let element = scene.element(instance);
    let bounds = instance.affine().transform_rect_bbox(element.bounds());
    let within = |wrap: bool, low: f64, high: f64, size: u32| {
        wrap || (low >= MARGIN && high <= f64::from(size) - MARGIN)
    };
    !element.fused
        && within(scene.tile.x, bounds.x0, bounds.x1, scene.width)
        && within(scene.tile.y, bounds.y0, bounds.y1, scene.height)
}
