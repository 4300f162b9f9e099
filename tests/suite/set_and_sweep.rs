//! Keys set over a case, sweeps, JSON, standard input and completions.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use super::command::{ended, folder, names, signorini, text};

fn with_standard_input(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_program"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    child.wait_with_output().unwrap()
}

/// What `check` says of the mesh, with these settings.
fn checked(folder: &Path, settings: &[&str]) -> Output {
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    signorini(folder, &["check", "case.toml"].into_iter().chain(settings).collect::<Vec<_>>())
}

#[test]
fn a_setting_has_the_effect_of_the_same_line_in_the_file() {
    let set = folder("set", &[]);
    let written = folder(
        "written",
        &[
            ["nx = 4", "nx = 7"],
            ["gap = \"0\"", "gap = \"0.1*x\""],
            ["[output]", "[method]\ngamma0 = \"auto\"\ndegree = 2\n[output]"],
        ],
    );
    let settings = [
        "mesh.rectangle.nx=3",
        "method.gamma0=auto",
        "boundary.bottom={contact = {gap = \"0.1*x\"}}",
        "method.degree=2",
        "mesh.rectangle.nx=7",
    ];
    let solve = |folder: &Path, settings: &[&str]| {
        let arguments = settings.iter().flat_map(|setting| ["--set", *setting]);
        let all: Vec<&str> = ["solve", "case.toml"].into_iter().chain(arguments).collect();
        let output = signorini(folder, &all);
        assert!(output.status.success(), "{}", text(&output.stderr));
        fs::read_to_string(folder.join("out/case/contact.csv")).unwrap()
    };
    assert_eq!(solve(&set, &settings), solve(&written, &[]));
    assert_ne!(solve(&set, &settings[..4]), solve(&written, &[]), "the last one wins");
}

#[test]
fn a_mistake_in_a_setting_is_reported_with_the_setting_and_exit_code_2() {
    let folder = folder("wrong-set", &[]);
    for (setting, message) in [
        (
            "metod.gamma0=1",
            "unknown key 'metod'; expected title, mesh, material, load, exact, boundary, obstacle, pair, point, method, solver, adapt, certify, output, units, body or step",
        ),
        (
            "method.gama0=1",
            "unknown key 'gama0' in [method]; expected degree, gamma0, kappa, contact_quadrature or allow_noncoercive",
        ),
        ("material.mu=-1", "[material] mu = -1; expected a positive number"),
        (
            "material.young=1",
            "[material]: found lambda, mu and young; expected lambda and mu, young and poisson, stiffness, or orthotropic",
        ),
        (
            "boundary.bottom.contact.gap=\"z\"",
            "[boundary.bottom] contact.gap = \"z\": column 1: found 'z', expected a number, x, y, pi, a function or '('",
        ),
        ("method.gamma0=1+x", "[method] gamma0 = \"1+x\"; expected a positive number or \"auto\""),
        (
            "material.mu=1,5",
            "invalid TOML: expected a value; an expression must be in quotes (\"0.1 - x\"), a list in brackets, and decimals have a point (0.5, not 0,5)",
        ),
        (
            "method.gamma0",
            "found no key with a value; expected KEY=VALUE, such as method.gamma0=1e-3",
        ),
        (
            "load.body.1=2",
            "'load.body' is a list, whose entries have no keys; expected all of it: load.body=[...]",
        ),
        (
            "pair=[{boundaries=[\"left\",\"right\"],reach=0}]",
            "[[pair]] reach = 0; expected a positive number",
        ),
        ("# a=1", "found no key with a value; expected KEY=VALUE, such as method.gamma0=1e-3"),
    ] {
        let output = checked(&folder, &["title=\"a\"", setting, "mesh.rectangle.ny=5"]);
        let expected = format!("error: case.toml with --set {setting}: {message}\n");
        assert_eq!(ended(&output), (Some(2), expected.as_str()));
    }
    // A mistake of the file stays one of the file.
    fs::write(folder.join("case.toml"), "titel = 1\n").unwrap();
    let output = checked(&folder, &["method.degree=2"]);
    assert!(text(&output.stderr).starts_with("error: case.toml:1: unknown key 'titel'"));
}

