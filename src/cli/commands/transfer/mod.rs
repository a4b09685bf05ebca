//! `vtex transfer`: the arrangement of one texture, or a picture, with the appearance of others.

mod arguments;
mod onto;
mod texture;

pub(crate) use arguments::TransferArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::config::CommandLineValues;
use onto::Redrawing;
use texture::Transferring;

impl Arguments for TransferArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        if self.onto.is_some() {
            let job = Redrawing::new(*self, &resolved)?;
            return Ok(Box::new(move |common, reporter| onto::run(common, reporter, &job)));
        }
        let job = Transferring::new(*self, &resolved)?;
        Ok(Box::new(move |common, reporter| texture::run(common, reporter, &job)))
    }
}
