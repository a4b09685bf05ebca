//! Summaries of commands: JSON for programs, a line or two for people.

use super::common::Common;
use super::output::{WrittenFile, print_json, say};
use super::progress::Reporter;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::path::{Path, PathBuf};
use std::time::Duration;
use vtex::Progress;
use vtex::library::{Lattice, Library, Source, SourceKind};
use vtex::output::reduce::GivenUp;
use vtex::raster::colour::Colour;
use vtex::scene::{Length, LengthUnit, Method, Role, Scene};
use vtex::statistics::{Overlap, Repetition};
use vtex::synth::{CategoryReport, ClusterReport, CurveReport, Structure, SynthReport, Turned, layer_map};

/// The summary of a command.
#[derive(Debug, Serialize)]
pub(crate) struct Summary {
    pub(crate) program: &'static str,
    pub(crate) command: &'static str,
    /// The photograph, libraries or file.
    pub(crate) inputs: Vec<String>,
    pub(crate) output: String,
    /// Further files, written by several -o.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) others: Vec<Other>,
    /// The file of the pattern, if one was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pattern: Option<String>,
    /// Bytes of the output.
    pub(crate) bytes: u64,
    /// Reductions to stay within --max-bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) given_up: Option<GivenUp>,
    /// The seed, where one matters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) seed: Option<u64>,
    /// Size of the picture, in pixels.
    pub(crate) size: [u32; 2],
    /// Width and height of the page, if it is not that of the picture in pixels of CSS.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) page: Option<[Length; 2]>,
    /// The photograph that was reduced before it was analysed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reduced: Option<PhotographReduction>,
    /// What else was done to the photograph before it was analysed.
    #[serde(flatten)]
    pub(crate) prepared: PhotographPreparation,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) counts: Option<ElementCounts>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) coverage: Option<Coverage>,
    /// The layers of a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) layers: Option<LayersReport>,
    /// The rows or the lattice of a library.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lattice: Option<Lattice>,
    /// The motifs of a drawing's library, by their number of elements.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) motifs: Vec<MotifCount>,
    /// How primaries were placed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) method: Option<Method>,
    /// Counts of the field of correspondences.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) structure: Option<Structure>,
    /// Advice if few elements were carried whole, for people.
    #[serde(skip)]
    pub(crate) few_whole: Option<String>,
    /// Area of primaries hidden by others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) overlap: Option<Overlap>,
    /// Repetition of the same primaries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) repetition: Option<Repetition>,
    /// Share of the places that repeat a drawing's own period.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) period: Option<f64>,
    /// What the optimisation of clustered samples did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clusters: Option<ClusterReport>,
    /// What the synthesis of curves did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) curves: Option<CurveReport>,
    /// Seconds by stage, in the order of the stages.
    pub(crate) seconds: Seconds,
    /// Most memory used, in bytes, where the system tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) peak_memory: Option<u64>,
    pub(crate) warnings: Vec<String>,
}

impl Summary {
    /// Summary of a finished command, with the warnings of the writer. Fields that only some commands have
    /// are empty. Ends the reports of progress.
    pub(crate) fn new(
        command: &'static str,
        inputs: Vec<String>,
        output: &Path,
        written: WrittenFile,
        reporter: &Reporter,
    ) -> Self {
        written.warnings.iter().for_each(|warning| reporter.warn(warning));
        let (seconds, warnings) = reporter.finish();
        Self {
            program: vtex::PROGRAM,
            command,
            inputs,
            output: output.display().to_string(),
            others: written.others.into_iter().map(Other::from).collect(),
            pattern: None,
            bytes: written.bytes,
            given_up: written.given_up,
            seed: None,
            size: [0; 2],
            page: None,
            reduced: None,
            prepared: PhotographPreparation::default(),
            counts: None,
            coverage: None,
            layers: None,
            lattice: None,
            motifs: Vec::new(),
            method: None,
            structure: None,
            few_whole: None,
            overlap: None,
            repetition: None,
            period: None,
            clusters: None,
            curves: None,
            seconds: Seconds(seconds),
            peak_memory: peak_memory(),
            warnings,
        }
    }
}

/// A further file.
#[derive(Debug, Serialize)]
pub(crate) struct Other {
    output: String,
    bytes: u64,
}

