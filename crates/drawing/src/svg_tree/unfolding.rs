//! What a document unfolds to, counted before it is parsed: every `<use>`, marker, pattern, mask, clip path and filter
//! picture followed, as the parser and the renderer follow them.
//!
//! A few hundred bytes of references can unfold without end, and neither the parser nor the renderer can be interrupted.

use super::bounds::{ids, linked};
use resvg::usvg::roxmltree::{Document, Node};
use std::collections::{BTreeMap, HashMap};

/// Largest number of elements that the parser holds in memory, those of shared definitions counted once.
pub const MOST_ELEMENTS: u64 = 1_000_000;
/// Largest number of elements that are drawn, those of a definition counted for each of its uses.
pub(super) const MOST_DRAWN: u64 = 4_000_000;
/// Most characters of outlines that the parser holds in memory. It makes some ten bytes of each.
pub(super) const MOST_OUTLINES: u64 = 50_000_000;
/// Largest number of elements looked at to count, which takes about a second.
const MOST_VISITS: u64 = 4_000_000;
/// Greatest depth of elements within one another, references followed. Each level takes a part of the stack.
pub(super) const DEEPEST: u32 = 1024;
/// Depth that a reference counts for: the parser and the renderer take several steps for it.
const REFERENCE: u32 = 8;

/// Why a document cannot be unfolded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unfoldable {
    /// Its references lead back to themselves.
    Circular,
    /// Elements and references are nested too deeply.
    Deep,
    /// It unfolds to too many elements.
    Large,
    /// The outlines of its elements unfold to too many characters.
    Detailed,
}

/// Properties that refer to definitions: paints and markers, which elements inherit, then those of an element itself.
const PROPERTIES: [&str; 8] =
    ["fill", "stroke", "marker-start", "marker-mid", "marker-end", "clip-path", "mask", "filter"];
/// Number of inherited [`PROPERTIES`]: the paints and markers.
const INHERITED: usize = 5;
const MARKERS: std::ops::Range<usize> = 2..INHERITED;
const MARKER_MID: usize = 3;
/// Elements that are drawn only where something refers to them.
const HIDDEN: [&str; 14] = [
    "clipPath",
    "defs",
    "desc",
    "filter",
    "linearGradient",
    "marker",
    "mask",
    "metadata",
    "pattern",
    "radialGradient",
    "script",
    "style",
    "symbol",
    "title",
];
/// Elements that are filled and stroked.
const SHAPES: [&str; 7] = ["circle", "ellipse", "line", "path", "polygon", "polyline", "rect"];

/// A declaration of a style sheet for an element.
pub(super) struct StyledProperty<'s> {
    /// Number of the element's node.
    pub(super) node: usize,
    pub(super) name: &'s str,
    pub(super) value: &'s str,
}

/// Checks that a document unfolds to a bounded number of elements. `styled` holds what style sheets declare.
pub(super) fn check(document: &Document<'_>, styled: &[StyledProperty<'_>]) -> Result<(), Unfoldable> {
    let mut unfolding = Unfolding::new(document, styled);
    let all = unfolding.element(document.root_element(), 0, 0)?;
    let held = all.held.saturating_add(unfolding.shared.held);
    let outlines = all.outlines.saturating_add(unfolding.shared.outlines);
    match () {
        () if held > MOST_ELEMENTS || all.drawn > MOST_DRAWN => Err(Unfoldable::Large),
        () if outlines > MOST_OUTLINES => Err(Unfoldable::Detailed),
        () => Ok(()),
    }
}

/// What an element unfolds to.
#[derive(Clone, Copy, Debug, Default)]
struct Unfolded {
    /// Elements in memory.
    held: u64,
    /// Characters of outlines in memory.
    outlines: u64,
    /// Elements to be drawn.
    drawn: u64,
}

impl Unfolded {
    fn add(&mut self, other: Self, times: u64) {
        self.held = self.held.saturating_add(other.held.saturating_mul(times));
        self.outlines = self.outlines.saturating_add(other.outlines.saturating_mul(times));
        self.drawn = self.drawn.saturating_add(other.drawn.saturating_mul(times));
    }
}

/// What the properties of an element refer to.
#[derive(Default)]
struct References {
    /// Which of the [`PROPERTIES`] are given, one bit each.
    given: u8,
    /// Numbers of properties, and of the nodes that they refer to. Several values of one property all count.
    targets: Vec<(usize, usize)>,
}

