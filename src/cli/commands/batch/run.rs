//! Runs all jobs; a job that fails does not end the others.

use super::jobs::BatchJob;
use super::plan::Batch;
use super::record::{Record, RecordedFile, Records, Status, key, sum};
use super::reporting::{Total, print_record, thousandths};
use super::values::Extension;
use crate::cli::analysis::{Analysis, analyze, finds_masks};
use crate::cli::common::Common;
use crate::cli::config::Parameters;
use crate::cli::exit::Exit;
use crate::cli::failure::{Failure, explain};
use crate::cli::input::{Input, InputKind};
use crate::cli::interrupt;
use crate::cli::options::analyze::SegmenterName;
use crate::cli::options::layers::LayerFiles;
use crate::cli::options::render::RenderParameters;
use crate::cli::options::svg::SvgParameters;
use crate::cli::output::{Destination, DrawingOptions, Target, say};
use crate::cli::panics::guarded;
use crate::cli::progress::Reporter;
use crate::cli::reading;
use crate::cli::recipe;
use crate::cli::values::{Resolution, Seed, Wrap};
use crate::cli::weights::read_weights;
use serde::Serialize;
use serde_json::Value;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::Instant;
use vtex::library::{AnalyzeParams, Library};
use vtex::output::file::Format;
use vtex::scene::{Scene, SynthParams};
use vtex::synth::{SynthReport, synthesize_with};
use vtex::{Error, Progress};

/// Everything that results depend on, except the program's version.
#[derive(Serialize)]
struct ResultInputs<'a> {
    program: &'static str,
    /// SHA-256 of the input.
    input: String,
    /// SHA-256 of the files that steer synthesis, with their flags.
    steering: Vec<(&'static str, String)>,
    /// For a photograph: the segmenter, with the checksums of its networks.
    masks: Option<String>,
    analyze: Option<&'a AnalyzeParams>,
    /// Whether the exemplar tiles; `auto` if analysis decides.
    wrap: Wrap,
    synth: &'a SynthParams,
    svg: SvgParameters,
    render: RenderParameters,
}

/// Segmenters by name: networks are large and read once for all jobs.
#[derive(Default)]
struct Finders(RefCell<BTreeMap<SegmenterName, String>>);

impl Finders {
    /// Everything that the masks of a job depend on besides its photograph and its parameters.
    fn of(&self, batch: &Batch, job: &BatchJob) -> anyhow::Result<String> {
        let name = job.parameters.segmenter;
        if let Some(known) = self.0.borrow().get(&name) {
            return Ok(known.clone());
        }
        let found = finds_masks(&job.masks, &batch.engine)?;
        self.0.borrow_mut().insert(name, found.clone());
        Ok(found)
    }
}

/// A job with all its parameters resolved.
struct ResolvedJob<'a> {
    batch: &'a Batch,
    job: &'a BatchJob,
    finders: &'a Finders,
    common: Common,
    input: Input,
    analyze: AnalyzeParams,
    synth: SynthParams,
}

/// Number of times that the program ends during a job until the job is left out. The first may be a power cut.
const DEATHS: usize = 2;

/// A texture that is not written yet.
struct UnwrittenTexture {
    /// The library made from a photograph, or the input library.
    library: Library,
    /// For a photograph: the recipe of the texture.
    recipe: Option<Value>,
    scene: Scene,
    report: SynthReport,
}

pub(super) fn run(common: &Common, batch: &Batch) -> anyhow::Result<()> {
    std::fs::create_dir_all(&batch.out_dir).map_err(|e| Error::write(&batch.out_dir, e))?;
    let records = Records::open(&batch.out_dir, batch.shard)?;
    let all = batch.jobs.iter().enumerate();
    let mine: Vec<&BatchJob> = all.filter(|(i, _)| batch.shard.holds(*i)).map(|(_, job)| job).collect();
    let finders = Finders::default();
    let began = Instant::now();
    let mut reported = Vec::new();
    for (i, job) in mine.iter().enumerate() {
        if interrupt::is_requested() {
            break;
        }
        if !common.quiet && !common.json {
            say(&format!("[{}/{}] {}", i + 1, mine.len(), job.input.display()));
        }
        let Some(record) = one(common, batch, job, &finders, &records) else { break };
        if record.status != Status::Skipped {
            records.add(&record)?;
        }
        print_record(common, &record)?;
        reported.push(record);
    }
    let count = |status| reported.iter().filter(|r: &&Record| r.status == status).count();
    let total = Total {
        program: vtex::PROGRAM,
        command: "batch",
        shard: batch.shard.to_string(),
        jobs: mine.len(),
        done: count(Status::Done),
        skipped: count(Status::Skipped),
        failed: count(Status::Failed),
        seconds: thousandths(began.elapsed().as_secs_f64()),
    };
    total.print(common, &reported)?;
    interrupt::check()?;
    if total.failed > 0 {
        let failure = Failure::failed(format!("{} of {} jobs failed", total.failed, total.jobs));
        let hint = "mend what the errors say, then run the same again: it does only these";
        return Err(failure.hint(hint).reported_already().into());
    }
    Ok(())
}

