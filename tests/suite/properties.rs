//! Properties of the solver and of what it is given, on random or on many data: each with a mistake in the check itself that it
//! must notice.

mod bodies;
mod conditions;
mod directions;
mod given;
mod integration;
mod matrix;
mod meshes;
mod newton;
mod places;
mod postprocess;
mod refinement;

/// What was found where a property does not hold.
type Outcome = Result<(), String>;

/// The words of an error that a check did not expect.
fn text(error: impl ToString) -> String {
    error.to_string()
}

/// Tests: what holds, and after `not` the control, which must not.
macro_rules! properties {
    ($($name:ident: $($holds:expr),+; not $($fails:expr),+;)+) => {$(
        #[test]
        fn $name() {
            $(assert_eq!($holds, Ok(()));)+
            $(assert!($fails.is_err(), "not noticed: {}", stringify!($fails));)+
        }
    )+};
}
use properties;
