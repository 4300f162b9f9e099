//! The command where its surroundings give out: pipes that close, disks that are full, signals, files that are none, names that
//! attack the terminal, and the other engine, which runs nothing of the folder in which it is started. Each case is one that once
//! went wrong. Kills at random times and small disks are in `.ci/faults.py`.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::command::{CASE, FILES, RECTANGLE, edited, ended, names, text, with_files};

/// A fresh folder with `case.toml` in it.
fn folder(test: &str) -> PathBuf {
    super::command::folder(&format!("doors-{test}"), &[])
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_program"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command
}

/// Waits no longer than a minute, and returns whether it has happened.
fn wait_for(mut happened: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while !happened() {
        if start.elapsed() > Duration::from_secs(60) {
            return false;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    true
}

/// A command that waits for the other end of a pipe never ends.
fn output(mut child: Child) -> Output {
    if !wait_for(|| child.try_wait().unwrap().is_some()) {
        let _ = child.kill();
        panic!("the command hangs");
    }
    child.wait_with_output().unwrap()
}

fn send(signal: &str, child: &Child) {
    let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
}

fn run(command: &mut Command) -> Output {
    output(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
}

fn full() -> Stdio {
    fs::OpenOptions::new().write(true).open("/dev/full").unwrap().into()
}

#[test]
fn a_reader_who_leaves_is_no_failure_and_the_files_are_there() {
    let folder = folder("reader");
    let mut child = command(&folder, &["solve", "case.toml"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = output(child);
    assert_eq!(ended(&output), (Some(0), ""));
    assert_eq!(names(&folder.join("out/case")), FILES);
}

#[test]
fn a_full_standard_output_ends_with_exit_code_1_and_the_files_are_there() {
    let folder = folder("full");
    let mut solve = command(&folder, &["solve", "case.toml"]);
    let output = output(solve.stdout(full()).stderr(Stdio::piped()).spawn().unwrap());
    let said = "error: cannot write to standard output: No space left on device\n";
    assert_eq!(ended(&output), (Some(1), said));
    assert_eq!(names(&folder.join("out/case")), FILES);
}

#[test]
fn help_that_nobody_can_be_given_is_a_failure_and_a_reader_of_it_who_leaves_is_none() {
    let folder = folder("full-help");
    for arguments in [&["--help"][..], &["--version"], &["help", "solve"]] {
        let child = command(&folder, arguments).stdout(full()).stderr(Stdio::piped()).spawn();
        let output = output(child.unwrap());
        let said = "error: cannot write to standard output: No space left on device\n";
        assert_eq!(ended(&output), (Some(1), said), "{arguments:?}");
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = command(&folder, arguments).stdout(writer).status().unwrap();
        assert_eq!(status.code(), Some(0), "{arguments:?}");
    }
}

#[test]
fn a_full_standard_error_leaves_the_exit_code_as_it_is() {
    let folder = folder("full-error");
    for (arguments, code) in [
        (&["solve", "nowhere.toml"][..], 2),
        (&["solve"], 2),
        (&["solve", "case.toml", "--out", "case.toml/out"], 1),
        (&["solve", "case.toml"], 0),
    ] {
        let child = command(&folder, arguments).stdout(full()).stderr(full()).spawn().unwrap();
        let expected = if code == 0 { 1 } else { code };
        assert_eq!(output(child).status.code(), Some(expected), "{arguments:?}");
        let quiet = command(&folder, arguments).arg("--quiet").stderr(full()).spawn().unwrap();
        assert_eq!(output(quiet).status.code(), Some(code), "{arguments:?}");
        let mut closed = Command::new("sh");
        closed.args(["-c", "exec \"$0\" \"$@\" <&- >&- 2>&-", env!("CARGO_BIN_EXE_program")]);
        let closed = closed.args(arguments).current_dir(&folder).status().unwrap();
        assert_eq!(closed.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn pipes_devices_and_directories_are_no_files_to_read() {
    let folder = folder("no-files");
    let pipe = Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap();
    assert!(pipe.success());
    let on_a_device = edited(&[[RECTANGLE, "gmsh = \"/dev/zero\""]]);
    fs::write(folder.join("mesh.toml"), on_a_device).unwrap();
    for (case, expected) in [
        ("pipe", "pipe: this is a pipe, a socket or a device; expected a file"),
        ("/dev/zero", "/dev/zero: this is a pipe, a socket or a device; expected a file"),
        (".", ".: this is a directory; expected a file"),
        (
            "mesh.toml",
            "mesh.toml:3: [mesh] gmsh: /dev/zero: this is a pipe, a socket or a device; expected a file",
        ),
    ] {
        for task in ["solve", "check"] {
            let output = run(&mut command(&folder, &[task, case]));
            assert_eq!(text(&output.stderr), format!("error: {expected}\n"));
            assert_eq!(output.status.code(), Some(2));
        }
    }
    assert_eq!(names(&folder), ["case.toml", "mesh.toml", "pipe"]);
}

#[test]
fn pipes_and_links_under_the_names_of_the_results_are_replaced() {
    let folder = folder("planted");
    let out = folder.join("out/case");
    fs::create_dir_all(&out).unwrap();
    fs::write(folder.join("precious"), "precious").unwrap();
    symlink(folder.join("precious"), out.join("solution.vtu")).unwrap();
    assert!(Command::new("mkfifo").arg(out.join("contact.csv")).status().unwrap().success());
    let output = run(&mut command(&folder, &["solve", "case.toml"]));
    assert_eq!(ended(&output), (Some(0), ""));
    assert_eq!(fs::read_to_string(folder.join("precious")).unwrap(), "precious");
    assert_eq!(names(&out), FILES);
    assert!(names(&out).iter().all(|name| fs::symlink_metadata(out.join(name)).unwrap().is_file()));
}

#[test]
fn a_case_named_with_dots_writes_below_out_and_no_case_is_overwritten() {
    let folder = folder("names");
    fs::rename(folder.join("case.toml"), folder.join("...toml")).unwrap();
    assert!(run(&mut command(&folder, &["solve", "...toml"])).status.success());
    assert_eq!(names(&folder), ["...toml", "out"]);
    assert_eq!(names(&folder.join("out/...toml")), FILES);

    fs::write(folder.join("result.json"), CASE).unwrap();
    for arguments in [
        &["solve", "result.json", "--out", "."][..],
        &["solve", "./result.json", "--out", "out/.."],
        &["solve", "result.json", "--out", folder.to_str().unwrap()],
    ] {
        let output = run(&mut command(&folder, arguments));
        let said = text(&output.stderr);
        assert!(said.ends_with("result.json is a file of the case, and the results would replace it; expected another folder: --out DIR\n"), "{said}");
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(fs::read_to_string(folder.join("result.json")).unwrap(), CASE);
    }
    assert_eq!(names(&folder), ["...toml", "out", "result.json"]);
}

/// Whatever a case calls things, the terminal sees no control character but the ends of lines.
#[test]
fn names_titles_and_paths_are_shown_without_control_characters() {
    let folder = folder("terminal");
    let nasty = "\u{1b}]0;owned\u{7}\u{9b}2J\u{202e}\r";
    let quoted = r#""\u001b]0;owned\u0007\u009b2J\u202e\r\n""#;
    let variants = [
        CASE.replace("\"Block\"", quoted),
        CASE.replace("boundary.top", &format!("boundary.{quoted}")),
        CASE.replace("\"-4 + 10*x\"", quoted),
        CASE.replace("nx = 4", &format!("nx = {quoted}")),
        CASE.replace("[load]", &format!("[{quoted}]")),
        CASE.replace("lambda", quoted),
        CASE.replace(RECTANGLE, &format!("gmsh = {quoted}")),
        CASE.replace("[load]", nasty),
        CASE.replace("1.0", &"1".repeat(100_000)),
        CASE.replace("width = 1.0", "width = 1e300"),
        format!("{CASE}[units]\nlength = {quoted}\nforce = \"N\"\n"),
        format!("{CASE}[obstacle.{quoted}]\nplane = {{ point = [0, 0], normal = [0, 1] }}\n"),
        format!("{CASE}[units]\nlength = \"mm\"\nforce = \"{}\"\n", "N".repeat(1 << 20)),
    ];
    let case = format!("case{nasty}.toml");
    for variant in variants {
        fs::write(folder.join(&case), &variant).unwrap();
        for arguments in [
            &["solve", &case][..],
            &["check", &case],
            &["solve", &case, "--out", &format!("{nasty}\n")],
        ] {
            let output = run(&mut command(&folder, arguments));
            for said in [text(&output.stdout), text(&output.stderr)] {
                let controls =
                    said.chars().filter(|&c| (c.is_control() && c != '\n') || c == '\u{202e}');
                assert_eq!(controls.count(), 0, "{said:?}");
                // The unit of forces, cut, stands in many lines.
                let most = if variant.contains("NNN") { 10_000 } else { 3000 };
                assert!(said.len() < most, "{said}");
            }
        }
    }
}

/// Pages and JSON have no character that a terminal obeys, and none that turns the direction of the text round; JSON stands for the
/// same text as before.
#[test]
fn pictures_reports_and_json_hold_no_character_that_a_terminal_obeys() {
    let nasty = r#""a\u202eb\u009bc\u0085d\u2066e\r""#;
    let text_of =
        CASE.replace("\"Block\"", nasty).replace("\"0\", \"0\"]", "\"0\", \"0\"] # \u{202e}\u{9b}");
    let text_of = format!("{text_of}[units]\nlength = {nasty}\nforce = {nasty}\n");
    let folder = with_files("doors-pages", &[("case.toml", &text_of)]);
    let output = run(&mut command(&folder, &["solve", "case.toml", "--report", "--out", "out"]));
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json = run(&mut command(&folder, &["solve", "case.toml", "--json"]));
    let read = |name| fs::read_to_string(folder.join("out").join(name)).unwrap();
    let json = text(&json.stdout);
    for page in [&read("picture.svg"), &read("report.html"), json, &read("result.json")] {
        let is_obeyed =
            |c: char| (c.is_control() && c != '\n' && c != '\t') || "\u{202e}\u{2066}".contains(c);
        let found: Vec<char> = page.chars().filter(|&c| is_obeyed(c)).collect();
        assert_eq!(found, []);
    }
    let results: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!(results["title"], "a\u{202e}b\u{9b}c\u{85}d\u{2066}e\r", "control");
}

/// An engine in the folder `bin` that does what the script says, and a package for it to run.
fn with_engine(folder: &Path, script: &str) {
    fs::create_dir_all(folder.join("bin")).unwrap();
    fs::create_dir_all(folder.join("here/fenicsx")).unwrap();
    fs::write(folder.join("here/fenicsx/__main__.py"), "").unwrap();
    let python = folder.join("bin/python3");
    let script = format!("#!/bin/sh\nif [ \"$2\" = -c ]; then exit 0; fi\n{script}\n");
    fs::write(&python, script).unwrap();
    fs::set_permissions(&python, fs::Permissions::from_mode(0o755)).unwrap();
}

fn engine(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = command(folder, &["solve", "--engine", "fenicsx", "--reference", "here"]);
    let path = format!(":.:{}:/usr/bin:/bin", folder.join("bin").display());
    command.args(arguments).env("PATH", path).env("PYTHONPATH", ":.:here:/opt/python");
    command
}

#[test]
fn the_engine_is_started_in_a_fresh_folder_with_paths_from_the_root() {
    let folder = folder("engine");
    let arguments =
        r#"{ pwd; ls -A; printf '%s\n' "$PYTHONPATH" "$PYTHONSAFEPATH" "$@"; } > "$NOTES"; exit 1"#;
    with_engine(&folder, arguments);
    // On PATH as `.` and as an empty entry.
    fs::copy(folder.join("bin/python3"), folder.join("python3")).unwrap();
    fs::write(folder.join("python3"), "#!/bin/sh\ntouch owned\n").unwrap();
    fs::rename(folder.join("case.toml"), folder.join("--nx=3")).unwrap();
    let notes = folder.join("notes");
    let output = run(engine(&folder, &["--", "--nx=3"]).env("NOTES", &notes));
    assert_eq!(text(&output.stderr), "error: the engine fenicsx ended with exit status: 1\n");
    assert_eq!(output.status.code(), Some(1));
    let notes = fs::read_to_string(notes).unwrap();
    let root = fs::canonicalize(&folder).unwrap();
    let lines: Vec<&str> = notes.lines().collect();
    let room = lines[0];
    assert!(room.starts_with(root.join("out/--nx=3/.signorini-").to_str().unwrap()), "{notes}");
    let package = root.join("here");
    let case = root.join("--nx=3");
    assert_eq!(
        lines[1],
        format!("{}:/opt/python", package.display()),
        "the folder is empty: {notes}"
    );
    assert_eq!(
        lines[2..],
        ["1", "-P", "-m", "fenicsx", "--ranks", "1", "--out", room, case.to_str().unwrap()]
    );
    assert_eq!(names(&folder), ["--nx=3", "bin", "here", "notes", "out", "python3"]);
    assert!(names(&folder.join("out/--nx=3")).is_empty(), "the fresh folder is gone");
}

#[test]
fn the_engine_is_not_looked_for_in_the_folder_where_the_command_is_started() {
    let folder = folder("cwd");
    for package in ["reference/fenicsx", "fenicsx"] {
        fs::create_dir_all(folder.join(package)).unwrap();
        fs::write(folder.join(package).join("__main__.py"), "open('owned', 'w')").unwrap();
    }
    fs::write(folder.join("dolfinx.py"), "open('owned', 'w')").unwrap();
    let out = self::folder("cwd_out");
    let arguments = ["solve", "--engine", "fenicsx", "case.toml", "--out", out.to_str().unwrap()];
    let output = run(command(&folder, &arguments).env("PYTHONPATH", folder.join("reference")));
    let said = text(&output.stderr);
    // The engine beside the program may be there, and DOLFINx too.
    let elsewhere = output.status.success()
        || said.starts_with("error: the engine fenicsx is not here: no folder fenicsx in /")
        || said.starts_with("error: the engine fenicsx needs DOLFINx");
    assert!(elsewhere, "{said}");
    assert_eq!(names(&folder), ["case.toml", "dolfinx.py", "fenicsx", "reference"]);
}

#[test]
fn a_result_that_the_engine_did_not_write_is_not_reported() {
    let folder = folder("stale");
    assert!(run(&mut command(&folder, &["solve", "case.toml"])).status.success());
    with_engine(&folder, "exit 0");
    let output = run(&mut engine(&folder, &["case.toml"]));
    let said = text(&output.stderr);
    assert!(
        said.starts_with("error: the engine fenicsx wrote no result.json that can be read"),
        "{said}"
    );
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        (text(&output.stdout), names(&folder.join("out/case"))),
        ("", FILES.map(str::to_owned).to_vec())
    );
}

#[test]
fn the_files_of_the_engine_replace_those_of_this_program_and_the_other_way_round() {
    let folder = folder("kinds");
    assert!(run(&mut command(&folder, &["solve", "case.toml"])).status.success());
    fs::copy(folder.join("out/case/result.json"), folder.join("earlier.json")).unwrap();
    with_engine(&folder, r#"cp "$EARLIER" result.json; touch solution.xdmf solution.h5 droppings"#);
    let mut solve = engine(&folder, &["case.toml"]);
    let output = run(solve.env("EARLIER", folder.join("earlier.json")));
    assert_eq!(text(&output.stderr), "");
    assert!(text(&output.stdout).contains(" out/case: solution.xdmf, result.json\n"));
    let of_engine = ["result.json", "solution.h5", "solution.xdmf"];
    assert_eq!(names(&folder.join("out/case")), of_engine);
    assert!(run(&mut command(&folder, &["solve", "case.toml"])).status.success());
    assert_eq!(names(&folder.join("out/case")), FILES);
}

/// The same, where the signals that end a program end it: a shell starts what runs in the background with SIGINT ignored, and
/// what is ignored stays so.
fn with_default_signals(command: &Command) -> Command {
    let mut env = Command::new("env");
    env.arg("--default-signal=TERM,INT,HUP").arg(command.get_program()).args(command.get_args());
    let variables = command.get_envs().filter_map(|(name, value)| Some((name, value?)));
    env.envs(variables).current_dir(command.get_current_dir().unwrap()).stdin(Stdio::null());
    env
}

#[test]
fn a_sweep_that_is_stopped_leaves_the_table_of_what_it_has_solved() {
    let folder = folder("sweep-signal");
    let case = include_str!("../../cases/block.toml");
    fs::write(folder.join("case.toml"), case).unwrap();
    // 1,000 runs.
    let loads: Vec<String> = (1..=100).map(|i| format!("[\"0\",\"-{i}e-4\"]")).collect();
    let most: Vec<String> = (191..=200).map(|most| most.to_string()).collect();
    let axes = [("load.body", loads), ("solver.max_iterations", most)]
        .map(|(k, v)| format!("{k}={}", v.join(",")));
    let arguments = ["sweep", "case.toml", "--set", &*axes[0], "--set", &*axes[1]];
    let sweep = command(&folder, &arguments);
    let child = with_default_signals(&sweep).stderr(Stdio::piped()).spawn().unwrap();
    let table = folder.join("out/case/sweep.csv");
    assert!(wait_for(|| table.exists()), "there is no table");
    send("-INT", &child);
    let output = output(child);
    assert_eq!(output.status.signal(), Some(2), "{}", text(&output.stderr));
    // The picture is drawn anew with the table, after it.
    let mut left = names(&folder.join("out/case"));
    // Where the signal came while the table was written.
    left.retain(|name| !name.starts_with(".signorini-"));
    assert!(left == ["sweep.csv"] || left == ["sweep.csv", "sweep.svg"], "{left:?}");
    let table = fs::read_to_string(table).unwrap();
    let (head, rows) = table.split_once('\n').unwrap();
    assert!(head.starts_with("load.body,solver.max_iterations,verdict,gamma0,"), "{head}");
    let solved = rows.lines().take_while(|line| line.ends_with(",converged")).count();
    let rest: Vec<&str> = rows.lines().skip(solved).collect();
    assert!(solved > 0 && !rest.is_empty(), "{solved} solved, {} not", rest.len());
    assert!(rest.iter().all(|line| line.ends_with(",not solved")), "{}", rest[0]);
    assert_eq!(solved + rest.len(), 1000);
}

/// In `bytes` of address space.
fn within(bytes: u64, folder: &Path, arguments: &str) -> Output {
    limited(&format!("-v {}", bytes / 1024), folder, arguments)
}

#[test]
fn what_does_not_fit_into_memory_ends_with_exit_code_1_and_the_number_of_bytes() {
    let folder = folder("memory");
    fs::write(folder.join("large.toml"), CASE.replace("nx = 4, ny = 4", "nx = 2000, ny = 2000"))
        .unwrap();
    fs::write(folder.join("long.toml"), format!("{CASE}# {}\n", "x".repeat(15 << 20))).unwrap();
    for case in ["large.toml", "long.toml"] {
        let output = within(300 << 20, &folder, &format!("check {case}"));
        let said = text(&output.stderr);
        assert!(
            said.contains("this needs ") && said.contains(" bytes of memory, more than "),
            "{said}"
        );
        assert_eq!(output.status.code(), Some(1), "{said}");
    }
    let output = within(300 << 20, &folder, "check case.toml");
    assert_eq!(ended(&output), (Some(0), ""), "control: a small case fits");
}

/// With a limit of the shell, such as `-f 1`.
fn limited(limit: &str, folder: &Path, arguments: &str) -> Output {
    let script = format!("ulimit {limit}; exec \"$0\" {arguments}");
    let mut shell = Command::new("sh");
    run(shell.args(["-c", &script, env!("CARGO_BIN_EXE_program")]).current_dir(folder))
}

/// An audit, and forces that a certificate is to find, where memory ends: a word about how many bytes are needed, not an abort.
#[test]
fn certificates_ask_for_memory_before_they_take_it() {
    let larger = CASE.replace("nx = 4, ny = 4", "nx = 48, ny = 48");
    let quantities = format!("{larger}[certify]\nquantities = [\"force bottom\"]\n");
    let files = [("case.toml", &*larger), ("forces.toml", &*quantities)];
    let folder = with_files("doors-memory-of-certificates", &files);
    let solved =
        run(&mut command(&folder, &["solve", "case.toml", "--certificate", "--out", "out"]));
    assert_eq!(ended(&solved), (Some(0), ""));
    let with = |megabytes: u32, arguments: &str| {
        limited(&format!("-v {}", megabytes << 10), &folder, arguments)
    };
    // The least that a command needs, in megabytes.
    let least = |arguments: &str, code: i32| {
        (8..).find(|&megabytes| with(megabytes, arguments).status.code() == Some(code)).unwrap()
    };
    let (least_of_all, audit) =
        (least("check missing.toml", 2), "audit out/certificate.json --quiet");
    let mut refused = 0;
    for megabytes in (least_of_all + 2..least_of_all + 40).step_by(4) {
        let output = with(megabytes, audit);
        let said = text(&output.stderr);
        match output.status.code() {
            Some(0) => {}
            Some(1) => {
                assert!(said.contains("bytes of memory"), "{said}");
                refused += 1;
            }
            other => panic!("{megabytes} MB: {other:?}: {said}"),
        }
    }
    assert!(refused > 0, "no limit is too low");
    // What is enough for a certificate is not for forces to second order: the results are there, without them.
    let enough = least("solve case.toml --certificate --json", 0) + 4;
    let output = with(enough, "solve forces.toml --json");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("bytes of memory"), "{}", text(&output.stdout));
    for control in
        [&["audit", "out/certificate.json", "--quiet"], &["solve", "forces.toml", "--quiet"]]
    {
        assert_eq!(ended(&run(&mut command(&folder, control))), (Some(0), ""));
    }
}

#[test]
fn a_shorter_sweep_leaves_no_folders_of_a_longer_one() {
    let folder = folder("sweep-folders");
    let sweep = |values: &str, more: &[&str]| {
        let values = format!("material.mu={values}");
        let arguments = [&["sweep", "case.toml", "--set", &values, "--quiet"], more].concat();
        let output = run(&mut command(&folder, &arguments));
        assert_eq!(ended(&output), (Some(0), ""));
        names(&folder.join("out/case"))
    };
    let all = ["1", "2", "3", "4", "sweep.csv", "sweep.pvd", "sweep.svg"];
    assert_eq!(sweep("1.0,2.0,3.0,4.0", &["--files"]), all);
    fs::write(folder.join("out/case/4/notes"), "of a person").unwrap();
    assert_eq!(
        sweep("7.0,8.0", &["--files"]),
        ["1", "2", "4", "sweep.csv", "sweep.pvd", "sweep.svg"]
    );
    assert_eq!(names(&folder.join("out/case/4")), ["notes"]);
    assert_eq!(names(&folder.join("out/case/2")), FILES);
    assert_eq!(sweep("7.0,8.0", &[]), ["4", "sweep.csv", "sweep.svg"]);
}

#[test]
fn a_certificate_does_not_come_beside_a_result_that_is_not_its_own() {
    let folder = folder("certificates");
    let mut field = "x,y,ux,uy\n".to_owned();
    for (x, y) in (0..25).map(|i| (f64::from(i % 5) / 4.0, f64::from(i / 5) / 4.0)) {
        field += &format!("{x},{y},0,{}\n", -0.001 * (1.0 - y));
    }
    fs::write(folder.join("field.csv"), field).unwrap();
    let succeeds = |arguments: &[&str]| {
        let output = run(&mut command(&folder, arguments));
        assert_eq!(ended(&output), (Some(0), ""), "{arguments:?}");
    };
    let certify = ["certify", "case.toml", "--displacement", "field.csv"];
    succeeds(&["solve", "case.toml", "--certificate"]);
    let before = fs::read(folder.join("out/case/certificate.bin")).unwrap();
    succeeds(&certify);
    assert_eq!(fs::read(folder.join("out/case/certificate.bin")).unwrap(), before);
    let certified = ["certificate.bin", "certificate.json", "certified.vtu"];
    assert_eq!(names(&folder.join("out/case/certified")), certified);
    let output = run(&mut command(&folder, &[&certify[..], &["--out", "out/case"]].concat()));
    let said = "error: out/case has the result.json of a solve, to which this certificate would seem to belong; expected another folder: --out DIR\n";
    assert_eq!(ended(&output), (Some(2), said));
    succeeds(&["solve", "case.toml", "--out", "out/case/certified"]);
    assert_eq!(names(&folder.join("out/case/certified")), FILES);
}

#[test]
fn a_curve_in_5000_physical_groups_makes_a_short_message() {
    let count = 5000;
    let name = |i: usize| format!("1 {i} \"{}{i}\"\n", "n".repeat(50));
    let all: String = (1..=count).map(name).collect();
    let tags: String = (1..=count).map(|i| format!("{i} ")).collect();
    let mesh = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{count}\n{all}$EndPhysicalNames\n\
         $Entities\n0 1 1 0\n1 0 0 0 1 1 0 {count} {tags}0\n1 0 0 0 1 1 0 0 0\n$EndEntities\n\
         $Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n\
         $Elements\n2 2 1 2\n1 1 1 1\n1 1 2\n2 1 2 1\n2 1 2 3\n$EndElements\n"
    );
    let case = edited(&[[RECTANGLE, "gmsh = \"many.msh\""]]);
    let folder = with_files("doors-many-names", &[("many.msh", &mesh), ("case.toml", &case)]);
    let output = run(&mut command(&folder, &["check", "case.toml"]));
    let said = text(&output.stderr);
    let expected = "curve 1 belongs to 5000 physical curves; expected at most 100\n";
    assert!(said.ends_with(expected), "{said}");
    assert!(said.len() < 3000, "{} bytes", said.len());
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn pressures_too_small_for_a_picture_are_refused() {
    let small = [["lambda = 1.0", "lambda = 1e-300"], ["mu = 1.0", "mu = 1e-300"]];
    let folder = super::command::folder(
        "doors-small-numbers",
        &[&small[..], &[["-4 + 10*x", "-1e-308"]]].concat(),
    );
    let output = run(&mut command(&folder, &["solve", "case.toml"]));
    let said = text(&output.stderr);
    assert!(said.contains("over- or underflow double precision"), "{said}");
    assert_eq!((output.status.code(), names(&folder)), (Some(1), vec!["case.toml".to_owned()]));
}

#[test]
fn a_solve_that_does_not_fit_into_memory_says_how_many_bytes_it_needs() {
    let folder = folder("solve-memory");
    for (degree, megabytes) in [(1, [60, 120, 290]), (2, [90, 300, 1000])] {
        let case = edited(&[["nx = 4, ny = 4", "nx = 300, ny = 300"]]);
        fs::write(folder.join("case.toml"), format!("{case}[method]\ndegree = {degree}\n"))
            .unwrap();
        for limit in megabytes {
            let output = within(limit << 20, &folder, "solve case.toml --quiet");
            let said = text(&output.stderr);
            assert!(said.contains("bytes of memory, more than"), "{degree}, {limit} MB: {said}");
            assert_eq!((output.status.code(), names(&folder)), (Some(1), vec!["case.toml".into()]));
        }
    }
}
