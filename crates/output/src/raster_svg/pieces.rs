//! A large SVG as a sequence of small ones that make the same picture when they are drawn in turn.
//!
//! The parser follows every `<use>` and holds the result, so it does not accept large files. The children of
//! the root, and of plain groups, can be drawn one after another; each piece gets the definitions that it
//! refers to. A group that is clipped becomes a layer of its own, so that its edge is cut once.

use resvg::usvg::roxmltree::{Document, Node};
use std::collections::{BTreeSet, HashMap};
use vtex_drawing::svg_tree::{ids, referred, uses, weights};

/// Elements of a piece, with every `<use>` followed: a fifth of what the parser accepts.
const PIECE: u64 = 200_000;
/// Greatest depth at which groups are split. Deeper groups are drawn as a whole, and the parser refuses those
/// that are too large.
const DEEPEST: usize = 32;

/// Attributes that paint the shapes of a clip path independently of their surroundings.
const CLIP: &str =
    "<g fill=\"#fff\" fill-opacity=\"1\" fill-rule=\"nonzero\" stroke=\"none\" visibility=\"visible\">";

/// The purpose of a piece of an SVG.
pub(super) enum PiecePurpose {
    /// An SVG to be drawn over the topmost layer, with its number of elements.
    Draw { text: String, weight: u64 },
    /// A layer begins.
    Open,
    /// The layer ends; it is visible only where this SVG is opaque.
    Close(String),
}

/// An SVG and how large its parts are.
pub(super) struct SvgPieces<'a> {
    text: &'a str,
    document: &'a Document<'a>,
    ids: HashMap<&'a str, Node<'a, 'a>>,
    /// Elements in each node with every `<use>` followed, by the number of the node.
    weights: Vec<u64>,
}

/// The part of a document around some siblings: tags before and after them.
struct EnclosingTags {
    before: String,
    after: String,
    /// Groups opened within the root.
    depth: usize,
}

impl<'a> SvgPieces<'a> {
    pub(super) fn new(text: &'a str, document: &'a Document<'a>) -> Self {
        let ids = ids(document);
        let weights = weights(document, &uses(document, &ids));
        Self { text, document, ids, weights }
    }

    /// Elements of the whole, with every `<use>` followed.
    pub(super) fn weight(&self) -> u64 {
        self.weights[self.document.root().id().get_usize()]
    }

    /// Whether it is to be drawn in several pieces: it is large, and nothing in it depends on the whole
    /// document.
    pub(super) fn several(&self) -> bool {
        let root = self.document.root_element();
        // A length in per cent of an unknown size is taken from the content.
        let given = |name: &str| root.attribute(name).is_some_and(|v| !v.trim().ends_with('%'));
        let sized = root.has_attribute("viewBox") || given("width") && given("height");
        let style = |n: Node<'_, '_>| n.tag_name().name() == "style";
        self.weight() > PIECE
            && sized
            && self.text[root.range().start..].starts_with("<svg")
            && is_plain(root)
            && !self.text.contains("<!DOCTYPE")
            && !self.document.descendants().any(style)
    }

    /// The root without any content.
    pub(super) fn empty(&self) -> String {
        let frame = self.root();
        frame.before + &frame.after
    }

    /// Gives the pieces in painting order, as long as `each` returns no error.
    pub(super) fn each<E>(&self, each: &mut impl FnMut(PiecePurpose) -> Result<(), E>) -> Result<(), E> {
        self.split(self.document.root_element(), &self.root(), each)
    }

    fn root(&self) -> EnclosingTags {
        let root = self.document.root_element();
        let name = self.text[root.range().start + 1..].split(|c: char| c.is_whitespace() || c == '>').next();
        EnclosingTags {
            before: self.start_tag(root).into(),
            after: format!("</{}>", name.unwrap_or_default()),
            depth: 0,
        }
    }

    /// Splits the children of a container within `frame`.
    fn split<E>(
        &self,
        container: Node<'a, 'a>,
        frame: &EnclosingTags,
        each: &mut impl FnMut(PiecePurpose) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut run: Option<(Node<'a, 'a>, Node<'a, 'a>)> = None;
        let mut weight = 0;
        for child in container.children().filter(Node::is_element) {
            let own = self.weights[child.id().get_usize()];
            let hidden = ["defs", "metadata", "title", "desc", "symbol"].contains(&child.tag_name().name());
            if hidden || own.saturating_add(weight) > PIECE {
                if let Some(run) = run.take() {
                    each(PiecePurpose::Draw { text: self.piece(frame, run), weight })?;
                }
                weight = 0;
            }
            if hidden {
                continue;
            }
            let group = self.start_tag(child).starts_with("<g") && is_plain(child);
            if own > PIECE && group && frame.depth < DEEPEST {
                match child.attribute("clip-path") {
                    None => {
                        let inner = frame.around(self.start_tag(child));
                        self.split(child, &inner, each)?;
                        continue;
                    }
                    Some(_) => {
                        if let Some(clip) = self.clip_of(child) {
                            let inner = frame.around(&self.unclipped(child));
                            each(PiecePurpose::Open)?;
                            self.split(child, &inner, each)?;
                            let shape = format!("{}{CLIP}{clip}</g>{}", inner.before, inner.after);
                            each(PiecePurpose::Close(shape))?;
                            continue;
                        }
                    }
                }
            }
            weight = own.saturating_add(weight);
            run = Some(run.map_or((child, child), |(first, _)| (first, child)));
        }
        run.map_or(Ok(()), |run| each(PiecePurpose::Draw { text: self.piece(frame, run), weight }))
    }

