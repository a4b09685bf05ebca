//! Weights of the score from a file.

use super::failure::Failure;
use super::format::{default_name, weights_path};
use super::input::Input;
use super::values::Name;
use vtex::output::file::Format;
use vtex::scene::SynthParams;
use vtex::tune::TunedWeights;

/// Replaces the weights by named ones, from a file beside the library or beside its photograph.
pub(crate) fn read_weights(
    name: Option<Name>,
    beside: &Input,
    synth: &mut SynthParams,
) -> anyhow::Result<()> {
    let Some(name) = name else { return Ok(()) };
    let name = name.as_str();
    let Input::File(beside) = beside else {
        let failure = Failure::usage(format!("the weights '{name}' are beside no file"));
        return Err(failure.hint("give the name of a file in place of -, or the weights as numbers").into());
    };
    let path = weights_path(beside, name);
    if !path.exists() {
        let library = default_name(beside, "", Format::Library);
        let library = beside.with_file_name(library.file_name().unwrap_or_default());
        let failure =
            Failure::failed(format!("there are no weights '{name}': cannot read '{}'", path.display()));
        let made = format!("'vtex tune {} --name {name}' makes them", library.display());
        return Err(failure.hint(made).into());
    }
    synth.weights = TunedWeights::read(&path)?.weights;
    Ok(())
}
