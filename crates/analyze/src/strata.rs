//! The nested layers of a weathered photograph: the layer of each element, and the background of each layer.
//!
//! The map of layers is found with the primaries known, or painted. Borders go around large elements; small
//! ones belong where their centre lies. Each stratum has a palette from its own pixels.

use super::memory::LayersMemory;
use super::{Exemplar, background};
use vtex_base::error::Result;
use vtex_base::progress::Progress;
use vtex_base::raster::LabelMap;
use vtex_field::layers::{Count, FindParams, LayerMap, LayerSearch};
use vtex_scene::element::ElementId;
use vtex_scene::library::{AnalyzeParams, ExemplarElement, ExemplarInstance, ExemplarLayer, Role};
use vtex_scene::scene::Field;

/// The layers of a photograph.
pub(super) struct PhotographStrata {
    /// Their map; each large element lies in one of them. `None` if there is a single layer.
    map: Option<LayerMap>,
    /// The reason for their number, if it was decided.
    pub(super) why: Option<String>,
}

impl PhotographStrata {
    /// Finds the layers of an exemplar, or takes painted ones. `primaries` has a label above 0 for each
    /// known element. `memory` may have the search in the photograph.
    pub(super) fn new(
        exemplar: &Exemplar,
        primaries: &LabelMap,
        params: &AnalyzeParams,
        memory: Option<&mut LayersMemory>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let order = || params.layer_order.iter().map(|&k| k as usize).collect::<Vec<_>>();
        let (map, mut why) = match (&exemplar.layers, params.layers) {
            (Some(painted), _) => {
                painted.check_photograph(exemplar.image.dimensions())?;
                let given = &params.layer_order;
                let map = if given.is_empty() { painted.clone() } else { painted.reordered(&order())? };
                (map, Some("as painted".into()))
            }
            (None, 1) => return Ok(Self { map: None, why: None }),
            (None, count) => {
                let count = if count == 0 { Count::Auto } else { Count::Fixed(count as usize) };
                let order = (!params.layer_order.is_empty()).then(order);
                let wanted = FindParams { count, order, seed: params.seed };
                let fresh;
                let search = match memory {
                    Some(memory) => memory.of(&exemplar.image, params.seed, progress)?,
                    None => {
                        fresh = LayerSearch::new(&exemplar.image, params.seed, progress)?;
                        &fresh
                    }
                };
                let found = search.find(Some(primaries), &wanted, progress)?;
                (found.map, Some(found.decision.why))
            }
        };
        if map.layers.len() < 2 {
            return Ok(Self { map: None, why });
        }
        let areas = primaries.areas();
        let least = LayerMap::least_element([primaries.width, primaries.height]);
        let of = map.layers_of(primaries, areas.len().saturating_sub(1));
        let map = map.with_whole_elements(|i| {
            let element = primaries.labels[i] as usize;
            (element > 0 && areas[element] >= least).then(|| of[element - 1])
        });
        let is_decided = exemplar.layers.is_none() && params.layers == 0;
        let map = if is_decided { surfaces(map, primaries, &mut why) } else { map.without_unused() };
        Ok(Self { map: (map.layers.len() > 1).then_some(map), why })
    }

    /// The layers of the library. `textons` is above 0 in any element, `primaries` in large ones; `elements`
    /// are those of the library.
    pub(super) fn layers(
        &self,
        exemplar: &Exemplar,
        [primaries, textons]: [&LabelMap; 2],
        elements: &[ExemplarElement],
        (background, spacing): (Field, f64),
        params: &AnalyzeParams,
    ) -> Vec<ExemplarLayer> {
        let Some(map) = &self.map else {
            return vtex_scene::library::Library::three_layers(elements, background, spacing);
        };
        let of_elements = self.of_elements(map, primaries, elements);
        let regions = map.outlines([false; 2]);
        let mut layers = Vec::new();
        for (k, layer) in map.layers.iter().enumerate() {
            let beside = |known: &LabelMap| {
                let labels = known.labels.iter().zip(&map.labels.labels);
                let labels = labels.map(|(&known, &l)| u32::from(known > 0 || l as usize != k)).collect();
                LabelMap { labels, ..*known }
            };
            let field = background::palette(&exemplar.image, &beside(primaries), &beside(textons), params);
            let own = |role: Role| {
                let is_own = |i: &usize| {
                    usize::from(of_elements[*i]) == k
                        && elements[*i].category.is_some() == (role == Role::Primary)
                };
                (0..elements.len())
                    .filter(is_own)
                    .map(|i| ExemplarInstance::of(ElementId::after(i)))
                    .collect()
            };
            layers.push(ExemplarLayer {
                name: layer.name.clone(),
                region: k.checked_sub(1).map(|above| regions[above].clone()),
                colour: Some(layer.colour),
                field: Some(field),
                ..ExemplarLayer::new(Role::Background)
            });
            for role in [Role::Secondary, Role::Primary] {
                layers.push(ExemplarLayer {
                    name: format!("{} {}", layer.name, role.name()),
                    spacing: (role == Role::Secondary).then_some(spacing),
                    instances: own(role),
                    ..ExemplarLayer::new(role)
                });
            }
        }
        layers
    }

    /// The layer of each element: the one of most of its pixels, or the one at its centre if it is small.
    fn of_elements(&self, map: &LayerMap, primaries: &LabelMap, elements: &[ExemplarElement]) -> Vec<u8> {
        let count = elements.partition_point(|e| e.category.is_some());
        let mut of = map.layers_of(primaries, count);
        of.extend(elements[count..].iter().map(|e| {
            let [x, y] = [0, 1].map(|k| {
                let size = [map.labels.width, map.labels.height][k];
                (e.centroid[k] as u32).min(size - 1)
            });
            map.labels.get(x, y) as u8
        }));
        of
    }
}

/// The map of those layers that are surfaces, with the reason why others are not.
fn surfaces(map: LayerMap, primaries: &LabelMap, why: &mut Option<String>) -> LayerMap {
    let (map, names) = map.without_layers_of_elements(primaries);
    if !names.is_empty() {
        let why = why.get_or_insert_default();
        let are = if names.len() == 1 { "is no layer" } else { "are no layers" };
        why.push_str(&format!("; {} {are}, but elements", names.join(" and ")));
    }
    map
}