impl From<(PathBuf, u64)> for Other {
    fn from((path, bytes): (PathBuf, u64)) -> Self {
        Self { output: path.display().to_string(), bytes }
    }
}

/// Sizes of a photograph that was reduced before it was analysed, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct PhotographReduction {
    pub(crate) from: [u32; 2],
    pub(crate) to: [u32; 2],
}

impl PhotographReduction {
    /// How far the exemplar of a library was reduced; `None` if it was analysed at full size.
    pub(crate) fn of_library(library: &Library) -> Option<Self> {
        let from = [library.source.width, library.source.height];
        let to = [library.arrangement.width, library.arrangement.height];
        (library.source.kind == SourceKind::Photograph && to[0] < from[0]).then_some(Self { from, to })
    }
}

/// What is done to small and to subtle pictures before they are analysed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct PhotographPreparation {
    /// Width and height of the small tile that was repeated, in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) repeated: Option<[u32; 2]>,
    /// Factor by which the contrast was stretched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) contrast: Option<f64>,
    /// How many times as bright as the darkest place the brightest was lit, if that light was taken out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) light: Option<f64>,
}

impl PhotographPreparation {
    pub(crate) fn of_library(library: &Library) -> Self {
        let Source { copies, contrast, light, width, height, .. } = library.source;
        Self {
            repeated: (copies != [1; 2]).then(|| [width / copies[0], height / copies[1]]),
            contrast: (contrast != 1.0).then_some(contrast),
            light,
        }
    }

    /// In words, a line each.
    pub(crate) fn in_words(&self) -> impl Iterator<Item = String> {
        let tile = |[w, h]: [u32; 2]| {
            format!(
                "the tile of {w} x {h} px was repeated before it was analysed, and textures repeat with it"
            )
        };
        let contrast = |gain: f64| {
            format!(
                "the contrast was stretched {gain:.1} times for the analysis; results have the photograph's own \
                 (--contrast off stops this)"
            )
        };
        let light = |ratio: f64| {
            format!(
                "one side of the photograph was lit {ratio:.1} times as brightly as another, which was evened out \
                 (--even-light off stops this)"
            )
        };
        self.repeated.map(tile).into_iter().chain(self.light.map(light)).chain(self.contrast.map(contrast))
    }
}

/// Number of elements by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct ElementCounts {
    /// Primaries of a library, or placed primaries of a scene.
    pub(crate) primaries: usize,
    /// Primaries that the border cuts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clipped: Option<usize>,
    /// Details on primaries.
    pub(crate) details: usize,
    pub(crate) secondaries: usize,
    /// Categories of primaries.
    pub(crate) categories: usize,
    /// Colours of the background.
    pub(crate) background: usize,
}

impl ElementCounts {
    /// Counts of a library.
    pub(crate) fn of_library(library: &Library) -> Self {
        Self {
            primaries: library.primaries().len(),
            clipped: Some(library.primaries().iter().filter(|p| p.clipped).count()),
            details: library.primaries().iter().map(|p| p.details().len()).sum(),
            secondaries: library.secondaries().len(),
            categories: library.categories.len(),
            background: library.background().points.len(),
        }
    }

    /// Counts of a validated scene.
    pub(crate) fn of_scene(scene: &Scene) -> Self {
        let textons = || scene.individuals().map(|i| scene.element(i));
        let categories: std::collections::BTreeSet<_> =
            textons().filter_map(|t| t.category.map(|c| (t.library, c))).collect();
        Self {
            primaries: scene.of_role(Role::Primary).count(),
            clipped: None,
            details: textons().map(|t| t.details().len()).sum(),
            secondaries: scene.of_role(Role::Secondary).count(),
            categories: categories.len(),
            background: scene.layers.iter().filter_map(|l| l.field.as_ref()).map(|f| f.points.len()).sum(),
        }
    }

    /// Counts of what a file of the scene contains, if it was reduced to a limit of bytes.
    fn reduced(self, given_up: Option<&GivenUp>) -> Self {
        let Some(given_up) = given_up else { return self };
        Self {
            primaries: self.primaries.saturating_sub(given_up.primaries),
            details: self.details.saturating_sub(given_up.details),
            secondaries: self.secondaries.saturating_sub(given_up.elements),
            ..self
        }
    }
}

