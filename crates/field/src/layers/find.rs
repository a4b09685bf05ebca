//! Finds the layers of a photograph: their number, their regions and their order.
//!
//! Regions come from k-means of blurred Oklab colours. Their borders are smoothed twice, and specks are
//! joined to their surroundings. The measures in `extent` and `separation` decide whether there are layers at all. Three
//! layers are kept if each of them is thick. The order is the one in which non-consecutive layers touch
//! least. At last borders are drawn again on the pixels of the photograph (`refine`).

use super::clean::{enlarged, smoothed, without_specks};
use super::extent::{ColourContrast, extent, thickness};
use super::map::{Contacts, LayerMap, MOST_LAYERS, shares};
use super::names::named;
use super::order::order;
use super::refine::refined;
use super::separation::Separation;
use image::RgbImage;
use vtex_base::error::{Error, Result, check};
use vtex_base::kmeans::{cluster, nearest};
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::LabelMap;
use vtex_base::raster::blur::{Plane, oklab_planes};
use vtex_base::raster::colour::{Colour, squared_distance};
use vtex_base::sampling::stream;

/// Longest shorter side, in pixels, of the picture in which layers are sought.
const WORKING_SIDE: usize = 512;
/// Weight of lightness relative to the two components of hue and chroma: first, and where two layers are then clearly
/// apart in neither.
const LIGHTNESS: [f32; 2] = [0.5, 0.25];
/// Standard deviations of the blurs before and after clustering, as shares of the shorter side.
const BLURS: [f32; 2] = [1.0 / 256.0, 1.0 / 128.0];
/// Largest number of pixels that clusters are fitted to.
const SAMPLES: usize = 20_000;
/// Smallest piece of a layer, as a share of the squared shorter side.
const SPECK: f64 = 4e-4;
/// Shortest side of a photograph with known elements in which layers are sought, in pixels.
const LEAST_SIDE: usize = 256;
/// Least spread of means over an eighth of the shorter side, in Oklab.
const LEAST_CONTRAST: f64 = 0.012;
/// Least product of reach and thickness: without known elements, and with them.
const LEAST_EXTENT: [f64; 2] = [0.65, 0.55];
/// Least thickness of three layers, in units of a 37th of the shorter side.
const LEAST_THICKNESS: f64 = 37.0 / 38.0;
/// Least difference between the mean colours of any two of three layers, in Oklab.
const LEAST_DIFFERENCE: f32 = 0.02;

/// The number of layers to find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Count {
    /// One, two or three, decided by the photograph. One if elements are known and a side is below 256
    /// pixels.
    #[default]
    Auto,
    /// This number, 1 to [`MOST_LAYERS`].
    Fixed(usize),
}

/// Parameters of [`find`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FindParams {
    /// Number of layers. Default: decided by the photograph.
    pub count: Count,
    /// The layers found, listed from the new bottom to the new top. Default: the order with the least
    /// contact of non-consecutive layers; ties put the largest at the bottom.
    pub order: Option<Vec<usize>>,
    /// Seed of the clustering. Default 0.
    pub seed: u64,
}

/// The reason for the number of layers, and the measures behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// One sentence without a full stop.
    pub why: String,
    /// Spread of colours averaged over an eighth of the shorter side, in Oklab.
    pub contrast: f64,
    /// Reach of colour differences times thickness of two layers. Layers have .65 or more, or .55 where the
    /// elements are known.
    pub extent: f64,
}

/// The layers of a photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLayers {
    /// The layers, at the size of the photograph.
    pub map: LayerMap,
    /// The reason for their number.
    pub decision: Decision,
}

/// Splits a photograph into layers by k-means of blurred colours in Oklab, smooths their borders and
/// removes specks. `elements` has labels above 0 for known elements; it is used only to distinguish
/// scattered elements from layers.
///
/// # Errors
/// [`Error::Parameter`] for a count out of range or an order that does not list all layers;
/// [`Error::Masks`] if `elements` has another size; [`Error::Unusable`] if the colours are too few or
/// too alike for the count asked for; [`Error::Interrupted`].
pub fn find(
    image: &RgbImage,
    elements: Option<&LabelMap>,
    parameters: &FindParams,
    progress: &dyn Progress,
) -> Result<FoundLayers> {
    LayerSearch::new(image, parameters.seed, progress)?.find(image, elements, parameters, progress)
}

const STAGE: &str = "layers";

/// The part of a search for layers that depends on a photograph and a seed alone, not on its elements.
pub struct LayerSearch {
    /// Size of the photograph.
    size: [usize; 2],
    /// Pixels of the photograph to a pixel of the planes, along one axis.
    factor: usize,
    planes: [Plane; 3],
    clustering: Clustering,
    /// Two layers, if the colours allow them, how thick they are, and how far apart their colours.
    pair: Option<LabelMap>,
    thick: f64,
    apart: Separation,
}

