//! Estimates the cost of parsing an SVG beforehand.
//!
//! The parser cannot be interrupted, and a few bytes can take hours: it tries each rule of the style sheets
//! at each element, follows references within references, and reads path data by recursion.

use super::SvgFault;
use super::unfolding::{self, DEEPEST, MOST_DRAWN, MOST_ELEMENTS, MOST_OUTLINES, StyledProperty, Unfoldable};
use resvg::usvg::roxmltree::{Attribute, Document, Node};
use simplecss::{AttributeOperator, Element, PseudoClass, StyleSheet};
use std::cell::Cell;
use std::collections::HashMap;

/// Number of allowed steps. Counting them takes some two seconds, and parsing as long.
const MOST_STEPS: u64 = 200_000_000;
/// Number of steps for a declaration of a style.
const DECLARATION: u64 = 20;
/// Number of characters per step when the parser counts lines up to a place, which on average is half way.
const CHARACTERS: u64 = 40;
/// Most declarations of style sheets, those of a list of selectors counted for each.
const MOST_DECLARATIONS: u64 = 20_000_000;
/// Largest number of consecutive commands that close a path. Each takes a part of the stack.
const MOST_CLOSES: usize = 1000;
/// Digits before the point of a radius.
const MOST_DIGITS: usize = 12;
/// Depth to which nested references are counted.
const DEPTH: usize = 32;

/// The reason to refuse a document; `None` if it may be parsed.
pub(super) fn refused(document: &Document<'_>) -> Option<SvgFault> {
    let closes = |a: Attribute<'_, '_>| a.name() == "d" && consecutive_closes(a.value()) > MOST_CLOSES;
    if document.descendants().flat_map(|n| n.attributes()).any(closes) {
        let reason = format!("a path is closed more than {MOST_CLOSES} times in a row");
        return Some(SvgFault { reason, advice: "delete the repeated Z in its path data" });
    }
    if document.descendants().any(|n| n.attributes().any(|a| is_too_large(n, a))) {
        let reason = "it has an arc, a circle or a filter that is larger than can be drawn".into();
        return Some(SvgFault { reason, advice: "delete what lies far outside the page" });
    }
    let Some(styled) = styled(document) else {
        let reason = "its styles would take more than ten seconds to apply".into();
        let advice = "turn its style sheet into attributes in the program that made it, or shorten it";
        return Some(SvgFault { reason, advice });
    };
    if links_within_containers(document) > MOST_STEPS {
        let reason = "its patterns, masks and clip paths refer to one another too often".into();
        return Some(SvgFault { reason, advice: super::SHAPES });
    }
    let (reason, advice) = match unfolding::check(document, &styled).err()? {
        Unfoldable::Circular => {
            ("its references lead back to themselves".into(), "remove the reference that closes the circle")
        }
        Unfoldable::Deep => {
            let reason = format!("it nests more than {DEEPEST} elements in one another, references followed");
            (reason, "ungroup it in the program that made it")
        }
        Unfoldable::Large => {
            let reason = format!(
                "its references unfold to more than {} million elements, or draw more than {} million",
                MOST_ELEMENTS / 1_000_000,
                MOST_DRAWN / 1_000_000
            );
            (reason, super::SHAPES)
        }
        Unfoldable::Detailed => {
            let reason = format!(
                "its outlines, written out wherever they are used, have more than {} million characters",
                MOST_OUTLINES / 1_000_000
            );
            (reason, "simplify its longest paths, or delete some of the elements that use them")
        }
    };
    Some(SvgFault { reason, advice })
}

/// Whether an attribute gives a radius or a length of a filter of some 10¹² or more: the parser makes an arc of the more
/// curves, the larger it is, and has no place for regions of filters beyond the largest number.
fn is_too_large(node: Node<'_, '_>, attribute: Attribute<'_, '_>) -> bool {
    let (tag, value) = (node.tag_name().name(), attribute.value());
    match attribute.name() {
        "r" | "rx" | "ry" => is_huge(value),
        "d" => value.contains(['a', 'A']) && is_huge(value),
        "x" | "y" | "width" | "height" | "dx" | "dy" | "radius" | "stdDeviation" | "scale" => {
            (tag == "filter" || tag.starts_with("fe")) && is_huge(value)
        }
        "filter" | "style" => ["blur(", "shadow("].iter().any(|f| value.contains(f)) && is_huge(value),
        _ => false,
    }
}

