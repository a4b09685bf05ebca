//! The background palette: median colours of the ground in Voronoi cells.

use crate::library::{AnalyzeParams, Background};
use crate::raster::{LabelMap, colour, squared_distance};
use crate::sampling::{Area, poisson_disk, stream};
use crate::scene::ControlPoint;
use image::RgbImage;
use spade::{DelaunayTriangulation, Point2};

/// Share of a full cell's pixels that must be ground for the cell to have a colour.
const ENOUGH: f64 = 0.12;
/// Colours further from the middle of the palette than this many median distances are leftovers of
/// textons that the masks missed, not ground.
const OUTLIER: f32 = 3.5;
/// No colour nearer than this to the middle of the palette is an outlier, in Oklab units.
const ALIKE: f32 = 0.03;

/// Takes the palette. `primaries` holds a label above 0 where a primary stands, `textons` where
/// any texton stands. Of each cell the pixels at least `background_margin` from every texton
/// count; where they are too few the strip is made thinner, in the end only primaries and the
/// pixels around them are left out, so that what lies between small textons is ground too.
/// Cells of little ground and colours far from all others are left out.
pub(super) fn palette(
    image: &RgbImage,
    primaries: &LabelMap,
    textons: &LabelMap,
    params: &AnalyzeParams,
) -> Background {
    let (w, h) = (image.width() as usize, image.height() as usize);
    let domain = Area { width: w as f64, height: h as f64, wrap_x: params.wrap, wrap_y: params.wrap };
    let mut random = stream(params.seed, "analyze/background", 0);
    let sites = poisson_disk(domain, params.background_spacing, &mut random);
    let cells = nearest_site(w, h, &sites);
    let from_textons = squared_distance(w, h, |i| textons.labels[i] != 0);
    let from_primaries = squared_distance(w, h, |i| primaries.labels[i] != 0);
    let mut pixels: Vec<Vec<u32>> = vec![Vec::new(); sites.len()];
    for (i, &cell) in cells.iter().enumerate() {
        pixels[cell as usize].push(i as u32);
    }
    let rgb = |i: u32| image.as_raw()[3 * i as usize..][..3].try_into().unwrap_or([0; 3]);
    let margin = params.background_margin as f32;
    let enough = ENOUGH * (w * h) as f64 / sites.len().max(1) as f64;
    let median_beyond = |cell: &[u32], distance2: &[f32], strip: f32| {
        let ground: Vec<u32> =
            cell.iter().copied().filter(|&i| distance2[i as usize] > strip * strip).collect();
        if ground.len() as f64 >= enough { colour::median(ground.into_iter().map(rgb)) } else { None }
    };
    let mut found = Vec::new();
    for (site, cell) in sites.iter().zip(&pixels) {
        let colour = [1.0, 0.6, 0.4]
            .iter()
            .find_map(|share| median_beyond(cell, &from_textons, margin * share))
            .or_else(|| median_beyond(cell, &from_primaries, (0.4 * margin).min(2.0)));
        found.extend(colour.map(|colour| ControlPoint { x: round(site[0]), y: round(site[1]), colour }));
    }
    drop_outliers(&mut found);
    let ground = (0..w as u32 * h as u32).filter(|&i| primaries.labels[i as usize] == 0);
    let fallback = colour::median(found.iter().map(|s| s.colour.0))
        .or_else(|| colour::median(ground.map(rgb)))
        .or_else(|| colour::median(image.pixels().map(|p| p.0)))
        .unwrap_or_default();
    Background { spacing: params.background_spacing, fallback, sites: found }
}

/// Drops sites whose colour lies far from the middle of the palette, measured by the median
/// distance (Oklab). A ground of two colours has a large median distance and keeps both.
fn drop_outliers(sites: &mut Vec<ControlPoint>) {
    let Some(middle) = colour::median(sites.iter().map(|s| s.colour.0)) else { return };
    let centre = middle.to_oklab();
    let distance = |s: &ControlPoint| {
        let lab = s.colour.to_oklab();
        (0..3).map(|c| (lab[c] - centre[c]) * (lab[c] - centre[c])).sum::<f32>().sqrt()
    };
    let mut distances: Vec<f32> = sites.iter().map(distance).collect();
    distances.sort_by(f32::total_cmp);
    let limit = (OUTLIER * distances[distances.len() / 2]).max(ALIKE);
    sites.retain(|s| distance(s) <= limit);
}

/// To a hundredth of a pixel, so that files stay small.
fn round(v: f64) -> f64 {
    libm::round(v * 100.0) / 100.0
}

/// Index of the nearest site for every pixel (its Voronoi cell).
fn nearest_site(w: usize, h: usize, sites: &[[f64; 2]]) -> Vec<u32> {
    let mut cells = vec![0; w * h];
    let points = sites.iter().map(|s| Point2::new(s[0], s[1])).collect();
    if let Ok(triangulation) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points) {
        crate::parallel::for_chunks(&mut cells, w, |y, row| {
            for (x, cell) in row.iter_mut().enumerate() {
                let at = Point2::new(x as f64 + 0.5, y as f64 + 0.5);
                *cell = triangulation.nearest_neighbor(at).map_or(0, |v| v.index() as u32);
            }
        });
    }
    cells
}
