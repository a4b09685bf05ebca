//! Layer maps: a label for each pixel, and the layer that each label stands for.

use vtex_base::error::{Error, Result, check};
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::Colour;

/// Most layers of a map.
pub const MOST_LAYERS: usize = 6;

/// A layer: the pixels of one label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapLayer {
    /// A name by colour, such as `rust brown`. Unique within a map.
    pub name: String,
    /// Mean colour. Unique within a map.
    pub colour: Colour,
}

/// A map of nested layers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerMap {
    /// Labels, from 0 at the bottom to the number of layers minus one at the top.
    pub labels: LabelMap,
    /// The layers from bottom to top, 1 to [`MOST_LAYERS`].
    pub layers: Vec<MapLayer>,
}

/// The region of one layer and all above it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerRegion {
    /// Width and height, in pixels.
    pub size: [usize; 2],
    /// Axes along which it repeats.
    pub wrap: [bool; 2],
    /// Whether each pixel is inside, row by row.
    pub inside: Vec<bool>,
}

impl LayerRegion {
    /// Number of pixels inside.
    pub fn area(&self) -> usize {
        self.inside.iter().filter(|&&v| v).count()
    }
}

impl LayerMap {
    /// A map of other labels with the same layers.
    pub(super) fn with(&self, labels: LabelMap) -> Self {
        Self { labels, layers: self.layers.clone() }
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.labels.width as usize, self.labels.height as usize]
    }

    /// Share of the pixels that each layer has, 0 to 1.
    pub fn shares(&self) -> Vec<f64> {
        shares(&self.labels, self.layers.len())
    }

    /// The region S_`layer`: pixels of this layer and of those above.
    pub fn region(&self, layer: usize, wrap: [bool; 2]) -> LayerRegion {
        let inside = self.labels.labels.iter().map(|&l| l as usize >= layer).collect();
        LayerRegion { size: self.size(), wrap, inside }
    }

    /// The map without layers that have no pixels.
    pub fn without_unused(&self) -> Self {
        let used: Vec<bool> = self.shares().iter().map(|&s| s > 0.0).collect();
        let rank: Vec<u32> = (0..used.len()).map(|k| used[..k].iter().map(|&u| u32::from(u)).sum()).collect();
        let labels = self.labels.labels.iter().map(|&l| rank[l as usize]).collect();
        let layers = self.layers.iter().zip(&used).filter(|(_, used)| **used).map(|(l, _)| l.clone());
        Self { labels: LabelMap { labels, ..self.labels }, layers: layers.collect() }
    }

    /// The same layers in another order. `order` lists the current layers from the new bottom to the new top.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless every layer is listed once.
    pub fn reordered(&self, order: &[usize]) -> Result<Self> {
        let mut sorted = order.to_vec();
        sorted.sort_unstable();
        check(
            sorted.iter().copied().eq(0..self.layers.len()),
            "layer-order",
            order.iter().map(ToString::to_string).collect::<Vec<_>>().join(","),
            "every layer is listed once, by its number from 0 at the bottom",
        )?;
        let mut rank = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| rank[old] = new as u32);
        let mut labels = self.labels.clone();
        labels.labels.iter_mut().for_each(|l| *l = rank[*l as usize]);
        Ok(Self { labels, layers: order.iter().map(|&old| self.layers[old].clone()).collect() })
    }

    /// Checks that the map has the size of its photograph, in pixels.
    ///
    /// # Errors
    /// [`Error::Control`].
    pub fn check_photograph(&self, size: (u32, u32)) -> Result<()> {
        let own = (self.labels.width, self.labels.height);
        if own == size {
            return Ok(());
        }
        Err(Error::Control {
            name: "the layer map".into(),
            role: "the layers of the photograph",
            reason: format!("it has {} x {} pixels, the photograph {} x {}", own.0, own.1, size.0, size.1),
            advice: "make the map of the same size as the photograph",
        })
    }

    /// Checks that there are at least two layers, so that there is a border.
    ///
    /// # Errors
    /// [`Error::Unusable`].
    pub(super) fn check_layered(&self) -> Result<()> {
        let used = self.shares().iter().filter(|&&s| s > 0.0).count();
        if used > 1 {
            return Ok(());
        }
        Err(Error::Control {
            name: "the layer map".into(),
            role: "an exemplar of layers",
            reason: "it has one layer only".into(),
            advice: "give a map of 2 to 6 layers",
        })
    }
}

