//! Printing of libraries and scenes.

use super::svg;
use crate::cli::common::Common;
use crate::cli::failure::label;
use crate::cli::foreign::escaped;
use crate::cli::input::{Input, InputKind};
use crate::cli::output;
use crate::cli::summary::{
    ElementCounts, MotifCount, PhotographPreparation, bytes as show_bytes, lattice_measures, lattice_text,
};
use anstyle::{AnsiColor, RgbColor, Style};
use serde::Serialize;
use vtex::library::{AnalyzeParams, Lattice, Library};
use vtex::raster::colour::Colour;
use vtex::scene::{CategoryId, EditRecord, Field, Length, Role, Scene, SynthParams, Tile};

/// The report on a file.
#[derive(Debug, Serialize)]
struct Inspection {
    command: &'static str,
    file: String,
    format: String,
    version: u32,
    program: String,
    /// Size of the file as stored, packed or not.
    bytes: u64,
    /// Size of the exemplar or canvas, in pixels.
    size: [u32; 2],
    /// Width and height of a scene's page.
    #[serde(skip_serializing_if = "Option::is_none")]
    page: Option<[Length; 2]>,
    exemplars: Vec<ExemplarFile>,
    #[serde(skip_serializing_if = "Option::is_none")]
    segmenter: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tile: Option<Tile>,
    /// What was done to a photograph before it was analysed.
    #[serde(flatten)]
    prepared: PhotographPreparation,
    /// Rows or lattice of an exemplar.
    #[serde(skip_serializing_if = "Option::is_none")]
    lattice: Option<Lattice>,
    /// The motifs of a drawing, by their number of elements.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    motifs: Vec<MotifCount>,
    /// The layers, in painting order.
    layers: Vec<LayerLine>,
    counts: ElementCounts,
    /// Share of the picture that primaries cover, 0 to 1.
    coverage: f64,
    /// Areas of the elements, in pixels.
    areas: AreaQuantiles,
    /// Typical distances, in pixels.
    spacing: Spacing,
    categories: Vec<CategoryLine>,
    #[serde(skip_serializing_if = "Option::is_none")]
    analyze: Option<AnalyzeParams>,
    #[serde(skip_serializing_if = "Option::is_none")]
    synth: Option<SynthParams>,
    /// Operations applied to a scene, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    edits: Vec<EditRecord>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct ExemplarFile {
    file: String,
    sha256: String,
}

#[derive(Debug, Serialize)]
struct LayerLine {
    name: String,
    role: Role,
    elements: usize,
    /// Control points of its colour field, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<usize>,
    /// Whether it fills only a region.
    region: bool,
}

#[derive(Debug, Serialize)]
struct AreaQuantiles {
    #[serde(skip_serializing_if = "Option::is_none")]
    primaries: Option<Quantiles>,
    #[serde(skip_serializing_if = "Option::is_none")]
    secondaries: Option<Quantiles>,
}

