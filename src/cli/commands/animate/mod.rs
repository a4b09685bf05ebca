//! `vtex animate`: a scene carried by a flow, or two scenes → frames, an animation, or a scene between
//! the two.

mod arguments;
mod between;
mod flow;
mod play;

pub(crate) use arguments::AnimateArgs;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::config::CommandLineValues;
use crate::cli::input::Input;
use crate::cli::options::files::required;
use crate::cli::output::DrawingOptions;
use between::Between;
use flow::Flowed;

impl Arguments for AnimateArgs {
    fn collect(&self, values: &mut CommandLineValues) {
        values.add("render", &self.render);
        values.add("svg", &self.svg);
    }

    fn job(mut self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let (svg, render) = (resolved.parameters.svg, resolved.parameters.render);
        let drawing = DrawingOptions { svg, render, recipe: None };
        let scene = required(self.scene.take())?;
        if let Some(to) = self.to.take().map(Input::new) {
            let job = Between::new(*self, scene, to, drawing)?;
            return Ok(Box::new(move |common, reporter| between::run(common, reporter, &job)));
        }
        let job = Flowed::new(*self, scene, resolved.seed.0, drawing)?;
        Ok(Box::new(move |common, reporter| flow::run(common, reporter, &job)))
    }
}
