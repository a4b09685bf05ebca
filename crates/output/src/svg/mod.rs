//! Scene → SVG: pure vectors in groups that designers find easy to navigate.
//!
//! The file is written as a stream; only the background's grid is held in memory. Textons that occur more
//! than once are defined once. Those with details become `<symbol overflow="visible">`, which vector editors
//! list among their symbols; those of one path become a plain `<path>` that takes the fill of its `<use>`.
//! References are `xlink:href`, which old and new readers alike understand. A texton that stands once is
//! written where it stands.
//!
//! In a scene that tiles, textons that cross an edge are repeated at the opposite one, right after their
//! original: primaries as a `<use>` of it, secondaries in full.
//!
//! Layers become groups with the layer's name; a region becomes a clip path. A reader finds of every element
//! of a layer of individuals its *category* in the class of its group (`category-2`, or `category-2-1` for
//! category 2 of library 1 where there are several, both numbered from 1); its *source*, the index among the
//! elements of its library, in the id of its definition, or of its first path where it stands once (`t12` is
//! element 12 with a category, `s340` element 340 without one, `t12-2` that of library 2 where there are
//! several); in an expanded file in `data-source` and `data-library` of its first path; its *place in the
//! painting order* in the order of the document. Soft ellipses that are elements of their own have a brush
//! and a place, but no id. Any other element of such a layer without an id is a copy of the one that its
//! `xlink:href` or `data-copy-of` names. Elements that were predicted have the class `predicted` too, and their number
//! in `data-vtex-id`, which editors keep where they rename ids. The layers are layers in Inkscape too, and the symbols have titles.
//!
//! Ids: layers `background`, `secondary`, `primary`, or `layer-` and a name of their own, with `-region`
//! their clip paths; `p7` the instance of id 7; `t…` and `s…` the elements, `t12g` the gradient of one,
//! `t12s` its shadow (`t12s2` another), `t12o` its bare outline; `g5` any other gradient; `u3` the brush of
//! soft ellipses of one colour, `c8` the clip path of those of an element; `b…` the gradients of fields;
//! `inside` a group that a domain clips, `domain` its clip path; `texture` the pattern, `tile` its content.
//!
//! A scene in one ink states it once (see `ink`). Tiles for the fills of other programs are written by `fill_tile`.

mod animation;
mod background;
mod brushes;
mod css;
mod fill_tile;
mod flowing;
mod gradients;
mod ink;
mod layers;
mod metadata;
mod number;
#[cfg(test)]
mod tests;
mod textons;
mod xml;

pub use animation::{Animation, write_animation};
pub use fill_tile::check_fill;
pub use flowing::write_flow;

use super::background::PreparedBackground;
use super::categories::{SceneCategory, class};
use flowing::{AnimatedPath, DocumentMotion, at_origin};
use layers::LayerGroup;
use number::HexColour;
use std::io::{self, Write};
use textons::SvgTextons;
use vtex_base::Parameter;
use vtex_base::error::{Error, Result};
use vtex_base::geometry::Vec2;
use vtex_scene::scene::{Instance, Layer, Length, LengthUnit, Scene};
use xml::{ViewerLoad, Xml};

/// The beginning of every SVG of vtex. Editors write another beginning when they save, so a file with this
/// beginning contains no one's edits.
pub(super) const BEGINNING: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Written by vtex ";

/// The id of the pattern.
const PATTERN: &str = "texture";

/// Distance by which the content of a pattern extends beyond its cell, in pixels. Renderers draw the cell
/// into whole pixels; a cell that ends within a pixel would leave a transparent hairline.
const BLEED: f64 = 8.0;

