//! Layers of a page as optional content, which viewers list by name and switch on and off.
//!
//! krilla writes no optional content, so its file is opened again: the page's content stream marks each
//! form XObject that it draws, the page's resources name the groups, the catalog lists them, and the
//! table of objects is written anew. Where everything on the page is drawn under one change of
//! coordinates, that is made once and for all: Inkscape 1.2 takes the change within `q` and `Q` for one
//! that gradients in forms ignore. The path of a domain is written before the change, which then stays
//! where it is. Nothing else changes.

use flate2::read::ZlibDecoder;
use std::collections::BTreeMap;
use std::io::Read;

/// Digits and spaces of an entry of the table of objects.
const ENTRY: usize = 20;

/// A file of one page whose content draws one form XObject for each of `names`, in this order; gives
/// the same file with a group of that name around each. `None` if the file has another structure.
pub(super) fn named(file: &[u8], names: &[String]) -> Option<Vec<u8>> {
    let objects = Objects::read(file)?;
    let catalog = objects.reference(objects.trailer, "/Root ")?;
    let pages = objects.reference(objects.text(catalog)?, "/Pages ")?;
    let page = objects.reference(objects.text(pages)?, "/Kids [")?;
    let content = objects.reference(objects.text(page)?, "/Contents ")?;

    let first = objects.bytes.len() + 1;
    let groups: Vec<String> = (0..names.len()).map(|k| format!("{} 0 R", first + k)).collect();
    let all = groups.join(" ");
    // Viewers list the topmost layer first.
    let order: Vec<&str> = groups.iter().rev().map(String::as_str).collect();
    let properties = format!("/OCProperties <</OCGs [{all}] /D <</Order [{}]>>>>", order.join(" "));
    let resources: String = groups.iter().enumerate().map(|(k, group)| format!("/l{k} {group} ")).collect();
    let mut changed = BTreeMap::from([
        (catalog, insert(objects.text(catalog)?, "/Type /Catalog", &properties)?),
        (page, insert(objects.text(page)?, "/Resources <<", &format!("/Properties <<{resources}>>"))?),
        (content, stream(content, &marked(&hoisted(content_of(objects.bytes(content)?)?), names.len())?)),
    ]);
    for (k, name) in names.iter().enumerate() {
        changed.insert(
            first + k,
            format!("{} 0 obj\n<</Type /OCG /Name {}>>\nendobj\n\n", first + k, text(name)),
        );
    }
    Some(objects.write(file, &changed))
}

/// A text string: as it is where it is plain ASCII, else in UTF-16.
fn text(name: &str) -> String {
    let plain = name.chars().all(|c| matches!(c, ' '..='~') && !matches!(c, '(' | ')' | '\\'));
    if plain {
        return format!("({name})");
    }
    let digits: String = name.encode_utf16().map(|unit| format!("{unit:04X}")).collect();
    format!("<FEFF{digits}>")
}

/// The objects of a file with one plain table.
struct Objects<'a> {
    /// The bytes of each object, by its number less one.
    bytes: Vec<&'a [u8]>,
    /// The bytes before the first object.
    head: usize,
    trailer: &'a str,
}

impl<'a> Objects<'a> {
    fn read(file: &'a [u8]) -> Option<Self> {
        // The table and what follows it is text; what comes before need not be.
        let end = &file[file.len().saturating_sub(64)..];
        let at = std::str::from_utf8(end).ok()?.rsplit_once("startxref\n")?.1;
        let at: usize = at.lines().next()?.parse().ok()?;
        let table = std::str::from_utf8(file.get(at..)?).ok()?;
        let (count, entries) = table.strip_prefix("xref\n0 ")?.split_once('\n')?;
        let count: usize = count.parse().ok()?;
        let (entries, trailer) = entries.split_at_checked(count.checked_mul(ENTRY)?)?;
        let places = (1..count).map(|n| entries[n * ENTRY..].get(..10)?.parse().ok());
        let places: Vec<usize> = places.collect::<Option<_>>()?;
        let mut sorted = places.clone();
        sorted.push(at);
        sorted.sort_unstable();
        let object = |&from: &usize| {
            let to = sorted[sorted.partition_point(|p| *p <= from)];
            file.get(from..to)
        };
        let bytes = places.iter().map(object).collect::<Option<_>>()?;
        Some(Self { bytes, head: sorted[0], trailer })
    }

