//! The source of a case: the text of its file, and keys set over it, as by the option `--set`: `method.gamma0=1e-3`,
//! `material.young=2`, `boundary.bottom.contact.gap="0.1*x"`.
//!
//! A setting is a line of TOML, so its value has the type that it has in the file; only a bare word, a path or an
//! expression needs no quotes (`method.gamma0=auto`, `boundary.bottom.contact.gap=0.1*x`). A table is merged into the table of
//! the file, any other value replaces that of the file, or its alternative, and a later setting wins over an earlier one. The reader of the case
//! sees no difference between setting and file, except for the place of a mistake.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeArray, DeString, DeTable, DeValue};

use crate::io::expression::Expression;
use crate::io::input::{Failure, FileError, Position};
use crate::model::SharedFunction;
use crate::quote::{cut, quoted};

/// A file, its text, and the settings over it. Places in the settings come after those in the text.
#[derive(Clone, Copy)]
pub struct Source<'s> {
    pub file: &'s Path,
    pub text: &'s str,
    pub settings: &'s [String],
    /// The functions that the text calls `@0`, `@1`, ..
    pub functions: &'s [SharedFunction],
}

impl<'s> Source<'s> {
    /// `error` at the byte `start`, or in the file as a whole.
    pub fn wrong(&self, start: Option<usize>, error: Failure) -> FileError {
        let setting = start.and_then(|start| self.setting_at(start));
        let position = match (setting, start) {
            (Some(setting), _) => Position::Setting(setting.to_owned()),
            (None, Some(start)) => Position::line_of(start, self.text.as_bytes()),
            (None, None) => Position::File,
        };
        error.at(self.file, position)
    }

    /// The setting in which the byte `start` lies, if it lies behind the file.
    pub(crate) fn setting_at(&self, start: usize) -> Option<&'s str> {
        let mut end = self.text.len();
        self.settings.iter().map(String::as_str).find(|setting| {
            let begin = end;
            end += 1 + setting.len();
            // A word in quotes that it was given without reaches two bytes further; no key or value begins there.
            begin < start && start <= end
        })
    }

    /// The entries of the text, with those of the settings laid over them. `layers` are the settings as [`Source::layers`] has
    /// them.
    pub fn entries(self, layers: &'s [String]) -> Result<DeTable<'s>, FileError> {
        let parsed = DeTable::parse(self.text).map_err(|e| {
            let start = e.span().map(|span| span.start).or_else(|| deepest(&e, self.text));
            self.wrong(start, no_toml(&e, self.text))
        })?;
        let mut entries = parsed.into_inner();
        for (setting, layer) in self.settings.iter().zip(layers) {
            let start = Some(layer.len() - layer.trim_start().len());
            let parsed = DeTable::parse(layer);
            let table = match parsed.map(Spanned::into_inner) {
                Err(e) if setting.contains('=') => {
                    return Err(self.wrong(start, no_toml(&e, layer)));
                }
                Ok(table) if setting.contains('=') && !table.is_empty() => table,
                _ => {
                    let said =
                        "found no key with a value; expected KEY=VALUE, such as method.gamma0=1e-3";
                    return Err(self.wrong(start, said.to_owned().into()));
                }
            };
            merge(&mut entries, table, "").map_err(|list| self.wrong(start, list.into()))?;
        }
        Ok(entries)
    }

    /// The entries of a load step, from 0: each \[\[step\]\] up to this step is laid over the rest of the file, one after the other.
    pub fn entries_of_step(
        self,
        layers: &'s [String],
        step: usize,
    ) -> Result<DeTable<'s>, FileError> {
        let mut entries = self.entries(layers)?;
        let steps = entries.remove("step").map(|steps| steps.into_inner());
        let Some(DeValue::Array(steps)) = steps else { return Ok(entries) };
        for table in steps.into_iter().take(step + 1) {
            let start = Some(table.span().start);
            if let DeValue::Table(table) = table.into_inner() {
                merge(&mut entries, table, "").map_err(|list| self.wrong(start, list.into()))?;
            }
        }
        Ok(entries)
    }

    /// The text, with a comment for each setting.
    pub fn said(self) -> String {
        let comment = |setting: &String| format!("# --set {}\n", setting.replace('\n', " "));
        self.text.to_owned() + &self.settings.iter().map(comment).collect::<String>()
    }

    /// The settings as TOML, each behind so much space that a place in it is a place in no other, nor in the file.
    pub fn layers(&self) -> Vec<String> {
        let mut start = self.text.len();
        let mut layers = Vec::with_capacity(self.settings.len());
        for setting in self.settings {
            start += 1;
            layers.push(" ".repeat(start) + &with_quotes(setting));
            start += setting.len();
        }
        layers
    }
}

