//! What is asked of `VERIFY.md`: that it is what the claims print, that its links lead to what they name, that checks call the code
//! that they are said to be about, and that rows and predicates keep their rules.

use super::*;

/// What begins the lists at the end, which are not read but looked up.
const LISTS: &str = "## Lists to look things up in\n";

fn evidence(claim: &Claim) -> impl Iterator<Item = &Check> {
    claim.checks.iter().filter(|check| !check.control)
}

fn words(text: &str) -> usize {
    text.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

/// The links of a text, each with what it shows and where it leads.
fn links(text: &str) -> impl Iterator<Item = (&str, &str)> {
    text.match_indices("](").filter_map(|(middle, _)| {
        let start = text[..middle].rfind('[')?;
        let end = middle + text[middle..].find(')')?;
        Some((&text[start + 1..middle], &text[middle + 2..end]))
    })
}

/// What is read aloud: all before the lists, without the lines of links and without names, which are looked up.
fn read_aloud(page: &str) -> String {
    let (prose, _) = page.split_once(LISTS).expect("the lists");
    let (front, items) = prose.split_once("## The items of the paper").expect("the items");
    let items = items.lines().filter(|line| !line.starts_with(LINKS)).collect::<Vec<_>>();
    let mut read = format!("{front}{}", items.join("\n"));
    for (shown, place) in links(prose) {
        let is_name = shown.contains(['_', '`', '§']);
        let link = format!("[{shown}]({place})");
        read = read.replace(&link, if is_name { "" } else { shown });
    }
    read
}

#[test]
fn verify_md_is_what_the_claims_print() {
    let stored = std::fs::read_to_string(root().join("VERIFY.md")).unwrap_or_default();
    let printed = page();
    assert!(stored == printed, "stale: cargo run -p props -- ledger > VERIFY.md");
}

#[test]
fn verify_md_is_read_aloud_in_a_quarter_of_an_hour() {
    let page = page();
    assert!(words(page) <= 4500, "{} words", words(page));
    // At 150 words a minute.
    let read = words(&read_aloud(page));
    assert!((1500..=2300).contains(&read), "{read} words of prose");
    // A sentence counts, and so do the words of a link that are no name; a line of links does not.
    let text = format!(
        "One [two three](a.rs) [`four`](a.rs#L1).\n## The items of the paper\nFive.\n{LINKS}[six_seven](a.rs#L6) eight.\n{LISTS}ten"
    );
    assert_eq!(words(&read_aloud(&text)), words("One two three Five"));
}

/// What is wrong with the links to lines of a page: each must lead to a line that has the name which the link shows, or the
/// header of the function that a check of this name is stated by.
fn astray(page: &str, checks: &[Check], places: &Places) -> Vec<String> {
    let mut found = Vec::new();
    // Whether a statement hands its data to the function that stands there: asked by another test, too.
    let leads_there = |shown: &str, place: &str| {
        let of = checks.iter().filter(|c| is_a_statement(c) && !c.control && c.name == shown);
        of.map(|check| places.of(check)).any(|of| of.as_deref() == Ok(place))
    };
    for (shown, place) in links(page) {
        let Some((file, line)) = place.split_once("#L") else { continue };
        let text = places.files.iter().find(|(name, _)| name == file).map(|(_, text)| text);
        let line = line.parse().ok().and_then(|line: usize| text?.lines().nth(line - 1));
        let is_shown = |name: &str| name.trim_start_matches("control_") == shown;
        let stated = checks.iter().find_map(|check| match check.subject {
            Subject::Function(_, stated) if is_shown(check.name) => Some(stated),
            _ => None,
        });
        let has = |line: &str| match stated {
            // A control whose mistake stands in the line leads there.
            Some(Stated::At(_)) => line.contains(shown),
            Some(Stated::In(function)) => {
                let name = parts(function).1;
                ['<', '('].iter().any(|end| line.contains(&format!("fn {name}{end}")))
            }
            None => line.contains(shown.trim_matches('`')) || leads_there(shown, place),
        };
        if !line.is_some_and(has) {
            found.push(format!("{shown}: {place}"));
        }
    }
    found
}

#[test]
fn each_link_leads_to_a_line_with_the_name_that_it_shows_or_with_the_function_that_states_it() {
    let (page, places) = (page(), Places::read().expect("the sources"));
    let checks: Vec<Check> = claims::all().into_iter().flat_map(|claim| claim.checks).collect();
    assert_eq!(astray(page, &checks, &places), Vec::<String>::new());
    assert!(links(page).filter(|(_, place)| place.contains("#L")).count() > 400);
    // A link that is a line off, one to a function that states another check, one to a file that is not there.
    let right = places.of(checks.iter().find(|c| c.name == "positive_part_satisfies_4").unwrap());
    let (file, line) = right.as_deref().unwrap().split_once("#L").unwrap();
    let off = format!("{file}#L{}", line.parse::<usize>().unwrap() + 1);
    for (name, place) in [
        ("positive_part_satisfies_4", off.as_str()),
        ("12_and_the_bound_of_phi_hold_on_random_bodies_for_p1", right.as_deref().unwrap()),
        ("`pressure`", "src/kernel/no_such_file.rs#L1"),
    ] {
        assert_eq!(astray(&format!("[{name}]({place})"), &checks, &places).len(), 1, "{name}");
    }
}

#[test]
fn the_controls_that_are_counted_are_those_that_are_listed() {
    let page = page();
    let lines = page.lines().filter(|line| line.starts_with("- *Controls:*"));
    let listed = lines.flat_map(links).filter(|(shown, _)| !shown.starts_with('`')).count();
    let checks = claims::all().into_iter().flat_map(|claim| claim.checks);
    assert!(page.contains(&format!("; {listed} controls.")), "{listed}");
    // What is asked can fail: one of them is a control of two engines.
    assert!(listed < checks.filter(|check| check.control).count());
}

/// A name that is called, behind that of a module or a type, or `.` for a method.
type Call<'a> = (&'a str, &'a str);

/// A function: its name, its file, the header of the `impl` around it, whether it is a method, to what it belongs, and what it calls.
struct Function<'a> {
    name: &'a str,
    file: &'a str,
    header: &'a str,
    is_method: bool,
    /// Its type or its trait, or else its module.
    owner: &'a str,
    calls: Vec<Call<'a>>,
}

