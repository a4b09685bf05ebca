//! Limits of the text of a document, before it is parsed: attributes that are compared with each other, namespaces that
//! are copied from element to element, entities that unfold.

use super::{SHAPES, SvgFault};
use std::collections::{HashMap, HashSet};

/// Largest number of attributes of an element: the parser compares them all with each other.
const MOST_ATTRIBUTES: usize = 1000;
/// Largest number of prefixes of namespaces: the parser copies those of an element to its children.
const MOST_NAMESPACES: usize = 200;
/// Most bytes to which all references to entities unfold, and the depth of nested entities that is counted.
const MOST_UNFOLDED: usize = 10_000_000;
const MOST_NESTED: usize = 10;

/// Why a text, which may not be well formed, is not parsed.
pub(super) fn refused(text: &str) -> Option<SvgFault> {
    let fault = |reason: String, advice| Some(SvgFault { reason, advice });
    if most_attributes(text) > MOST_ATTRIBUTES {
        let reason = format!("an element has more than {MOST_ATTRIBUTES} attributes");
        return fault(reason, "delete those that nothing needs");
    }
    if has_many_namespaces(text) {
        return fault(
            format!("it has more than {MOST_NAMESPACES} namespaces"),
            "delete those that nothing needs",
        );
    }
    if unfolded(text) > MOST_UNFOLDED {
        return fault(format!("its entities unfold to more than {} MB", MOST_UNFOLDED / 1_000_000), SHAPES);
    }
    None
}

/// Upper bound of the largest number of attributes of an element.
fn most_attributes(text: &str) -> usize {
    // Neither tags nor the values of attributes hold a '<'.
    text.split('<').map(attributes).max().unwrap_or(0)
}

/// Number of values in quotes in a tag and the text behind it.
fn attributes(tag: &str) -> usize {
    let mut quote = None;
    let mut count = 0;
    for byte in tag.bytes() {
        match (quote, byte) {
            (None, b'>') => break,
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if open == byte => {
                quote = None;
                count += 1;
            }
            _ => {}
        }
    }
    count
}

fn has_many_namespaces(text: &str) -> bool {
    let mut known = HashSet::new();
    for after in text.split("xmlns:").skip(1) {
        let end = after.find(|c: char| c == '=' || c.is_whitespace()).unwrap_or(after.len());
        known.insert(&after[..end]);
        if known.len() > MOST_NAMESPACES {
            return true;
        }
    }
    false
}

/// Bytes to which all references to entities unfold, or more.
fn unfolded(text: &str) -> usize {
    let declared = text.split("<!ENTITY").skip(1).filter_map(|after| {
        let (name, rest) = after.trim_start().split_once(char::is_whitespace)?;
        let rest = rest.trim_start();
        let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        Some((name, rest[1..].split(quote).next()?))
    });
    let entities: HashMap<&str, &str> = declared.collect();
    if entities.is_empty() {
        return 0;
    }
    // The lengths of entities within whose values the others have theirs from the round before.
    let mut lengths: HashMap<&str, usize> = entities.keys().map(|name| (*name, 0)).collect();
    for _ in 0..MOST_NESTED {
        lengths = entities.iter().map(|(name, value)| (*name, length(value, &lengths))).collect();
    }
    length(text, &lengths) - text.len()
}

/// Length of a text whose references have such lengths, at most some times what is permitted.
fn length(text: &str, lengths: &HashMap<&str, usize>) -> usize {
    let of =
        |after: &str| after.split_once(';').and_then(|(name, _)| lengths.get(name)).copied().unwrap_or(0);
    let all = text.split('&').skip(1).map(of).fold(text.len(), usize::saturating_add);
    all.min(text.len() + 2 * MOST_UNFOLDED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_unfolds_and_is_copied_is_counted() {
        let of = |entities: &str, rest: &str| format!("<!DOCTYPE svg [{entities}]><svg>{rest}</svg>");
        assert_eq!(unfolded(&of(r#"<!ENTITY ns "abc">"#, "&ns;&amp;&ns;")), 6);
        assert_eq!(unfolded("<svg>&ns;</svg>"), 0);
        let long = format!("<!ENTITY e '{}'>", "x".repeat(100_000));
        assert!(refused(&of(&long, &"&e;".repeat(90))).is_none());
        let said = |text: &str| refused(text).expect("it is refused").reason;
        assert!(said(&of(&long, &"&e;".repeat(2000))).contains("entities unfold"));
        // Ten of ten of ten.
        let nested: String = (1..8)
            .map(|k| format!("<!ENTITY e{k} '{}'>", format!("&e{};", k - 1).repeat(10)))
            .chain(["<!ENTITY e0 'xxxxxxxxxx'>".into()])
            .collect();
        assert!(said(&of(&nested, "&e7;")).contains("entities unfold"));
        let prefixes: String = (0..300).map(|k| format!("<g xmlns:a{k}='u'>")).collect();
        assert!(said(&prefixes).contains("namespaces"));
        assert!(refused(&"<use xmlns:xlink='u'/>".repeat(5000)).is_none());
    }
}
