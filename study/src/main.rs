//! `study convergence CASE`: a case with an exact solution on finer and finer meshes. `study document`: docs/convergence.md.
//!
//! Exit codes as of the command `signorini`: 1 no result, 2 the case is wrong.

#[cfg(not(kani))]
mod command {
    use std::path::{Path, PathBuf};
    use std::process::ExitCode;

    use clap::{Args, Parser, Subcommand};
    use signorini::io::{Case, Failure, printable, spare};
    use signorini::model::Degree;
    use study::convergence::{self, Study};
    use study::document;

    const UNMEASURED: &str = "[exact]: near its singular point the exact solution is beyond the range of doubles, so its errors cannot be measured; expected a corner with an angle that is not so near to pi, such as omega = 2.7";

    /// Evidence on exact solutions: errors, rates and the bounds of section 3.3
    #[derive(Parser)]
    #[command(name = "study")]
    struct Arguments {
        #[command(subcommand)]
        task: Task,
    }

    #[derive(Subcommand)]
    enum Task {
        /// Solve a case with [exact] on finer and finer meshes; write convergence.csv and convergence.svg
        Convergence(Convergence),
        /// Write docs/convergence.md and its figures, from the root of the repository
        Document,
    }

    #[derive(Args)]
    struct Convergence {
        /// The case file (TOML)
        case: PathBuf,
        /// Set a key of the case file, such as method.gamma0=1e-3; may be repeated
        #[arg(long = "set", value_name = "KEY=VALUE")]
        settings: Vec<String>,
        /// The number of meshes, each with twice as many cells along each axis as the one before; the first is the case's
        #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..=12))]
        levels: u8,
        /// Polynomial degrees, such as 1,2 [default: that of the case]
        #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u8).range(1..=2))]
        degree: Vec<u8>,
        /// Structured or perturbed meshes, or both: structured,perturbed [default: those of the case]
        #[arg(long, value_delimiter = ',', value_parser = ["structured", "perturbed"])]
        mesh: Vec<String>,
        /// The folder to write to [default: out/ and the name of the case]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    }

    pub fn run() -> ExitCode {
        let done = match Arguments::parse().task {
            Task::Convergence(arguments) => convergence(&arguments).map(|text| print!("{text}")),
            Task::Document => document::write().map_err(Failure::failed),
        };
        match done {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                eprintln!("error: {}", printable(&failure.to_string()));
                ExitCode::from(if failure.is_wrong() { 2 } else { 1 })
            }
        }
    }

    fn convergence(arguments: &Convergence) -> Result<String, Failure> {
        let Convergence { case: file, settings, levels, degree, mesh, out } = arguments;
        let case = Case::parse(file, &Case::text(file)?, settings)?;
        let name = Path::new(file.file_stem().unwrap_or_default());
        let folder = out.clone().unwrap_or_else(|| Path::new("out").join(name));
        spare(&folder, &convergence::FILES, &case.sources)?;
        let of = |d: &u8| if *d == 1 { Degree::One } else { Degree::Two };
        let degrees = or_none(degree.iter().map(of).collect());
        let meshes = or_none(mesh.iter().map(|mesh| mesh == "perturbed").collect());
        let mut studies: Vec<Study> = Vec::new();
        for (degree, perturbed) in degrees.iter().flat_map(|d| meshes.iter().map(|m| (*d, *m))) {
            let study = convergence::ladder(&case, degree, perturbed)
                .and_then(|ladder| convergence::climb(ladder, usize::from(*levels)))
                .map_err(|failure| failure.of(&case.file))?;
            if !study.levels.iter().all(|level| level.errors.is_finite()) {
                return Err(Failure::failed(UNMEASURED).of(&case.file));
            }
            studies.push(study);
        }
        let written = convergence::write(&folder, &case.title, &studies)?;
        let tables: Vec<String> = studies.iter().map(Study::table).collect();
        let files: Vec<String> = written.iter().map(|file| file.display().to_string()).collect();
        let (title, files) = (&case.title, files.join(", "));
        Ok(printable(&format!("{title}\n\n{}\nwritten: {files}\n", tables.join("\n"))))
    }

    /// The wanted ones, or one that the case decides.
    fn or_none<T>(wanted: Vec<T>) -> Vec<Option<T>> {
        if wanted.is_empty() { vec![None] } else { wanted.into_iter().map(Some).collect() }
    }
}

#[cfg(not(kani))]
fn main() -> std::process::ExitCode {
    command::run()
}

/// The model checker looks at the kernel only.
#[cfg(kani)]
fn main() {}
