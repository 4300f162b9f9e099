//! The command `signorini`: reads a case file, solves it, writes the files and says what came out.
//!
//! Exit codes: 0 solved; 1 could not solve, or could not write; 2 the case is wrong, and then nothing is written.

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
    use std::path::{Path, PathBuf};
    use std::process::ExitCode;
    use std::time::Instant;

    use clap::{Parser, Subcommand};
    use signorini::io::{Case, outputs};
    use signorini::solve::{self, SolveError, Status};

    use crate::summary;

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
        },
        /// Read a case and report its sizes and the limit of gamma0; solve nothing, write nothing
        Check {
            /// The case file (TOML)
            case: PathBuf,
        },
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
        let text = match &arguments.task {
            Task::Solve { case, out } => solve(case, out.as_deref()),
            Task::Check { case } => check(case),
        };
        match text {
            Ok(text) => {
                if !arguments.quiet {
                    print!("{text}");
                }
                ExitCode::SUCCESS
            }
            Err(Failure { message, code }) => {
                eprintln!("error: {message}");
                ExitCode::from(code)
            }
        }
    }

    fn solve(file: &Path, out: Option<&Path>) -> Result<String, Failure> {
        let start = Instant::now();
        let case = Case::read(file).map_err(|e| failure(WRONG)(&e))?;
        let read = start.elapsed();
        let (solution, times) = solve::solve(&case.problem, &case.method, &case.settings)
            .map_err(|e| unsolvable(file, &e))?;
        if solution.newton.status == Status::NotConverged {
            let message = summary::not_converged(file, &case.settings, &solution.newton);
            return Err(Failure { message, code: FAILED });
        }
        let folder = match out {
            Some(folder) => folder.to_owned(),
            None => Path::new("out").join(file.file_stem().unwrap_or_default()),
        };
        let (files, seconds) = outputs::write(&folder, &case, &solution, read, times)
            .map_err(|e| failure(FAILED)(&e))?;
        Ok(summary::solved(&case, &solution, &seconds, &files))
    }

    fn check(file: &Path) -> Result<String, Failure> {
        let case = Case::read(file).map_err(|e| failure(WRONG)(&e))?;
        let outline =
            solve::check(&case.problem, &case.method).map_err(|e| unsolvable(file, &e))?;
        Ok(summary::checked(&case, &outline))
    }

    fn unsolvable(file: &Path, error: &SolveError) -> Failure {
        let code = match error {
            SolveError::Data(_) | SolveError::NotCoercive { .. } => WRONG,
            SolveError::NotPositiveDefinite | SolveError::OutOfMemory => FAILED,
        };
        Failure { message: format!("{}: {error}", file.display()), code }
    }
}
