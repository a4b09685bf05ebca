//! Joins the fields of layers with regions into one field.

use super::{ControlPoint, Field};
use std::borrow::Cow;
use vtex_base::geometry::{Interior, Outline, Point};

/// The fields of layers as one field: each contributes the points at which its layer is on top. Layers are
/// given in painting order by their regions, `None` for everywhere. `None` if there is no layer.
pub fn joined<'a>(layers: &[(Option<&Outline>, &'a Field)]) -> Option<Cow<'a, Field>> {
    let &(_, bottom) = layers.first()?;
    if layers.len() == 1 {
        return Some(Cow::Borrowed(bottom));
    }
    let regions: Vec<Option<Interior>> = layers.iter().map(|(region, _)| region.map(Interior::new)).collect();
    let holds = |k: usize, p: &ControlPoint| {
        regions[k].as_ref().is_none_or(|region| region.contains(Point::new(p.x, p.y)))
    };
    let on_top =
        |k: usize, p: &ControlPoint| holds(k, p) && (k + 1..layers.len()).all(|above| !holds(above, p));
    let own = layers.iter().enumerate().flat_map(|(k, (_, field))| field.points.iter().map(move |p| (k, p)));
    let points = own.filter(|(k, p)| on_top(*k, p)).map(|(_, p)| *p).collect();
    Some(Cow::Owned(Field { points, ..*bottom }))
}
