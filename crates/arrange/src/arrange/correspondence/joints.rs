//! Joints between the packed elements of an exemplar.

use vtex_base::raster::LabelMap;

/// Widest joint, in pixels.
const WIDEST: usize = 16;

/// The usual width of an exemplar's joints, in pixels: the median distance of neighbours along rows and columns; 0 if
/// most neighbours touch.
pub(super) fn width(labels: &LabelMap) -> usize {
    let mut counts = [0u64; WIDEST + 1];
    // The last primary along a line, and the pixels of ground after it.
    let mut walk = |line: &mut dyn Iterator<Item = u32>| {
        let (mut last, mut ground) = (0, 0);
        for label in line {
            match label {
                0 => ground += 1,
                _ => {
                    if last != 0 && label != last && ground <= WIDEST {
                        counts[ground] += 1;
                    }
                    (last, ground) = (label, 0);
                }
            }
        }
    };
    (0..labels.height).for_each(|y| walk(&mut labels.row(y).iter().copied()));
    (0..labels.width).for_each(|x| walk(&mut (0..labels.height).map(|y| labels.get(x, y))));
    let half = counts.iter().sum::<u64>() / 2;
    let mut below = 0;
    counts
        .iter()
        .position(|count| {
            below += count;
            below > half
        })
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_of_joints_is_that_between_most_neighbours() {
        let tiles = |gap: u32| {
            let label =
                |x: u32, y: u32| if x % 20 < gap || y % 20 < gap { 0 } else { 1 + y / 20 * 10 + x / 20 };
            let labels = (0..100 * 100).map(|i| label(i % 100, i / 100)).collect();
            LabelMap { width: 100, height: 100, labels }
        };
        assert_eq!([0, 3, 7].map(|gap| width(&tiles(gap))), [0, 3, 7]);
        assert_eq!(width(&LabelMap::filled(30, 30, 0)), 0);
    }
}
