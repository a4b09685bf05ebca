//! Gradients of very many stops, thinned before they are parsed.
//!
//! The parser removes equal stops one by one, every shape gets a copy of the stops, and the renderer looks at all of them
//! for each pixel.

use super::SvgFault;
use resvg::usvg::roxmltree::{Document, Node};
use std::ops::Range;

/// Maximum number of stops of a gradient.
const MOST_STOPS: usize = 256;
/// The namespace of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";

/// The text of a document with at most 256 stops in each gradient, the first, the last and some evenly between them; `None`
/// if no gradient has more.
///
/// # Errors
/// A gradient with more stops that entities give it.
pub(super) fn thinned(document: &Document<'_>) -> Result<Option<String>, SvgFault> {
    let mut dropped: Vec<Range<usize>> = Vec::new();
    for gradient in document.descendants().filter(is_gradient) {
        let stops: Vec<Node<'_, '_>> =
            gradient.children().filter(|n| n.has_tag_name((SVG, "stop"))).collect();
        if stops.len() <= MOST_STOPS {
            continue;
        }
        let around = gradient.range();
        if stops.iter().any(|s| s.range().start < around.start || s.range().end > around.end) {
            let reason = format!("a gradient has more than {MOST_STOPS} stops, from entities");
            return Err(SvgFault { reason, advice: "give it fewer stops" });
        }
        let last = stops.len() - 1;
        let mut kept = (0..MOST_STOPS).map(|k| k * last / (MOST_STOPS - 1)).peekable();
        for (k, stop) in stops.iter().enumerate() {
            if kept.next_if_eq(&k).is_none() {
                dropped.push(stop.range());
            }
        }
    }
    if dropped.is_empty() {
        return Ok(None);
    }
    // What an entity holds occurs several times, and stops may be nested.
    dropped.sort_by_key(|range| (range.start, range.end));
    let (all, mut text, mut at) = (document.input_text(), String::new(), 0);
    for range in dropped {
        if range.start >= at {
            text.push_str(&all[at..range.start]);
            at = range.end;
        }
    }
    text.push_str(&all[at..]);
    Ok(Some(text))
}

fn is_gradient(node: &Node<'_, '_>) -> bool {
    node.has_tag_name((SVG, "linearGradient")) || node.has_tag_name((SVG, "radialGradient"))
}

#[cfg(test)]
mod tests {
    use super::super::{document, tree};
    use super::*;
    use resvg::usvg;

    fn svg(doctype: &str, inner: &str) -> String {
        format!(
            r#"{doctype}<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9">{inner}<rect width="9" height="9" fill="url(#g)"/></svg>"#
        )
    }

    fn ramp(count: u32) -> String {
        let red = |k: u32| k * 255 / (count - 1);
        let stop = |k: u32| {
            let offset = f64::from(k) / f64::from(count - 1);
            format!("<stop offset='{offset}' stop-color='rgb({},0,0)'><title>{k}</title></stop> ", red(k))
        };
        (0..count).map(stop).collect()
    }

    /// Offsets and red components of the gradient of a document's shape.
    fn stops_of(text: &str) -> Vec<[f64; 2]> {
        let tree = tree(&document(text).unwrap()).unwrap();
        let Some(usvg::Node::Path(path)) = tree.root().children().last() else { panic!("a path") };
        let usvg::Paint::LinearGradient(gradient) = path.fill().unwrap().paint() else {
            panic!("a gradient")
        };
        gradient.stops().iter().map(|s| [f64::from(s.offset().get()), f64::from(s.color().red)]).collect()
    }

    #[test]
    fn gradients_of_very_many_stops_are_thinned_once() {
        let gradient = |count| format!("<linearGradient id='g'>{}</linearGradient>", ramp(count));
        for count in [2, 255, 256, 257, 300, 10_000] {
            let text = svg("", &gradient(count));
            let found = stops_of(&text);
            assert_eq!(found.len(), MOST_STOPS.min(count as usize));
            assert_eq!([found[0][0], found[found.len() - 1][0]], [0.0, 1.0]);
            for [offset, red] in found {
                assert!((red / 255.0 - offset).abs() < 0.01, "{offset} {red}");
            }
            let again = thinned(&document(&text).unwrap()).unwrap();
            assert_eq!(again.is_some(), count as usize > MOST_STOPS);
            assert!(again.is_none_or(|text| thinned(&document(&text).unwrap()).unwrap().is_none()));
        }
    }

    #[test]
    fn a_gradient_that_entities_give_too_many_stops_is_refused() {
        let stop = "<stop offset='.5'/>";
        let doctype = format!("<!DOCTYPE svg [<!ENTITY a \"{}\">]>", stop.repeat(99));
        let fault = |uses: usize| {
            let text =
                svg(&doctype, &format!("<linearGradient id='g'>{}</linearGradient>", "&a;".repeat(uses)));
            tree(&document(&text).unwrap()).err().map(|fault| fault.reason)
        };
        assert_eq!(fault(2), None);
        assert!(fault(3).unwrap().contains("more than 256 stops"));
        // A whole gradient in an entity that is used twice.
        let doctype = format!(
            "<!DOCTYPE svg [<!ENTITY a \"<g><linearGradient id='g'>{}</linearGradient></g>\">]>",
            ramp(300).replace('"', "'")
        );
        assert_eq!(stops_of(&svg(&doctype, "&a;&a;")).len(), MOST_STOPS);
    }
}