/// A name that is called, with the file of the function that it means, if that is known.
type Reached<'a> = (&'a str, Option<&'a str>);

/// The functions of the sources, which of them have a name, and what each one calls.
struct Functions<'a> {
    all: Vec<Function<'a>>,
    named: BTreeMap<&'a str, Vec<usize>>,
    called: Vec<Vec<(&'a str, Option<usize>)>>,
    imported: BTreeMap<&'a str, BTreeSet<&'a str>>,
}

/// The page, printed once for all tests.
fn page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| ledger().expect("each name stands in the sources"))
}

/// The sources with their functions, read once for all tests.
fn sources() -> (&'static Places, &'static Functions<'static>) {
    static SOURCES: OnceLock<(&Places, Functions)> = OnceLock::new();
    let (places, functions) = SOURCES.get_or_init(|| {
        let places: &Places = Box::leak(Box::new(Places::read().expect("the sources")));
        (places, Functions::of(places))
    });
    (places, functions)
}

/// The names in the imports of a text.
fn imports(text: &str) -> BTreeSet<&str> {
    let statements = text.split("use ").skip(1).filter_map(|rest| rest.split(';').next());
    statements
        .flat_map(|names| names.split(|c| !is_name(c)))
        .filter(|name| !name.is_empty())
        .collect()
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// What of a text is before the bracket that closes the one which stands before it.
fn inside(text: &str, [open, close]: [char; 2]) -> Option<&str> {
    let mut depth = 1;
    let end = text.find(|c| {
        depth += i32::from(c == open) - i32::from(c == close);
        depth == 0
    });
    end.map(|end| &text[..end])
}

/// The type, or the trait, to which the functions below this header belong.
fn own_type(header: &str) -> &str {
    let of = header.rsplit_once(" for ").map_or(header, |(_, of)| of);
    let parameters = of.strip_prefix("impl<").and_then(|rest| inside(rest, ['<', '>']));
    let of = parameters.map_or(of, |inside| &of["impl<>".len() + inside.len()..]);
    let mut names = of.split(|c| !is_name(c)).filter(|name| !name.is_empty());
    names.find(|name| !["impl", "pub", "trait"].contains(name)).unwrap_or_default()
}

/// The functions of a text.
fn functions<'a>(file: &'a str, text: &'a str) -> Vec<Function<'a>> {
    let mut found = Vec::new();
    let mut header = "";
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        match () {
            () if ["impl", "pub trait", "trait"].iter().any(|s| line.starts_with(s)) => {
                header = line;
            }
            () if line.starts_with('}') => header = "",
            () => {}
        }
        let word =
            ["fn ", "holds ", "fails "].iter().find_map(|s| line.find(s).map(|i| i + s.len()));
        let Some(word) = word.filter(|_| !line.trim_start().starts_with("//")) else {
            continue;
        };
        let part = &text[start + word..];
        let end = part.find(|c| !is_name(c)).unwrap_or(0);
        let Some(open) = part.find('{').filter(|_| end > 0) else { continue };
        let rest = &part[open + 1..];
        let body = inside(rest, ['{', '}']).unwrap_or(rest);
        let (name, is_method) = (&part[..end], part[..open].contains("self"));
        let module = file.trim_end_matches(".rs").rsplit('/').next().unwrap_or_default();
        let owner = if header.is_empty() { module } else { own_type(header) };
        found.push(Function { name, file, header, is_method, owner, calls: calls(body) });
    }
    found
}

