//! Textons in SVG: defined once, or written in place.

use super::SvgOptions;
use super::brushes::Brushes;
use super::gradients::BoxGradient;
use super::ink::InheritedInk;
use super::number::{HexColour, Number, list};
use super::xml::{ViewerLoad, Xml};
use crate::categories::SceneCategory;
use crate::shadow::{self, ShadowOutline, Shadows};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use vtex_base::geometry::{Affine, Outline, PathText, Rect, Vec2, write_path};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Cap, Join, Line, SoftRim};
use vtex_scene::scene::{
    CategoryId, Element, ElementId, Gradient, Instance, LibraryId, Scene, Shadow, Shape, Stroke,
};

/// The textons of a scene and how each is written.
pub(super) struct SvgTextons<'a> {
    scene: &'a Scene,
    precision: u8,
    expand: bool,
    /// Whether definitions are groups instead of symbols, and copies are written one by one.
    fills: bool,
    ink: InheritedInk,
    /// Distance beyond the canvas up to which copies are written, in pixels.
    bleed: f64,
    /// Whether a texton is defined once and placed by reference.
    shared: Vec<bool>,
    /// Whether a shared texton has no colour of its own and takes that of the instance.
    inherits: Vec<bool>,
    /// Bounding boxes; empty if the scene has no copies.
    bounds: Vec<Rect>,
    /// The elements and references that a viewer draws for each definition.
    drawn: Vec<Cell<ViewerLoad>>,
    /// The id of each definition.
    ids: Vec<String>,
    /// Names of categories.
    names: BTreeMap<(LibraryId, CategoryId), String>,
    /// Number of the next gradient.
    gradients: Cell<u64>,
    shadows: Shadows,
    /// Ids of the shadows that are defined once.
    shared_shadows: BTreeMap<shadow::Key, String>,
    /// Whether a texton's bare outline is defined, for lines along it.
    outlined: Vec<bool>,
    brushes: Brushes,
    /// Number of the next clip path around soft ellipses.
    clips: Cell<u64>,
}

/// How the source of an element's first path is stated.
#[derive(Clone, Copy)]
enum PathId {
    /// By the path's own attributes, for an element written in place.
    Source(usize),
    /// By the id of its definition.
    Base(usize),
    Nothing,
}

/// Where the fill of a path is stated.
#[derive(Clone, Copy, PartialEq)]
enum FillPlace {
    /// On the path.
    Path,
    /// On a group around it, so that references to the path may have another.
    Group,
}

/// The paint of an element's outline.
#[derive(Clone, Copy)]
enum Base<'a> {
    /// The paint of its parent.
    Inherited,
    Colour(Colour),
    /// A colour, and the gradient that replaces it.
    Gradient(Colour, &'a Gradient),
}

