//! Recolours instances, each by an affine map of Oklab.

use super::{Element, ElementId, Instance};
use std::collections::BTreeMap;
use vtex_base::raster::oklab_map::OklabMap;

/// Recolours instances one by one. Elements that several instances share are copied once for each change of
/// colours; elements of one plain shape are not copied.
#[derive(Default)]
pub struct Repaint {
    known: BTreeMap<(ElementId, [[u32; 4]; 3]), ElementId>,
}

impl Repaint {
    /// Recolours an instance. Adds the elements that it needs to `elements`.
    pub fn paint(&mut self, elements: &mut Vec<Element>, instance: &mut Instance, map: &OklabMap) {
        if *map == OklabMap::IDENTITY {
            return;
        }
        let element = &elements[instance.element.index()];
        let shaded = instance.colour.is_none() && element.base().gradient.is_some();
        let is_plain = element.details().is_empty() && element.base().rim.is_none();
        let own = instance.colour.unwrap_or(element.base().colour);
        if is_plain && !shaded {
            instance.colour = Some(map.of(own));
            return;
        }
        instance.colour = instance.colour.map(|colour| map.of(colour));
        instance.element = *self.known.entry((instance.element, map.key())).or_insert_with(|| {
            let element = &elements[instance.element.index()];
            let shapes = element.shapes.iter().map(|s| s.recoloured(|c| map.of(c))).collect();
            elements.push(element.with_shapes(shapes));
            ElementId::after(elements.len() - 1)
        });
    }
}