#[derive(Debug, Serialize)]
struct Spacing {
    #[serde(skip_serializing_if = "Option::is_none")]
    secondaries: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    background: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Quantiles {
    smallest: f64,
    tenth: f64,
    median: f64,
    ninetieth: f64,
    largest: f64,
}

#[derive(Debug, Serialize)]
struct CategoryLine {
    /// Number of its library, from 1, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    library: Option<u64>,
    /// Its number, from 1.
    category: u32,
    name: String,
    colour: Colour,
    primaries: usize,
    /// Number of elements that the border does not cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    whole: Option<usize>,
    mean_area: f64,
    coverage: f64,
}

pub(super) fn run(common: &Common, input: &Input) -> anyhow::Result<()> {
    let bytes = input.read()?;
    let (name, size) = (input.name(), bytes.len() as u64);
    let inspection =
        match InputKind::expect(&bytes, input, &[InputKind::Library, InputKind::Scene, InputKind::Svg])? {
            InputKind::Svg => return svg::run(common, &name, &bytes),
            InputKind::Library => of_library(&Library::from_bytes(bytes, &name)?, name, size),
            _ => of_scene(&Scene::from_bytes(bytes, &name)?, name, size),
        };
    if common.json {
        return output::print_json(&inspection, false);
    }
    output::print_styled(&inspection.show())
}

fn of_library(library: &Library, file: String, bytes: u64) -> Inspection {
    let source = &library.source;
    // Areas are counted in pixels of the arrangement.
    let pixels = source.scale[0] * source.scale[1];
    let categories =
        library.categories.iter().zip(library.category_names()).enumerate().map(|(i, (category, name))| {
            let members =
                || library.primaries().iter().filter(|p| p.category.is_some_and(|c| c.index() == i));
            CategoryLine {
                library: None,
                category: CategoryId(i as u16).number(),
                name,
                colour: category.colour(),
                primaries: members().count(),
                whole: Some(members().filter(|p| !p.clipped).count()),
                mean_area: category.centre[3] / pixels,
                coverage: category.coverage,
            }
        });
    Inspection {
        command: "inspect",
        file,
        format: library.format.clone(),
        version: library.version,
        program: source.program.clone(),
        bytes,
        size: [source.width, source.height],
        page: None,
        exemplars: vec![ExemplarFile { file: source.file.clone(), sha256: source.sha256.clone() }],
        segmenter: Some(source.segmenter.clone()),
        seed: Some(source.parameters.seed),
        tile: None,
        prepared: PhotographPreparation::of_library(library),
        lattice: library.lattice.clone(),
        motifs: MotifCount::of_library(library),
        layers: library
            .layers
            .iter()
            .map(|l| LayerLine::new(&l.name, l.role, l.instances.len(), l.field.as_ref(), l.region.is_some()))
            .collect(),
        counts: ElementCounts::of_library(library),
        coverage: library.coverage,
        areas: AreaQuantiles {
            primaries: Quantiles::of(library.primaries().iter().map(|p| f64::from(p.area) / pixels)),
            secondaries: Quantiles::of(library.secondaries().iter().map(|s| f64::from(s.area) / pixels)),
        },
        spacing: Spacing {
            secondaries: Some(library.secondary_spacing()),
            background: Some(library.background().spacing),
        },
        categories: categories.collect(),
        analyze: Some(source.parameters.clone()),
        synth: None,
        edits: Vec::new(),
        warnings: source.warnings.clone(),
    }
}

fn of_scene(scene: &Scene, file: String, bytes: u64) -> Inspection {
    let area = |i: &vtex::scene::Instance| scene.element(i).outline().area() * i.affine().determinant().abs();
    let covered = vtex::output::coverage(scene);
    let canvas = (vtex::output::inside(scene) as f64).max(1.0);
    let categories = vtex::output::categories(scene).into_iter().map(|c| {
        let same = |t: &vtex::scene::Element| t.library == c.library && t.category == Some(c.category);
        let members = scene.individuals().filter(|i| same(scene.element(i)));
        let pixels = covered.get(&(c.library, c.category)).copied().unwrap_or(0);
        CategoryLine {
            library: (scene.libraries.len() > 1).then(|| c.library.number()),
            category: c.category.number(),
            name: c.name,
            colour: c.colour,
            primaries: c.elements,
            whole: None,
            mean_area: members.map(area).sum::<f64>() / c.elements.max(1) as f64,
            coverage: pixels as f64 / canvas,
        }
    });
    let exemplars =
        scene.libraries.iter().map(|l| ExemplarFile { file: l.exemplar.clone(), sha256: l.sha256.clone() });
    Inspection {
        command: "inspect",
        file,
        format: scene.format.clone(),
        version: scene.version,
        program: scene.program.clone(),
        bytes,
        size: [scene.width, scene.height],
        page: scene.page,
        exemplars: exemplars.collect(),
        segmenter: None,
        seed: scene.parameters.as_ref().map(|p| p.seed),
        tile: Some(scene.tile),
        prepared: PhotographPreparation::default(),
        lattice: None,
        motifs: Vec::new(),
        layers: scene
            .layers
            .iter()
            .map(|l| LayerLine::new(&l.name, l.role, l.instances.len(), l.field.as_ref(), l.region.is_some()))
            .collect(),
        counts: ElementCounts::of_scene(scene),
        coverage: covered.values().sum::<u64>() as f64 / canvas,
        areas: AreaQuantiles {
            primaries: Quantiles::of(scene.of_role(Role::Primary).map(area)),
            secondaries: Quantiles::of(scene.of_role(Role::Secondary).map(area)),
        },
        spacing: Spacing {
            secondaries: None,
            background: scene.layers.iter().find_map(|l| Some(l.field.as_ref()?.spacing)),
        },
        categories: categories.collect(),
        analyze: None,
        synth: scene.parameters.clone(),
        edits: scene.edits.clone(),
        warnings: Vec::new(),
    }
}

impl LayerLine {
    fn new(name: &str, role: Role, elements: usize, field: Option<&Field>, region: bool) -> Self {
        Self { name: name.to_owned(), role, elements, points: field.map(|f| f.points.len()), region }
    }
}

impl Quantiles {
    /// Quantiles of some values; `None` without values. Each is the value at or below which that share lies.
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let at = |tenths: usize| sorted[last * tenths / 10];
        Some(Self { smallest: at(0), tenth: at(1), median: at(5), ninetieth: at(9), largest: at(10) })
    }
}

