//! Frames → one animated file: GIF or animated PNG (APNG).
//!
//! Frames are requested and written one by one, so only one is held in memory.

mod palette;

use palette::AnimationPalette;
use std::borrow::Cow;
use std::io::{self, Write};
use tiny_skia::Pixmap;
use vtex_base::Parameter;
use vtex_base::error::{Error, Large, Result, check};
use vtex_base::parallel;

/// Number and rate of the pictures of an animation, which loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterAnimation {
    /// Number of pictures, at least 1.
    pub frames: u32,
    /// Pictures in a second. GIF counts in hundredths of a second, so its pace is rounded.
    pub rate: f64,
}

/// Number of frames sampled for the palette; odd, so that the turning point of an animation that plays there
/// and back is among them.
const LOOKS: u32 = 5;

impl RasterAnimation {
    /// Pictures in a second.
    pub const RATE: Parameter<f64> = Parameter::new("fps", [0.1, 100.0], "").or(15.0);

    fn check(&self) -> Result<()> {
        check(self.frames > 0, "frames", self.frames, "at least 1")?;
        Self::RATE.check(self.rate)
    }

    /// Writes a GIF with one palette of 256 colours for all frames, so that resting parts do not flicker;
    /// intermediate shades are dithered with an ordered pattern. `frame` draws frame k; it is called twice
    /// for a few frames.
    ///
    /// # Errors
    /// Those of `frame`; a parameter out of range; pictures of more than 65535 pixels on a side;
    /// a failing writer.
    pub fn write_gif(&self, mut frame: impl FnMut(u32) -> Result<Pixmap>, out: impl Write) -> io::Result<()> {
        self.check()?;
        let looks = LOOKS.min(self.frames);
        let mut seen = Vec::new();
        for k in 0..looks {
            let at = u64::from(k) * u64::from(self.frames) / u64::from(looks - 1).max(1);
            seen.push(frame((at as u32).min(self.frames - 1))?);
        }
        let palette = AnimationPalette::new(&seen);
        let side = |v: u32| {
            u16::try_from(v).map_err(|_| Error::TooLarge {
                what: Large::Drawn,
                name: "GIF".into(),
                found: format!("{v} pixels on a side"),
                limit: "65535 pixels".into(),
            })
        };
        let (width, height) = (side(seen[0].width())?, side(seen[0].height())?);
        drop(seen);
        let mut encoder = gif::Encoder::new(out, width, height, palette.colours()).map_err(failed_gif)?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(failed_gif)?;
        let comment = gif::AnyExtension(0xfe);
        encoder.write_raw_extension(comment, &[vtex_base::PROGRAM.as_bytes()]).map_err(failed_gif)?;
        for k in 0..self.frames {
            let picture = frame(k)?;
            let row = picture.width() as usize;
            let mut indices = vec![0; row * picture.height() as usize];
            parallel::for_chunks(&mut indices, row, |y, line| palette.index_row(&picture, y, line));
            // Rounded as absolute times, so that rounding errors do not add up.
            let tick = |k: u32| libm::round(f64::from(k) * 100.0 / self.rate);
            let frame = gif::Frame {
                delay: (tick(k + 1) - tick(k)).clamp(1.0, 65535.0) as u16,
                dispose: match palette.transparent() {
                    Some(_) => gif::DisposalMethod::Background,
                    None => gif::DisposalMethod::Keep,
                },
                transparent: palette.transparent(),
                width,
                height,
                buffer: Cow::Owned(indices),
                ..gif::Frame::default()
            };
            encoder.write_frame(&frame).map_err(failed_gif)?;
        }
        encoder.into_inner().and_then(|mut out| Ok(out.flush()?)).map_err(failed_gif)
    }

    /// Writes an animated PNG; programs without support for animation show its first frame. `opaque` says
    /// that all frames are opaque. `frame` draws picture k.
    ///
    /// # Errors
    /// As [`RasterAnimation::write_gif`].
    pub fn write_png(
        &self,
        opaque: bool,
        mut frame: impl FnMut(u32) -> Result<Pixmap>,
        out: impl Write,
    ) -> io::Result<()> {
        self.check()?;
        let first = frame(0)?;
        let mut encoder = png::Encoder::new(out, first.width(), first.height());
        encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let begun = encoder
            .add_text_chunk("Software".into(), vtex_base::PROGRAM.into())
            .and_then(|()| encoder.set_animated(self.frames, 0))
            // Rates are at least 0.1, so the denominator is not 0.
            .and_then(|()| encoder.set_frame_delay(100, libm::round(self.rate * 100.0) as u16))
            .and_then(|()| encoder.write_header());
        let mut writer = begun.map_err(super::png::failed)?;
        let mut next = Some(first);
        for k in 0..self.frames {
            let picture = match next.take() {
                Some(first) => first,
                None => frame(k)?,
            };
            let data = super::png::straight(&picture, if opaque { 3 } else { 4 });
            writer.write_image_data(&data).map_err(super::png::failed)?;
        }
        writer.finish().map_err(super::png::failed)
    }
}