impl<'a> Base<'a> {
    /// A colour, or the gradient that replaces it.
    fn new((colour, gradient): (Colour, Option<&'a Gradient>)) -> Self {
        gradient.map_or(Self::Colour(colour), |g| Self::Gradient(colour, g))
    }
}

impl<'a> SvgTextons<'a> {
    /// Decides which textons are shared.
    pub(super) fn new(
        scene: &'a Scene,
        categories: &[SceneCategory],
        options: &SvgOptions,
        bleed: f64,
    ) -> Self {
        // A stroked path keeps its paint, unless an instance has a colour of its own.
        let inherits = scene.elements.iter().map(|t| is_bare(t) && t.base().line.is_none()).collect();
        let bounds =
            if scene.tile.any() { scene.elements.iter().map(Element::bounds).collect() } else { Vec::new() };
        let shared = vec![false; scene.elements.len()];
        let SvgOptions { precision, expand, fills, .. } = *options;
        let names = categories.iter().map(|c| ((c.library, c.category), c.name.clone())).collect();
        let (ids, gradients) = (ids(scene), Cell::new(0));
        let drawn = vec![Cell::default(); scene.elements.len()];
        let (shadows, shared_shadows) = (Shadows::new(scene), BTreeMap::new());
        let outlined = vec![false; scene.elements.len()];
        let mut textons = Self {
            scene,
            precision,
            expand,
            fills,
            ink: InheritedInk::new(scene, options),
            bleed,
            shared,
            inherits,
            bounds,
            drawn,
            ids,
            names,
            gradients,
            shadows,
            shared_shadows,
            outlined,
            brushes: Brushes::new(scene, precision),
            clips: Cell::new(0),
        };
        let mut uses = vec![0; scene.elements.len()];
        let mut shadow_uses: BTreeMap<shadow::Key, usize> = BTreeMap::new();
        let mut outlined = textons.outlined.clone();
        // Copies of individual elements refer to their original as a whole.
        let counted = scene.layers.iter().flat_map(|layer| {
            layer.instances.iter().map(|i| {
                let count = if layer.role.is_individual() && !fills { 1 } else { textons.copies(i).count() };
                (i, count)
            })
        });
        for (instance, count) in counted {
            uses[instance.element.index()] += count;
            if let Some(shadow) = &instance.shadow {
                *shadow_uses.entry(shadow::key(instance, shadow)).or_insert(0) += count;
            }
            outlined[instance.element.index()] |= instance.stroke.is_some();
        }
        for instance in scene.instances() {
            textons.inherits[instance.element.index()] |= instance.colour.is_some();
        }
        let is_shared =
            |(element, &uses): (&Element, &usize)| uses > 1 && !expand && !element.base().is_soft();
        textons.shared = scene.elements.iter().zip(&uses).map(is_shared).collect();
        // A definition that is a plain path is its own outline.
        let is_plain = |i: usize| is_bare(&scene.elements[i]) && textons.inherits[i];
        let with_line = |(i, asked): (usize, bool)| asked && textons.shared[i] && !is_plain(i);
        textons.outlined = outlined.into_iter().enumerate().map(with_line).collect();
        let many = shadow_uses.into_iter().filter(|(_, n)| *n > 1 && !expand);
        let mut numbers: BTreeMap<ElementId, u32> = BTreeMap::new();
        for (key, _) in many {
            let number = numbers.entry(key.0).or_insert(0);
            *number += 1;
            let more = if *number > 1 { number.to_string() } else { String::new() };
            textons.shared_shadows.insert(key, format!("{}s{more}", textons.ids[key.0.index()]));
        }
        textons
    }

    /// The shifts of the copies of an instance that are written, that of the original first.
    pub(super) fn copies(&self, instance: &Instance) -> impl Iterator<Item = Vec2> + use<> {
        let bounds = self.bounds.get(instance.element.index()).copied().unwrap_or_default();
        self.copies_of(instance.reach(bounds))
    }

    /// The shifts of the copies of any content with the given bounds on the canvas.
    pub(super) fn copies_of(&self, bounds: Rect) -> impl Iterator<Item = Vec2> + use<> {
        // Rounding may move an outline by as much as the last digit.
        let reach = self.bleed + 1.0 / f64::from(10u32.pow(self.precision.into()));
        self.scene.copies(bounds.inflate(reach, reach))
    }

    /// The ink of all textons, if they have one.
    pub(super) fn ink(&self) -> InheritedInk {
        self.ink
    }

    /// The name of an element's category, if it has one.
    pub(super) fn category_name(&self, element: &Element) -> Option<&str> {
        self.names.get(&(element.library, element.category?)).map(String::as_str)
    }

    /// Whether every texton is written in full at each place.
    pub(super) fn expands(&self) -> bool {
        self.expand
    }

    /// Number of textons that are defined once.
    pub(super) fn shared_count(&self) -> u64 {
        self.shared.iter().filter(|s| **s).count() as u64
    }