impl Inspection {
    /// Text for people: aligned, with styles that are removed where colours are off.
    fn show(&self) -> String {
        let head = Style::new().bold();
        let c = &self.counts;
        let mut text = format!(
            "{head}{}{head:#}: {} {}, written by {}, {}\n\n",
            escaped(&self.file),
            self.format,
            self.version,
            escaped(&self.program),
            show_bytes(self.bytes)
        );
        let mut line =
            |name: &str, value: String| text.push_str(&format!("{head}{name:12}{head:#} {value}\n"));
        line("size", format!("{} x {} px", self.size[0], self.size[1]));
        if let Some([width, height]) = self.page {
            line("page", format!("{width} x {height}"));
        }
        for exemplar in &self.exemplars {
            let sum: String = exemplar.sha256.chars().take(12).collect();
            line("exemplar", escaped(&format!("{} (sha256 {sum}…)", exemplar.file)));
        }
        if let Some(segmenter) = &self.segmenter {
            line("segmenter", escaped(segmenter));
        }
        if let Some(seed) = self.seed {
            line("seed", seed.to_string());
        }
        match self.tile {
            Some(Tile { x: true, y: true }) => line("tiles", "in both directions".into()),
            Some(Tile { x: true, .. }) => line("tiles", "left to right".into()),
            Some(Tile { y: true, .. }) => line("tiles", "top to bottom".into()),
            _ => {}
        }
        for (k, words) in self.prepared.in_words().enumerate() {
            line(if k == 0 { "prepared" } else { "" }, words);
        }
        if let Some(lattice) = &self.lattice {
            line("regular", lattice_text(lattice));
            line("", lattice_measures(lattice));
        }
        if let Some(motifs) = MotifCount::in_words(&self.motifs) {
            line("motifs", motifs);
        }
        let layers: Vec<&str> = self.layers.iter().map(|layer| layer.name.as_str()).collect();
        line("layers", layers.join(", "));
        let whole = c.clipped.map(|n| format!(" ({} can be placed, {n} cut by the border)", c.primaries - n));
        line("primaries", format!("{:7}{}", c.primaries, whole.unwrap_or_default()));
        line("details", format!("{:7}", c.details));
        let apart = self.spacing.secondaries.map(|s| format!(" (spacing {s:.1} px)"));
        line("secondaries", format!("{:7}{}", c.secondaries, apart.unwrap_or_default()));
        let apart = self.spacing.background.map(|s| format!(" (spacing {s:.1} px)"));
        line("background", format!("{:7}{}", c.background, apart.unwrap_or_default()));
        line("coverage", format!("{:6.1} %", self.coverage * 100.0));
        let areas = [("primaries", self.areas.primaries), ("secondaries", self.areas.secondaries)];
        if areas.iter().any(|a| a.1.is_some()) {
            text.push('\n');
            let titles = ["area in px", "smallest", "10 %", "median", "90 %", "largest"];
            let mut rows = vec![titles.map(str::to_owned).to_vec()];
            for (name, quantiles) in areas {
                let Some(q) = quantiles else { continue };
                let values = [q.smallest, q.tenth, q.median, q.ninetieth, q.largest];
                rows.push(std::iter::once(name.into()).chain(values.map(|v| format!("{v:.0}"))).collect());
            }
            table(&rows, &[], &mut text);
        }
        if !self.categories.is_empty() {
            text.push('\n');
            let several = self.categories.iter().any(|c| c.library.is_some());
            let whole = self.categories.iter().any(|c| c.whole.is_some());
            let mut titles = vec!["category", "colour", "name", "primaries"];
            if whole {
                titles.push("whole");
            }
            titles.extend(["mean area", "coverage"]);
            let mut rows = vec![titles.into_iter().map(str::to_owned).collect::<Vec<_>>()];
            for c in &self.categories {
                let name = match c.library {
                    Some(library) if several => format!("{library}:{}", c.category),
                    _ => c.category.to_string(),
                };
                let mut row = vec![name, c.colour.to_string(), c.name.clone(), c.primaries.to_string()];
                row.extend(c.whole.map(|n| n.to_string()));
                row.extend([format!("{:.0} px", c.mean_area), format!("{:.2} %", c.coverage * 100.0)]);
                rows.push(row);
            }
            let swatches: Vec<Colour> = self.categories.iter().map(|c| c.colour).collect();
            table(&rows, &swatches, &mut text);
        }
        if !self.edits.is_empty() {
            text.push_str(&format!("\n{head}edits{head:#}, in this order\n"));
        }
        for (i, edit) in self.edits.iter().enumerate() {
            // The seed is shown only if it is not the scene's own.
            let own = edit.seed == self.seed.unwrap_or(0);
            let seed = if own { String::new() } else { format!(" (seed {})", edit.seed) };
            text.push_str(&format!("{:4}  {}{seed}\n", i + 1, escaped(&edit.operation.to_string())));
        }
        if !self.warnings.is_empty() {
            text.push('\n');
        }
        let yellow = label(AnsiColor::Yellow);
        for warning in &self.warnings {
            text.push_str(&format!("{yellow}warning:{yellow:#} {}\n", escaped(warning)));
        }
        text
    }
}

