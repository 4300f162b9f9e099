//! The command line: tasks and options. The help and shell completions are made from it.

use std::path::PathBuf;
use std::str::FromStr;

use crate::io::sweep::ParameterAxis;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::Shell;

/// Unilateral (Signorini) contact in linear elasticity by Nitsche's method.
#[derive(Parser)]
#[command(
    name = "signorini",
    bin_name = "signorini",
    version,
    arg_required_else_help = true,
    after_help = format!("{SCOPE}\n\n{EXIT_CODES}")
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) task: Task,
    /// Print nothing but errors
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    /// Print also how the case was solved: mesh, coercivity, Newton's method, accuracy, balance of energies, times
    #[arg(long, global = true, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
}

const SCOPE: &str = "Linear elastic, small displacements and rotations, plane strain, plane stress or bodies of revolution. Contact is \
                     with rigid obstacles and between deformable bodies, without friction or with Tresca's or Coulomb's: they push \
                     and never pull; gap and direction are those of the undeformed bodies.\n\
                     Not computed: 3D, large displacements or sliding, friction in bodies of revolution, plasticity and other nonlinear materials, dynamics, thermal strain.\n\
                     docs/case.md of the sources lists the keys of a case file.";

const EXIT_CODES: &str = "Exit codes: 0 solved and proved; 1 no result: it could not be computed or written, or a certificate was not accepted; \
                          2 the case or the arguments are wrong, and nothing is written; 3 results are written, but they are not \
                          proved, or lack a certificate or a target that was asked for. Signals end the command as usual (130, \
                          143, 129 in a shell). A closed pipe (| head) is not an error; a full standard output is (1).";

impl Arguments {
    /// Reads the command line; an error suggests what was probably meant.
    pub(crate) fn read() -> Result<Arguments, clap::Error> {
        Arguments::try_parse().map_err(|mut error| {
            let has = |kind| error.get(kind).is_some();
            let is_similar = has(ContextKind::SuggestedArg) || has(ContextKind::SuggestedSubcommand);
            let word = |kind| match error.get(kind) {
                Some(ContextValue::String(word)) => word.as_str(),
                _ => "",
            };
            let tip = match error.kind() {
                ErrorKind::InvalidSubcommand => match word(ContextKind::InvalidSubcommand) {
                    case if case.ends_with(".toml") => {
                        "a case is solved by 'signorini solve CASE.toml'"
                    }
                    "convergence" => {
                        "in the sources: 'cargo run --release -p study -- convergence CASE.toml'"
                    }
                    _ if is_similar => return error,
                    _ => "the commands are new, check, solve, sweep, certify, audit, completions",
                },
                ErrorKind::UnknownArgument => match word(ContextKind::InvalidArg) {
                    "-o" => "the folder to write to is set by '--out DIR'",
                    case if case.ends_with(".toml") => {
                        "one case at a time; 'signorini sweep' solves a case for several values of its keys"
                    }
                    _ if is_similar => return error,
                    _ => "a key of the case file is set by --set, such as '--set method.degree=2'",
                },
                _ => return error,
            };
            error.insert(
                ContextKind::Suggested,
                ContextValue::StyledStrs(vec![StyledStr::from(tip)]),
            );
            error
        })
    }
}

#[derive(Subcommand)]
pub(crate) enum Task {
    /// Solve a case; write solution.vtu, contact.vtu, contact.csv, picture.svg and result.json
    #[command(after_help = "Examples:\n  signorini solve cases/bracket.toml --report\n  \
                            signorini solve cases/disk.toml --within \"force contact 2 %\"\n  \
                            signorini solve cases/disk.toml --set material.young=2000 --set method.degree=2")]
    Solve {
        #[command(flatten)]
        case: CaseArguments,
        #[command(flatten)]
        options: SolveOptions,
    },
    /// Verify a certificate from scratch, without the solver
    #[command(
        after_help = "Example: signorini audit out/block/certificate.json --case cases/block.toml"
    )]
    Audit {
        /// The file certificate.json, with certificate.bin beside it
        #[arg(value_hint = ValueHint::FilePath)]
        certificate: PathBuf,
        /// Also check that the certificate belongs to this case: mesh (or a refinement of it), materials, supports, loads and
        /// obstacles
        #[arg(long, value_name = "CASE.toml", value_hint = ValueHint::FilePath)]
        case: Option<PathBuf>,
        /// Set a key of the case file, as for solve
        #[arg(long = "set", value_name = "KEY=VALUE", requires = "case")]
        settings: Vec<String>,
    },
    /// Bound the error of a displacement that another program computed for a case; write certified.vtu, certificate.json and
    /// certificate.bin
    Certify {
        #[command(flatten)]
        case: CaseArguments,
        /// The displacement at the vertices of the case's mesh, and where its degree is 2 also in the middles of the edges: .csv with
        /// x, y, ux, uy
        #[arg(long, value_name = "FIELD.csv", value_hint = ValueHint::FilePath)]
        displacement: PathBuf,
        /// The folder to write to [default: out/, the name of the case, and certified]
        #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
        out: Option<PathBuf>,
    },
    /// Write a case file to begin with, from a Gmsh mesh: its boundaries, a support and a floor
    New {
        /// The mesh (.msh)
        #[arg(value_name = "PART.msh", value_hint = ValueHint::FilePath)]
        mesh: PathBuf,
        /// The case file to write, which must not be there [default: that of the mesh with the ending .toml]
        #[arg(long, value_name = "CASE.toml", value_hint = ValueHint::FilePath)]
        out: Option<PathBuf>,
    },
    /// Read a case and list its boundaries with condition, length, load and gap, whether the body is held, the size of the mesh and
    /// the limit of gamma0, and what is doubtful, without solving or writing anything
    #[command(after_help = "Example: signorini check cases/disk.toml")]
    Check {
        #[command(flatten)]
        case: CaseArguments,
    },
    /// Solve a case for each combination of values of some keys; print a table, write it to sweep.csv and draw it in sweep.svg
    #[command(
        after_help = "Examples:\n  signorini sweep cases/disk.toml --set 'boundary.top.displacement=[0,-0.001:-0.015:8]'\n  \
                            signorini sweep cases/disk.toml --set material.young=1000:3000:5 --set method.degree=1,2 --jobs 2"
    )]
    Sweep {
        /// The case file (TOML), or - for standard input
        #[arg(value_hint = ValueHint::FilePath)]
        case: PathBuf,
        /// A key of the case file and its values, such as method.gamma0=1e-3,1e-2, or from:to:count, such as
        /// material.young=1000:3000:5, also as an entry of a list; may be repeated
        #[arg(long = "set", value_name = "KEY=VALUE,VALUE,...", required = true)]
        axes: Vec<ParameterAxis>,
        /// Also write the files of each run, into folders 1, 2, ..., their pictures on one scale, and sweep.pvd for ParaView
        #[arg(long)]
        files: bool,
        /// Solve so many runs at the same time, each with memory of its own
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
        jobs: u16,
        /// The folder to write to [default: out/ and the name of the case]
        #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
        out: Option<PathBuf>,
    },
    /// Print the completion script for a shell
    Completions {
        /// The shell
        shell: Shell,
    },
}