/// Number of the motifs of a number of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct MotifCount {
    pub(crate) elements: usize,
    pub(crate) motifs: usize,
}

impl MotifCount {
    /// Counts of a library.
    pub(crate) fn of_library(library: &Library) -> Vec<Self> {
        let sizes = library.motif_sizes();
        sizes.into_iter().map(|(elements, motifs)| Self { elements, motifs }).collect()
    }

    /// Counts in a line, as in "12 motifs of 3 elements"; `None` for no motifs.
    pub(crate) fn in_words(counts: &[Self]) -> Option<String> {
        let each = |&Self { elements, motifs }: &Self| {
            format!("{} of {}", counted(motifs, "motif", "motifs"), counted(elements, "element", "elements"))
        };
        let each: Vec<String> = counts.iter().map(each).collect();
        (!each.is_empty()).then(|| each.join(", "))
    }
}

/// Share of the area that primaries cover, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Coverage {
    /// In the exemplar, or what a shape to fill and maps leave of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wanted: Option<f64>,
    /// In the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) got: Option<f64>,
    /// The same by category, in the library's order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) categories: Vec<CategoryReport>,
    /// The kind of exemplar, for messages.
    #[serde(skip)]
    pub(crate) exemplar: &'static str,
    /// Share in the exemplar itself, for messages. A shape to fill or a map lets a canvas want another.
    #[serde(skip)]
    pub(crate) own: Option<f64>,
}

impl Coverage {
    /// The shares in words; `None` if none is known.
    fn in_words(&self) -> Option<String> {
        let (wanted, got) = match (self.wanted, self.got) {
            (Some(wanted), Some(got)) => (wanted, got),
            (Some(share), None) | (None, Some(share)) => {
                return Some(format!("elements cover {}", percent(share)));
            }
            (None, None) => return None,
        };
        let (got, wanted, exemplar) = (percent(got), percent(wanted), self.exemplar);
        Some(match self.own.map(percent).filter(|own| *own != wanted) {
            Some(own) => {
                format!("elements cover {got} of the canvas ({wanted} wanted there, {own} in the {exemplar})")
            }
            None => format!("elements cover {got} ({wanted} in the {exemplar})"),
        })
    }
}

/// A share, 0 to 1, in whole per cent.
pub(crate) fn percent(share: f64) -> String {
    // Of a share a little below 0 the sign would stay.
    format!("{:.0} %", (100.0 * share).round() + 0.0)
}

/// A number of things, with the word for one of them or for several.
pub(crate) fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// The exemplars of several libraries, for messages.
pub(crate) const SEVERAL: &str = "exemplars";

/// The kind of the exemplars of libraries, for messages.
pub(crate) fn exemplar_of(libraries: &[Library]) -> &'static str {
    match libraries {
        [library] if library.source.kind == SourceKind::Drawing => "drawing",
        [_] => "photograph",
        _ => SEVERAL,
    }
}

/// The layers of a map, from bottom to top.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct LayersReport {
    pub(crate) names: Vec<String>,
    pub(crate) colours: Vec<Colour>,
    /// Shares of the area in the input, 0 to 1.
    pub(crate) wanted: Vec<f64>,
    /// The same in the result.
    pub(crate) got: Vec<f64>,
    /// For a texture: share of each layer that primaries cover, in the exemplar and in the result, 0 to 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) coverage: Vec<[f64; 2]>,
    /// Reason for the number of layers, if they were found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) why: Option<String>,
}

impl LayersReport {
    /// Layers of a library's exemplar; `None` for a single layer without a decision on the number.
    pub(crate) fn of_library(library: &Library) -> Option<Self> {
        let map = layer_map(library);
        let why = library.source.strata_reason.clone();
        (map.layers.len() > 1 || why.is_some()).then(|| Self {
            names: map.layers.iter().map(|l| l.name.clone()).collect(),
            colours: map.layers.iter().map(|l| l.colour).collect(),
            wanted: map.shares(),
            got: map.shares(),
            coverage: Vec::new(),
            why,
        })
    }

