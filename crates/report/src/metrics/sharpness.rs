//! Sharpness: the variance of the Laplacian.

use super::plane::Channel;

/// Variance of the Laplacian (Pech-Pacheco and others 2000) of grey values from 0 to 255. The picture
/// is mirrored at its borders.
pub(super) fn lapvar(plane: &Channel) -> f64 {
    let (width, height) = (plane.width, plane.height);
    let (mut sum, mut squares) = (0.0, 0.0);
    for y in 0..height {
        let above = plane.row(y.saturating_sub(1));
        let (own, below) = (plane.row(y), plane.row((y + 1).min(height - 1)));
        for x in 0..width {
            let (left, right) = (own[x.saturating_sub(1)], own[(x + 1).min(width - 1)]);
            let around: f64 = [left, right, above[x], below[x]].iter().map(|v| f64::from(v * 255.0)).sum();
            let value = around - 4.0 * f64::from(own[x] * 255.0);
            sum += value;
            squares += value * value;
        }
    }
    let count = (width * height) as f64;
    squares / count - (sum / count) * (sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_takes_sharpness_away() {
        let board = Channel::from_fn(30, 20, |x, y| ((x + y) % 2) as f32);
        // The Laplacian of a checkerboard is ±4 · 255 in its interior.
        assert!((lapvar(&board) / (1020.0 * 1020.0) - 1.0).abs() < 0.2);
        assert!(lapvar(&board.smooth(1.0)) < 0.01 * lapvar(&board));
        assert_eq!(lapvar(&Channel::from_fn(9, 9, |_, _| 0.25)), 0.0);
    }
}