/// Finds the first key with more parts than the TOML reader takes, for its message does not give the place.
fn deepest(error: &toml::de::Error, text: &str) -> Option<usize> {
    const MOST_PARTS: usize = 80;
    let is_deep = |line: &&str| line.matches('.').nth(MOST_PARTS - 1).is_some();
    let line = text.split('\n').find(is_deep).filter(|_| error.message() == "recursion limit")?;
    Some(line.as_ptr() as usize - text.as_ptr() as usize)
}

/// Tables, by the last part of their names, with two keys of which one at most may be there.
const ALTERNATIVES: [(&str, [&str; 2]); 2] =
    [("friction", ["tresca", "coulomb"]), ("method", ["gamma0", "kappa"])];

/// Merges one table into another, that of the key `path` (the whole file if empty). A key takes the place of its alternative.
fn merge<'s>(below: &mut DeTable<'s>, above: DeTable<'s>, path: &str) -> Result<(), String> {
    let table = path.rsplit('.').next();
    for (key, mut value) in above {
        let name = &**key.get_ref();
        let is_here =
            |group: &&(&str, [&str; 2])| table == Some(group.0) && group.1.contains(&name);
        for other in ALTERNATIVES.iter().find(is_here).map_or(&[][..], |(_, keys)| keys) {
            if *other != name {
                below.remove(*other);
            }
        }
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match (below.get_mut(name).map(|old| old.get_mut()), value.get_mut()) {
            (Some(DeValue::Table(old)), DeValue::Table(new)) => {
                merge(old, std::mem::take(new), &path)?;
            }
            (Some(DeValue::Array(old)), DeValue::Table(new)) if has_tables(old, new) => {
                let most = old.len() - 1;
                for (number, mut entry) in std::mem::take(new) {
                    let (number, list) = (number.get_ref(), cut(&path));
                    let index: Option<usize> = number.parse().ok();
                    let old = index.and_then(|index| old.get_mut(index)).map(Spanned::get_mut);
                    let (Some(DeValue::Table(old)), DeValue::Table(new)) = (old, entry.get_mut())
                    else {
                        return Err(format!(
                            "found {list}.{}; expected a key of one of the tables {list}.0 to {list}.{most}",
                            cut(number)
                        ));
                    };
                    merge(old, std::mem::take(new), &format!("{path}.{number}"))?;
                }
            }
            (Some(DeValue::Array(_)), DeValue::Table(new)) if new.keys().all(is_number) => {
                let (list, path) = (quoted(&path, '\''), cut(&path));
                return Err(format!(
                    "{list} is a list, whose entries have no keys; expected all of it: {path}=[...]"
                ));
            }
            _ => {
                // Insert with the key, so that messages have the place of the setting.
                below.remove(name);
                below.insert(key, value);
            }
        }
    }
    Ok(())
}

/// The list is one of tables, which the keys of the other table number.
fn has_tables(list: &DeArray, numbered: &DeTable) -> bool {
    let is_table = |entry: &Spanned<DeValue>| matches!(entry.get_ref(), DeValue::Table(_));
    !list.is_empty() && list.iter().all(is_table) && numbered.keys().all(is_number)
}

fn is_number(key: &Spanned<DeString>) -> bool {
    key.get_ref().bytes().all(|b| b.is_ascii_digit())
}

/// The setting, its value in quotes if that is a bare word, a path, or an expression that is no value of TOML.
fn with_quotes(setting: &str) -> String {
    let is_expression = |value: &str| {
        let has_place = value.len() < 1000 && value.contains(['x', 'y']);
        has_place && DeTable::parse(setting).is_err() && value.parse::<Expression>().is_ok()
    };
    match setting.split_once('=') {
        Some((key, value)) if is_word(value) || is_expression(value) => {
            format!("{key}=\"{value}\"")
        }
        _ => setting.to_owned(),
    }
}

/// Returns whether this is a word or a path that has no other meaning in TOML.
fn is_word(text: &str) -> bool {
    let is_path = ["/", "./", "../"].iter().any(|start| text.starts_with(start));
    (is_path || text.starts_with(|c: char| c.is_ascii_alphabetic()))
        && text.chars().all(|c| c.is_ascii_alphanumeric() || "_-./".contains(c))
        && !["true", "false", "inf", "nan"].contains(&text)
}

