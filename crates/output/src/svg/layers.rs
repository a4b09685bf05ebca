//! Layers as groups, which Inkscape shows as layers too.

use super::xml::Xml;
use crate::label;
use std::collections::BTreeSet;
use std::io::{self, Write};
use vtex_scene::scene::{Domain, Edge, Role};

/// Id of the clip path of a domain.
pub(super) const DOMAIN: &str = "domain";

/// The group of a layer.
pub(super) struct LayerGroup {
    id: String,
    label: String,
    /// Whether the domain clips it.
    clipped: bool,
    /// Id of the clip path of its region, if it has one.
    region: Option<String>,
}

impl LayerGroup {
    /// The groups of layers, given by name, role and whether they have a region. `edge` is that of the
    /// domain, if there is one.
    pub(super) fn of<'a>(
        layers: impl Iterator<Item = (&'a str, Role, bool)>,
        edge: Option<Edge>,
    ) -> Vec<Self> {
        let mut known = BTreeSet::new();
        let frame = |(k, (name, role, has_region)): (usize, (&str, Role, bool))| {
            // The id of a layer named after its role is that name; ids of other layers get a prefix.
            let mut id = if name == role.name() { name.to_owned() } else { format!("layer-{}", word(name)) };
            if !known.insert(id.clone()) {
                id.push_str(&format!(".{k}"));
            }
            Self {
                region: has_region.then(|| format!("{id}-region")),
                clipped: edge.is_some_and(|edge| Domain::clips(edge, role)),
                label: label(name),
                id,
            }
        };
        layers.enumerate().map(frame).collect()
    }

    /// Id of the clip path of its region, if it has one.
    pub(super) fn region(&self) -> Option<&str> {
        self.region.as_deref()
    }
}

/// A name as a part of an id.
fn word(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' || c == '_' { c } else { '-' }).collect()
}

/// Writes the groups; consecutive ones that the domain clips lie in one group, so that their common edge is
/// clipped once. `write` fills each, given its index.
pub(super) fn write<W: Write>(
    xml: &mut Xml<W>,
    frames: &[LayerGroup],
    mut write: impl FnMut(&mut Xml<W>, usize) -> io::Result<()>,
) -> io::Result<()> {
    let mut next = 0;
    let mut clips = 0;
    for run in frames.chunk_by(|a, b| a.clipped == b.clipped) {
        if run[0].clipped {
            clips += 1;
            let more = if clips > 1 { format!("-{clips}") } else { String::new() };
            begin(xml, &format!("inside{more}"), "Inside");
            xml.attribute("clip-path", format_args!("url(#{DOMAIN})"));
            xml.line();
        }
        for frame in run {
            begin(xml, &frame.id, &frame.label);
            if let Some(region) = &frame.region {
                xml.attribute("clip-path", format_args!("url(#{region})"));
            }
            xml.line();
            write(xml, next)?;
            next += 1;
            end(xml)?;
        }
        if run[0].clipped {
            end(xml)?;
        }
    }
    Ok(())
}

fn begin<W: Write>(xml: &mut Xml<W>, id: &str, label: &str) {
    xml.open("g");
    xml.attribute("id", id);
    xml.attribute("inkscape:groupmode", "layer");
    xml.attribute("inkscape:label", label);
}

fn end<W: Write>(xml: &mut Xml<W>) -> io::Result<()> {
    xml.close()?;
    xml.line();
    Ok(())
}
