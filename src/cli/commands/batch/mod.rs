//! `vtex batch`: many photographs or libraries → textures.

mod arguments;
mod jobs;
mod plan;
mod record;
mod reporting;
mod run;
mod values;

pub(crate) use arguments::BatchArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::config::{CommandLineValues, ConfigLayer};
use crate::cli::failure::Failure;
use jobs::JobSource;
use plan::Batch;

impl Arguments for BatchArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("analyze", &self.analyze);
        values.add("synth", &self.synth);
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn layer(&mut self) -> anyhow::Result<Option<&ConfigLayer>> {
        if !self.input.is_empty() {
            self.source = Some(JobSource::new(&self.input)?);
        }
        Ok(self.source.as_ref().and_then(JobSource::defaults))
    }

    fn preset(&self) -> Result<Option<ConfigLayer>, Failure> {
        self.preset.layer()
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let batch = Batch::new(*self, &resolved)?;
        Ok(Box::new(move |common, _| run::run(common, &batch)))
    }
}
