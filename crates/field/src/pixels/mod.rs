//! Pixel-based synthesis: textures without elements, as a baseline and for backgrounds.
//!
//! [`carried`] copies the pixels of a photograph along a correspondence field. [`scanned`] makes pixels one
//! by one with a codebook of neighbourhoods (Wei and Levoy); [`filled`] does so within a hole, and [`extended`]
//! beyond the border of a picture. [`by_numbers`] and [`scanned_by_numbers`] follow two label maps, one of the
//! photograph and one of the result.
//!
//! Works badly where elements must stay whole, because pixels carry no knowledge of them.

mod colour_use;
mod neighbourhood;
mod pyramid;
mod scan;
mod synthesis;
mod tsvq;

pub use scan::{ScanParams, extended, filled, scanned, scanned_by_numbers};

use crate::correspondence::{CHANNELS, CanvasRequest, ExemplarPage, find};
use image::{Rgb, RgbImage};
use vtex_base::error::{Error, Result};
use vtex_base::parallel;
use vtex_base::progress::Progress;
use vtex_base::raster::colour::oklab;
use vtex_base::raster::{LabelMap, check_size};

/// Side of the cells of the field, in pixels.
const CELL: usize = 2;
/// Weight of the contrast within a cell relative to one standard deviation of colour.
const GRAIN: f32 = 0.4;

/// Makes a picture of `size` pixels by copying along a correspondence field. It repeats along the axes of
/// `wrap`.
///
/// # Errors
/// A size out of range; [`Error::Interrupted`].
pub fn carried(
    image: &RgbImage,
    size: [usize; 2],
    wrap: [bool; 2],
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    check_size(size)?;
    let page = page(image, 0, None);
    let cells = size.map(|v| v.div_ceil(CELL));
    copied(
        image,
        size,
        &CanvasRequest { pages: &[page], size: cells, wrap, groups: None, active: None, seed },
        progress,
    )
}

/// Makes a picture that follows the labels of `wanted` and has its size; `known` has the labels of the
/// photograph's pixels (texture by numbers, Hertzmann et al. 2001).
///
/// # Errors
/// [`Error::Control`] if `known` has another size than the photograph, or `wanted` has labels that are
/// missing in `known`; as [`carried`].
pub fn by_numbers(
    image: &RgbImage,
    known: &LabelMap,
    wanted: &LabelMap,
    wrap: [bool; 2],
    seed: u64,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    let size = [wanted.width as usize, wanted.height as usize];
    check_size(size)?;
    check_map(image, known)?;
    let cells = [known.width, known.height].map(|v| (v as usize / CELL).max(1));
    let own: Vec<u32> = (0..cells[0] * cells[1]).map(|i| middle(known, cells, i)).collect();
    let canvas = size.map(|v| v.div_ceil(CELL));
    let groups: Vec<u8> = (0..canvas[0] * canvas[1]).map(|i| middle(wanted, canvas, i) as u8).collect();
    let count = groups.iter().copied().max().unwrap_or(0);
    let pages: Vec<ExemplarPage> = (0..=count)
        .filter(|&label| groups.contains(&label))
        .map(|label| page(image, label, Some(own.iter().map(|&l| l == u32::from(label)).collect())))
        .collect();
    // A field needs sources away from the border of the photograph for each label.
    let rim = |i: usize| {
        i % cells[0] < 3 || i % cells[0] + 3 >= cells[0] || i / cells[0] < 3 || i / cells[0] + 3 >= cells[1]
    };
    let short = pages.iter().find(|p| {
        p.inside
            .as_ref()
            .is_some_and(|inside| (0..inside.len()).filter(|&i| inside[i] && !rim(i)).count() < 16)
    });
    if let Some(page) = short {
        return Err(hardly_known(u32::from(page.group)));
    }
    let request =
        CanvasRequest { pages: &pages, size: canvas, wrap, groups: Some(groups), active: None, seed };
    copied(image, size, &request, progress)
}

/// Refuses a label map of another size than the photograph.
fn check_map(image: &RgbImage, known: &LabelMap) -> Result<()> {
    let (found, wanted) = ([known.width, known.height], [image.width(), image.height()]);
    let reason =
        format!("it has {} x {} pixels, the photograph {} x {}", found[0], found[1], wanted[0], wanted[1]);
    let advice = "make the first map of the same size as the photograph";
    if found == wanted { Ok(()) } else { Err(unusable_map(reason, advice)) }
}

