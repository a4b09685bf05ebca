//! Values for several options at once.

use crate::cli::config::ConfigLayer;
use crate::cli::failure::Failure;
use crate::cli::values::{OneOf, one_of};
use clap::Args;

/// The names of presets and what they set, as in a file for `--config`.
const PRESETS: [(&str, &str); 4] = [
    (
        "draft",
        "[analyze]\nmax-pixels = 150000\nsegmenter = \"regions\"\ncells = 1\nfidelity = 1.0\nshading = \"flat\"\n[synth]\nmoves = 1\ncandidates = 8\n",
    ),
    ("default", ""),
    (
        "fine",
        "[analyze]\nfidelity = 0.25\ndetail-scale = 5.0\n[synth]\nmoves = 10\ncandidates = 40\n[svg]\nprecision = 2\n",
    ),
    ("poster", "[analyze]\nfidelity = 1.0\nshading = \"flat\"\ncolors = 12\nmax-paths = 2000\n"),
];

/// A preset by its name.
#[derive(Args)]
pub(crate) struct PresetArgs {
    /// Start from the values of a preset; other options override them [draft, default, fine or poster,
    /// default: default]
    ///
    /// draft, for a quick look: --max-pixels 150000 --segmenter regions --cells 1 --fidelity 1 --shading flat
    /// --moves 1 --candidates 8;
    /// fine: --fidelity 0.25 --detail-scale 5 --moves 10 --candidates 40 --precision 2;
    /// poster: --fidelity 1 --shading flat --colors 12 --max-paths 2000
    #[arg(long, value_name = "NAME", value_parser = preset(), hide_possible_values = true)]
    pub(crate) preset: Option<String>,
}

fn preset() -> OneOf<String> {
    const NAMES: [&str; 4] = [PRESETS[0].0, PRESETS[1].0, PRESETS[2].0, PRESETS[3].0];
    one_of(&NAMES, |text| NAMES.contains(&text).then(|| text.to_owned()).ok_or_else(String::new))
}

impl PresetArgs {
    /// The values of the chosen preset.
    pub(crate) fn layer(&self) -> Result<Option<ConfigLayer>, Failure> {
        let found = self.preset.as_ref().and_then(|name| PRESETS.iter().find(|(known, _)| known == name));
        let Some((name, values)) = found else { return Ok(None) };
        let table = values.parse().map_err(|_| Failure::failed("a preset is damaged"))?;
        ConfigLayer::new(format!("--preset {name}"), table).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::config::{CommandLineValues, Parameters};
    use clap::CommandFactory;

    #[derive(clap::Parser)]
    struct Only {
        #[command(flatten)]
        preset: PresetArgs,
    }

    #[test]
    fn the_help_says_what_presets_set() {
        let command = Only::command();
        let help = command.get_arguments().next().and_then(|a| a.get_long_help()).unwrap().to_string();
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        for (name, values) in PRESETS {
            let layer = PresetArgs { preset: Some(name.into()) }.layer().unwrap();
            assert!(Parameters::resolve(&layer, &CommandLineValues::default()).is_ok());
            for line in values.lines().filter(|line| !line.starts_with('[')) {
                let (key, value) = line.split_once(" = ").unwrap();
                let value = value.trim_matches('"').trim_end_matches(".0");
                assert!(help.contains(&format!("--{key} {value}")), "{name}: {line}: {help}");
            }
        }
    }
}