impl<'a> Functions<'a> {
    fn of(places: &'a Places) -> Self {
        // What runs the checks knows all of them.
        let runs = |file: &str| {
            let name = file.strip_prefix("props/src/").unwrap_or_default();
            let is_definition = ["bodies", "naive", "discrete", "elimination", "numbers/"];
            let of_claims = ["claims/", "sharpness", "problems"];
            let mut known = is_definition.iter().chain(&of_claims);
            // Reading and writing files calls all, and is called by none of the checks.
            let is_beside = file.starts_with("src/io/");
            is_beside || file.starts_with("props/") && !known.any(|start| name.starts_with(start))
        };
        let files = places.files.iter().filter(|(file, _)| !runs(file));
        let all = files.flat_map(|(file, text)| functions(file, text));
        let all: Vec<Function> =
            all.filter(|function| !["claim", "checks", "all"].contains(&function.name)).collect();
        let mut named: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (i, function) in all.iter().enumerate() {
            named.entry(function.name).or_default().push(i);
        }
        let files = places.files.iter();
        let imported = files.map(|(file, text)| (file.as_str(), imports(text))).collect();
        let mut functions = Functions { all, named, called: Vec::new(), imported };
        let called = functions.all.iter().map(|f| functions.meant_by(f.file, &f.calls));
        functions.called = called.collect();
        functions
    }

    /// Whether a file, or the one above it where it has all of that, imports this name.
    fn imports(&self, file: &str, name: &str) -> bool {
        let above = file.rsplit_once('/').map(|(folder, _)| format!("{folder}.rs"));
        let names = |file: &str| self.imported.get(file).is_some_and(|n| n.contains(name));
        names(file) || above.is_some_and(|above| names(&above) || self.has(&above, name))
    }

    fn has(&self, file: &str, name: &str) -> bool {
        let of = self.named.get(name).into_iter().flatten();
        of.copied().any(|i| self.all[i].file == file)
    }

