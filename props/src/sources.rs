//! What a run of the model checker was about: a hash of everything that can change the answer of a harness.
//!
//! It covers the harness itself, the rest of its file (the other harnesses apart), and every file of the kernel and of this
//! crate that these reach. A file reaches another one if a word of it is the name of that file's module or of one of its
//! public items, or if it says `super` or has a glob import; that goes on from file to file, and from the words that are
//! names of packages into `Cargo.lock`. Nothing else can matter: a method belongs to a type or to a trait, which somebody
//! on the way has named, for every `impl` stands in the file of its trait or of its type (a test sees to that). What the
//! model checker does not compile (`#[cfg(test)]`, `#[cfg(not(kani))]`) and comments are left out. So are the lists of
//! modules and of re-exports: what a name leads to is in by its own file.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;

use sha2::{Digest, Sha256};

/// The sources that the model checker compiles, by their paths from the root of the workspace.
pub struct Sources {
    files: BTreeMap<String, File>,
    /// The entries of `Cargo.lock` that come from a registry, by name and version.
    packages: BTreeMap<String, String>,
}

#[derive(Clone)]
struct File {
    /// What is compiled, without comments, harnesses and lists of modules and re-exports.
    text: String,
    /// The harnesses: their names and texts.
    harnesses: BTreeMap<String, String>,
    /// By these words other files reach it.
    names: BTreeSet<String>,
    /// The modules that it declares in files of their own.
    modules: BTreeSet<String>,
}

/// In every hash: the attributes of the crates, the edition, and what makes a function a harness.
const ALWAYS: [&str; 4] = ["src/lib.rs", "props/src/lib.rs", "props/src/harness.rs", "Cargo.toml"];

impl Sources {
    /// Reads the sources of the workspace in `root`.
    ///
    /// # Errors
    /// A directory or a file that can't be read.
    pub fn read(root: &Path) -> io::Result<Sources> {
        let mut paths = vec!["src/lib.rs".to_owned()];
        for directory in ["src/kernel", "props/src"] {
            collect(&root.join(directory), directory, &mut paths)?;
        }
        let mut files = BTreeMap::new();
        for path in paths {
            let file = File::new(&path, &std::fs::read_to_string(root.join(&path))?);
            files.insert(path, file);
        }
        files = files.iter().filter(|(path, _)| is_compiled(&files, path)).map(clone).collect();
        let manifest = std::fs::read_to_string(root.join("Cargo.toml"))?;
        let edition: String = manifest.lines().filter(|line| line.starts_with("edition")).collect();
        files.insert("Cargo.toml".to_owned(), File::new("", &edition));
        let lock = std::fs::read_to_string(root.join("Cargo.lock"))?;
        Ok(Sources { files, packages: packages(&lock) })
    }

    /// The harnesses by their paths in this crate, each with the hash of what it is about.
    pub fn harnesses(&self) -> BTreeMap<String, String> {
        let mut hashes = BTreeMap::new();
        for (path, file) in &self.files {
            for (name, text) in &file.harnesses {
                let module = path.trim_start_matches("props/src/").trim_end_matches(".rs");
                let module = module.trim_end_matches("/mod").replace('/', "::");
                hashes.insert(format!("{module}::{name}"), self.hash(path, text));
            }
        }
        hashes
    }

