//! What the user asked for, checked as far as it can be without reading anything but the
//! configuration: from [`Cli`] to a job and what all jobs share.

use super::arguments::{
    Cli, Command, ControlArgs, EngineArgs, EngineName, ForceArgs, InspectArgs, MasksArgs, ModelsAction,
    PatternArgs, SamArgs, SegmenterName, TuneArgs, WarpArgs,
};
use super::batch::{Batch, Source};
use super::config::{Given, Layer, Parameters, RenderParameters, SvgParameters, Top};
use super::edit_arguments::{self, EditArgs, Editing};
use super::failure::Failure;
use super::format::{self, default_name, weights_path};
use super::input::Input;
use super::interp_arguments::Interpolating;
use super::metrics_arguments::MetricsArgs;
use super::output::{Place, Target};
use super::values::{Factors, Name, Seed};
use clap_complete::Shell;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use vtex::engine::{EngineOptions, Runtime};
use vtex::library::AnalyzeParams;
use vtex::output::file::{Format, Kind};
use vtex::scene::SynthParams;
use vtex::synth::tune::{TuneParams, TunedWeights};
use vtex::synth::{Controls, WarpParams};

/// What is to be done.
pub(crate) enum Options {
    /// Print the parameters.
    DumpConfig(String),
    /// Run a command.
    Job(Common, Box<Job>),
}

/// What all commands share.
#[derive(Clone, Debug)]
pub(crate) struct Common {
    /// Threads to use, if said.
    pub(crate) threads: Option<u16>,
    /// Whether no seed was given.
    pub(crate) seed_chosen: bool,
    pub(crate) quiet: bool,
    /// 0, 1 or 2.
    pub(crate) verbosity: u8,
    pub(crate) json: bool,
    pub(crate) debug_folder: Option<PathBuf>,
}

/// A command with its options.
pub(crate) enum Job {
    Texture(Box<Analysis>, Synthesis),
    Vectorize(Analysis, SvgParameters, Target),
    Analyze(Analysis, Target),
    Synth(Vec<Input>, Synthesis),
    Batch(Batch),
    Warp(Warping),
    Edit(Editing),
    Tune(Input, Tuning),
    Render(Input, RenderOptions),
    Metrics(MetricsArgs),
    Inspect(Vec<Input>, Option<PageOptions>),
    Interp(Interpolating),
    Doctor(EngineOptions),
    Models(ModelsJob),
    Completions(Shell),
    Man(PathBuf),
}

/// How a photograph is analyzed.
pub(crate) struct Analysis {
    pub(crate) photo: Input,
    pub(crate) masks: MasksFrom,
    pub(crate) engine: EngineOptions,
    pub(crate) save_masks: Option<Place>,
    pub(crate) parameters: AnalyzeParams,
}

/// Where masks come from.
#[derive(Clone, Debug)]
pub(crate) enum MasksFrom {
    /// Segment Anything if there is a model, else the texton network.
    Auto,
    Texton,
    Regions,
    Felzenszwalb,
    Sam(SamFrom),
    File(PathBuf),
}

/// Where a network of Segment Anything comes from.
#[derive(Clone, Debug)]
pub(crate) enum SamFrom {
    /// A model that was added, or the only one.
    Model(Option<Name>),
    Files(Vec<PathBuf>),
}

/// What is done with models.
pub(crate) enum ModelsJob {
    Add { files: Vec<PathBuf>, name: Name, force: bool, engine: EngineOptions },
    List,
    Verify,
    Remove(Name),
}

/// How a texture is made and written.
pub(crate) struct Synthesis {
    pub(crate) parameters: SynthParams,
    pub(crate) steering: Steering,
    pub(crate) svg: SvgParameters,
    pub(crate) target: Target,
    pub(crate) pattern: Option<Target>,
}

/// How a scene is bent and written.
pub(crate) struct Warping {
    pub(crate) scene: Input,
    pub(crate) libraries: Vec<Input>,
    pub(crate) how: How,
    pub(crate) parameters: WarpParams,
    pub(crate) svg: SvgParameters,
    pub(crate) target: Target,
}

/// What bends a scene.
pub(crate) enum How {
    /// Factors along x and y.
    Scale([f64; 2]),
    /// A cage, before and after.
    Cage([Input; 2]),
}