/// Share of the pixels with each of `count` labels.
pub(super) fn shares(map: &LabelMap, count: usize) -> Vec<f64> {
    let mut areas = vec![0usize; count];
    map.labels.iter().for_each(|&l| areas[l as usize] += 1);
    areas.iter().map(|&a| a as f64 / map.labels.len().max(1) as f64).collect()
}

/// Lengths of the borders between layers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contacts {
    count: usize,
    /// Pixel edges between each pair of layers, both ways.
    lengths: Vec<u64>,
}

impl Contacts {
    /// The contacts of a map of `count` labels that repeats along the axes of `wrap`.
    pub fn new(map: &LabelMap, count: usize, wrap: [bool; 2]) -> Self {
        let (w, h) = (map.width as usize, map.height as usize);
        let mut lengths = vec![0; count * count];
        let mut meet = |a: u32, b: u32| {
            if a != b {
                lengths[a as usize * count + b as usize] += 1;
                lengths[b as usize * count + a as usize] += 1;
            }
        };
        for y in 0..h {
            let row = &map.labels[y * w..][..w];
            row.windows(2).for_each(|pair| meet(pair[0], pair[1]));
            if wrap[0] {
                meet(row[w - 1], row[0]);
            }
            let below = if y + 1 < h { Some(y + 1) } else { wrap[1].then_some(0) };
            if let Some(below) = below {
                let next = &map.labels[below * w..][..w];
                row.iter().zip(next).for_each(|(&a, &b)| meet(a, b));
            }
        }
        Self { count, lengths }
    }

    /// Pixel edges between two layers.
    pub fn between(&self, a: usize, b: usize) -> u64 {
        self.lengths[a * self.count + b]
    }

    /// Pixel edges around a layer, except those along the border of the map.
    pub fn around(&self, layer: usize) -> u64 {
        self.lengths[layer * self.count..][..self.count].iter().sum()
    }

    /// Pixel edges between all layers.
    pub fn total(&self) -> u64 {
        self.lengths.iter().sum::<u64>() / 2
    }

    /// Share of all borders that lie between non-consecutive layers, 0 to 1.
    pub fn distant(&self) -> f64 {
        let far = |i: usize| (i / self.count).abs_diff(i % self.count) > 1;
        let distant: u64 = (0..self.lengths.len()).filter(|&i| far(i)).map(|i| self.lengths[i]).sum();
        distant as f64 / self.lengths.iter().sum::<u64>().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: u32, labels: &[u32]) -> LabelMap {
        LabelMap { width, height: labels.len() as u32 / width, labels: labels.to_vec() }
    }

    #[test]
    fn contacts_count_pixel_edges() {
        let map = map(3, &[0, 0, 2, 1, 1, 2]);
        let plain = Contacts::new(&map, 3, [false; 2]);
        assert_eq!([plain.between(0, 1), plain.between(0, 2), plain.between(1, 2)], [2, 1, 1]);
        assert_eq!((plain.total(), plain.around(2)), (4, 2));
        assert_eq!(plain.distant(), 0.25);
        assert_eq!(Contacts::new(&map, 3, [true; 2]).total(), 4 + 2 + 2);
    }

    #[test]
    fn orders_are_permutations() {
        let layer = |name: &str, v| MapLayer { name: name.into(), colour: Colour([v; 3]) };
        let map = LayerMap {
            labels: map(3, &[0, 1, 2]),
            layers: vec![layer("a", 1), layer("b", 2), layer("c", 3)],
        };
        let turned = map.reordered(&[2, 0, 1]).unwrap();
        assert_eq!(turned.labels.labels, [1, 2, 0]);
        assert_eq!(turned.layers[0].name, "c");
        assert_eq!(turned.region(1, [false; 2]).inside, [true, true, false]);
        let gap = LayerMap { labels: turned.labels.clone(), ..map.clone() };
        let gap =
            LayerMap { labels: LabelMap { labels: vec![0, 2, 2], ..gap.labels }, ..gap }.without_unused();
        assert_eq!((gap.labels.labels, gap.layers.len()), (vec![0, 1, 1], 2));
        for bad in [&[0, 1][..], &[0, 1, 1], &[0, 1, 3]] {
            assert!(matches!(map.reordered(bad), Err(Error::Parameter { name: "layer-order", .. })));
        }
    }
}