    /// The files and the packages that a harness with this text reaches from its file.
    fn reached<'a>(
        &'a self,
        path: &'a str,
        harness: &'a str,
    ) -> (BTreeSet<&'a str>, BTreeSet<&'a str>) {
        let (mut files, mut packages) = (BTreeSet::new(), BTreeSet::new());
        let mut open = vec![(path, harness)];
        let mut found: Vec<&str> = ALWAYS.into_iter().chain([path]).collect();
        loop {
            for path in found.drain(..) {
                if let Some((path, file)) = self.files.get_key_value(path)
                    && files.insert(path.as_str())
                {
                    open.push((path, &file.text));
                }
            }
            let Some((path, text)) = open.pop() else { return (files, packages) };
            let words: BTreeSet<&str> = words(text).collect();
            let all = text.contains("::*") || text.contains("{*");
            for (other, file) in &self.files {
                let above = words.contains("super") && parents(path).contains(other);
                if all || above || file.names.iter().any(|name| words.contains(name.as_str())) {
                    found.push(other);
                }
            }
            self.reach_packages(&words, &mut packages);
        }
    }

    fn reach_packages<'a>(&'a self, words: &BTreeSet<&str>, reached: &mut BTreeSet<&'a str>) {
        let name = |package: &str| package.split(' ').next().unwrap_or(package).to_owned();
        let named = |package: &&String| words.contains(name(package).replace('-', "_").as_str());
        let mut open: Vec<&String> = self.packages.keys().filter(named).collect();
        while let Some(package) = open.pop() {
            if reached.insert(package.as_str()) {
                // An entry quotes the packages that it needs, with their version where there are several.
                let entry = &self.packages[package];
                let needs = |other: &&String| {
                    [name(other), (*other).clone()]
                        .iter()
                        .any(|n| entry.contains(&format!("\"{n}\"")))
                };
                open.extend(self.packages.keys().filter(needs));
            }
        }
    }

    fn hash(&self, path: &str, harness: &str) -> String {
        let (files, packages) = self.reached(path, harness);
        let mut sha = Sha256::new();
        sha.update(harness);
        for file in files {
            sha.update(format!("\n{file}\n{}", self.files[file].text));
        }
        for package in packages {
            sha.update(format!("\n{package}\n{}", self.packages[package]));
        }
        sha.finalize()[..8].iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

fn clone((path, file): (&String, &File)) -> (String, File) {
    (path.clone(), file.clone())
}

/// Whether the model checker compiles a file: somebody whom it compiles declares the module.
fn is_compiled(files: &BTreeMap<String, File>, path: &str) -> bool {
    let module = path.trim_end_matches(".rs").trim_end_matches("/mod").rsplit('/').next();
    path.ends_with("/lib.rs")
        || parents(path).iter().any(|parent| {
            let declares = |file: &File| module.is_some_and(|m| file.modules.contains(m));
            files.get(parent).is_some_and(declares) && is_compiled(files, parent)
        })
}

/// The files in which the module of a file may be declared: those that `super` may lead to.
fn parents(path: &str) -> [String; 3] {
    let module = path.trim_end_matches(".rs").trim_end_matches("/mod");
    let directory = module.rsplit_once('/').map_or("", |(directory, _)| directory);
    [format!("{directory}.rs"), format!("{directory}/mod.rs"), format!("{directory}/lib.rs")]
}

/// The Rust files below a directory.
fn collect(directory: &Path, path: &str, paths: &mut Vec<String>) -> io::Result<()> {
    for entry in std::fs::read_dir(directory)? {
        let entry = entry?;
        let path = format!("{path}/{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), &path, paths)?;
        } else if path.ends_with(".rs") {
            paths.push(path);
        }
    }
    Ok(())
}

impl File {
    fn new(path: &str, source: &str) -> File {
        let (text, harnesses) = without_harnesses(&compiled(source));
        let list = |line: &str| {
            let item = line.strip_prefix("pub ").unwrap_or(line);
            let module = item.strip_prefix("mod ").and_then(|rest| rest.strip_suffix(';'));
            module.map(str::to_owned)
        };
        let modules = text.lines().filter_map(list).collect();
        let mut names: BTreeSet<String> = text.lines().filter_map(public_item).collect();
        let lists = ["mod.rs", "lib.rs"].iter().any(|name| path.ends_with(name));
        let module = path.trim_end_matches(".rs").trim_end_matches("/mod").rsplit('/').next();
        names.extend(module.filter(|module| *module != "lib").map(str::to_owned));
        // What a list of modules or of re-exports names is reached by those who use the name; a new name is not.
        let kept = |line: &&str| {
            let reexport = line.starts_with("pub use ") && line.ends_with(';');
            list(line).is_none() && !(lists && reexport && !line.contains(" as "))
        };
        let text = text.lines().filter(kept).collect::<Vec<_>>().join("\n");
        File { text, harnesses, names, modules }
    }
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty())
}

/// The name of an item that other files can see, from the line that declares it.
fn public_item(line: &str) -> Option<String> {
    let rest = if let Some(rest) = line.strip_prefix("macro_rules! ") {
        return words(rest).next().map(str::to_owned);
    } else {
        line.strip_prefix("pub")?
    };
    let mut words = words(rest.trim_start());
    let kinds = ["fn", "struct", "enum", "trait", "const", "static", "type", "union"];
    words.by_ref().find(|word| kinds.contains(word))?;
    words.find(|word| *word != "fn" && *word != "mut").map(str::to_owned)
}

/// A source without comments on lines of their own, without blank lines, and without the items that are not compiled.
/// Sources are formatted: an item ends with the first line at its indentation that ends in `;` or `}`.
fn compiled(source: &str) -> String {
    let mut kept = String::new();
    let mut lines = source.lines().peekable();
    while let Some(line) = lines.next() {
        let code = line.trim_start();
        let indentation = line.len() - code.len();
        let apart = code.starts_with("#[cfg(test)]") || code.starts_with("#[cfg(not(kani))]");
        if apart && lines.peek().is_some_and(|next| is_item(next)) {
            for line in lines.by_ref() {
                let code = line.trim_start();
                let end = code.split(" //").next().unwrap_or(code).trim_end().ends_with([';', '}']);
                if line.len() - code.len() == indentation && end {
                    break;
                }
            }
        } else if !code.is_empty() && !code.starts_with("//") {
            kept += line;
            kept.push('\n');
        }
    }
    kept
}

