//! Validation of libraries.

use super::{AnalyzeParams, LARGEST_SIDE, Library, Role};
use crate::scene::{check_layer, check_spacing};
use std::collections::BTreeSet;
use vtex_base::document::is_category_name;

/// Most backgrounds with fields.
const MOST_STRATA: usize = 6;

/// Checks every reference, range and total of a library.
pub(super) fn validate(l: &Library) -> Result<(), String> {
    l.source.parameters.validate().map_err(|e| format!("source.parameters: {e}"))?;
    let (w, h) = (l.source.width, l.source.height);
    if w == 0 || h == 0 || w > LARGEST_SIDE || h > LARGEST_SIDE {
        return Err(format!("source size {w} x {h} is not within 1 to {LARGEST_SIDE}"));
    }
    if !AnalyzeParams::CONTRAST.allows(l.source.contrast) {
        return Err(format!(
            "source.contrast = {} is not within {}",
            l.source.contrast,
            AnalyzeParams::CONTRAST
        ));
    }
    if let Some(light) = l.source.light.filter(|light| !(1.0..=1e6).contains(light)) {
        return Err(format!("source.light = {light} is not within 1 to 1000000"));
    }
    let copies = l.source.copies;
    if copies.iter().zip([w, h]).any(|(count, side)| !(1..=side).contains(count)) {
        return Err(format!("source.copies = {copies:?} do not fit the exemplar"));
    }
    let [wide, high] = [l.arrangement.width, l.arrangement.height];
    let maps = [(w, wide, l.source.scale[0]), (h, high, l.source.scale[1])];
    let fits = |(side, pixels, scale): (u32, u32, f64)| {
        // A drawing's page may end within a unit.
        let slack = if scale == 1.0 { 0.0 } else { 0.5 + 0.501 * scale };
        let apart = (f64::from(side) * scale - f64::from(pixels)).abs();
        scale.is_finite() && scale > 0.0 && apart <= slack && (1..=LARGEST_SIDE).contains(&pixels)
    };
    if !maps.into_iter().all(fits) {
        return Err("arrangement and source differ in size".into());
    }
    if l.descriptor_half > LARGEST_SIDE {
        return Err(format!("descriptor_half = {} is above {LARGEST_SIDE}", l.descriptor_half));
    }
    l.arrangement.check(l.primaries().len() as u32)?;
    if let Some(guide) = &l.guide {
        guide.check(wide, high)?;
    }
    // Its limits are pixels, of which a unit of a small drawing has several; places are rounded.
    let pixels = l.source.scale.map(|scale| 1.01 * scale.max(1.0));
    if let Some(fault) = l.lattice.as_ref().and_then(|lattice| lattice.scaled(pixels).fault()) {
        return Err(format!("lattice {fault}"));
    }
    share("coverage", l.coverage)?;
    let [right, below] = maps.map(|(_, pixels, scale)| f64::from(pixels) / scale + 0.01);
    let inside = |what: &str, c: [f64; 2]| {
        let ok = c[0] >= 0.0 && c[1] >= 0.0 && c[0] <= right && c[1] <= below;
        if ok { Ok(()) } else { Err(format!("{what}.centroid {c:?} lies outside the exemplar")) }
    };
    let first_secondary = l.primaries().len();
    for (i, e) in l.elements.iter().enumerate() {
        let at = format_args!("elements[{i}]");
        match e.category {
            Some(category) if category.index() >= l.categories.len() => {
                let count = l.categories.len();
                return Err(format!("{at}.category is {}, there are {count} categories", category.0));
            }
            Some(_) if i >= first_secondary => {
                return Err(format!("{at} has a category, and elements[{first_secondary}] has none"));
            }
            Some(_) | None => {}
        }
        if let Some(fault) = crate::element::fault(&e.shapes) {
            return Err(format!("{at} {fault}"));
        }
        if e.outline().is_empty() || e.area == 0 {
            return Err(format!("{at} is empty"));
        }
        if e.difference.is_some_and(|d| d.iter().any(|v| v.abs() > 255)) {
            return Err(format!("{at}.difference is beyond ±255"));
        }
        share(&format!("{at}.compactness"), e.compactness.unwrap_or(0.0))?;
        inside(&at.to_string(), e.centroid)?;
    }
    validate_layers(l)?;
    super::motif::validate(l)?;
    for (i, c) in l.categories.iter().enumerate() {
        if c.name.is_some() != l.categories[0].name.is_some() {
            return Err(format!("categories[{i}] and categories[0] do not both have a name"));
        }
        let is_taken =
            |name: &String| l.categories[..i].iter().any(|other| other.name.as_ref() == Some(name));
        if c.name.as_ref().is_some_and(|name| !is_category_name(name) || is_taken(name)) {
            return Err(format!(
                "categories[{i}].name is taken, or not made of letters, digits, blanks and hyphens"
            ));
        }
        share(&format!("categories[{i}].coverage"), c.coverage)?;
        if !c.centre.iter().all(|v| v.is_finite()) {
            return Err(format!("categories[{i}].centre is not finite"));
        }
        let of_it = |e: &&super::ExemplarElement| e.category.is_some_and(|c| c.index() == i);
        let members = l.primaries().iter().filter(of_it).count();
        if members != c.members as usize {
            return Err(format!("categories[{i}].members is {}, counted {members}", c.members));
        }
    }
    Ok(())
}

/// Checks that every element is in one layer of its role, and checks the layers' fields.
fn validate_layers(l: &Library) -> Result<(), String> {
    let backgrounds = l.layers.iter().filter(|layer| layer.role == Role::Background && layer.field.is_some());
    match backgrounds.clone().count() {
        0 => return Err("no background layer has a field".into()),
        1..=MOST_STRATA => {}
        count => return Err(format!("{count} background layers have fields, at most {MOST_STRATA} may")),
    }
    if backgrounds.skip(1).any(|layer| layer.region.is_none()) {
        return Err("a background above the lowest has no region".into());
    }
    let first_secondary = l.primaries().len();
    let mut names = BTreeSet::new();
    for (k, layer) in l.layers.iter().enumerate() {
        let at = format!("layers[{k}]");
        check_layer(&at, &layer.name, layer.region.as_ref(), &mut names)?;
        if layer.spacing.is_some_and(|s| !(0.0..=f64::from(LARGEST_SIDE)).contains(&s)) {
            return Err(format!("{at}.spacing is out of range"));
        }
        if let Some(field) = &layer.field {
            check_spacing(&at, field, f64::from(LARGEST_SIDE))?;
            if let Some(i) = field.points.iter().position(|p| !(p.x.abs() < 1e6 && p.y.abs() < 1e6)) {
                return Err(format!("{at}.field.points[{i}] lies far outside the exemplar"));
            }
        }
        for (i, instance) in layer.instances.iter().enumerate() {
            let at = format_args!("{at}.instances[{i}]");
            let element = instance.element.index();
            if element >= l.elements.len() {
                return Err(format!("{at}.element is {element}, there are {}", l.elements.len()));
            }
            let role = if element < first_secondary { Role::Primary } else { Role::Secondary };
            if role != layer.role {
                return Err(format!("{at}: element {element} is not a {} element", layer.role.name()));
            }
            if !instance.transform.iter().all(|v| v.abs() < 1e6) {
                return Err(format!("{at}.transform is out of range"));
            }
        }
    }
    Ok(())
}

fn share(name: &str, value: f64) -> Result<(), String> {
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(format!("{name} = {value} is not within 0 to 1")) }
}