    /// Layers of a texture; `None` if it has none.
    pub(crate) fn of_texture(report: &SynthReport) -> Option<Self> {
        let strata = &report.strata;
        (!strata.is_empty()).then(|| Self {
            names: strata.iter().map(|s| s.name.clone()).collect(),
            colours: strata.iter().map(|s| s.colour).collect(),
            wanted: strata.iter().map(|s| s.area_wanted).collect(),
            got: strata.iter().map(|s| s.area).collect(),
            coverage: strata.iter().map(|s| [s.coverage_wanted, s.coverage]).collect(),
            why: None,
        })
    }

    /// Names and areas in a line; `None` for a single layer.
    fn in_words(&self) -> Option<String> {
        let each = self.names.iter().zip(&self.got).enumerate().map(|(k, (name, share))| {
            let coverage = self.coverage.get(k).map_or(String::new(), |[wanted, got]| {
                format!(" (elements cover {} of it, {} in the photograph)", percent(*got), percent(*wanted))
            });
            format!("{name} {}{coverage}", percent(*share))
        });
        let each: Vec<String> = each.collect();
        (each.len() > 1).then(|| format!("layers from bottom to top: {}", each.join(", ")))
    }
}

/// Seconds by stage.
#[derive(Debug)]
pub(crate) struct Seconds(pub(crate) Vec<(&'static str, Duration)>);

impl Seconds {
    /// The sum of all stages.
    pub(crate) fn total(&self) -> f64 {
        self.0.iter().map(|s| s.1.as_secs_f64()).sum()
    }
}

impl Serialize for Seconds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let milliseconds = |s: f64| (s * 1e3).round() / 1e3;
        let mut map = serializer.serialize_map(Some(self.0.len() + 1))?;
        for (stage, spent) in &self.0 {
            map.serialize_entry(stage, &milliseconds(spent.as_secs_f64()))?;
        }
        map.serialize_entry("total", &milliseconds(self.total()))?;
        map.end()
    }
}

impl Summary {
    /// Prints the summary in the chosen form and verbosity.
    ///
    /// # Errors
    /// A closed standard output.
    pub(crate) fn print(&self, common: &Common, stdout_is_taken: bool) -> anyhow::Result<()> {
        if common.json {
            return print_json(self, stdout_is_taken);
        }
        if common.quiet {
            return Ok(());
        }
        let mut line = format!("{}: {} x {} px", self.output, self.size[0], self.size[1]);
        if let Some([width, height]) = self.page.filter(|page| page[0].unit() != LengthUnit::Pixel) {
            let dpi = f64::from(self.size[0]) / width.inches();
            line.push_str(&format!(" on a page of {width} x {height} ({dpi:.0} dpi)"));
        }
        if let Some(c) = self.counts.map(|counts| counts.reduced(self.given_up.as_ref())) {
            let small = match c.secondaries {
                0 => String::new(),
                n => format!(" and {}", counted(n, "small one", "small ones")),
            };
            let elements = counted(c.primaries, "element", "elements");
            let categories = counted(c.categories, "category", "categories");
            line.push_str(&format!(", {elements} in {categories}{small}"));
        }
        if let Some(coverage) = self.coverage.as_ref().and_then(Coverage::in_words) {
            line.push_str(&format!(", {coverage}"));
        }
        if let Some(pattern) = &self.pattern {
            line.push_str(&format!(", pattern in {pattern}"));
        }
        line.push_str(&format!(", {} in {:.2} s", bytes(self.bytes), self.seconds.total()));
        say(&line);
        if let Some(few) = &self.few_whole {
            say(few);
        }
        if let Some(turned) = self.structure.as_ref().and_then(|structure| structure.turned) {
            say(turned_text(turned));
        }
        for Other { output, bytes: size } in &self.others {
            say(&format!("{output}: {}", bytes(*size)));
        }
        if let Some(PhotographReduction { from: [w, h], to: [x, y] }) = self.reduced {
            say(&format!(
                "the photograph of {w} x {h} px was reduced to {x} x {y} px first (--max-pixels says how far)"
            ));
        }
        self.prepared.in_words().for_each(|line| say(&line));
        if let Some(layers) = self.layers.as_ref().and_then(LayersReport::in_words) {
            say(&layers);
        }
        if let Some(lattice) = &self.lattice {
            say(&lattice_text(lattice));
        }
        if let Some(motifs) = MotifCount::in_words(&self.motifs) {
            say(&motifs);
        }
        if let Some(given_up) = &self.given_up {
            say(&format!("reduced to stay within the limit of bytes: {}", reductions(given_up)));
        }
        if let (Some(seed), true) = (self.seed, common.seed_chosen) {
            say(&format!("seed: {seed} (give --seed {seed} to make the same again)"));
        }
        if common.verbosity > 0 {
            self.print_details();
        }
        Ok(())
    }

