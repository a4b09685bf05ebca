//! `vtex batch`: many photographs or libraries → textures.

mod arguments;
mod jobs;
mod plan;
mod record;
mod run;
mod tell;
mod values;

pub(crate) use arguments::BatchArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::config::{Given, Layer};
use crate::cli::failure::Failure;
use jobs::Source;
use plan::Batch;

impl Arguments for BatchArgs {
    fn give(&self, given: &mut Given) {
        given.add("analyze", &self.analyze);
        given.add("synth", &self.synth);
        given.add("render", &self.render);
        given.add("svg", &self.svg);
    }

    fn layer(&mut self) -> anyhow::Result<Option<&Layer>> {
        if !self.input.is_empty() {
            self.source = Some(Source::new(&self.input)?);
        }
        Ok(self.source.as_ref().and_then(Source::defaults))
    }

    fn preset(&self) -> Result<Option<Layer>, Failure> {
        self.preset.layer()
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let batch = Batch::new(*self, &resolved)?;
        Ok(Box::new(move |common, _| run::run(common, &batch)))
    }
}