impl LayerSearch {
    /// Prepares a search; `seed` is that of the clustering.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn new(image: &RgbImage, seed: u64, progress: &dyn Progress) -> Result<Self> {
        let size = [image.width() as usize, image.height() as usize];
        advance(progress, STAGE, 0, 4)?;
        let factor = size[0].min(size[1]).div_ceil(WORKING_SIDE);
        let planes = oklab_planes(image, factor);
        let divided = |lightness: f32| {
            let clustering = Clustering::new(&planes, seed, lightness);
            let pair = clustering.split(2);
            let apart = pair.as_ref().map_or_else(Separation::default, |map| Separation::new(map, &planes));
            (clustering, pair, apart)
        };
        let mut found = divided(LIGHTNESS[0]);
        advance(progress, STAGE, 1, 4)?;
        if found.1.is_some() && !found.2.is_clear() {
            found = divided(LIGHTNESS[1]);
        }
        let (clustering, pair, apart) = found;
        let thick = pair.as_ref().map_or(0.0, |map| thickness(map, 2));
        Ok(Self { size, factor, planes, clustering, pair, thick, apart })
    }

    /// The layers: [`find`] with the seed and the photograph of the search.
    ///
    /// # Errors
    /// Those of [`find`].
    pub fn find(
        &self,
        image: &RgbImage,
        elements: Option<&LabelMap>,
        parameters: &FindParams,
        progress: &dyn Progress,
    ) -> Result<FoundLayers> {
        let Self { size, factor, planes, clustering, thick, .. } = self;
        if let Count::Fixed(count) = parameters.count {
            let allowed = format!("auto, or 1 to {MOST_LAYERS}");
            check((1..=MOST_LAYERS).contains(&count), "layers", count, allowed)?;
        }
        if elements.is_some_and(|map| [map.width as usize, map.height as usize] != *size) {
            return Err(Error::Masks("they have another size".into()));
        }
        let elements = elements.map(|map| subsampled(map, *factor, planes[0].size));
        let measured = extent(planes, elements.as_ref());
        advance(progress, STAGE, 2, 4)?;
        let least = LEAST_EXTENT[usize::from(elements.is_some())];
        let few = size[0].min(size[1]) < LEAST_SIDE;
        let decided = if parameters.count == Count::Auto && elements.is_some() && few {
            (clustering.one(), 1, format!("a photograph of less than {LEAST_SIDE} px hardly shows any"))
        } else {
            self.decide(parameters.count, measured, least)?
        };
        advance(progress, STAGE, 3, 4)?;

        let order = order(&Contacts::new(&decided.0, decided.1, [false; 2]), &shares(&decided.0, decided.1));
        let map = assembled(&decided.0, &order, (planes, *factor), image, clustering.lightness);
        let map = match &parameters.order {
            Some(order) => map.reordered(order)?,
            None => map,
        };
        advance(progress, STAGE, 4, 4)?;
        let decision =
            Decision { why: decided.2, contrast: measured.contrast, extent: measured.reach * thick };
        Ok(FoundLayers { map, decision })
    }

    /// Labels at the working size, the number of layers, and the reason for it.
    fn decide(
        &self,
        count: Count,
        measured: ColourContrast,
        least: f64,
    ) -> Result<(LabelMap, usize, String)> {
        let Self { planes, clustering, thick, .. } = self;
        let pair = self.pair.clone();
        let one = || clustering.one();
        if let Count::Fixed(count) = count {
            let map = match count {
                1 => Some(one()),
                2 => pair,
                _ => clustering.split(count),
            };
            let fail = || Error::Unusable {
                name: "the photograph".into(),
                reason: format!("its colours are too few or too alike for {count} layers"),
                advice: "ask for fewer layers",
            };
            return Ok((map.ok_or_else(fail)?, count, "as asked".into()));
        }
        let extent = measured.reach * thick;
        if measured.contrast < LEAST_CONTRAST {
            let contrast = measured.contrast;
            let why = format!(
                "colours hardly differ from place to place ({contrast:.4}, layers {LEAST_CONTRAST} or more)"
            );
            return Ok((one(), 1, why));
        }
        if pair.is_some() && !self.apart.is_of_material() {
            let chroma = self.apart.chroma;
            let why =
                format!("the same material lies in light and shade ({chroma:.2} deviations of its hue)");
            return Ok((one(), 1, why));
        }
        let Some(pair) = pair.filter(|_| extent >= least) else {
            let why = format!(
                "differences of colour are those of small elements and grain ({extent:.2}, layers {least} or more)"
            );
            return Ok((one(), 1, why));
        };
        let reached = format!("differences of colour reach far ({extent:.2} of {least})");
        if let Some(three) =
            clustering.split(3).filter(|map| clustering.difference(map, 3, planes) >= LEAST_DIFFERENCE)
        {
            let thin = thickness(&three, 3);
            if thin >= LEAST_THICKNESS {
                return Ok((
                    three,
                    3,
                    format!(
                        "{reached} and three layers are thick enough ({thin:.2} of {LEAST_THICKNESS:.2})"
                    ),
                ));
            }
            return Ok((
                pair,
                2,
                format!("{reached}, a third layer would be too thin ({thin:.2} of {LEAST_THICKNESS:.2})"),
            ));
        }
        Ok((pair, 2, format!("{reached}, there is no third colour")))
    }
}