/// Whether a text has a number of more than 12 digits before the point, or an exponent of 12 or more.
fn is_huge(text: &str) -> bool {
    let digits = |rest: &str| rest.bytes().take_while(u8::is_ascii_digit).count();
    let exponents = text.split(['e', 'E']).skip(1).map(|rest| rest.strip_prefix('+').unwrap_or(rest));
    let is_large = |rest: &str| {
        rest[..digits(rest)].parse::<u64>().map_or(digits(rest) > 0, |v| v >= MOST_DIGITS as u64)
    };
    let parts = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    exponents.into_iter().any(is_large) || parts.into_iter().any(|number| digits(number) > MOST_DIGITS)
}

/// Largest number of consecutive commands that close a path.
fn consecutive_closes(data: &str) -> usize {
    let mut longest = 0;
    let mut run = 0;
    for byte in data.bytes() {
        match byte {
            b'z' | b'Z' => run += 1,
            byte if byte.is_ascii_whitespace() => {}
            _ => run = 0,
        }
        longest = longest.max(run);
    }
    longest
}

/// The references that style sheets declare; `None` if styles take too long to apply.
fn styled<'a>(document: &'a Document<'_>) -> Option<Vec<StyledProperty<'a>>> {
    let steps = Cell::new(0);
    let mut sheet = StyleSheet::new();
    for style in document.descendants().filter(|n| n.has_tag_name("style")) {
        if style.attribute("type").is_some_and(|t| t != "text/css") {
            continue;
        }
        let text = style.text().unwrap_or_default();
        let count = |what: &[u8]| 1 + text.bytes().filter(|b| what.contains(b)).count() as u64;
        if count(b",").saturating_mul(count(b";")) > MOST_DECLARATIONS {
            return None;
        }
        // All rules are sorted again for each style sheet.
        steps.set(steps.get() + reading(text) + sheet.rules.len() as u64);
        if steps.get() > MOST_STEPS {
            return None;
        }
        sheet.parse_more(text);
    }
    let mut dearest = 0;
    let mut styled = Vec::new();
    for node in document.descendants().filter(Node::is_element) {
        let before = steps.get();
        let element = Counted { node, steps: &steps };
        for rule in &sheet.rules {
            if rule.selector.matches(&element) {
                element.count(DECLARATION * rule.declarations.len() as u64);
                let refer = rule.declarations.iter().filter(|d| d.value.contains("url("));
                let number = node.id().get_usize();
                styled.extend(refer.map(|d| StyledProperty { node: number, name: d.name, value: d.value }));
            }
        }
        element.count(node.attribute("style").map_or(0, reading));
        if steps.get() > MOST_STEPS {
            return None;
        }
        dearest = dearest.max(steps.get() - before);
    }
    let own = document.descendants().filter(Node::is_element).count() as u64;
    let copies = weights(document, &uses(document, &ids(document)))[0].min(MOST_ELEMENTS).saturating_sub(own);
    (steps.get() + copies * dearest <= MOST_STEPS).then_some(styled)
}

/// Steps of reading a style. Where a value ends, after the mark of a colour, and after a number without a unit,
/// the parser counts the lines up to there.
fn reading(style: &str) -> u64 {
    let mut counts = 0;
    let mut last = b' ';
    for byte in style.bytes() {
        let number = byte.is_ascii_digit() && !last.is_ascii_alphanumeric() && !matches!(last, b'#' | b'.');
        counts += u64::from(number || matches!(byte, b';' | b'}' | b'#'));
        last = byte;
    }
    style.len() as u64 / 8 + style.len() as u64 * counts / CHARACTERS
}

/// An element that counts the queries of the selector engine. Beyond [`MOST_STEPS`] no selector matches, so
/// that the search ends.
struct Counted<'a, 'd> {
    node: Node<'a, 'd>,
    steps: &'a Cell<u64>,
}

impl Counted<'_, '_> {
    /// Counts steps. Returns whether any are left.
    fn count(&self, steps: u64) -> bool {
        self.steps.set(self.steps.get() + steps);
        self.steps.get() <= MOST_STEPS
    }

    fn beside(&self, node: Option<Self>) -> Option<Self> {
        node.filter(|_| self.count(1))
    }
}