    /// The shared textons, for `<defs>`.
    pub(super) fn write_definitions<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        self.brushes.write_definitions(xml)?;
        for (key, layers) in self.shadows.all() {
            if let Some(id) = self.shared_shadows.get(&key) {
                self.write_shadow(xml, layers, None, Some(id))?;
                xml.line();
            }
        }
        for (i, element) in self.scene.elements.iter().enumerate().filter(|(i, _)| self.shared[*i]) {
            if self.outlined[i] {
                xml.open("path");
                xml.attribute("id", format_args!("{}o", self.ids[i]));
                xml.attribute("d", self.data(element.outline(), None));
                xml.close()?;
                xml.line();
            }
            let id = &self.ids[i];
            if self.inherits[i]
                && let Some(gradient) = self.base_gradient(element)
            {
                gradient.write(xml, format_args!("{id}g"))?;
                xml.line();
            }
            let before = xml.drawn();
            if is_bare(element) && self.inherits[i] {
                xml.open("path");
                xml.attribute("id", id);
                write_opacity(xml, element.base());
                xml.attribute("d", self.data(&element.base().outline, None));
                xml.close()?;
            } else {
                self.open_symbol(xml, i)?;
                let base = if self.inherits[i] { Base::Inherited } else { Base::new(element.paint(None)) };
                self.write_paths(xml, i, base, None)?;
                xml.close()?;
            }
            self.drawn[i].set(xml.drawn().since(before));
            xml.line();
        }
        Ok(())
    }

    /// Begins the definition of a texton of several paths.
    fn open_symbol<W: Write>(&self, xml: &mut Xml<W>, index: usize) -> io::Result<()> {
        if self.fills {
            xml.open("g");
            xml.attribute("id", &self.ids[index]);
            return Ok(());
        }
        let element = &self.scene.elements[index];
        xml.open("symbol");
        xml.attribute("id", &self.ids[index]);
        xml.attribute("overflow", "visible");
        xml.open("title");
        xml.text(&title(element, self.category_name(element)));
        xml.close()
    }

    /// Writes the source of a texton that is written in place. Otherwise its id tells the source, but an id
    /// cannot occur several times.
    fn write_source<W: Write>(&self, xml: &mut Xml<W>, index: usize) {
        if !self.expand {
            return xml.attribute("id", &self.ids[index]);
        }
        let element = &self.scene.elements[index];
        if let Some(source) = element.source {
            xml.attribute("data-source", source.0);
        }
        if self.scene.libraries.len() > 1 {
            xml.attribute("data-library", element.library);
        }
    }

    /// The single colour of a placed texton; `None` if it has details, a rim or a gradient, or is soft.
    pub(super) fn fill(&self, instance: &Instance) -> Option<Colour> {
        let element = self.scene.element(instance);
        let one = is_bare(element)
            && !element.base().is_soft()
            && (element.base().gradient.is_none() || instance.colour.is_some());
        one.then(|| instance.colour.unwrap_or(element.base().colour))
    }

    /// One placed texton, moved by `shift`; its fill is left to the group around it unless
    /// `with_fill`.
    pub(super) fn write_instance<W: Write>(
        &self,
        xml: &mut Xml<W>,
        instance: &Instance,
        shift: Vec2,
        with_fill: bool,
    ) -> io::Result<()> {
        let index = instance.element.index();
        let base = Base::new(self.scene.elements[index].paint(instance.colour));
        let affine = instance.affine().then_translate(shift);
        if let Some(shadow) = &instance.shadow {
            self.write_shadow_of(xml, instance, shadow, affine)?;
        }
        let element = &self.scene.elements[index];
        if let Some((ellipse, colour)) = element.spot(instance.colour) {
            self.brushes.write(xml, ellipse, (colour, element.base().opacity), affine)?;
        } else if !self.shared[index] {
            let base = if with_fill { base } else { Base::Inherited };
            self.write_paths(xml, index, base, Some(affine))?;
        } else {
            self.write_use(xml, index, base, affine, with_fill)?;
        }
        instance.stroke.map_or(Ok(()), |stroke| self.write_stroke(xml, index, stroke, affine))
    }

