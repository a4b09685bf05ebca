//! `vtex interp`: two scenes → frames, an animation, or a scene between them.

mod arguments;
mod run;

pub(crate) use arguments::InterpArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::config::CommandLineValues;
use arguments::Interpolating;

impl Arguments for InterpArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let job = Interpolating::new(*self, &resolved.parameters)?;
        Ok(Box::new(move |common, reporter| run::run(common, reporter, &job)))
    }
}
