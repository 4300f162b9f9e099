//! What a predicate answers, and the numbers it is stated for.
//!
//! A predicate is an ordinary function of plain data, generic over the number type, that writes a statement of the paper
//! out with `<`, `<=`, `==` and `if`. It has no idea which engine runs it: over symbols it is proved, over rationals and
//! doubles it is tested, over bits it is model-checked.

use signorini::kernel::Scalar;

/// Numbers with an order: doubles, exact rationals, integers and symbols. Balls are not among them, on purpose.
pub trait Ordered: Scalar + PartialOrd {}

impl<S: Scalar + PartialOrd> Ordered for S {}

/// The answer of a predicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The statement holds, and the data were of this class.
    Holds(&'static str),
    /// The hypothesis of the statement does not hold: nothing is said.
    Vacuous,
    /// The hypothesis holds and the conclusion does not.
    Fails(&'static str),
}

impl Verdict {
    /// Whether this is [`Verdict::Fails`].
    pub fn fails(self) -> bool {
        matches!(self, Verdict::Fails(_))
    }
}

/// A hypothesis: where it does not hold, the predicate is [`Verdict::Vacuous`].
#[macro_export]
macro_rules! given {
    ($condition:expr) => {
        if $condition {
        } else {
            return $crate::Verdict::Vacuous;
        }
    };
}

/// A conclusion: where it does not hold, the predicate [`Verdict::Fails`].
#[macro_export]
macro_rules! ensure {
    ($condition:expr) => {
        if $condition {
        } else {
            return $crate::Verdict::Fails(stringify!($condition));
        }
    };
}