/// The labels at the size of the photograph, in the given order, with mean colours and names. `planes` are those of
/// the photograph reduced by `factor`, as `map` is. `lightness` is the weight of lightness.
fn assembled(
    map: &LabelMap,
    order: &[usize],
    (planes, factor): (&[Plane; 3], usize),
    image: &RgbImage,
    lightness: f32,
) -> LayerMap {
    let count = order.len();
    let mut rank = vec![0; count];
    order.iter().enumerate().for_each(|(new, &old)| rank[old] = new as u32);
    let labels = map.labels.iter().map(|&l| rank[l as usize]).collect();
    let map = LabelMap { labels, ..*map };
    let size = [image.width() as usize, image.height() as usize];
    let labels = refined(&enlarged(&map, count, size, factor), count, image, lightness);
    let colours = means(&subsampled(&labels, factor, planes[0].size), count, planes);
    let colours: Vec<Colour> = colours.into_iter().map(Colour::from_oklab).collect();
    LayerMap { labels, layers: named(&colours) }
}

/// The mean colour of each layer, in Oklab.
fn means(map: &LabelMap, count: usize, planes: &[Plane; 3]) -> Vec<[f32; 3]> {
    let mut sums = vec![([0f64; 3], 0.0f64); count];
    for (i, &l) in map.labels.iter().enumerate() {
        let (sum, n) = &mut sums[l as usize];
        (0..3).for_each(|c| sum[c] += f64::from(planes[c].values[i]));
        *n += 1.0;
    }
    sums.iter().map(|(sum, n)| sum.map(|v| (v / n.max(1.0)) as f32)).collect()
}

/// The points to cluster.
struct Clustering {
    size: [usize; 2],
    points: Vec<[f64; 3]>,
    seed: u64,
    /// Weight of lightness in the points.
    lightness: f32,
}

impl Clustering {
    fn new(planes: &[Plane; 3], seed: u64, lightness: f32) -> Self {
        let size = planes[0].size;
        let sigma = size[0].min(size[1]) as f32 * BLURS[0];
        let [l, a, b] = planes.each_ref().map(|plane| plane.blurred(sigma, [false; 2]));
        let points = (0..l.values.len())
            .map(|i| [lightness * l.values[i], a.values[i], b.values[i]].map(f64::from))
            .collect();
        Self { size, points, seed, lightness }
    }

    /// A single layer.
    fn one(&self) -> LabelMap {
        LabelMap::filled(self.size[0] as u32, self.size[1] as u32, 0)
    }

    /// The least difference between the mean colours of two layers.
    fn difference(&self, map: &LabelMap, count: usize, planes: &[Plane; 3]) -> f32 {
        let colours = means(map, count, planes);
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let differences = pairs.map(|(a, b)| libm::sqrtf(squared_distance(colours[a], colours[b])));
        differences.fold(f32::INFINITY, f32::min)
    }

    /// `count` layers with smooth borders; `None` if the colours do not allow them.
    fn split(&self, count: usize) -> Option<LabelMap> {
        // The samples are the same for all seeds. Only the starts differ.
        let samples = self.points.len().min(SAMPLES);
        let mut place = stream(0, "layers/samples", 0);
        let sample = |k: usize| {
            let [from, to] = [k, k + 1].map(|k| k * self.points.len() / samples);
            self.points[from + place.index(to - from)]
        };
        let samples: Vec<[f64; 3]> = (0..samples).map(sample).collect();
        let random = |start| stream(self.seed, "layers/clusters", start);
        let centres = cluster(&samples, &vec![1.0; samples.len()], count, random).centres;
        if centres.len() < count {
            return None;
        }
        let labels = self.points.iter().map(|p| nearest(&centres, p) as u32).collect();
        let mut map = LabelMap { width: self.size[0] as u32, height: self.size[1] as u32, labels };
        let shorter = self.size[0].min(self.size[1]);
        for _ in 0..2 {
            map = smoothed(&map, count, shorter as f32 * BLURS[1]);
        }
        let least = libm::ceil(SPECK * (shorter * shorter) as f64) as usize;
        let map = without_specks(map, count, least, [false; 2]);
        shares(&map, count).iter().all(|&s| s > 0.0).then_some(map)
    }
}