    /// Which functions a name in a file means: those of the module or the type before the name; else those of this file, or the only one
    /// of props/src or of all.
    fn meant(&self, file: &str, (before, name): Call) -> Vec<usize> {
        let Some(all) = self.named.get(name) else { return Vec::new() };
        let of = |is_meant: &dyn Fn(&Function) -> bool| -> Vec<usize> {
            all.iter().copied().filter(|&i| is_meant(&self.all[i])).collect()
        };
        let is_in = |f: &Function| {
            let mut modules = f.file.trim_end_matches(".rs").split('/');
            modules.any(|module| module == before)
                || f.header.split(|c| !is_name(c)).any(|name| name == before)
        };
        let is_path = before.starts_with(char::is_alphabetic);
        let mut meant = if is_path { of(&is_in) } else { Vec::new() };
        // Another module than those with the functions.
        let beside = ["self", "super", "crate", "Self"];
        if is_path && before.starts_with(char::is_lowercase) && !beside.contains(&before) {
            return meant;
        }
        // A method, one of the crates below; or a function that the file has, or imports.
        let is_such = |f: &Function| {
            let is_below = |folder| file.starts_with(folder) && !f.file.starts_with(folder);
            let is_near = !["src/kernel/", "src/"].iter().any(is_below);
            match before {
                "." => f.is_method && is_near,
                _ if beside.contains(&before) => true,
                // Of a trait: that of the type is found above.
                _ if is_path => !f.header.is_empty() && self.imports(file, f.owner),
                _ => f.header.is_empty() && (f.file == file || self.imports(file, name)),
            }
        };
        if meant.is_empty() {
            meant = of(&|f| f.file == file && is_such(f));
        }
        if meant.is_empty() {
            let all: Vec<usize> = of(&is_such);
            let near = of(&|f| f.file.starts_with("props/src/") && is_such(f));
            let is_near = file.starts_with("props/src/") && !near.is_empty();
            // Those of a type, or of a module, that the file imports.
            let imported = self.imported.get(file);
            let known = |all: &[usize]| -> Vec<usize> {
                let is_known = |f: &Function| imported.is_some_and(|names| names.contains(f.owner));
                all.iter().copied().filter(|&i| is_known(&self.all[i])).collect()
            };
            let of_types = if before == "." { known(&all) } else { Vec::new() };
            let found = match if is_near { near } else { all } {
                _ if of_types.len() == 1 => of_types,
                found if found.len() > 1 => known(&found),
                found => found,
            };
            meant = if found.len() == 1 { found } else { Vec::new() };
        }
        meant
    }

    /// What is called by these calls in a file, by the functions that they mean, and so on: each name with the file of the function
    /// that it means, or without one where it means none or any of several.
    fn reached(&self, file: &str, calls: &[Call<'a>]) -> BTreeSet<Reached<'a>> {
        let mut found = BTreeSet::new();
        let mut seen = vec![false; self.all.len()];
        let mut left = self.meant_by(file, calls);
        while let Some((name, meant)) = left.pop() {
            found.insert((name, meant.map(|i| self.all[i].file)));
            if let Some(i) = meant.filter(|&i| !std::mem::replace(&mut seen[i], true)) {
                left.extend(&self.called[i]);
            }
        }
        found
    }

    /// The names of calls in a file, each with a function that it means or without one.
    fn meant_by(&self, file: &str, calls: &[Call<'a>]) -> Vec<(&'a str, Option<usize>)> {
        let of = |&(before, name): &Call<'a>| {
            let meant = self.meant(file, (before, name));
            let is_one = self.named.get(name).is_some_and(|all| all.len() == 1);
            let is_unsure = meant.is_empty() || before == "." && !is_one;
            let none = is_unsure.then_some((name, None));
            meant.into_iter().map(move |i| (name, Some(i))).chain(none)
        };
        calls.iter().flat_map(of).collect()
    }
}

/// The names that are called in a text, or given to a function by themselves, and constants; each with the name of the module or
/// of the type before it.
fn calls(text: &str) -> Vec<Call<'_>> {
    let mut found = Vec::new();
    let mut end = 0;
    while let Some(start) = text[end..].find(is_name).map(|start| end + start) {
        end = text[start..].find(|c| !is_name(c)).map_or(text.len(), |length| start + length);
        let (before, name, after) = (&text[..start], &text[start..end], &text[end..]);
        let path = before.strip_suffix("::");
        let path = path.map(|path| &path[path.rfind(|c| !is_name(c)).map_or(0, |at| at + 1)..]);
        let start = before.strip_suffix("::").map_or(before, |b| b.trim_end_matches(is_name));
        let is_argument =
            start.trim_end().ends_with(['(', ',']) && after.trim_start().starts_with([')', ',']);
        let is_constant =
            !name.contains(char::is_lowercase) && name.starts_with(char::is_alphabetic);
        let is_called = after.starts_with('(') || after.starts_with("::<");
        if is_called || is_argument || is_constant {
            let beside = if before.ends_with('.') { "." } else { "" };
            found.push((path.unwrap_or(beside), name));
        }
    }
    found
}

/// All that a check calls.
fn called_by<'a>(
    check: &'a Check,
    places: &'a Places,
    functions: &Functions<'a>,
) -> Option<BTreeSet<Reached<'a>>> {
    let place = match check.subject {
        Subject::Function(..) => places.registered(check),
        _ => places.of(check),
    };
    let file = place.ok()?.split('#').next()?.to_owned();
    let (file, text) = places.files.iter().find(|(name, _)| *name == file)?;
    let Subject::Function(..) = check.subject else {
        return Some(functions.reached(file, &[("", check.name)]));
    };
    let (_, text) = text.split_once(&format!("!(\"{}\",", check.name))?;
    let (_, run) = text.split_once("=>")?;
    Some(functions.reached(file, &calls(inside(run, ['(', ')'])?)))
}

