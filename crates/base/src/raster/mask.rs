//! Masks: sets of pixels as horizontal runs.

use super::LabelMap;

/// A horizontal run of pixels: `x0..x1` in row `y`. Coordinates may be negative, so masks can be
/// shifted beyond the border of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// Row.
    pub y: i32,
    /// First column.
    pub x0: i32,
    /// Last column plus one.
    pub x1: i32,
}

impl Span {
    /// Number of pixels.
    pub fn len(&self) -> u32 {
        (self.x1 - self.x0) as u32
    }

    /// Whether the run has no pixel. Runs of a [`Mask`] are never empty.
    pub fn is_empty(&self) -> bool {
        self.x1 <= self.x0
    }
}

/// A set of pixels: runs sorted by row, then column, that neither touch nor overlap.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    spans: Vec<Span>,
}

impl Mask {
    /// Builds a mask from runs in any order; they may overlap.
    pub fn from_spans(mut spans: Vec<Span>) -> Self {
        spans.retain(|s| !s.is_empty());
        spans.sort_unstable();
        let mut merged: Vec<Span> = Vec::with_capacity(spans.len());
        for s in spans {
            match merged.last_mut() {
                Some(last) if last.y == s.y && s.x0 <= last.x1 => last.x1 = last.x1.max(s.x1),
                _ => merged.push(s),
            }
        }
        Self { spans: merged }
    }

    /// The pixels of a label map for which `inside` holds.
    pub fn from_labels(map: &LabelMap, inside: impl Fn(u32) -> bool) -> Self {
        let mut spans = Vec::new();
        for y in 0..map.height {
            push_runs(map.row(y), y as i32, 0, &inside, &mut spans);
        }
        Self { spans }
    }

    /// One mask for each label from 0 to `count - 1`. Larger labels are ignored.
    pub fn all_of_labels(map: &LabelMap, count: usize) -> Vec<Self> {
        let mut masks = vec![Self::default(); count];
        for y in 0..map.height {
            let row = map.row(y);
            let mut x = 0;
            while x < row.len() {
                let label = row[x];
                let start = x;
                while x < row.len() && row[x] == label {
                    x += 1;
                }
                if let Some(mask) = masks.get_mut(label as usize) {
                    mask.spans.push(Span { y: y as i32, x0: start as i32, x1: x as i32 });
                }
            }
        }
        masks
    }

    /// The mask after its picture is stretched from the size `from` to the size `to`: the pixels whose
    /// centres lie in the stretched mask. Enlarging and then reducing gives the same mask.
    pub fn stretched(&self, from: [u32; 2], to: [u32; 2]) -> Self {
        // The first pixel whose centre lies at or beyond an edge.
        let first = |edge: i32, axis: usize| {
            let [old, new] = [i64::from(from[axis]), i64::from(to[axis])];
            -(old - 2 * new * i64::from(edge)).div_euclid(2 * old) as i32
        };
        let mut spans = Vec::with_capacity(self.spans.len());
        for s in &self.spans {
            let (x0, x1) = (first(s.x0, 0), first(s.x1, 0));
            spans.extend((first(s.y, 1)..first(s.y + 1, 1)).map(|y| Span { y, x0, x1 }));
        }
        Self::from_spans(spans)
    }

