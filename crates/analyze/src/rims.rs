//! Soft rims: the borders of elements that the photograph shows out of focus.
//!
//! Across an outline, colours change over a pixel or two where the photograph is in focus, and over more where it is
//! not. The width of the border is that between 10 % and 90 % of the change, in the median of places along the outline.
//! Where it is clearly over that of an edge in focus, a translucent line of that width ([`SoftRim`]) is tried, in the
//! colour and with the opacity that take most from the squared error of the picture. What is painted there already,
//! such as soft ellipses beside the outline and rims of neighbours, is part of that picture. The rim stays if it takes
//! away more than its bytes are worth.

use super::edges::sample;
use super::painted::PaintedPicture;
use image::RgbImage;
use std::ops::Range;
use vtex_base::geometry::{Outline, Point, Rect, Vec2};
use vtex_base::parallel;
use vtex_base::raster::LabelMap;
use vtex_base::raster::colour::Colour;
use vtex_scene::element::SoftRim;

/// Bytes of a rim as [`RateDistortion`](super::rate_distortion::RateDistortion) counts them: as packed, 3.5 times
/// those of a soft ellipse.
pub(super) const RIM_BYTES: f64 = 95.0;
/// Width of a border from which it is out of focus, in pixels from 10 % to 90 % of the change. Those of photographs in
/// focus have 1.4 to 1.6 in the mean.
const SOFT: f64 = 2.0;
/// Share of a linear ramp that lies between 10 % and 90 % of its change.
const RISE: f64 = 0.8;
/// Widest rim, in pixels.
const WIDEST: f64 = 12.0;
/// Opacities tried.
const OPACITIES: [f64; 4] = [0.4, 0.6, 0.8, 1.0];
/// Offsets within a pixel, along the normal of an outline, at which the opacity of a rim is sampled.
const WITHIN: [f64; 3] = [-1.0 / 3.0, 0.0, 1.0 / 3.0];
/// Distance between places along an outline, in pixels.
const SPACING: f64 = 1.0;
/// Fewest places along an outline whose border is measured.
const PLACES: usize = 24;
/// Share of the places along an outline at which there must be a border.
const BORDERED: f64 = 0.25;
/// Least contrast of a border, over 3 px, in steps of 8 bits.
const CONTRAST: f64 = 15.0;
/// Distance between samples across an outline, in pixels.
const STEP: f64 = 0.5;
/// Samples to each side of an outline.
const REACH: usize = 17;
/// A border ends where its slope is less than this share of the steepest.
const END: f64 = 0.08;

/// The soft rims of elements, whose `outlines` are in painting order and have the labels from 1 on: those that take more
/// from the squared error between the `photograph` and what is `painted` than `least`, over pixels and components.
pub(super) fn rims(
    photograph: &RgbImage,
    labels: &LabelMap,
    painted: &PaintedPicture,
    outlines: &[Outline],
    least: f64,
) -> Vec<Option<SoftRim>> {
    let blurred = parallel::map(outlines, |outline| {
        let width = width(photograph, outline)?;
        Some((width, pixels_near(outline, width / 2.0, [labels.width, labels.height])))
    });
    if blurred.iter().all(Option::is_none) {
        return vec![None; outlines.len()];
    }
    let mut painted = painted.colours.clone();
    // One after the other: a rim is painted on those of elements below.
    let mut rim = |(label, blurred): (u32, Option<(f64, Vec<NearPixel>)>)| {
        let (width, mut near) = blurred?;
        // Elements painted later hide it.
        near.retain(|pixel| labels.labels[pixel.index] <= label);
        let sums = RimSums::new(photograph, &painted, &near, width);
        let fits = OPACITIES.into_iter().filter_map(|opacity| sums.fit(width, opacity));
        // Of equals the first.
        let best = fits.reduce(|best, fit| if fit.gain > best.gain { fit } else { best })?;
        if best.gain <= least {
            return None;
        }
        let own = best.rim.colour.to_f64();
        for pixel in near {
            let opacity = best.rim.opacity * pixel.share(width);
            let below = &mut painted[pixel.index];
            (0..3).for_each(|c| below[c] += (opacity * (own[c] - f64::from(below[c]))) as f32);
        }
        Some(best.rim)
    };
    (1..).zip(blurred).map(&mut rim).collect()
}

