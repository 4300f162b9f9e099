//! Markdown tables and numbers in them.

use std::time::Duration;

/// A Markdown table; numbers to the right.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|&cell| cell.to_owned()).collect();
    let rule = vec!["---:".to_owned(); head.len()];
    let body: String = rows.iter().map(|row| line(row)).collect();
    format!("{}{}{body}", line(&head), line(&rule))
}

/// A time with three digits.
pub fn time(t: Duration) -> String {
    seconds(t.as_secs_f64())
}

/// A time with three digits.
pub fn seconds(s: f64) -> String {
    if s < 1.0 { format!("{} ms", three(1e3 * s)) } else { format!("{} s", three(s)) }
}

/// A number of bytes.
pub fn bytes(b: f64) -> String {
    if b < 1e9 { format!("{:.0} MB", b / 1e6) } else { format!("{:.2} GB", b / 1e9) }
}

/// Three significant digits.
pub fn three(x: f64) -> String {
    let digits = (2 - x.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{x:.digits$}")
}
