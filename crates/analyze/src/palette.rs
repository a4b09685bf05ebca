//! Colour quantisation of flat fills.

use vtex_base::kmeans;
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::stream;

/// The palette's colours, each in sRGB and in Oklab. Empty if colours are not quantised.
pub(super) struct Palette(Vec<(Colour, [f64; 3])>);

impl Palette {
    /// Clusters colours, each given with its area in pixels, into at most `count` palette entries
    /// (weighted k-means in Oklab). A `count` of 0 gives an empty palette.
    pub(super) fn new(colours: &[(Colour, u32)], count: usize, seed: u64) -> Self {
        if count == 0 {
            return Self(Vec::new());
        }
        let points: Vec<[f64; 3]> = colours.iter().map(|(c, _)| oklab(*c)).collect();
        let weights: Vec<f64> = colours.iter().map(|&(_, area)| f64::from(area.max(1))).collect();
        let assigned =
            kmeans::cluster(&points, &weights, count, |start| stream(seed, "analyze/palette", start)).of;
        let mut sums = vec![([0.0; 3], 0.0); assigned.iter().max().map_or(0, |m| m + 1)];
        for ((&cluster, (colour, _)), w) in assigned.iter().zip(colours).zip(&weights) {
            let own = colour.to_f64();
            sums[cluster].0 = [0, 1, 2].map(|c| sums[cluster].0[c] + w * own[c]);
            sums[cluster].1 += w;
        }
        let held = sums.into_iter().filter(|s| s.1 > 0.0);
        Self(held.map(|(sum, w)| Colour::from_f64(sum.map(|v| v / w))).map(|c| (c, oklab(c))).collect())
    }

    /// The palette entry nearest to a colour in Oklab; the colour itself if the palette is empty.
    pub(super) fn nearest(&self, colour: Colour) -> Colour {
        let own = oklab(colour);
        let distance = |c: &[f64; 3]| (0..3).map(|i| (c[i] - own[i]) * (c[i] - own[i])).sum::<f64>();
        let nearest = self.0.iter().min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)));
        nearest.map_or(colour, |c| c.0)
    }
}

fn oklab(colour: Colour) -> [f64; 3] {
    colour.to_oklab().map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_stand_for_many() {
        let about = |centre: [u8; 3]| (0..20).map(move |i| (Colour(centre.map(|v| v + i)), 5));
        let colours: Vec<(Colour, u32)> = about([200, 40, 30]).chain(about([20, 60, 190])).collect();
        let palette = Palette::new(&colours, 2, 7);
        assert_eq!(palette.nearest(Colour([205, 45, 40])), palette.nearest(Colour([219, 59, 49])));
        assert_ne!(palette.nearest(Colour([205, 45, 40])), palette.nearest(Colour([25, 65, 195])));
        let all = Palette::new(&colours, 0, 7);
        assert_eq!(all.nearest(Colour([1, 2, 3])), Colour([1, 2, 3]));
        assert_eq!(Palette::new(&[], 4, 7).nearest(Colour([1, 2, 3])), Colour([1, 2, 3]));
    }
}
