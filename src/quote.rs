//! Text from outside, as a message shows it: control characters escaped, long texts cut, numbers with as many digits as
//! they need and no more, lists as people say them.
//!
//! Names, titles and paths come from files that anybody may have written. A terminal obeys control characters, and some
//! characters that are not control characters turn the direction of the text round: both are shown as `\u{..}`.

use std::cmp::Ordering;
use std::path::Path;

/// The largest number of characters of a word; longer words are cut.
const MOST: usize = 60;

/// The largest number of characters of a title; longer titles are cut.
const MOST_OF_A_LINE: usize = 200;

/// The longest path shown whole; of a longer one the end is shown.
const MOST_OF_A_PATH: usize = 300;

/// The largest number of names that are shown; more are counted.
const MOST_NAMES: usize = 20;

/// `text` between two `mark`s.
pub(crate) fn quoted(text: &str, mark: char) -> String {
    format!("{mark}{}{mark}", cut(text))
}

/// `text` without quotes.
pub(crate) fn cut(text: &str) -> String {
    cut_at(text, MOST)
}

/// A text of a file, on one line of at most 200 characters.
pub(crate) fn line(text: &str) -> String {
    cut_at(text, MOST_OF_A_LINE)
}

fn cut_at(text: &str, most: usize) -> String {
    let mut shown = escaped(text.chars().take(most));
    if text.chars().nth(most).is_some() {
        shown.push_str("...");
    }
    shown
}

/// A path, on one line; of a long one its end.
pub(crate) fn path(path: &Path) -> String {
    let text = path.to_string_lossy();
    match text.char_indices().rev().nth(MOST_OF_A_PATH) {
        None => escaped(text.chars()),
        Some((cut, c)) => format!("...{}", escaped(text[cut + c.len_utf8()..].chars())),
    }
}

/// A key of a case file as the file has it: in quotes only if it needs them.
pub(crate) fn key(key: &str) -> String {
    let bare = key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare && (1..=MOST).contains(&key.len()) { key.to_owned() } else { quoted(key, '"') }
}

/// The digits that read back to the same number; with an exponent where there would be many zeros.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || (1e-5..1e16).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// A number to three digits, for lengths that are the result of a computation.
pub(crate) fn short(x: f64) -> String {
    number(format!("{x:.2e}").parse().unwrap_or(x))
}

/// A number with so many decimals; from 1e16 on, which has none, as [`number`] writes it.
pub(crate) fn fixed(x: f64, decimals: usize) -> String {
    if x.abs() < 1e16 { format!("{x:.decimals$}") } else { number(x) }
}

/// Keeps line breaks and escapes all other control characters, for output to a terminal.
pub fn lines(text: &str) -> String {
    text.split('\n').map(unbroken).collect::<Vec<_>>().join("\n")
}

/// One line of any length, with control characters escaped.
pub(crate) fn unbroken(text: &str) -> String {
    escaped(text.chars())
}

fn escaped(text: impl Iterator<Item = char>) -> String {
    let mut shown = String::new();
    for c in text {
        match c {
            '\n' | '\r' | '\t' | '\0' => shown.extend(c.escape_debug()),
            c if is_hidden(c) => shown.extend(c.escape_unicode()),
            c => shown.push(c),
        }
    }
    shown
}

/// A text for a page: spaces in place of control characters (a table of bytes above 127 has some, too) and of those that turn
/// the direction of the text round or are not seen; line breaks and tabs stay.
#[cfg(feature = "files")]
pub(crate) fn on_page(text: &str) -> String {
    let is_kept = |c: char| {
        matches!(c, '\n' | '\t') || !(is_hidden(c) || matches!(c, '\u{fffe}' | '\u{ffff}'))
    };
    text.chars().map(|c| if is_kept(c) { c } else { ' ' }).collect()
}

/// A text in JSON, in which the characters that a terminal obeys are escaped: the text that it stands for is the same.
#[cfg(feature = "files")]
pub(crate) fn in_json(json: &str) -> String {
    let mut shown = String::with_capacity(json.len());
    for c in json.chars() {
        if c != '\n' && is_hidden(c) {
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                shown.push_str(&format!("\\u{unit:04x}"));
            }
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Control characters, and those that format text without being seen.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}')
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
        || matches!(c, '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

/// `a, b or c`, where `last` is "or".
pub(crate) fn listed(words: &[&str], last: &str) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).to_owned(),
        [first @ .., word] => format!("{} {last} {word}", first.join(", ")),
    }
}

