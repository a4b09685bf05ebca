//! Accuracy and size of SVG backgrounds: the construction that vtex writes is compared with three
//! others, as a table in Markdown for given libraries.
//!
//! ```text
//! cargo run --release --example background_study -- [--side N] [--files DIR] [--kept] LIBRARY...
//! ```
//!
//! Errors are differences, in 8-bit steps, between pixels drawn by resvg and the field at their centres:
//! at 1x for all pixels, at 4x for every ninth. `--files` keeps the SVGs and their pictures at 1x;
//! `--kept` measures only vtex's construction. Canvases above 2000 pixels are drawn only at 1x.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;
use tiny_skia::Pixmap;
use vtex::library::Library;
use vtex::output::raster_svg::render_svg;
use vtex::output::svg::{self, SvgOptions};
use vtex::scene::field::Interpolant;
use vtex::scene::{Scene, SynthParams};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;
/// Writes the background as SVG.
type Construction<'a> = dyn Fn() -> Outcome<Vec<u8>> + 'a;

fn main() -> Outcome {
    let (mut side, mut files, mut kept) = (1000, None, false);
    println!(
        "| library | construction | kB | gzip kB | elements | write s | resvg s | mean 1x | largest 1x | > 4, ppm | mean 4x | largest 4x |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match &argument[..] {
            "--side" => side = arguments.next().ok_or("--side needs a number")?.parse()?,
            "--files" => files = Some(PathBuf::from(arguments.next().ok_or("--files needs a folder")?)),
            "--kept" => kept = true,
            path => study(Path::new(path), side, files.as_deref(), kept)?,
        }
    }
    Ok(())
}

/// The rows of one library.
fn study(path: &Path, side: u32, files: Option<&Path>, kept: bool) -> Outcome {
    let library = Library::read(path)?;
    let params = SynthParams { width: side, height: side, ..SynthParams::default() };
    let mut scene = vtex::synth::synthesize(&library, &params, &())?;
    scene.elements.clear();
    scene.layers.iter_mut().for_each(|layer| layer.instances.clear());
    let field = scene.layers.iter().find_map(|layer| layer.field.as_ref()).ok_or("no field")?;
    let field = Interpolant::new(field, side, side, scene.tile);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.split('.').next().unwrap_or_default();
    let constructions: [(&str, &Construction<'_>); 4] = [
        ("kept", &|| written(&scene)),
        ("grid", &|| Ok(even_grid(&field, side))),
        ("blur", &|| Ok(blurred_cells(&field, side))),
        ("iso", &|| Ok(iso_bands(&field, side))),
    ];
    for (construction, write) in &constructions[..if kept { 1 } else { 4 }] {
        let start = Instant::now();
        let bytes = write()?;
        let writing = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let picture = render_svg(&bytes, 1.0, construction, &())?;
        let drawing = start.elapsed().as_secs_f64();
        let one = Distance::of(&field, &picture, 1.0, if side > 2000 { 7 } else { 1 });
        let four = if side > 2000 {
            String::from("– | –")
        } else {
            let four = Distance::of(&field, &render_svg(&bytes, 4.0, construction, &())?, 4.0, 3);
            format!("{:.2} | {:.1}", four.mean, four.largest)
        };
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(&bytes)?;
        println!(
            "| {name} | {construction} | {:.0} | {:.0} | {} | {writing:.2} | {drawing:.2} | {:.2} | {:.1} | {:.0} | {four} |",
            bytes.len() as f64 / 1e3,
            packed.finish()?.len() as f64 / 1e3,
            bytes.windows(2).filter(|w| w[0] == b'<' && w[1].is_ascii_alphabetic()).count(),
            one.mean,
            one.largest,
            one.far * 1e6,
        );
        if let Some(folder) = files {
            let file = folder.join(format!("{name}_{construction}_{side}.svg"));
            std::fs::write(&file, &bytes)?;
            picture.save_png(file.with_extension("png"))?;
        }
    }
    Ok(())
}

/// The construction that vtex writes.
fn written(scene: &Scene) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    svg::write(scene, &SvgOptions::default(), &mut bytes)?;
    Ok(bytes)
}

/// Differences between a picture and the field.
struct Distance {
    mean: f64,
    largest: f64,
    /// Share of pixels that differ by more than 4.
    far: f64,
}