impl Element for Counted<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.beside(self.node.parent_element().map(|node| Self { node, ..*self }))
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.beside(self.node.prev_sibling_element().map(|node| Self { node, ..*self }))
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.count(1) && self.node.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        let value = self.node.attribute(name).unwrap_or_default();
        let steps = 1 + self.node.attributes().len() as u64 / 8 + value.len() as u64 / 8;
        self.count(steps) && self.node.has_attribute(name) && operator.matches(value)
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        self.count(1) && class == PseudoClass::FirstChild && self.node.prev_sibling_element().is_none()
    }
}

/// Number of steps in which the parser searches for patterns, masks and the like that refer to themselves: it
/// follows all references within each.
fn links_within_containers(document: &Document<'_>) -> u64 {
    const CONTAINERS: [&str; 5] = ["pattern", "mask", "clipPath", "filter", "marker"];
    let ids = ids(document);
    let sizes = weights(document, &[]);
    let mut steps = sizes.clone();
    let mut links = vec![0u64; sizes.len()];
    let nodes: Vec<Node<'_, '_>> = document.descendants().collect();
    for (i, node) in nodes.iter().enumerate().rev() {
        for target in node.attributes().flat_map(referred).filter_map(|id| ids.get(id)) {
            links[i] += 1;
            steps[i] = steps[i].saturating_add(sizes[target.id().get_usize()]);
        }
        if let Some(parent) = node.parent() {
            let parent = parent.id().get_usize();
            steps[parent] = steps[parent].saturating_add(steps[i] - sizes[i]);
            links[parent] += links[i];
        }
    }
    let containers = nodes.iter().enumerate().filter(|(_, n)| CONTAINERS.contains(&n.tag_name().name()));
    containers.fold(0, |sum: u64, (i, _)| sum.saturating_add(if links[i] > 0 { steps[i] } else { 0 }))
}

/// The first element of each id.
pub fn ids<'a, 'd>(document: &'a Document<'d>) -> HashMap<&'a str, Node<'a, 'd>> {
    let mut ids = HashMap::new();
    for node in document.descendants().filter(Node::is_element) {
        if let Some(id) = node.attribute("id") {
            ids.entry(id).or_insert(node);
        }
    }
    ids
}

/// Numbers of each `<use>` and of the node that it shows, in document order.
pub fn uses(document: &Document<'_>, ids: &HashMap<&str, Node<'_, '_>>) -> Vec<(usize, usize)> {
    let uses = document.descendants().filter(|n| n.tag_name().name() == "use");
    let link = |node: Node<'_, '_>| {
        let link = node.attributes().find(|a| a.name() == "href")?.value().strip_prefix('#')?;
        Some((node.id().get_usize(), ids.get(link)?.id().get_usize()))
    };
    uses.filter_map(link).collect()
}

/// The ids that an attribute refers to. A style, or a list of filters, may hold several.
pub fn referred<'a>(attribute: Attribute<'a, '_>) -> Vec<&'a str> {
    if attribute.name() == "href" {
        return attribute.value().trim().strip_prefix('#').into_iter().collect();
    }
    linked(attribute.value())
}

/// The ids that a value refers to by `url(#id)`.
pub(super) fn linked(value: &str) -> Vec<&str> {
    fn id(rest: &str) -> Option<&str> {
        let id = rest.split(')').next()?.trim().trim_matches(['\'', '"']);
        id.trim().strip_prefix('#')
    }
    value.split("url(").skip(1).filter_map(id).collect()
}

/// Number of elements in each node with all links followed. A link leads from one node to another by number;
/// links are in the order of the nodes.
pub fn weights(document: &Document<'_>, links: &[(usize, usize)]) -> Vec<u64> {
    let nodes: Vec<Node<'_, '_>> = document.descendants().collect();
    let mut weights = vec![0; nodes.len()];
    // Each round follows links one level deeper.
    for _ in 0..DEPTH {
        let before = weights.clone();
        weights.fill(0);
        let mut rest = links;
        for (i, node) in nodes.iter().enumerate().rev() {
            weights[i] = u64::from(node.is_element()).saturating_add(weights[i]);
            while let Some(((from, to), others)) = rest.split_last()
                && *from == i
            {
                weights[i] = weights[i].saturating_add(before[*to]);
                rest = others;
            }
            if let Some(parent) = node.parent() {
                let parent = parent.id().get_usize();
                weights[parent] = weights[i].saturating_add(weights[parent]);
            }
        }
        if weights == before {
            break;
        }
    }
    weights
}
