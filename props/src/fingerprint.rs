//! Fingerprints of what a run of the model checker was about: a hash of everything that can change the answer of a harness.
//!
//! A fingerprint covers the harness itself, the items of the kernel and of this crate that it reaches, and what the model
//! checker compiles them with: edition, Kani's flags, and the packages that the kernel depends on. An item reaches the items
//! whose names it mentions, wherever they stand; an `impl` belongs to its type, or to its trait where the type is foreign, and
//! a trait is reached by the names of its methods, too. Items count by their tokens without comments, hints to inline, visibility
//! and the modules in front of a name, so that a fingerprint outlives moves between files and crates, renamed modules and
//! formatting. Names are taken for what they say: two items of one name are both reached.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;

use proc_macro2::{Delimiter, Ident, Spacing, TokenStream, TokenTree};
use quote::ToTokens;
use sha2::{Digest, Sha256};
use syn::{Item, Meta, Type, UseTree};

/// The crates that the model checker compiles, by their roots.
const CRATES: [&str; 2] = ["src/kernel/lib.rs", "props/src/lib.rs"];

/// The manifests that say with what.
const MANIFESTS: [&str; 3] = ["src/kernel/Cargo.toml", "Cargo.toml", "props/Cargo.toml"];

/// The macros that make a function a harness: in every fingerprint.
const MACROS: [&str; 3] = ["harnesses", "harness_function", "counterexample"];

/// What the model checker compiles.
#[derive(Default)]
pub struct Sources {
    items: Vec<Entry>,
    /// The harnesses by name, with their tokens.
    harnesses: BTreeMap<String, Vec<String>>,
    /// Edition, flags and packages.
    environment: String,
}

/// An item.
struct Entry {
    /// The names by which it is reached.
    names: BTreeSet<String>,
    /// The type that it declares.
    declares: Option<String>,
    /// The type and the trait of an `impl`.
    implements: Option<(String, Option<String>)>,
    tokens: Vec<String>,
}

impl Sources {
    /// Reads the sources of the workspace in `root`.
    ///
    /// # Errors
    /// A file that can't be read or parsed.
    pub fn read(root: &Path) -> io::Result<Sources> {
        let read = |path: &str| std::fs::read_to_string(root.join(path));
        let mut sources = Sources::default();
        for path in CRATES {
            sources.add_file(&root.join(path))?;
        }
        sources.settle_impls();
        let manifests = MANIFESTS.iter().map(|path| read(path)).collect::<io::Result<Vec<_>>>()?;
        sources.environment = environment(&manifests, &read("Cargo.lock")?);
        Ok(sources)
    }

    /// The fingerprint of each harness, by its name.
    pub fn fingerprints(&self) -> BTreeMap<String, String> {
        let mut named: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (number, item) in self.items.iter().enumerate() {
            for name in &item.names {
                named.entry(name).or_default().push(number);
            }
        }
        let of = |(name, tokens): (&String, &Vec<String>)| {
            (name.clone(), self.fingerprint(tokens, &named))
        };
        self.harnesses.iter().map(of).collect()
    }