/// Number of elements, with every `<use>` followed, from which on editors are slow.
const SLOW_ELEMENTS: u64 = 100_000;
/// Seconds and gigabytes that Inkscape needs to open a million elements: it took 37 s and 6.3 GB for 330 000.
const INKSCAPE: [f64; 2] = [112.0, 19.0];
/// Number of elements, with every `<use>` followed, at which resvg fails.
const MANY_ELEMENTS: u64 = 1_000_000;
/// Number of references at which librsvg fails, and with it rsvg-convert and the viewers of GNOME.
const MANY_REFERENCES: u64 = 500_000;

/// How an SVG is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SvgOptions {
    /// Digits after the decimal point of coordinates. With the default, 1, they are off by a twentieth of a pixel
    /// at most, far below the fidelity of outlines. With 2 outlines are exact, because their grid is 0.01 px.
    pub precision: u8,
    /// Write every texton as plain paths in place, without `<symbol>`, `<use>` and transforms, for programs
    /// that support none of these. Default false.
    pub expand: bool,
    /// Write a style rule for each category, with custom properties that shift its hue and lightness.
    /// Default false.
    pub css: bool,
    /// Name individual elements, as editors list them. Ids and classes are written all the same. Default true.
    pub names: bool,
    /// Write a tile for the fills of other programs: a page of plain shapes, which is also the content of a
    /// `<pattern>`. Needs a scene that [`check_fill`] accepts. Default false.
    pub fills: bool,
}

impl SvgOptions {
    /// Digits after the decimal point of coordinates.
    pub const PRECISION: Parameter<u8> = Parameter::new("precision", [0, 6], "").or(1);

    /// With two decimals in place of one if elements come from a drawing on a small page, where a tenth of a unit is
    /// visible.
    pub fn fit(self, scene: &Scene) -> Self {
        let is_fine = scene.libraries.iter().any(|library| library.fine);
        if is_fine && self.precision == 1 { Self { precision: 2, ..self } } else { self }
    }
}

impl Default for SvgOptions {
    fn default() -> Self {
        Self { precision: 1, expand: false, css: false, names: true, fills: false }
    }
}

/// Counts of a written file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SvgSummary {
    /// Length of the file.
    pub bytes: u64,
    /// Elements in the file.
    pub elements: u64,
    /// Number of elements that a viewer draws, with every `<use>` followed.
    pub drawn: u64,
    /// Textons defined once and placed by reference.
    pub shared_textons: u64,
    /// Warnings for the user, a sentence each.
    pub warnings: Vec<String>,
}

/// Writes a scene as SVG. Same scene and options: the same bytes.
///
/// # Errors
/// A precision out of range; a scene that breaks its invariants; those of [`check_fill`] for a tile for fills; a
/// failing writer.
pub fn write(scene: &Scene, options: &SvgOptions, out: impl Write) -> io::Result<SvgSummary> {
    write_with_recipe(scene, options, None, out)
}

/// As [`write()`]; `recipe` describes how the scene was made from its inputs, in the form of the program that
/// made it, and is stored in the metadata.
///
/// # Errors
/// Those of [`write()`].
pub fn write_with_recipe(
    scene: &Scene,
    options: &SvgOptions,
    recipe: Option<&serde_json::Value>,
    out: impl Write,
) -> io::Result<SvgSummary> {
    if options.fills {
        return fill_tile::write(scene, options, out);
    }
    let document = Document { recipe, ..Document::new(scene, options, 0.0)? };
    summed(document.textons.shared_count(), out, |xml| document.write(xml))
}

/// Writes a scene that tiles as an SVG of any size: a self-contained `<pattern id="texture">`, and a
/// rectangle filled with it. Same scene and options: the same bytes.
///
/// # Errors
/// [`Error::Seams`] for a scene that does not tile along both axes; those of [`write`].
pub fn write_pattern(scene: &Scene, options: &SvgOptions, out: impl Write) -> io::Result<SvgSummary> {
    if !scene.tile.both() {
        return Err(Error::Seams.into());
    }
    let document = Document::new(scene, &SvgOptions { fills: false, ..*options }, BLEED)?;
    summed(document.textons.shared_count(), out, |xml| document.write_pattern(xml))
}