#[test]
fn a_check_runs_the_function_that_its_link_leads_to() {
    let (places, functions) = sources();
    let checks: Vec<Check> = claims::all().into_iter().flat_map(|claim| claim.checks).collect();
    let (mut count, mut strangers) = (0, 0);
    for check in &checks {
        let Subject::Function(_, stated) = check.subject else { continue };
        let names = called_by(check, places, functions).expect("a line of a row");
        let name = parts(stated.by()).1;
        let calls = |asked: &str| names.iter().any(|(name, _)| *name == asked);
        assert!(calls(&name), "{} does not call {name}", check.name);
        strangers += usize::from(calls("monotone_on_bodies"));
        count += 1;
    }
    assert!(count > 50, "{count}");
    // What is asked can fail: two checks call this one.
    assert_eq!(strangers, 2);
    let text = "fn a() { b(); }\nfn b() { c(); }\nfn d() { e(); }\n";
    let places = Places { files: vec![("src/a.rs".to_owned(), text.to_owned())] };
    let names = Functions::of(&places).reached("src/a.rs", &[("", "a")]);
    let here = Some("src/a.rs");
    assert_eq!(names.into_iter().collect::<Vec<_>>(), [("a", here), ("b", here), ("c", None)]);
}

#[test]
fn a_statement_leads_to_the_function_that_compares_and_that_it_calls() {
    let (places, functions) = sources();
    let checks: Vec<Check> = claims::all().into_iter().flat_map(|claim| claim.checks).collect();
    let mut forwarded = 0;
    for check in checks.iter().filter(|check| is_a_statement(check) && !check.control) {
        let place = places.of(check).expect("a place");
        let (file, line) = place.split_once("#L").expect("a line");
        let (_, text) = places.files.iter().find(|(name, _)| name == file).expect("a file");
        let line = text.lines().nth(line.parse::<usize>().unwrap() - 1).expect("a line");
        let name = line.split_once("fn ").and_then(|(_, rest)| rest.split('<').next()).unwrap();
        let (_, body) = text.split_once(&format!("fn {name}<")).expect("a function");
        assert!(body.split("\n}").next().unwrap().contains("ensure!"), "{}: {place}", check.name);
        let called = called_by(check, places, functions).expect("a check stands in a file");
        assert!(called.iter().any(|(called, _)| *called == name), "{}: {place}", check.name);
        forwarded += usize::from(check.name != name);
    }
    assert!(forwarded >= 10, "{forwarded}");
    // What is asked can fail: a function that compares nothing and calls none that does.
    let text =
        "fn a<S>(x: S) {\n    b(x)\n}\nfn b<S>(x: S) {\n    ensure!(x);\n}\nfn c<S>(x: S) {\n}\n";
    assert_eq!([comparing(text, "a"), comparing(text, "c")], [Some("b"), None]);
}