/// Files that steer synthesis.
#[derive(Debug, Default)]
pub(crate) struct Steering {
    pub(crate) domain: Option<DomainFrom>,
    pub(crate) density: Option<Input>,
    pub(crate) maps: Vec<Input>,
}

/// Where the shape to fill comes from.
#[derive(Debug)]
pub(crate) enum DomainFrom {
    Shape(Input),
    Mask(Input),
}

/// How weights are searched, and where they go.
pub(crate) struct Tuning {
    pub(crate) name: String,
    pub(crate) parameters: TuneParams,
    pub(crate) place: Place,
}

/// How a file is drawn.
pub(crate) struct RenderOptions {
    pub(crate) scale: RenderParameters,
    pub(crate) svg: SvgParameters,
    pub(crate) target: Target,
    pub(crate) pattern: Option<Target>,
}

/// What a page shows beside libraries and scene, and where it goes.
pub(crate) struct PageOptions {
    pub(crate) exemplars: Vec<Input>,
    pub(crate) place: Place,
}

impl Options {
    /// Checks a command line.
    ///
    /// # Errors
    /// Usage errors, and a configuration that cannot be read.
    pub(crate) fn resolve(cli: Cli) -> anyhow::Result<Self> {
        let Cli { global, command } = cli;
        let mut given = Given::default();
        given.add("", &Top { seed: global.seed, threads: global.threads });
        match &command {
            Some(Command::Texture(a)) => {
                given.add("analyze", &a.analyze);
                given.add("synth", &a.synth);
                given.add("svg", &a.svg);
            }
            Some(Command::Vectorize(a)) => {
                given.add("analyze", &a.analyze);
                given.add("svg", &a.svg);
            }
            Some(Command::Analyze(a)) => given.add("analyze", &a.analyze),
            Some(Command::Synth(a)) => {
                given.add("synth", &a.synth);
                given.add("synth", &a.background);
                given.add("svg", &a.svg);
            }
            Some(Command::Batch(a)) => {
                given.add("analyze", &a.analyze);
                given.add("synth", &a.synth);
                given.add("svg", &a.svg);
            }
            Some(Command::Render(a)) => {
                given.add("render", &a.render);
                given.add("svg", &a.svg);
            }
            Some(Command::Interp(a)) => {
                given.add("render", &a.render);
                given.add("svg", &a.svg);
            }
            Some(Command::Warp(a)) => given.add("svg", &a.svg),
            Some(Command::Edit(a)) => given.add("svg", &a.svg),
            Some(
                Command::Tune(_)
                | Command::Inspect(_)
                | Command::Metrics(_)
                | Command::Doctor(_)
                | Command::Models(_)
                | Command::Completions(_)
                | Command::Man(_),
            )
            | None => {}
        }
        let config = global.config.as_deref().map(Layer::read).transpose()?;
        let source = match &command {
            Some(Command::Batch(a)) if !a.input.is_empty() => Some(Source::new(&a.input)?),
            _ => None,
        };
        let defaults = source.as_ref().and_then(Source::defaults);
        let parameters = Parameters::resolve(config.iter().chain(defaults), &given)?;
        if global.dump_config {
            return Ok(Self::DumpConfig(parameters.dump()));
        }
        let command = command.ok_or_else(|| Failure::usage("no command is given"))?;
        let seed = parameters.seed.unwrap_or_else(Seed::chosen);
        let common = Common {
            threads: parameters.threads,
            seed_chosen: parameters.seed.is_none(),
            quiet: global.quiet,
            verbosity: global.verbose,
            json: global.json,
            debug_folder: global.debug_dir,
        };
        let job = match (command, source) {
            (Command::Batch(a), Some(source)) => {
                Job::Batch(Batch::new(*a, source, config.as_ref(), &given, seed, parameters.threads)?)
            }
            (command, _) => Job::resolve(command, parameters, seed)?,
        };
        Ok(Self::Job(common, Box::new(job)))
    }
}