/// The width of the rim of an element with an outline; `None` if its border is in focus, or none is seen.
fn width(photograph: &RgbImage, outline: &Outline) -> Option<f64> {
    let places = places(outline);
    if places.len() < PLACES {
        return None;
    }
    let widths = places.iter().filter_map(|&(at, normal)| Profile::new(photograph, at, normal).width());
    let mut widths: Vec<f64> = widths.collect();
    if (widths.len() as f64) < BORDERED * places.len() as f64 {
        return None;
    }
    widths.sort_by(f64::total_cmp);
    let median = widths[widths.len() / 2];
    // Rounded, so that numbers repeat in files.
    (median >= SOFT).then(|| libm::round(4.0 * (median / RISE).min(WIDEST)) / 4.0)
}

/// Places along an outline, [`SPACING`] apart, with the unit normal at each.
fn places(outline: &Outline) -> Vec<(Point, Vec2)> {
    let mut places = Vec::new();
    for ring in outline.polygons(0.05) {
        let mut ahead = SPACING / 2.0;
        for (i, &from) in ring.iter().enumerate() {
            let along = ring[(i + 1) % ring.len()] - from;
            let length = along.hypot();
            while ahead < length {
                places.push((from + along * (ahead / length), Vec2::new(-along.y, along.x) / length));
                ahead += SPACING;
            }
            ahead -= length;
        }
    }
    places
}

/// Colours across an outline, [`STEP`] apart, half of them on either side.
struct Profile([[f64; 3]; 2 * REACH]);

impl Profile {
    fn new(image: &RgbImage, at: Point, normal: Vec2) -> Self {
        Self(std::array::from_fn(|k| sample(image, at + normal * Self::distance(k))))
    }

    /// Signed distance of a sample from the outline, in pixels.
    fn distance(k: usize) -> f64 {
        (k as f64 + 0.5 - REACH as f64) * STEP
    }

    /// The width of the border, in pixels; `None` if there is none.
    fn width(&self) -> Option<f64> {
        const NEAR: usize = 3;
        let (low, high) = (self.0[REACH - NEAR], self.0[REACH - 1 + NEAR]);
        let apart = [0, 1, 2].map(|c| high[c] - low[c]);
        let contrast = libm::sqrt(apart.iter().map(|v| v * v).sum());
        if contrast < CONTRAST {
            return None;
        }
        let along = self.0.map(|colour| (0..3).map(|c| colour[c] * apart[c]).sum::<f64>() / contrast);
        let slope = |k: usize| along[k + 1] - along[k];
        let near = REACH - NEAR..REACH - 1 + NEAR;
        let steepest = near.reduce(|best, k| if slope(k) > slope(best) { k } else { best })?;
        let least = END * slope(steepest);
        if least <= 0.0 {
            return None;
        }
        let last = 2 * REACH - 1;
        let end = (steepest..last).find(|&k| slope(k) < least).unwrap_or(last);
        let start = (0..steepest).rev().find(|&k| slope(k) < least).map_or(0, |k| k + 1);
        let [from, to] = [(1.0 - RISE) / 2.0, (1.0 + RISE) / 2.0].map(|share| {
            let level = along[start] + share * (along[end] - along[start]);
            let k = (start..end).find(|&k| along[k + 1] >= level).unwrap_or(end - 1);
            k as f64 + (level - along[k]) / slope(k)
        });
        Some((to - from) * STEP)
    }
}

/// A pixel near an outline.
struct NearPixel {
    index: usize,
    /// Distance of its middle from the outline, in pixels.
    distance: f64,
}

