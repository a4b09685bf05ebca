//! The background palette: the median colour of the background in each of a set of Voronoi cells.

use image::RgbImage;
use spade::{DelaunayTriangulation, Point2};
use vtex_base::parallel;
use vtex_base::raster::{LabelMap, colour, squared_distance};
use vtex_base::sampling::{Area, poisson_disk, stream};
use vtex_scene::library::AnalyzeParams;
use vtex_scene::scene::{ControlPoint, Field};

/// Least share of a cell's mean area that must be background for the cell to yield a colour.
const LEAST_SHARE: f64 = 0.12;
/// Outlier threshold, as a multiple of the median distance to the palette's median colour. Colours beyond
/// it come from elements that the masks missed.
const OUTLIER_FACTOR: f32 = 3.5;
/// Lower bound of the outlier threshold, in Oklab units.
const LEAST_LIMIT: f32 = 0.03;

/// Samples the palette at the sites of a Poisson-disk set. `primaries` is above 0 in primaries, `textons`
/// above 0 in any element. A cell's colour is the median of its pixels that lie at least
/// `background_margin` from every element. If too few remain, the margin is reduced in steps. As a last
/// resort only primaries and a thin strip around them are excluded, so the space between small elements
/// counts as background. Cells with little background, and outlying colours, are left out.
pub(super) fn palette(
    image: &RgbImage,
    primaries: &LabelMap,
    textons: &LabelMap,
    params: &AnalyzeParams,
) -> Field {
    let (w, h) = (image.width() as usize, image.height() as usize);
    let domain = Area { width: w as f64, height: h as f64, wrap_x: params.wrap, wrap_y: params.wrap };
    let mut random = stream(params.seed, "analyze/background", 0);
    let sites = poisson_disk(domain, params.background_spacing, &mut random);
    let cells = nearest_site(w, h, &sites);
    let (from_textons, from_primaries) = parallel::join(
        || squared_distance(w, h, |i| textons.labels[i] != 0),
        || squared_distance(w, h, |i| primaries.labels[i] != 0),
    );
    let mut pixels: Vec<Vec<u32>> = vec![Vec::new(); sites.len()];
    for (i, &cell) in cells.iter().enumerate() {
        pixels[cell as usize].push(i as u32);
    }
    let rgb = |i: u32| image.as_raw()[3 * i as usize..][..3].try_into().unwrap_or([0; 3]);
    let margin = params.background_margin as f32;
    let enough = LEAST_SHARE * (w * h) as f64 / sites.len().max(1) as f64;
    let median_beyond = |cell: &[u32], distance2: &[f32], strip: f32| {
        let background: Vec<u32> =
            cell.iter().copied().filter(|&i| distance2[i as usize] > strip * strip).collect();
        if background.len() as f64 >= enough { colour::median(background.into_iter().map(rgb)) } else { None }
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
    let background = (0..w as u32 * h as u32).filter(|&i| primaries.labels[i as usize] == 0);
    let fallback = colour::median(found.iter().map(|s| s.colour.0))
        .or_else(|| colour::median(background.map(rgb)))
        .or_else(|| colour::median(image.pixels().map(|p| p.0)))
        .unwrap_or_default();
    Field { spacing: params.background_spacing, fallback, points: found }
}

/// Drops sites whose colour lies far from the palette's median colour, relative to the median of
/// these distances (Oklab). A background of two colours has a large median and keeps both.
fn drop_outliers(sites: &mut Vec<ControlPoint>) {
    let Some(middle) = colour::median(sites.iter().map(|s| s.colour.0)) else { return };
    let centre = middle.to_oklab();
    let distance = |s: &ControlPoint| {
        let lab = s.colour.to_oklab();
        (0..3).map(|c| (lab[c] - centre[c]) * (lab[c] - centre[c])).sum::<f32>().sqrt()
    };
    let mut distances: Vec<f32> = sites.iter().map(distance).collect();
    distances.sort_by(f32::total_cmp);
    let limit = (OUTLIER_FACTOR * distances[distances.len() / 2]).max(LEAST_LIMIT);
    sites.retain(|s| distance(s) <= limit);
}

/// Rounds to a hundredth of a pixel, which keeps files small.
fn round(v: f64) -> f64 {
    libm::round(v * 100.0) / 100.0
}

/// Index of the nearest site for every pixel (its Voronoi cell).
fn nearest_site(w: usize, h: usize, sites: &[[f64; 2]]) -> Vec<u32> {
    let mut cells = vec![0; w * h];
    let points = sites.iter().map(|s| Point2::new(s[0], s[1])).collect();
    if let Ok(triangulation) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points) {
        parallel::for_chunks(&mut cells, w, |y, row| {
            for (x, cell) in row.iter_mut().enumerate() {
                let at = Point2::new(x as f64 + 0.5, y as f64 + 0.5);
                *cell = triangulation.nearest_neighbor(at).map_or(0, |v| v.index() as u32);
            }
        });
    }
    cells
}
