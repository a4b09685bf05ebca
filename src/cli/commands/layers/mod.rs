//! `vtex layers`: photograph, layer map or heights → a new map.

mod arguments;
mod run;

pub(crate) use arguments::LayersArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use arguments::Mapping;

impl Arguments for LayersArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let job = Mapping::new(*self, resolved.seed.0)?;
        Ok(Box::new(move |common, reporter| run::run(common, reporter, &job)))
    }
}
