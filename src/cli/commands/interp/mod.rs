//! `vtex interp`: two scenes → frames, an animation, or a scene between them.

mod arguments;
mod run;

pub(crate) use arguments::InterpArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::config::Given;
use arguments::Interpolating;

impl Arguments for InterpArgs {
    fn give(&self, given: &mut Given) {
        given.add("render", &self.render);
        given.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let job = Interpolating::new(*self, &resolved.parameters)?;
        Ok(Box::new(move |common, reporter| run::run(common, reporter, &job)))
    }
}