impl NearPixel {
    /// The opacity of a rim in the pixel, relative to that on the outline.
    fn share(&self, width: f64) -> f64 {
        let rim = SoftRim { width, colour: Colour::default(), opacity: 1.0 };
        let all = WITHIN.map(|offset| rim.opacity_at((self.distance + offset).abs()));
        all.iter().sum::<f64>() / all.len() as f64
    }
}

/// The pixels of a picture that a line along an outline touches, half of its width on either side.
fn pixels_near(outline: &Outline, half: f64, size: [u32; 2]) -> Vec<NearPixel> {
    let reach = half + 0.5;
    let rings = outline.polygons(0.05);
    let points = rings.iter().flatten();
    // Polygons reach beyond the bounds of the curves that they replace, by up to the tolerance.
    let Some(bounds) = points.map(|p| Rect::from_points(*p, *p)).reduce(|all, p| all.union(p)) else {
        return Vec::new();
    };
    let pixels = |from: f64, to: f64, within: &Range<usize>| {
        let [from, to] = [libm::floor(from - reach), libm::ceil(to + reach)];
        let [from, to] = [from, to].map(|v| v.clamp(within.start as f64, within.end as f64) as usize);
        from..to
    };
    let [width, height] = size.map(|side| 0..side as usize);
    let [columns, rows] = [pixels(bounds.x0, bounds.x1, &width), pixels(bounds.y0, bounds.y1, &height)];
    let mut squares = vec![f64::INFINITY; columns.len() * rows.len()];
    for ring in &rings {
        for (i, &from) in ring.iter().enumerate() {
            let to = ring[(i + 1) % ring.len()];
            // In short pieces, around each of which few pixels are far away.
            let count = libm::ceil((to - from).hypot() / reach).max(1.0);
            for k in 0..count as usize {
                let [a, b] = [k, k + 1].map(|k| from.lerp(to, k as f64 / count));
                let piece = Rect::from_points(a, b);
                let xs = pixels(piece.x0, piece.x1, &columns);
                for y in pixels(piece.y0, piece.y1, &rows) {
                    for x in xs.clone() {
                        let middle = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                        let near = &mut squares[(y - rows.start) * columns.len() + x - columns.start];
                        *near = near.min(squared_distance(middle, a, b));
                    }
                }
            }
        }
    }
    let near = squares.into_iter().enumerate().filter(|(_, square)| *square < reach * reach);
    let pixel = |(i, square): (usize, f64)| {
        let (x, y) = (columns.start + i % columns.len(), rows.start + i / columns.len());
        NearPixel { index: y * size[0] as usize + x, distance: libm::sqrt(square) }
    };
    near.map(pixel).collect()
}

/// Squared distance of a point from the line between two others.
fn squared_distance(p: Point, a: Point, b: Point) -> f64 {
    let (way, own) = (b - a, p - a);
    let length = way.hypot2();
    let t = if length > 0.0 { (own.dot(way) / length).clamp(0.0, 1.0) } else { 0.0 };
    (own - way * t).hypot2()
}

/// Sums over the pixels of a rim that give its best colour for any opacity.
#[derive(Default)]
struct RimSums {
    /// Of squared shares of opacity.
    squares: f64,
    /// Of shares times what is missing, by component.
    missing: [f64; 3],
    /// Of squared shares times what is painted, by component.
    painted: [f64; 3],
    /// What a black rim of full opacity adds to the squared error: the part that grows with the opacity, and the part
    /// that grows with its square.
    black: [f64; 2],
}

/// A rim in its best colour.
struct RimFit {
    rim: SoftRim,
    /// By how much it reduces the squared error.
    gain: f64,
}