/// Writes a document and returns counts of what was written.
fn summed<W: Write>(
    shared_textons: u64,
    out: W,
    content: impl FnOnce(&mut Xml<W>) -> io::Result<()>,
) -> io::Result<SvgSummary> {
    let program = vtex_base::PROGRAM.strip_prefix("vtex ").unwrap_or_default();
    let mut xml = Xml::new(out, &format!("{BEGINNING}{program} -->\n"));
    let written = content(&mut xml).and_then(|()| xml.finish());
    let (bytes, elements, drawn) = written?;
    let warnings = too_much(drawn).into_iter().collect();
    Ok(SvgSummary { bytes, elements, drawn: drawn.elements, shared_textons, warnings })
}

/// A warning of the programs that are slow with a file or fail to open it, and a remedy; `None` for a small
/// file.
fn too_much(drawn: ViewerLoad) -> Option<String> {
    let ViewerLoad { elements, references } = drawn;
    if elements < SLOW_ELEMENTS && references < MANY_REFERENCES {
        return None;
    }
    let (many, linked) = (elements >= MANY_ELEMENTS, references >= MANY_REFERENCES);
    let [seconds, gigabytes] = INKSCAPE.map(|each| each * elements as f64 / 1e6);
    let mut text = format!(
        "the SVG has {elements} shapes, every <use> followed: Inkscape takes some {seconds:.0} s and \
         {gigabytes:.1} GB of memory to open it"
    );
    if many {
        text.push_str(&format!(", resvg stops at {MANY_ELEMENTS}"));
    }
    if linked {
        text.push_str(&format!(
            ", librsvg stops at {MANY_REFERENCES} references, of which it has {references}"
        ));
    }
    let expand = if linked && !many { " elements written in full," } else { "" };
    Some(
        text + &format!(
            "; lighter files: a smaller canvas,{expand} a limit of bytes, fewer elements, or a PNG"
        ),
    )
}

/// Pixels of CSS for each pixel of the canvas, along x and y, to twelve decimals.
fn stretch(scene: &Scene) -> [f64; 2] {
    let [width, height] = scene.css_size();
    let by = [width / f64::from(scene.width), height / f64::from(scene.height)];
    by.map(|v| libm::round(v * 1e12) / 1e12)
}

/// Width and height of the open `<svg>`, which are those of the page, and its view box, which is the canvas. A canvas
/// that its page stretches by a part of a pixel says so in `preserveAspectRatio`, which browsers, Inkscape, librsvg and
/// resvg follow; coordinates stay those of the canvas, without a transform around the layers.
fn write_page<W: Write>(xml: &mut Xml<W>, scene: &Scene) {
    let Scene { width, height, page, .. } = *scene;
    match page {
        Some([wide, high]) => {
            xml.attribute("width", svg_length(wide));
            xml.attribute("height", svg_length(high));
        }
        None => {
            xml.attribute("width", width);
            xml.attribute("height", height);
        }
    }
    xml.attribute("viewBox", format_args!("0 0 {width} {height}"));
    let [x, y] = stretch(scene);
    if (x / y - 1.0).abs() > 1e-9 {
        xml.attribute("preserveAspectRatio", "none");
    }
}

/// A length as SVG writes it: pixels without a unit, metres, which it lacks, in millimetres.
fn svg_length(length: Length) -> String {
    match length.unit() {
        LengthUnit::Pixel => length.value().to_string(),
        LengthUnit::Metre => format!("{}mm", libm::round(length.value() * 1e9) / 1e6),
        _ => length.to_string(),
    }
}