fn is_item(line: &str) -> bool {
    let kinds = ["pub", "mod", "use", "fn", "const", "static", "impl", "struct", "enum", "type"];
    words(line).next().is_some_and(|word| kinds.contains(&word)) && !line.trim_end().ends_with(',')
}

/// A compiled source with a blank line for each harness, and the harnesses: `holds name() {` or `fails name([..]) {` up to
/// the brace that closes it.
fn without_harnesses(compiled: &str) -> (String, BTreeMap<String, String>) {
    let (mut rest, mut harnesses) = (String::new(), BTreeMap::new());
    let mut current: Option<(String, String)> = None;
    for line in compiled.lines() {
        let item = line.strip_prefix("    ").unwrap_or_default();
        if let Some((name, text)) = &mut current {
            text.push_str(line);
            text.push('\n');
            if item == "}" {
                harnesses.insert(std::mem::take(name), std::mem::take(text));
                current = None;
                rest.push('\n');
            }
        } else if let Some(header) = item.strip_prefix("holds ").or(item.strip_prefix("fails ")) {
            let name = words(header).next().unwrap_or_default().to_owned();
            current = Some((name, format!("{line}\n")));
        } else {
            rest += line;
            rest.push('\n');
        }
    }
    // What does not end is no harness: its text stays.
    if let Some((_, text)) = current {
        rest += &text;
    }
    (rest, harnesses)
}