impl References {
    fn add(&mut self, name: &str, value: &str, ids: &HashMap<&str, Node<'_, '_>>) {
        let of = |name: &str| PROPERTIES.iter().position(|p| *p == name);
        let numbers = if name == "marker" { MARKERS } else { of(name).map_or(0..0, |k| k..k + 1) };
        for k in numbers {
            self.given |= 1 << k;
            let found = linked(value).into_iter().filter_map(|id| ids.get(id));
            let useful = found.filter(|n| k >= 2 || n.tag_name().name() == "pattern");
            self.targets.extend(useful.map(|n| (k, n.id().get_usize())));
        }
    }
}

/// The definitions that an element inherits, for each inherited property.
type Inheritance = [Vec<usize>; INHERITED];

struct Unfolding<'a, 'd> {
    nodes: Vec<Node<'a, 'd>>,
    /// What each element with such properties refers to.
    references: HashMap<usize, References>,
    /// The element that each `<use>`, filter picture or pattern is made from.
    links: HashMap<usize, usize>,
    /// What elements inherit, each set once, and the number of each set.
    inheritances: Vec<Inheritance>,
    numbers: BTreeMap<Inheritance, usize>,
    /// What each definition unfolds to, by node and number of what it inherits; `None` while it is being unfolded.
    known: HashMap<(usize, usize), Option<Unfolded>>,
    /// Content of definitions that are held once.
    shared: Unfolded,
    visits: u64,
}