/// A scene made ready to be written.
struct Document<'a> {
    scene: &'a Scene,
    backgrounds: Vec<NamedField>,
    frames: Vec<LayerGroup>,
    textons: SvgTextons<'a>,
    categories: Vec<SceneCategory>,
    /// Whether categories have style rules.
    css: bool,
    /// Whether individual elements have names in editors.
    names: bool,
    /// Distance by which the content extends beyond the canvas, in pixels.
    bleed: f64,
    /// The recipe in the metadata: how the scene was made.
    recipe: Option<&'a serde_json::Value>,
    /// The motion of elements; `None` if they rest.
    moving: Option<DocumentMotion<'a>>,
}

impl<'a> Document<'a> {
    fn new(scene: &'a Scene, options: &SvgOptions, bleed: f64) -> Result<Self> {
        SvgOptions::PRECISION.check(options.precision)?;
        scene.check()?;
        let categories = crate::categories(scene);
        let textons = SvgTextons::new(scene, &categories, options, bleed);
        let fields = scene.layers.iter().map(|layer| layer.field.as_ref());
        let backgrounds =
            backgrounds(fields.map(|f| f.map(|field| PreparedBackground::new(scene, field))), "b");
        let layers = scene.layers.iter().map(|l| (l.name.as_str(), l.role, l.region.is_some()));
        let frames = LayerGroup::of(layers, scene.domain.as_ref().map(|d| d.edge));
        let (css, names) = (options.css, options.names);
        let (recipe, moving) = (None, None);
        Ok(Self { scene, backgrounds, frames, textons, categories, css, names, bleed, recipe, moving })
    }

