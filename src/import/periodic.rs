//! Whether the opposite borders of a picture join.

use image::RgbImage;

/// Share of neighbouring columns that may differ more than the borders do.
const QUANTILE: f64 = 0.02;
/// Difference of columns that is none, in 8-bit steps.
const NONE: f64 = 1.5;

/// Whether both pairs of borders join as well as neighbouring columns and rows do.
pub(super) fn is_periodic(picture: &RgbImage) -> bool {
    joins(picture, true) && joins(picture, false)
}

fn joins(picture: &RgbImage, across_x: bool) -> bool {
    let (w, h) = picture.dimensions();
    let (count, length) = if across_x { (w, h) } else { (h, w) };
    if count < 3 {
        return false;
    }
    let difference = |a: u32, b: u32| {
        let pixel =
            |v: u32, t: u32| picture.get_pixel(if across_x { v } else { t }, if across_x { t } else { v });
        let sum = |t: u32| {
            let (p, q) = (pixel(a, t).0, pixel(b, t).0);
            (0..3).map(|k| u64::from(p[k].abs_diff(q[k]))).sum::<u64>()
        };
        (0..length).map(sum).sum::<u64>() as f64 / (3.0 * f64::from(length))
    };
    let mut within: Vec<f64> = (1..count).map(|v| difference(v - 1, v)).collect();
    within.sort_by(f64::total_cmp);
    let usual = within[((1.0 - QUANTILE) * (within.len() - 1) as f64) as usize];
    difference(count - 1, 0) <= usual.max(NONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn borders_that_go_on_join() {
        // Bands whose phase returns to itself after the width, or does not.
        let of = |periods: f64| {
            RgbImage::from_fn(60, 40, |x, _| {
                Rgb([(127.0 + 120.0 * libm::sin(f64::from(x) / 60.0 * periods * 6.283)) as u8; 3])
            })
        };
        assert!(is_periodic(&of(2.0)));
        assert!(!is_periodic(&of(2.5)));
    }
}
