//! What a file says, as a message shows it: texts in quotes, control characters escaped, long texts cut; lists as people
//! say them.

/// More characters than this are cut.
const MOST: usize = 60;

/// `text` between two `mark`s.
pub fn quoted(text: &str, mark: char) -> String {
    format!("{mark}{}{mark}", cut(text))
}

/// `text` without quotes.
pub fn cut(text: &str) -> String {
    let mut shown = String::new();
    for c in text.chars().take(MOST) {
        if c.is_control() {
            shown.extend(c.escape_debug());
        } else {
            shown.push(c);
        }
    }
    if text.chars().nth(MOST).is_some() {
        shown.push_str("...");
    }
    shown
}

/// `a, b or c`, where `last` is "or".
pub fn listed(words: &[&str], last: &str) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).to_owned(),
        [first @ .., word] => format!("{} {last} {word}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_long_texts_cut() {
        assert_eq!(quoted("a 'b'\n\u{7}é", '"'), "\"a 'b'\\n\\u{7}é\"");
        assert_eq!(quoted(&"x".repeat(61), '\''), format!("'{}...'", "x".repeat(60)));
        assert_eq!(quoted(&"x".repeat(60), '\''), format!("'{}'", "x".repeat(60)));
    }

    #[test]
    fn lists_end_with_a_word() {
        assert_eq!(listed(&[], "or"), "");
        assert_eq!(listed(&["a"], "or"), "a");
        assert_eq!(listed(&["a", "b", "c"], "and"), "a, b and c");
    }
}