    /// Writes the canvas.
    fn write<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        self.begin(xml);
        write_page(xml, self.scene);
        self.textons.ink().begin(xml);
        xml.line();
        self.write_about(xml)?;
        self.write_definitions(xml)?;
        self.write_layers(xml)
    }

    /// Writes a pattern of the canvas, and a rectangle of any size filled with it.
    fn write_pattern<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        self.begin(xml);
        xml.attribute("width", "100%");
        xml.attribute("height", "100%");
        xml.line();
        self.write_about(xml)?;
        self.open_pattern(xml);
        self.textons.ink().begin(xml);
        xml.line();
        self.write_definitions(xml)?;
        self.write_layers(xml)?;
        xml.close()?;
        xml.line();
        xml.open("rect");
        xml.attribute("width", "100%");
        xml.attribute("height", "100%");
        xml.attribute("fill", format_args!("url(#{PATTERN})"));
        xml.close()?;
        xml.line();
        Ok(())
    }

    /// Begins a pattern of the canvas, at the size of its page.
    fn open_pattern<W: Write>(&self, xml: &mut Xml<W>) {
        xml.open("pattern");
        xml.attribute("id", PATTERN);
        xml.attribute("patternUnits", "userSpaceOnUse");
        xml.attribute("width", self.scene.width);
        xml.attribute("height", self.scene.height);
        if self.scene.page.is_some() {
            let [x, y] = stretch(self.scene);
            xml.attribute("patternTransform", format_args!("scale({x} {y})"));
        }
    }

    fn begin<W: Write>(&self, xml: &mut Xml<W>) {
        xml.open("svg");
        xml.attribute("xmlns", "http://www.w3.org/2000/svg");
        xml.attribute("xmlns:xlink", "http://www.w3.org/1999/xlink");
        xml.attribute("xmlns:inkscape", "http://www.inkscape.org/namespaces/inkscape");
    }

    /// Title, metadata and style rules.
    fn write_about<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        let title = crate::title(self.scene);
        let metadata = metadata::json(self.scene, &self.categories, self.recipe);
        for (name, text) in [("title", title), ("metadata", metadata)] {
            xml.open(name);
            xml.text(&text);
            xml.close()?;
            xml.line();
        }
        if self.css {
            xml.open("style");
            xml.raw_text(&css::rules(self.scene, &self.categories))?;
            xml.close()?;
            xml.line();
        }
        Ok(())
    }

    /// Writes the definitions that layers refer to.
    fn write_definitions<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        xml.open("defs");
        xml.line();
        for (background, name) in self.backgrounds.iter().flatten() {
            background.write_definitions(xml, self.bleed, name)?;
        }
        self.textons.write_definitions(xml)?;
        let domain = self.scene.domain.as_ref().map(|d| (layers::DOMAIN, &d.outline));
        let layers = self.scene.layers.iter().zip(&self.frames);
        let regions = layers.filter_map(|(layer, frame)| Some((frame.region()?, layer.region.as_ref()?)));
        for (id, outline) in domain.into_iter().chain(regions) {
            xml.open("clipPath");
            xml.attribute("id", id);
            for shift in self.textons.copies_of(outline.bounds()) {
                self.textons.write_outline(xml, outline, shift)?;
            }
            xml.close()?;
            xml.line();
        }
        xml.close()?;
        xml.line();
        Ok(())
    }

    fn write_layers<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        layers::write(xml, &self.frames, |xml, k| {
            if let Some((background, name)) = self.backgrounds[k].as_ref() {
                background.write_bands(xml, self.bleed, name)?;
            }
            let layer = &self.scene.layers[k];
            let turns = match &self.moving {
                Some(moving) if !layer.instances.is_empty() => moving.begin_turn(xml, self.scene)?,
                _ => false,
            };
            if layer.role.is_individual() {
                self.write_individuals(xml, layer)?;
            } else {
                self.write_compactly(xml, &layer.instances)?;
            }
            if turns {
                xml.close()?;
                xml.line();
            }
            Ok(())
        })
    }

    /// Writes elements without groups of their own.
    fn write_compactly<W: Write>(&self, xml: &mut Xml<W>, instances: &[Instance]) -> io::Result<()> {
        let textons = &self.textons;
        // Neighbours in painting order that share a fill take it from one group.
        let alike = |a: &_, b: &_| textons.fill(a).is_some() && textons.fill(a) == textons.fill(b);
        for run in instances.chunk_by(alike) {
            let fill = textons.fill(&run[0]).filter(|fill| run.len() > 1 && !textons.ink().is(*fill));
            if let Some(fill) = fill {
                xml.open("g");
                xml.attribute("fill", HexColour(fill));
                xml.line();
            }
            for instance in run {
                for shift in textons.copies(instance) {
                    let moves = self.path_of(instance).is_some();
                    if moves {
                        xml.open("g");
                    }
                    self.write_in_group(xml, instance, shift, fill.is_none())?;
                    if moves {
                        xml.close()?;
                    }
                    xml.line();
                }
            }
            if fill.is_some() {
                xml.close()?;
                xml.line();
            }
        }
        Ok(())
    }

    /// The path of an element, unless it rests.
    fn path_of(&self, instance: &Instance) -> Option<AnimatedPath<'_>> {
        self.moving.as_ref().and_then(|moving| moving.path_of(instance))
    }

    /// Writes an element in the open group, which is animated if the element moves.
    fn write_in_group<W: Write>(
        &self,
        xml: &mut Xml<W>,
        instance: &Instance,
        shift: Vec2,
        fill: bool,
    ) -> io::Result<()> {
        match self.path_of(instance) {
            Some(way) => {
                way.write(xml, instance)?;
                self.textons.write_instance(xml, &at_origin(instance), shift, fill)
            }
            None => self.textons.write_instance(xml, instance, shift, fill),
        }
    }

    /// The category of an individual element, as the class of its group, and by name in its label.
    fn write_category<W: Write>(&self, xml: &mut Xml<W>, layer: &Layer, instance: &Instance) {
        let element = self.scene.element(instance);
        let category = class(self.scene, element);
        let predicted = layer.predicted.then(|| Layer::PREDICTED.to_owned());
        let classes: Vec<String> = predicted.into_iter().chain(category).collect();
        if !classes.is_empty() {
            xml.attribute("class", classes.join(" "));
        }
        if layer.predicted {
            xml.attribute("data-vtex-id", instance.id);
        }
        if let Some(name) = self.textons.category_name(element).filter(|_| self.names) {
            xml.attribute("inkscape:label", format_args!("{name} {}", instance.id));
        }
    }

    /// Writes elements, each in a group with its id, and copies of them, by their height.
    fn write_stacked<W: Write>(&self, xml: &mut Xml<W>, layer: &Layer) -> io::Result<()> {
        let copies = |instance| self.textons.copies(instance).map(move |shift| (instance, shift));
        let mut all: Vec<(&Instance, Vec2)> = layer.instances.iter().flat_map(copies).collect();
        all.sort_by_key(|(instance, shift)| self.scene.height(instance, *shift));
        for (instance, shift) in all {
            let copy = (shift != Vec2::ZERO).then(|| (shift, ViewerLoad::default()));
            self.write_individual(xml, (layer, instance), copy)?;
        }
        Ok(())
    }

    /// Writes elements, each in a group with its id, and motifs in groups of these.
    fn write_individuals<W: Write>(&self, xml: &mut Xml<W>, layer: &Layer) -> io::Result<()> {
        if self.scene.is_stacked() {
            return self.write_stacked(xml, layer);
        }
        for run in layer.instances.chunk_by(|a, b| a.motif.is_some() && a.motif == b.motif) {
            let motif = run[0].motif.filter(|_| run.len() > 1);
            if let Some(number) = motif {
                xml.open("g");
                xml.attribute("class", "motif");
                xml.attribute("inkscape:label", format_args!("motif {number}"));
                xml.line();
            }
            self.write_run(xml, (layer, run))?;
            if motif.is_some() {
                xml.close()?;
                xml.line();
            }
        }
        Ok(())
    }

    fn write_run<W: Write>(&self, xml: &mut Xml<W>, (layer, run): (&Layer, &[Instance])) -> io::Result<()> {
        for instance in run {
            let before = xml.drawn();
            let mut original = ViewerLoad::default();
            for (k, shift) in self.textons.copies(instance).enumerate() {
                self.write_individual(xml, (layer, instance), (k > 0).then_some((shift, original)))?;
                if k == 0 {
                    original = xml.drawn().since(before);
                }
            }
        }
        Ok(())
    }

    /// Writes an element, or a shifted copy of it.
    fn write_individual<W: Write>(
        &self,
        xml: &mut Xml<W>,
        (layer, instance): (&Layer, &Instance),
        copy: Option<(Vec2, ViewerLoad)>,
    ) -> io::Result<()> {
        match copy {
            Some((shift, original)) if !self.textons.expands() => {
                xml.open("use");
                xml.attribute("xlink:href", format_args!("#p{}", instance.id));
                self.textons.write_shift(xml, shift);
                xml.follow(original);
            }
            Some((shift, _)) => {
                xml.open("g");
                xml.attribute("data-copy-of", format_args!("p{}", instance.id));
                self.write_category(xml, layer, instance);
                self.textons.write_instance(xml, instance, shift, true)?;
            }
            None => {
                xml.open("g");
                xml.attribute("id", format_args!("p{}", instance.id));
                self.write_category(xml, layer, instance);
                self.write_in_group(xml, instance, Vec2::ZERO, true)?;
            }
        }
        xml.close()?;
        xml.line();
        Ok(())
    }
}

/// The field of a layer, if it has one, and the prefix of its ids.
type NamedField = Option<(PreparedBackground, String)>;

/// The fields of layers. Their ids begin with `name`, followed by a number from the second on.
fn backgrounds(fields: impl Iterator<Item = Option<PreparedBackground>>, name: &str) -> Vec<NamedField> {
    let mut count = 0;
    let mut named = |background: PreparedBackground| {
        count += 1;
        (background, if count > 1 { format!("{name}{count}-") } else { name.to_owned() })
    };
    fields.map(|field| field.map(&mut named)).collect()
}