#[test]
fn json_prints_the_results_and_nothing_else_and_writes_no_files() {
    let folder = folder("json", &[]);
    let output = signorini(&folder, &["solve", "case.toml", "--json"]);
    assert_eq!(ended(&output), (Some(0), ""));
    assert_eq!(names(&folder), ["case.toml"]);
    let without_seconds = |text: &str| text[..text.find("\"seconds\"").unwrap()].to_owned();
    let printed = text(&output.stdout);
    let results: serde_json::Value = serde_json::from_str(printed).unwrap();
    assert!(results["title"].is_string());
    // With a folder, the files are written, too, and the same is printed.
    let output = signorini(&folder, &["solve", "case.toml", "--json", "--out", "o"]);
    let file = fs::read_to_string(folder.join("o/result.json")).unwrap();
    assert_eq!(text(&output.stdout), file);
    assert_eq!(without_seconds(printed), without_seconds(&file));
    let wrong = signorini(&folder, &["solve", "case.toml", "--json", "--set", "mesh=1"]);
    assert!(wrong.status.code() == Some(2) && wrong.stdout.is_empty());
}

#[test]
fn a_case_from_standard_input_is_solved_like_one_from_a_file() {
    let folder = folder("stdin", &[]);
    let case = fs::read(folder.join("case.toml")).unwrap();
    let output = with_standard_input(&folder, &["solve", "-"], &case);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(signorini(&folder, &["solve", "case.toml"]).status.success());
    let read = |out: &str| fs::read(folder.join(out).join("solution.vtu")).unwrap();
    assert!(read("out/stdin") == read("out/case"));
    let output = with_standard_input(&folder, &["check", "-"], b"titel = 1");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).starts_with("error: standard input:1: unknown key 'titel'"));
}