    /// Some siblings, with all that they refer to.
    fn piece(&self, frame: &EnclosingTags, (first, last): (Node<'a, 'a>, Node<'a, 'a>)) -> String {
        let range = first.range().start..last.range().end;
        let mut definitions = String::new();
        let mut known = BTreeSet::new();
        let mut open = vec![first];
        while open.last().is_some_and(|n| *n != last) {
            let next = open[open.len() - 1].next_sibling_element();
            open.push(next.unwrap_or(last));
        }
        let around = first.ancestors().skip(1).flat_map(|n| n.attributes()).flat_map(referred);
        let mut wanted: Vec<&str> = around.collect();
        while let Some(node) = open.pop() {
            wanted.extend(references(node));
            for id in wanted.drain(..) {
                let Some(target) = self.ids.get(id) else { continue };
                if !range.contains(&target.range().start) && known.insert(target.id().get_usize()) {
                    definitions += &self.text[target.range()];
                    open.push(*target);
                }
            }
        }
        let root = self.start_tag(self.document.root_element()).len();
        let (root, groups) = frame.before.split_at(root);
        let slice = &self.text[range];
        format!("{root}<defs>{definitions}</defs>{groups}{slice}{}", frame.after)
    }

    /// The tag that begins an element with content.
    fn start_tag(&self, node: Node<'_, '_>) -> &'a str {
        let range = node.range();
        let end = node.first_child().map_or(range.end, |child| child.range().start);
        &self.text[range.start..end]
    }

    /// The tag that begins a group, without its clip path.
    fn unclipped(&self, node: Node<'_, '_>) -> String {
        let tag = self.start_tag(node);
        let place = node.attributes().find(|a| a.name() == "clip-path").map(|a| a.range());
        place.map_or(tag.into(), |place| {
            let start = node.range().start;
            format!("{}{}", &tag[..place.start - start], &tag[place.end - start..])
        })
    }

    /// The content of the clip path of a group, if it is made of bare shapes.
    fn clip_of(&self, node: Node<'_, '_>) -> Option<&'a str> {
        const PLACE: [&str; 13] =
            ["id", "d", "x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "points", "transform"];
        let id = node.attribute("clip-path")?.strip_prefix("url(#")?.strip_suffix(')')?;
        let clip = self.ids.get(id)?;
        let bare = |n: Node<'_, '_>| {
            let name = n.tag_name().name();
            let shape = ["path", "rect", "circle", "ellipse", "polygon"].contains(&name);
            shape && n.attributes().all(|a| PLACE.contains(&a.name())) && !n.has_children()
        };
        let alone = clip.attributes().all(|a| a.name() == "id") && clip.tag_name().name() == "clipPath";
        let ruled = clip.ancestors().any(|n| n.has_attribute("clip-rule"));
        if !(alone && !ruled && clip.children().filter(Node::is_element).all(bare)) {
            return None;
        }
        Some(&self.text[clip.first_child()?.range().start..clip.last_child()?.range().end])
    }
}

impl EnclosingTags {
    /// The enclosing tags with a further group inside.
    fn around(&self, tag: &str) -> Self {
        Self {
            before: format!("{}{tag}", self.before),
            after: format!("</g>{}", self.after),
            depth: self.depth + 1,
        }
    }
}

/// Whether the children of an element are painted one after another directly on the canvas, apart from
/// clipping.
fn is_plain(node: Node<'_, '_>) -> bool {
    const TOGETHER: [&str; 8] = [
        "opacity",
        "filter",
        "mask",
        "style",
        "isolation",
        "mix-blend-mode",
        "systemLanguage",
        "requiredExtensions",
    ];
    let root = node.parent_element().is_none();
    !(root && node.has_attribute("clip-path"))
        && node.has_children()
        && TOGETHER.iter().all(|name| !node.has_attribute(*name))
}

/// The ids that an element and all in it refer to, in document order.
fn references<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = &'a str> {
    node.descendants().flat_map(|n| n.attributes()).flat_map(referred)
}
