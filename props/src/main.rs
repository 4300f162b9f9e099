//! The ledger and its audit, on the command line.

#[cfg(kani)]
fn main() {}

#[cfg(not(kani))]
fn main() -> std::process::ExitCode {
    use std::process::ExitCode;

    if cfg!(panic = "abort") {
        eprintln!(
            "error: a check that fails panics, and a release ends there; run without --release"
        );
        return ExitCode::FAILURE;
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments[..] {
        ["ledger"] => props::ledger::ledger().map_err(std::io::Error::other).map(|text| {
            print!("{text}");
            true
        }),
        ["audit"] => props::audit::audit(None, None),
        ["audit", id] => props::audit::audit(Some(id), None),
        ["audit", id, name] => props::audit::audit(Some(id), Some(name)),
        ["smt", directory] => props::export::export(directory.as_ref()).map(|count| {
            println!("{count} problems in {directory}");
            true
        }),
        ["export", "--rocq", directory] => props::paper::export(directory.as_ref()).map(|count| {
            println!("{count} theorems in {directory}/paper.v");
            true
        }),
        ["export", directory] => props::export::certificates(directory.as_ref()).map(|count| {
            println!("{count} proofs in {directory}");
            true
        }),
        ["receipt", log] => props::receipt::make(log.as_ref()).map(|path| {
            println!("written: {}", path.display());
            println!("VERIFY.md follows it: cargo run -p props -- ledger > VERIFY.md");
            true
        }),
        _ => {
            eprintln!("props ledger       print VERIFY.md");
            eprintln!("props audit [ROW [CHECK]]  run every check, or those of a row, or one");
            eprintln!("props smt DIR      write the statements in doubles as SMT-LIB 2 problems");
            eprintln!("props export DIR   write the proofs with their certificates as text");
            eprintln!(
                "props export --rocq DIR    write the headline statements with proofs for Rocq"
            );
            eprintln!(
                "props receipt LOG  keep the output of cargo kani as a receipt in props/receipts"
            );
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
