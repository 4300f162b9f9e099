//! TOML with places: a table or a value knows what it is called and where it stands, so that a mistake in it can be
//! reported in one line. The names in messages look like the file: `[mesh] rectangle.nx`, `[load] body[1]`.
//!
//! Why not serde: its derived readers drop the third entry of a list meant for two, turn an alternative such as
//! "a number or "auto"" into "did not match any variant", and forget the line.

use std::ops::RangeInclusive;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use super::expression::Expression;
use super::mistake::{CaseError, CaseMistake};
use super::source::Source;
use crate::fem::SharedFunction;
use crate::quote::{cut, key as shown, listed, number, quoted};

/// A table of the file.
pub struct Table<'s> {
    source: Source<'s>,
    /// Its name in messages, and the prefix of its keys there; both are empty for the whole file.
    name: String,
    prefix: String,
    start: Option<usize>,
    entries: &'s DeTable<'s>,
}

/// A value of the file.
pub struct Value<'s> {
    source: Source<'s>,
    name: String,
    start: usize,
    value: &'s DeValue<'s>,
}

impl<'s> Table<'s> {
    /// The whole file.
    pub fn whole(source: Source<'s>, entries: &'s DeTable<'s>) -> Self {
        Table { source, name: String::new(), prefix: String::new(), start: None, entries }
    }

    pub fn keys(&self) -> impl Iterator<Item = &'s str> {
        self.entries.keys().map(|key| &**key.get_ref())
    }

    pub fn get(&self, key: &str) -> Option<Value<'s>> {
        let (key, value) = self.entries.get_key_value(key)?;
        Some(Value {
            source: self.source,
            name: format!("{}{}", self.prefix, shown(key.get_ref())),
            start: key.span().start,
            value: value.get_ref(),
        })
    }

    /// The value of `key`, which must be there.
    pub fn require(&self, key: &str, expected: &str) -> Result<Value<'s>, CaseError> {
        self.get(key).ok_or_else(|| {
            let name = format!("{}{key}", self.prefix);
            self.wrong(CaseMistake::Missing { name, expected: expected.to_owned() })
        })
    }

    /// The table `key` of the file under its header, if there is one.
    pub fn section(&self, key: &str) -> Result<Option<Table<'s>>, CaseError> {
        self.get(key).map(|value| value.section(format!("[{key}]"))).transpose()
    }

    /// The table `key` of the file, which must be there.
    pub fn required_section(&self, key: &str, expected: &str) -> Result<Table<'s>, CaseError> {
        let name = format!("[{key}]");
        self.section(key)?
            .ok_or_else(|| self.wrong(CaseMistake::Missing { name, expected: expected.to_owned() }))
    }

    /// Refuses keys that are not `known`.
    pub fn only(&self, known: &[&str]) -> Result<(), CaseError> {
        let unknown = self.entries.keys().find(|key| !known.contains(&&**key.get_ref()));
        match unknown {
            None => Ok(()),
            Some(key) => {
                let mistake = CaseMistake::Unknown {
                    key: quoted(key.get_ref(), '\''),
                    place: self.name.clone(),
                    known: listed(known, "or"),
                };
                Err(self.source.wrong(Some(key.span().start), mistake))
            }
        }
    }

    /// The one of `keys` that is there.
    pub fn exactly_one(&self, keys: &[&str]) -> Result<Value<'s>, CaseError> {
        self.only(keys)?;
        let mut values = keys.iter().filter_map(|key| self.get(key));
        match (values.next(), values.next()) {
            (Some(value), None) => Ok(value),
            _ => Err(self.combination(keys, &format!("either {}", listed(keys, "or")))),
        }
    }

    /// The complaint about which of `keys` are there.
    pub fn combination(&self, keys: &[&str], expected: &str) -> CaseError {
        let found: Vec<&str> = keys.iter().copied().filter(|k| self.get(k).is_some()).collect();
        let mistake = CaseMistake::Combination {
            name: self.name.clone(),
            found: if found.is_empty() { "none".to_owned() } else { listed(&found, "and") },
            expected: expected.to_owned(),
        };
        // Where one of them was set over the file, that is what went wrong.
        let mut starts = found.iter().filter_map(|key| Some(self.get(key)?.start));
        let set = starts.rfind(|&start| self.source.setting_at(start).is_some());
        self.source.wrong(set.or(self.start), mistake)
    }

    /// A mistake that concerns the table as a whole.
    pub fn wrong(&self, mistake: CaseMistake) -> CaseError {
        self.source.wrong(self.start, mistake)
    }

    pub fn name(&self) -> &str {
        &self.name
    }
}

impl<'s> Value<'s> {
    pub fn name(&self) -> &str {
        &self.name
    }