/// The name of the constant or the function of a place; of another line, of the one around it.
fn name_at<'p>(&(file, start): &Place, places: &'p Places) -> Option<&'p str> {
    let (_, text) = places.files.iter().find(|(name, _)| name == file).expect("a file");
    let line = places.line((file, start)).expect("a line");
    let lines: Vec<&str> = text.lines().take(line).collect();
    let start = if start.starts_with("const ") { "const " } else { "fn " };
    let header = lines.iter().rev().find_map(|line| line.split_once(start));
    header.and_then(|(_, rest)| rest.split(|c| !is_name(c)).next())
}

/// The lines of code that no check of an item calls.
fn not_called<'i>(
    item: &'i Item,
    code: &'i [Place],
    claims: &'i [Claim],
    (places, functions): (&'i Places, &Functions<'i>),
) -> Vec<&'i str> {
    let mut called = BTreeSet::new();
    for (_, check) in item.found(claims) {
        called.extend(called_by(check, places, functions).expect("a check stands in a file"));
    }
    let is_called = |&place: &&Place| {
        let name = name_at(place, places);
        name.is_some_and(|name| {
            [None, Some(place.0)].iter().any(|&of| called.contains(&(name, of)))
        })
    };
    code.iter().filter(|place| !is_called(place)).map(|(_, start)| *start).collect()
}

#[test]
fn the_code_of_an_item_is_called_by_its_checks() {
    let (claims, (places, functions)) = (claims::all(), sources());
    let mut uncalled = 0;
    for item in ITEMS {
        let not_called = |code| not_called(item, code, &claims, (places, functions));
        assert_eq!(not_called(item.code), Vec::<&str>::new(), "{}", item.name);
        assert_eq!(not_called(item.uncalled).len(), item.uncalled.len(), "{}", item.name);
        uncalled += item.uncalled.len();
    }
    assert!(uncalled >= 8, "{uncalled}");
    // Of the bodies, and of the kernel's lines that are compared, it has all that its checks call, and no other.
    let keys: Vec<&Place> = ON.iter().chain(crate::items::KERNEL).collect();
    let of_8 = ITEMS.iter().find(|item| item.name == "(8)").expect("an item");
    let (mut wrong, mut strange) = (Vec::new(), 0);
    for item in ITEMS {
        let mut called = BTreeSet::new();
        for (_, check) in item.found(&claims) {
            called.extend(called_by(check, places, functions).expect("a check"));
        }
        for key in &keys {
            let name = name_at(key, places).expect("a name");
            let is_called = called.contains(&(name, Some(key.0)));
            if is_called != item.code.contains(key) {
                wrong.push(format!("{}: {key:?}, called: {is_called}", item.name));
            }
            strange += usize::from(is_called && !of_8.code.contains(key));
        }
    }
    // What is asked can fail: with the lines of (8) others would lack some.
    assert!(strange > 50, "{strange}");
    assert_eq!(wrong.len(), 0, "{}", wrong.join("\n"));
    // What is asked can fail for lines that checks of other items call.
    let of_k = ITEMS.iter().find(|item| item.name == "K").expect("an item");
    for place in [
        ("props/src/bodies/definition.rs", "pub fn big_a("),
        ("src/kernel/contact.rs", "pub fn pressure(&self)"),
        ("props/src/claims/assembled/draw.rs", "pub(crate) fn problems("),
    ] {
        assert_eq!(not_called(of_k, &[place], &claims, (places, functions)), [place.1]);
    }
}

#[test]
fn a_name_that_does_not_stand_in_the_sources_once_has_no_link() {
    let places = Places::read().expect("the sources");
    assert!(places.of_claims(&["fn no_such_predicate<".to_owned()]).is_err());
    assert!(places.line(("src/kernel/contact.rs", "pub fn no_such_function")).is_err());
    assert!(places.line(("src/kernel/no_such_file.rs", "")).is_err());
}

