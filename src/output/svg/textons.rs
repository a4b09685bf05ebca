//! Textons in SVG: defined once, or written where they stand.

use super::SvgOptions;
use super::number::{Number, Paint, list};
use super::xml::Xml;
use crate::geometry::{Affine, Outline, PathText, write_path};
use crate::raster::colour::Colour;
use crate::scene::{Instance, Scene, Texton};
use std::io::{self, Write};

/// The textons of a scene and how each is written.
pub(super) struct Textons<'a> {
    scene: &'a Scene,
    precision: u8,
    /// Whether a texton is defined once and placed by reference.
    shared: Vec<bool>,
    /// Whether a shared texton has no colour of its own and takes that of the instance.
    inherits: Vec<bool>,
}

impl<'a> Textons<'a> {
    /// Decides which textons are shared.
    pub(super) fn new(scene: &'a Scene, options: &SvgOptions) -> Self {
        let mut uses = vec![0u32; scene.textons.len()];
        let mut inherits: Vec<bool> = scene.textons.iter().map(|t| t.details.is_empty()).collect();
        for instance in scene.secondary.iter().chain(&scene.primary) {
            let texton = instance.texton as usize;
            uses[texton] += 1;
            inherits[texton] |= instance.colour.is_some();
        }
        let shared = uses.iter().map(|&n| n > 1 && !options.expand).collect();
        Self { scene, precision: options.precision, shared, inherits }
    }

    /// Number of textons that are defined once.
    pub(super) fn shared_count(&self) -> u64 {
        self.shared.iter().filter(|s| **s).count() as u64
    }

    /// The shared textons, for `<defs>`.
    pub(super) fn write_definitions<W: Write>(&self, xml: &mut Xml<W>) -> io::Result<()> {
        for (i, texton) in self.scene.textons.iter().enumerate().filter(|(i, _)| self.shared[*i]) {
            let id = format_args!("t{i}");
            if texton.details.is_empty() {
                xml.open("path");
                xml.attribute("id", id);
                xml.attribute("d", self.data(&texton.outline, None));
                xml.close()?;
            } else {
                xml.open("symbol");
                xml.attribute("id", id);
                xml.attribute("overflow", "visible");
                let own = (!self.inherits[i]).then_some(texton.colour);
                self.write_paths(xml, texton, own, None)?;
                xml.close()?;
            }
            xml.line();
        }
        Ok(())
    }

    /// The one fill of a placed texton; none if it has details.
    pub(super) fn fill(&self, instance: &Instance) -> Option<Colour> {
        let texton = &self.scene.textons[instance.texton as usize];
        texton.details.is_empty().then(|| instance.colour.unwrap_or(texton.colour))
    }

    /// One placed texton; its fill is left to the group around it unless `with_fill`.
    pub(super) fn write_instance<W: Write>(
        &self,
        xml: &mut Xml<W>,
        instance: &Instance,
        with_fill: bool,
    ) -> io::Result<()> {
        let index = instance.texton as usize;
        let texton = &self.scene.textons[index];
        let colour = instance.colour.unwrap_or(texton.colour);
        if !self.shared[index] {
            let fill = with_fill.then_some(colour);
            return self.write_paths(xml, texton, fill, Some(instance.affine()));
        }
        xml.open("use");
        xml.attribute("xlink:href", format_args!("#t{index}"));
        self.write_transform(xml, &instance.transform);
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
        for (outline, colour) in base.chain(texton.details.iter().map(|p| (&p.outline, Some(p.colour)))) {
            xml.open("path");
            if let Some(colour) = colour {
                xml.attribute("fill", Paint(colour));
            }
            xml.attribute("d", self.data(outline, affine));
            xml.close()?;
        }
        Ok(())
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
            for (name, v) in [("x", e), ("y", f)] {
                if v != 0.0 {
                    xml.attribute(name, length(v));
                }
            }
        } else {
            let fine = |v: f64| Number(v, self.precision + 2);
            let numbers = [fine(a), fine(b), fine(c), fine(d), length(e), length(f)];
            xml.attribute("transform", format_args!("matrix({})", list(&numbers)));
        }
    }
}
