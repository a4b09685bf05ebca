//! `vtex studio`: a page on one's own machine, to see, mend, steer, change and save a texture.

mod calls;
mod categories;
mod command_lines;
mod drawing;
mod follower;
mod knobs;
mod opened;
mod renumbering;
mod results;
mod session;
mod settings;
mod stages;
mod state;
mod worker;

use crate::cli::command::{Arguments, Job, Resolved};
use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::input::Input;
use crate::cli::number::Takes;
use crate::cli::output::say;
use crate::cli::values::Seed;
use calls::{StudioApp, begun};
use clap::Args;
use opened::{DOCUMENT, Opened};
use session::{Session, WorkSession};
use settings::StudioSettings;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use vtex::Parameter;
use vtex_studio::work::StudioWork;
use vtex_studio::{Bounds, StudioServer, open_address};

const PORT: Parameter<u16> = Parameter::new("port", [0, u16::MAX], "").or(0);
const IDLE: Parameter<u32> = Parameter::new("idle-exit", [1, 604_800], "seconds");

/// Open a page in the browser: see, correct, steer, change, save
#[derive(Args)]
#[command(
    override_usage = "vtex studio [OPTIONS] [FILE]...",
    after_long_help = "\
Examples:
  vtex studio photo.jpg
  vtex studio swatch.svg photo.lib.json
  vtex studio photo.jpg --no-open --port 8080

The page is served to this computer only, and nothing is uploaded. Its address
contains a key: do not share it. Your work is saved beside photo.jpg, in
photo.jpg.vtex-studio.json. Open the photograph again to continue."
)]
pub(crate) struct StudioArgs {
    /// Photographs, SVG drawings, libraries, scenes, or saved work (.vtex-studio.json)
    #[arg(value_name = "FILE")]
    file: Vec<PathBuf>,
    /// Folder for files that you drop on the page, and for the work on them [default: the current one]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Port of the page's address; 0: any free port
    #[arg(long, number = PORT)]
    port: Option<u16>,
    /// Print the page's address, and open no browser
    #[arg(long)]
    no_open: bool,
    /// End after no page has been open for this time
    #[arg(long, number_or(IDLE, "not before Ctrl-C"), value_name = "SECONDS")]
    idle_exit: Option<u32>,
}

impl Arguments for StudioArgs {
    fn job(self: Box<Self>, resolved: Resolved) -> anyhow::Result<Job> {
        let seed = resolved.parameters.seed.filter(|_| resolved.values.has_seed());
        Ok(Box::new(move |common, _| run(common, *self, seed)))
    }
}

fn run(common: &Common, arguments: StudioArgs, seed: Option<Seed>) -> anyhow::Result<()> {
    let StudioArgs { file, folder, port, no_open, idle_exit } = arguments;
    let folder = folder.unwrap_or_default();
    if !folder.as_os_str().is_empty() && !folder.is_dir() {
        return Err(Failure::failed(format!("'{}' is not a folder", folder.display())).into());
    }
    let sessions = file.into_iter().map(|path| opened(path, seed)).collect::<anyhow::Result<Vec<_>>>()?;
    let port = port.unwrap_or(PORT.default());
    let server = StudioServer::bind(port, Bounds::default()).map_err(|e| {
        let failure = Failure::failed(format!("cannot listen on port {port}: {e}"));
        failure.hint("use another --port, or omit it")
    })?;
    let session = Arc::new(Session::new(sessions, common.threads, seed, folder));
    // Without it nobody could reach the page, so it is said with --quiet too.
    say(&format!("The studio is at {}", server.guard().address()));
    if !common.quiet {
        say("Ctrl-C ends it");
    }
    if !no_open && let Err(e) = open_address(&server.guard().ticket_address()) {
        say(&format!("no browser could be opened ({e}): open the address above"));
    }
    let (app, events) = (Arc::new(StudioApp(Arc::clone(&session))), session.events.clone());
    let idle = idle_exit.map(|seconds| Duration::from_secs(seconds.into()));
    let ended = Arc::clone(&session);
    let serving = std::thread::Builder::new().spawn(move || {
        let served = server.run(app, events, idle, || ended.has_ended());
        ended.end();
        served
    })?;
    worker::work(&session);
    session.end();
    let served = serving.join().map_err(|_| Failure::failed("the server broke off"))?;
    Ok(served.map_err(|e| Failure::failed(format!("the server broke off: {e}")))?)
}

/// Opens a file of the command line, with the work of last time.
fn opened(path: PathBuf, seed: Option<Seed>) -> anyhow::Result<WorkSession> {
    let input = Input::File(path.clone());
    let bytes = input.read()?;
    if !path.to_string_lossy().ends_with(DOCUMENT) {
        return Ok(with_seed(begun(Opened::new(path, bytes)?, seed), seed));
    }
    let work = StudioWork::from_bytes(bytes, &input.name())?;
    let file = Input::File(path.with_file_name(&work.input.file));
    let opened = Opened::new(file.path().to_owned(), file.read()?)?;
    Ok(with_seed(begun(Opened { document: Some(path), ..opened }, seed), seed))
}

/// The seed of the command line is newer than that of the work of last time, which undo brings back.
fn with_seed(mut one: WorkSession, seed: Option<Seed>) -> WorkSession {
    if let Some(Seed(seed)) = seed {
        one.change("", StudioSettings { analysis_seed: seed, seed, ..one.settings().clone() });
    }
    one
}
