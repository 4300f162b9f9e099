//! The reference pages say what the code does: every name in result.json and every key of a case file, no more and no
//! less; and links lead to files that the package holds.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value;
use signorini::io::Case;
use signorini::io::outputs::{self, Extra};
use signorini::io::run;

use super::command::{signorini, text};
use super::common::root;

fn page(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
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
                "body.thickness=2",
            ][..],
        ),
        ("cases/singular.toml", &["mesh.rectangle.nx=2", "mesh.rectangle.ny=2"]),
        (
            "cases/block.toml",
            &[
                "mesh.rectangle.nx=4",
                "method.gamma0=auto",
                "boundary.bottom.contact.friction={coulomb=0.3}",
            ],
        ),
        ("cases/singular.toml", &["method.degree=1", "adapt.target=\"20 %\""]),
        ("cases/singular.toml", &["adapt.target=\"0.1 %\"", "adapt.max_unknowns=10"]),
        (
            "cases/block.toml",
            &[
                "mesh.rectangle.nx=4",
                "mesh.rectangle.ny=4",
                "method.gamma0=auto",
                "adapt.target={force=\"bottom\",within=\"60 %\"}",
            ],
        ),
        (
            "cases/block.toml",
            &["mesh.rectangle.nx=4", "method.gamma0=auto", "load.body=[\"0\", \"-1\"]"],
        ),
        ("cases/disk_force.toml", &[]),
        ("cases/hub.toml", &[]),
        // Beyond the limit of gamma0, where nothing is proved.
        (
            "cases/block.toml",
            &[
                "mesh.rectangle.nx=4",
                "mesh.rectangle.ny=4",
                "method.degree=1",
                "method.gamma0=0.13",
                "method.allow_noncoercive=true",
            ],
        ),
        (
            "cases/slider.toml",
            &["mesh.rectangle.nx=4", "mesh.rectangle.ny=2", "step=[{title=\"the first\"}]"],
        ),
    ] {
        let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
        let mut case = Case::parse(&root().join(file), &page(file), &settings).unwrap();
        if let Some(step) = case.steps.pop() {
            case = step;
        }
        let (case, mut solved) = run::solve(case, None, &|_| {}).unwrap();
        solved.certify(&case);
        let extra = Extra { certificate: true, report: false };
        let results = outputs::results(&case, &solved, Duration::ZERO, extra).unwrap();
        paths("", &serde_json::to_value(results).unwrap(), &mut written);
    }
    assert_eq!(written, first_cells(&page("docs/result.md")));
}

/// The keys that the reader says it expects in a table of this case.
fn known(file: &str, settings: &[&str], table: &str) -> BTreeSet<String> {
    known_to(file, &page(file), settings, table)
}

fn known_to(file: &str, text: &str, settings: &[&str], table: &str) -> BTreeSet<String> {
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    let dot = if table.is_empty() { "" } else { "." };
    let nonsense = format!("{table}{dot}nonsense=1");
    let all = [settings, vec![nonsense]].concat();
    let error = match Case::parse(&root().join(file), text, &all) {
        Ok(_) => panic!("{table}: nonsense is accepted"),
        Err(error) => error.to_string(),
    };
    let (_, expected) = error.split_once("; expected ").unwrap();
    assert!(error.contains("unknown key 'nonsense'"), "{error}");
    expected.split([',', ' ']).filter(|w| !["", "or"].contains(w)).map(str::to_owned).collect()
}