/// Samples the label at the centre of each block of `factor` pixels.
fn subsampled(map: &LabelMap, factor: usize, size: [usize; 2]) -> LabelMap {
    let at = |i: usize| {
        map.get((i % size[0] * factor + factor / 2) as u32, (i / size[0] * factor + factor / 2) as u32)
    };
    LabelMap {
        width: size[0] as u32,
        height: size[1] as u32,
        labels: (0..size[0] * size[1]).map(at).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{agreement, surface};
    use super::*;

    fn auto(seed: u64) -> FindParams {
        FindParams { seed, ..FindParams::default() }
    }

    #[test]
    fn layers_are_those_that_were_painted() {
        for count in [2, 3] {
            let (photo, painted) = surface([256, 256], count, 7);
            let found = find(&photo, None, &auto(1), &()).unwrap();
            assert_eq!(found.map.layers.len(), count, "{:?}", found.decision);
            let same = agreement(&found.map.labels, &painted);
            assert!(same > 0.9, "{count}: {same}");
            assert_eq!(find(&photo, None, &auto(1), &()).unwrap(), found);
            let other = find(&photo, None, &auto(2), &()).unwrap();
            assert!(agreement(&found.map.labels, &other.map.labels) > 0.95);
        }
    }

    #[test]
    fn half_the_resolution_gives_the_same_layers() {
        let (photo, _) = surface([600, 520], 2, 3);
        let half = vtex_base::raster::resized(&photo, 300, 260, vtex_base::raster::Filter::Triangle);
        let [large, small] = [&photo, &half].map(|p| find(p, None, &auto(1), &()).unwrap().map);
        let again = LabelMap {
            labels: (0..600 * 520).map(|i| small.labels.get(i % 600 / 2, i / 600 / 2)).collect(),
            ..large.labels
        };
        assert_eq!(large.layers.len(), small.layers.len());
        let same = agreement(&large.labels, &again);
        assert!(same > 0.95, "{same}");
    }

    #[test]
    fn grain_and_light_are_no_layers() {
        use vtex_base::sampling::stream;
        let mut random = stream(1, "grain", 0);
        let grain = RgbImage::from_fn(200, 200, |_, _| image::Rgb([random.below(256) as u8; 3]));
        let light = RgbImage::from_fn(200, 200, |x, y| image::Rgb([(100 + (x + y) / 50) as u8; 3]));
        for photo in [grain, light] {
            let found = find(&photo, None, &auto(1), &()).unwrap();
            assert_eq!(found.map.layers.len(), 1, "{:?}", found.decision);
            assert!(!found.decision.why.ends_with('.'));
        }
        let (small, _) = surface([120, 160], 2, 7);
        let elements = LabelMap::filled(120, 160, 0);
        let layers = |elements| find(&small, elements, &auto(1), &()).unwrap().map.layers.len();
        assert_eq!([layers(None), layers(Some(&elements))], [2, 1]);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let (photo, _) = surface([64, 64], 2, 1);
        let with = |count| FindParams { count: Count::Fixed(count), ..FindParams::default() };
        for count in [0, 7] {
            assert!(matches!(
                find(&photo, None, &with(count), &()),
                Err(Error::Parameter { name: "layers", .. })
            ));
        }
        let flat = RgbImage::from_fn(64, 64, |x, _| image::Rgb([if x < 30 { 20 } else { 200 }; 3]));
        assert_eq!(find(&flat, None, &with(2), &()).unwrap().map.layers.len(), 2);
        let refused = find(&flat, None, &with(5), &());
        assert!(matches!(refused, Err(Error::Unusable { .. })), "{refused:?}");
        let order = FindParams { order: Some(vec![0, 2]), ..with(2) };
        assert!(matches!(find(&photo, None, &order, &()), Err(Error::Parameter { name: "layer-order", .. })));
        let elements = LabelMap::filled(9, 9, 0);
        assert!(matches!(find(&photo, Some(&elements), &with(2), &()), Err(Error::Masks(_))));
    }

    #[test]
    fn layers_change_places_when_asked() {
        let (photo, _) = surface([128, 128], 2, 5);
        let with = |order| FindParams { count: Count::Fixed(2), order, seed: 1 };
        let plain = find(&photo, None, &with(None), &()).unwrap().map;
        let turned = find(&photo, None, &with(Some(vec![1, 0])), &()).unwrap().map;
        assert_eq!(turned.layers[0], plain.layers[1]);
        assert!(plain.labels.labels.iter().zip(&turned.labels.labels).all(|(a, b)| a + b == 1));
    }

    #[test]
    fn it_can_be_stopped() {
        let (photo, _) = surface([64, 64], 2, 1);
        let stopped = find(&photo, None, &auto(1), &vtex_testing::StopAtOnce);
        assert!(matches!(stopped, Err(Error::Interrupted)));
    }
}