    fn fingerprint(&self, harness: &[String], named: &BTreeMap<&str, Vec<usize>>) -> String {
        let mut reached = BTreeSet::new();
        let mut open: Vec<&str> = harness.iter().map(String::as_str).chain(MACROS).collect();
        while let Some(word) = open.pop() {
            for &item in named.get(word).into_iter().flatten() {
                if reached.insert(item) {
                    open.extend(self.items[item].tokens.iter().map(String::as_str));
                }
            }
        }
        let texts: BTreeSet<String> =
            reached.into_iter().map(|item| self.items[item].tokens.join(" ")).collect();
        let mut sha = Sha256::new();
        sha.update(harness.join(" "));
        for text in texts {
            sha.update(format!("\n{text}"));
        }
        sha.update(&self.environment);
        sha.finalize()[..8].iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Adds the items of a file and of the modules that it declares.
    fn add_file(&mut self, path: &Path) -> io::Result<()> {
        let failed =
            |why: &dyn std::fmt::Display| io::Error::other(format!("{}: {why}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|why| failed(&why))?;
        let file = syn::parse_file(&text).map_err(|why| failed(&why))?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let folder = if ["lib", "mod"].contains(&&*stem) {
            path.with_file_name("")
        } else {
            path.with_extension("")
        };
        self.add_items(file.items, &folder)
    }

    /// Adds items of a module whose own modules stand in `folder`.
    fn add_items(&mut self, items: Vec<Item>, folder: &Path) -> io::Result<()> {
        for item in items {
            if !is_compiled(&item) {
                continue;
            }
            let (mut declares, mut implements) = (None, None);
            let names = match &item {
                Item::Mod(module) => {
                    let name = module.ident.to_string();
                    if let Item::Mod(syn::ItemMod { content: Some((_, items)), .. }) = item {
                        self.add_items(items, &folder.join(name))?;
                    } else {
                        let file = folder.join(format!("{name}.rs"));
                        let list = folder.join(name).join("mod.rs");
                        self.add_file(if file.exists() { &file } else { &list })?;
                    }
                    continue;
                }
                Item::Use(import) => {
                    self.add_renames(&import.tree);
                    continue;
                }
                Item::Macro(call) if call.mac.path.is_ident("harnesses") => {
                    self.add_harnesses(&call.mac.tokens);
                    continue;
                }
                Item::Macro(call) => match &call.ident {
                    Some(name) => vec![name.to_string()],
                    // What it makes may be for any of its arguments.
                    None => normal(call.mac.tokens.clone()),
                },
                Item::Impl(block) => {
                    implements = Some(implemented(block));
                    Vec::new()
                }
                Item::Trait(definition) => {
                    let methods = definition.items.iter().filter_map(|item| match item {
                        syn::TraitItem::Fn(method) => Some(method.sig.ident.to_string()),
                        _ => None,
                    });
                    methods.chain([definition.ident.to_string()]).collect()
                }
                Item::Const(item) => vec![item.ident.to_string()],
                Item::Enum(syn::ItemEnum { ident, .. })
                | Item::Struct(syn::ItemStruct { ident, .. })
                | Item::Type(syn::ItemType { ident, .. }) => {
                    declares = Some(ident.to_string());
                    vec![ident.to_string()]
                }
                Item::Fn(item) => vec![item.sig.ident.to_string()],
                Item::Static(item) => vec![item.ident.to_string()],
                other => normal(other.to_token_stream()),
            };
            let names = names.into_iter().collect();
            let tokens = normal(item.into_token_stream());
            self.items.push(Entry { names, declares, implements, tokens });
        }
        Ok(())
    }

    /// A name given by `use .. as name` leads to what it renames.
    fn add_renames(&mut self, tree: &UseTree) {
        match tree {
            UseTree::Path(path) => self.add_renames(&path.tree),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.add_renames(tree)),
            UseTree::Rename(rename) => {
                let [from, to] = [&rename.ident, &rename.rename].map(Ident::to_string);
                let names = BTreeSet::from([to.clone()]);
                let tokens = vec![from, "as".to_owned(), to];
                self.items.push(Entry { names, declares: None, implements: None, tokens });
            }
            UseTree::Name(_) | UseTree::Glob(_) => {}
        }
    }

    /// Adds the harnesses of a call of the macro: `kind name (values)? (within n)? { body }` for each.
    fn add_harnesses(&mut self, tokens: &TokenStream) {
        let (mut harness, mut depth) = (Vec::new(), 0);
        for token in normal(tokens.clone()) {
            depth += i32::from(token == "{") - i32::from(token == "}");
            let ends = token == "}" && depth == 0;
            harness.push(token);
            if ends {
                let name = harness.get(1).cloned().unwrap_or_default();
                self.harnesses.insert(name, std::mem::take(&mut harness));
            }
        }
    }

    /// An `impl` belongs to its type where the type is declared in these sources, else to its trait.
    fn settle_impls(&mut self) {
        let declared: BTreeSet<String> =
            self.items.iter().filter_map(|item| item.declares.clone()).collect();
        for item in &mut self.items {
            if let Some((target, of_trait)) = item.implements.take() {
                let name = if declared.contains(&target) { Some(target) } else { of_trait };
                item.names = name.into_iter().collect();
            }
        }
    }
}

/// The names of the type and of the trait of an `impl`.
fn implemented(block: &syn::ItemImpl) -> (String, Option<String>) {
    let mut target = &*block.self_ty;
    while let Type::Reference(reference) = target {
        target = &reference.elem;
    }
    let name = |path: &syn::Path| path.segments.last().map(|last| last.ident.to_string());
    let target = if let Type::Path(path) = target { name(&path.path) } else { None };
    let of_trait = block.trait_.as_ref().and_then(|(path, _)| name(path));
    (target.unwrap_or_default(), of_trait)
}

fn is_primitive(name: &str) -> bool {
    let numbers = ["f64", "f32", "usize", "isize", "bool", "char", "str"];
    let integer = name.strip_prefix(['i', 'u']).is_some_and(|bits| bits.parse::<u32>().is_ok());
    integer || numbers.contains(&name)
}

/// Whether the model checker compiles an item: `cfg(kani)` holds, `cfg(test)` does not.
fn is_compiled(item: &Item) -> bool {
    let attributes = match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => return true,
    };
    let conditions = attributes.iter().filter(|attribute| attribute.path().is_ident("cfg"));
    conditions
        .filter_map(|attribute| attribute.parse_args::<Meta>().ok())
        .all(|condition| holds(&condition) != Some(false))
}

/// Whether a condition of `cfg` holds under the model checker, where that is known.
fn holds(condition: &Meta) -> Option<bool> {
    match condition {
        Meta::Path(path) if path.is_ident("kani") => Some(true),
        Meta::Path(path) if path.is_ident("test") => Some(false),
        Meta::List(list) => {
            let several = list.parse_args_with(
                syn::punctuated::Punctuated::<Meta, syn::Token![,]>::parse_terminated,
            );
            let each: Vec<Option<bool>> = several.ok()?.iter().map(holds).collect();
            match list.path.get_ident()?.to_string().as_str() {
                "not" => each.first().copied()?.map(|known| !known),
                "all" if each.contains(&Some(false)) => Some(false),
                "any" if each.contains(&Some(true)) => Some(true),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The tokens of a source without documentation, hints to inline, visibility, the modules in front of a name, and commas before a
/// bracket that closes.
fn normal(stream: TokenStream) -> Vec<String> {
    let mut tokens = Vec::new();
    add_normal(stream, &mut tokens);
    tokens
}

fn add_normal(stream: TokenStream, tokens: &mut Vec<String>) {
    let trees: Vec<TokenTree> = stream.into_iter().collect();
    let punct = |at: usize, sign: char| matches!(trees.get(at), Some(TokenTree::Punct(p)) if p.as_char() == sign);
    let ident = |at: usize| match trees.get(at) {
        Some(TokenTree::Ident(ident)) => Some(ident.to_string()),
        _ => None,
    };
    let mut at = 0;
    while at < trees.len() {
        match &trees[at] {
            TokenTree::Punct(_)
                if punct(at, '#') && begins(trees.get(at + 1), &["doc", "inline"]) =>
            {
                at += 1;
            }
            TokenTree::Punct(_)
                if punct(at, '$') && ident(at + 1).is_some_and(|i| i == "crate") => {}
            TokenTree::Punct(sign) => {
                // `==` and `= =` are two things.
                let joint = sign.spacing() == Spacing::Joint;
                tokens.push(format!("{}{}", sign.as_char(), if joint { "-" } else { "" }));
            }
            TokenTree::Ident(name) if *name == "pub" => {
                at += usize::from(begins(trees.get(at + 1), &["crate", "super", "self", "in"]));
            }
            TokenTree::Ident(name) => {
                let name = name.to_string();
                let module = name.starts_with(|c: char| c.is_lowercase()) && !is_primitive(&name);
                let path = punct(at + 1, ':') && punct(at + 2, ':') && ident(at + 3).is_some();
                if module && path {
                    at += 2;
                } else {
                    tokens.push(name);
                }
            }
            TokenTree::Literal(literal) => tokens.push(literal.to_string()),
            TokenTree::Group(group) => {
                let [open, close] = match group.delimiter() {
                    Delimiter::Parenthesis => ["(", ")"],
                    Delimiter::Brace => ["{", "}"],
                    Delimiter::Bracket => ["[", "]"],
                    Delimiter::None => ["", ""],
                };
                tokens.push(open.to_owned());
                add_normal(group.stream(), tokens);
                if tokens.last().is_some_and(|last| last == ",") {
                    tokens.pop();
                }
                tokens.push(close.to_owned());
            }
        }
        at += 1;
    }
}

/// Whether a group of tokens begins with one of these words.
fn begins(tree: Option<&TokenTree>, words: &[&str]) -> bool {
    let Some(TokenTree::Group(group)) = tree else { return false };
    let first = group.stream().into_iter().next();
    matches!(first, Some(TokenTree::Ident(ident)) if words.iter().any(|word| ident == word))
}

/// The edition, Kani's flags, and the registry's packages that the manifests depend on under the model checker, with all
/// that these need.
fn environment(manifests: &[String], lock: &str) -> String {
    let (mut lines, mut open) = (BTreeSet::new(), Vec::new());
    for manifest in manifests {
        let mut section = "";
        for line in manifest.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'))
        {
            if line.starts_with('[') {
                section = line;
            }
            let dependency = section == "[dependencies]" && !line.starts_with('[');
            let registry = dependency && !line.contains("path =") && !line.contains("workspace");
            let flag = section.contains("metadata.kani");
            let edition = line.starts_with("edition =");
            if registry || flag || edition {
                lines.insert(line.to_owned());
            }
            if registry {
                open.push(line.split([' ', '=']).next().unwrap_or_default().to_owned());
            }
        }
    }
    let packages = packages(lock);
    let mut reached = BTreeSet::new();
    while let Some(name) = open.pop() {
        // A name alone, or with its version where there are several.
        let is = |key: &&String| **key == name || key.split(' ').next() == Some(&name);
        for package in packages.keys().filter(is) {
            if reached.insert(package) {
                let needs = packages[package].lines().filter_map(|line| line.strip_prefix(" \""));
                open.extend(needs.map(|need| need.trim_end_matches("\",").to_owned()));
            }
        }
    }
    lines.extend(reached.into_iter().map(|package| packages[package].clone()));
    lines.into_iter().collect::<Vec<_>>().join("\n")
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

    const KERNEL: &str = "pub mod flat;\npub mod round;\n#[cfg(not(kani))]\npub mod solve;\n";
    const FLAT: &str = "use nalgebra::Vector2;\npub struct Square;\nimpl Square {\n    pub fn area(&self) -> i32 {\n        crate::round::scale(1)\n    }\n}\n";
    const ROUND: &str = "pub fn scale(a: i32) -> i32 {\n    a\n}\npub fn pi() -> i32 {\n    3\n}\n";
    const CLAIM: &str = "\
use signorini::flat::Square;
fn is_positive(a: i32) -> bool {
    a > 0
}
harnesses! {
    /// True.
    holds areas_are_positive() {
        assert!(is_positive(Square.area()));
    }
    fails control_areas_are_zero([1.0]) {
        assert!(Square.area() == 0);
    }
}
#[cfg(not(kani))]
mod row {
    fn draws() {}
}
";
    const LOCK: &str = "[[package]]\nname = \"nalgebra\"\nversion = \"0.34\"\nsource = \"registry\"\n\
        dependencies = [\n \"simba\",\n]\n[[package]]\nname = \"simba\"\nversion = \"1\"\n\
        source = \"registry\"\n[[package]]\nname = \"faer\"\nversion = \"2\"\nsource = \"registry\"\n";
    const MANIFEST: &str = "edition = \"2024\"\n[dependencies]\nnalgebra = \"0.34\"\n\
        [target.'cfg(not(kani))'.dependencies]\nfaer = \"2\"\n";

    /// The fingerprints of the harness and of its control in a small workspace, with some files in place of its own.
    fn fingerprints(changes: &[(&str, &str)]) -> [String; 2] {
        use std::sync::atomic::{AtomicUsize, Ordering};
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let root = std::env::temp_dir()
            .join(format!("signorini-fingerprint-{}-{number}", std::process::id()));
        let mut files = BTreeMap::from([
            (CRATES[0], KERNEL),
            ("src/kernel/flat.rs", FLAT),
            ("src/kernel/round.rs", ROUND),
            (CRATES[1], "mod areas;\n"),
            ("props/src/areas.rs", CLAIM),
            (MANIFESTS[0], MANIFEST),
            (MANIFESTS[1], ""),
            (MANIFESTS[2], "[dependencies]\nsignorini = { path = \"..\" }\n"),
            ("Cargo.lock", LOCK),
        ]);
        files.extend(changes.iter().copied());
        for (path, text) in files {
            let path = root.join(path);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, text).expect("a file");
        }
        let found = Sources::read(&root).expect("sources").fingerprints();
        std::fs::remove_dir_all(root).expect("the folder");
        ["areas_are_positive", "control_areas_are_zero"].map(|name| found[name].clone())
    }

    fn changed(changes: &[(&str, &str)]) -> [bool; 2] {
        let (before, after) = (fingerprints(&[]), fingerprints(changes));
        [0, 1].map(|n| before[n] != after[n])
    }

    #[test]
    fn a_fingerprint_changes_with_what_its_harness_reaches() {
        let one = |path: &'static str, text: &str, from: &str, to: &str| {
            assert!(text.contains(from));
            changed(&[(path, &text.replace(from, to))])
        };
        assert_eq!(one("src/kernel/flat.rs", FLAT, "scale(1)", "scale(2)"), [true; 2]);
        assert_eq!(one("src/kernel/round.rs", ROUND, "    a\n", "    a + 1\n"), [true; 2]);
        assert_eq!(one("props/src/areas.rs", CLAIM, "a > 0", "a >= 0"), [true, false]);
        assert_eq!(one("props/src/areas.rs", CLAIM, "== 0", "== 7"), [false, true]);
        assert_eq!(one(MANIFESTS[0], MANIFEST, "2024", "2021"), [true; 2]);
        assert_eq!(one("Cargo.lock", LOCK, "version = \"1\"", "version = \"1.1\""), [true; 2]);
        let flags =
            format!("{MANIFEST}[workspace.metadata.kani.flags]\nno-overflow-checks = true\n");
        assert_eq!(changed(&[(MANIFESTS[0], &flags)]), [true; 2]);
        let renamed = "use signorini::round::pi as scale;\nmod areas;\n";
        assert_eq!(changed(&[(CRATES[1], renamed)]), [true; 2]);
    }

    #[test]
    fn a_fingerprint_outlives_moves_and_changes_elsewhere() {
        let one = |path: &'static str, text: &str, from: &str, to: &str| {
            assert!(text.contains(from));
            changed(&[(path, &text.replace(from, to))])
        };
        assert_eq!(one("src/kernel/round.rs", ROUND, "    3\n", "    4\n"), [false; 2]);
        assert_eq!(one("src/kernel/flat.rs", FLAT, "pub fn", "/// An area.\n    fn"), [false; 2]);
        assert_eq!(one("props/src/areas.rs", CLAIM, "fn draws() {}", "fn others() {}"), [false; 2]);
        assert_eq!(one("props/src/areas.rs", CLAIM, "/// True.", "/// Quite true."), [false; 2]);
        assert_eq!(one("Cargo.lock", LOCK, "version = \"2\"", "version = \"3\""), [false; 2]);
        // Everything in one file, at another place, in another crate.
        let moved = format!("mod areas;\nmod inner {{\n{FLAT}{ROUND}}}\n")
            .replace("crate::round::", "super::");
        assert_eq!(
            changed(&[(CRATES[0], "#[cfg(test)]\nmod a {}\n"), (CRATES[1], &moved)]),
            [false; 2]
        );
    }
}