impl<'a, 'd> Unfolding<'a, 'd> {
    fn new(document: &'a Document<'d>, styled: &[StyledProperty<'_>]) -> Self {
        let ids = ids(document);
        let (mut references, mut links) = (HashMap::<usize, References>::new(), HashMap::new());
        for node in document.descendants().filter(Node::is_element) {
            let number = node.id().get_usize();
            let mut own = References::default();
            for attribute in node.attributes() {
                match attribute.name() {
                    "href" if ["use", "feImage", "pattern"].contains(&node.tag_name().name()) => {
                        let target = attribute.value().trim().strip_prefix('#').and_then(|id| ids.get(id));
                        links.extend(target.map(|target| (number, target.id().get_usize())));
                    }
                    "style" => {
                        let declarations = attribute.value().split(';').filter_map(|d| d.split_once(':'));
                        declarations.for_each(|(name, value)| own.add(name.trim(), value, &ids));
                    }
                    name => own.add(name, attribute.value(), &ids),
                }
            }
            if own.given > 0 {
                references.insert(number, own);
            }
        }
        for StyledProperty { node, name, value } in styled {
            references.entry(*node).or_default().add(name, value, &ids);
        }
        Self {
            nodes: document.descendants().collect(),
            references,
            links,
            inheritances: vec![Inheritance::default()],
            numbers: BTreeMap::from([(Inheritance::default(), 0)]),
            known: HashMap::new(),
            shared: Unfolded::default(),
            visits: 0,
        }
    }

    /// An element in its place, where it inherits the set of number `inherited`.
    fn element(&mut self, node: Node<'a, 'd>, inherited: usize, depth: u32) -> Result<Unfolded, Unfoldable> {
        self.visits += 1;
        if self.visits > MOST_VISITS {
            return Err(Unfoldable::Large);
        }
        if depth > DEEPEST {
            return Err(Unfoldable::Deep);
        }
        let number = node.id().get_usize();
        let inherited = self.handed_down(number, inherited);
        let name = node.tag_name().name();
        let mut all = Unfolded { held: 1, outlines: outline(node).len() as u64, drawn: 1 };
        for child in node.children().filter(|c| c.is_element() && !HIDDEN.contains(&c.tag_name().name())) {
            all.add(self.element(child, inherited, depth + 1)?, 1);
        }
        if name != "pattern"
            && let Some(target) = self.links.get(&number)
        {
            all.add(self.definition(*target, inherited, depth)?, 1);
        }
        let of_itself = self.references.get(&number).into_iter().flat_map(|r| &r.targets);
        let of_itself: Vec<usize> = of_itself.filter(|t| t.0 >= INHERITED).map(|t| t.1).collect();
        for target in of_itself {
            all.add(self.standing(target, depth)?, 1);
        }
        if inherited > 0 && SHAPES.contains(&name) {
            for (k, targets) in self.inheritances[inherited].clone().into_iter().enumerate() {
                let times = if k == MARKER_MID { vertices(node) } else { 1 };
                for target in targets {
                    all.add(self.standing(target, depth)?, times);
                }
            }
        }
        Ok(all)
    }

    /// The content of a definition, with what that refers to, where it inherits the set of number `inherited`.
    fn definition(&mut self, target: usize, inherited: usize, depth: u32) -> Result<Unfolded, Unfoldable> {
        match self.known.get(&(target, inherited)) {
            Some(Some(known)) => return Ok(*known),
            Some(None) => return Err(Unfoldable::Circular),
            None => {}
        }
        self.known.insert((target, inherited), None);
        let node = self.nodes[target];
        let depth = depth.saturating_add(REFERENCE);
        let mut found = self.element(node, inherited, depth)?;
        // A pattern without content has that of the one that it is made from.
        if node.tag_name().name() == "pattern"
            && !node.has_children()
            && let Some(from) = self.links.get(&target)
        {
            found.add(self.standing(*from, depth)?, 1);
        }
        self.known.insert((target, inherited), Some(found));
        Ok(found)
    }

    /// A definition that inherits from where it stands in the document, such as a pattern. The parser holds it once unless
    /// it depends on the bounds of what refers to it.
    fn standing(&mut self, target: usize, depth: u32) -> Result<Unfolded, Unfoldable> {
        let node = self.nodes[target];
        let above: Vec<usize> = node.ancestors().skip(1).map(|n| n.id().get_usize()).collect();
        let inherited = above.into_iter().rev().fold(0, |inherited, n| self.handed_down(n, inherited));
        let is_new = !self.known.contains_key(&(target, inherited));
        let found = self.definition(target, inherited, depth)?;
        let in_user_space = |name: &str| node.attribute(name) == Some("userSpaceOnUse");
        let is_held_once = match node.tag_name().name() {
            "clipPath" => !self.is_in_bounds(target, "clipPathUnits"),
            "pattern" => in_user_space("patternUnits") && !self.is_in_bounds(target, "patternContentUnits"),
            "mask" => in_user_space("maskUnits") && !self.is_in_bounds(target, "maskContentUnits"),
            _ => false,
        };
        if !is_held_once {
            return Ok(found);
        }
        if is_new {
            self.shared.add(found, 1);
        }
        Ok(Unfolded { drawn: found.drawn, ..Unfolded::default() })
    }

    /// Whether an attribute of a definition, or of one that it is made from, gives units of the bounds of what refers to it.
    fn is_in_bounds(&self, target: usize, name: &str) -> bool {
        let chain = std::iter::successors(Some(target), |n| self.links.get(n).copied());
        chain.take(DEEPEST as usize).any(|n| self.nodes[n].attribute(name) == Some("objectBoundingBox"))
    }

    /// The number of what an element hands down to its content.
    fn handed_down(&mut self, number: usize, inherited: usize) -> usize {
        let Some(own) = self.references.get(&number) else { return inherited };
        let before = &self.inheritances[inherited];
        let replaced = |k: &usize| own.given & (1 << k) > 0;
        if (0..INHERITED).filter(replaced).all(|k| before[k].is_empty())
            && own.targets.iter().all(|t| t.0 >= INHERITED)
        {
            return inherited;
        }
        let mut next = before.clone();
        for k in (0..INHERITED).filter(replaced) {
            next[k] = own.targets.iter().filter(|t| t.0 == k).map(|t| t.1).collect();
        }
        let count = self.inheritances.len();
        let found = *self.numbers.entry(next.clone()).or_insert(count);
        if found == count {
            self.inheritances.push(next);
        }
        found
    }
}

/// The outline of a path, a polygon or a polyline, as it is written.
fn outline<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute("d").or_else(|| node.attribute("points")).unwrap_or_default()
}

/// Upper bound of the number of vertices of a shape.
fn vertices(node: Node<'_, '_>) -> u64 {
    let between =
        outline(node).bytes().filter(|b| !b.is_ascii_digit() && !matches!(b, b'.' | b'e' | b'E')).count();
    between as u64 + 2
}
