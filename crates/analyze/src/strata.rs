//! The nested layers of a weathered photograph: the background of each layer, and the layer of each element.
//!
//! The map of layers is found with the primaries known, or painted. Borders go around large elements; spots
//! belong where their centre lies, other elements where most of their pixels lie. Each stratum has a palette from its
//! own pixels, and elements are sought on the background of the stratum that they lie in.

use super::margin::Margin;
use super::{Exemplar, background};
use image::RgbImage;
use vtex_base::error::Result;
use vtex_base::parallel;
use vtex_base::progress::Progress;
use vtex_base::raster::LabelMap;
use vtex_field::layers::{Count, FindParams, LayerMap, LayerSearch};
use vtex_scene::element::ElementId;
use vtex_scene::library::{AnalyzeParams, ExemplarElement, ExemplarInstance, ExemplarLayer, Role};
use vtex_scene::scene::field::Interpolant;
use vtex_scene::scene::{Field, Tile, pixels};

/// The search for layers, and what it was made of: the photograph, and a seed.
#[derive(Default)]
pub(super) struct LayersMemory(Option<(RgbImage, u64, LayerSearch)>);

impl LayersMemory {
    /// The search in a photograph.
    ///
    /// # Errors
    /// [`vtex_base::Error::Interrupted`].
    pub(super) fn of(
        &mut self,
        image: &RgbImage,
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<&LayerSearch> {
        let is_same = |(known, of, _): &(RgbImage, u64, LayerSearch)| *of == seed && known == image;
        let kept = match self.0.take().filter(is_same) {
            Some(kept) => kept,
            None => (image.clone(), seed, LayerSearch::new(image, seed, progress)?),
        };
        Ok(&self.0.insert(kept).2)
    }
}

/// The layers of a photograph.
pub(super) struct PhotographStrata {
    /// Their map; each large element lies in one of them. `None` if there is a single layer.
    map: Option<LayerMap>,
    /// The background of each layer.
    pub(super) fields: Vec<Field>,
    /// The reason for their number, if it was decided.
    pub(super) why: Option<String>,
}

impl PhotographStrata {
    /// The layers of an exemplar and their backgrounds. `primaries` has a label above 0 for each known primary,
    /// `textons` for any element. `memory` may have the search in the photograph.
    ///
    /// # Errors
    /// Those of [`LayerSearch::find`], and of painted layers that do not fit the exemplar.
    pub(super) fn new(
        exemplar: &Exemplar,
        [primaries, textons]: [&LabelMap; 2],
        params: &AnalyzeParams,
        memory: Option<&mut LayersMemory>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let (map, why) = found(exemplar, primaries, params, memory, progress)?;
        let Some(map) = map else {
            let field = background::palette(&exemplar.image, primaries, textons, params);
            return Ok(Self { map: None, fields: vec![field], why });
        };
        let palette = |k: &usize| {
            let or_beside = |known: &LabelMap| {
                let labels = known.labels.iter().zip(&map.labels.labels);
                let labels = labels.map(|(&known, &l)| u32::from(known > 0 || l as usize != *k)).collect();
                LabelMap { labels, ..*known }
            };
            background::palette(&exemplar.image, &or_beside(primaries), &or_beside(textons), params)
        };
        let layers: Vec<usize> = (0..map.layers.len()).collect();
        let fields = parallel::map(&layers, palette);
        Ok(Self { map: Some(map), fields, why })
    }

    /// What lies behind all elements.
    pub(super) fn behind<'a>(&'a self, margin: &'a Margin, tile: Tile) -> BehindElements<'a> {
        let [width, height] = margin.size();
        let fields = self.fields.iter().map(|field| Interpolant::new(field, width, height, tile)).collect();
        BehindElements { margin, fields, layers: self.map.as_ref().map(|map| &map.labels) }
    }

