//! The command `signorini`: reads a case file, solves it (once, or on finer and finer meshes), writes the files and says
//! what came out.
//!
//! Exit codes: 0 solved and proved; 1 no result: could not solve, could not write; 2 the case is wrong, and then nothing is
//! written; 3 results that are written, but not proved, or without something else that was asked for. Nobody
//! listening at standard output (`| head`) is no failure, a standard output that is full is one: 1. A signal ends the
//! program as a signal does: 130, 143 or 129 to a shell.

#[cfg(not(kani))]
mod arguments;
#[cfg(not(kani))]
mod engine;
#[cfg(not(kani))]
mod progress;
#[cfg(not(kani))]
mod signals;

#[cfg(not(kani))]
fn main() -> std::process::ExitCode {
    command::run()
}

/// The model checker looks at the kernel only.
#[cfg(kani)]
fn main() {}

#[cfg(not(kani))]
mod command {
    use std::fmt::Display;
    use std::fs;
    use std::io::{self, Write};
    use std::path::{Path, PathBuf};
    use std::process::ExitCode;
    use std::time::{Duration, Instant};

    use clap::CommandFactory;
    use signorini::certify::adapt::Stage;
    use signorini::certify::binding::compare;
    use signorini::certify::certify_field;
    use signorini::fem::MeshError;
    use signorini::io::convergence::{self, Meshes, StudyError};
    use signorini::io::field::read_field;
    use signorini::io::files::{reason, spare};
    use signorini::io::input;
    use signorini::io::outputs::{self, Certified, Extra};
    use signorini::io::result::{Results, Seconds, result_json};
    use signorini::io::run::{self, RunError, Solved};
    use signorini::io::sweep::{self, Axis, Sweep, SweepError};
    use signorini::io::{Case, FileError, certificate, report, summary};
    use signorini::quote;
    use signorini::solve::{self, Course, Degree, LadderError, Solution, Times};

    use crate::arguments::{Arguments, CaseArguments, Engine, Mesh, Task};
    use crate::progress::Phases;
    use crate::{engine, signals};

    /// The case is wrong.
    const WRONG: u8 = 2;
    /// The case is right, but there is no result.
    const FAILED: u8 = 1;
    /// There are results, but they are not proved, or something else that was asked for is missing.
    const SHORT: u8 = 3;

    /// A sweep writes the table of what it has solved so often.
    const BETWEEN_TABLES: Duration = Duration::from_secs(1);

    /// A message for people and an exit code.
    struct Failure {
        message: String,
        code: u8,
    }

    fn failure(code: u8) -> impl Fn(&dyn Display) -> Failure {
        move |error| Failure { message: error.to_string(), code }
    }

    pub fn run() -> ExitCode {
        let Arguments { task, quiet, verbose } = match Arguments::read() {
            Ok(arguments) => arguments,
            Err(error) if error.use_stderr() => error.exit(),
            // What was asked for: help, or the version.
            Err(text) => return ended(heard(text.print()).map(|()| 0)),
        };
        signals::watch();
        let done = match &task {
            Task::Solve { case, out, json, certificate, report, engine, ranks, reference } => {
                let out = out.as_deref();
                let extra = Extra { certificate: *certificate, report: *report };
                let wanted = if *json { Wanted::Json } else { Wanted::Summary { verbose } };
                match (engine, ranks) {
                    (Engine::Fenicsx, ranks) => {
                        let reference = reference.as_deref();
                        let by = Fenicsx { ranks: ranks.unwrap_or(1), reference };
                        solve_by_fenicsx(case, out, by, wanted, quiet)
                    }
                    (Engine::Signorini, None) => solve(case, out, wanted, extra, quiet),
                    (Engine::Signorini, Some(ranks)) => Err(Failure {
                        message: format!(
                            "--ranks {ranks}: this program solves in one process; expected --engine fenicsx beside it"
                        ),
                        code: WRONG,
                    }),
                }
            }
            Task::Audit { certificate, case, settings } => {
                audit(certificate, case.as_deref(), settings).map(summarised(quiet))
            }
            Task::Certify { case, displacement, out } => {
                certify(case, displacement, out.as_deref(), quiet).map(summarised(quiet))
            }
            Task::Check { case } => check(case).map(summarised(quiet)),
            Task::Sweep { case, axes, files, out } => {
                sweep(case, axes, *files, out.as_deref(), quiet)
            }
            Task::Convergence { case, levels, degree, mesh, out } => {
                let wanted = Ladders { levels: usize::from(*levels), degree, mesh };
                study(case, &wanted, out.as_deref(), quiet).map(summarised(quiet))
            }
            Task::Completions { shell } => Ok(completions(*shell)),
        };
        ended(done.and_then(|Done { text, code }| say(&text).map(|()| code)))
    }