#[test]
fn a_sweep_prints_and_writes_one_line_for_each_combination() {
    let folder = folder("sweep", &[]);
    let arguments = ["--set", "method.gamma0=1e-3,auto", "--set", "method.degree=1,2"];
    let output = signorini(&folder, &[&["sweep", "case.toml"], &arguments[..]].concat());
    assert_eq!(ended(&output), (Some(0), ""));
    assert_eq!(names(&folder.join("out/case")), ["sweep.csv", "sweep.svg"]);
    let csv = fs::read_to_string(folder.join("out/case/sweep.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(
        lines[0],
        "method.gamma0,method.degree,verdict,kappa,newton_steps,contact_force,contact_length,peak_pressure,max_von_mises,max_displacement,elastic_energy,remarks,bottom.force,bottom.length,bottom.peak_pressure,bottom.force_low,bottom.force_high,top.reaction_x,top.reaction_y,probe_1.u_x,probe_1.u_y,probe_2.u_x,probe_2.u_y,status"
    );
    for (line, values) in lines[1..].iter().zip(["1e-3,1", "1e-3,2", "auto,1", "auto,2"]) {
        assert!(line.starts_with(values) && line.ends_with(",converged"), "{line}");
    }
    assert_eq!(lines.len(), 5);
    // The line has the numbers of the solve.
    let [gamma0, degree] = ["method.gamma0=auto", "method.degree=2"];
    let solve = ["solve", "case.toml", "--json", "--set", gamma0, "--set", degree];
    let json = signorini(&folder, &solve).stdout;
    // As it stands there: serde_json reads some numbers to the last digit but one.
    let json = text(&json);
    let (_, force) = json.split_once("\"contact_force\": ").unwrap();
    let force = format!(",{},", force.split_once(',').unwrap().0);
    assert!(lines[4].contains(&force) && !lines[3].contains(&force), "{csv}{force}");
    let (table, remarks) = text(&output.stdout).split_once("\nremark on row ").unwrap();
    assert!(table.lines().count() == 1 + 1 + 5, "{table}");
    assert!(remarks.ends_with("\n\nwritten: out/case: sweep.svg, sweep.csv\n"), "{remarks}");
}

#[test]
fn settings_lie_over_a_long_case_and_may_be_long_themselves() {
    let folder = folder("long-settings", &[]);
    let case = fs::read_to_string(folder.join("case.toml")).unwrap();
    let long = "# A remark.\n".repeat(10_000) + &case;
    fs::write(folder.join("long.toml"), &long).unwrap();
    let force =
        format!("load.body=[\"0\", \"-2{}\"]", format!(" + {}0", " ".repeat(40)).repeat(2000));
    assert!(long.len() > 1 << 16 && force.len() > 1 << 16);
    for (task, file, setting) in [
        ("check", "long.toml", "method.degree=2"),
        ("sweep", "long.toml", "method.degree=1,2"),
        ("check", "case.toml", &force),
        ("sweep", "case.toml", &force),
    ] {
        let output = signorini(&folder, &[task, file, "--set", setting]);
        assert_eq!(ended(&output), (Some(0), ""), "{task} {file}");
        let longest = text(&output.stdout).lines().map(str::len).max();
        assert!(longest.is_some_and(|length| length < 500), "{task} {file}: {longest:?}");
    }
}

#[test]
fn a_sweep_over_lists_writes_the_files_of_each_run_where_asked() {
    let folder = folder("sweep-files", &[]);
    let loads = "load.body=[\"0\", \"-1\"],[\"0\", \"-2\"]";
    let output =
        signorini(&folder, &["sweep", "case.toml", "--set", loads, "--files", "--out", "o"]);
    assert_eq!(ended(&output), (Some(0), ""));
    assert_eq!(names(&folder.join("o")), ["1", "2", "sweep.csv", "sweep.pvd", "sweep.svg"]);
    let collection = fs::read_to_string(folder.join("o/sweep.pvd")).unwrap();
    assert!(
        collection.contains("<DataSet timestep=\"2\" file=\"2/solution.vtu\"/>"),
        "{collection}"
    );
    assert!(names(&folder.join("o/2")).contains(&"picture.svg".to_owned()));
    let csv = fs::read_to_string(folder.join("o/sweep.csv")).unwrap();
    assert!(csv.contains("\n\"[\"\"0\"\", \"\"-2\"\"]\","), "{csv}");
}

#[test]
fn a_run_without_a_solution_is_a_line_of_the_sweep_and_exit_code_1() {
    let folder = folder("sweep-fails", &[]);
    let output = signorini(&folder, &["sweep", "case.toml", "--set", "method.gamma0=0.1,5"]);
    assert_eq!(output.status.code(), Some(1));
    let csv = fs::read_to_string(folder.join("out/case/sweep.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[1].ends_with(",converged"), "{csv}");
    assert!(
        lines[2].starts_with("5,,,") && lines[2].contains(",,\"gamma0 = 5 gives kappa = "),
        "{csv}"
    );
    let table = text(&output.stdout);
    assert!(table.contains("and coercivity needs kappa < 1\n"), "{table}");
}

#[test]
fn a_sweep_that_is_wrong_ends_with_exit_code_2_and_writes_nothing() {
    let folder = folder("sweep-wrong", &[]);
    for (axis, message) in [
        (
            "method.degree=1,3",
            "error: case.toml with --set method.degree=3: [method] degree = 3; expected 1 or 2\n",
        ),
        ("method.gamma0=5,6", "error: case.toml: gamma0 = 5 gives kappa = "),
        (
            "method.degree",
            "error: invalid value 'method.degree' for '--set <KEY=VALUE,VALUE,...>': expected KEY=VALUE,",
        ),
    ] {
        let output = signorini(&folder, &["sweep", "case.toml", "--set", axis]);
        let said = text(&output.stderr);
        assert!(output.status.code() == Some(2) && said.starts_with(message), "{said}");
        assert_eq!(names(&folder), ["case.toml"]);
    }
}

#[test]
fn what_only_the_other_engine_or_only_this_one_can_do_is_refused() {
    let folder = folder("engines", &[]);
    for (arguments, message) in [
        (
            &["--ranks", "4"][..],
            "error: --ranks 4: this program solves in one process; expected --engine fenicsx beside it\n",
        ),
        (
            &["--engine", "fenicsx", "--set", "a=1"],
            "error: --set a=1: the engine fenicsx reads the case file itself; write the key into a case file\n",
        ),
    ] {
        let output = signorini(&folder, &[&["solve", "case.toml"], arguments].concat());
        assert_eq!(ended(&output), (Some(2), message));
    }
    let output = signorini(&folder, &["solve", "-", "--engine", "fenicsx"]);
    let message = "error: -: the engine fenicsx reads the case file itself; expected its name\n";
    assert_eq!(ended(&output), (Some(2), message));
}

#[test]
fn two_cases_of_one_name_in_one_folder_are_remarked_on() {
    let folder = folder("remark", &[]);
    fs::create_dir(folder.join("b")).unwrap();
    fs::copy(folder.join("case.toml"), folder.join("b/case.toml")).unwrap();
    let said = |arguments: &[&str]| {
        let output = signorini(&folder, &[&["solve"], arguments].concat());
        assert!(output.status.success());
        text(&output.stderr).to_owned()
    };
    assert_eq!(said(&["case.toml"]), "");
    assert_eq!(said(&["./case.toml"]), "");
    assert_eq!(
        said(&["b/case.toml"]),
        "remark: the results of ./case.toml in out/case are replaced by those of b/case.toml; --out DIR keeps them apart\n"
    );
    assert_eq!(said(&["case.toml", "--quiet"]), "");
}

#[test]
fn completions_know_every_option() {
    let folder = folder("completions", &[]);
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let output = signorini(&folder, &["completions", shell]);
        assert!(output.status.success() && text(&output.stdout).contains("ranks"), "{shell}");
    }
}

#[test]
fn a_sweep_has_the_remarks_of_its_runs_in_a_column_and_below_the_table() {
    let folder = folder("sweep-remarks", &[]);
    let loads = "load.body=[\"0\", \"-0.001\"],[\"0\", \"-4 + 10*x\"]";
    let output = signorini(&folder, &["sweep", "case.toml", "--set", loads]);
    assert_eq!(ended(&output), (Some(0), ""));
    let said = text(&output.stdout);
    assert!(said.contains("\nremark on row 2: the largest strain is "), "{said}");
    assert!(!said.contains("remark on row 1"), "control: {said}");
    let csv = fs::read_to_string(folder.join("out/case/sweep.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    let column = rows[0].split(',').position(|name| name == "remarks").unwrap();
    // The loads have a comma each, in quotes.
    let count = |row: &str| row.split(',').nth(column + 1).unwrap().parse::<usize>().unwrap();
    assert_eq!(count(rows[1]), 0, "{csv}");
    assert!(count(rows[2]) > 0, "{csv}");
}

#[test]
fn a_range_makes_as_many_rows_and_jobs_change_nothing_but_the_time() {
    let folder = folder("sweep-range", &[]);
    let sweep = |jobs: &str, out: &str| {
        let range = "boundary.top.displacement=[0,-0.01:-0.03:5]";
        let arguments = ["sweep", "case.toml", "--set", range, "--jobs", jobs, "--out", out];
        assert_eq!(ended(&signorini(&folder, &arguments)), (Some(0), ""));
        fs::read_to_string(folder.join(out).join("sweep.csv")).unwrap()
    };
    let [one, two] = [sweep("1", "one"), sweep("2", "two")];
    let rows: Vec<&str> = one.lines().collect();
    assert!(rows.len() == 6 && rows[3].starts_with("\"[0,-0.02]\","), "{one}");
    // Runs start from other solutions: their last digits differ.
    for (a, b) in one.lines().zip(two.lines()) {
        for (a, b) in a.split(',').zip(b.split(',')) {
            match (a.parse::<f64>(), b.parse::<f64>()) {
                // Newton steps.
                (Ok(a), Ok(b)) if a.fract() == 0.0 && b.fract() == 0.0 && a.abs() > 1.5 => {}
                (Ok(a), Ok(b)) => {
                    approx::assert_relative_eq!(a, b, max_relative = 1e-7, epsilon = 1e-12)
                }
                _ => assert_eq!(a, b),
            }
        }
    }
    let drawn = fs::read_to_string(folder.join("one/sweep.svg")).unwrap();
    // Five points in each of two panels, and one in the legend.
    assert_eq!(drawn.matches("<circle").count(), 11);
    assert!(drawn.contains("boundary.top.displacement"), "{drawn}");
}

#[test]
fn the_error_that_is_asked_for_on_the_command_line_is_met() {
    let folder = folder("within", &[]);
    let bounds = |within: &str, code: i32| {
        let output = signorini(&folder, &["solve", "case.toml", "--within", within]);
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        text(&output.stdout).to_owned() + text(&output.stderr)
    };
    assert!(bounds("30 %", 0).contains("  adapted      target 30 % met;"));
    let said = bounds("force bottom 40 %", 0);
    assert!(said.contains("  adapted      force of bottom within ±40 % met;"), "{said}");
    for (within, message) in [
        ("30", "invalid value '30' for '--within <TARGET>': expected a share of the energy norm"),
        ("force roof 5 %", "adapt.target={ force = \"roof\""),
    ] {
        let said = bounds(within, 2);
        assert!(said.contains(message), "{said}");
    }
}

/// The first line of numbers of a sweep of the case, by the names of their columns.
fn swept(test: &str, edits: &[[&str; 2]]) -> Vec<(String, f64)> {
    let folder = folder(test, edits);
    let output = signorini(&folder, &["sweep", "case.toml", "--set", "method.degree=1,2"]);
    assert_eq!(ended(&output), (Some(0), ""));
    let csv = fs::read_to_string(folder.join("out/case/sweep.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let numbers = lines[0].iter().zip(&lines[1]);
    numbers.filter_map(|(name, x)| Some(((*name).to_owned(), x.parse().ok()?))).collect()
}

#[test]
fn forces_reactions_and_energies_of_a_sweep_are_those_of_the_whole_thickness() {
    let thick = swept("sweep-thick", &[["[load]", "[body]\nthickness = 20\n[load]"]]);
    let thin = swept("sweep-thin", &[]);
    let mut wholes = Vec::new();
    for ((name, whole), (_, per_thickness)) in thick.iter().zip(&thin) {
        let of_the_whole =
            ["force", "energy", "reaction_x", "reaction_y", "force_low", "force_high"];
        let last = name.rsplit(['.', '_']).next().unwrap();
        let is_whole = of_the_whole.iter().any(|of| name.ends_with(of)) || last == "force";
        let expected = if is_whole { 20.0 * per_thickness } else { *per_thickness };
        // A product that is rounded, and ends that go outwards by a double.
        approx::assert_relative_eq!(*whole, expected, max_relative = 1e-15);
        wholes.extend(is_whole.then_some(name.as_str()));
    }
    let expected = [
        "contact_force",
        "elastic_energy",
        "bottom.force",
        "bottom.force_low",
        "bottom.force_high",
        "top.reaction_x",
        "top.reaction_y",
    ];
    assert_eq!(wholes, expected);
    assert_eq!(thick.len(), thin.len());
}

/// One step is what its keys say, not the case without them.
#[test]
fn one_load_step_is_solved_as_several_are() {
    let force = |step: &str, name: &str, result: &str| {
        let folder = folder(name, &[["[output]", &format!("{step}[output]")]]);
        let output = signorini(&folder, &["solve", "case.toml"]);
        assert_eq!(ended(&output), (Some(0), ""));
        let json = fs::read_to_string(folder.join("out/case").join(result)).unwrap();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let force = json["contact"][0]["force"].as_f64().unwrap();
        (force, names(&folder.join("out/case")))
    };
    let step = "[[step]]\nboundary.top.displacement = [\"0\", \"-0.5\"]\n";
    let (pressed, files) = force(step, "one-step", "1/result.json");
    assert_eq!(files, ["1", "steps.csv", "steps.pvd"]);
    let (free, _) = force("", "no-step", "result.json");
    assert!(pressed > 2.0 * free.abs(), "{pressed} {free}");
}

#[test]
fn load_steps_are_solved_one_after_the_other_and_have_a_table() {
    let steps = "[[step]]\nboundary.top.displacement = [\"0\", \"-0.05\"]\n[[step]]\nboundary.top.displacement = [\"0.05\", \"-0.05\"]\n[[step]]\nboundary.top.displacement = [\"0.02\", \"-0.05\"]\ntitle = \"Back\"\n";
    let edits = [
        ["contact = { gap = \"0\" }", "contact = { gap = \"0\", friction = { coulomb = 0.2 } }"],
        ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\", \"0\"]"],
        ["[output]", &format!("{steps}[output]")],
    ];
    let folder = folder("steps", &edits);
    let output = signorini(&folder, &["solve", "case.toml"]);
    assert_eq!(ended(&output), (Some(0), ""));
    let said = text(&output.stdout);
    assert!(!said.contains("one step") && said.contains("step  verdict"), "{said}");
    let written = folder.join("out/case");
    assert_eq!(names(&written), ["1", "2", "3", "steps.csv", "steps.pvd", "steps.svg"]);
    // The plot has the title of the case, each picture that of its step.
    let has =
        |file: &str, title: &str| fs::read_to_string(written.join(file)).unwrap().contains(title);
    let [whole, last] = ["Block", "Back"].map(|title| format!("<title>{title}</title>"));
    assert!(has("steps.svg", &whole) && !has("steps.svg", &last));
    assert!(has("3/picture.svg", &last) && !has("3/picture.svg", &whole));
    let csv = fs::read_to_string(written.join("steps.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = lines[0].iter().position(|name| *name == "bottom.force_x").unwrap();
    let forces: Vec<f64> = lines[1..].iter().map(|line| line[column].parse().unwrap()).collect();
    // Friction holds back what is dragged to the right, and what is dragged back.
    assert!(forces[0].abs() < 0.1 * forces[1].abs() && forces[1] < 0.0, "{forces:?}");
    assert!(forces[2] > forces[1] + 0.5 * forces[1].abs(), "{forces:?}");
    let json = fs::read_to_string(written.join("3/result.json")).unwrap();
    assert!(json.contains("\"step\": 3") && json.contains("\"title\": \"Back\""), "{json}");
    // The last state at once is dragged to the right.
    let last = ["--set", "boundary.top.displacement=[\"0.02\",\"-0.05\"]"];
    let case = fs::read_to_string(folder.join("case.toml")).unwrap().replace(steps, "");
    fs::write(folder.join("once.toml"), case).unwrap();
    let once = signorini(&folder, &[&["solve", "once.toml"], &last[..]].concat());
    assert_eq!(ended(&once), (Some(0), ""));
    let said = text(&once.stdout);
    assert!(said.contains("one step: friction is as if the loads grew in proportion"), "{said}");
    let json = fs::read_to_string(folder.join("out/once/result.json")).unwrap();
    assert!(!json.contains("\"step\"") && json.contains("\"sticks\""));
    for (arguments, message) in [
        (&["sweep", "case.toml", "--set", "method.degree=1,2"][..], "found [[step]] in the case"),
        (&["solve", "case.toml", "--json"], "--json: the case has [[step]]"),
        (
            &["solve", "case.toml", "--within", "5 %"],
            "step: found [[step]] beside [adapt]; expected one of both",
        ),
    ] {
        let output = signorini(&folder, arguments);
        let (code, said) = ended(&output);
        assert!(code == Some(2) && said.contains(message), "{said}");
    }
}