/// Runs a job and records how it ended. `None` if the user stopped it.
fn one(
    common: &Common,
    batch: &Batch,
    job: &BatchJob,
    finders: &Finders,
    records: &Records,
) -> Option<Record> {
    let began = Instant::now();
    let mut record = Record {
        job: job.name.clone(),
        input: job.input.display().to_string(),
        status: Status::Done,
        key: String::new(),
        seed: None,
        size: None,
        primaries: None,
        coverage: None,
        outputs: Vec::new(),
        seconds: 0.0,
        error: None,
        hint: None,
        died: false,
        warnings: Vec::new(),
    };
    // A panic in one job must not end the others.
    let done = guarded(|| ResolvedJob::new(common, batch, job, finders)?.complete(&mut record, records));
    if let Err(error) = done {
        let (message, hint, exit) = explain(&error);
        if exit == Exit::Interrupted {
            return None;
        }
        record.status = Status::Failed;
        (record.error, record.hint) = (Some(message), hint);
    }
    record.seconds = thousandths(began.elapsed().as_secs_f64());
    Some(record)
}

impl<'a> ResolvedJob<'a> {
    fn new(
        common: &Common,
        batch: &'a Batch,
        job: &'a BatchJob,
        finders: &'a Finders,
    ) -> anyhow::Result<Self> {
        let input = Input::File(job.input.clone());
        let seed = job.parameters.seed.unwrap_or(batch.seed).0;
        let analyze = AnalyzeParams { seed, ..job.parameters.analyze.clone() };
        let mut synth = SynthParams { seed, ..job.parameters.synth.clone() };
        read_weights(job.parameters.weights.clone(), &input, &mut synth)?;
        let debug_folder = common.debug_folder.as_ref().map(|folder| folder.join(&job.name));
        Ok(Self {
            batch,
            job,
            finders,
            common: Common { debug_folder, ..common.clone() },
            input,
            analyze,
            synth,
        })
    }

    /// Skips a job that is done; otherwise makes and writes all results.
    fn complete(&self, record: &mut Record, records: &Records) -> anyhow::Result<()> {
        let bytes = self.input.read()?;
        let is_library = InputKind::expect(
            &bytes,
            &self.input,
            &[InputKind::Library, InputKind::Image, InputKind::Svg, InputKind::Unknown],
        )? == InputKind::Library;
        record.key = self.key(&bytes, is_library)?;
        drop(bytes);
        let files: Vec<String> = self.job.files().collect();
        let is_forced = self.batch.forces(self.job);
        if let Some(known) = records.done(&record.job, &record.key, &files).filter(|_| !is_forced) {
            *record = Record { status: Status::Skipped, input: record.input.clone(), ..known.clone() };
            return Ok(());
        }
        let deaths = records.deaths(&record.job, &record.key);
        if !is_forced && deaths >= DEATHS {
            record.died = true;
            let failure = Failure::failed("the program was killed twice during this job, so it is left out");
            let hint = format!(
                "give more memory, another input or other parameters; --force={} tries it again, and please \
                 report it if vtex itself ended",
                self.job.name
            );
            return Err(failure.hint(hint).into());
        }
        let _running = records.begin(record)?;
        let reporter = Reporter::new(&self.common)?;
        if deaths > 0 {
            reporter.warn("the program was killed during this job in an earlier run; this is another try");
        }
        let outcome = self.make(&reporter, is_library).and_then(|made| {
            reporter.stage("writing")?;
            for target in self.targets() {
                let written = made.write(&target, self.job.parameters.svg, self.job.parameters.render)?;
                written.iter().for_each(|warning| reporter.warn(warning));
            }
            Ok(made)
        });
        record.warnings = reporter.finish().1;
        // Work also stops if a picture of a stage cannot be written; that error is then the reason.
        let made = match reporter.failure() {
            Some(reason) => return Err(reason.into()),
            None => outcome?,
        };
        let written = files.iter().map(|file| RecordedFile::of(&self.batch.out_dir, file));
        record.outputs = written.collect::<vtex::Result<_>>()?;
        record.seed = Some(self.synth.seed);
        record.size = Some(made.scene.picture_size(1.0));
        record.primaries = Some(made.scene.of_role(vtex::scene::Role::Primary).count());
        record.coverage = Some([made.report.coverage_wanted, made.report.coverage]);
        Ok(())
    }