    /// The layers of the library. `primaries` is above 0 in large elements; `elements` are those of the library.
    pub(super) fn layers(
        &self,
        primaries: &LabelMap,
        elements: &[ExemplarElement],
        spacing: f64,
    ) -> Vec<ExemplarLayer> {
        let Some(map) = &self.map else {
            return vtex_scene::library::Library::three_layers(elements, self.fields[0].clone(), spacing);
        };
        let of_elements = self.of_elements(map, primaries, elements);
        let regions = map.outlines([false; 2]);
        let mut layers = Vec::new();
        for (k, layer) in map.layers.iter().enumerate() {
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
                field: Some(self.fields[k].clone()),
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

    /// The layer of each element: the one of most of its pixels, and for spots the one at their centre.
    fn of_elements(&self, map: &LayerMap, primaries: &LabelMap, elements: &[ExemplarElement]) -> Vec<u8> {
        let count = elements.partition_point(|e| e.category.is_some());
        let mut of = map.layers_of(primaries, count);
        of.extend(parallel::map(&elements[count..], |e| {
            let at_centre = label(&map.labels, e.centroid) as u8;
            let base = &e.shapes[0];
            if base.is_soft() {
                at_centre
            } else {
                map.layer_of(&pixels::mask(&base.outline)).unwrap_or(at_centre)
            }
        }));
        of
    }
}

/// What lies behind the elements of a photograph: the background, or the background of each layer.
pub(super) struct BehindElements<'a> {
    margin: &'a Margin,
    fields: Vec<Interpolant>,
    /// The layer of each pixel, if there are several.
    layers: Option<&'a LabelMap>,
}

impl BehindElements<'_> {
    /// Number of layers.
    pub(super) fn count(&self) -> usize {
        self.fields.len()
    }

    /// The layer at a place of the photograph with its margin, in pixels.
    pub(super) fn layer(&self, at: [f64; 2]) -> usize {
        self.layers.map_or(0, |labels| label(labels, self.margin.place(at)) as usize)
    }

    /// The colour of a layer's background at a place, components 0 to 255, not clamped.
    pub(super) fn colour_of(&self, layer: usize, at: [f64; 2]) -> [f64; 3] {
        let [x, y] = self.margin.place(at);
        self.fields[layer].at(x, y)
    }

    /// The colour behind elements at a place.
    pub(super) fn colour(&self, at: [f64; 2]) -> [f64; 3] {
        self.colour_of(self.layer(at), at)
    }
}

/// The label of the pixel at a place, or of the pixel nearest to it.
fn label(labels: &LabelMap, at: [f64; 2]) -> u32 {
    let [x, y] = [(at[0], labels.width), (at[1], labels.height)].map(|(v, side)| (v as u32).min(side - 1));
    labels.get(x, y)
}

/// The layers of an exemplar, found or painted, if there are several, and the reason for their number. `primaries` has
/// a label above 0 for each known element.
fn found(
    exemplar: &Exemplar,
    primaries: &LabelMap,
    params: &AnalyzeParams,
    memory: Option<&mut LayersMemory>,
    progress: &dyn Progress,
) -> Result<(Option<LayerMap>, Option<String>)> {
    let order = || params.layer_order.iter().map(|&k| k as usize).collect::<Vec<_>>();
    let (map, mut why) = match (&exemplar.layers, params.layers) {
        (Some(painted), _) => {
            painted.check_photograph(exemplar.image.dimensions())?;
            let given = &params.layer_order;
            let map = if given.is_empty() { painted.clone() } else { painted.reordered(&order())? };
            (map, Some("as painted".into()))
        }
        (None, 1) => return Ok((None, None)),
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
            let found = search.find(&exemplar.image, Some(primaries), &wanted, progress)?;
            (found.map, Some(found.decision.why))
        }
    };
    if map.layers.len() < 2 {
        return Ok((None, why));
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
    Ok(((map.layers.len() > 1).then_some(map), why))
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
