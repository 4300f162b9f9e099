//! The ledger and its audit, on the command line.

#[cfg(kani)]
fn main() {}

#[cfg(not(kani))]
const USAGE: &str = "\
props ledger       print VERIFY.md
props audit [ROW [CHECK]]  run every check, or those of a row, or one
props smt DIR      write the statements in doubles as SMT-LIB 2 problems
props export DIR   write the proofs with their certificates as text
props export --rocq DIR    write the headline statements with proofs for Rocq
props receipt LOG  keep the output of cargo kani as a receipt in props/receipts
";

#[cfg(not(kani))]
fn main() -> std::process::ExitCode {
    use std::process::ExitCode;

    use props::audit::audit;
    use props::{export, ledger, paper, receipt};

    if cfg!(panic = "abort") {
        eprintln!(
            "error: a check that fails panics, and a release ends there; run without --release"
        );
        return ExitCode::FAILURE;
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let said = |text: String| {
        print!("{text}");
        true
    };
    let outcome = match arguments[..] {
        ["ledger"] => ledger::ledger().map_err(std::io::Error::other).map(said),
        ["audit"] => audit(None, None),
        ["audit", id] => audit(Some(id), None),
        ["audit", id, name] => audit(Some(id), Some(name)),
        ["smt", to] => {
            export::export(to.as_ref()).map(|count| said(format!("{count} problems in {to}\n")))
        }
        ["export", "--rocq", to] => paper::export(to.as_ref())
            .map(|count| said(format!("{count} theorems in {to}/paper.v\n"))),
        ["export", to] => {
            export::certificates(to.as_ref()).map(|count| said(format!("{count} proofs in {to}\n")))
        }
        ["receipt", log] => receipt::make(log.as_ref()).map(|path| {
            said(format!(
                "written: {}\nVERIFY.md follows it: cargo run -p props -- ledger > VERIFY.md\n",
                path.display()
            ))
        }),
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(why) => {
            eprintln!("{why}");
            ExitCode::from(2)
        }
    }
}
