//! TOML with places: tables and values know their names and places, so that mistakes can be reported in one line. The names in
//! messages look like the file: `[mesh] rectangle.nx`, `[load] body[1]`.
//!
//! Why not serde: its derived readers drop the third entry of a list meant for two, turn an alternative such as
//! "a number or "auto"" into "did not match any variant", and forget the line.

use std::ops::RangeInclusive;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use super::beyond;
use super::source::Source;
use crate::io::expression::Expression;
use crate::io::input::{Failure, FileError};
use crate::model::SharedFunction;
use crate::quote::{cut, key as shown, listed, number, quoted};

/// The subject of a message: its name and its place. The file as a whole has neither.
pub(crate) struct Spot<'s> {
    source: Source<'s>,
    pub(crate) name: String,
    start: Option<usize>,
}

impl Spot<'_> {
    /// A mistake here.
    pub(crate) fn wrong(&self, error: impl Into<Failure>) -> FileError {
        self.source.wrong(self.start, error.into())
    }

    /// An error that names its subject.
    pub(crate) fn about(&self, error: impl Into<Failure>) -> FileError {
        self.wrong(error.into().map(|problem| format!("{}: {problem}", self.name)))
    }

    /// The complaint that something else should be here.
    pub(crate) fn found(&self, found: &str, expected: &str) -> FileError {
        self.about(format!("found {found}; expected {expected}"))
    }
}

pub(crate) struct Table<'s> {
    pub(crate) at: Spot<'s>,
    entries: &'s DeTable<'s>,
}

pub(crate) struct Value<'s> {
    pub(crate) at: Spot<'s>,
    value: &'s DeValue<'s>,
}

impl<'s> Table<'s> {
    pub(crate) fn whole(source: Source<'s>, entries: &'s DeTable<'s>) -> Self {
        let at = Spot { source, name: String::new(), start: None };
        Table { at, entries }
    }

    /// The name of an entry in messages: behind a header a space, behind a key a point.
    fn name_of(&self, key: &str) -> String {
        match &*self.at.name {
            "" => key.to_owned(),
            header if header.ends_with(']') => format!("{header} {key}"),
            table => format!("{table}.{key}"),
        }
    }