    /// The checksum of everything that results depend on, except a seed that was not given, because it
    /// differs in every run.
    fn key(&self, input: &[u8], is_library: bool) -> anyhow::Result<String> {
        let given = self.job.parameters.seed.is_some();
        let seed = |seed: u64| if given { seed } else { 0 };
        let analyze = AnalyzeParams { seed: seed(self.analyze.seed), ..self.analyze.clone() };
        let synth = SynthParams { seed: seed(self.synth.seed), ..self.synth.clone() };
        let steering = self.batch.steering.files().map(|(flag, file)| Ok((flag, sum(&file.read()?))));
        Ok(key(&ResultInputs {
            program: vtex::PROGRAM,
            input: sum(input),
            steering: steering.collect::<vtex::Result<_>>()?,
            masks: (!is_library).then(|| self.finders.of(self.batch, self.job)).transpose()?,
            analyze: (!is_library).then_some(&analyze),
            wrap: self.job.parameters.wrap,
            synth: &synth,
            svg: self.job.parameters.svg,
            render: self.job.parameters.render,
        }))
    }

    fn targets(&self) -> Vec<Target> {
        let target = |(file, format): (String, Extension)| Target {
            place: Destination::File {
                path: self.batch.out_dir.join(file),
                force: self.batch.forces(self.job),
            },
            kind: format.0,
        };
        self.job.files().zip(self.job.formats.iter().copied()).map(target).collect()
    }

    fn make(&self, reporter: &Reporter, is_library: bool) -> anyhow::Result<UnwrittenTexture> {
        // Faults of the options are reported before the long work.
        self.targets().iter().try_for_each(|target| target.place.probe())?;
        let mut controls = reading::controls(&self.batch.steering, &self.synth, 1, &Input::read)?;
        let mut recipe = None;
        let mut libraries = if is_library {
            reporter.stage("reading")?;
            reading::libraries(std::slice::from_ref(&self.input))?
        } else {
            let analysis = Analysis {
                layers: LayerFiles::default(),
                input: self.input.clone(),
                masks: self.job.masks.clone(),
                engine: self.batch.engine.clone(),
                save_masks: None,
                parameters: self.analyze.clone(),
                wrap: self.job.parameters.wrap.choice(),
                looks_at_borders: true,
                places: true,
            };
            let library = analyze(&self.common, &analysis, reporter)?;
            let parameters = Parameters {
                seed: Some(Seed(self.synth.seed)),
                synth: self.synth.clone(),
                ..self.job.parameters.clone()
            };
            let steering = &self.batch.steering;
            recipe =
                Some(recipe::of(&parameters, analysis.masks(), (steering, None), &library, &self.input)?);
            vec![library]
        };
        let mut synth = self.synth.clone();
        let Parameters { size, svg, render, .. } = &self.job.parameters;
        svg.form.set_canvas(*size, &mut synth, &libraries, render.dpi);
        if [synth.width, synth.height] != [self.synth.width, self.synth.height] {
            controls = reading::controls(&self.batch.steering, &synth, 1, &Input::read)?;
        }
        controls.structure = reading::structure_guide(&self.batch.steering, &libraries[0])?;
        let (scene, report) = synthesize_with(&libraries, &synth, &controls, reporter)?;
        Ok(UnwrittenTexture { library: libraries.remove(0), recipe, scene, report })
    }
}

impl UnwrittenTexture {
    /// Writes one of the results. Returns the warnings of the writer.
    fn write(
        &self,
        target: &Target,
        svg: SvgParameters,
        render: RenderParameters,
    ) -> vtex::Result<Vec<String>> {
        let written = match target.kind.format {
            Format::Library => target.write_bytes(&self.library.to_json())?,
            _ => {
                // The scene has the page.
                let render = RenderParameters { dpi: Resolution::default(), ..render };
                let drawing = DrawingOptions { svg, render, recipe: self.recipe.as_ref() };
                target.write_scene(&self.scene, drawing)?
            }
        };
        Ok(written.warnings)
    }
}