/// The entries of `Cargo.lock` that come from a registry, by name and version.
fn packages(lock: &str) -> BTreeMap<String, String> {
    let mut packages = BTreeMap::new();
    for entry in lock.split("[[package]]").skip(1) {
        let field = |key: &str| {
            let line = entry.lines().find_map(|line| line.strip_prefix(key));
            line.map(|value| value.trim_matches('"').to_owned())
        };
        if let (Some(name), Some(version), Some(_)) =
            (field("name = "), field("version = "), field("source = "))
        {
            packages.insert(format!("{name} {version}"), entry.to_owned());
        }
    }
    packages
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIBRARY: &str = "pub mod kernel;\n#[cfg(not(kani))]\npub mod solve;\n";
    const CLAIM: &str = "\
use signorini::kernel::area;
harnesses! {
    /// True.
    holds areas_are_positive() {
        assert!(area() > 0);
    }
    fails control_areas_are_zero([1.0]) {
        assert!(area() == 0);
    }
}
#[cfg(not(kani))]
mod row {
    fn draws() {}
}
";

    /// A small workspace, with some files in place of its own.
    fn sources(changes: &[(&str, &str)]) -> BTreeMap<String, String> {
        let mut texts = BTreeMap::from([
            ("src/lib.rs", LIBRARY),
            ("src/kernel/mod.rs", "pub mod flat;\npub mod round;\npub use flat::area;\n"),
            ("src/kernel/flat.rs", "use nalgebra::Vector2;\npub fn area() -> i32 {\n    1\n}\n"),
            ("src/kernel/round.rs", "pub fn pi() -> i32 {\n    3\n}\n"),
            (
                "props/src/lib.rs",
                "pub mod claims;\npub mod harness;\n#[cfg(not(kani))]\npub mod area;\n",
            ),
            ("props/src/harness.rs", "pub use kani::any;\n"),
            ("props/src/area.rs", "pub fn area() {}\n"),
            ("props/src/claims/mod.rs", "pub mod areas;\n"),
            ("props/src/claims/areas.rs", CLAIM),
            ("Cargo.toml", "edition = \"2024\"\n"),
        ]);
        texts.extend(changes.iter().copied());
        let lock = "[[package]]\nname = \"nalgebra\"\nversion = \"0.34\"\nsource = \"registry\"\n\
                    dependencies = [\n \"simba\",\n]\n[[package]]\nname = \"simba\"\nversion = \"V\"\n\
                    source = \"registry\"\n[[package]]\nname = \"faer\"\nversion = \"F\"\nsource = \"registry\"\n";
        let lock = texts.remove("Cargo.lock").map_or(lock.to_owned(), |c| lock.replace(&c[..1], c));
        let mut files: BTreeMap<String, File> = texts
            .into_iter()
            .map(|(path, text)| (path.to_owned(), File::new(path, text)))
            .collect();
        let all = files.clone();
        files.retain(|path, _| path == "Cargo.toml" || is_compiled(&all, path));
        Sources { files, packages: packages(&lock) }.harnesses()
    }

    const HOLDS: &str = "claims::areas::areas_are_positive";
    const FAILS: &str = "claims::areas::control_areas_are_zero";

    fn changed(path: &str, text: &str) -> [bool; 2] {
        let (before, after) = (sources(&[]), sources(&[(path, text)]));
        assert!(before.keys().eq([HOLDS, FAILS]) && after.keys().eq([HOLDS, FAILS]));
        [HOLDS, FAILS].map(|harness| before[harness] != after[harness])
    }

    #[test]
    fn a_harness_has_another_hash_when_something_changes_that_it_reaches() {
        let flat = "use nalgebra::Vector2;\npub fn area() -> i32 {\n    2\n}\n";
        assert_eq!(changed("src/kernel/flat.rs", flat), [true; 2]);
        assert_eq!(changed("props/src/harness.rs", "pub use kani::assume;\n"), [true; 2]);
        assert_eq!(changed("Cargo.toml", "edition = \"2021\"\n"), [true; 2]);
        assert_eq!(
            changed("src/kernel/mod.rs", "pub mod flat;\npub use flat::pi as area;\n"),
            [true; 2]
        );
        assert_eq!(changed("Cargo.lock", "V1"), [true; 2], "nalgebra needs simba");
        let through = "use super::round::pi;\npub fn area() -> i32 {\n    pi()\n}\n";
        let round = ("src/kernel/round.rs", "pub fn pi() -> i32 {\n    4\n}\n");
        let flat = ("src/kernel/flat.rs", through);
        assert_ne!(sources(&[flat]), sources(&[flat, round]));
    }

    #[test]
    fn a_harness_has_the_same_hash_when_something_else_changes() {
        assert_eq!(changed("src/kernel/round.rs", "pub fn pi() -> i32 {\n    4\n}\n"), [false; 2]);
        assert_eq!(changed("props/src/area.rs", "pub fn area() -> bool {}\n"), [false; 2]);
        assert_eq!(changed("Cargo.lock", "F1"), [false; 2]);
        let rows = CLAIM.replace("fn draws() {}", "fn others() {}");
        assert_eq!(changed("props/src/claims/areas.rs", &rows), [false; 2]);
        let comment = CLAIM.replace("/// True.", "/// Quite true.");
        assert_eq!(changed("props/src/claims/areas.rs", &comment), [false; 2]);
    }

    #[test]
    fn a_change_of_one_harness_is_none_of_the_other_and_what_both_use_is_of_both() {
        let one = CLAIM.replace("area() == 0", "area() == 7");
        assert_eq!(changed("props/src/claims/areas.rs", &one), [false, true]);
        let both = CLAIM.replace("use signorini", "use  signorini");
        assert_eq!(changed("props/src/claims/areas.rs", &both), [true; 2]);
    }

    #[test]
    fn only_what_follows_the_attribute_is_left_out() {
        let source = "#[cfg(test)]\nuse a::{\n    b,\n};\nfn c() {}\n#[cfg(not(kani))]\nmod row {\n    fn d() {}\n}\nfn e() {}\n";
        assert_eq!(compiled(source), "fn c() {}\nfn e() {}\n");
        let field = "struct A {\n    #[cfg(test)]\n    a: i32,\n    b: i32,\n}\n";
        assert_eq!(compiled(field), field);
    }

    /// The hash follows names, and a method is found by the name of its type or of its trait: so an `impl` must not
    /// stand where neither is declared.
    #[test]
    fn every_impl_of_the_kernel_and_of_the_harnesses_stands_with_its_type_or_its_trait() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        let sources = Sources::read(root).expect("the sources");
        let mut impls = 0;
        for (path, file) in &sources.files {
            let own: BTreeSet<&str> = file
                .text
                .lines()
                .filter_map(|line| {
                    let mut words = words(line)
                        .skip_while(|w| !["struct", "enum", "trait", "union", "type"].contains(w));
                    words.next().and(words.next())
                })
                .collect();
            // What a macro implements for its parameter stands where the macro is called, with the type.
            let implements = |line: &&str| {
                let line = line.trim_start();
                !line.contains('$')
                    && (line.starts_with("impl") || line.contains("entry_of_nalgebra!("))
            };
            for line in file.text.lines().filter(implements) {
                impls += 1;
                assert!(words(line).any(|word| own.contains(word)), "{path}: {line}");
            }
        }
        assert!(impls > 20, "{impls}");
    }
}
