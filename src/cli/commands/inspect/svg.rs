//! Printing of the metadata of an SVG of vtex.

use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::foreign::escaped;
use crate::cli::output;
use crate::cli::recipe::metadata;
use crate::cli::summary::bytes as show_bytes;
use anstyle::Style;
use serde_json::{Value, json};

/// Prints seed, size, categories and recipe.
///
/// # Errors
/// An SVG without metadata of vtex.
pub(super) fn run(common: &Common, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let known = metadata(bytes).filter(|found| found["format"] == "vtex-svg");
    let Some(mut found) = known else {
        let failure = Failure::failed(format!("'{name}' does not say how it was made"));
        return Err(failure
            .hint("only an SVG that vtex has written does; draw others with 'vtex render'")
            .into());
    };
    if common.json {
        found["command"] = "inspect".into();
        found["file"] = name.into();
        found["bytes"] = json!(bytes.len());
        return output::print_json(&found, false);
    }
    output::print_styled(&show(name, bytes.len() as u64, &found))
}

/// A value as text, without quotes.
fn plain(value: &Value) -> String {
    escaped(&value.as_str().map_or_else(|| value.to_string(), str::to_owned))
}

/// For people: aligned.
fn show(name: &str, bytes: u64, found: &Value) -> String {
    let head = Style::new().bold();
    let (program, bytes) = (plain(&found["program"]), show_bytes(bytes));
    let mut text = format!("{head}{}{head:#}: SVG, written by {program}, {bytes}\n\n", escaped(name));
    let mut line = |name: &str, value: String| text.push_str(&format!("{head}{name:12}{head:#} {value}\n"));
    line("size", format!("{} x {} px", plain(&found["width"]), plain(&found["height"])));
    for library in found["libraries"].as_array().into_iter().flatten() {
        line("exemplar", plain(&library["exemplar"]));
    }
    if let Some(seed) = found.get("seed") {
        line("seed", plain(seed));
    }
    if let Some(method) = found["parameters"].get("method") {
        line("method", plain(method));
    }
    for edit in found["edits"].as_array().into_iter().flatten() {
        line("edit", plain(edit));
    }
    let recipe = &found["recipe"];
    for file in recipe["files"].as_array().into_iter().flatten() {
        line(&plain(&file["role"]), plain(&file["file"]));
    }
    for section in ["analyze", "synth"] {
        let values = recipe[section].as_object().into_iter().flatten();
        let values: Vec<String> =
            values.map(|(key, value)| format!("{} {}", escaped(key), plain(value))).collect();
        if !values.is_empty() {
            line(section, values.join(", "));
        }
    }
    let categories = found["categories"].as_array().filter(|list| !list.is_empty());
    if let Some(categories) = categories {
        text.push_str(&format!("\n{head}category     colour   elements  name{head:#}\n"));
        for c in categories {
            let [number, colour, elements, name] =
                ["category", "colour", "elements", "name"].map(|key| plain(&c[key]));
            text.push_str(&format!("{number:12} {colour:8} {elements:>8}  {name}\n"));
        }
    }
    if recipe.is_object() {
        text.push_str(&format!("\nmake it again: vtex texture PHOTO --again {}\n", escaped(name)));
    }
    text
}
