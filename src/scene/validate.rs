//! Validation of scenes.

use super::{Scene, SynthParams};

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
    for (i, t) in s.textons.iter().enumerate() {
        if t.library as usize >= s.libraries.len() {
            return Err(format!("textons[{i}].library is {}, there are {}", t.library, s.libraries.len()));
        }
        let gradients = t.details.iter().filter_map(|d| d.gradient.as_ref()).chain(&t.gradient);
        if let Some(fault) = gradients.filter_map(super::Gradient::fault).next() {
            return Err(format!("textons[{i}]: a gradient {fault}"));
        }
    }
    let mut ids = std::collections::BTreeSet::new();
    for (layer, instances) in [("secondary", &s.secondary), ("primary", &s.primary)] {
        for (i, instance) in instances.iter().enumerate() {
            if instance.texton as usize >= s.textons.len() {
                return Err(format!(
                    "{layer}[{i}].texton is {}, there are {}",
                    instance.texton,
                    s.textons.len()
                ));
            }
            if !instance.transform.iter().all(|v| v.abs() < 1e7) {
                return Err(format!("{layer}[{i}].transform is out of range"));
            }
            if let Some(effect) = instance.fault() {
                return Err(format!("{layer}[{i}].{effect} is out of range"));
            }
            if !ids.insert(instance.id) {
                return Err(format!("{layer}[{i}].id {} is used twice", instance.id));
            }
        }
    }
    if !(s.background.spacing >= 1.0 && s.background.spacing <= 1e6) {
        return Err(format!("background.spacing = {} is out of range", s.background.spacing));
    }
    if s.domain.as_ref().is_some_and(|d| d.outline.is_empty()) {
        return Err("domain.outline is empty".into());
    }
    for (i, p) in s.background.points.iter().enumerate() {
        if !(p.x.abs() < 1e7 && p.y.abs() < 1e7) {
            return Err(format!("background.points[{i}] is out of range"));
        }
    }
    Ok(())
}
