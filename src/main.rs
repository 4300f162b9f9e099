//! The command `signorini`: reads a case file, solves it (once, or on finer and finer meshes), writes the files and says
//! what came out.
//!
//! Exit codes: 0 solved; 1 could not solve, or could not write; 2 the case is wrong, and then nothing is written. Nobody
//! listening at standard output (`| head`) is no failure, a standard output that is full is one: 1. A signal ends the
//! program as a signal does: 130, 143 or 129 to a shell.

#[cfg(not(kani))]
mod engine;
#[cfg(not(kani))]
mod signals;
#[cfg(not(kani))]
mod summary;

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
    use std::io::{self, Write};
    use std::path::{Path, PathBuf};
    use std::process::ExitCode;
    use std::time::Instant;

    use clap::{Parser, Subcommand, ValueEnum};
    use indicatif::{ProgressBar, ProgressStyle};
    use signorini::fem::{DataError, MeshError};
    use signorini::io::convergence::{self, Meshes, StudyError};
    use signorini::io::files::{reason, spare};
    use signorini::io::{Case, CaseError, outputs};
    use signorini::quote;
    use signorini::solve::{self, Degree, LadderError, SolveError, Status};

    use crate::{engine, signals, summary};

    /// Unilateral (Signorini) contact in linear elasticity by Nitsche's method.
    #[derive(Parser)]
    #[command(version, arg_required_else_help = true)]
    struct Arguments {
        #[command(subcommand)]
        task: Task,
        /// Print nothing but errors
        #[arg(long, global = true)]
        quiet: bool,
    }

    #[derive(Subcommand)]
    enum Task {
        /// Solve a case; write solution.vtu, contact.vtu, contact.csv, picture.svg and result.json
        Solve {
            /// The case file (TOML)
            case: PathBuf,
            /// The folder to write to [default: out/ and the name of the case]
            #[arg(long, value_name = "DIR")]
            out: Option<PathBuf>,
            /// Who solves: this program, or the reference in FEniCSx, which runs on many processes
            #[arg(long, value_enum, default_value_t = Engine::Signorini)]
            engine: Engine,
            /// MPI processes for the engine fenicsx
            #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
            ranks: u16,
            /// The folder with the reference in FEniCSx, reference/ of the sources [default: beside this program]
            #[arg(long, value_name = "DIR")]
            reference: Option<PathBuf>,
        },
        /// Read a case and report its sizes and the limit of gamma0; solve nothing, write nothing
        Check {
            /// The case file (TOML)
            case: PathBuf,
        },
        /// Solve a case with an exact solution on finer and finer meshes; write convergence.csv and convergence.svg
        Convergence {
            /// The case file (TOML)
            case: PathBuf,
            /// How many meshes, each with twice as many cells along each axis as the one before; the first is the case's
            #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..=12))]
            levels: u8,
            /// Polynomial degrees, such as 1,2 [default: that of the case]
            #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u8).range(1..=2))]
            degree: Vec<u8>,
            /// Structured or perturbed meshes, or both: structured,perturbed [default: those of the case]
            #[arg(long, value_enum, value_delimiter = ',')]
            mesh: Vec<Mesh>,
            /// The folder to write to [default: out/ and the name of the case]
            #[arg(long, value_name = "DIR")]
            out: Option<PathBuf>,
        },
    }

    #[derive(Clone, Copy, ValueEnum)]
    enum Mesh {
        Structured,
        Perturbed,
    }

    #[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
    enum Engine {
        Signorini,
        Fenicsx,
    }

    /// The case is wrong.
    const WRONG: u8 = 2;
    /// The case is right, but there is no result.
    const FAILED: u8 = 1;

    /// A message for people and an exit code.
    struct Failure {
        message: String,
        code: u8,
    }

    fn failure(code: u8) -> impl Fn(&dyn Display) -> Failure {
        move |error| Failure { message: error.to_string(), code }
    }

    pub fn run() -> ExitCode {
        let arguments = Arguments::parse();
        signals::watch();
        let text = match &arguments.task {
            Task::Solve { case, out, engine: Engine::Signorini, .. } => solve(case, out.as_deref()),
            Task::Solve { case, out, engine: Engine::Fenicsx, ranks, reference } => {
                engine::fenicsx(case, &folder(case, out.as_deref()), *ranks, reference.as_deref())
                    .map(|(results, files)| summary::solved(&results, &files))
                    .map_err(|e| failure(if e.is_wrong_case() { WRONG } else { FAILED })(&e))
            }
            Task::Check { case } => check(case),
            Task::Convergence { case, levels, degree, mesh, out } => {
                let wanted = Wanted { levels: usize::from(*levels), degree, mesh };
                study(case, &wanted, out.as_deref(), arguments.quiet)
            }
        };
        let said = text.and_then(|text| if arguments.quiet { Ok(()) } else { say(&text) });
        match said {
            Ok(()) => ExitCode::SUCCESS,
            Err(Failure { message, code }) => {
                signals::give_way();
                // Where there is no standard error, the code says it alone.
                let _ = writeln!(io::stderr(), "error: {}", quote::lines(&message));
                ExitCode::from(code)
            }
        }
    }

    /// Says it on standard output. A reader who has left has heard enough; the files are written in any case.
    fn say(text: &str) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        let said = out.write_all(quote::lines(text).as_bytes()).and_then(|()| out.flush());
        match said {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                let message = format!("cannot write to standard output: {}", reason(&error));
                Err(Failure { message, code: FAILED })
            }
            _ => Ok(()),
        }
    }

    /// The case in this file.
    fn read(file: &Path) -> Result<Case, Failure> {
        let code = |error: &CaseError| if error.is_lack_of_memory() { FAILED } else { WRONG };
        Case::read(file).map_err(|error| failure(code(&error))(&error))
    }

    fn solve(file: &Path, out: Option<&Path>) -> Result<String, Failure> {
        let start = Instant::now();
        let case = read(file)?;
        let read = start.elapsed();
        let folder = folder(file, out);
        spare(&folder, &outputs::FILES, &case.sources).map_err(|e| failure(WRONG)(&e))?;
        let (solution, times) = solve::solve(&case.problem, &case.method, &case.settings)
            .map_err(|e| unsolvable(file, &e))?;
        if solution.newton.status == Status::NotConverged {
            let message = summary::not_converged(file, &case.settings, &solution.newton);
            return Err(Failure { message, code: FAILED });
        }
        let (files, results) = outputs::write(&folder, &case, &solution, read, times)
            .map_err(|e| failure(FAILED)(&e))?;
        Ok(summary::solved(&results, &files))
    }

    /// What `--out` says, or out/ and the name of the case.
    fn folder(file: &Path, out: Option<&Path>) -> PathBuf {
        // "...toml" without its ending would be "..", the folder above.
        let stem = file.file_stem().filter(|stem| !matches!(stem.to_str(), Some("." | "..")));
        match out {
            Some(folder) => folder.to_owned(),
            None => Path::new("out").join(stem.or(file.file_name()).unwrap_or_default()),
        }
    }

    /// What the study shall cover; empty lists stand for what the case says.
    struct Wanted<'a> {
        levels: usize,
        degree: &'a [u8],
        mesh: &'a [Mesh],
    }

    fn study(
        file: &Path,
        wanted: &Wanted,
        out: Option<&Path>,
        quiet: bool,
    ) -> Result<String, Failure> {
        let case = read(file)?;
        let folder = folder(file, out);
        spare(&folder, &convergence::FILES, &case.sources).map_err(|e| failure(WRONG)(&e))?;
        let degree = |d: &u8| if *d == 1 { Degree::One } else { Degree::Two };
        let mesh = |m: &Mesh| match m {
            Mesh::Structured => Meshes::Structured,
            Mesh::Perturbed => Meshes::Perturbed,
        };
        let degrees = or_none(wanted.degree.iter().map(degree).collect());
        let meshes = or_none(wanted.mesh.iter().map(mesh).collect());
        let progress = progress(degrees.len() * meshes.len() * wanted.levels, quiet);
        let mut studies = Vec::new();
        for degree in &degrees {
            for meshes in &meshes {
                let study = convergence::ladder(&case, *degree, *meshes)
                    .and_then(|(ladder, meshes)| {
                        convergence::climb(ladder, meshes, wanted.levels, || progress.inc(1))
                    })
                    .map_err(|e| no_study(file, &e))?;
                studies.push(study);
            }
        }
        progress.finish_and_clear();
        let files =
            convergence::write(&folder, &case.title, &studies).map_err(|e| failure(FAILED)(&e))?;
        Ok(summary::studied(&case, &studies, &files))
    }

    /// The wanted ones, or one that the case decides.
    fn or_none<T>(wanted: Vec<T>) -> Vec<Option<T>> {
        if wanted.is_empty() { vec![None] } else { wanted.into_iter().map(Some).collect() }
    }

    /// A bar on standard error if that is a terminal, else nothing. The levels to come take longer than those done.
    fn progress(levels: usize, quiet: bool) -> ProgressBar {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(levels as u64) };
        let colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        let bar_of = if colour { "{bar:30.cyan}" } else { "{bar:30}" };
        let template = format!("  {bar_of} {{pos}} of {{len}} meshes, {{elapsed}}");
        match ProgressStyle::with_template(&template) {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    }

    fn no_study(file: &Path, error: &StudyError) -> Failure {
        let code = match error {
            StudyError::NoSolution | StudyError::MeshFile => WRONG,
            StudyError::Level { error, .. } => match error {
                LadderError::Mesh(MeshError::OutOfMemory(_)) => FAILED,
                LadderError::Mesh(_) => WRONG,
                LadderError::Solve(error) => code(error),
                LadderError::NotConverged { .. } => FAILED,
            },
        };
        Failure { message: format!("{}: {error}", quote::path(file)), code }
    }

    fn check(file: &Path) -> Result<String, Failure> {
        let case = read(file)?;
        let outline =
            solve::check(&case.problem, &case.method).map_err(|e| unsolvable(file, &e))?;
        Ok(summary::checked(&case, &outline))
    }

    fn unsolvable(file: &Path, error: &SolveError) -> Failure {
        Failure { message: format!("{}: {error}", quote::path(file)), code: code(error) }
    }

    fn code(error: &SolveError) -> u8 {
        match error {
            SolveError::Data(DataError::Mesh(MeshError::OutOfMemory(_))) => FAILED,
            SolveError::Data(_) | SolveError::NotCoercive { .. } => WRONG,
            SolveError::NotPositiveDefinite | SolveError::OutOfMemory => FAILED,
        }
    }
}