impl RimSums {
    fn new(photograph: &RgbImage, painted: &[[f32; 3]], near: &[NearPixel], width: f64) -> Self {
        let target = photograph.as_raw();
        let mut sums = Self::default();
        for pixel in near {
            let share = pixel.share(width);
            sums.squares += share * share;
            for c in 0..3 {
                let below = f64::from(painted[pixel.index][c]);
                let missing = f64::from(target[3 * pixel.index + c]) - below;
                sums.missing[c] += share * missing;
                sums.painted[c] += share * share * below;
                sums.black[0] += 2.0 * share * missing * below;
                sums.black[1] += share * share * below * below;
            }
        }
        sums
    }

    /// The rim of an opacity in its best colour; `None` if nothing of it is seen.
    fn fit(&self, width: f64, opacity: f64) -> Option<RimFit> {
        let squares = opacity * opacity * self.squares;
        if squares < 1.0 {
            return None;
        }
        let wanted = [0, 1, 2].map(|c| opacity * (self.missing[c] + opacity * self.painted[c]));
        let colour = Colour::from_f64(wanted.map(|v| v / squares));
        let own = colour.to_f64();
        let coloured = (0..3).map(|c| own[c] * (squares * own[c] - 2.0 * wanted[c])).sum::<f64>();
        let added = opacity * (self.black[0] + opacity * self.black[1]) + coloured;
        Some(RimFit { rim: SoftRim { width, colour, opacity }, gain: -added })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyzeParams, Exemplar, analyze};
    use image::Rgb;
    use vtex_base::error::Result;
    use vtex_base::geometry::{BezPath, parse_path};
    use vtex_base::progress::Progress;
    use vtex_base::raster::{LabelMap, Limits, Mask};
    use vtex_base::sampling::stream;
    use vtex_scene::library::{Library, Shading};
    use vtex_scene::reconstruct::reconstruct;
    use vtex_segment::segment::{ScoredMask, Segmenter};

    /// A picture of 80 × 80 with a disc of radius 20 whose border is a ramp of a width.
    fn disc(width: f64) -> RgbImage {
        RgbImage::from_fn(80, 80, |x, y| {
            let from = libm::hypot(f64::from(x) - 39.5, f64::from(y) - 39.5) - 20.0;
            let share = (0.5 - from / width).clamp(0.0, 1.0);
            Rgb([60.0, 80.0, 50.0].map(|v| libm::round(v + share * 100.0) as u8))
        })
    }

    fn circle() -> Outline {
        let path = "M60 40C60 51 51 60 40 60C29 60 20 51 20 40C20 29 29 20 40 20C51 20 60 29 60 40z";
        Outline::new(&parse_path(path).unwrap()).unwrap()
    }

    /// The disc with a crisp border.
    fn crisp() -> PaintedPicture {
        let colours = disc(1.0).pixels().map(|p| p.0.map(f32::from)).collect();
        PaintedPicture { width: 80, colours }
    }

    /// The rim of an element in a photograph, in which it is painted with a crisp border.
    fn rim(photograph: &RgbImage, outline: &Outline, least: f64) -> Option<SoftRim> {
        let labels = LabelMap::filled(80, 80, 0);
        rims(photograph, &labels, &crisp(), std::slice::from_ref(outline), least).pop().unwrap()
    }

    /// The squared error of a picture.
    fn error(photograph: &RgbImage, painted: &[[f32; 3]]) -> f64 {
        let all = photograph.pixels().zip(painted);
        all.map(|(p, own)| (0..3).map(|c| f64::from(f32::from(p.0[c]) - own[c])).map(|d| d * d).sum::<f64>())
            .sum()
    }