    /// Prints counts, measures, seconds by stage and memory.
    fn print_details(&self) {
        if let Some(c) = &self.counts {
            let cut = c.clipped.map_or(String::new(), |n| {
                format!(", the border cuts {n} of {}", counted(c.primaries, "element", "elements"))
            });
            let details = counted(c.details, "detail", "details");
            let background = counted(c.background, "background colour", "background colours");
            say(&format!("  {details} on elements, {background}{cut}"));
        }
        if let Some(why) = self.layers.as_ref().and_then(|layers| layers.why.as_ref()) {
            let count = self.layers.as_ref().map_or(0, |layers| layers.names.len());
            let count = counted(count, "layer", "layers");
            say(&format!("  {count}: {why}"));
        }
        if let Some(lattice) = &self.lattice {
            say(&format!("  {}", lattice_measures(lattice)));
        }
        let placed = match self.method {
            Some(Method::Correspondence) => Some("carried along from the exemplar (correspondence)"),
            Some(Method::Descriptor) => Some("placed one by one, by what stands around them (descriptor)"),
            Some(Method::Period) => Some("placed by the period of the drawing (period)"),
            Some(Method::Clustered) => {
                Some("arranged by clusters of samples, as the neighbourhoods of the drawing (clustered)")
            }
            Some(Method::Curves) => {
                Some("made anew as curves, as the neighbourhoods of the drawing (curves)")
            }
            Some(Method::Auto) | None => None,
        };
        if let Some(how) = placed {
            say(&format!("  elements were {how}"));
        }
        if let Some(share) = self.period {
            say(&format!("  {} of the places repeat the drawing", percent(share)));
        }
        if let Some(clusters) = &self.clusters {
            say(&format!("  {}", optimised(clusters)));
        }
        if let Some(curves) = &self.curves {
            say(&format!("  {}", run_on(curves)));
        }
        if let Some(structure) = &self.structure {
            say(&format!("  {}", structure_text(structure)));
        }
        if let (Some(overlap), Some(repetition)) = (&self.overlap, &self.repetition) {
            say(&format!("  {}", placement_text(overlap, repetition)));
        }
        for (stage, spent) in &self.seconds.0 {
            say(&format!("  {stage:16} {:8.3} s", spent.as_secs_f64()));
        }
        if let Some(peak) = self.peak_memory {
            say(&format!("  {:16} {:>10}", "peak memory", bytes(peak)));
        }
    }
}

/// What the optimisation of clusters did, in a line.
fn optimised(clusters: &ClusterReport) -> String {
    let ClusterReport { samples, iterations, switched, merged, split, .. } = clusters;
    let ClusterReport { moved, removed, added, exchanged, .. } = clusters;
    let beside = clusters.recognised.map_or(String::new(), |[own, all]| {
        format!("; {own} of {all} elements beside it are those of the library")
    });
    format!(
        "{samples} samples in {iterations} iterations: {switched} changed clusters, {merged} merged, {split} split; \
         {moved} elements moved apart, {removed} removed, {added} added, {exchanged} exchanged{beside}"
    )
}

/// What the synthesis of curves did, in a line.
fn run_on(curves: &CurveReport) -> String {
    let CurveReport { samples, iterations, paths, joined, attached, removed, ends, continued, .. } = curves;
    let [drawn, made] = ends;
    let beside =
        continued.map_or(String::new(), |[ends, on]| format!("; {on} of {ends} ends beside it go on"));
    format!(
        "{samples} samples in {iterations} iterations, {paths} paths: {joined} pairs of loose ends joined, {attached} led \
         to a line, {removed} samples removed; {made:.2} ends for each 1000 units of line, {drawn:.2} in the drawing{beside}"
    )
}

