//! Groups of options that several commands share: as types for clap, and as checked values.

pub(crate) mod analyze;
pub(crate) mod context;
pub(crate) mod control;
pub(crate) mod engine;
pub(crate) mod files;
pub(crate) mod frames;
pub(crate) mod global;
pub(crate) mod layers;
pub(crate) mod masks;
pub(crate) mod pattern;
pub(crate) mod preset;
pub(crate) mod render;
pub(crate) mod svg;
pub(crate) mod synth;
pub(crate) mod variants;

/// Puts options of groups among those that `-h` lists.
pub(crate) fn common(ids: &'static [&'static str]) -> impl Fn(clap::Arg) -> clap::Arg {
    move |option| {
        if ids.contains(&option.get_id().as_str()) {
            option.help_heading(None::<&'static str>)
        } else {
            option
        }
    }
}