/// `a, b, c`; of many names the first, and how many more there are.
pub(crate) fn names<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let mut rest = names.into_iter();
    let mut shown: Vec<String> = rest.by_ref().take(MOST_NAMES).map(cut).collect();
    match rest.count() {
        0 => {}
        more => shown.push(format!("and {more} more")),
    }
    shown.join(", ")
}

/// The order of names in which the numbers in them count as numbers: wall 2 comes before wall 10.
pub(crate) fn natural(a: &str, b: &str) -> Ordering {
    let key = |text: &str| {
        let parts = text.as_bytes().chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit());
        let part = |part: &[u8]| {
            // A number by its length without zeros before it, then by its digits.
            let zeros = part.iter().take_while(|&&c| c == b'0').count();
            let digits = part.first().is_some_and(u8::is_ascii_digit);
            let length = if digits { part.len() - zeros } else { 0 };
            (!digits, length, part[if digits { zeros } else { 0 }..].to_vec())
        };
        parts.map(part).collect::<Vec<_>>()
    };
    key(a).cmp(&key(b)).then_with(|| a.cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_a_terminal_obeys_are_escaped_and_long_texts_cut() {
        assert_eq!(quoted("a 'b'\n\u{7}é", '"'), "\"a 'b'\\n\\u{7}é\"");
        assert_eq!(cut("a\u{202e}b\u{1b}[2Jc\u{9b}\0"), "a\\u{202e}b\\u{1b}[2Jc\\u{9b}\\0");
        assert_eq!(lines("a\u{1b}c\nb\r\n"), "a\\u{1b}c\nb\\r\n");
        let long = |count: usize| "x".repeat(count);
        assert_eq!([cut(&long(60)), cut(&long(61))], [long(60), long(60) + "..."]);
        assert_eq!(line(&long(201)), long(200) + "...");
    }

    #[cfg(feature = "files")]
    #[test]
    fn pages_and_json_hold_no_character_that_a_terminal_obeys() {
        assert_eq!(on_page("a\u{202e}b\u{9b}\tc\u{feff}\n"), "a b \tc \n");
        let text = "{\n  \"a\": \"x\u{202e}y\u{9b}\u{e0001}é\"\n}";
        let shown = in_json(text);
        assert_eq!(shown, "{\n  \"a\": \"x\\u202ey\\u009b\\udb40\\udc01é\"\n}");
        assert_eq!(lines(&shown), shown, "nothing is left to escape");
    }

    #[test]
    fn of_a_long_path_the_end_is_shown() {
        assert_eq!(path(Path::new("a\nb/c.toml")), "a\\nb/c.toml");
        let long = format!("{}/case.toml", "é".repeat(1000));
        let shown = path(Path::new(&long));
        assert!(shown.starts_with("...é") && shown.ends_with("é/case.toml"), "{shown}");
        assert_eq!(shown.chars().count(), MOST_OF_A_PATH + 3);
        let fits = "é".repeat(MOST_OF_A_PATH);
        assert_eq!(path(Path::new(&fits)), fits);
    }

    #[test]
    fn numbers_read_back_and_have_no_row_of_zeros() {
        let shown = [0.0, -0.25, 0.00001, 1e-6, 1e16, f64::NAN, f64::INFINITY].map(number);
        assert_eq!(shown, ["0", "-0.25", "0.00001", "1e-6", "1e16", "NaN", "inf"]);
        assert_eq!([fixed(1.69706, 4), fixed(1e300, 4)], ["1.6971", "1e300"]);
        for x in [0.1 + 0.2, f64::MAX, f64::MIN_POSITIVE, 5e-324, 9.999999999999998e15] {
            assert_eq!(number(x).parse(), Ok(x));
            assert!(number(x).len() < 25);
        }
    }

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["wall 10", "wall 2", "1", "11", "2", "wall", "10", "a02", "a1", "a2"];
        names.sort_by(|a, b| natural(a, b));
        let expected = ["1", "2", "10", "11", "a1", "a02", "a2", "wall", "wall 2", "wall 10"];
        assert_eq!(names, expected);
        names.sort_unstable();
        assert_ne!(names, expected, "control");
    }

    #[test]
    fn lists_end_with_a_word_and_long_ones_with_a_count() {
        assert_eq!(listed(&[], "or"), "");
        assert_eq!(listed(&["a"], "or"), "a");
        assert_eq!(listed(&["a", "b", "c"], "and"), "a, b and c");
        assert_eq!(names(["a", "b"]), "a, b");
        let many = names(std::iter::repeat_n("a", 32_000));
        assert!(many.ends_with("a, and 31980 more") && many.len() < 100, "{many}");
    }
}