/// The remedies for errors whose message from the TOML reader begins so.
const REMEDIES: [(&str, &str); 11] = [
    (
        "missing comma between array elements",
        "expected ',' or ']'; is a list or a text above not closed?",
    ),
    ("key with no value", "expected KEY = VALUE"),
    (
        "missing escaped value",
        "a backslash in \"...\" begins an escape; expected '/' in a path, or the text in '...'",
    ),
    ("invalid mantissa", "expected a digit before the decimal point (0.5, not .5)"),
    // The TOML reader has this message for a missing value, too.
    (NO_QUOTES, "expected a value; a text must be in quotes"),
    ("invalid boolean", "expected a value; a text must be in quotes"),
    ("invalid time", NO_RANGE),
    ("invalid date", NO_RANGE),
    ("invalid float", NO_VALUE),
    ("unexpected key or value", NO_VALUE),
    ("unexpected leading zero", NO_VALUE),
];

const NO_QUOTES: &str = "string values must be quoted";

const NO_RANGE: &str = "expected a value; a range from:to:count is one of 'signorini sweep', with a count of at least 2";

const NO_VALUE: &str = "expected a value; an expression must be in quotes (\"0.1 - x\"), a list in brackets, and decimals have a point (0.5, not 0,5)";

/// The TOML reader's message, and the words of the file that it is about.
fn no_toml(error: &toml::de::Error, text: &str) -> Failure {
    let found = error.span().and_then(|span| text.get(span)).map_or("", str::trim);
    let message = error.message();
    let is_unquoted = message.starts_with(NO_QUOTES);
    let said = if text.starts_with("$MeshFormat") {
        "this is a Gmsh mesh; expected a case file, which names it: [mesh] gmsh = \"FILE.msh\""
    } else if text.trim_start().starts_with(['{', '<']) {
        "this is a JSON or an XML file; expected a case file in TOML"
    } else if found.contains(['\u{201c}', '\u{201d}', '\u{2018}', '\u{2019}']) {
        "expected straight quotes (\") around a text"
    } else if is_unquoted && found.contains("//") {
        "expected a value; a comment begins with #"
    } else if is_unquoted && found.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
        "expected a number, without a unit ([units] names the units)"
    } else {
        let remedy = REMEDIES.iter().find(|(start, _)| message.starts_with(start));
        remedy.map_or(message, |(_, remedy)| remedy)
    };
    let at =
        if found.is_empty() { found.to_owned() } else { format!(" at {}", quoted(found, '\'')) };
    format!("invalid TOML{at}: {}", said.replace('\n', ", ")).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_paths_of_files_need_no_quotes() {
        for word in ["auto", "part.msh", "meshes/part-2.msh", "./part.msh", "../part.msh", "/a/b"] {
            assert_eq!(with_quotes(&format!("key={word}")), format!("key=\"{word}\""));
        }
        for expression in ["0.1-x", "x*y", "2 - sin(x)"] {
            let quoted = format!("key=\"{expression}\"");
            assert_eq!(with_quotes(&format!("key={expression}")), quoted);
        }
        for other in ["1e-3", ".5", "true", "nan", "[0, 1]", "\"a\"", "a b", "1000,5", ""] {
            assert_eq!(with_quotes(&format!("key={other}")), format!("key={other}"));
        }
    }

    #[test]
    fn a_key_takes_the_place_of_its_alternative_and_of_no_other() {
        let text = "boundary.a.contact.friction = { coulomb = 0.3 }\n\
                    method = { kappa = 0.5, degree = 2 }\nboundary.coulomb.normal = 0";
        let settings = [
            "boundary.a.contact.friction={tresca=\"1\"}",
            "method.gamma0=0.1",
            "boundary.tresca.normal=0",
        ];
        let settings = settings.map(str::to_owned);
        let source = Source { file: Path::new(""), text, settings: &settings, functions: &[] };
        let layers = source.layers();
        let entries = source.entries(&layers).unwrap();
        fn below<'s>(table: &DeTable<'s>, key: &str) -> DeTable<'s> {
            match table.get(key).map(Spanned::get_ref) {
                Some(DeValue::Table(table)) => table.clone(),
                _ => DeTable::new(),
            }
        }
        let keys = |path: &str| {
            let table = path.split('.').fold(entries.clone(), |table, key| below(&table, key));
            let mut keys: Vec<String> = table.keys().map(|key| key.get_ref().to_string()).collect();
            keys.sort();
            keys
        };
        assert_eq!(keys("boundary.a.contact.friction"), ["tresca"]);
        assert_eq!(keys("method"), ["degree", "gamma0"]);
        assert_eq!(keys("boundary"), ["a", "coulomb", "tresca"]);
    }
}