impl Job {
    fn resolve(command: Command, parameters: Parameters, seed: Seed) -> anyhow::Result<Self> {
        let threads = parameters.threads;
        let Parameters { seed: given_seed, segmenter, analyze, synth, weights, svg, render, .. } = parameters;
        let analyze = AnalyzeParams { seed: seed.0, ..analyze };
        let mut synth = SynthParams { seed: seed.0, ..synth };
        Ok(match command {
            Command::Texture(a) => {
                let photo = required(a.photo)?;
                read_weights(weights, &photo, &mut synth)?;
                let output = a.output.clone();
                let target = target(a.output, &a.force, &photo, format::OF_SCENE, Format::Svg)?;
                let steering = Steering::new(a.control, Vec::new());
                steering.check(
                    &[("the photograph", &photo)],
                    &[("-o", output.as_deref()), ("--save-masks", a.masks.save_masks.as_deref())],
                )?;
                let analysis =
                    Analysis::new(photo, a.masks, &a.force, segmenter, threads, analyze, output.as_deref())?;
                Self::Texture(
                    Box::new(analysis),
                    Synthesis::new(synth, steering, svg, target, a.pattern, &a.force)?,
                )
            }
            Command::Vectorize(a) => {
                let photo = required(a.photo)?;
                let output = a.output.clone();
                let target = target(a.output, &a.force, &photo, format::OF_SCENE, Format::Svg)?;
                let analysis =
                    Analysis::new(photo, a.masks, &a.force, segmenter, threads, analyze, output.as_deref())?;
                Self::Vectorize(analysis, svg, target)
            }
            Command::Analyze(a) => {
                let photo = required(a.photo)?;
                let output = a.output.clone();
                let target = target(a.output, &a.force, &photo, format::OF_LIBRARY, Format::Library)?;
                Self::Analyze(
                    Analysis::new(photo, a.masks, &a.force, segmenter, threads, analyze, output.as_deref())?,
                    target,
                )
            }
            Command::Synth(a) => {
                let libraries: Vec<Input> = a.library.into_iter().map(Input::new).collect();
                let Some(first) = libraries.first() else {
                    return Err(Failure::usage("no input is given").into());
                };
                let output = a.output.clone();
                let target = target(a.output, &a.force, first, format::OF_SCENE, Format::Svg)?;
                let steering = Steering::new(a.control, a.map);
                let read: Vec<_> = libraries.iter().map(|file| ("the library", file)).collect();
                steering.check(&read, &[("-o", output.as_deref())])?;
                steering.check_counts(libraries.len())?;
                read_weights(weights, first, &mut synth)?;
                Self::Synth(libraries, Synthesis::new(synth, steering, svg, target, a.pattern, &a.force)?)
            }
            Command::Batch(_) => return Err(Failure::usage("no input is given").into()),
            Command::Warp(a) => {
                let parameters = WarpParams { seed: given_seed.map(|s| s.0), edge: a.edge };
                Self::Warp(Warping::new(a, parameters, svg)?)
            }
            Command::Edit(a) => Self::Edit(editing(a, given_seed, svg)?),
            Command::Tune(mut a) => {
                let library = required(a.library.take())?;
                read_weights(weights, &library, &mut synth)?;
                let tuning = Tuning::new(a, &library, synth)?;
                Self::Tune(library, tuning)
            }
            Command::Render(a) => {
                let file = required(a.file)?;
                let target = target(a.output, &a.force, &file, format::OF_SCENE, Format::Png)?;
                let pattern = pattern(a.pattern, &a.force, &target)?;
                Self::Render(file, RenderOptions { scale: render, svg, target, pattern })
            }
            Command::Metrics(a) => Self::Metrics(a),
            Command::Inspect(a) => {
                let files: Vec<Input> = a.file.iter().cloned().map(Input::new).collect();
                let page = PageOptions::new(a, &files)?;
                Self::Inspect(files, page)
            }
            Command::Interp(a) => Self::Interp(Interpolating::new(a, render, svg)?),
            Command::Doctor(a) => Self::Doctor(engine(a.engine, threads)),
            Command::Models(a) => Self::Models(match a.action {
                ModelsAction::Add(a) => ModelsJob::Add {
                    files: a.files,
                    name: a.name,
                    force: a.force,
                    engine: engine(a.engine, threads),
                },
                ModelsAction::List => ModelsJob::List,
                ModelsAction::Verify => ModelsJob::Verify,
                ModelsAction::Remove { name } => ModelsJob::Remove(name),
            }),
            Command::Completions(a) => Self::Completions(a.shell),
            Command::Man(a) => Self::Man(a.folder),
        })
    }
}

