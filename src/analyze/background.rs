//! The background palette: median colours of the ground in Voronoi cells.

use crate::library::{AnalyzeParams, Background};
use crate::raster::{LabelMap, colour, squared_distance};
use crate::sampling::{Domain, poisson_disk, stream};
use crate::scene::ControlPoint;
use image::RgbImage;
use spade::{DelaunayTriangulation, Point2};

/// Fewest pixels that give a cell a colour.
const ENOUGH: usize = 12;

/// Takes the palette. `primaries` holds a label above 0 where a primary stands, `textons` where
/// any texton stands. Of each cell the pixels at least `background_margin` from every texton
/// count; where they are too few the strip is made thinner, in the end only primaries and the
/// pixel around them are left out, so that what lies between small textons is ground too.
pub(super) fn palette(
    image: &RgbImage,
    primaries: &LabelMap,
    textons: &LabelMap,
    params: &AnalyzeParams,
) -> Background {
    let (w, h) = (image.width() as usize, image.height() as usize);
    let domain = Domain { width: w as f64, height: h as f64, wrap_x: params.wrap, wrap_y: params.wrap };
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
    let median_beyond = |cell: &[u32], distance2: &[f32], strip: f32| {
        let ground: Vec<u32> =
            cell.iter().copied().filter(|&i| distance2[i as usize] > strip * strip).collect();
        if ground.len() >= ENOUGH { colour::median(ground.into_iter().map(rgb)) } else { None }
    };
    let strips = [1.0, 0.6, 0.4, 0.2].map(|share| margin * share);
    let mut found = Vec::new();
    for (site, cell) in sites.iter().zip(&pixels) {
        let colour = strips
            .iter()
            .find_map(|&strip| median_beyond(cell, &from_textons, strip))
            .or_else(|| median_beyond(cell, &from_primaries, 1.0));
        found.extend(colour.map(|colour| ControlPoint { x: round(site[0]), y: round(site[1]), colour }));
    }
    let ground = (0..w as u32 * h as u32).filter(|&i| primaries.labels[i as usize] == 0);
    let fallback = colour::median(ground.map(rgb))
        .or_else(|| colour::median(image.pixels().map(|p| p.0)))
        .unwrap_or_default();
    Background { spacing: params.background_spacing, fallback, sites: found }
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