    /// A shared texton in its place.
    fn write_use<W: Write>(
        &self,
        xml: &mut Xml<W>,
        index: usize,
        base: Base<'_>,
        affine: Affine,
        with_fill: bool,
    ) -> io::Result<()> {
        let element = &self.scene.elements[index];
        xml.open("use");
        xml.attribute("xlink:href", format_args!("#{}", self.ids[index]));
        self.write_transform(xml, &affine.as_coeffs());
        xml.follow(self.drawn[index].get());
        if self.inherits[index] && with_fill {
            match base {
                Base::Gradient(..) if self.base_gradient(element).is_some() => {
                    xml.attribute("fill", format_args!("url(#{}g)", self.ids[index]));
                }
                // References to a definition are in no group with another fill.
                Base::Gradient(colour, _) | Base::Colour(colour) if self.ink.is(colour) => (),
                Base::Gradient(colour, _) | Base::Colour(colour) => {
                    xml.attribute("fill", HexColour(colour));
                }
                Base::Inherited => (),
            }
        }
        xml.close()
    }

    /// The shadow of an instance that `affine` brings to its place.
    fn write_shadow_of<W: Write>(
        &self,
        xml: &mut Xml<W>,
        instance: &Instance,
        shadow: &Shadow,
        affine: Affine,
    ) -> io::Result<()> {
        let affine = affine.then_translate(shadow.shift());
        let Some(id) = self.shared_shadows.get(&shadow::key(instance, shadow)) else {
            return self.write_shadow(xml, self.shadows.of(instance, shadow), Some(affine), None);
        };
        xml.open("use");
        xml.attribute("xlink:href", format_args!("#{id}"));
        self.write_transform(xml, &affine.as_coeffs());
        let layers = self.shadows.of(instance, shadow).len() as u64;
        xml.follow(ViewerLoad { elements: 1 + layers, references: 0 });
        xml.close()
    }

    /// The layers of a shadow, moved by `affine`.
    fn write_shadow<W: Write>(
        &self,
        xml: &mut Xml<W>,
        layers: &[ShadowOutline],
        affine: Option<Affine>,
        id: Option<&str>,
    ) -> io::Result<()> {
        xml.open("g");
        if let Some(id) = id {
            xml.attribute("id", id);
        }
        xml.attribute("class", "shadow");
        xml.attribute("fill", HexColour(Colour([0; 3])));
        for layer in layers {
            xml.open("path");
            xml.attribute("fill-opacity", Number(layer.opacity, 4));
            xml.attribute("d", self.data(&layer.outline, affine));
            xml.close()?;
        }
        xml.close()
    }

    /// The line along the outline of a texton that `affine` brings to its place.
    fn write_stroke<W: Write>(
        &self,
        xml: &mut Xml<W>,
        index: usize,
        stroke: Stroke,
        affine: Affine,
    ) -> io::Result<()> {
        let width = if self.shared[index] {
            xml.open("use");
            let line = if self.outlined[index] { "o" } else { "" };
            xml.attribute("xlink:href", format_args!("#{}{line}", self.ids[index]));
            self.write_transform(xml, &affine.as_coeffs());
            xml.follow(ViewerLoad { elements: 1, references: 0 });
            stroke.width
        } else {
            xml.open("path");
            xml.attribute("d", self.data(self.scene.elements[index].outline(), Some(affine)));
            stroke.width * libm::sqrt(affine.determinant().abs())
        };
        xml.attribute("class", "outline");
        xml.attribute("fill", "none");
        self.ink.paint(xml, "stroke", stroke.colour);
        xml.attribute("stroke-width", Number(width, 2));
        xml.attribute("stroke-linejoin", "round");
        xml.close()
    }