    fn bytes(&self, number: usize) -> Option<&'a [u8]> {
        self.bytes.get(number.checked_sub(1)?).copied()
    }

    fn text(&self, number: usize) -> Option<&'a str> {
        std::str::from_utf8(self.bytes(number)?).ok()
    }

    /// The number of the object that follows `key`.
    fn reference(&self, text: &str, key: &str) -> Option<usize> {
        text.split_once(key)?.1.split(' ').next()?.parse().ok()
    }

    /// The file with some objects changed or added.
    fn write(&self, file: &[u8], changed: &BTreeMap<usize, String>) -> Vec<u8> {
        let mut out = file[..self.head].to_vec();
        let last = changed.keys().copied().max().unwrap_or(0).max(self.bytes.len());
        let mut table = format!("xref\n0 {}\n0000000000 65535 f\r\n", last + 1);
        for number in 1..=last {
            table += &format!("{:010} 00000 n\r\n", out.len());
            let old = self.bytes(number).unwrap_or_default();
            out.extend_from_slice(changed.get(&number).map_or(old, String::as_bytes));
        }
        let at = out.len();
        let old = format!("/Size {}\n", self.bytes.len() + 1);
        let (before, after) = self.trailer.split_once(&old).unwrap_or((self.trailer, ""));
        let after = after.split_once("startxref").map_or(after, |(part, _)| part);
        let tail = format!("{table}{before}/Size {}\n{after}startxref\n{at}\n%%EOF", last + 1);
        out.extend_from_slice(tail.as_bytes());
        out
    }
}

/// The text with something added after its first `key`.
fn insert(text: &str, key: &str, added: &str) -> Option<String> {
    let (before, after) = text.split_once(key)?;
    Some(format!("{before}{key}\n  {added}{after}"))
}

/// The content of a packed stream.
fn content_of(object: &[u8]) -> Option<String> {
    const BEGINNING: &[u8] = b"stream\n";
    let at = object.windows(BEGINNING.len()).position(|w| w == BEGINNING)?;
    let mut text = String::new();
    ZlibDecoder::new(&object[at + BEGINNING.len()..]).read_to_string(&mut text).ok()?;
    Some(text)
}

/// The content with the change of coordinates that all its parts begin with made before them.
fn hoisted(content: String) -> String {
    let Some(change) = content.lines().nth(1).filter(|line| line.ends_with(" cm")) else { return content };
    let mut out = format!("{change}\n");
    let (mut depth, mut begins) = (0, false);
    for line in content.lines() {
        if begins && line != change || depth == 0 && !["q", ""].contains(&line) {
            return content;
        }
        if !begins {
            out += line;
            out.push('\n');
        }
        begins = depth == 0 && line == "q";
        depth += i32::from(line == "q") - i32::from(line == "Q");
    }
    out
}

/// The content with a mark around each of the `count` objects that it draws.
fn marked(content: &str, count: usize) -> Option<String> {
    let mut drawn = 0;
    let lines = content.lines().map(|line| {
        if !line.ends_with(" Do") {
            return format!("{line}\n");
        }
        drawn += 1;
        format!("/OC /l{} BDC\n{line}\nEMC\n", drawn - 1)
    });
    let text = lines.collect();
    (drawn == count).then_some(text)
}

/// A stream of plain text.
fn stream(number: usize, text: &str) -> String {
    format!("{number} 0 obj\n<</Length {}>>\nstream\n{text}\nendstream\nendobj\n\n", text.len())
}