    /// The runs.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Number of pixels.
    pub fn area(&self) -> u32 {
        self.spans.iter().map(Span::len).sum()
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// Bounding box `(x0, y0, x1, y1)`, ends exclusive; `None` if empty.
    pub fn bounds(&self) -> Option<(i32, i32, i32, i32)> {
        let (first, last) = (self.spans.first()?, self.spans.last()?);
        let x0 = self.spans.iter().map(|s| s.x0).min()?;
        let x1 = self.spans.iter().map(|s| s.x1).max()?;
        Some((x0, first.y, x1, last.y + 1))
    }

    /// Mean of the pixel centres (pixel (0, 0) has its centre at (.5, .5)); `None` if empty.
    pub fn centroid(&self) -> Option<(f64, f64)> {
        let (mut sx, mut sy, mut n) = (0.0, 0.0, 0.0);
        for s in &self.spans {
            let len = f64::from(s.len());
            sx += len * (f64::from(s.x0) + f64::from(s.x1)) / 2.0;
            sy += len * (f64::from(s.y) + 0.5);
            n += len;
        }
        (n > 0.0).then(|| (sx / n, sy / n))
    }

    /// Whether a pixel is in the set (binary search).
    pub fn contains(&self, x: i32, y: i32) -> bool {
        let after = self.spans.partition_point(|s| (s.y, s.x0) <= (y, x));
        after > 0 && {
            let s = self.spans[after - 1];
            s.y == y && x < s.x1
        }
    }

    /// Calls `f(pixel, step, behind)` for every crack, an edge between a pixel of the set and one outside
    /// it. `pixel` is the one in the set, `step` the unit step from it across the crack, and `behind`
    /// whether the pixel on its other side is in the set.
    pub fn for_cracks(&self, mut f: impl FnMut([i32; 2], [i32; 2], bool)) {
        let mut beside = [0, 0];
        for s in &self.spans {
            let thick = s.len() > 1;
            f([s.x0, s.y], [-1, 0], thick);
            f([s.x1 - 1, s.y], [1, 0], thick);
            self.advance(&mut beside, *s);
            let mut at = beside;
            for x in s.x0..s.x1 {
                let inside = [0, 1].map(|k| {
                    let y = s.y + [-1, 1][k];
                    while self.spans.get(at[k]).is_some_and(|o| o.y == y && o.x1 <= x) {
                        at[k] += 1;
                    }
                    self.spans.get(at[k]).is_some_and(|o| o.y == y && o.x0 <= x)
                });
                if !inside[0] {
                    f([x, s.y], [0, -1], inside[1]);
                }
                if !inside[1] {
                    f([x, s.y], [0, 1], inside[0]);
                }
            }
        }
    }

    /// The pixels whose four neighbours are in the set too.
    pub fn interior(&self) -> Self {
        let (mut spans, mut beside) = (Vec::new(), [0, 0]);
        for s in &self.spans {
            self.advance(&mut beside, *s);
            let [mut i, mut j] = beside;
            while let (Some(a), Some(b)) = (self.spans.get(i), self.spans.get(j)) {
                let (x0, x1) = (a.x0.max(b.x0).max(s.x0 + 1), a.x1.min(b.x1).min(s.x1 - 1));
                if a.y != s.y - 1 || b.y != s.y + 1 || a.x0.max(b.x0) >= s.x1 {
                    break;
                }
                if x0 < x1 {
                    spans.push(Span { y: s.y, x0, x1 });
                }
                if a.x1 <= b.x1 { i += 1 } else { j += 1 }
            }
        }
        Self { spans }
    }

    /// Moves two indices on to the first runs above and below `s` that do not end before it.
    fn advance(&self, beside: &mut [usize; 2], s: Span) {
        for (at, y) in beside.iter_mut().zip([s.y - 1, s.y + 1]) {
            while self.spans.get(*at).is_some_and(|o| (o.y, o.x1) <= (y, s.x0)) {
                *at += 1;
            }
        }
    }

    /// The mask translated by whole pixels.
    pub fn shifted(&self, dx: i32, dy: i32) -> Self {
        let spans = self.spans.iter().map(|s| Span { y: s.y + dy, x0: s.x0 + dx, x1: s.x1 + dx });
        Self { spans: spans.collect() }
    }

    /// The part that lies within a rectangle, from `low` up to and without `high`.
    pub fn within(&self, low: [i32; 2], high: [i32; 2]) -> Self {
        let rows = self.spans.iter().filter(|s| (low[1]..high[1]).contains(&s.y));
        let kept = rows.map(|s| Span { x0: s.x0.max(low[0]), x1: s.x1.min(high[0]), ..*s });
        Self::from_spans(kept.collect())
    }

    /// The mask relative to an origin; on a torus of the given size, every pixel where it is nearest to
    /// the origin.
    pub fn around(&self, origin: [i32; 2], torus: Option<[i32; 2]>) -> Self {
        let Some([w, h]) = torus else { return self.shifted(-origin[0], -origin[1]) };
        let near = |v: i32, size: i32| (v + size / 2).rem_euclid(size) - size / 2;
        let pixel = |(x, y): (i32, i32)| {
            let x = near(x - origin[0], w);
            Span { y: near(y - origin[1], h), x0: x, x1: x + 1 }
        };
        Self::from_spans(self.pixels().map(pixel).collect())
    }

    /// Number of pixels in both sets.
    pub fn overlap(&self, other: &Self) -> u32 {
        let (mut i, mut j, mut count) = (0, 0, 0);
        while let (Some(a), Some(b)) = (self.spans.get(i), other.spans.get(j)) {
            if a.y == b.y {
                count += (a.x1.min(b.x1) - a.x0.max(b.x0)).max(0);
            }
            if (a.y, a.x1) <= (b.y, b.x1) { i += 1 } else { j += 1 }
        }
        count as u32
    }

    /// The pixels in both sets.
    pub fn intersection(&self, other: &Self) -> Self {
        let (mut i, mut j, mut spans) = (0, 0, Vec::new());
        while let (Some(a), Some(b)) = (self.spans.get(i), other.spans.get(j)) {
            let (x0, x1) = (a.x0.max(b.x0), a.x1.min(b.x1));
            if a.y == b.y && x0 < x1 {
                spans.push(Span { y: a.y, x0, x1 });
            }
            if (a.y, a.x1) <= (b.y, b.x1) { i += 1 } else { j += 1 }
        }
        Self { spans }
    }

    /// The pixels of this set that are not in another.
    pub fn without(&self, other: &Self) -> Self {
        let (mut from, mut spans) = (0, Vec::with_capacity(self.spans.len()));
        for s in &self.spans {
            while other.spans.get(from).is_some_and(|o| (o.y, o.x1) <= (s.y, s.x0)) {
                from += 1;
            }
            let mut x0 = s.x0;
            let within = other.spans[from..].iter().take_while(|o| o.y == s.y && o.x0 < s.x1);
            for o in within {
                spans.extend((x0 < o.x0).then_some(Span { y: s.y, x0, x1: o.x0 }));
                x0 = o.x1;
            }
            spans.extend((x0 < s.x1).then_some(Span { y: s.y, x0, x1: s.x1 }));
        }
        Self { spans }
    }

    /// All pixels, row by row, as (x, y).
    pub fn pixels(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        self.spans.iter().flat_map(|s| (s.x0..s.x1).map(move |x| (x, s.y)))
    }
}

fn push_runs(row: &[u32], y: i32, x_offset: i32, inside: impl Fn(u32) -> bool, spans: &mut Vec<Span>) {
    let mut x = 0;
    while x < row.len() {
        if inside(row[x]) {
            let start = x;
            while x < row.len() && inside(row[x]) {
                x += 1;
            }
            spans.push(Span { y, x0: x_offset + start as i32, x1: x_offset + x as i32 });
        } else {
            x += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mask_strategy() -> impl Strategy<Value = Mask> {
        prop::collection::vec((0..12i32, 0..20i32, 1..8i32), 0..20).prop_map(|runs| {
            Mask::from_spans(runs.into_iter().map(|(y, x, n)| Span { y, x0: x, x1: x + n }).collect())
        })
    }

    proptest! {
        #[test]
        fn overlap_counts_common_pixels(a in mask_strategy(), b in mask_strategy()) {
            let common = a.pixels().filter(|&(x, y)| b.contains(x, y)).count();
            prop_assert_eq!(a.overlap(&b) as usize, common);
            prop_assert_eq!(a.overlap(&b), b.overlap(&a));
            prop_assert_eq!(a.overlap(&a), a.area());
        }

        #[test]
        fn a_set_without_another_keeps_the_rest(a in mask_strategy(), b in mask_strategy()) {
            let wanted: Vec<_> = a.pixels().filter(|&(x, y)| !b.contains(x, y)).collect();
            let rest = a.without(&b);
            prop_assert_eq!(rest.pixels().collect::<Vec<_>>(), wanted);
            prop_assert_eq!(Mask::from_spans(rest.spans().to_vec()), rest);
        }

        #[test]
        fn cracks_lie_between_the_set_and_the_rest(a in mask_strategy()) {
            let mut found = Vec::new();
            a.for_cracks(|p, d, behind| found.push((p, d, behind)));
            let steps = [[-1, 0], [1, 0], [0, -1], [0, 1]];
            let all = a.pixels().flat_map(|(x, y)| {
                steps.map(|[dx, dy]| ([x, y], [dx, dy], a.contains(x - dx, y - dy)))
            });
            let mut wanted: Vec<_> = all.filter(|([x, y], [dx, dy], _)| !a.contains(x + dx, y + dy)).collect();
            found.sort_unstable();
            wanted.sort_unstable();
            prop_assert_eq!(found, wanted);
        }

        #[test]
        fn the_interior_is_what_no_crack_touches(a in mask_strategy()) {
            let deep = |x: i32, y: i32| {
                [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)].iter().all(|(dx, dy)| a.contains(x + dx, y + dy))
            };
            let wanted: Vec<_> = a.pixels().filter(|&(x, y)| deep(x, y)).collect();
            prop_assert_eq!(a.interior().pixels().collect::<Vec<_>>(), wanted);
        }

        #[test]
        fn spans_are_sorted_and_apart(a in mask_strategy()) {
            for pair in a.spans().windows(2) {
                prop_assert!(pair[0].y < pair[1].y || pair[0].x1 < pair[1].x0);
            }
            let (dx, dy) = (-7, 3);
            let moved = a.shifted(dx, dy);
            prop_assert!(a.pixels().all(|(x, y)| moved.contains(x + dx, y + dy)));
            prop_assert_eq!(moved.area(), a.area());
        }
    }
}
