//! Numbers for people: round ones for scales and ticks, a few digits for labels and summaries.

/// The largest of the numbers 1, 2, 5 times powers of ten that is not above `x`, for finite `x > 0`.
pub(crate) fn round_below(x: f64) -> f64 {
    // The decimal exponent as the formatter sees it: exact, where log10 may be off by one.
    let text = format!("{x:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digit = match mantissa.as_bytes().first() {
        Some(b'1') => 1,
        Some(b'2'..=b'4') => 2,
        _ => 5,
    };
    format!("{digit}e{exponent}").parse().unwrap_or(x)
}

/// The smallest of the numbers 1, 2, 5 times powers of ten that is not below `x`.
fn round_above(x: f64) -> f64 {
    let below = round_below(x);
    // The next round number is 2 or 2.5 times as large.
    if below == x { x } else { round_below(2.6 * below) }
}

/// Round numbers in \[min, max\], evenly spaced, some three to six of them, with their text. For `min < max`.
pub(crate) fn ticks(min: f64, max: f64) -> Vec<(f64, String)> {
    let step = round_above((max - min) / 5.0);
    let (first, last) = ((min / step).ceil(), (max / step).floor());
    // Where the interval is narrow beside its distance from 0, doubles have no room for ticks.
    if !(first.abs() < 1e9 && last.abs() < 1e9) {
        return Vec::new();
    }
    let tick = |i| step * i as f64;
    (first as i64..=last as i64).map(|i| (tick(i), short(tick(i), 12))).collect()
}

/// A number of this many significant digits that is not below `x`, for `x >= 0`.
pub(crate) fn above(x: f64, digits: usize) -> String {
    short(x + 0.5 * 10_f64.powi(1 - digits as i32) * x, digits)
}

/// `x` with this many significant digits, without the zeros at their end; with an exponent where the size asks for it.
pub(crate) fn short(x: f64, digits: usize) -> String {
    let after_the_first = digits.saturating_sub(1);
    let text = format!("{x:.after_the_first$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    match exponent.parse::<i32>() {
        Ok(exponent) if (-3..5).contains(&exponent) => {
            let exponent = i64::from(exponent);
            let decimals = usize::try_from(after_the_first as i64 - exponent).unwrap_or(0);
            trimmed(&format!("{x:.decimals$}"))
        }
        _ => format!("{}e{exponent}", trimmed(mantissa)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers_are_the_nearest_below_and_above() {
        for (x, below, above) in [
            (1.0, 1.0, 1.0),
            (1.99, 1.0, 2.0),
            (4.99, 2.0, 5.0),
            (9.99, 5.0, 10.0),
            (0.001, 0.001, 0.001),
            (0.03, 0.02, 0.05),
            (7e-300, 5e-300, 1e-299),
        ] {
            assert_eq!([round_below(x), round_above(x)], [below, above], "{x}");
        }
    }

    #[test]
    fn a_number_above_is_not_below_and_off_by_a_digit_at_most() {
        for k in 1..500 {
            let x = f64::from(k) * 0.777 * 10_f64.powi(k % 11 - 5);
            for digits in [1, 2, 3] {
                let found: f64 = above(x, digits).parse().unwrap();
                let digit = 10_f64.powi(1 - digits as i32);
                assert!(x <= found && found <= x * (1.0 + digit), "{x}: {found}");
            }
        }
        assert_eq!(above(0.0, 2), "0");
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let texts =
            |min, max| ticks(min, max).into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(texts(0.013, 0.29), ["0.1", "0.2"]);
        assert_eq!(texts(-3.0, 17.0), ["0", "5", "10", "15"]);
        assert_eq!(texts(0.0, 3e7), ["0", "1e7", "2e7", "3e7"]);
        assert_eq!(texts(1.0, 1.0 + 1e-12), Vec::<String>::new());
    }

    #[test]
    fn labels_have_three_digits() {
        let numbers = [0.0, -0.25, 2.1449, 99.96, 1234.0, 0.0012345, 1.0e-7, 2.346e12];
        let labels = ["0", "-0.25", "2.14", "100", "1234", "0.00123", "1e-7", "2.35e12"];
        assert_eq!(numbers.map(|x| short(x, 3)), labels);
    }
}