/// The reductions of a file, in a line.
fn reductions(given_up: &GivenUp) -> String {
    let GivenUp { decimals, names, tolerance, details, elements, primaries, background, colours } = *given_up;
    let digits = counted(decimals.into(), "decimal", "decimals");
    let mut line = format!("numbers have {digits}");
    if names {
        line.push_str(", elements have no names in editors");
    }
    if tolerance > 0.0 {
        line.push_str(&format!(", outlines lie within {tolerance} px"));
    }
    if details + elements > 0 {
        let details = counted(details, "detail", "details");
        let elements = counted(elements, "small element", "small elements");
        line.push_str(&format!(", {details} and {elements} are left out"));
    }
    if primaries > 0 {
        let primaries = counted(primaries, "large element", "large elements");
        line.push_str(&format!(", also {primaries}"));
    }
    if background > 1.0 {
        line.push_str(&format!(", the background is {background} times coarser"));
    }
    if colours > 0.0 {
        line.push_str(", colours are rounded and gradients flat");
    }
    line
}

/// A lattice, in a line.
pub(crate) fn lattice_text(lattice: &Lattice) -> String {
    let found = lattice.in_words();
    if lattice.is_kept() {
        return format!("{found}: textures keep to them");
    }
    let numbers: Vec<String> = lattice.vectors.iter().flatten().map(|v| format!("{v:.1}")).collect();
    format!(
        "{found}, but only in parts: textures do not keep to them unless you give --lattice={}",
        numbers.join(",")
    )
}

/// The measures of a lattice, in a line.
pub(crate) fn lattice_measures(lattice: &Lattice) -> String {
    let vectors: Vec<String> = lattice.vectors.iter().map(|[x, y]| format!("({x:.1}, {y:.1})")).collect();
    format!(
        "vectors {} px, correlation {:.2} of 1, stray {:.1} px",
        vectors.join(" and "),
        lattice.strength,
        lattice.stray
    )
}

/// Counts of a field of correspondences, in a line.
fn structure_text(s: &Structure) -> String {
    format!(
        "{} came whole, in {}; {} replaced by others like them, {} joined of parts ({:.1} % of the canvas)",
        counted(s.whole, "element", "elements"),
        counted(s.islands, "patch", "patches"),
        s.like,
        s.fused,
        100.0 * s.fused_share
    )
}

/// Advice if few elements of a texture were carried whole; `None` if enough were. Of 24 photographs on
/// canvases of 800 px one gets the advice: an eighth of its planks were carried whole, a third without the
/// rows. Of bricks two fifths were carried whole, which is not noticeable. Of cracked mud a sixth was carried
/// whole from a quarter of the photograph, two thirds from all of it.
pub(crate) fn few_whole(s: &Structure, library: &Library) -> Option<String> {
    const LEAST_SHARE: f64 = 0.25;
    const LEAST_COUNT: usize = 8;
    /// Largest coverage of elements that count as apart.
    const APART: f64 = 0.6;
    let all = s.whole + s.like + s.fused;
    if all < LEAST_COUNT || s.whole as f64 >= LEAST_SHARE * all as f64 {
        return None;
    }
    let larger = match library.source.kind {
        SourceKind::Photograph => "a larger photograph helps",
        SourceKind::Drawing => "a larger drawing helps",
    };
    let helps = if library.lattice.as_ref().is_some_and(Lattice::is_kept) {
        "--lattice off keeps more of them whole, but not their rows".into()
    } else if s.wanted < APART {
        format!("{larger}, and --method descriptor places none but whole ones")
    } else {
        larger.to_owned()
    };
    Some(format!(
        "only {} of {all} elements came whole, the others were replaced or joined of parts: {helps}",
        s.whole
    ))
}

/// How a photograph was turned because few of its elements are whole, in a line.
fn turned_text(turned: Turned) -> &'static str {
    match turned {
        Turned::Freely => {
            "few elements are whole, so the photograph was turned and mirrored; --rotate 0 stops this"
        }
        Turned::Mirrored => "few elements are whole, so the photograph was mirrored; --rotate 0 stops this",
    }
}