    /// The exit code, after a word about a failure.
    fn ended(said: Result<u8, Failure>) -> ExitCode {
        match said {
            Ok(code) => ExitCode::from(code),
            Err(Failure { message, code }) => {
                signals::give_way();
                complain(&format!("error: {message}"));
                ExitCode::from(code)
            }
        }
    }

    /// Says it on standard output.
    fn say(text: &str) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        heard(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
    }

    /// A reader who has left has heard enough; the files are written in any case.
    fn heard(written: io::Result<()>) -> Result<(), Failure> {
        match written {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                let message = format!("cannot write to standard output: {}", reason(&error));
                Err(Failure { message, code: FAILED })
            }
            _ => Ok(()),
        }
    }

    /// Says it on standard error. Where there is none, the exit code says it alone.
    fn complain(text: &str) {
        let _ = writeln!(io::stderr(), "{}", quote::lines(text));
    }

    /// Text for standard output, and the exit code.
    struct Done {
        text: String,
        code: u8,
    }

    fn summarised(quiet: bool) -> impl Fn(String) -> Done {
        move |text| Done { text: if quiet { String::new() } else { quote::lines(&text) }, code: 0 }
    }

    /// The form of a solve's report.
    #[derive(Clone, Copy, PartialEq, Eq)]
    enum Wanted {
        Summary { verbose: bool },
        Json,
    }

    impl Wanted {
        fn text(self, results: &Results, files: &[PathBuf], quiet: bool) -> Result<Done, Failure> {
            match self {
                Wanted::Summary { verbose } => {
                    Ok(summarised(quiet)(summary::solved(results, files, verbose)))
                }
                Wanted::Json => match result_json(results) {
                    Ok(text) => Ok(Done { text, code: 0 }),
                    Err(error) => {
                        Err(failure(FAILED)(&format!("result.json cannot be made: {error}")))
                    }
                },
            }
        }
    }

    fn solve(
        arguments: &CaseArguments,
        out: Option<&Path>,
        wanted: Wanted,
        extra: Extra,
        quiet: bool,
    ) -> Result<Done, Failure> {
        let phases = Phases::start(quiet);
        phases.enter("reading the case and its mesh");
        let start = Instant::now();
        let case = read(arguments)?;
        let read = start.elapsed();
        let folder = folder(&arguments.file, out);
        if wanted != Wanted::Json || out.is_some() {
            let names = [&outputs::FILES[..], &certificate::FILES, &[report::FILE]].concat();
            spare(&folder, &names, &case.sources).map_err(|e| failure(WRONG)(&e))?;
        }
        let (case, Solved { solution, times, certified, .. }) = as_asked(case, &phases)?;
        let certified = certified.or_else(|| {
            extra.certificate.then(|| {
                phases.enter("certifying");
                Certified::new(&case, &solution)
            })
        });
        let (files, results) = match (wanted, out) {
            (Wanted::Json, None) => {
                let seconds = Seconds::new(read, &times, Duration::ZERO);
                let results = outputs::results(&case, &solution, seconds);
                let mut results = results.map_err(|e| failure(FAILED)(&e))?;
                certified
                    .iter()
                    .for_each(|certified| certified.add_to(&mut results, extra.certificate));
                (Vec::new(), results)
            }
            _ => {
                phases.enter("writing the files");
                let remark = remark_of_another_case(&folder, &case.file);
                let certified = certified.as_ref();
                let written =
                    outputs::write(&folder, &case, &solution, read, times, certified, extra)
                        .map_err(|e| failure(FAILED)(&e))?;
                drop(phases);
                if let (Some(remark), false) = (remark, quiet) {
                    complain(&remark);
                }
                written
            }
        };
        let done = wanted.text(&results, &files, quiet)?;
        let code = if results.falls_short() { SHORT } else { done.code };
        Ok(Done { code, ..done })
    }

    /// How wrong a displacement is that any program computed.
    fn certify(
        arguments: &CaseArguments,
        displacement: &Path,
        out: Option<&Path>,
        quiet: bool,
    ) -> Result<String, Failure> {
        let phases = Phases::start(quiet);
        phases.enter("reading the case and its mesh");
        let case = read(arguments)?;
        let folder =
            out.map_or_else(|| folder(&arguments.file, None).join("certified"), Path::to_owned);
        if folder.join("result.json").exists() {
            return Err(failure(WRONG)(&format!(
                "{} has the result.json of a solve, to which this certificate would seem to belong; expected another folder: --out DIR",
                quote::path(&folder)
            )));
        }
        let field = read_field(displacement, &case.problem.mesh).map_err(|e| failure(WRONG)(&e))?;
        let (solution, _) = solved(&case, &phases)?;
        phases.enter("certifying");
        let certified = certify_field(&case.problem, &solution, &field)
            .map_err(|e| failure(FAILED)(&format!("{}: {e}", displacement.display())))?;
        let files = outputs::write_certified(&folder, &case, &field, &certified)
            .map_err(|e| failure(FAILED)(&e))?;
        drop(phases);
        Ok(summary::certified(&case, displacement, &certified, &files))
    }

    /// Verifies a certificate from scratch, and that it is of a case if one is named.
    fn audit(path: &Path, case: Option<&Path>, settings: &[String]) -> Result<String, Failure> {
        let case = case.map(|file| {
            let settings = settings.to_vec();
            read(&CaseArguments { file: file.to_owned(), settings })
        });
        let case = case.transpose()?;
        let audit = certificate::audit(path).map_err(|error| failure(FAILED)(&error))?;
        let Some(Case { problem, file, .. }) = case else {
            return Ok(summary::audited(&audit, None));
        };
        let reason = compare(problem, &audit.certificate, &audit.forces).map_err(|difference| {
            let [path, file] = [path, &file].map(quote::path);
            let text = format!("{path}: not a certificate of {file}: {difference}");
            failure(FAILED)(&text)
        })?;
        Ok(summary::audited(&audit, Some((&file, reason.as_deref()))))
    }

    /// On its own mesh, or on adapted ones.
    fn as_asked(case: Case, phases: &Phases) -> Result<(Case, Solved), Failure> {
        let file = case.file.clone();
        let watcher = |stage| match stage {
            Stage::Solve(phase) => phases.enter_solve(phase),
            Stage::Certify(level) => phases.enter(format!("certifying level {level}")),
            _ => phases.enter("refining the mesh"),
        };
        run::solve(case, None, &watcher).map_err(|e| unsolvable(&file, &e))
    }

    fn solved(case: &Case, phases: &Phases) -> Result<(Solution, Times), Failure> {
        let watcher = |phase| phases.enter_solve(phase);
        let course = Course::default().watched_by(&watcher);
        solve::solve_along(&case.problem, &case.method, &case.settings, course)
            .map_err(|e| unsolvable(&case.file, &e.into()))
    }

    /// The settings of the engine fenicsx.
    struct Fenicsx<'a> {
        ranks: u16,
        reference: Option<&'a Path>,
    }

    fn solve_by_fenicsx(
        arguments: &CaseArguments,
        out: Option<&Path>,
        by: Fenicsx,
        wanted: Wanted,
        quiet: bool,
    ) -> Result<Done, Failure> {
        let CaseArguments { file, settings } = arguments;
        if let Some(setting) = settings.first() {
            return Err(failure(WRONG)(&format!(
                "--set {setting}: the engine fenicsx reads the case file itself; write the key into a case file"
            )));
        }
        if is_standard_input(file) {
            return Err(failure(WRONG)(
                &"-: the engine fenicsx reads the case file itself; expected its name",
            ));
        }
        let phases = Phases::start(quiet);
        phases.enter("solving by the engine fenicsx");
        let (results, files) = engine::fenicsx(file, &folder(file, out), by.ranks, by.reference)
            .map_err(|e| failure(if e.is_wrong_case() { WRONG } else { FAILED })(&e))?;
        drop(phases);
        wanted.text(&results, &files, quiet)
    }

    const STANDARD_INPUT: &str = "standard input";

    fn is_standard_input(file: &Path) -> bool {
        file == Path::new("-")
    }

    fn read(CaseArguments { file, settings }: &CaseArguments) -> Result<Case, Failure> {
        let (file, text) = read_text(file)?;
        Case::parse(&file, &text, settings).map_err(|e| no_case(&e))
    }

    fn no_case(error: &FileError) -> Failure {
        failure(if error.error.is_lack() { FAILED } else { WRONG })(error)
    }

    /// The text of a case, and what messages call its file.
    fn read_text(file: &Path) -> Result<(PathBuf, String), Failure> {
        let (name, text) = if is_standard_input(file) {
            let name = Path::new(STANDARD_INPUT);
            (name, Case::text_from(io::stdin(), name))
        } else {
            (file, Case::text(file))
        };
        Ok((name.to_owned(), text.map_err(|e| no_case(&e))?))
    }

    /// The folder given by `--out`, or out/ and the name of the case.
    fn folder(file: &Path, out: Option<&Path>) -> PathBuf {
        match out {
            Some(folder) => folder.to_owned(),
            None if is_standard_input(file) => PathBuf::from("out/stdin"),
            None => {
                // "...toml" without its ending would be "..", the folder above.
                let stem = file.file_stem().filter(|s| !matches!(s.to_str(), Some("." | "..")));
                Path::new("out").join(stem.or(file.file_name()).unwrap_or_default())
            }
        }
    }

    /// Two cases of one name write into one folder: said when the results in `folder` are those of another case than `file`.
    fn remark_of_another_case(folder: &Path, file: &Path) -> Option<String> {
        let bytes = input::read(&folder.join("result.json"), input::MOST_OF_A_CASE).ok()?;
        let earlier: Results = serde_json::from_slice(&bytes).ok()?;
        let earlier = PathBuf::from(earlier.case?);
        let whole = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        (whole(&earlier) != whole(file)).then(|| {
            format!(
                "remark: the results of {} in {} are replaced by those of {}; --out DIR keeps them apart",
                quote::path(&earlier),
                quote::path(folder),
                quote::path(file)
            )
        })
    }

    fn sweep(
        file: &Path,
        axes: &[Axis],
        files: bool,
        out: Option<&Path>,
        quiet: bool,
    ) -> Result<Done, Failure> {
        let no_sweep = |error: SweepError| {
            let code = match error {
                SweepError::Output(_) => FAILED,
                SweepError::Case(ref error) if error.error.is_lack() => FAILED,
                _ => WRONG,
            };
            failure(code)(&error)
        };
        let runs = sweep::count(axes).map_err(no_sweep)?;
        let folder = folder(file, out);
        let (file, text) = read_text(file)?;
        spare(&folder, &[sweep::FILE], std::slice::from_ref(&file))
            .map_err(|e| failure(WRONG)(&e))?;
        let phases = Phases::start(quiet);
        let enter = |done| phases.enter(format!("{done} of {runs} runs"));
        enter(0);
        // A sweep that is stopped leaves the table of what it has solved.
        let mut written = Instant::now();
        let done = |sweep: &Sweep| {
            enter(sweep.runs.len());
            let some = sweep.runs.iter().any(|run| run.outcome.is_ok());
            if some && !sweep.to_come.is_empty() && written.elapsed() >= BETWEEN_TABLES {
                sweep.write(&folder)?;
                written = Instant::now();
            }
            Ok(())
        };
        let sweep = sweep::run(&file, &text, axes, &folder, files, done).map_err(no_sweep)?;
        drop(phases);
        let code = |outcome: &sweep::Outcome| match outcome {
            Ok(results) => results.falls_short().then_some(SHORT),
            Err(error) => Some(code(error)),
        };
        let codes: Vec<u8> = sweep.runs.iter().filter_map(|run| code(&run.outcome)).collect();
        if codes.len() == sweep.runs.len() && codes.iter().all(|code| *code == WRONG) {
            let Some(Err(error)) = sweep.runs.first().map(|run| &run.outcome) else {
                return Ok(summarised(quiet)(String::new()));
            };
            return Err(failure(WRONG)(&format!("{}: {error}", quote::path(&file))));
        }
        let written = sweep.write(&folder).map_err(|e| failure(FAILED)(&e))?;
        let code = match codes.iter().all(|code| *code == SHORT) {
            true => codes.first().copied().unwrap_or_default(),
            false => FAILED,
        };
        Ok(Done { code, ..summarised(quiet)(summary::swept(&sweep, &written)) })
    }

    fn completions(shell: clap_complete::Shell) -> Done {
        let mut bytes = Vec::new();
        clap_complete::generate(shell, &mut Arguments::command(), "signorini", &mut bytes);
        Done { text: String::from_utf8_lossy(&bytes).into_owned(), code: 0 }
    }

    /// The scope of a convergence study; empty lists stand for the case's own degree and mesh.
    struct Ladders<'a> {
        levels: usize,
        degree: &'a [u8],
        mesh: &'a [Mesh],
    }

    fn study(
        arguments: &CaseArguments,
        wanted: &Ladders,
        out: Option<&Path>,
        quiet: bool,
    ) -> Result<String, Failure> {
        let case = read(arguments)?;
        let folder = folder(&arguments.file, out);
        spare(&folder, &convergence::FILES, &case.sources).map_err(|e| failure(WRONG)(&e))?;
        let degree = |d: &u8| if *d == 1 { Degree::One } else { Degree::Two };
        let mesh = |m: &Mesh| match m {
            Mesh::Structured => Meshes::Structured,
            Mesh::Perturbed => Meshes::Perturbed,
        };
        let degrees = or_none(wanted.degree.iter().map(degree).collect());
        let meshes = or_none(wanted.mesh.iter().map(mesh).collect());
        let count = degrees.len() * meshes.len() * wanted.levels;
        let phases = Phases::start(quiet);
        let mut done = 0;
        let mut enter = |more| {
            done += more;
            phases.enter(format!("{done} of {count} meshes"));
        };
        enter(0);
        let mut studies = Vec::new();
        for degree in &degrees {
            for meshes in &meshes {
                let study = convergence::ladder(&case, *degree, *meshes)
                    .and_then(|(ladder, meshes)| {
                        convergence::climb(ladder, meshes, wanted.levels, || enter(1))
                    })
                    .map_err(|e| no_study(&case.file, &e))?;
                studies.push(study);
            }
        }
        drop(phases);
        let files =
            convergence::write(&folder, &case.title, &studies).map_err(|e| failure(FAILED)(&e))?;
        Ok(summary::studied(&case, &studies, &files))
    }

    /// The wanted ones, or one that the case decides.
    fn or_none<T>(wanted: Vec<T>) -> Vec<Option<T>> {
        if wanted.is_empty() { vec![None] } else { wanted.into_iter().map(Some).collect() }
    }

    fn no_study(file: &Path, error: &StudyError) -> Failure {
        let code = match error {
            StudyError::NoSolution | StudyError::MeshFile => WRONG,
            StudyError::Level { error, .. } => match error {
                LadderError::Mesh(MeshError::OutOfMemory(_)) => FAILED,
                LadderError::Mesh(_) => WRONG,
                LadderError::Solve(error) if error.is_wrong_case() => WRONG,
                LadderError::Solve(_) => FAILED,
            },
        };
        Failure { message: format!("{}: {error}", quote::path(file)), code }
    }

    fn check(arguments: &CaseArguments) -> Result<String, Failure> {
        let case = read(arguments)?;
        let outline = solve::check(&case.problem, &case.method)
            .map_err(|e| unsolvable(&case.file, &e.into()))?;
        Ok(summary::checked(&case, &outline))
    }

    fn unsolvable(file: &Path, error: &RunError) -> Failure {
        Failure { message: format!("{}: {error}", quote::path(file)), code: code(error) }
    }

    fn code(error: &RunError) -> u8 {
        if error.is_wrong_case() { WRONG } else { FAILED }
    }
}