/// What a predicate must not look at: then it could answer each engine as that likes.
const BESIDE_THE_NUMBERS: [&str; 14] = [
    "type_name",
    "TypeId",
    "Any",
    "is::<",
    "downcast",
    "size_of",
    "format!",
    "{:?}",
    "static ",
    "Cell",
    "Atomic",
    "env::",
    "thread",
    "catch_unwind",
];

/// The functions of a source that are generic over the number type and look at something else, with what they look at.
fn curious(source: &str) -> Vec<String> {
    let mut found = Vec::new();
    for part in source.split("fn ").skip(1) {
        let Some((header, rest)) = part.split_once('{') else { continue };
        if !header.contains(": Ordered") {
            continue;
        }
        let body = inside(rest, ['{', '}']).unwrap_or(rest);
        let looks = BESIDE_THE_NUMBERS.iter().filter(|word| body.contains(**word));
        let name = header.split(['<', '(']).next().unwrap_or(header);
        found.extend(looks.map(|word| format!("{name}: {word}")));
    }
    found
}

#[test]
fn predicates_look_at_their_numbers_only() {
    let cheat = "fn zero<S: Ordered>([a]: [S; 1]) -> Verdict { if type_name::<S>() == \"f64\" {} }";
    assert_eq!(curious(cheat), ["zero: type_name"]);
    let cheat = "fn one<S: Ordered>([a]: [S; 1]) -> Verdict { if (&a as &dyn Any).is::<Sym>() {} }";
    assert_eq!(curious(cheat), ["one: Any", "one: is::<"]);
    let cheat =
        "fn two<S: Ordered>([a]: [S; 1]) -> Verdict { if std::env::args().count() == 0 {} }";
    assert_eq!(curious(cheat), ["two: env::"]);
    assert!(curious("fn name<S: Ordered>() {} fn other() { type_name::<f64>() }").is_empty());
    let places = Places::read().expect("the sources");
    let claims = places.files.iter().filter(|(file, _)| file.starts_with(CLAIMS));
    let found = claims.clone().flat_map(|(_, text)| curious(text)).collect::<Vec<_>>();
    assert_eq!(found, Vec::<String>::new());
    assert!(claims.count() > 20);
}

#[test]
fn every_row_has_two_engines_or_a_reason_and_a_control() {
    for claim in &claims::all() {
        // A harness is not counted: a receipt may stop standing behind it at any time.
        let mut kinds: Vec<Engine> = evidence(claim).map(|check| check.engine).collect();
        kinds.retain(|&engine| engine != Engine::Harness);
        kinds.sort_unstable();
        kinds.dedup();
        let is_excused = claim.limits.contains("One engine: ");
        assert!((kinds.len() > 1) != is_excused, "row {}: {kinds:?}", claim.id);
        assert!(claim.checks.iter().any(|check| check.control), "row {}", claim.id);
    }
}

#[test]
fn every_harness_has_a_false_twin_and_there_are_at_least_25() {
    let harnesses = claims::harnesses();
    let twins = harnesses.iter().filter(|harness| harness.counterexample.is_some()).count();
    assert!(twins >= 25, "{twins}");
    assert_eq!(2 * twins, harnesses.len());
}

#[test]
fn an_item_has_checks_or_says_what_is_missing_and_a_check_names_items_that_exist() {
    let claims = claims::all();
    assert!(ITEMS.len() >= 40);
    for item in ITEMS {
        assert!(!item.says.is_empty(), "{item:?}");
        assert!(!item.missing.is_empty() || !item.found(&claims).is_empty(), "{}", item.name);
    }
    for check in claims.iter().flat_map(|claim| &claim.checks) {
        let known = |name: &&str| ITEMS.iter().any(|item| item.name == *name);
        assert!(check.items.iter().all(known), "{}: {:?}", check.name, check.items);
    }
}
