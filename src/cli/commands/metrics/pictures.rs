//! Comparison of two pictures; SVGs and scenes are drawn.

use super::content::FileContent;
use super::show::{digits, print_found};
use crate::cli::common::Common;
use crate::cli::foreign::escaped;
use crate::cli::progress::Reporter;
use crate::cli::table::table;
use image::RgbImage;
use serde::Serialize;
use vtex::Progress;
use vtex::analyze::{Exemplar, Limits};
use vtex::metrics::{self, Metrics};
use vtex::output::{png, raster_svg};

/// The report in JSON.
#[derive(Serialize)]
struct PictureReport {
    program: &'static str,
    command: &'static str,
    exemplar: String,
    result: String,
    /// How many times as large the result shows the texture.
    scale: f64,
    #[serde(flatten)]
    metrics: Metrics,
    /// Seconds to read, draw and compare.
    seconds: f64,
    warnings: Vec<String>,
}

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    [exemplar, result]: [String; 2],
    first: &FileContent,
    second: &FileContent,
    scale: f64,
) -> anyhow::Result<()> {
    reporter.stage("drawing")?;
    let (picture, other) = (draw(first, 1.0, &exemplar, reporter)?, draw(second, 1.0, &result, reporter)?);
    let is_drawn = !matches!(second, FileContent::Image(_)) && scale == 1.0;
    let contours = if is_drawn && metrics::can_compare_contours(&picture, other.dimensions().into()) {
        let enlarged = draw(second, metrics::ENLARGED.into(), &result, reporter)?;
        Some(metrics::contours(&picture, &enlarged, reporter)?)
    } else {
        None
    };
    let other = metrics::scaled(other, scale)?;
    let pictures = metrics::reduced([picture, other], reporter);
    let metrics = Metrics { contours, ..metrics::compare(&pictures[0], &pictures[1], reporter)? };
    let (seconds, warnings) = reporter.finish();
    let seconds = seconds.iter().map(|s| s.1.as_secs_f64()).sum::<f64>();
    let seconds = (seconds * 1e3).round() / 1e3;
    let command = "metrics";
    let found = PictureReport {
        program: vtex::PROGRAM,
        command,
        exemplar,
        result,
        scale,
        metrics,
        seconds,
        warnings,
    };
    print_found(common, &found, || found.show())
}

/// A picture of a file's content, over white. What is drawn has `scale` pixels per pixel of the canvas along each
/// axis; a picture has its own.
fn draw(content: &FileContent, scale: f64, name: &str, reporter: &Reporter) -> anyhow::Result<RgbImage> {
    let pixmap = match content {
        FileContent::Image(bytes) => {
            let decoded = Exemplar::from_bytes(bytes, name, &Limits::default())?;
            decoded.warnings.iter().for_each(|w| reporter.warn(&w.replace("the photograph", name)));
            return Ok(decoded.image);
        }
        // Up to three drawings are made of two files.
        FileContent::Svg(bytes) => raster_svg::render_part_of(bytes, scale, (name, 1.0 / 3.0), reporter)?,
        FileContent::Scene(scene) => png::render(scene, scale)?,
        FileContent::Library(library) => png::render(&vtex::synth::reconstruct(library), scale)?,
    };
    Ok(png::over_white(&pixmap))
}

impl PictureReport {
    fn show(&self) -> String {
        let m = &self.metrics;
        let size = |[w, h]: [u32; 2]| format!("{w} x {h} px");
        let scale =
            if self.scale == 1.0 { String::new() } else { format!(", made 1/{} as large", self.scale) };
        let mut text = format!(
            "{} ({}) and {} ({}{scale})\n\n",
            escaped(&self.exemplar),
            size(m.exemplar_size),
            escaped(&self.result),
            size(m.result_size)
        );
        let distance = |name: &str, value: Option<f64>, meaning: &str| {
            vec![name.into(), value.map_or("-".into(), digits), meaning.into()]
        };
        text += &table(&[
            ["distance", "", "0 is the same, more is further away"].map(str::to_owned).to_vec(),
            distance("emd_rgb", Some(m.emd_rgb), "colours: histograms of red, green, blue, 0 to 255"),
            distance("emd_lab", Some(m.emd_lab), "colours: histogram in CIE Lab, delta E"),
            distance("psd_radial", Some(m.psd_radial), "spectrum, log power by frequency"),
            distance("psd_2d", Some(m.psd_2d), "spectrum, log power by frequency and direction"),
            distance("lbp", Some(m.lbp), "grain: local binary patterns, 0 to 1"),
            distance("swd", Some(m.swd), "small patches: sliced Wasserstein, in the exemplar's deviations"),
            distance(
                "fb_frechet",
                Some(m.fb_frechet),
                "filter responses: Frechet, in the exemplar's deviations",
            ),
            distance("coherence", m.coherence, "result's patches in the exemplar; 1 is as good as its own"),
            distance("completeness", m.completeness, "exemplar's patches in the result; likewise"),
        ]);
        text.push('\n');
        let likeness = |name: &str, value: Option<f64>, meaning: &str| distance(name, value, meaning);
        text += &table(&[
            ["likeness", "", "1 is the same; low for all that does not lie pixel on pixel"]
                .map(str::to_owned)
                .to_vec(),
            likeness("ssim", Some(m.ssim), "structural similarity of the middles"),
            likeness("ms_ssim", m.ms_ssim, "the same at five scales"),
        ]);
        text.push('\n');
        let pair =
            |name: &str, a: f64, b: f64, meaning: String| vec![name.into(), digits(a), digits(b), meaning];
        let ratio = digits(m.lapvar_logratio);
        let mut rows = vec![["of each", "exemplar", "result", ""].map(str::to_owned).to_vec()];
        rows.extend(m.structure.iter().map(|s| {
            let ratio = s.ratio.map_or("-".into(), digits);
            let meaning = format!("spread of means of blocks; ratio {ratio}, below 1 is too even");
            pair(&format!("spread {} px", s.block), s.exemplar, s.result, meaning)
        }));
        rows.extend([
            pair(
                "lapvar",
                m.lapvar_exemplar,
                m.lapvar_result,
                format!("sharpness; log ratio {ratio}, below 0 is more blurred"),
            ),
            pair("acf_peak", m.acf_peak_exemplar, m.acf_peak_result, "repetition, at most 1".into()),
        ]);
        text += &table(&rows);
        if let Some(c) = &m.contours {
            text.push('\n');
            let row =
                |name: &str, a: String, b: String, meaning: &str| vec![name.into(), a, b, meaning.into()];
            let share = |v: f64| digits(1000.0 * v);
            text += &table(&[
                ["contours, enlarged", "exemplar", "result", ""].map(str::to_owned).to_vec(),
                row("contours", String::new(), share(c.share), "parts of 1000 of the picture"),
                row("spurious", String::new(), share(c.spurious), "those of them that the exemplar lacks"),
                row(
                    "width",
                    digits(c.width_exemplar),
                    digits(c.width_result),
                    "px from 10 to 90 % of a border",
                ),
            ]);
        }
        text
    }
}
