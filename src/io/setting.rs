//! Keys set over a case file, as by the option `--set`: `method.gamma0=1e-3`, `material.young=2`,
//! `boundary.bottom.contact.gap="0.1*x"`.
//!
//! A setting is a line of TOML, so its value has the type that it has in the file; only a bare word, a path or an
//! expression needs no quotes (`method.gamma0=auto`, `boundary.bottom.contact.gap=0.1*x`). A table is laid over the one that is there, anything else takes its place, and a later setting
//! wins over an earlier one. The reader of the case then cannot tell a setting from the file, but where a mistake is.

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::expression::Expression;
use super::mistake::{CaseError, CaseMistake, no_toml};
use super::source::Source;

/// The settings as TOML, each behind so much space that a place in it is a place in no other, nor in the file.
pub fn layers(source: &Source) -> Vec<String> {
    let mut start = source.text.len();
    let mut layers = Vec::with_capacity(source.settings.len());
    for setting in source.settings {
        start += 1;
        layers.push(" ".repeat(start) + &with_quotes(setting));
        start += setting.len();
    }
    layers
}

/// Lays the settings over the file's entries.
///
/// # Errors
/// A setting that is not of the form KEY=VALUE in TOML, or of an entry of a list.
pub fn lay<'s>(
    source: Source<'s>,
    layers: &'s [String],
    entries: &mut DeTable<'s>,
) -> Result<(), CaseError> {
    for (setting, layer) in source.settings.iter().zip(layers) {
        let start = Some(layer.len() - layer.trim_start().len());
        let no_setting = || source.wrong(start, CaseMistake::NoSetting);
        if !setting.contains('=') {
            return Err(no_setting());
        }
        let table = DeTable::parse(layer)
            .map_err(|e| source.wrong(start, no_toml(&e, layer)))?
            .into_inner();
        if table.is_empty() {
            return Err(no_setting());
        }
        merge(entries, table, "").map_err(|list| source.wrong(start, list))?;
    }
    Ok(())
}

/// Lays one table over another, which is that of the key `path`, if that is not empty.
fn merge<'s>(below: &mut DeTable<'s>, above: DeTable<'s>, path: &str) -> Result<(), CaseMistake> {
    for (key, mut value) in above {
        let name = &**key.get_ref();
        let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match (below.get_mut(name).map(|old| old.get_mut()), value.get_mut()) {
            (Some(DeValue::Table(old)), DeValue::Table(new)) => {
                merge(old, std::mem::take(new), &path)?;
            }
            (Some(DeValue::Array(_)), DeValue::Table(new)) if new.keys().all(is_number) => {
                return Err(CaseMistake::InList { list: path });
            }
            _ => {
                // With the key, so that the place is the new one.
                below.remove(name);
                below.insert(key, value);
            }
        }
    }
    Ok(())
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

/// Returns whether this is a word, or the path of a file, that TOML has no other meaning for.
fn is_word(text: &str) -> bool {
    let is_path = ["/", "./", "../"].iter().any(|start| text.starts_with(start));
    (is_path || text.starts_with(|c: char| c.is_ascii_alphabetic()))
        && text.chars().all(|c| c.is_ascii_alphanumeric() || "_-./".contains(c))
        && !["true", "false", "inf", "nan"].contains(&text)
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
}
