//! Continuous control maps: values that rise within each layer (the paper, eq. 5).

use super::map::{LayerMap, LayerRegion};
use super::regions::depth;

/// A value for each pixel. It rises from i at the outer border of layer i, towards the layer below, to i +
/// 1 at its inner border, towards the layer above, in proportion to the distances to both. The largest
/// distance within the map replaces the distance to a border that a layer does not have.
pub fn continuous(map: &LayerMap, wrap: [bool; 2]) -> Vec<f32> {
    let count = map.layers.len();
    let depths: Vec<Vec<f32>> = (1..count).map(|k| depth(&map.region(k, wrap))).collect();
    // The largest distance of any pixel from a border.
    let farthest =
        depths.iter().flatten().map(|d| d.abs()).fold(1.0f32, f32::max).min(largest(&map.region(0, wrap)));
    let value = |i: usize| {
        let layer = map.labels.labels[i] as usize;
        let outer = if layer > 0 { depths[layer - 1][i].max(0.0) } else { farthest };
        let inner = if layer + 1 < count { (-depths[layer][i]).max(0.0) } else { farthest };
        let share = outer.min(farthest) / (outer.min(farthest) + inner.min(farthest)).max(f32::MIN_POSITIVE);
        // Stays below the next whole number, so that rounding down restores the label.
        (layer as f32 + share).min((layer + 1) as f32 - 1e-3)
    };
    (0..map.labels.labels.len()).map(value).collect()
}

/// Length of the diagonal of a map.
fn largest(region: &LayerRegion) -> f32 {
    let [w, h] = region.size.map(|v| v as f32);
    libm::sqrtf(w * w + h * h)
}

/// The labels of a continuous map: its values rounded down.
pub fn discrete(values: &[f32]) -> Vec<u32> {
    values.iter().map(|&v| libm::floorf(v).max(0.0) as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::super::names::named;
    use super::super::testing::nested;
    use super::*;
    use vtex_base::raster::LabelMap;
    use vtex_base::raster::colour::Colour;

    fn with(labels: LabelMap, count: u8) -> LayerMap {
        LayerMap { labels, layers: named(&(0..count).map(|k| Colour([k * 40; 3])).collect::<Vec<_>>()) }
    }

    #[test]
    fn rounding_down_gives_the_labels_back() {
        for (count, wrap) in [(2u8, false), (3, true), (5, false)] {
            let map = with(nested([80, 60], usize::from(count), 3), count);
            let values = continuous(&map, [wrap; 2]);
            assert_eq!(discrete(&values), map.labels.labels);
        }
    }

    #[test]
    fn values_rise_from_border_to_border() {
        // Stripes 20 pixels wide: 0, 1, 2.
        let mut labels = LabelMap::filled(60, 9, 0);
        (0..9).for_each(|y| (20..60).for_each(|x| labels.set(x, y, x / 20)));
        let values = continuous(&with(labels, 3), [false; 2]);
        let row = &values[4 * 60..5 * 60];
        assert!(row.windows(2).all(|p| p[0] <= p[1]), "{row:?}");
        assert!((row[20] - 1.0).abs() < 0.05 && (row[39] - 2.0).abs() < 0.05, "{row:?}");
        assert!((row[30] - 1.5).abs() < 0.05);
        assert!(row[19] > 0.9 && row[40] < 2.1);
    }

    #[test]
    fn one_layer_is_half_way() {
        let values = continuous(&with(LabelMap::filled(5, 5, 0), 1), [false; 2]);
        assert!(values.iter().all(|v| (v - 0.5).abs() < 1e-6), "{values:?}");
    }
}