/// The tables of a case, each with a case that has it and with its name on the page.
const TABLES: [(&str, &[&str], &str, &str); 25] = [
    ("cases/block.toml", &[], "", ""),
    ("cases/block.toml", &["body.thickness=2"], "body", "body"),
    ("cases/block.toml", &[], "mesh", "mesh"),
    ("cases/block.toml", &[], "mesh.rectangle", "mesh.rectangle"),
    ("cases/corner.toml", &[], "mesh.trapezoid", "mesh.trapezoid"),
    ("cases/block.toml", &["mesh.perturb={amount=0.1}"], "mesh.perturb", "mesh.perturb"),
    ("cases/block.toml", &[], "material", "material"),
    ("cases/wood.toml", &[], "material.orthotropic", "material.orthotropic"),
    ("cases/block.toml", &[], "load", "load"),
    ("cases/block.toml", &[], "boundary.left", "boundary.NAME"),
    ("cases/block.toml", &[], "boundary.bottom.contact", "boundary.NAME.contact"),
    (
        "cases/block.toml",
        &["boundary.bottom.contact.friction={coulomb=0.1}"],
        "boundary.bottom.contact.friction",
        "boundary.NAME.contact.friction",
    ),
    ("cases/block.toml", &["method.degree=1"], "method", "method"),
    ("cases/block.toml", &["solver.tolerance=1e-9"], "solver", "solver"),
    ("cases/block.toml", &["method.degree=1", "adapt.target=\"1 %\""], "adapt", "adapt"),
    ("cases/block.toml", &["certify.quantities=[]"], "certify", "certify"),
    ("cases/pin.toml", &[], "units", "units"),
    ("cases/pin.toml", &[], "obstacle.pin", "obstacle.NAME"),
    ("cases/pin.toml", &[], "obstacle.pin.circle", "obstacle.NAME.circle"),
    ("cases/disk.toml", &[], "obstacle.floor.plane", "obstacle.NAME.plane"),
    ("cases/block.toml", &["pair=[{boundaries=[\"left\", \"right\"]}]"], "pair.0", "pair"),
    (
        "cases/block.toml",
        &["pair=[{boundaries=[\"left\", \"right\"], friction={coulomb=0.1}}]"],
        "pair.0.friction",
        "pair.friction",
    ),
    ("cases/block.toml", &["point.p.displacement=[0,0]"], "point.p", "point.NAME"),
    ("cases/block.toml", &["step=[{title=\"one\"}]"], "step.0", "step"),
    ("cases/block.toml", &["output.probes=[]"], "output", "output"),
];

/// The keys of the first cells, with their tables, of all sections but that on exact solutions.
fn documented_keys(page: &str) -> BTreeSet<String> {
    let mut section = String::new();
    let mut keys = BTreeSet::new();
    for line in page.lines() {
        if let Some(name) = line.strip_prefix("## ") {
            let inner = name.strip_prefix("`[").and_then(|name| name.strip_suffix("]`"));
            section = inner.unwrap_or_default().trim_matches(['[', ']']).to_owned();
        }
        let Some(row) = line.strip_prefix("| `").filter(|_| section != "exact") else { continue };
        let cell = row.split(" | ").next().unwrap();
        let mut table = String::new();
        for word in cell.split(['`', ',', ' ']).filter(|word| !word.is_empty()) {
            let key = match word.strip_prefix('.') {
                Some(key) => format!("{table}.{key}"),
                None => word.to_owned(),
            };
            table = key.rsplit_once('.').map_or(String::new(), |(table, _)| table.to_owned());
            keys.insert(if section.is_empty() { key } else { format!("{section}.{key}") });
        }
    }
    keys
}

#[test]
fn the_page_on_case_files_lists_exactly_the_keys_that_are_read() {
    let page = page("docs/case.md");
    let mut read = BTreeSet::new();
    for (file, settings, table, name) in TABLES {
        let dot = if name.is_empty() { "" } else { "." };
        read.extend(known(file, settings, table).iter().map(|key| format!("{name}{dot}{key}")));
    }
    // Keys that are tables are listed by what is in them.
    let is_table = |key: &String| {
        let within = format!("{key}.");
        key == "exact" || TABLES.iter().any(|table| format!("{}.", table.3).starts_with(&within))
    };
    read.retain(|key| !is_table(key));
    assert_eq!(documented_keys(&page), read);
    let quadrature = ["method.contact_quadrature={gauss=1}"];
    let gauss = known("cases/block.toml", &quadrature, "method.contact_quadrature");
    assert_eq!(gauss, BTreeSet::from(["gauss".to_owned()]));
    assert!(page.contains("`{ gauss = 4 }`"));
}

