//! Arguments that are searched for before the command line is parsed.

use super::options::global::When;
use super::values::Axes;
use clap::ValueEnum;
use std::ffi::OsString;

/// The arguments with the value of `--tile` joined to it. The option may have no value, so the parser takes
/// no value after a space; a following word that can only be its value is joined.
pub(crate) fn joined(arguments: Vec<OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::with_capacity(arguments.len());
    let mut ended = false;
    for argument in arguments {
        ended |= argument == "--";
        let value = argument.to_str().filter(|v| Axes::NAMES.contains(v));
        match (value, joined.last_mut()) {
            (Some(value), Some(last)) if !ended && last == "--tile" => {
                last.push("=");
                last.push(value);
            }
            _ => joined.push(argument),
        }
    }
    joined
}

/// The value of `--color`, searched for before parsing so that it applies to errors of parsing too.
pub(crate) fn colour_choice(arguments: &[OsString]) -> When {
    let mut choice = When::default();
    let mut rest = arguments.iter().skip(1).map_while(|a| (a != "--").then(|| a.to_string_lossy()));
    while let Some(argument) = rest.next() {
        let value = match argument.strip_prefix("--color") {
            Some("") => rest.next(),
            Some(v) => v.strip_prefix('=').map(|v| v.to_owned().into()),
            None => None,
        };
        if let Some(when) = value.and_then(|v| When::from_str(&v, false).ok()) {
            choice = when;
        }
    }
    choice
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_join_the_option_before_them() {
        let joined = |line: &str| {
            let all = joined(line.split(' ').map(OsString::from).collect());
            all.iter().map(|a| a.to_string_lossy()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(joined("vtex synth --tile x a.json"), "vtex synth --tile=x a.json");
        assert_eq!(joined("vtex synth a.json --tile none"), "vtex synth a.json --tile=none");
        for same in [
            "vtex synth --tile a.json",
            "vtex synth --tile=y x",
            "vtex synth --tile",
            "vtex synth x --tile -- x",
            "vtex synth -- --tile x",
            "x",
        ] {
            assert_eq!(joined(same), same);
        }
    }
}
