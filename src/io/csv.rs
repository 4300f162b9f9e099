//! contact.csv: what happens along the contact line, for a spreadsheet or a plot.
//!
//! Each number is the shortest decimal that reads back to the same double.

use std::fmt::Write;

use super::finite::{NotFinite, check_finite};

/// The columns of numbers: arc length from the start of the boundary, place in the undeformed body, u . n~, gap g, n~ . sigma(u) n
/// (negative in compression), contact pressure lambda^h (never positive), recovered pressure (never negative).
const NUMBERS: [&str; 8] = ["arc", "x", "y", "u_n", "gap", "sigma_n", "lambda", "pressure"];

/// One node of one contact edge: the name of its boundary and the numbers of the columns. A node between two edges
/// has a row for each: sigma_n jumps there.
pub type ContactRow<'a> = (&'a str, [f64; 8]);

/// The text of the file: a line with the names, then a line for each row.
///
/// # Errors
/// [`NotFinite`], with the number of the row, counted from 0.
pub fn contact_csv(rows: &[ContactRow]) -> Result<String, NotFinite> {
    check_finite("row", rows.iter().map(|(_, numbers)| numbers.as_slice()))?;
    let mut text = format!("{},boundary\n", NUMBERS.join(","));
    for (boundary, numbers) in rows {
        for number in numbers {
            // Writing to a string cannot fail. The debug form is the one that uses exponents where they are shorter.
            let _ = write!(text, "{number:?},");
        }
        text.push_str(&cell(boundary));
        text.push('\n');
    }
    Ok(text)
}

/// A cell as RFC 4180 has it: in quotes if it needs them. A text that a spreadsheet would take for a formula and obey gets an
/// apostrophe before it; a number stays one.
pub(super) fn cell(text: &str) -> String {
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

    const ROW: [f64; 8] = [0.1, 1.0 / 3.0, -0.0, -1e-17, 0.0, 5e-324, -1.5e300, 2.0];

    #[test]
    fn numbers_are_the_shortest_that_read_back() {
        let mut second = ROW;
        second[0] = 2.0;
        let text = contact_csv(&[("floor", ROW), ("the \"floor\", left", second)]).unwrap();
        assert_eq!(
            text,
            "arc,x,y,u_n,gap,sigma_n,lambda,pressure,boundary\n\
             0.1,0.3333333333333333,-0.0,-1e-17,0.0,5e-324,-1.5e300,2.0,floor\n\
             2.0,0.3333333333333333,-0.0,-1e-17,0.0,5e-324,-1.5e300,2.0,\"the \"\"floor\"\", left\"\n"
        );
    }

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

    #[test]
    fn a_number_that_is_not_finite_is_refused_by_row() {
        let mut second = ROW;
        second[4] = f64::NAN;
        let error = contact_csv(&[("floor", ROW), ("floor", second)]).unwrap_err();
        assert_eq!(error.to_string(), "row[1] is NaN or infinite; expected a finite number");
    }
}
