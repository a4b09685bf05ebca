//! Several textures that differ by their seed.

use crate::cli::failure::Failure;
use crate::cli::format::numbered;
use crate::cli::number::Takes;
use crate::cli::output::{Destination, Target, Targets};
use clap::Args;
use vtex::Parameter;
use vtex::output::file::Format;

/// Several textures that differ by their seed.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Output")]
pub(crate) struct VariantsArgs {
    /// Make several textures, with this seed and the seeds after it; each file name gets its seed, such as
    /// out-7.svg
    #[arg(long, number = Parameter::<u32>::new("variants", [1, 1000], "").or(1))]
    pub(crate) variants: Option<u32>,
}

impl VariantsArgs {
    /// Number of textures.
    ///
    /// # Errors
    /// Several of them on standard output.
    pub(crate) fn count(self, targets: &Targets) -> Result<u64, Failure> {
        let count = u64::from(self.variants.unwrap_or(1));
        if count > 1 && targets.piped() {
            let failure = Failure::usage("several variants cannot be written to standard output");
            return Err(failure.hint("name a file with -o: each variant has its seed in its name"));
        }
        Ok(count)
    }
}

/// The files of the variant of a seed. A library is the same for all.
pub(crate) fn of_seed(targets: &Targets, seed: u64) -> Targets {
    let others = targets.others.iter().map(|target| target_of_seed(target, seed)).collect();
    Targets { first: target_of_seed(&targets.first, seed), others }
}

/// The file of the variant of a seed.
pub(crate) fn target_of_seed(target: &Target, seed: u64) -> Target {
    let place = match &target.place {
        Destination::File { path, force } if target.kind.format != Format::Library => {
            Destination::File { path: numbered(path, seed), force: *force }
        }
        place => place.clone(),
    };
    Target { place, kind: target.kind }
}
