//! The reference pages say what the code does: every name in result.json and every key of a case file, no more and no
//! less; and links lead to files that the package holds.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use signorini::io::Case;
use signorini::io::outputs::{self, Certified};
use signorini::io::result::Seconds;
use signorini::solve;

fn page(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

/// The words in backquotes of the first cell of each row.
fn first_cells(page: &str) -> BTreeSet<String> {
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `"));
    let cells = rows.filter_map(|row| row.split(" | ").next());
    cells
        .flat_map(|cell| cell.split(['`', ',', ' ']).map(str::to_owned).collect::<Vec<_>>())
        .filter(|word| !word.is_empty())
        .collect()
}

fn paths(prefix: &str, value: &Value, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            for (name, value) in members {
                let by_name = [
                    "quantities.reactions",
                    "reaction_moments",
                    "certificate.discrete.intervals.reactions",
                ];
                let name = if by_name.contains(&prefix) { "NAME" } else { name };
                let dot = if prefix.is_empty() { "" } else { "." };
                paths(&format!("{prefix}{dot}{name}"), value, into);
            }
        }
        _ => {
            into.insert(prefix.to_owned());
        }
    }
}

#[test]
fn the_page_on_result_json_lists_exactly_what_is_written() {
    let mut written = BTreeSet::new();
    for (file, settings) in [
        (
            "cases/block.toml",
            &[
                "output.probes=[[0.5, 0.5]]",
                "mesh.rectangle.nx=4",
                "method.gamma0=auto",
                "units={length=\"m\", force=\"N\"}",
            ][..],
        ),
        ("cases/singular.toml", &["mesh.rectangle.nx=2", "mesh.rectangle.ny=2"]),
        (
            "cases/block.toml",
            &["mesh.rectangle.nx=4", "method.gamma0=auto", "load.body=[\"0\", \"-1\"]"],
        ),
        // Held by contact alone.
        ("cases/disk_force.toml", &[]),
    ] {
        let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
        let case = Case::parse(Path::new(file), &page(file), &settings).unwrap();
        let (solution, times) = solve(&case.problem, &case.method, &case.settings).unwrap();
        let zero = std::time::Duration::ZERO;
        let seconds = Seconds::new(zero, &times, zero);
        let mut results = outputs::results(&case, &solution, seconds).unwrap();
        results.add_certificate(Some(Certified::new(&case, &solution).report()));
        paths("", &serde_json::to_value(results).unwrap(), &mut written);
    }
    assert_eq!(written, first_cells(&page("docs/result.md")));
}

/// The keys that the reader says it expects in a table of this case.
fn known(file: &str, settings: &[&str], table: &str) -> BTreeSet<String> {
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    let dot = if table.is_empty() { "" } else { "." };
    let nonsense = format!("{table}{dot}nonsense=1");
    let all = [settings, vec![nonsense]].concat();
    let error = match Case::parse(Path::new(file), &page(file), &all) {
        Ok(_) => panic!("{table}: nonsense is accepted"),
        Err(error) => error.to_string(),
    };
    let (_, expected) = error.split_once("; expected ").unwrap();
    assert!(error.contains("unknown key 'nonsense'"), "{error}");
    expected.split([',', ' ']).filter(|w| !["", "or"].contains(w)).map(str::to_owned).collect()
}

#[test]
fn the_page_on_case_files_knows_every_key() {
    let page = page("docs/case.md");
    let smooth = ["boundary={bottom=\"contact\"}"];
    for (file, settings, table) in [
        ("cases/block.toml", &[][..], ""),
        ("cases/block.toml", &[], "mesh"),
        ("cases/block.toml", &[], "mesh.rectangle"),
        ("cases/corner.toml", &[], "mesh.trapezoid"),
        ("cases/block.toml", &["mesh.perturb={amount=0.1}"], "mesh.perturb"),
        ("cases/block.toml", &[], "material"),
        ("cases/block.toml", &[], "load"),
        ("cases/block.toml", &[], "boundary.left"),
        ("cases/block.toml", &[], "boundary.bottom.contact"),
        ("cases/block.toml", &["method.degree=1"], "method"),
        ("cases/block.toml", &["method.contact_quadrature={gauss=1}"], "method.contact_quadrature"),
        ("cases/block.toml", &["solver.tolerance=1e-9"], "solver"),
        ("cases/pin.toml", &[], "units"),
        ("cases/pin.toml", &[], "obstacle.pin"),
        ("cases/pin.toml", &[], "obstacle.pin.circle"),
        ("cases/disk.toml", &[], "obstacle.floor.plane"),
        ("cases/block.toml", &["output.probes=[]"], "output"),
        ("cases/smooth.toml", &smooth, "exact"),
        ("cases/singular.toml", &[], "exact"),
        ("cases/corner.toml", &[], "exact"),
    ] {
        for key in known(file, settings, table) {
            let shown = ["`", ".", "[", "{ "].into_iter().any(|before| {
                ["`", ".", "]", " ="]
                    .into_iter()
                    .any(|after| page.contains(&format!("{before}{key}{after}")))
            });
            assert!(shown, "docs/case.md does not know '{key}' of [{table}]");
        }
    }
}

#[test]
fn every_link_of_the_readme_and_the_pages_leads_to_a_file_of_the_package() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = page("Cargo.toml");
    let excluded = manifest.lines().find(|line| line.starts_with("exclude = ")).unwrap();
    let mut names = ["README.md", "VERIFY.md", "CONTRIBUTING.md"].map(str::to_owned).to_vec();
    names.extend(
        fs::read_dir(root.join("docs"))
            .unwrap()
            .map(|entry| format!("docs/{}", entry.unwrap().file_name().to_str().unwrap()))
            .filter(|name| name.ends_with(".md")),
    );
    let mut count = 0;
    for name in names {
        let text = page(&name);
        let folder = Path::new(&name).parent().unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.starts_with("http") || link.starts_with('#') {
                continue;
            }
            let file = folder.join(link.split('#').next().unwrap());
            assert!(root.join(&file).is_file(), "{name} links to {link}, which is no file");
            let first = file.components().next().unwrap().as_os_str().to_str().unwrap();
            assert!(
                !excluded.contains(&format!("\"{first}")),
                "{name} links to {link}, which is not packaged"
            );
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
}