/// Counts of placement, in a line.
fn placement_text(overlap: &Overlap, repetition: &Repetition) -> String {
    let mut line = format!(
        "elements hide {:.1} % of one another; {} different ones are used ({} are whole), none for more than \
         {:.1} % of the places",
        100.0 * overlap.hidden,
        repetition.textons,
        repetition.placeable,
        100.0 * repetition.largest_share
    );
    if let Some(copies) = repetition.copies {
        line.push_str(&format!(
            ", and the next of the same kind is {:.0} px away or more, {:.0} px in the median",
            copies.shortest, copies.median
        ));
    }
    line
}

/// A number of bytes in a readable unit.
pub(crate) fn bytes(count: u64) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", count as f64 / 1e6),
        _ => format!("{:.2} GB", count as f64 / 1e9),
    }
}

/// Most memory that this process has used, in bytes.
pub(crate) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kb| kb * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_readable() {
        let shown = [0, 999, 1_000, 2_345_678, 7_000_000_000].map(bytes);
        assert_eq!(shown, ["0 B", "999 B", "1.0 kB", "2.3 MB", "7.00 GB"]);
    }

    #[test]
    fn counts_and_shares_read_well() {
        assert_eq!([0.0, -0.0, -0.001, 0.184, 1.0].map(percent), ["0 %", "0 %", "0 %", "18 %", "100 %"]);
        assert_eq!(counted(1, "category", "categories"), "1 category");
        assert_eq!([0, 2].map(|n| counted(n, "patch", "patches")), ["0 patches", "2 patches"]);
        let coverage = |own| Coverage {
            wanted: Some(0.21),
            got: Some(0.18),
            categories: Vec::new(),
            exemplar: "photograph",
            own,
        };
        assert_eq!(coverage(Some(0.211)).in_words().unwrap(), "elements cover 18 % (21 % in the photograph)");
        assert_eq!(
            coverage(Some(0.76)).in_words().unwrap(),
            "elements cover 18 % of the canvas (21 % wanted there, 76 % in the photograph)"
        );
    }

    #[test]
    fn placement_is_told_in_a_line() {
        let overlap = Overlap { hidden: 0.0123, buried: 0.0 };
        let mut repetition =
            Repetition { textons: 40, placeable: 44, largest_share: 0.031, near: 0.1, copies: None };
        let line = placement_text(&overlap, &repetition);
        assert_eq!(
            line,
            "elements hide 1.2 % of one another; 40 different ones are used (44 are whole), none for more than 3.1 % of \
             the places"
        );
        repetition.copies = Some(vtex::statistics::CopyDistances {
            shortest: 20.4,
            shortest_neighbours: 1.0,
            median: 60.5,
            median_neighbours: 3.0,
        });
        assert!(
            placement_text(&overlap, &repetition).ends_with("is 20 px away or more, 60 px in the median")
        );
    }

    #[test]
    fn few_whole_elements_are_told_with_what_helps() {
        let drawing =
            br#"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="40"><circle r="9"/></svg>"#;
        let mut library = vtex::import::import(drawing, "a", &Default::default(), &()).unwrap();
        library.source.kind = SourceKind::Photograph;
        library.lattice = None;
        let structure =
            |whole, fused, wanted| Structure { whole, like: 2, fused, wanted, ..Structure::default() };
        let told = few_whole(&structure(5, 40, 0.3), &library).unwrap();
        assert!(told.starts_with("only 5 of 47 elements came whole"), "{told}");
        assert!(told.contains("larger photograph") && told.contains("--method descriptor"), "{told}");
        assert!(!few_whole(&structure(5, 40, 0.9), &library).unwrap().contains("--method"));
        assert_eq!(few_whole(&structure(20, 40, 0.3), &library), None);
        assert_eq!(few_whole(&structure(0, 4, 0.3), &library), None);
        library.lattice = Lattice::new(&[[0.0, 40.0]]).ok();
        assert!(few_whole(&structure(5, 40, 0.3), &library).unwrap().contains("--lattice off"));
    }

    #[test]
    fn seconds_keep_the_order_of_stages() {
        let seconds = Seconds(vec![("b", Duration::from_millis(1500)), ("a", Duration::from_millis(250))]);
        assert_eq!(serde_json::to_string(&seconds).unwrap(), r#"{"b":1.5,"a":0.25,"total":1.75}"#);
    }
}
