//! `vtex metrics`: how alike an exemplar and a result are.

mod arrangement;
mod pictures;

use crate::cli::failure::Failure;
use crate::cli::input::{Input, Kind};
use crate::cli::metrics_arguments::MetricsArgs;
use crate::cli::options::Common;
use crate::cli::output::{print, print_styled};
use crate::cli::progress::Reporter;
use serde::Serialize;
use vtex::library::Library;
use vtex::scene::Scene;

/// What a file holds.
enum Content {
    Library(Box<Library>),
    Scene(Box<Scene>),
    Svg(Vec<u8>),
    Image(Vec<u8>),
}

pub(super) fn run(common: &Common, reporter: &Reporter, arguments: &MetricsArgs) -> anyhow::Result<()> {
    let inputs = [&arguments.exemplar, &arguments.result].map(|path| Input::new(path.clone()));
    if inputs.iter().all(|input| *input == Input::Stdin) {
        let failure = Failure::usage("'-' stands for both files");
        return Err(failure.hint("standard input can be read once").into());
    }
    reporter.stage("reading")?;
    let [exemplar, result] = [Content::read(&inputs[0])?, Content::read(&inputs[1])?];
    let names = inputs.map(|input| input.name());
    match (&exemplar, &result) {
        (Content::Library(library), Content::Scene(scene)) => {
            if arguments.scale != 1.0 {
                let failure = Failure::usage("--scale is for pictures; a scene has the scale of its library");
                return Err(failure.hint("leave it away, or give a picture of one of them").into());
            }
            arrangement::run(common, reporter, names, library, scene)
        }
        _ => pictures::run(common, reporter, names, &exemplar, &result, arguments.scale),
    }
}

impl Content {
    fn read(input: &Input) -> anyhow::Result<Self> {
        let bytes = input.read()?;
        let name = input.name();
        Ok(match Kind::of(&bytes) {
            Kind::Library => Self::Library(Box::new(Library::from_bytes(&bytes, &name)?)),
            Kind::Scene => Self::Scene(Box::new(Scene::from_bytes(&bytes, &name)?)),
            Kind::Svg => Self::Svg(bytes),
            // What is nothing known may still be a damaged picture, and decoding it says so.
            Kind::Image | Kind::Unknown => Self::Image(bytes),
        })
    }
}

/// Prints JSON, or a text for people.
fn tell(common: &Common, found: &impl Serialize, text: impl FnOnce() -> String) -> anyhow::Result<()> {
    if common.json {
        let mut json = serde_json::to_string_pretty(found)?;
        json.push('\n');
        return print(json.as_bytes());
    }
    print_styled(&text())
}

/// A number with four digits that count.
fn digits(value: f64) -> String {
    let whole = digits_before_the_point(value.abs());
    format!("{value:.*}", 4usize.saturating_sub(whole))
}

/// Digits before the point.
fn digits_before_the_point(mut value: f64) -> usize {
    let mut count = 0;
    while value >= 1.0 && count < 20 {
        value /= 10.0;
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let shown = [0.0, 0.00123, 0.5, 1.0, 12.3456, -123.456, 98765.4].map(digits);
        assert_eq!(shown, ["0.0000", "0.0012", "0.5000", "1.000", "12.35", "-123.5", "98765"]);
    }
}