impl Warping {
    fn new(a: WarpArgs, parameters: WarpParams, svg: SvgParameters) -> Result<Self, Failure> {
        let scene = required(a.scene)?;
        let libraries: Vec<Input> = a.library.into_iter().map(Input::new).collect();
        let output = a.output.clone();
        let target = target(a.output, &a.force, &scene, format::OF_SCENE, Format::Svg)?;
        let how = match (a.scale, a.cage, a.to) {
            (Some(Factors(factors)), ..) => How::Scale(factors),
            (None, Some(cage), Some(to)) => How::Cage([cage, to].map(Input::new)),
            _ => {
                return Err(Failure::usage("nothing says how to bend the scene")
                    .hint("give --scale, or two cages with --cage and --to"));
            }
        };
        let mut read = vec![("the scene", &scene)];
        read.extend(libraries.iter().map(|file| ("the library", file)));
        if let How::Cage([cage, to]) = &how {
            read.extend([("--cage", cage), ("--to", to)]);
        }
        check_files(&read, &[("-o", output.as_deref())])?;
        Ok(Self { scene, libraries, how, parameters, svg, target })
    }
}

/// What is done to a scene.
fn editing(a: EditArgs, seed: Option<Seed>, svg: SvgParameters) -> anyhow::Result<Editing> {
    if a.list {
        return Ok(Editing::List);
    }
    let scene = required(a.scene)?;
    let operations = edit_arguments::operations(&a.op)?;
    let output = a.output.clone();
    let target = target(a.output, &a.force, &scene, format::OF_SCENE, Format::Svg)?;
    check_files(&[("the scene", &scene)], &[("-o", output.as_deref())])?;
    Ok(Editing::Edit { scene, operations, seed: seed.map(|s| s.0), svg, target })
}

impl Synthesis {
    fn new(
        parameters: SynthParams,
        steering: Steering,
        svg: SvgParameters,
        target: Target,
        pattern_args: PatternArgs,
        force: &ForceArgs,
    ) -> Result<Self, Failure> {
        let pattern = pattern(pattern_args, force, &target)?;
        if pattern.is_some() && !parameters.tile.both() {
            let message = "--pattern needs a texture that repeats along both axes";
            return Err(Failure::usage(message).hint("give --tile, for both axes"));
        }
        Ok(Self { parameters, steering, svg, target, pattern })
    }

    /// Fails now if a file could not be written later.
    ///
    /// # Errors
    /// As [`Place::probe`].
    pub(crate) fn probe(&self) -> vtex::Result<()> {
        self.target.place.probe()?;
        self.pattern.as_ref().map_or(Ok(()), |p| p.place.probe())
    }
}

impl Analysis {
    /// Fails now if the masks could not be saved later.
    ///
    /// # Errors
    /// As [`Place::probe`].
    pub(crate) fn probe(&self) -> vtex::Result<()> {
        self.save_masks.as_ref().map_or(Ok(()), Place::probe)
    }

    fn new(
        photo: Input,
        masks: MasksArgs,
        force: &ForceArgs,
        segmenter: SegmenterName,
        threads: Option<u16>,
        parameters: AnalyzeParams,
        output: Option<&Path>,
    ) -> Result<Self, Failure> {
        if let Some(path) = &masks.save_masks {
            format::check_masks_name(path)?;
        }
        let photo_path = match &photo {
            Input::File(path) => Some(path.as_path()),
            _ => None,
        };
        let read = [("the photograph", photo_path), ("--masks", masks.masks.as_deref())];
        let written = [("-o", output), ("--save-masks", masks.save_masks.as_deref())];
        apart(&[read[0], written[0], written[1]])?;
        apart(&[read[1], written[0]])?;
        let save_masks = masks.save_masks.map(|path| Place::File { path, force: force.force });
        let sam = SamFrom::new(masks.sam);
        let from = masks_from(masks.masks, segmenter, sam)?;
        let engine = engine(masks.engine, threads);
        Ok(Self { photo, masks: from, engine, save_masks, parameters })
    }
}

/// Where masks come from: a file, or what finds them.
pub(super) fn masks_from(
    file: Option<PathBuf>,
    segmenter: SegmenterName,
    sam: Option<SamFrom>,
) -> Result<MasksFrom, Failure> {
    Ok(match (file, segmenter, sam) {
        (None, SegmenterName::Sam, sam) => MasksFrom::Sam(sam.unwrap_or(SamFrom::Model(None))),
        (_, _, Some(_)) => {
            let message = "--model, --encoder and --decoder are for --segmenter sam";
            return Err(Failure::usage(message).hint("add --segmenter sam"));
        }
        (Some(file), ..) => MasksFrom::File(file),
        (None, SegmenterName::Auto, None) => MasksFrom::Auto,
        (None, SegmenterName::Texton, None) => MasksFrom::Texton,
        (None, SegmenterName::Regions, None) => MasksFrom::Regions,
        (None, SegmenterName::Felzenszwalb, None) => MasksFrom::Felzenszwalb,
    })
}