/// The error of a label that has too few pixels of the photograph.
fn hardly_known(label: u32) -> Error {
    unusable_map(
        format!("layer {label} of the second is hardly in the first"),
        "use no colours in the second map that the first has not",
    )
}

fn unusable_map(reason: String, advice: &'static str) -> Error {
    Error::Control { name: "the map".into(), role: "a control map", reason, advice }
}

/// The label at the centre of a cell.
fn middle(map: &LabelMap, cells: [usize; 2], i: usize) -> u32 {
    let at = |v: usize, k: usize, size: u32| (((2 * v + 1) * size as usize) / (2 * cells[k])) as u32;
    map.get(
        at(i % cells[0], 0, map.width).min(map.width - 1),
        at(i / cells[0], 1, map.height).min(map.height - 1),
    )
}

/// The features of a photograph for the search: mean colours and the contrast within each cell.
fn page(image: &RgbImage, group: u8, inside: Option<Vec<bool>>) -> ExemplarPage {
    let size = [image.width(), image.height()].map(|v| (v as usize / CELL).max(1));
    let mut features = vec![[0f32; CHANNELS]; size[0] * size[1]];
    parallel::for_chunks(&mut features, size[0], |y, row| {
        for (x, feature) in row.iter_mut().enumerate() {
            let mut all = [[0f32; 3]; CELL * CELL];
            for (k, colour) in all.iter_mut().enumerate() {
                let at = [x * CELL + k % CELL, y * CELL + k / CELL];
                let [u, v] = [at[0].min(image.width() as usize - 1), at[1].min(image.height() as usize - 1)];
                *colour = oklab(image.get_pixel(u as u32, v as u32).0);
            }
            for c in 0..3 {
                feature[c] = all.iter().map(|p| p[c]).sum::<f32>() / all.len() as f32;
            }
            let light = all.iter().map(|p| (p[0] - feature[0]) * (p[0] - feature[0])).sum::<f32>();
            feature[3] = libm::sqrtf(light / all.len() as f32);
        }
    });
    let variance = |c: usize| {
        let n = features.len() as f64;
        let mean = features.iter().map(|f| f64::from(f[c])).sum::<f64>() / n;
        features.iter().map(|f| (f64::from(f[c]) - mean) * (f64::from(f[c]) - mean)).sum::<f64>() / n
    };
    let unit = 1.0 / libm::sqrt((0..3).map(variance).sum::<f64>()).max(1e-3) as f32;
    let grain = GRAIN / libm::sqrt(variance(3)).max(1e-4) as f32;
    features.iter_mut().for_each(|f| (0..CHANNELS).for_each(|c| f[c] *= if c < 3 { unit } else { grain }));
    ExemplarPage { group, groups: None, size, features, inside, periods: None }
}

/// Copies pixels along the field of a request.
fn copied(
    image: &RgbImage,
    size: [usize; 2],
    request: &CanvasRequest<'_>,
    progress: &dyn Progress,
) -> Result<RgbImage> {
    let field = find(request, progress)?;
    let cells = field.size;
    let mut rows = vec![[0u8; 3]; size[0] * size[1]];
    parallel::for_chunks(&mut rows, size[0], |y, row| {
        // Cells are slightly smaller where their size does not divide the canvas.
        let place = |v: usize, k: usize| {
            let at = (v as f64 + 0.5) * cells[k] as f64 / size[k] as f64;
            (at as usize, ((at - libm::floor(at)) * CELL as f64) as u32)
        };
        let (cy, dy) = place(y, 1);
        for (x, out) in row.iter_mut().enumerate() {
            let (cx, dx) = place(x, 0);
            let source = field.sources[cy * cells[0] + cx];
            let at = [u32::from(source.at[0]) * CELL as u32 + dx, u32::from(source.at[1]) * CELL as u32 + dy];
            *out = image.get_pixel(at[0].min(image.width() - 1), at[1].min(image.height() - 1)).0;
        }
    });
    Ok(RgbImage::from_fn(size[0] as u32, size[1] as u32, |x, y| Rgb(rows[y as usize * size[0] + x as usize])))
}

#[cfg(test)]
mod figures;
#[cfg(test)]
mod scan_tests;
#[cfg(test)]
mod tests;