    /// As a table under the header `name`.
    pub fn section(&self, name: String) -> Result<Table<'s>, CaseError> {
        let prefix = format!("{name} ");
        self.table_named(name, prefix)
    }

    /// As a table inside a line.
    pub fn table(&self) -> Result<Table<'s>, CaseError> {
        self.table_named(self.name.clone(), format!("{}.", self.name))
    }

    fn table_named(&self, name: String, prefix: String) -> Result<Table<'s>, CaseError> {
        match self.value {
            DeValue::Table(entries) => {
                Ok(Table { source: self.source, name, prefix, start: Some(self.start), entries })
            }
            _ => Err(self.wrong("a table")),
        }
    }

    pub fn is_table(&self) -> bool {
        matches!(self.value, DeValue::Table(_))
    }

    pub fn text(&self) -> Result<&'s str, CaseError> {
        self.as_text().ok_or_else(|| self.wrong("a text in quotes"))
    }

    pub fn as_text(&self) -> Option<&'s str> {
        match self.value {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    pub fn flag(&self) -> Result<bool, CaseError> {
        match self.value {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => Err(self.wrong("true or false")),
        }
    }

    /// A finite number; integers are numbers.
    pub fn number(&self) -> Result<f64, CaseError> {
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
    pub fn number_that(
        &self,
        holds: impl FnOnce(f64) -> bool,
        expected: &str,
    ) -> Result<f64, CaseError> {
        let number = self.number()?;
        if holds(number) { Ok(number) } else { Err(self.wrong(expected)) }
    }

    /// An integer in a range.
    pub fn whole_number(&self, range: RangeInclusive<usize>) -> Result<usize, CaseError> {
        let number = match self.value {
            DeValue::Integer(n) => integer(n).and_then(|n| usize::try_from(n).ok()),
            _ => None,
        };
        number.filter(|n| range.contains(n)).ok_or_else(|| {
            self.wrong(&format!("a whole number from {} to {}", range.start(), range.end()))
        })
    }

    /// The value that one of these words stands for.
    pub fn one_of<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, CaseError> {
        let found = self.as_text().and_then(|text| words.iter().find(|word| word.0 == text));
        found.map(|word| word.1).ok_or_else(|| {
            let words: Vec<String> = words.iter().map(|word| quoted(word.0, '"')).collect();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            self.wrong(&listed(&words, "or"))
        })
    }

    /// The items of a list.
    pub fn items(&self) -> Result<Vec<Value<'s>>, CaseError> {
        match self.value {
            DeValue::Array(items) => Ok(items.iter().enumerate().map(|i| self.item(i)).collect()),
            _ => Err(self.wrong("a list")),
        }
    }

    fn item(&self, (i, item): (usize, &'s Spanned<DeValue<'s>>)) -> Value<'s> {
        Value {
            source: self.source,
            name: format!("{}[{i}]", self.name),
            start: item.span().start,
            value: item.get_ref(),
        }
    }

    /// A list of two.
    pub fn pair(&self) -> Result<[Value<'s>; 2], CaseError> {
        let pair = self.items().ok().and_then(|items| items.try_into().ok());
        pair.ok_or_else(|| self.wrong("a list of two: one for x, one for y"))
    }

    /// An expression in x and y. One that is the same everywhere must be finite.
    pub fn expression(&self) -> Result<Expression, CaseError> {
        if let DeValue::Integer(_) | DeValue::Float(_) = self.value {
            return self.number().map(Expression::from);
        }
        let Some(text) = self.as_text() else {
            return Err(self.wrong("a number, or an expression in quotes, such as \"2*x\""));
        };
        let expression: Expression = text.parse().map_err(|error| {
            let (name, text) = (self.name.clone(), quoted(text, '"'));
            self.mistake(CaseMistake::Expression { name, text, error })
        })?;
        match expression.constant() {
            Some(value) if !value.is_finite() => {
                let found = format!("{}, which is {}", quoted(text, '"'), number(value));
                Err(self.wrong_as(found, "a finite value"))
            }
            _ => Ok(expression),
        }
    }

    /// The value as a function.
    pub fn function(&self) -> Result<SharedFunction, CaseError> {
        Ok(Arc::new(self.expression()?))
    }

    /// The complaint that this should have been as `expected`.
    pub fn wrong(&self, expected: &str) -> CaseError {
        let found = match self.value {
            DeValue::String(text) => quoted(text, '"'),
            DeValue::Integer(n) => cut(&n.to_string()),
            DeValue::Float(f) => cut(f.as_str()),
            DeValue::Boolean(flag) => flag.to_string(),
            DeValue::Datetime(date) => cut(&date.to_string()),
            DeValue::Array(items) => format!("a list of {}", items.len()),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.wrong_as(found, expected)
    }

    /// The value is wrong; messages show it as `found`.
    pub fn wrong_as(&self, found: String, expected: &str) -> CaseError {
        let (name, expected) = (self.name.clone(), expected.to_owned());
        self.mistake(CaseMistake::Value { name, found, expected })
    }

    /// A mistake that concerns this value.
    pub fn mistake(&self, mistake: CaseMistake) -> CaseError {
        self.source.wrong(Some(self.start), mistake)
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