    /// The gradient of a texton's outline where it is defined.
    fn base_gradient<'e>(&self, element: &'e Element) -> Option<BoxGradient<'e>> {
        BoxGradient::new(
            element.base().gradient.as_deref()?,
            Affine::IDENTITY,
            element.base().outline.bounds(),
        )
    }

    /// The paths of a texton, moved by `affine`.
    fn write_paths<W: Write>(
        &self,
        xml: &mut Xml<W>,
        index: usize,
        base: Base<'_>,
        affine: Option<Affine>,
    ) -> io::Result<()> {
        let element = &self.scene.elements[index];
        let is_clipped = element.details().iter().any(Shape::is_soft);
        let rim = element.base().rim.as_deref();
        let id = match affine {
            Some(_) => PathId::Source(index),
            // A definition has its id already.
            None if is_clipped || rim.is_some() => PathId::Base(index),
            None => PathId::Nothing,
        };
        let place = if rim.is_some() && !self.expand { FillPlace::Group } else { FillPlace::Path };
        self.write_filled(xml, element.base(), (base, place), affine, id)?;
        let clip = is_clipped.then(|| self.write_clip(xml, index, affine)).transpose()?;
        for run in element.details().chunk_by(|a, b| a.is_soft() == b.is_soft()) {
            if let Some(clip) = clip.filter(|_| run[0].is_soft()) {
                xml.open("g");
                xml.attribute("clip-path", format_args!("url(#c{clip})"));
                for shape in run {
                    if let Some(ellipse) = &shape.ellipse {
                        let paint = (shape.colour, shape.opacity);
                        self.brushes.write(xml, ellipse, paint, affine.unwrap_or_default())?;
                    }
                }
                xml.close()?;
                continue;
            }
            for shape in run {
                let fill = Base::new((shape.colour, shape.gradient.as_deref()));
                self.write_filled(xml, shape, (fill, FillPlace::Path), affine, PathId::Nothing)?;
            }
        }
        rim.map_or(Ok(()), |rim| self.write_rim(xml, index, rim, affine))
    }

    /// The strokes of a soft rim along an element's first shape, moved by `affine`.
    fn write_rim<W: Write>(
        &self,
        xml: &mut Xml<W>,
        index: usize,
        rim: &SoftRim,
        affine: Option<Affine>,
    ) -> io::Result<()> {
        let size = affine.map_or(1.0, |affine| libm::sqrt(affine.determinant().abs()));
        xml.open("g");
        xml.attribute("class", "rim");
        xml.attribute("fill", "none");
        self.ink.paint(xml, "stroke", rim.colour);
        xml.attribute("stroke-linejoin", "round");
        for [width, opacity] in rim.strokes() {
            xml.open(if self.expand { "path" } else { "use" });
            if !self.expand {
                xml.attribute("xlink:href", format_args!("#{}", self.base_id(index, affine)));
                xml.follow(ViewerLoad { elements: 1, references: 0 });
            }
            xml.attribute("stroke-width", Number(width * size, 2));
            xml.attribute("stroke-opacity", Number(opacity, 2));
            if self.expand {
                xml.attribute("d", self.data(&self.scene.elements[index].base().outline, affine));
            }
            xml.close()?;
        }
        xml.close()
    }

    /// The id of an element's first path: that of the element where it is written in place, moved by `affine`, or its own
    /// in a definition.
    fn base_id(&self, index: usize, affine: Option<Affine>) -> String {
        let suffix = if affine.is_some() { "" } else { "b" };
        format!("{}{suffix}", self.ids[index])
    }

    /// The clip path of an element's soft ellipses: its first shape. Gives its number.
    fn write_clip<W: Write>(
        &self,
        xml: &mut Xml<W>,
        index: usize,
        affine: Option<Affine>,
    ) -> io::Result<u64> {
        let number = self.clips.get();
        self.clips.set(number + 1);
        xml.open("clipPath");
        xml.attribute("id", format_args!("c{number}"));
        if self.expand {
            xml.open("path");
            xml.attribute("d", self.data(&self.scene.elements[index].base().outline, affine));
        } else {
            xml.open("use");
            xml.attribute("xlink:href", format_args!("#{}", self.base_id(index, affine)));
            xml.follow(ViewerLoad { elements: 1, references: 0 });
        }
        xml.close()?;
        xml.close()?;
        Ok(number)
    }

    /// A path, moved by `affine`, after the gradient that fills it; the first of a texton written in
    /// place names its source.
    fn write_filled<W: Write>(
        &self,
        xml: &mut Xml<W>,
        shape: &Shape,
        (fill, place): (Base<'_>, FillPlace),
        affine: Option<Affine>,
        path_id: PathId,
    ) -> io::Result<()> {
        let mut id = None;
        if let Base::Gradient(_, gradient) = fill {
            let moved = affine.unwrap_or_default();
            if let Some(gradient) = BoxGradient::new(gradient, moved, shape.outline.bounds_after(moved)) {
                let number = self.gradients.get();
                self.gradients.set(number + 1);
                gradient.write(xml, format_args!("g{number}"))?;
                id = Some(number);
            }
        }
        let in_group = place == FillPlace::Group;
        xml.open(if in_group { "g" } else { "path" });
        if !in_group {
            self.write_path_id(xml, path_id);
        }
        // A shape that takes its paint from elsewhere is filled.
        let line = shape.line.as_ref().filter(|_| !matches!(fill, Base::Inherited));
        let kind = if line.is_some() { "stroke" } else { "fill" };
        match (fill, id) {
            (_, Some(number)) => xml.attribute(kind, format_args!("url(#g{number})")),
            (Base::Colour(colour) | Base::Gradient(colour, _), None) => self.ink.paint(xml, kind, colour),
            (Base::Inherited, None) => (),
        }
        if in_group {
            xml.open("path");
            self.write_path_id(xml, path_id);
        }
        match line {
            Some(line) => self.write_line(xml, line, shape.opacity, affine),
            None => {
                write_opacity(xml, shape);
                xml.attribute("d", self.data(&shape.outline, affine));
            }
        }
        if in_group {
            xml.close()?;
        }
        xml.close()
    }

    /// What a path's id states of its source.
    fn write_path_id<W: Write>(&self, xml: &mut Xml<W>, path_id: PathId) {
        match path_id {
            PathId::Source(index) => self.write_source(xml, index),
            PathId::Base(index) => xml.attribute("id", format_args!("{}b", self.ids[index])),
            PathId::Nothing => (),
        }
    }

    /// All attributes of a stroked path but its paint.
    fn write_line<W: Write>(&self, xml: &mut Xml<W>, line: &Line, opacity: f64, affine: Option<Affine>) {
        let affine = affine.unwrap_or_default();
        let size = libm::sqrt(affine.determinant().abs());
        let length = |v: f64| Number(v * size, self.precision + 1);
        xml.attribute("fill", "none");
        if opacity < 1.0 {
            xml.attribute("stroke-opacity", Number(opacity, 4));
        }
        xml.attribute("stroke-width", length(line.width));
        match line.cap {
            Cap::Butt => (),
            Cap::Round => xml.attribute("stroke-linecap", "round"),
            Cap::Square => xml.attribute("stroke-linecap", "square"),
        }
        match line.join {
            Join::Miter if line.miter_limit != 4.0 => {
                xml.attribute("stroke-miterlimit", Number(line.miter_limit, 2));
            }
            Join::Miter => (),
            Join::Round => xml.attribute("stroke-linejoin", "round"),
            Join::Bevel => xml.attribute("stroke-linejoin", "bevel"),
        }
        if !line.dashes.is_empty() {
            let dashes: Vec<Number> = line.dashes.iter().map(|d| length(*d)).collect();
            xml.attribute("stroke-dasharray", list(&dashes));
            if line.dash_offset != 0.0 {
                xml.attribute("stroke-dashoffset", length(line.dash_offset));
            }
        }
        let style = PathText { precision: self.precision };
        xml.attribute("d", write_path(&(affine * line.path.path()), style));
    }

    /// A bare outline, moved by `shift`.
    pub(super) fn write_outline<W: Write>(
        &self,
        xml: &mut Xml<W>,
        outline: &Outline,
        shift: Vec2,
    ) -> io::Result<()> {
        xml.open("path");
        xml.attribute("d", self.data(outline, Some(Affine::translate(shift))));
        xml.close()
    }

    fn data(&self, outline: &Outline, affine: Option<Affine>) -> String {
        let style = PathText { precision: self.precision };
        match affine {
            Some(affine) => write_path(&(affine * outline.path()), style),
            None => write_path(outline.path(), style),
        }
    }

    /// `x` and `y` for a mere shift, which is shorter than a transform; else a matrix, its linear
    /// part with two digits more because it is multiplied by coordinates.
    fn write_transform<W: Write>(&self, xml: &mut Xml<W>, m: &[f64; 6]) {
        let [a, b, c, d, e, f] = *m;
        let length = |v: f64| Number(v, self.precision);
        if [a, b, c, d] == [1.0, 0.0, 0.0, 1.0] {
            self.write_shift(xml, Vec2::new(e, f));
        } else {
            let fine = |v: f64| Number(v, self.precision + 2);
            let numbers = [fine(a), fine(b), fine(c), fine(d), length(e), length(f)];
            xml.attribute("transform", format_args!("matrix({})", list(&numbers)));
        }
    }

    /// `x` and `y` of a `<use>`.
    pub(super) fn write_shift<W: Write>(&self, xml: &mut Xml<W>, shift: Vec2) {
        for (name, v) in [("x", shift.x), ("y", shift.y)] {
            if v != 0.0 {
                xml.attribute(name, Number(v, self.precision));
            }
        }
    }
}

