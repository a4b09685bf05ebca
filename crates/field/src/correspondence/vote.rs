//! Votes on the features of each cell, and histogram matching.

use super::atlas::Atlas;
use super::canvas::LevelCanvas;
use super::{CHANNELS, LANES, PATCH, REACH, RowProgress};
use vtex_base::parallel;

/// Bins of a histogram.
const BINS: usize = 1 << 12;

impl LevelCanvas {
    /// Sets the features of every cell to the weighted mean of the patches over it. Patches centred near
    /// the cell, and patches that fit well, have more weight.
    pub(super) fn vote(&mut self, atlas: &Atlas, watch: &RowProgress<'_>) {
        let mut sorted: Vec<i32> =
            (0..self.costs.len()).filter(|&i| self.is_active(i)).map(|i| self.costs[i]).collect();
        if sorted.is_empty() {
            return;
        }
        let middle = sorted.len() / 2;
        let median = (*sorted.select_nth_unstable(middle).1).max(1) as f32;
        let trust: Vec<f32> = self.costs.iter().map(|&c| 1.0 / (1.0 + c as f32 / median)).collect();
        let near: Vec<([isize; 2], f32)> = (0..PATCH * PATCH)
            .map(|k| {
                let d = [(k % PATCH) as isize - REACH as isize, (k / PATCH) as isize - REACH as isize];
                let sigma = PATCH as f32 / 4.0;
                (d, libm::expf(-((d[0] * d[0] + d[1] * d[1]) as f32) / (2.0 * sigma * sigma)))
            })
            .collect();
        let (row, width) = (self.value_row(), self.size[0]);
        let mut values = std::mem::take(&mut self.values);
        let this = &*self;
        parallel::for_chunks(&mut values[REACH * row..(REACH + this.size[1]) * row], row, |y, values| {
            if !watch.keep_going(width) {
                return;
            }
            for x in 0..width {
                if !this.is_active(y * width + x) {
                    continue;
                }
                let (mut sum, mut weights) = ([0f32; CHANNELS], 0f32);
                for &([dx, dy], weight) in &near {
                    let Some(q) = this.neighbour([x, y], [dx, dy]) else { continue };
                    let Some(cell) = atlas.moved(this.sources[q], -dx, -dy) else { continue };
                    let weight = weight * trust[q];
                    let of = atlas.of(cell);
                    (0..CHANNELS).for_each(|c| sum[c] += weight * f32::from(of[c]));
                    weights += weight;
                }
                let to = (x + REACH) * LANES;
                let own = atlas.of(this.sources[y * width + x]);
                for c in 0..CHANNELS {
                    values[to + c] =
                        if weights > 0.0 { libm::rintf(sum[c] / weights) as i16 } else { own[c] };
                }
            }
        });
        self.values = values;
    }

    /// Matches the features of the cells of each group to the histogram of its pages, channel by channel.
    pub(super) fn match_histograms(&mut self, atlas: &Atlas) {
        let mut groups: Vec<u8> = match &self.groups {
            Some(groups) => groups.clone(),
            None => vec![atlas.pages[0].group],
        };
        groups.sort_unstable();
        groups.dedup();
        for group in groups {
            let cells: Vec<usize> = (0..self.sources.len())
                .filter(|&i| self.is_active(i) && self.groups.as_ref().is_none_or(|g| g[i] == group))
                .map(|i| self.value_at(i % self.size[0], i / self.size[0]))
                .collect();
            for channel in 0..CHANNELS {
                let wanted = atlas.sources_of(group).map(|s| atlas.of(s)[channel]);
                let wanted = Histogram::new(wanted);
                let own = Histogram::new(cells.iter().map(|&i| self.values[i + channel]));
                let table = own.to(&wanted);
                for &i in &cells {
                    self.values[i + channel] = table[bin(self.values[i + channel])];
                }
            }
        }
    }
}

/// A cumulative histogram: the number of values in all bins before each.
struct Histogram {
    before: Vec<u32>,
}

/// The bin of a value.
fn bin(value: i16) -> usize {
    (i32::from(value) + (BINS / 2) as i32).clamp(0, BINS as i32 - 1) as usize
}

impl Histogram {
    fn new(values: impl Iterator<Item = i16>) -> Self {
        let mut before = vec![0u32; BINS + 1];
        values.for_each(|v| before[bin(v) + 1] += 1);
        for i in 0..BINS {
            before[i + 1] += before[i];
        }
        Self { before }
    }

    /// For each bin the value of equal rank in another histogram.
    fn to(&self, other: &Self) -> Vec<i16> {
        let [total, wanted] = [self, other].map(|h| u64::from(h.before[BINS]));
        let mut at = 0;
        (0..BINS)
            .map(|i| {
                // The middle rank of the values in the bin.
                let rank = u64::from(self.before[i]) + u64::from(self.before[i + 1]);
                let rank = if total > 0 { rank * wanted / (2 * total) } else { 0 };
                while at + 1 < BINS && u64::from(other.before[at + 1]) <= rank {
                    at += 1;
                }
                at as i16 - (BINS / 2) as i16
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_kept_and_values_are_those_of_the_other() {
        let own = Histogram::new([-30i16, -10, 0, 40].into_iter());
        let other = Histogram::new([5i16, 5, 7, 900].into_iter());
        let table = own.to(&other);
        assert_eq!([-30i16, -10, 0, 40].map(|v| table[bin(v)]), [5, 5, 7, 900]);
        assert!(table.is_sorted());
    }
}
