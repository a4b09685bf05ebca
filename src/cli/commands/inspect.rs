//! `vtex inspect`: what a library or a scene holds.

use crate::cli::input::{Input, Kind};
use crate::cli::options::Common;
use crate::cli::output;
use crate::cli::summary::Counts;
use vtex::library::Library;
use vtex::scene::Scene;

pub(super) fn run(_common: &Common, input: &Input) -> anyhow::Result<()> {
    let bytes = input.read()?;
    let name = input.name();
    let counts = match Kind::expect(&bytes, input, &[Kind::Library, Kind::Scene])? {
        Kind::Library => Counts::of_library(&Library::from_bytes(&bytes, &name)?),
        _ => Counts::of_scene(&Scene::from_bytes(&bytes, &name)?),
    };
    output::print_styled(&format!("{counts:#?}\n"))
}
