//! `vtex completions`: what a shell sources.

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::output;
use clap::Args;
use clap_complete::Shell;

/// Print completions for a shell
#[derive(Args)]
#[command(
    hide = true,
    after_long_help = "\
Examples:
  vtex completions bash > ~/.local/share/bash-completion/completions/vtex
  vtex completions zsh > ~/.zfunc/_vtex
  vtex completions fish > ~/.config/fish/completions/vtex.fish"
)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

impl Arguments for CompletionsArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        Ok(Box::new(move |_, _| run(self.shell, (resolved.program)())))
    }
}

fn run(shell: Shell, mut command: clap::Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, "vtex", &mut script);
    output::print(&script)
}
