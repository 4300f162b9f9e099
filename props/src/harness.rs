//! Harnesses for the model checker Kani, and the stand-in that runs the same functions on random draws elsewhere.
//!
//! Under Kani [`any`] is every value at once and [`assume`] restricts them. Elsewhere a harness is run many times:
//! [`any`] draws (edge values often), and [`assume`] ends the run when it does not hold. A harness whose assumptions no
//! draw meets has shown nothing, and is an error. A control is the false twin of a harness: under Kani it must fail
//! (`should_panic`), and the stand-in must find a draw for which it panics.

#[cfg(kani)]
pub use kani::{any, assume};

#[cfg(not(kani))]
pub use stand_in::{Any, Harness, any, assume};

/// Names a function as a harness of the model checker, with its unwinding bound, and lists it for the stand-in.
///
/// `harnesses! { const LIST; #[unwind] fn name() { .. } .. }`; a name that starts with `control_` is a false twin.
#[macro_export]
macro_rules! harnesses {
    ($($(#[doc = $doc:literal])* $kind:ident $name:ident() $body:block)*) => {
        $($crate::harness_function! { $(#[doc = $doc])* $kind $name $body })*

        /// The harnesses of this module.
        #[cfg(not(kani))]
        pub const HARNESSES: &[$crate::harness::Harness] = &[$($crate::harness::Harness {
            name: stringify!($name),
            control: $crate::is_control!($kind),
            body: $name,
        }),*];
    };
}

/// One harness: `holds` must hold, `fails` must not.
#[macro_export]
macro_rules! harness_function {
    ($(#[doc = $doc:literal])* holds $name:ident $body:block) => {
        $(#[doc = $doc])*
        #[cfg_attr(kani, kani::proof)]
        #[cfg_attr(kani, kani::unwind(8))]
        pub fn $name() $body
    };
    ($(#[doc = $doc:literal])* fails $name:ident $body:block) => {
        $(#[doc = $doc])*
        #[cfg_attr(kani, kani::proof)]
        #[cfg_attr(kani, kani::unwind(8))]
        #[cfg_attr(kani, kani::should_panic)]
        pub fn $name() $body
    };
}

/// Whether a kind of harness is a control.
#[macro_export]
macro_rules! is_control {
    (holds) => {
        false
    };
    (fails) => {
        true
    };
}

#[cfg(not(kani))]
mod stand_in {
    use std::cell::{Cell, RefCell};
    use std::panic::{self, AssertUnwindSafe};
    use std::sync::Once;

    use crate::proof::sampler::Random;

    /// Runs per harness.
    const RUNS: u32 = 20_000;

    /// A harness: a function that asserts something about [`any`] values.
    #[derive(Clone, Copy)]
    pub struct Harness {
        /// Its name, which says the range.
        pub name: &'static str,
        /// A false twin: it must panic for some draw.
        pub control: bool,
        /// The function.
        pub body: fn(),
    }

    /// How a run that ended early ended.
    struct AssumptionFailed;

    thread_local! {
        static RANDOM: RefCell<Random> = RefCell::new(Random::new(0));
        static RUNNING: Cell<bool> = const { Cell::new(false) };
    }

    impl Harness {
        /// Runs it on random draws.
        ///
        /// # Errors
        /// The message of a harness that panicked, a control that did not, or that no draw met the assumptions.
        pub fn run(&self) -> Result<String, String> {
            quiet_panics();
            RANDOM.set(Random::new(crate::draws::seed()));
            let mut met = 0;
            for run in 0..RUNS {
                RUNNING.set(true);
                let result = panic::catch_unwind(AssertUnwindSafe(self.body));
                RUNNING.set(false);
                match result {
                    Ok(()) => met += 1,
                    Err(why) if why.is::<AssumptionFailed>() => {}
                    Err(_) if self.control => return Ok(format!("rejected at draw {run}")),
                    Err(why) => {
                        let text = why.downcast_ref::<&str>().map(|s| (*s).to_owned());
                        let text = text.or_else(|| why.downcast_ref::<String>().cloned());
                        return Err(format!("draw {run}: {}", text.unwrap_or_default()));
                    }
                }
            }
            match (self.control, met) {
                (true, _) => Err("no draw rejected the planted mistake".to_owned()),
                (false, 0) => Err("no draw met the assumptions".to_owned()),
                (false, _) => Ok(format!("{met} of {RUNS} random draws met the assumptions")),
            }
        }
    }

    /// A panic inside a run of a harness is an answer, not an accident: it is not printed.
    fn quiet_panics() {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| {
            let usual = panic::take_hook();
            panic::set_hook(Box::new(move |info| {
                if !RUNNING.get() {
                    usual(info);
                }
            }));
        });
    }

    /// Ends the run if `condition` does not hold.
    pub fn assume(condition: bool) {
        if !condition {
            panic::panic_any(AssumptionFailed);
        }
    }

    /// Any value of a type: here, a random one.
    pub fn any<T: Any>() -> T {
        RANDOM.with_borrow_mut(|random| T::draw(random))
    }

    /// A type of which [`any`] value can be asked for.
    pub trait Any {
        /// A random value, edge values often.
        fn draw(random: &mut Random) -> Self;
    }

    impl Any for f64 {
        fn draw(random: &mut Random) -> f64 {
            // The last two refute the scaled (5) => u <= 0 together.
            const EDGES: [f64; 9] =
                [0.0, -0.0, 1.0, -1.0, 5e-324, f64::MAX, f64::NAN, 3.9e-121, -8.3e-25];
            match random.below(4) {
                0 => EDGES[random.below(9)],
                1 => f64::from_bits(random.bits()),
                _ => random.below(2001) as f64 / 8.0 - 125.0,
            }
        }
    }

    impl Any for bool {
        fn draw(random: &mut Random) -> bool {
            random.below(2) == 0
        }
    }

    macro_rules! any_integer {
        ($($type:ty),*) => {
            $(impl Any for $type {
                fn draw(random: &mut Random) -> $type {
                    match random.below(3) {
                        0 => random.below(9) as $type,
                        1 => (0 as $type).wrapping_sub(random.below(9) as $type),
                        _ => random.bits() as $type,
                    }
                }
            })*
        };
    }

    any_integer!(i8, u8, i16, i32, u32, usize);

    #[cfg(test)]
    mod tests {
        use super::*;

        fn harness(body: fn(), control: bool) -> Harness {
            Harness { name: "test", control, body }
        }

        #[test]
        fn a_harness_whose_assumptions_contradict_each_other_is_an_error() {
            let h = harness(|| assume(any::<i8>() as i32 > 1000), false);
            assert_eq!(h.run(), Err("no draw met the assumptions".to_owned()));
        }

        #[test]
        fn a_false_harness_is_an_error_and_a_true_control_too() {
            fn small() {
                assert!(any::<i8>() < 100, "small");
            }
            assert!(harness(small, false).run().unwrap_err().ends_with("small"));
            assert!(harness(small, true).run().is_ok());
            assert!(harness(|| {}, true).run().is_err());
        }
    }
}
