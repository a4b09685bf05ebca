//! Textons in SVG: defined once, or written where they stand.

use super::SvgOptions;
use super::number::{Number, Paint, list};
use super::xml::Xml;
use crate::geometry::{Affine, Outline, PathText, Rect, Vec2, write_path};
use crate::raster::colour::Colour;
use crate::scene::{Instance, Scene, Texton};
use std::collections::BTreeSet;
use std::io::{self, Write};

/// The textons of a scene and how each is written.
pub(super) struct Textons<'a> {
    scene: &'a Scene,
    precision: u8,
    expand: bool,
    /// How far beyond the canvas copies are written, in pixels.
    bleed: f64,
    /// Whether a texton is defined once and placed by reference.
    shared: Vec<bool>,
    /// Whether a shared texton has no colour of its own and takes that of the instance.
    inherits: Vec<bool>,
    /// Bounding boxes; none where nothing is copied.
    bounds: Vec<Rect>,
    /// What each is called where it is defined.
    ids: Vec<String>,
}

impl<'a> Textons<'a> {
    /// Decides which textons are shared.
    pub(super) fn new(scene: &'a Scene, options: &SvgOptions, bleed: f64) -> Self {
        let inherits = scene.textons.iter().map(|t| t.details.is_empty()).collect();
        let bounds =
            if scene.tile.any() { scene.textons.iter().map(Texton::bounds).collect() } else { Vec::new() };
        let shared = vec![false; scene.textons.len()];
        let SvgOptions { precision, expand } = *options;
        let ids = ids(scene);
        let mut textons = Self { scene, precision, expand, bleed, shared, inherits, bounds, ids };
        let mut uses = vec![0; scene.textons.len()];
        // Copies of primaries refer to their original as a whole.
        let secondary = scene.secondary.iter().map(|i| (i, textons.copies(i).count()));
        for (instance, count) in secondary.chain(scene.primary.iter().map(|i| (i, 1))) {
            uses[instance.texton as usize] += count;
        }
        for instance in scene.secondary.iter().chain(&scene.primary) {
            textons.inherits[instance.texton as usize] |= instance.colour.is_some();
        }
        textons.shared = uses.iter().map(|&n| n > 1 && !expand).collect();
        textons
    }

    /// The shifts at which an instance is to be written, that of the original first.
    pub(super) fn copies(&self, instance: &Instance) -> impl Iterator<Item = Vec2> + use<> {
        let bounds = self.bounds.get(instance.texton as usize).copied().unwrap_or_default();
        self.copies_of(instance.affine().transform_rect_bbox(bounds))
    }

    /// The same of anything with the given bounds on the canvas.
    pub(super) fn copies_of(&self, bounds: Rect) -> impl Iterator<Item = Vec2> + use<> {
        // Rounding may move an outline by as much as the last digit.
        let reach = self.bleed + 1.0 / f64::from(10u32.pow(self.precision.into()));
        self.scene.copies(bounds.inflate(reach, reach))
    }

    /// Whether every texton is written in full where it stands.
    pub(super) fn expands(&self) -> bool {
        self.expand
    }

    /// Number of textons that are defined once.
    pub(super) fn shared_count(&self) -> u64 {
        self.shared.iter().filter(|s| **s).count() as u64
    }

    /// The shared textons, for `<defs>`.
    pub(super) fn write_definitions<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        for (i, texton) in self.scene.textons.iter().enumerate().filter(|(i, _)| self.shared[*i]) {
            let id = &self.ids[i];
            if texton.details.is_empty() {
                xml.open("path");
                xml.attribute("id", id);
                xml.attribute("d", self.data(&texton.outline, None));
                xml.close()?;
            } else {
                xml.open("symbol");
                xml.attribute("id", id);
                xml.attribute("overflow", "visible");
                xml.open("title");
                xml.text(&title(texton));
                xml.close()?;
                let own = (!self.inherits[i]).then_some(texton.colour);
                self.write_paths(xml, texton, own, None)?;
                xml.close()?;
            }
            xml.line();
        }
        Ok(())
    }

    /// Where a texton comes from, as its id says it where it has one.
    fn write_source<W: Write>(&self, xml: &mut Xml<W>, texton: &Texton) {
        xml.attribute("data-source", texton.source);
        if self.scene.libraries.len() > 1 {
            xml.attribute("data-library", texton.library);
        }
    }

    /// The one fill of a placed texton; none if it has details.
    pub(super) fn fill(&self, instance: &Instance) -> Option<Colour> {
        let texton = &self.scene.textons[instance.texton as usize];
        texton.details.is_empty().then(|| instance.colour.unwrap_or(texton.colour))
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
        let index = instance.texton as usize;
        let texton = &self.scene.textons[index];
        let colour = instance.colour.unwrap_or(texton.colour);
        let affine = instance.affine().then_translate(shift);
        if !self.shared[index] {
            let fill = with_fill.then_some(colour);
            return self.write_paths(xml, texton, fill, Some(affine));
        }
        xml.open("use");
        xml.attribute("xlink:href", format_args!("#{}", self.ids[index]));
        self.write_transform(xml, &affine.as_coeffs());
        if self.inherits[index] && with_fill {
            xml.attribute("fill", Paint(colour));
        }
        xml.close()
    }

    /// The paths of a texton, moved by `affine`. Without a colour the base takes its parent's.
    fn write_paths<W: Write>(
        &self,
        xml: &mut Xml<W>,
        texton: &Texton,
        colour: Option<Colour>,
        affine: Option<Affine>,
    ) -> io::Result<()> {
        let base = std::iter::once((&texton.outline, colour));
        let paths = base.chain(texton.details.iter().map(|p| (&p.outline, Some(p.colour))));
        for (i, (outline, colour)) in paths.enumerate() {
            xml.open("path");
            // A definition says it by its id.
            if i == 0 && affine.is_some() {
                self.write_source(xml, texton);
            }
            if let Some(colour) = colour {
                xml.attribute("fill", Paint(colour));
            }
            xml.attribute("d", self.data(outline, affine));
            xml.close()?;
        }
        Ok(())
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

/// An id for each texton: `t` of a primary or `s` of a secondary, its index in its library, and
/// `-` with the number of the library where there are several. In a scene in which two are called
/// alike, the later ones have `.` and their index after it.
fn ids(scene: &Scene) -> Vec<String> {
    let mut known = BTreeSet::new();
    let id = |(i, t): (usize, &Texton)| {
        let mut id = format!("{}{}", if t.category.is_some() { 't' } else { 's' }, t.source);
        if scene.libraries.len() > 1 {
            id.push_str(&format!("-{}", t.library));
        }
        if !known.insert((t.category.is_some(), t.source, t.library)) {
            id.push_str(&format!(".{i}"));
        }
        id
    };
    scene.textons.iter().enumerate().map(id).collect()
}

/// What editors call a texton among their symbols.
fn title(texton: &Texton) -> String {
    match texton.category {
        Some(category) => format!("Primary {}, category {category}", texton.source),
        None => format!("Secondary {}", texton.source),
    }
}
