//! Layer maps → PNG, SVG and JSON; values → PNG of 16 bits.
//!
//! A PNG is indexed: its palette lists the layers from bottom to top. In an SVG each layer is a group
//! with the region of this layer and of all above it, so regions are nested and each covers those below.
//! Borders are traced once and shared.

use crate::png::failed;
use crate::svg::BEGINNING;
use serde::Serialize;
use std::io::{self, Write};
use vtex_base::geometry::{Outline, PathText, write_path};
use vtex_field::layers::LayerMap;

/// Writes a map as an indexed PNG.
///
/// # Errors
/// A failing writer.
pub fn write_png(map: &LayerMap, seed: Option<u64>, out: impl Write) -> io::Result<()> {
    let palette: Vec<u8> = map.layers.iter().flat_map(|l| l.colour.0).collect();
    let data: Vec<u8> = map.labels.labels.iter().map(|&l| l as u8).collect();
    encode([map.labels.width, map.labels.height], png::ColorType::Indexed, Some(palette), &data, seed, out)
}

/// Writes 16-bit grey values, row by row, as a PNG.
///
/// # Errors
/// As [`write_png`].
pub fn write_grey(size: [usize; 2], values: &[u16], seed: Option<u64>, out: impl Write) -> io::Result<()> {
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    encode(size.map(|v| v as u32), png::ColorType::Grayscale, None, &data, seed, out)
}

fn encode(
    size: [u32; 2],
    colour: png::ColorType,
    palette: Option<Vec<u8>>,
    data: &[u8],
    seed: Option<u64>,
    out: impl Write,
) -> io::Result<()> {
    let write = || {
        let mut encoder = png::Encoder::new(out, size[0], size[1]);
        encoder.set_color(colour);
        encoder.set_depth(if palette.is_some() { png::BitDepth::Eight } else { png::BitDepth::Sixteen });
        if let Some(palette) = palette {
            encoder.set_palette(palette);
        }
        encoder.add_text_chunk("Software".into(), vtex_base::PROGRAM.into())?;
        if let Some(seed) = seed {
            encoder.add_text_chunk("Seed".into(), seed.to_string())?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(data)?;
        writer.finish()
    };
    write().map_err(failed)
}

/// Writes a map as an SVG: a group for each layer, from bottom to top, named by the layer.
///
/// # Errors
/// As [`write_png`].
pub fn write_svg(map: &LayerMap, wrap: [bool; 2], mut out: impl Write) -> io::Result<()> {
    let [w, h] = map.size();
    let mut text = format!(
        "{BEGINNING}{} -->\n<svg xmlns=\"http://www.w3.org/2000/svg\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"{w}\" height=\"{h}\" \
         viewBox=\"0 0 {w} {h}\">\n<title>Layers</title>\n",
        env!("CARGO_PKG_VERSION")
    );
    let paths = map.outlines(wrap);
    for (k, layer) in map.layers.iter().enumerate() {
        let path = match k.checked_sub(1) {
            None => format!("M0 0H{w}V{h}H0z"),
            Some(above) => write_path(paths[above].path(), PathText { precision: 2 }),
        };
        text.push_str(&format!(
            "<g id=\"layer-{k}\" inkscape:groupmode=\"layer\" inkscape:label=\"{}\"><path fill=\"{}\" d=\"{path}\"/></g>\n",
            layer.name, layer.colour
        ));
    }
    text.push_str("</svg>\n");
    out.write_all(text.as_bytes())
}

/// A map as JSON.
#[derive(Serialize)]
struct Described<'a> {
    format: &'static str,
    version: u32,
    program: &'static str,
    seed: Option<u64>,
    /// Size in pixels.
    width: usize,
    height: usize,
    /// Axes along which it repeats.
    tile: RepeatingAxes,
    /// Share of the borders that lie between layers that are not next to each other.
    distant_contact: f64,
    /// From bottom to top.
    layers: Vec<DescribedLayer<'a>>,
}

#[derive(Serialize)]
struct RepeatingAxes {
    x: bool,
    y: bool,
}

#[derive(Serialize)]
struct DescribedLayer<'a> {
    name: &'a str,
    colour: vtex_base::raster::colour::Colour,
    /// Share of the pixels.
    share: f64,
    /// Outline of the region of this layer and those above it; `None` for the bottom layer, whose region is
    /// the whole map.
    region: Option<&'a Outline>,
}