    pub(crate) fn keys(&self) -> impl Iterator<Item = &'s str> {
        self.entries.keys().map(|key| &**key.get_ref())
    }

    pub(crate) fn keys_of_tables(&self) -> Vec<&'s str> {
        let is_table = |key: &&str| self.get(key).is_some_and(|value| value.is_table());
        self.keys().filter(is_table).collect()
    }

    pub(crate) fn get(&self, key: &str) -> Option<Value<'s>> {
        let (key, value) = self.entries.get_key_value(key)?;
        let name = self.name_of(&shown(key.get_ref()));
        let at = Spot { source: self.at.source, name, start: Some(key.span().start) };
        Some(Value { at, value: value.get_ref() })
    }

    /// Reads the value of `key`, if it is there.
    pub(crate) fn optional<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Value<'s>) -> Result<T, FileError>,
    ) -> Result<Option<T>, FileError> {
        self.get(key).map(|value| read(&value)).transpose()
    }

    /// Reads the value of `key` into `setting`, if it is there.
    pub(crate) fn set<T>(
        &self,
        key: &str,
        setting: &mut T,
        read: impl FnOnce(&Value<'s>) -> Result<T, FileError>,
    ) -> Result<(), FileError> {
        if let Some(value) = self.optional(key, read)? {
            *setting = value;
        }
        Ok(())
    }

    /// Lists those of `keys` that are there.
    pub(crate) fn given<'k>(&self, keys: &[&'k str]) -> Vec<&'k str> {
        keys.iter().copied().filter(|key| self.entries.contains_key(*key)).collect()
    }

    /// A number that must be there and have a property, which `expected` puts in words.
    pub(crate) fn number_that(
        &self,
        key: &str,
        holds: impl FnOnce(f64) -> bool,
        expected: &str,
    ) -> Result<f64, FileError> {
        self.require(key, expected)?.number_that(holds, expected)
    }

    /// The value of `key`, which must be there.
    pub(crate) fn require(&self, key: &str, expected: &str) -> Result<Value<'s>, FileError> {
        let missing = || format!("{} is missing; expected {expected}", self.name_of(key));
        self.get(key).ok_or_else(|| self.at.wrong(missing()))
    }

    /// The table `key` of the file under its header, if there is one.
    pub(crate) fn section(&self, key: &str) -> Result<Option<Table<'s>>, FileError> {
        self.optional(key, |value| value.section(format!("[{key}]")))
    }

    /// Reads the table `key` of the file, if it is there.
    pub(crate) fn optional_section<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Table<'s>) -> Result<T, FileError>,
    ) -> Result<Option<T>, FileError> {
        self.section(key)?.map(|table| read(&table)).transpose()
    }

    /// The table `key` of the file, which must be there.
    pub(crate) fn required_section(
        &self,
        key: &str,
        expected: &str,
    ) -> Result<Table<'s>, FileError> {
        let missing = || format!("[{key}] is missing; expected {expected}");
        self.section(key)?.ok_or_else(|| self.at.wrong(missing()))
    }

    /// The entry `key` of this section, under a header of its own.
    pub(crate) fn under_header(&self, key: &str) -> Spot<'s> {
        let name = format!("{}.{}]", self.at.name.trim_end_matches(']'), shown(key));
        let start = self.entries.get_key_value(key).map(|(key, _)| key.span().start);
        Spot { source: self.at.source, name, start }
    }

    /// The table `key` of this section, under a header of its own.
    pub(crate) fn subsection(&self, key: &str) -> Result<Table<'s>, FileError> {
        self.require(key, "a table")?.section(self.under_header(key).name)
    }

    /// Refuses keys that are not `known`.
    pub(crate) fn only(&self, known: &[&str]) -> Result<(), FileError> {
        let unknown = self.entries.keys().find(|key| !known.contains(&&**key.get_ref()));
        let Some(key) = unknown else { return Ok(()) };
        let within = match &*self.at.name {
            "" => String::new(),
            name => format!(" in {name}"),
        };
        let (shown, known) = (quoted(key.get_ref(), '\''), listed(known, "or"));
        let beyond = beyond::not_here(key.get_ref());
        let beyond = beyond.map_or(String::new(), |what| format!(": {what}"));
        let said = format!("unknown key {shown}{within}{beyond}; expected {known}");
        Err(self.at.source.wrong(Some(key.span().start), said.into()))
    }

    /// The complaint about which of `keys` are there.
    pub(crate) fn combination(&self, keys: &[&str], expected: &str) -> FileError {
        let found = self.given(keys);
        // If a setting over the file supplied one of the keys, report that setting.
        let mut starts = found.iter().filter_map(|key| self.get(key)?.at.start);
        let set = starts.rfind(|&start| self.at.source.setting_at(start).is_some());
        let name = self.at.name.clone();
        let at = Spot { source: self.at.source, name, start: set.or(self.at.start) };
        at.found(
            &if found.is_empty() { "none".to_owned() } else { listed(&found, "and") },
            expected,
        )
    }
}