/// Whether an element is its first shape alone.
fn is_bare(element: &Element) -> bool {
    element.details().is_empty() && element.base().rim.is_none()
}

/// The opacity of a shape, if it is not opaque.
fn write_opacity<W: Write>(xml: &mut Xml<W>, shape: &Shape) {
    if shape.opacity < 1.0 {
        xml.attribute("fill-opacity", Number(shape.opacity, 4));
    }
}

/// An id for each element: `t` of one with a category, `f` of a fused one or `s` of one without, its index in
/// its library, and `-` with the number of the library where there are several. If two would have the same
/// id, the later ones get `.` and their index appended.
fn ids(scene: &Scene) -> Vec<String> {
    let mut known = BTreeSet::new();
    let id = |(i, e): (usize, &Element)| {
        let kind = match e.category {
            Some(_) if e.fused => 'f',
            Some(_) => 't',
            None => 's',
        };
        let source = e.source.map_or(String::new(), |source| source.0.to_string());
        let mut id = format!("{kind}{source}");
        if scene.libraries.len() > 1 {
            id.push_str(&format!("-{}", e.library));
        }
        if source.is_empty() || !known.insert((kind, source, e.library)) {
            id.push_str(&format!(".{i}"));
        }
        id
    };
    scene.elements.iter().enumerate().map(id).collect()
}

/// The title of an element among the symbols of an editor.
fn title(element: &Element, category_name: Option<&str>) -> String {
    let part = if element.fused { "Made of element" } else { "Element" };
    let number = element.source.map_or(String::new(), |source| format!(" {}", source.0));
    let category = element.category.map_or(String::new(), |c| format!(", category {c}"));
    let name = category_name.map_or(String::new(), |name| format!(" ({name})"));
    format!("{part}{number}{category}{name}")
}