#[test]
fn the_page_on_case_files_lists_exactly_the_parameters_of_the_exact_solutions() {
    let text = page("docs/case.md");
    let rows = text.lines().skip_while(|line| !line.starts_with("| `solution`")).skip(2);
    let mut solutions = Vec::new();
    for row in rows.take_while(|line| line.starts_with("| `\"")) {
        let cells: Vec<&str> = row.split(" | ").collect();
        let solution = cells[0].trim_matches(['|', ' ', '`', '"']).to_owned();
        let words = cells[1].split('`').skip(1).step_by(2);
        let documented: BTreeSet<String> = words
            .filter(|word| !word.starts_with('"'))
            .map(|word| word.split(' ').next().unwrap().to_owned())
            .chain(["solution".to_owned()])
            .collect();
        let variants = match solution.as_str() {
            "smooth" | "singular" | "corner" => vec![page(&format!("cases/{solution}.toml"))],
            "patch" => {
                let singular = page("cases/singular.toml");
                let (before, after) = singular.split_once("[exact]").unwrap();
                let rest = &after[after.find("\n[").unwrap()..];
                let test =
                    |i| format!("{before}[exact]\nsolution = \"patch\"\nwhich = \"d{i}\"{rest}");
                (1..=5).map(test).collect()
            }
            _ => panic!("the page has an exact solution '{solution}' that this test does not know"),
        };
        let read: BTreeSet<String> =
            variants.iter().flat_map(|text| known_to("cases/x.toml", text, &[], "exact")).collect();
        assert_eq!(documented, read, "{solution}");
        solutions.push(solution);
    }
    assert_eq!(solutions, ["smooth", "singular", "corner", "patch"]);
}

#[test]
fn output_and_picture_of_the_readme_are_those_of_its_command() {
    let folder = std::env::temp_dir().join(format!("signorini-{}-readme", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let case = root().join("cases/bracket.toml");
    let run = signorini(&folder, &["solve", case.to_str().unwrap()]);
    assert!(run.status.success(), "{run:?}");
    let drawn = fs::read_to_string(folder.join("out/bracket/picture.svg")).unwrap();
    fs::remove_dir_all(folder).unwrap();
    let readme = page("README.md");
    assert!(readme.contains("\ncargo run --release -- solve cases/bracket.toml\n"));
    let shown = readme.split("```text\n").nth(1).and_then(|rest| rest.split("```").next());
    // How many digits are proved differs from processor to processor.
    let alike = |text: &str| match text.split_once("exactly for this mesh, to ") {
        Some((before, after)) => {
            before.to_owned() + after.trim_start_matches(|c: char| c.is_ascii_digit())
        }
        None => text.to_owned(),
    };
    assert_eq!(
        shown.map(alike),
        Some(alike(text(&run.stdout))),
        "copy what the command prints there"
    );
    assert!(drawn == page("docs/bracket.svg"), "copy the picture.svg of cases/bracket.toml there");
}

fn pages() -> Vec<String> {
    let docs = fs::read_dir(root().join("docs")).unwrap();
    ["README.md", "VERIFY.md", "CONTRIBUTING.md", "CHANGELOG.md"]
        .map(str::to_owned)
        .into_iter()
        .chain(docs.map(|entry| format!("docs/{}", entry.unwrap().file_name().to_str().unwrap())))
        .filter(|name| name.ends_with(".md"))
        .collect()
}

#[test]
fn every_link_of_the_readme_and_the_pages_leads_to_a_file_of_the_package() {
    let root = root();
    let manifest = page("Cargo.toml");
    let excluded = manifest.lines().find(|line| line.starts_with("exclude = ")).unwrap();
    let mut count = 0;
    for name in pages() {
        let text = page(&name);
        let folder = Path::new(&name).parent().unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.starts_with("http") || link.starts_with('#') {
                continue;
            }
            let file = folder.join(link.split('#').next().unwrap());
            assert!(root.join(&file).is_file(), "{name} links to {link}, which is no file");
            let first = file.components().next().unwrap().as_os_str().to_str().unwrap();
            // The ledger leads to the claims, which are evidence of the repository and not of the package.
            assert!(
                name == "VERIFY.md" || !excluded.contains(&format!("\"{first}")),
                "{name} links to {link}, which is not packaged"
            );
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
}

/// The anchors that GitHub makes of the headings of a page.
fn anchors(page: &str) -> BTreeSet<String> {
    let headings = page.lines().filter_map(|line| line.strip_prefix('#'));
    let kept = |c: &char| c.is_alphanumeric() || [' ', '-', '_'].contains(c);
    headings
        .map(|line| line.trim_start_matches('#').trim())
        .map(|title| {
            title.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")
        })
        .collect()
}

#[test]
fn every_anchor_of_a_link_is_that_of_a_heading() {
    let mut count = 0;
    for name in pages() {
        let text = page(&name);
        let folder = Path::new(&name).parent().unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let Some((file, anchor)) = link.split_once('#') else { continue };
            let file = if file.is_empty() { PathBuf::from(&name) } else { folder.join(file) };
            if link.starts_with("http") || file.extension() != Some("md".as_ref()) {
                continue;
            }
            let known = anchors(&page(file.to_str().unwrap()));
            assert!(known.contains(anchor), "{name} links to {link}; the headings are {known:?}");
            count += 1;
        }
    }
    assert!(count >= 30, "{count}");
    assert!(!anchors(&page("docs/theory.md")).contains("7-the-mixed-form"));
}

/// The numbers of sections that follow the name of a page in `text`: "docs/theory.md, 5.6" or "theory.md, section 10".
fn sections_named(text: &str, page: &str) -> Vec<String> {
    let ends = text.split(page).skip(1).map(|rest| rest.trim_start_matches([')', '`']));
    ends.filter_map(|rest| rest.strip_prefix(", "))
        .map(|rest| rest.trim_start_matches("sections ").trim_start_matches("section "))
        .map(|rest| {
            rest.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect::<String>()
        })
        .map(|number| number.trim_end_matches('.').to_owned())
        .filter(|number| !number.is_empty())
        .collect()
}

fn rust_files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, into);
        } else if path.extension() == Some("rs".as_ref()) {
            into.push(path);
        }
    }
}

