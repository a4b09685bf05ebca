//! Fast hashed noise, bitwise equal on every platform.

/// 32 well-mixed bits of a lattice point.
#[inline]
pub(super) fn hash(x: i32, y: i32, seed: u32) -> u32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed;
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

/// 32 bits as a number in 0..1.
#[inline]
pub(super) fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Integer part (floor) and fractional part of `v`.
#[inline]
pub(super) fn split(v: f32) -> (i32, f32) {
    let truncated = v as i32;
    let floor = truncated - i32::from(v < truncated as f32);
    (floor, v - floor as f32)
}

/// Smooth gradient noise (Perlin 2002, hashed), about -1..1, wavelength 1.
#[inline]
pub(super) fn noise(x: f32, y: f32, seed: u32) -> f32 {
    const GRADIENTS: [[f32; 2]; 16] = [
        [1.0, 0.0],
        [0.924, 0.383],
        [0.707, 0.707],
        [0.383, 0.924],
        [0.0, 1.0],
        [-0.383, 0.924],
        [-0.707, 0.707],
        [-0.924, 0.383],
        [-1.0, 0.0],
        [-0.924, -0.383],
        [-0.707, -0.707],
        [-0.383, -0.924],
        [0.0, -1.0],
        [0.383, -0.924],
        [0.707, -0.707],
        [0.924, -0.383],
    ];
    let ((xi, fx), (yi, fy)) = (split(x), split(y));
    // One round of mixing is enough for the top bits.
    let (column, row) = ((xi as u32).wrapping_mul(0x9e37_79b1), (yi as u32).wrapping_mul(0x85eb_ca77) ^ seed);
    let columns = [column, column.wrapping_add(0x9e37_79b1)];
    let rows = [row, (yi as u32).wrapping_add(1).wrapping_mul(0x85eb_ca77) ^ seed];
    let corner = |dx: usize, dy: usize| {
        let h = columns[dx] ^ rows[dy];
        let g = GRADIENTS[((h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d) >> 28) as usize];
        g[0] * (fx - dx as f32) + g[1] * (fy - dy as f32)
    };
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (fade(fx), fade(fy));
    let top = mix(corner(0, 0), corner(1, 0), u);
    let bottom = mix(corner(0, 1), corner(1, 1), u);
    1.5 * mix(top, bottom, v)
}

/// Fractal sum of [`noise`]. Each octave has half the amplitude and half the wavelength of the previous
/// one and is rotated against it, which hides the lattice. About -1..1.
#[inline]
pub(super) fn fractal(mut x: f32, mut y: f32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight) = (0.0, 0.6);
    for octave in 0..octaves {
        sum += weight * noise(x, y, seed.wrapping_add(octave.wrapping_mul(0x68e3_1da4)));
        (x, y) = (1.6 * x + 1.2 * y, 1.6 * y - 1.2 * x);
        weight *= 0.5;
    }
    sum
}

/// Linear interpolation: `a` at `t` = 0, `b` at `t` = 1.
#[inline]
pub(super) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// 0 below `low`, 1 above `high`, smooth between.
#[inline]
pub(super) fn smoothstep(low: f32, high: f32, v: f32) -> f32 {
    let t = ((v - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_centred_and_bounded() {
        let (mut sum, mut largest) = (0.0, 0.0f32);
        for i in 0..20_000 {
            let (x, y) = (i as f32 * 0.37 - 3000.0, i as f32 * 0.11 - 900.0);
            let v = noise(x, y, 5);
            sum += v;
            largest = largest.max(v.abs());
            assert!((noise(x + 0.01, y, 5) - v).abs() < 0.05);
        }
        assert!((sum / 20_000.0).abs() < 0.02 && largest > 0.6 && largest < 1.3, "{sum} {largest}");
    }
}