/// A case file and what is set over it.
#[derive(Args)]
pub(crate) struct CaseArguments {
    /// The case file (TOML), or - for standard input
    #[arg(value_name = "CASE", value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// Set a key of the case file, such as method.gamma0=1e-3; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) settings: Vec<String>,
}

/// Options of a solve.
#[derive(Args)]
pub(crate) struct SolveOptions {
    /// The folder to write to [default: out/ and the name of the case]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) out: Option<PathBuf>,
    /// Print result.json instead of the summary; write no files unless --out names a folder
    #[arg(long)]
    pub(crate) json: bool,
    /// Also bound the distance to the true solution, and write the proof to certificate.json and certificate.bin, for
    /// `signorini audit`; with the forces between two numbers it takes one to five times as long as the solution
    #[arg(long)]
    pub(crate) certificate: bool,
    /// Refine the mesh until the error is proved to be at most this: "5 %" of the energy norm, or "force NAME 2 %" of the contact
    /// force of a boundary. Sets adapt.target of the case
    #[arg(long, value_name = "TARGET")]
    pub(crate) within: Option<Within>,
    /// Write report.html, too: picture, numbers, what is proved and the case, in one file to send to a colleague
    #[arg(long)]
    pub(crate) report: bool,
    /// The solver: this program, or the reference implementation in FEniCSx, which can run in several processes
    #[arg(long, value_enum, default_value_t = Engine::Signorini)]
    pub(crate) engine: Engine,
    /// MPI processes for --engine fenicsx [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) ranks: Option<u16>,
    /// The folder of the reference implementation, reference/ of the sources [default: beside this program]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) reference: Option<PathBuf>,
}

/// The target of an adaptive solve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Within {
    /// The key of the case file that says the same, with its value.
    pub(crate) setting: String,
}

impl FromStr for Within {
    type Err = String;

    fn from_str(text: &str) -> Result<Within, String> {
        let share = |text: &str| {
            let number = text.trim().strip_suffix('%')?.trim();
            let is_share = number.parse::<f64>().is_ok_and(|x| x > 0.0 && x.is_finite());
            is_share.then(|| format!("\"{number} %\""))
        };
        let of_force = |text: &str| {
            let named = text.trim().strip_prefix("force ")?.trim();
            let at = named.trim_end_matches(['%', ' ']).rfind(' ')?;
            let (name, within) = (named[..at].trim(), share(&named[at..])?);
            let name = name.replace('\\', "\\\\").replace('"', "\\\"");
            Some(format!("{{ force = \"{name}\", within = {within} }}"))
        };
        match share(text).or_else(|| of_force(text)) {
            Some(target) => Ok(Within { setting: format!("adapt.target={target}") }),
            None => Err("expected a share of the energy norm, such as \"5 %\", or of the contact force of a boundary, such as \"force bottom 2 %\"".to_owned()),
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Engine {
    Signorini,
    Fenicsx,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_share_of_the_energy_norm_or_of_a_force() {
        for (text, setting) in [
            ("5 %", r#"adapt.target="5 %""#),
            ("0.5%", r#"adapt.target="0.5 %""#),
            ("force bottom 2 %", r#"adapt.target={ force = "bottom", within = "2 %" }"#),
            (
                "force the left \"foot\" 2%",
                r#"adapt.target={ force = "the left \"foot\"", within = "2 %" }"#,
            ),
        ] {
            assert_eq!(text.parse(), Ok(Within { setting: setting.to_owned() }), "{text}");
        }
        for text in
            ["5", "-1 %", "0 %", "x %", "force bottom", "force 2 %", "forces bottom 2 %", ""]
        {
            assert!(text.parse::<Within>().is_err(), "{text}");
        }
    }
}
