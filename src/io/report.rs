//! report.html: picture, numbers, what is proved and the case as read, in one file that has no scripts and
//! loads nothing, to send to somebody.

use std::fmt::Write;

use super::case::Case;
use super::result::Results;
use super::summary;
use crate::quote;

pub(crate) const FILE: &str = "report.html";

const STYLE: &str = "\
body { font-family: Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif; color: #222; background: #fff; max-width: 64em; margin: 2em auto; padding: 0 1em; line-height: 1.4 }
svg { max-width: 100%; height: auto }
table { border-collapse: collapse; margin: 1em 0 }
th, td { text-align: left; vertical-align: top; padding: 0.15em 1.2em 0.15em 0 }
th { font-weight: normal; color: #666; white-space: nowrap }
.numbers td { text-align: right; font-variant-numeric: tabular-nums }
.numbers thead th { border-bottom: 1px solid #666 }
pre { background: #f4f4f4; padding: 1em; overflow-x: auto; white-space: pre-wrap }
footer { color: #666; border-top: 1px solid #ccc; margin-top: 2em; padding-top: 0.5em }";

/// The text of the file, with the text of picture.svg in it.
pub(crate) fn html(case: &Case, results: &Results, picture: &str) -> String {
    let title = escaped(&case.title);
    // Without the XML declaration, which only a separate file has.
    let picture = picture.find("<svg").map_or("", |start| &picture[start..]);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>\n{STYLE}\n</style>\n</head>\n<body>\n{picture}"
    );
    page.push_str("<h2>Result</h2>\n");
    if let Some(outcome) = results.outcome().filter(|_| results.falls_short()) {
        page.push_str(&format!("<p><strong>{}</strong></p>\n", escaped(&outcome)));
    }
    page.push_str("<table>\n");
    let brief = summary::lines_of(results, false);
    brief.iter().for_each(|(name, line)| row(&mut page, name, line));
    page.push_str("</table>\n");
    page.push_str(&stretches(results));
    page.push_str("<h2>How it was solved</h2>\n<table>\n");
    let all = summary::lines_of(results, true);
    for (name, line) in all.iter().filter(|line| !brief.contains(line)) {
        row(&mut page, name, line);
    }
    // Writing to a string cannot fail.
    let _ = write!(
        page,
        "</table>\n<h2>Case</h2>\n<pre>{}</pre>\n<footer>signorini {}: unilateral (Signorini) contact in linear elasticity by Nitsche's method, after Chouly and Hild (SIAM J. Numer. Anal. 51, 2013). Case file: {}</footer>\n</body>\n</html>\n",
        escaped(&case.text),
        escaped(&results.version),
        escaped(&case.file.display().to_string()),
    );
    page
}

fn row(page: &mut String, name: &str, line: &str) {
    let _ = writeln!(page, "<tr><th>{}</th><td>{}</td></tr>", escaped(name), escaped(line));
}

/// A table of where each boundary is in contact; empty where none is.
fn stretches(results: &Results) -> String {
    let mut rows = String::new();
    for part in results.contact.iter().filter(|part| results.is_in_contact(part)) {
        for [from, to] in &part.stretches {
            let all_round = from == to;
            let [from, to] = [from, to].map(|&place| summary::vector(place));
            let [from, to] =
                if all_round { ["all round".to_owned(), String::new()] } else { [from, to] };
            let boundary = escaped(&part.boundary);
            let _ = writeln!(rows, "<tr><th>{boundary}</th><td>{from}</td><td>{to}</td></tr>");
        }
    }
    if rows.is_empty() {
        return rows;
    }
    let head = "<thead><tr><th>in contact</th><th>from</th><th>to</th></tr></thead>";
    format!("<table class=\"numbers\">\n{head}\n{rows}</table>\n")
}

/// Text that HTML shows as it is.
fn escaped(text: &str) -> String {
    quote::on_page(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::result::tests::everything;

    #[test]
    fn a_stretch_goes_from_its_start_to_its_end() {
        let found = stretches(&everything());
        let row = "<tr><th>floor</th><td>(2.41, 2.51)</td><td>(2.57, 2.63)</td></tr>";
        assert!(found.contains(row), "{found}");
        let mut open = everything();
        open.contact[0].force = 0.0;
        assert_eq!(stretches(&open), "");
    }
}
