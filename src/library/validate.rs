//! Validation of libraries.

use super::{LARGEST_SIDE, Library};

/// Checks every reference, range and total of a library.
pub(super) fn validate(l: &Library) -> Result<(), String> {
    l.source.parameters.validate().map_err(|e| format!("source.parameters: {e}"))?;
    let (w, h) = (l.source.width, l.source.height);
    if w == 0 || h == 0 || w > LARGEST_SIDE || h > LARGEST_SIDE {
        return Err(format!("source size {w} x {h} is not within 1 to {LARGEST_SIDE}"));
    }
    if (l.arrangement.width, l.arrangement.height) != (w, h) {
        return Err("arrangement and source differ in size".into());
    }
    if l.descriptor_half > LARGEST_SIDE {
        return Err(format!("descriptor_half = {} is above {LARGEST_SIDE}", l.descriptor_half));
    }
    l.arrangement.check(l.primaries.len() as u32)?;
    if let Some(guide) = &l.guide {
        guide.check(w, h)?;
    }
    share("coverage", l.coverage)?;
    let inside = |what: &str, c: [f64; 2]| {
        let ok = c[0] >= 0.0 && c[1] >= 0.0 && c[0] <= f64::from(w) && c[1] <= f64::from(h);
        if ok { Ok(()) } else { Err(format!("{what}.centroid {c:?} lies outside the exemplar")) }
    };
    for (i, p) in l.primaries.iter().enumerate() {
        if p.id.0 as usize != i {
            return Err(format!("primaries[{i}].id is {}", p.id.0));
        }
        if usize::from(p.category.0) >= l.categories.len() {
            return Err(format!(
                "primaries[{i}].category is {}, there are {} categories",
                p.category.0,
                l.categories.len()
            ));
        }
        if p.outline.is_empty() || p.area == 0 {
            return Err(format!("primaries[{i}] is empty"));
        }
        let gradients = p.details.iter().filter_map(|d| d.gradient.as_ref()).chain(&p.gradient);
        if let Some(fault) = gradients.filter_map(crate::scene::Gradient::fault).next() {
            return Err(format!("primaries[{i}]: a gradient {fault}"));
        }
        share(&format!("primaries[{i}].compactness"), p.compactness)?;
        inside(&format!("primaries[{i}]"), p.centroid)?;
    }
    for (i, c) in l.categories.iter().enumerate() {
        share(&format!("categories[{i}].coverage"), c.coverage)?;
        if !c.centre.iter().all(|v| v.is_finite()) {
            return Err(format!("categories[{i}].centre is not finite"));
        }
        let members = l.primaries.iter().filter(|p| usize::from(p.category.0) == i).count();
        if members != c.members as usize {
            return Err(format!("categories[{i}].members is {}, counted {members}", c.members));
        }
    }
    if !(0.0..=f64::from(LARGEST_SIDE)).contains(&l.secondaries.spacing) {
        return Err(format!("secondaries.spacing = {} is out of range", l.secondaries.spacing));
    }
    for (i, s) in l.secondaries.textons.iter().enumerate() {
        if s.outline.is_empty() || s.area == 0 {
            return Err(format!("secondaries.textons[{i}] is empty"));
        }
        if s.difference.iter().any(|d| d.abs() > 255) {
            return Err(format!("secondaries.textons[{i}].difference is beyond ±255"));
        }
        inside(&format!("secondaries.textons[{i}]"), s.centroid)?;
    }
    if !(l.background.spacing >= 1.0 && l.background.spacing <= f64::from(LARGEST_SIDE)) {
        return Err(format!("background.spacing = {} is out of range", l.background.spacing));
    }
    for (i, s) in l.background.sites.iter().enumerate() {
        if !(s.x.abs() < 1e6 && s.y.abs() < 1e6) {
            return Err(format!("background.sites[{i}] lies far outside the exemplar"));
        }
    }
    Ok(())
}

fn share(name: &str, value: f64) -> Result<(), String> {
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(format!("{name} = {value} is not within 0 to 1")) }
}