impl<'s> Value<'s> {
    /// The value as a table under the header `name`.
    pub(crate) fn section(&self, name: String) -> Result<Table<'s>, FileError> {
        match self.value {
            DeValue::Table(entries) => {
                let at = Spot { source: self.at.source, name, start: self.at.start };
                Ok(Table { at, entries })
            }
            _ => Err(self.wrong("a table")),
        }
    }

    /// The value as a table under its key.
    pub(crate) fn table(&self) -> Result<Table<'s>, FileError> {
        self.section(self.at.name.clone())
    }

    /// The value as a table under its key, where `expected` shows one.
    pub(crate) fn table_such_as(&self, expected: &str) -> Result<Table<'s>, FileError> {
        if self.is_table() { self.table() } else { Err(self.wrong(expected)) }
    }

    pub(crate) fn is_table(&self) -> bool {
        matches!(self.value, DeValue::Table(_))
    }

    pub(crate) fn text(&self) -> Result<&'s str, FileError> {
        self.as_text().ok_or_else(|| self.wrong("a text in quotes"))
    }

    pub(crate) fn as_text(&self) -> Option<&'s str> {
        match self.value {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    pub(crate) fn flag(&self) -> Result<bool, FileError> {
        match self.value {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => Err(self.wrong("true or false")),
        }
    }

    /// A finite number; integers are numbers.
    pub(crate) fn number(&self) -> Result<f64, FileError> {
        let number = match self.value {
            DeValue::Integer(n) => integer(n).map(|n| n as f64),
            DeValue::Float(f) => f.as_str().parse().ok(),
            DeValue::String(text) if has_unit(text) => {
                return Err(self.wrong("a number, without quotes and without a unit"));
            }
            _ => return Err(self.wrong("a number")),
        };
        number.filter(|n: &f64| n.is_finite()).ok_or_else(|| self.wrong("a finite number"))
    }

    /// A number with a property, which `expected` puts in words.
    pub(crate) fn number_that(
        &self,
        holds: impl FnOnce(f64) -> bool,
        expected: &str,
    ) -> Result<f64, FileError> {
        let number = self.number()?;
        if holds(number) { Ok(number) } else { Err(self.wrong(expected)) }
    }

    pub(crate) fn positive(&self) -> Result<f64, FileError> {
        self.number_that(|x| x > 0.0, "a positive number")
    }

    pub(crate) fn whole_number(&self, range: RangeInclusive<usize>) -> Result<usize, FileError> {
        let number = match self.value {
            DeValue::Integer(n) => integer(n).and_then(|n| usize::try_from(n).ok()),
            _ => None,
        };
        number.filter(|n| range.contains(n)).ok_or_else(|| {
            self.wrong(&format!("a whole number from {} to {}", range.start(), range.end()))
        })
    }

    /// The value that one of these words stands for.
    pub(crate) fn one_of<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, FileError> {
        let found = self.as_text().and_then(|text| words.iter().find(|word| word.0 == text));
        found.map(|word| word.1).ok_or_else(|| {
            let words: Vec<String> = words.iter().map(|word| quoted(word.0, '"')).collect();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let beyond = self.as_text().and_then(beyond::not_here);
            let beyond = beyond.map_or(String::new(), |what| format!(" ({what})"));
            self.wrong(&(listed(&words, "or") + &beyond))
        })
    }

    pub(crate) fn items(&self) -> Result<Vec<Value<'s>>, FileError> {
        let DeValue::Array(items) = self.value else { return Err(self.wrong("a list")) };
        let item = |(i, item): (usize, &'s Spanned<DeValue<'s>>)| {
            let name = format!("{}[{i}]", self.at.name);
            let at = Spot { source: self.at.source, name, start: Some(item.span().start) };
            Value { at, value: item.get_ref() }
        };
        Ok(items.iter().enumerate().map(item).collect())
    }

    pub(crate) fn pair(&self) -> Result<[Value<'s>; 2], FileError> {
        let pair = self.items().ok().and_then(|items| items.try_into().ok());
        pair.ok_or_else(|| self.wrong("a list of two: one for x, one for y"))
    }

    /// Two numbers: a point or a vector.
    pub(crate) fn vector(&self) -> Result<[f64; 2], FileError> {
        let [x, y] = self.pair()?;
        Ok([x.number()?, y.number()?])
    }

    pub(crate) fn functions(&self) -> Result<[SharedFunction; 2], FileError> {
        let [x, y] = self.pair()?;
        Ok([x.function()?, y.function()?])
    }

    pub(crate) fn function(&self) -> Result<SharedFunction, FileError> {
        let number = self.as_text().and_then(|text| text.strip_prefix('@')?.parse::<usize>().ok());
        match number.and_then(|number| self.at.source.functions.get(number)) {
            Some(function) => Ok(Arc::clone(function)),
            None => Ok(Arc::new(self.expression()?)),
        }
    }

    /// An expression in x and y. One that is the same everywhere must be finite.
    pub(crate) fn expression(&self) -> Result<Expression, FileError> {
        if let DeValue::Integer(_) | DeValue::Float(_) = self.value {
            return self.number().map(Expression::from);
        }
        let Some(text) = self.as_text() else {
            return Err(self.wrong("a number, or an expression in quotes, such as \"2*x\""));
        };
        let (name, shown) = (&self.at.name, quoted(text, '"'));
        let expression: Expression =
            text.parse().map_err(|error| self.at.wrong(format!("{name} = {shown}: {error}")))?;
        match expression.constant() {
            Some(value) if !value.is_finite() => {
                let found = format!("{shown}, which is {}", number(value));
                Err(self.wrong_as(&found, "a finite value"))
            }
            _ => Ok(expression),
        }
    }

    /// The complaint that this should have been as `expected`.
    pub(crate) fn wrong(&self, expected: &str) -> FileError {
        let found = match self.value {
            DeValue::String(text) => quoted(text, '"'),
            DeValue::Integer(n) => cut(&n.to_string()),
            DeValue::Float(f) => cut(f.as_str()),
            DeValue::Boolean(flag) => flag.to_string(),
            DeValue::Datetime(date) => cut(&date.to_string()),
            DeValue::Array(items) => format!("a list of {}", items.len()),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.wrong_as(&found, expected)
    }

    /// The value is wrong; messages show it as `found`.
    pub(crate) fn wrong_as(&self, found: &str, expected: &str) -> FileError {
        self.at.wrong(format!("{} = {found}; expected {expected}", self.at.name))
    }
}

/// Returns whether this is a number with a word behind it.
fn has_unit(text: &str) -> bool {
    text.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit())
        && text.ends_with(|c: char| c.is_alphabetic())
}

fn integer(n: &DeInteger<'_>) -> Option<i128> {
    i128::from_str_radix(n.as_str(), n.radix()).ok()
}
