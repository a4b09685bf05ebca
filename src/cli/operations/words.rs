//! A text split into words.

use super::fault::Fault;

/// The words of a text: split at spaces, quotes taken off. Unlike a shell's, `#` begins no comment and
/// `\` is a plain letter, so that colours and paths need no quotes.
pub(super) fn words(text: &str) -> Result<Vec<String>, Fault> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in text.chars() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => word.get_or_insert_default().push(c),
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            None => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    match quote {
        Some(open) => Err(Fault::new(format!("a quote {open} is not closed"), "close it with the same sign")),
        None => Ok(words),
    }
}