impl Distance {
    fn of(field: &Interpolant, picture: &Pixmap, scale: f64, step: usize) -> Self {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
        let wanted = field.grid(0.5 / scale, 0.5 / scale, step as f64 / scale, columns, rows);
        let (mut sum, mut largest, mut far) = (0.0, 0.0f64, 0.0);
        for (k, wanted) in wanted.iter().enumerate() {
            let p = picture.pixels()[k / columns * step * width + k % columns * step];
            let found = [p.red(), p.green(), p.blue()];
            let off = [0, 1, 2].map(|c| (f64::from(wanted[c]) - f64::from(found[c])).abs());
            let most = off.iter().fold(0.0, |a: f64, b| a.max(*b));
            sum += off.iter().sum::<f64>() / 3.0;
            largest = largest.max(most);
            far += f64::from(u8::from(most > 4.0));
        }
        let count = wanted.len() as f64;
        Self { mean: sum / count, largest, far: far / count }
    }
}

fn begin(side: u32) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{side}\" height=\"{side}\" viewBox=\"0 0 {side} {side}\">\n"
    )
}

fn hex(colour: [f32; 3]) -> String {
    let [r, g, b] = colour.map(|v| (v + 0.5) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A bilinear grid of equal cells of 8 pixels: rows of gradients under one mask, as vtex writes them,
/// but with all stops.
fn even_grid(field: &Interpolant, side: u32) -> Vec<u8> {
    const CELL: u32 = 8;
    let count = side.div_ceil(CELL);
    let full = count * CELL;
    let grid = field.grid(0.0, 0.0, f64::from(CELL), count as usize + 1, count as usize + 1);
    let mut out = begin(side) + "<defs>\n";
    for (k, row) in grid.chunks_exact(count as usize + 1).enumerate() {
        let _ = write!(out, "<linearGradient id=\"b{k}\">");
        for (i, colour) in row.iter().enumerate() {
            let offset = format!("{:.4}", i as f64 / f64::from(count));
            let offset = offset.trim_start_matches('0').trim_end_matches('0').trim_end_matches('.');
            let offset = if offset.is_empty() { "0" } else { offset };
            let _ = write!(out, "<stop offset=\"{offset}\" stop-color=\"{}\"/>", hex(*colour));
        }
        out += "</linearGradient>\n";
    }
    out += "<linearGradient id=\"t\" x2=\"0\" y2=\"1\"><stop offset=\"0\" stop-color=\"#000\"/>\
            <stop offset=\".5\" stop-color=\"#fff\"/><stop offset=\"1\" stop-color=\"#000\"/></linearGradient>\n\
            <mask id=\"m\" color-interpolation=\"sRGB\">";
    let band = |k: u32| (k.saturating_sub(1) * CELL, (k + 1) * CELL + 1);
    for k in (1..=count).step_by(2) {
        let y = (k - 1) * CELL;
        let _ = write!(out, "<rect y=\"{y}\" width=\"{full}\" height=\"{}\" fill=\"url(#t)\"/>", 2 * CELL);
    }
    out += "</mask>\n</defs>\n";
    for parity in 0..2 {
        out += if parity == 0 { "<g>" } else { "<g mask=\"url(#m)\">" };
        for k in (parity..=count).step_by(2) {
            let (top, bottom) = band(k);
            let height = bottom - top;
            let _ =
                writeln!(out, "<rect y=\"{top}\" width=\"{full}\" height=\"{height}\" fill=\"url(#b{k})\"/>");
        }
        out += "</g>\n";
    }
    (out + "</svg>\n").into_bytes()
}

/// Cells of 8 pixels with one colour each, smoothed by a filter.
fn blurred_cells(field: &Interpolant, side: u32) -> Vec<u8> {
    const CELL: i64 = 8;
    /// Cells beyond each border, for the filter.
    const MORE: i64 = 3;
    let count = i64::from(side.div_ceil(CELL as u32)) + 2 * MORE;
    let first = -MORE * CELL;
    let at = first as f64 + CELL as f64 / 2.0;
    let colours = field.grid(at, at, CELL as f64, count as usize, count as usize);
    let mut out = begin(side);
    let _ = writeln!(
        out,
        "<filter id=\"f\" filterUnits=\"userSpaceOnUse\" x=\"{first}\" y=\"{first}\" width=\"{0}\" height=\"{0}\" \
         color-interpolation-filters=\"sRGB\"><feGaussianBlur stdDeviation=\"{1}\"/></filter>\n\
         <g filter=\"url(#f)\" shape-rendering=\"crispEdges\">",
        count * CELL,
        CELL as f64 * 0.45,
    );
    for (k, colour) in colours.iter().enumerate() {
        let (x, y) = (first + k as i64 % count * CELL, first + k as i64 / count * CELL);
        let _ = writeln!(out, "<path fill=\"{}\" d=\"M{x} {y}h8v8h-8\"/>", hex(*colour));
    }
    (out + "</g>\n</svg>\n").into_bytes()
}

/// Stacked level sets for each component, three steps apart; the components are added.
fn iso_bands(field: &Interpolant, side: u32) -> Vec<u8> {
    const STEP: u8 = 3;
    const CELL: f64 = 5.0;
    // One more point on each side, below every level, closes all rings.
    let count = (f64::from(side) / CELL) as usize + 3;
    let inner = field.grid(0.0, 0.0, CELL, count - 2, count - 2);
    let mut out = begin(side) + "<g style=\"isolation:isolate\">\n<path d=\"M0 0h9999v9999H0z\"/>\n";
    for c in 0..3 {
        out += "<g style=\"mix-blend-mode:screen\">\n";
        let values: Vec<f64> = (0..count * count)
            .map(|k| {
                let (i, j) = (k % count, k / count);
                let inside = |v: usize| (1..count - 1).contains(&v);
                if inside(i) && inside(j) { f64::from(inner[(j - 1) * (count - 2) + i - 1][c]) } else { -1e5 }
            })
            .collect();
        for level in (0..=255u8).step_by(usize::from(STEP)) {
            let path = level_set(&values, count, CELL, (f64::from(level) - f64::from(STEP) / 2.0).max(-1.0));
            if path.is_empty() {
                break;
            }
            let mut colour = [0.0; 3];
            colour[c] = f32::from(level);
            let _ = writeln!(out, "<path fill=\"{}\" d=\"{path}\"/>", hex(colour));
        }
        out += "</g>\n";
    }
    (out + "</g>\n</svg>\n").into_bytes()
}

/// The area in which a grid of values exceeds a level, as path data (marching squares).
fn level_set(values: &[f64], count: usize, cell: f64, level: f64) -> String {
    // The boundary enters each edge of the grid that it leaves another one by.
    let mut next: BTreeMap<(usize, bool), (usize, bool)> = BTreeMap::new();
    for k in 0..count * (count - 1) {
        if k % count == count - 1 {
            continue;
        }
        let corners = [k, k + 1, k + count + 1, k + count];
        let edges = [(k, false), (k + 1, true), (k + count, false), (k, true)];
        let above = corners.map(|i| values[i] >= level);
        for entry in 0..4 {
            // It enters where the next corner is above the level, and leaves at the next edge where that ends.
            if above[entry] || !above[(entry + 1) % 4] {
                continue;
            }
            let exit = (1..4).map(|n| (entry + n) % 4).find(|e| above[*e] && !above[(e + 1) % 4]);
            if let Some(exit) = exit {
                next.insert(edges[exit], edges[entry]);
            }
        }
    }
    let place = |(k, down): (usize, bool)| {
        let (a, b) = (values[k], values[if down { k + count } else { k + 1 }]);
        let t = ((level - a) / (b - a)).clamp(0.0, 1.0);
        let (x, y) = ((k % count) as f64 - 1.0, (k / count) as f64 - 1.0);
        if down { (x * cell, (y + t) * cell) } else { ((x + t) * cell, y * cell) }
    };
    let mut path = String::new();
    while let Some((start, mut edge)) = next.pop_first() {
        let (x, y) = place(start);
        let _ = write!(path, "M{x:.1} {y:.1}");
        let mut before = ((x * 10.0).round(), (y * 10.0).round());
        path.push('l');
        loop {
            let (x, y) = place(edge);
            let now = ((x * 10.0).round(), (y * 10.0).round());
            let _ = write!(path, "{} {} ", (now.0 - before.0) / 10.0, (now.1 - before.1) / 10.0);
            before = now;
            match next.remove(&edge) {
                Some(following) => edge = following,
                None => break,
            }
        }
        path.push('z');
    }
    path
}
