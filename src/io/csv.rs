//! Tables in CSV, for a spreadsheet or a plot.
//!
//! Each number is the shortest decimal that reads back to the same double.

use super::files::{NotFinite, check_finite};

/// The text of a file: a line with the names of the columns, then a line for each row of numbers and a text behind them.
/// An error names the row, counted from 0.
pub(super) fn table(names: &[&str], rows: &[(Vec<f64>, &str)]) -> Result<String, NotFinite> {
    check_finite("row", rows.iter().map(|(numbers, _)| numbers.as_slice()))?;
    let row = |(numbers, last): &(Vec<f64>, &str)| {
        line(numbers.iter().map(|&x| number(x)).chain([(*last).to_owned()]))
    };
    Ok(names.join(",") + "\n" + &rows.iter().map(row).collect::<String>())
}

/// The debug form is the one that uses exponents where they are shorter.
pub(super) fn number(x: f64) -> String {
    format!("{x:?}")
}

/// A line of the file.
pub(super) fn line(cells: impl IntoIterator<Item = String>) -> String {
    cells.into_iter().map(|text| cell(&text)).collect::<Vec<_>>().join(",") + "\n"
}

/// A cell as RFC 4180 has it: in quotes if it needs them. A text that a spreadsheet would take for a formula and obey gets an
/// apostrophe before it; a number stays one.
fn cell(text: &str) -> String {
    let is_formula =
        text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    let mark = if is_formula { "'" } else { "" };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{mark}{}\"", text.replace('"', "\"\""))
    } else {
        format!("{mark}{text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_marked_as_texts_and_numbers_stay_numbers() {
        for (text, expected) in [
            ("=1+1", "'=1+1"),
            ("@SUM(1)", "'@SUM(1)"),
            ("-2+3", "'-2+3"),
            ("=HYPERLINK(\"a\",1)", "\"'=HYPERLINK(\"\"a\"\",1)\""),
            ("-2.5e-3", "-2.5e-3"),
            ("+7", "+7"),
            ("floor", "floor"),
        ] {
            assert_eq!(cell(text), expected);
        }
    }
}