/// Writes a map as JSON: its layers with names, colours, shares of the area, and the outlines of the
/// nested regions as SVG path data.
///
/// # Errors
/// As [`write_png`].
pub fn write_json(map: &LayerMap, wrap: [bool; 2], seed: Option<u64>, mut out: impl Write) -> io::Result<()> {
    let paths = map.outlines(wrap);
    let shares = map.shares();
    let layer = |(k, layer): (usize, &'_ vtex_field::layers::MapLayer)| (k, layer.name.clone(), layer.colour);
    let named: Vec<_> = map.layers.iter().enumerate().map(layer).collect();
    let layers = named.iter().map(|(k, name, colour)| DescribedLayer {
        name,
        colour: *colour,
        share: shares[*k],
        region: k.checked_sub(1).map(|above| &paths[above]),
    });
    let [width, height] = map.size();
    let described = Described {
        format: "vtex-layers",
        version: 1,
        program: vtex_base::PROGRAM,
        seed,
        width,
        height,
        tile: RepeatingAxes { x: wrap[0], y: wrap[1] },
        distant_contact: vtex_field::layers::Contacts::new(&map.labels, map.layers.len(), wrap).distant(),
        layers: layers.collect(),
    };
    let mut bytes = serde_json::to_vec(&described).expect("maps hold nothing that JSON cannot");
    bytes.push(b'\n');
    out.write_all(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster_svg::render_svg;
    use vtex_base::raster::Limits;
    use vtex_base::raster::colour::Colour;
    use vtex_field::layers::{LayerPicture, MOST_LAYERS};
    use vtex_testing::{SceneKind, SceneParams, generate};

    /// A map of rings and blobs.
    fn map(size: [usize; 2], count: u32) -> LayerMap {
        let at = |i: usize| {
            let [x, y] = [(i % size[0]) as f64, (i / size[0]) as f64];
            let v = libm::sin(x / 17.0) + libm::sin(y / 23.0 + x / 40.0) + libm::cos((x - y) / 31.0);
            (((v + 3.0) / 6.0 * f64::from(count)) as u32).min(count - 1)
        };
        let labels = vtex_base::raster::LabelMap {
            width: size[0] as u32,
            height: size[1] as u32,
            labels: (0..size[0] * size[1]).map(at).collect(),
        };
        let layer = |k: u32| vtex_field::layers::MapLayer {
            name: format!("layer {k}"),
            colour: Colour([40 * k as u8, 100, 200 - 30 * k as u8]),
        };
        LayerMap { labels, layers: (0..count).map(layer).collect() }
    }

    #[test]
    fn an_indexed_png_comes_back() {
        let map = map([120, 90], 4);
        let mut bytes = Vec::new();
        write_png(&map, Some(3), &mut bytes).unwrap();
        let read = LayerPicture::from_bytes(&bytes, "map.png", &Limits::default()).unwrap().layers().unwrap();
        assert_eq!(read.labels, map.labels);
        let colours = |m: &LayerMap| m.layers.iter().map(|l| l.colour).collect::<Vec<_>>();
        assert_eq!(colours(&read), colours(&map));
    }

    #[test]
    fn an_svg_shows_the_map() {
        for (count, wrap) in [(2, [false; 2]), (4, [true; 2]), (MOST_LAYERS as u32, [true, false])] {
            let map = map([200, 160], count);
            let mut bytes = Vec::new();
            write_svg(&map, wrap, &mut bytes).unwrap();
            let drawn = render_svg(&bytes, 1.0, "map", &()).unwrap();
            let same = drawn.pixels().iter().zip(&map.labels.labels).filter(|(p, l)| {
                let wanted = map.layers[**l as usize].colour.0;
                let got = [p.red(), p.green(), p.blue()];
                (0..3).all(|c| wanted[c].abs_diff(got[c]) <= 20)
            });
            let share = same.count() as f64 / map.labels.labels.len() as f64;
            assert!(share >= 0.9, "{count} layers: {share}");
            // Pixels that a border crosses are mixed; none of the others may differ.
            let inner = |i: usize| {
                let [x, y] = [i % 200, i / 200];
                (1..199).contains(&x)
                    && (1..159).contains(&y)
                    && [i - 1, i + 1, i - 200, i + 200]
                        .iter()
                        .all(|&j| map.labels.labels[j] == map.labels.labels[i])
            };
            let wrong = (0..200 * 160).filter(|&i| inner(i)).filter(|&i| {
                let p = drawn.pixels()[i];
                let got = [p.red(), p.green(), p.blue()];
                let near = |l: &vtex_field::layers::MapLayer| {
                    (0..3).map(|c| u32::from(l.colour.0[c].abs_diff(got[c]))).sum::<u32>()
                };
                (0..map.layers.len()).min_by_key(|&k| near(&map.layers[k]))
                    != Some(map.labels.labels[i] as usize)
            });
            let wrong = wrong.count() as f64 / (200.0 * 160.0);
            assert!(wrong < 0.01, "{count} layers: {wrong}");
        }
    }

    #[test]
    fn regions_are_nested_and_named() {
        let map = map([100, 80], 3);
        let mut bytes = Vec::new();
        write_json(&map, [false; 2], Some(1), &mut bytes).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        assert_eq!(json["format"], "vtex-layers");
        let layers = json["layers"].as_array().unwrap();
        assert_eq!(layers.len(), 3);
        assert!(layers[0]["region"].is_null() && layers[1]["region"].is_string());
        let sum: f64 = layers.iter().map(|l| l["share"].as_f64().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-9);
        let areas: Vec<f64> = map.outlines([false; 2]).iter().map(Outline::area).collect();
        let shares = map.shares();
        assert!((areas[0] / 8000.0 - shares[1] - shares[2]).abs() < 0.01);
        assert!((areas[1] / 8000.0 - shares[2]).abs() < 0.01);
    }

    #[test]
    fn sixteen_bits_come_back() {
        let values: Vec<u16> = (0..40 * 32).map(|i| (i * 51) as u16).collect();
        let mut bytes = Vec::new();
        write_grey([40, 32], &values, None, &mut bytes).unwrap();
        let read = vtex_field::layers::Terrain::from_bytes(&bytes, "x", &Limits::default()).unwrap();
        assert_eq!(read.to_16_bits(), values);
    }

    #[test]
    fn photographs_are_no_maps() {
        let params =
            SceneParams { width: 96, height: 96, kind: SceneKind::Pebbles, size: 20.0, ..Default::default() };
        let mut bytes = std::io::Cursor::new(Vec::new());
        generate(&params).unwrap().image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let picture = LayerPicture::from_bytes(&bytes.into_inner(), "photo", &Limits::default()).unwrap();
        assert!(!picture.is_flat() && picture.layers().is_err());
    }
}