impl SamFrom {
    /// What was said of it, if anything.
    pub(super) fn new(args: SamArgs) -> Option<Self> {
        let files: Vec<PathBuf> = args.encoder.into_iter().chain(args.decoder).collect();
        if files.is_empty() {
            args.model.map(|name| Self::Model(Some(name)))
        } else {
            Some(Self::Files(files))
        }
    }
}

/// What networks run on.
pub(super) fn engine(args: EngineArgs, threads: Option<u16>) -> EngineOptions {
    let runtime = match args.engine.unwrap_or_default() {
        EngineName::Auto => Runtime::Auto,
        EngineName::OnnxRuntime => Runtime::OnnxRuntime,
        EngineName::Rten => Runtime::Rten,
    };
    EngineOptions { runtime, library: args.onnxruntime, threads: threads.map(usize::from) }
}

impl Steering {
    pub(super) fn new(control: ControlArgs, maps: Vec<PathBuf>) -> Self {
        let shape = control.domain.map(|path| DomainFrom::Shape(Input::new(path)));
        Self {
            domain: shape.or(control.mask.map(|path| DomainFrom::Mask(Input::new(path)))),
            density: control.density.map(Input::new),
            maps: maps.into_iter().map(Input::new).collect(),
        }
    }

    /// The files with their flags.
    pub(super) fn files(&self) -> impl Iterator<Item = (&'static str, &Input)> {
        let domain = self.domain.iter().map(|d| match d {
            DomainFrom::Shape(file) => ("--domain", file),
            DomainFrom::Mask(file) => ("--mask", file),
        });
        let density = self.density.iter().map(|file| ("--density", file));
        domain.chain(density).chain(self.maps.iter().map(|file| ("--map", file)))
    }

