//! Validation of scenes.

use super::{Field, Scene, SynthParams};
use crate::geometry::Outline;
use std::collections::BTreeSet;

/// Checks every reference and range of a scene.
pub(super) fn validate(s: &Scene) -> Result<(), String> {
    let side = |v: u32| (1..=SynthParams::LARGEST_SIDE).contains(&v);
    if !side(s.width) || !side(s.height) {
        return Err(format!(
            "size {} x {} is not within 1 to {}",
            s.width,
            s.height,
            SynthParams::LARGEST_SIDE
        ));
    }
    if let Some(p) = &s.parameters {
        p.validate().map_err(|e| format!("parameters: {e}"))?;
    }
    for (i, e) in s.elements.iter().enumerate() {
        if e.library.index() >= s.libraries.len() {
            return Err(format!("elements[{i}].library is {}, there are {}", e.library, s.libraries.len()));
        }
        if let Some(fault) = crate::element::fault(&e.shapes) {
            return Err(format!("elements[{i}] {fault}"));
        }
    }
    let (mut ids, mut names) = (BTreeSet::new(), BTreeSet::new());
    for (k, layer) in s.layers.iter().enumerate() {
        let at = format!("layers[{k}]");
        if layer.name.is_empty() || !names.insert(&layer.name) {
            return Err(format!("{at}.name '{}' is empty or used twice", crate::error::clip(&layer.name)));
        }
        if layer.region.as_ref().is_some_and(Outline::is_empty) {
            return Err(format!("{at}.region is empty"));
        }
        if let Some(field) = &layer.field {
            validate_field(&at, field)?;
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

fn validate_field(layer: &str, field: &Field) -> Result<(), String> {
    if !(field.spacing >= 1.0 && field.spacing <= 1e6) {
        return Err(format!("{layer}.field.spacing = {} is out of range", field.spacing));
    }
    for (i, p) in field.points.iter().enumerate() {
        if !(p.x.abs() < 1e7 && p.y.abs() < 1e7) {
            return Err(format!("{layer}.field.points[{i}] is out of range"));
        }
    }
    Ok(())
}
