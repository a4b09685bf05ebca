//! Label PNGs: each grey value or palette index except 0 is a mask.

use super::{LABEL_PNG, MasksDocument};
use std::io::Cursor;
use vtex_base::error::{Error, Result};
use vtex_base::raster::LabelMap;

/// Decodes labels; `check` is asked about the size first.
pub(super) fn read_png(
    bytes: &[u8],
    name: &str,
    check: impl Fn([u32; 2]) -> Result<[u32; 2]>,
) -> Result<LabelMap> {
    let fail = |reason: String| Error::Format { name: name.into(), format: LABEL_PNG, reason };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(|e| fail(e.to_string()))?;
    let (info, bits) = (reader.info(), reader.info().bit_depth as usize);
    check([info.width, info.height])?;
    if !matches!(info.color_type, png::ColorType::Grayscale | png::ColorType::Indexed) {
        return Err(fail("it contains colours; labels must be grey values or palette indices".into()));
    }
    let length = reader.output_buffer_size().ok_or_else(|| fail("its size overflows".into()))?;
    let mut data = vec![0; length];
    let frame = reader.next_frame(&mut data).map_err(|e| fail(e.to_string()))?;
    let (width, height) = (frame.width as usize, frame.height as usize);
    let mut labels = Vec::with_capacity(width * height);
    for row in data.chunks_exact(frame.line_size).take(height) {
        for x in 0..width {
            labels.push(match bits {
                16 => u32::from(u16::from_be_bytes([row[2 * x], row[2 * x + 1]])),
                8 => u32::from(row[x]),
                _ => {
                    let at = x * bits;
                    u32::from(row[at / 8] >> (8 - bits - at % 8)) & ((1 << bits) - 1)
                }
            });
        }
    }
    if labels.len() != width * height {
        return Err(fail("it contains fewer rows than it says".into()));
    }
    Ok(LabelMap { width: frame.width, height: frame.height, labels })
}

/// Encodes labels; smaller masks are painted over larger ones.
pub(super) fn write_png(document: &MasksDocument) -> std::result::Result<Vec<u8>, String> {
    let count = document.masks.len();
    if count > usize::from(u16::MAX) {
        return Err(format!("{count} masks are more than a PNG can tell apart; write .json"));
    }
    let width = document.width as usize;
    let mut labels = vec![0u16; width * document.height as usize];
    for i in document.smaller_last() {
        for &[y, x0, x1] in &document.masks[i].runs {
            let row = y as usize * width;
            labels[row + x0 as usize..row + x1 as usize].fill(i as u16 + 1);
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, document.width, document.height);
    encoder.set_color(png::ColorType::Grayscale);
    let wide = count > usize::from(u8::MAX);
    encoder.set_depth(if wide { png::BitDepth::Sixteen } else { png::BitDepth::Eight });
    let data: Vec<u8> = if wide {
        labels.iter().flat_map(|l| l.to_be_bytes()).collect()
    } else {
        labels.iter().map(|&l| l as u8).collect()
    };
    // Marks the file as written by vtex; editors do not keep this chunk.
    encoder.add_text_chunk("Software".into(), vtex_base::PROGRAM.into()).map_err(|e| e.to_string())?;
    let write = |encoder: png::Encoder<'_, _>| {
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&data)?;
        writer.finish()
    };
    write(encoder).map_err(|e: png::EncodingError| e.to_string())?;
    Ok(bytes)
}