    #[test]
    fn the_width_of_a_rim_is_that_of_the_border() {
        for width in [4.0, 6.0, 9.0] {
            let found = rim(&disc(width), &circle(), 1000.0).unwrap();
            assert!((found.width / width - 1.0).abs() < 0.35, "{width} {found:?}");
            assert!(found.opacity >= 0.8, "{found:?}");
            let middle = [110.0, 130.0, 100.0];
            let off =
                found.colour.to_f64().iter().zip(middle).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 8.0, "{found:?}");
        }
    }

    #[test]
    fn borders_in_focus_and_even_ones_have_no_rim() {
        assert_eq!(rim(&disc(1.0), &circle(), 1000.0), None);
        assert_eq!(rim(&RgbImage::from_pixel(80, 80, Rgb([90; 3])), &circle(), 1000.0), None);
        // Not worth its bytes.
        assert_eq!(rim(&disc(6.0), &circle(), 1e9), None);
        // A speck.
        let speck = Outline::new(&parse_path("M38 38h4v4h-4z").unwrap()).unwrap();
        assert_eq!(rim(&disc(6.0), &speck, 0.0), None);
    }

    /// A ring of some curves with points made by chance around a picture of 64 × 48, or in its middle.
    fn by_chance(item: u64) -> Outline {
        let mut random = stream(58, "rims/tests", item);
        let around = if item.is_multiple_of(4) { 9.0 } else { -12.0 };
        let mut point =
            || Point::new(random.range(-around, 64.0 + around), random.range(-around, 48.0 + around));
        let mut path = BezPath::new();
        path.move_to(point());
        (0..1 + item % 5).for_each(|_| path.curve_to(point(), point(), point()));
        Outline::new(&path).unwrap()
    }

    #[test]
    fn pixels_near_outlines_made_by_chance_are_those_within_reach() {
        let mut beyond = 0;
        for item in 0..2000 {
            let outline = by_chance(item);
            let (rings, bounds) = (outline.polygons(0.05), outline.bounds());
            // Lines that end on a border of pixels where they follow the curves.
            let end = [bounds.x0, bounds.y0, -bounds.x1, -bounds.y1][item as usize % 4];
            let half = 0.5 + (end - libm::floor(end)) + (item % 3) as f64;
            beyond += rings.iter().flatten().filter(|p| bounds.union_pt(**p) != bounds).count();
            let near = pixels_near(&outline, half, [64, 48]);
            let mut found = near.iter().map(|p| (p.index, p.distance)).peekable();
            for index in 0..64 * 48 {
                let middle = Point::new((index % 64) as f64 + 0.5, (index / 64) as f64 + 0.5);
                let sides = rings.iter().flat_map(|r| (0..r.len()).map(|i| (r[i], r[(i + 1) % r.len()])));
                let squares = sides.map(|(a, b)| squared_distance(middle, a, b));
                let wanted = libm::sqrt(squares.fold(f64::INFINITY, f64::min));
                match found.next_if(|(own, _)| *own == index) {
                    Some((_, distance)) => assert!((distance - wanted).abs() < 1e-9, "{outline}: {index}"),
                    // Distances on the limit may round to either side.
                    None => assert!(wanted > half + 0.5 - 1e-9, "{outline}: {index} at {wanted}"),
                }
            }
            assert!(found.next().is_none());
        }
        assert!(beyond > 100, "{beyond}");
        assert!(pixels_near(&Outline::default(), 2.0, [64, 48]).is_empty());
    }

    #[test]
    fn gains_are_errors_that_are_taken_away() {
        let (photograph, near) = (disc(8.0), pixels_near(&circle(), 4.0, [80, 80]));
        let mut painted = crisp().colours;
        let fit = RimSums::new(&photograph, &painted, &near, 8.0).fit(8.0, 0.8).unwrap();
        let before = error(&photograph, &painted);
        for pixel in &near {
            let from = libm::hypot((pixel.index % 80) as f64 - 39.5, (pixel.index / 80) as f64 - 39.5) - 20.0;
            assert!((pixel.distance - from.abs()).abs() < 0.1, "{} {from}", pixel.distance);
            let opacity = 0.8 * pixel.share(8.0);
            let below = &mut painted[pixel.index];
            (0..3).for_each(|c| {
                below[c] += (opacity * (fit.rim.colour.to_f64()[c] - f64::from(below[c]))) as f32
            });
        }
        let after = error(&photograph, &painted);
        assert!(((before - after) / fit.gain - 1.0).abs() < 1e-3, "{before} - {after} = {}", fit.gain);
        assert!(after < 0.25 * before, "{before} {after}");
        // Nothing is left for a second one.
        let again = RimSums::new(&photograph, &painted, &near, 8.0).fit(8.0, 0.8).unwrap();
        assert!(again.gain < 0.2 * fit.gain, "{} {}", again.gain, fit.gain);
    }

    #[test]
    fn what_is_painted_already_and_what_is_hidden_count() {
        let (photograph, outline) = (disc(6.0), circle());
        let painted = |colours: Vec<[f32; 3]>| PaintedPicture { width: 80, colours };
        let free = LabelMap::filled(80, 80, 0);
        let exact = painted(photograph.pixels().map(|p| p.0.map(f32::from)).collect());
        assert_eq!(rims(&photograph, &free, &exact, std::slice::from_ref(&outline), 100.0), [None]);
        // Of two elements with one border, one has a rim.
        let both = rims(&photograph, &free, &crisp(), &[outline.clone(), outline.clone()], 30_000.0);
        assert!(both[0].is_some() && both[1].is_none(), "{both:?}");
        let above = LabelMap::filled(80, 80, 2);
        let both = rims(&photograph, &above, &crisp(), &[outline.clone(), outline], 30_000.0);
        assert!(both[0].is_none() && both[1].is_some(), "{both:?}");
    }

    /// Finds the disc of [`disc`].
    struct Disc;

    impl Segmenter for Disc {
        fn name(&self) -> String {
            "disc".into()
        }

        fn segment(&self, image: &RgbImage, _: &dyn Progress) -> Result<Vec<ScoredMask>> {
            let labels = image.pixels().map(|p| u32::from(p.0[0] > 110)).collect();
            let map = LabelMap { width: image.width(), height: image.height(), labels };
            let masks = Mask::all_of_labels(&map, 2).split_off(1);
            Ok(masks.into_iter().map(|mask| ScoredMask { mask, score: 1.0 }).collect())
        }
    }

    /// The library of a disc whose border is a ramp of a width.
    fn library(width: f64, shading: Shading) -> Library {
        let mut png = std::io::Cursor::new(Vec::new());
        disc(width).write_to(&mut png, image::ImageFormat::Png).unwrap();
        let exemplar = Exemplar::from_bytes(&png.into_inner(), "disc.png", &Limits::default()).unwrap();
        analyze(&exemplar, &Disc, &AnalyzeParams { shading, ..AnalyzeParams::default() }, &()).unwrap()
    }

    #[test]
    fn libraries_and_scenes_keep_rims() {
        let soft = library(8.0, Shading::Soft);
        let rim = soft.primaries()[0].base().rim.as_deref().unwrap();
        assert!((5.0..11.0).contains(&rim.width), "{rim:?}");
        assert_eq!(Library::from_bytes(soft.to_json(), "disc").unwrap(), soft);
        let scene = reconstruct(&soft);
        let drawn = scene.individuals().next().unwrap();
        assert_eq!(scene.element(drawn).base().rim.as_deref(), Some(rim));
        // Twice as large.
        let twice = soft.scaled([2.0; 2]);
        assert_eq!(twice.primaries()[0].base().rim.as_ref().unwrap().width, 2.0 * rim.width);
    }

    #[test]
    fn only_soft_shading_has_rims() {
        let rims = |library: Library| library.elements.iter().filter(|e| e.base().rim.is_some()).count();
        assert_eq!(rims(library(8.0, Shading::Soft)), 1);
        assert_eq!(rims(library(8.0, Shading::Gradient)) + rims(library(8.0, Shading::Flat)), 0);
        assert_eq!(rims(library(1.0, Shading::Soft)), 0);
    }
}