#[test]
fn every_section_of_the_theory_that_code_and_pages_name_is_there() {
    let root = root();
    let mut files: Vec<PathBuf> = pages().iter().map(|name| root.join(name)).collect();
    for folder in ["src", "tests", "props"].map(|name| root.join(name)) {
        // The package does without the folder of the claims.
        if folder.is_dir() {
            rust_files(&folder, &mut files);
        }
    }
    let mut count = 0;
    for name in ["theory.md", "a-posteriori.md"] {
        let text = page(&format!("docs/{name}"));
        let headings = text.lines().filter_map(|line| line.strip_prefix('#'));
        let known: BTreeSet<&str> = headings
            .filter_map(|line| line.trim_start_matches(['#', ' ']).split(' ').next())
            .map(|number| number.trim_end_matches('.'))
            .collect();
        assert!(known.contains("7.4") == (name == "a-posteriori.md"), "{known:?}");
        for file in &files {
            for number in sections_named(&fs::read_to_string(file).unwrap(), name) {
                // The whole page is section 7.
                let whole = number == "7";
                assert!(
                    whole || known.contains(number.as_str()),
                    "{} names {name}, {number}; its sections are {known:?}",
                    file.display()
                );
                count += 1;
            }
        }
    }
    assert!(count >= 60, "{count}");
    let named =
        sections_named("[a.md](a.md), 7.7). Not a.md. Part 6, 8, a.md, section 10.", "a.md");
    assert_eq!(named, ["7.7", "10"]);
}

/// The words of a picture, numbers included.
fn words_of(picture: &str) -> Vec<&str> {
    let before_ends = picture.split("</text>");
    before_ends.filter_map(|text| text.rsplit('>').next()).map(str::trim).collect()
}

#[test]
fn pictures_of_the_gallery_have_the_words_and_numbers_of_their_commands() {
    let root = root();
    let folder = std::env::temp_dir().join(format!("signorini-{}-gallery", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let gallery = page("docs/gallery.md");
    let mut shown = BTreeSet::new();
    for line in gallery.lines().filter_map(|line| line.strip_prefix("signorini solve cases/")) {
        let (name, settings) = line.split_once(".toml").unwrap();
        let case = root.join(format!("cases/{name}.toml"));
        let words = settings.split(' ').filter(|word| !word.is_empty());
        let command: Vec<&str> =
            ["solve", case.to_str().unwrap()].into_iter().chain(words).collect();
        let run = signorini(&folder, &command);
        assert!(run.status.success(), "{run:?}");
        let drawn = fs::read_to_string(folder.join(format!("out/{name}/picture.svg"))).unwrap();
        let stored = page(&format!("docs/gallery/{name}.svg"));
        assert_eq!(words_of(&stored), words_of(&drawn), "copy the picture.svg of {line} there");
        assert!(gallery.contains(&format!("](gallery/{name}.svg)")), "{name} is not shown");
        assert!(words_of(&stored).len() > 20, "{:?}", words_of(&stored));
        shown.insert(words_of(&stored).concat());
    }
    fs::remove_dir_all(folder).unwrap();
    // No two have the same words, so that one in the place of another would be noticed.
    assert_eq!(shown.len(), 8);
}
