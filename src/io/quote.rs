//! What a file says, as a message shows it: in quotes, control characters escaped, long texts cut.

/// More characters than this are cut.
const MOST: usize = 60;

/// `text` between two `mark`s.
pub fn quoted(text: &str, mark: char) -> String {
    let mut shown = String::from(mark);
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
    shown.push(mark);
    shown
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
}
