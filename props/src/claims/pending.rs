//! Rows that are not checked yet: they say so.

use crate::claim::Claim;

fn row(
    id: &'static str,
    items: &'static [&'static str],
    title: &'static str,
    paper: &'static str,
) -> Claim {
    Claim {
        id,
        items,
        title,
        paper,
        statement: "Not yet.",
        numbers: "None yet.",
        kernel: &[],
        preconditions: "None yet.",
        limits: "Everything: there is no evidence here yet.",
        single: None,
        checks: Vec::new(),
    }
}

/// The rows without evidence.
pub fn claims() -> Vec<Claim> {
    vec![
        row(
            "12",
            &["Theorem 3.5", "(21)", "(22)-(24)", "Corollary 3.6", "(25)", "Remark 3.7"],
            "Rates",
            "|u - u^h|_1 + |gamma^1/2 (sigma_n(u) + [P(u^h)]+/gamma)| <= C h^(1/2 + nu) |u|_(3/2 + nu).",
        ),
        row(
            "13",
            &["floating point"],
            "What the above rests on in floating point",
            "Nothing: the paper computes in R.",
        ),
    ]
}