    /// Refuses that a file is read and written, or standard input read twice.
    fn check(
        &self,
        inputs: &[(&'static str, &Input)],
        written: &[(&str, Option<&Path>)],
    ) -> Result<(), Failure> {
        check_files(&inputs.iter().copied().chain(self.files()).collect::<Vec<_>>(), written)
    }

    /// Refuses a number of maps that does not fit the libraries.
    fn check_counts(&self, libraries: usize) -> Result<(), Failure> {
        let most = Controls::MOST_LIBRARIES;
        let maps = self.maps.len();
        let message = match (libraries, maps) {
            (1, 0) => return Ok(()),
            (1, _) => "--map is for several libraries, one is given".to_owned(),
            (n, _) if n > most => format!("{n} libraries are given, at most {most} make a scene"),
            (_, 1) => return Ok(()),
            (n, 0) => format!("{n} libraries are given, and nothing that says which is where"),
            (n, maps) if n == maps => return Ok(()),
            (n, maps) => format!("{maps} times --map is given for {n} libraries"),
        };
        Err(Failure::usage(message).hint("give one --map for all libraries, or one for each"))
    }
}

impl Tuning {
    fn new(a: TuneArgs, library: &Input, synth: SynthParams) -> anyhow::Result<Self> {
        let Input::File(beside) = library else {
            let failure = Failure::usage("the weights are written beside the library, so it must be a file");
            return Err(failure.hint("write the library to a file first").into());
        };
        let defaults = TuneParams::default();
        let (width, height) =
            a.search.size.map_or((defaults.synth.width, defaults.synth.height), |s| (s.width, s.height));
        let parameters = TuneParams {
            synth: SynthParams { width, height, ..synth },
            seeds: a.search.seeds.unwrap_or(defaults.seeds),
            evaluations: a.search.evaluations.unwrap_or(defaults.evaluations),
        };
        parameters.validate()?;
        let name = a.name.map_or("tuned".into(), |n| n.as_str().to_owned());
        let path = weights_path(beside, &name);
        Ok(Self { name, parameters, place: Place::File { path, force: a.force.force } })
    }
}

impl PageOptions {
    /// None if no page is asked for.
    fn new(a: InspectArgs, files: &[Input]) -> Result<Option<Self>, Failure> {
        let Some(output) = a.output else {
            if files.len() > 1 {
                return Err(Failure::usage("several files are shown on a page only")
                    .hint("name the page, as in -o report.html, or give one file at a time"));
            }
            return Ok(None);
        };
        let exemplars: Vec<Input> = a.exemplar.into_iter().map(Input::new).collect();
        let read = files.iter().map(|file| ("the input", file));
        let read: Vec<_> = read.chain(exemplars.iter().map(|file| ("--exemplar", file))).collect();
        check_files(&read, &[("-o", Some(&output))])?;
        if output.as_os_str() == "-" {
            return Ok(Some(Self { exemplars, place: Place::Stdout }));
        }
        format::check_page_name(&output)?;
        Ok(Some(Self { exemplars, place: Place::File { path: output, force: a.force.force } }))
    }
}

/// Replaces the weights by those of a name, which are in a file beside the library, or beside the
/// photograph of one.
pub(super) fn read_weights(
    name: Option<Name>,
    beside: &Input,
    synth: &mut SynthParams,
) -> anyhow::Result<()> {
    let Some(name) = name else { return Ok(()) };
    let name = name.as_str();
    let Input::File(beside) = beside else {
        let failure = Failure::usage(format!("the weights '{name}' are beside no file"));
        return Err(failure.hint("give the name of a file in place of -, or the weights as numbers").into());
    };
    let path = weights_path(beside, name);
    if !path.exists() {
        let library = default_name(beside, Format::Library);
        let library = beside.with_file_name(library.file_name().unwrap_or_default());
        let failure =
            Failure::failed(format!("there are no weights '{name}': cannot read '{}'", path.display()));
        let made = format!("'vtex tune {} --name {name}' makes them", library.display());
        return Err(failure.hint(made).into());
    }
    synth.weights = TunedWeights::read(&path)?.weights;
    Ok(())
}

/// Refuses that a file is read and written, or standard input read twice.
pub(super) fn check_files(read: &[(&str, &Input)], written: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    if read.iter().filter(|(_, file)| **file == Input::Stdin).count() > 1 {
        let failure = Failure::usage("'-' stands for more than one file");
        return Err(failure.hint("standard input can be read once"));
    }
    for (name, file) in read {
        if let Input::File(path) = file {
            for &other in written {
                apart(&[(name, Some(path.as_path())), other])?;
            }
        }
    }
    Ok(())
}

/// Refuses that one file is to hold two things: the later would destroy the earlier, `--force` or not.
fn apart(files: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    for (i, (name, path)) in files.iter().enumerate() {
        for (other, second) in &files[i + 1..] {
            if let (Some(a), Some(b)) = (path, second)
                && a == b
            {
                let message = format!("{name} and {other} name the same file, '{}'", a.display());
                return Err(Failure::usage(message).hint("give one of them another name"));
            }
        }
    }
    Ok(())
}

/// Where results go: as asked; else stdout if the input is stdin; else a file named after it.
pub(super) fn target(
    output: Option<PathBuf>,
    force: &ForceArgs,
    input: &Input,
    allowed: &[Format],
    usual: Format,
) -> Result<Target, Failure> {
    let path = match (output, input) {
        (Some(path), _) => path,
        (None, Input::Stdin) => Path::new("-").into(),
        (None, Input::File(path)) => default_name(path, usual),
    };
    if path.as_os_str() == "-" {
        if usual == Format::Png && std::io::stdout().is_terminal() {
            return Err(Failure::usage("a terminal cannot show a picture").hint("name a file with --output"));
        }
        return Ok(Target { place: Place::Stdout, kind: Kind { format: usual, gzip: false } });
    }
    let kind = format::kind_of("--output", &path, allowed)?;
    Ok(Target { place: Place::File { path, force: force.force }, kind })
}

/// Where a pattern goes: a file of its own.
fn pattern(args: PatternArgs, force: &ForceArgs, output: &Target) -> Result<Option<Target>, Failure> {
    let Some(path) = args.pattern else { return Ok(None) };
    let kind = format::kind_of("--pattern", &path, format::OF_PATTERN)?;
    apart(&[("the output", Some(output.place.path())), ("--pattern", Some(&path))])?;
    Ok(Some(Target { place: Place::File { path, force: force.force }, kind }))
}

/// An argument that the parser lets be missing only beside `--dump-config`.
pub(super) fn required(path: Option<PathBuf>) -> Result<Input, Failure> {
    path.map(Input::new).ok_or_else(|| Failure::usage("no input is given"))
}