/// A table: titles are bold, the first column is aligned to the left, all others to the right. With colours,
/// each row after the first has a patch of its colour before the second column.
fn table(rows: &[Vec<String>], swatches: &[Colour], text: &mut String) {
    let bold = Style::new().bold();
    let width = |k: usize| rows.iter().filter_map(|r| r.get(k)).map(|c| c.chars().count()).max().unwrap_or(0);
    for (i, row) in rows.iter().enumerate() {
        let style = if i == 0 { bold } else { Style::new() };
        let mut line = String::new();
        for (k, cell) in row.iter().enumerate() {
            let width = width(k);
            match k {
                0 => line.push_str(&format!("{cell:<0$}", width.max(12))),
                1 if !swatches.is_empty() => {
                    let colour = i.checked_sub(1).and_then(|k| swatches.get(k));
                    let patch = colour.map_or(Style::new(), |c| {
                        let [r, g, b] = c.0;
                        Style::new().bg_color(Some(RgbColor(r, g, b).into()))
                    });
                    line.push_str(&format!(" {patch}    {patch:#} {cell:>width$}"));
                }
                _ => line.push_str(&format!("  {cell:>width$}")),
            }
        }
        text.push_str(&format!("{style}{line}{style:#}\n"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_the_sample() {
        let q = Quantiles::of((0..=100).rev().map(f64::from)).unwrap();
        assert_eq!((q.smallest, q.tenth, q.median, q.ninetieth, q.largest), (0.0, 10.0, 50.0, 90.0, 100.0));
        let one = Quantiles::of([7.0].into_iter()).unwrap();
        assert_eq!((one.smallest, one.largest), (7.0, 7.0));
        assert_eq!(Quantiles::of(std::iter::empty()), None);
    }
}
