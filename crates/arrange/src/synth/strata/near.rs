//! Places near a stratum.

use vtex_base::raster::{LabelMap, squared_distance};

/// The places in or near a stratum, by square blocks.
pub(super) struct NearbyPlaces {
    side: f64,
    width: usize,
    height: usize,
    away: Vec<f32>,
    reach: f32,
}

impl NearbyPlaces {
    /// Number of blocks along the reach.
    const PARTS: f64 = 6.0;

    /// Places within `reach` pixels of a stratum, plus up to one block.
    pub(super) fn new(labels: &LabelMap, stratum: u32, reach: f64) -> Self {
        let side = (reach / Self::PARTS).max(1.0);
        let [width, height] = [labels.width, labels.height].map(|v| (f64::from(v) / side) as usize + 1);
        let mut held = vec![false; width * height];
        for (y, row) in labels.labels.chunks(labels.width as usize).enumerate() {
            let first = (y as f64 / side) as usize * width;
            for (x, _) in row.iter().enumerate().filter(|(_, label)| **label == stratum) {
                held[first + (x as f64 / side) as usize] = true;
            }
        }
        let away = squared_distance(width, height, |i| held[i]);
        Self { side, width, height, away, reach: (reach / side) as f32 + 1.0 }
    }

    /// Whether a place, in pixels, is in or near the stratum.
    pub(super) fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let block = |v: f64, count: usize| ((v.max(0.0) / self.side) as usize).min(count - 1);
        self.away[block(y, self.height) * self.width + block(x, self.width)] <= self.reach * self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_within_reach_and_a_block() {
        let labels = (0..90).flat_map(|y| (0..120).map(move |x| u32::from(x < 30 && y < 60))).collect();
        let labels = LabelMap { width: 120, height: 90, labels };
        let near = NearbyPlaces::new(&labels, 1, 24.0);
        for (at, is_near) in
            [([-3.0, 10.0], true), ([53.0, 20.0], true), ([63.0, 20.0], false), ([10.0, 95.0], false)]
        {
            assert_eq!(near.holds(at), is_near, "{at:?}");
        }
        assert!(!NearbyPlaces::new(&labels, 2, 24.0).holds([5.0, 5.0]));
    }
}
