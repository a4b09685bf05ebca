//! Exact Euclidean distance transform (Felzenszwalb and Huttenlocher 2012).

/// Columns that are read together, so that little of each row is read often.
const COLUMNS: usize = 16;

/// Squared distance from every pixel to the nearest pixel for which `is_source` (given its index)
/// holds, in pixels². Row-major, `width` × `height` values. All are `f32::INFINITY` if there is no
/// source.
pub fn squared_distance(width: usize, height: usize, is_source: impl Fn(usize) -> bool) -> Vec<f32> {
    let mut d: Vec<f32> =
        (0..width * height).map(|i| if is_source(i) { 0.0 } else { f32::INFINITY }).collect();
    let mut lines = vec![0.0; COLUMNS * height.max(width)];
    let mut out = vec![0.0; height];
    let longest = width.max(height);
    let mut scratch = Scratch { at: vec![0; longest], from: vec![0.0; longest + 1] };
    for x in (0..width).step_by(COLUMNS) {
        let columns = x..(x + COLUMNS).min(width);
        for (y, row) in d.chunks_exact(width).enumerate() {
            row[columns.clone()].iter().enumerate().for_each(|(k, value)| lines[k * height + y] = *value);
        }
        for line in lines.chunks_exact_mut(height.max(1)).take(columns.len()) {
            transform_line(line, &mut out, &mut scratch);
            line.copy_from_slice(&out);
        }
        for (y, row) in d.chunks_exact_mut(width).enumerate() {
            row[columns.clone()].iter_mut().enumerate().for_each(|(k, value)| *value = lines[k * height + y]);
        }
    }
    let line = &mut lines[..width];
    for row in d.chunks_mut(width) {
        line.copy_from_slice(row);
        transform_line(line, row, &mut scratch);
    }
    d
}

struct Scratch {
    at: Vec<usize>,
    from: Vec<f32>,
}

/// Lower envelope of the parabolas `f[q] + (x - q)²`.
fn transform_line(f: &[f32], out: &mut [f32], s: &mut Scratch) {
    let mut k = 0usize;
    let mut empty = true;
    for q in 0..f.len() {
        if f[q].is_infinite() {
            continue;
        }
        if empty {
            (s.at[0], s.from[0], k, empty) = (q, f32::NEG_INFINITY, 0, false);
            continue;
        }
        loop {
            let p = s.at[k];
            let (fq, fp) = (f[q] + (q * q) as f32, f[p] + (p * p) as f32);
            let x = (fq - fp) / (2 * (q - p)) as f32;
            if x <= s.from[k] && k > 0 {
                k -= 1;
                continue;
            }
            k += 1;
            (s.at[k], s.from[k]) = (q, x);
            break;
        }
    }
    if empty {
        out.fill(f32::INFINITY);
        return;
    }
    let mut j = 0;
    for (x, value) in out.iter_mut().enumerate() {
        while j < k && s.from[j + 1] < x as f32 {
            j += 1;
        }
        let p = s.at[j];
        let d = x.abs_diff(p) as f32;
        *value = d * d + f[p];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn equals_brute_force(sources in prop::collection::vec(prop::bool::weighted(0.05), 37 * 9)) {
            let d = squared_distance(37, 9, |i| sources[i]);
            for (i, &value) in d.iter().enumerate() {
                let (x, y) = (i as i64 % 37, i as i64 / 37);
                let nearest = (0..sources.len())
                    .filter(|&j| sources[j])
                    .map(|j| (x - j as i64 % 37).pow(2) + (y - j as i64 / 37).pow(2))
                    .min();
                match nearest {
                    Some(n) => prop_assert_eq!(value, n as f32),
                    None => prop_assert!(value.is_infinite()),
                }
            }
        }
    }
}
