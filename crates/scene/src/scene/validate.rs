//! Validation of scenes.

use super::{Field, Scene, SynthParams};
use std::collections::BTreeSet;
use vtex_base::document::is_category_name;
use vtex_base::error::clip;
use vtex_base::geometry::Outline;

/// Checks every reference and range of a scene.
pub(super) fn validate(s: &Scene) -> Result<(), String> {
    if ![s.width, s.height].iter().all(|side| SynthParams::SIDE.allows(*side)) {
        return Err(format!("size {} x {} is not {}", s.width, s.height, SynthParams::SIDE));
    }
    if let Some(p) = &s.parameters {
        p.validate().map_err(|e| format!("parameters: {e}"))?;
    }
    for (k, library) in s.libraries.iter().enumerate() {
        if let Some(i) = library.categories.iter().position(|name| !is_category_name(name)) {
            return Err(format!(
                "libraries[{k}].categories[{i}] is not made of letters, digits, blanks and hyphens"
            ));
        }
    }
    for (i, e) in s.elements.iter().enumerate() {
        let Some(library) = s.libraries.get(e.library.index()) else {
            return Err(format!("elements[{i}].library is {}, there are {}", e.library.0, s.libraries.len()));
        };
        let named = library.categories.len();
        if let Some(category) = e.category.filter(|c| named > 0 && c.index() >= named) {
            return Err(format!("elements[{i}].category is {}, its library has {named}", category.0));
        }
        if let Some(fault) = crate::element::fault(&e.shapes) {
            return Err(format!("elements[{i}] {fault}"));
        }
    }
    let (mut ids, mut names) = (BTreeSet::new(), BTreeSet::new());
    for (k, layer) in s.layers.iter().enumerate() {
        let at = format!("layers[{k}]");
        check_layer(&at, &layer.name, layer.region.as_ref(), &mut names)?;
        if let Some(field) = &layer.field {
            check_spacing(&at, field, 1e6)?;
            if let Some(i) = field.points.iter().position(|p| !(p.x.abs() < 1e7 && p.y.abs() < 1e7)) {
                return Err(format!("{at}.field.points[{i}] is out of range"));
            }
        }
        for (i, instance) in layer.instances.iter().enumerate() {
            let at = format_args!("{at}.instances[{i}]");
            if instance.element.index() >= s.elements.len() {
                return Err(format!(
                    "{at}.element is {}, there are {}",
                    instance.element.0,
                    s.elements.len()
                ));
            }
            if !instance.transform.iter().all(|v| v.abs() < 1e7) {
                return Err(format!("{at}.transform is out of range"));
            }
            if let Some(effect) = instance.fault() {
                return Err(format!("{at}.{effect} is out of range"));
            }
            if !ids.insert(instance.id) {
                return Err(format!("{at}.id {} is used twice", instance.id));
            }
        }
    }
    if s.domain.as_ref().is_some_and(|d| d.outline.is_empty()) {
        return Err("domain.outline is empty".into());
    }
    Ok(())
}

/// Checks the properties that layers of libraries and of scenes share: a unique name among `names`, and a
/// region, if any, that is not empty. `at` is its place in the file.
pub(crate) fn check_layer<'a>(
    at: &str,
    name: &'a str,
    region: Option<&Outline>,
    names: &mut BTreeSet<&'a str>,
) -> Result<(), String> {
    if name.is_empty() || !names.insert(name) {
        return Err(format!("{at}.name '{}' is empty or used twice", clip(name)));
    }
    if region.is_some_and(Outline::is_empty) { Err(format!("{at}.region is empty")) } else { Ok(()) }
}

/// Checks the distance between control points of a layer's field: 1 to `most` pixels.
pub(crate) fn check_spacing(at: &str, field: &Field, most: f64) -> Result<(), String> {
    let sound = field.spacing >= 1.0 && field.spacing <= most;
    if sound { Ok(()) } else { Err(format!("{at}.field.spacing = {} is out of range", field.spacing)) }
}
