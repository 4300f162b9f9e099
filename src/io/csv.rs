//! contact.csv: what happens along the contact line, for a spreadsheet or a plot.
//!
//! Each number is the shortest decimal that reads back to the same double.

use std::fmt::Write;

use super::data::{DataError, check_finite};

/// One node of one contact edge. A node between two edges has a row for each: sigma_n jumps there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRow<'a> {
    /// Arc length from the start of the boundary.
    pub arc: f64,
    /// The place in the undeformed body.
    pub x: f64,
    /// The place in the undeformed body.
    pub y: f64,
    /// u . n~
    pub u_n: f64,
    /// The gap g.
    pub gap: f64,
    /// n~ . sigma(u) n, negative in compression.
    pub sigma_n: f64,
    /// The contact pressure lambda^h, never positive.
    pub lambda: f64,
    /// The recovered pressure, never negative.
    pub pressure: f64,
    /// The name of the boundary.
    pub boundary: &'a str,
}

/// The text of the file: a line with the names, then a line for each row.
///
/// # Errors
/// [`DataError::NotFinite`], with the number of the row, counted from 0.
pub fn contact_csv(rows: &[ContactRow]) -> Result<String, DataError> {
    let mut text = String::from("arc,x,y,u_n,gap,sigma_n,lambda,pressure,boundary\n");
    let numbers: Vec<[f64; 8]> = rows
        .iter()
        .map(|&ContactRow { arc, x, y, u_n, gap, sigma_n, lambda, pressure, .. }| {
            [arc, x, y, u_n, gap, sigma_n, lambda, pressure]
        })
        .collect();
    check_finite("row", numbers.iter().map(<[f64; 8]>::as_slice))?;
    for (row, numbers) in rows.iter().zip(numbers) {
        for number in numbers {
            // Writing to a string cannot fail. The debug form is the one that uses exponents where they are shorter.
            let _ = write!(text, "{number:?},");
        }
        text.push_str(&cell(row.boundary));
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

    const ROW: ContactRow<'static> = ContactRow {
        arc: 0.1,
        x: 1.0 / 3.0,
        y: -0.0,
        u_n: -1e-17,
        gap: 0.0,
        sigma_n: 5e-324,
        lambda: -1.5e300,
        pressure: 2.0,
        boundary: "floor",
    };

    #[test]
    fn numbers_are_the_shortest_that_read_back() {
        let text =
            contact_csv(&[ROW, ContactRow { arc: 2.0, boundary: "the \"floor\", left", ..ROW }])
                .unwrap();
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
        let error = contact_csv(&[ROW, ContactRow { gap: f64::NAN, ..ROW }]).unwrap_err();
        assert_eq!(error.to_string(), "row[1] is NaN or infinite; expected a finite number");
    }
}