fn failed_gif(e: gif::EncodingError) -> io::Error {
    match e {
        gif::EncodingError::Io(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tiny_skia::{Color, Paint, Rect, Shader, Transform};

    /// A square that goes from left to right over a shaded background.
    fn picture(k: u32) -> Pixmap {
        let mut pixmap = Pixmap::new(40, 30).unwrap();
        for (i, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
            let v = (60 + i % 40 * 3) as u8;
            *pixel = tiny_skia::PremultipliedColorU8::from_rgba(v, v, v / 2, 255).unwrap();
        }
        let paint =
            Paint { shader: Shader::SolidColor(Color::from_rgba8(200, 30, 40, 255)), ..Paint::default() };
        let square = Rect::from_xywh(k as f32 * 8.0, 10.0, 8.0, 8.0).unwrap();
        pixmap.fill_rect(square, &paint, Transform::identity(), None);
        pixmap
    }

    const ANIMATION: RasterAnimation = RasterAnimation { frames: 5, rate: 12.5 };

    #[test]
    fn a_gif_plays_what_was_drawn() {
        let mut bytes = Vec::new();
        ANIMATION.write_gif(|k| Ok(picture(k)), &mut bytes).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let mut count = 0;
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!((frame.delay, frame.width, frame.height), (8, 40, 30));
            let wanted = picture(count);
            let pairs = wanted.data().iter().zip(frame.buffer.iter());
            let far: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            assert!(far < 6 * 40 * 30 * 3, "{far}");
            count += 1;
        }
        assert_eq!(count, 5);
        let mut again = Vec::new();
        ANIMATION.write_gif(|k| Ok(picture(k)), &mut again).unwrap();
        assert!(bytes == again);
    }

    #[test]
    fn all_colours_of_a_film_that_plays_back_are_known() {
        // Red at first, then a step towards blue, blue at the turning point.
        let plain = |k: u32| {
            let mut pixmap = Pixmap::new(8, 8).unwrap();
            let blue = [0, 40, 230, 40][k as usize];
            pixmap.fill(Color::from_rgba8(240 - blue, 20, blue, 255));
            Ok(pixmap)
        };
        for (frames, rate) in [(4, 10.0), (3, 10.0)] {
            let mut bytes = Vec::new();
            RasterAnimation { frames, rate }.write_gif(plain, &mut bytes).unwrap();
            let mut options = gif::DecodeOptions::new();
            options.set_color_output(gif::ColorOutput::RGBA);
            let mut decoder = options.read_info(&bytes[..]).unwrap();
            let mut last = Vec::new();
            for _ in 0..3 {
                last = decoder.read_next_frame().unwrap().unwrap().buffer.to_vec();
            }
            assert!(last[2] > 200 && last[0] < 40, "{:?}", &last[..4]);
        }
        // There and back in twenty pictures: the one in which it turns is the eleventh.
        let turning = |k: u32| plain(if k == 10 { 2 } else { 0 });
        let mut bytes = Vec::new();
        RasterAnimation { frames: 20, rate: 10.0 }.write_gif(turning, &mut bytes).unwrap();
        let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
        let palette = decoder.global_palette().unwrap().to_vec();
        assert!(palette.chunks(3).any(|c| c[2] > 200 && c[0] < 40));
        assert!(decoder.read_next_frame().unwrap().is_some());
    }

    #[test]
    fn a_png_plays_what_was_drawn() {
        for opaque in [true, false] {
            let mut bytes = Vec::new();
            ANIMATION.write_png(opaque, |k| Ok(picture(k)), &mut bytes).unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            assert_eq!(reader.info().animation_control().unwrap().num_frames, 5);
            let mut data = vec![0; reader.output_buffer_size().unwrap()];
            for k in 0..5 {
                reader.next_frame(&mut data).unwrap();
                assert_eq!(data, crate::png::straight(&picture(k), if opaque { 3 } else { 4 }));
            }
        }
    }

    #[test]
    fn a_pace_out_of_range_is_refused() {
        for rate in [0.0, 101.0, f64::NAN] {
            let animation = RasterAnimation { frames: 2, rate };
            let fault = animation.write_gif(|k| Ok(picture(k)), Vec::new()).unwrap_err();
            assert!(matches!(fault.downcast(), Ok(Error::Parameter { name: "fps", .. })));
        }
    }
}
