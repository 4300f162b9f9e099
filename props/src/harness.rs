//! Harnesses for the model checker Kani, and the stand-in that runs the same functions on random draws elsewhere.
//!
//! Under Kani [`any`] is every value at once and [`assume`] restricts them. Elsewhere a harness is run many times: on all
//! values, where it asks for some bits or bytes only; else [`any`] draws (edge values often). [`assume`] ends the run when it
//! does not hold. What counts are the draws that
//! meet the assumptions; a harness that hardly any does has shown nothing, and is an error. A control is the false twin of a
//! harness: under Kani it must fail (`should_panic`); elsewhere it is run once, on the counterexample that is stored with it, and
//! must panic there.
//!
//! Loops take at most seven rounds, or one less than a harness says (`within 4`: three rounds): the unwinding bound. So
//! harnesses compare no whole arrays or slices of integers: such a comparison is a loop over bytes. A loop over a slice whose
//! length is not known beforehand is unrolled up to the bound, and so is each one inside it.

#[cfg(kani)]
pub use kani::{any, assume};

#[cfg(not(kani))]
pub use stand_in::{Any, Harness, any, assume};

use crate::numbers::Whole;

/// Any finite double.
pub fn finite() -> f64 {
    let number: f64 = any();
    assume(number.is_finite());
    number
}

/// Any double but NaN.
pub fn number() -> f64 {
    let number: f64 = any();
    assume(!number.is_nan());
    number
}

/// Any whole number of a byte.
pub fn byte() -> Whole {
    Whole(i32::from(any::<i8>()))
}

/// 0 or 1.
pub fn bit() -> i32 {
    i32::from(any::<bool>())
}

/// Any whole number from -3 to 3.
pub fn within_3() -> Whole {
    Whole((2 * bit() + bit()) * (1 - 2 * bit()))
}

/// Any whole number from -7 to 7.
pub fn within_7() -> Whole {
    Whole((4 * bit() + 2 * bit() + bit()) * (1 - 2 * bit()))
}

/// Names functions as harnesses of the model checker, with their unwinding bound, and lists them for the stand-in.
///
/// `holds name() { .. }` must hold for all values; `fails name([v, ..]) { .. }` is a false twin, which fails when
/// [`any`] returns the values v, .. one after the other. `within n` in front of the body is another unwinding bound than 8.
#[macro_export]
macro_rules! harnesses {
    ($(
        $(#[doc = $doc:literal])*
        $kind:ident $name:ident($($counterexample:expr)?) $(within $bound:literal)? $body:block
    )*) => {
        $($crate::harness_function! { $(#[doc = $doc])* $kind $name $($bound)? $body })*

        /// The harnesses of this module.
        #[cfg(not(kani))]
        pub const HARNESSES: &[$crate::harness::Harness] = &[$($crate::harness::Harness {
            name: stringify!($name),
            module: module_path!(),
            counterexample: $crate::counterexample!($kind $($counterexample)?),
            body: $name,
        }),*];
    };
}

/// One harness: `holds` must hold, `fails` must not.
#[macro_export]
macro_rules! harness_function {
    ($(#[doc = $doc:literal])* holds $name:ident $bound:literal $body:block) => {
        $(#[doc = $doc])*
        #[cfg_attr(kani, kani::proof)]
        #[cfg_attr(kani, kani::unwind($bound))]
        pub fn $name() $body
    };
    ($(#[doc = $doc:literal])* fails $name:ident $bound:literal $body:block) => {
        $(#[doc = $doc])*
        #[cfg_attr(kani, kani::proof)]
        #[cfg_attr(kani, kani::unwind($bound))]
        #[cfg_attr(kani, kani::should_panic)]
        pub fn $name() $body
    };
    ($(#[doc = $doc:literal])* $kind:ident $name:ident $body:block) => {
        $crate::harness_function! { $(#[doc = $doc])* $kind $name 8 $body }
    };
}

/// The stored counterexample of a false twin; a harness that holds has none.
#[macro_export]
macro_rules! counterexample {
    (holds) => {
        None
    };
    (fails $values:expr) => {
        Some(&$values)
    };
}

#[cfg(not(kani))]
mod stand_in {
    use std::cell::{Cell, RefCell};
    use std::panic::{self, AssertUnwindSafe};
    use std::sync::Once;

    use crate::proof::sampler::Random;

    /// So many draws shall meet the assumptions of a harness, out of so many at most, and so many must.
    const ENOUGH: u32 = 5_000;
    const MOST: u32 = 50_000;
    const LEAST: u32 = 100;
    /// All values are run where they are no more than this.
    const ALL: u64 = 1 << 20;

    /// A harness: a function that asserts something about [`any`] values.
    #[derive(Clone, Copy)]
    pub struct Harness {
        /// Its name, which says the range.
        pub name: &'static str,
        /// The module in which it stands.
        pub module: &'static str,
        /// The values for which a false twin must panic; a number stands for the value of any type.
        pub counterexample: Option<&'static [f64]>,
        /// The function.
        pub body: fn(),
    }

    /// How a run that ended early ended.
    struct AssumptionFailed;

    /// Where [`any`] takes its values from.
    enum Source {
        Random(Random),
        /// In reverse order.
        Stored(Vec<f64>),
        All(Odometer),
    }

    /// One value after the other: for each time that a value is asked for, which one it is, of how many.
    #[derive(Default)]
    struct Odometer {
        digits: Vec<[u32; 2]>,
        asked: usize,
        /// A value of a type with too many was asked for.
        endless: bool,
    }

    impl Odometer {
        fn next<T: Any>(&mut self) -> T {
            self.endless |= T::COUNT.is_none();
            if self.asked == self.digits.len() {
                self.digits.push([0, T::COUNT.unwrap_or(1)]);
            }
            self.asked += 1;
            T::of_bits(u64::from(self.digits[self.asked - 1][0]))
        }

        fn is_endless(&self) -> bool {
            let cases = self.digits.iter().map(|[_, count]| u64::from(*count));
            self.endless || cases.fold(1, u64::saturating_mul) > ALL
        }

        /// Goes on to the next values; false where these were the last.
        fn step(&mut self) -> bool {
            self.digits.truncate(std::mem::take(&mut self.asked));
            while let Some([digit, count]) = self.digits.pop() {
                if digit + 1 < count {
                    self.digits.push([digit + 1, count]);
                    return true;
                }
            }
            false
        }
    }

    thread_local! {
        static SOURCE: RefCell<Source> = const { RefCell::new(Source::Stored(Vec::new())) };
        static RUNNING: Cell<bool> = const { Cell::new(false) };
    }

    /// How one run of a harness ended.
    enum End {
        Passed,
        NotAssumed,
        Panicked(String),
    }

    impl Harness {
        /// Its path in this crate, as the model checker prints it.
        pub fn path(&self) -> String {
            let module = self.module.split_once("::").map_or("", |(_, module)| module);
            format!("{module}::{}", self.name)
        }

        /// Runs it on all values if they are few, else on random draws; or a false twin on its counterexample.
        ///
        /// # Errors
        /// The message of a harness that panicked, a false twin that did not, or that no draw met the assumptions.
        pub fn run(&self) -> Result<String, String> {
            match self.counterexample {
                None => self.run_on_all().unwrap_or_else(|| self.run_on_draws()),
                Some(values) => self.run_on(values),
            }
        }

        /// Whether it holds on all values, and they are few enough to be run.
        pub fn is_decided(&self) -> bool {
            self.counterexample.is_none() && matches!(self.run_on_all(), Some(Ok(_)))
        }

        /// Nothing if there are too many values.
        fn run_on_all(&self) -> Option<Result<String, String>> {
            SOURCE.set(Source::All(Odometer::default()));
            let (mut cases, mut met) = (0, 0);
            loop {
                let end = self.run_once();
                let more = SOURCE.with_borrow_mut(|source| match source {
                    Source::All(odometer) => (!odometer.is_endless()).then(|| odometer.step()),
                    _ => None,
                })?;
                cases += 1;
                match end {
                    End::Passed => met += 1,
                    End::NotAssumed => {}
                    End::Panicked(why) => return Some(Err(format!("case {cases}: {why}"))),
                }
                if !more {
                    break;
                }
            }
            Some(match met {
                0 => Err("no value meets the assumptions".to_owned()),
                _ => Ok(format!("{met} of all {cases} cases meet the assumptions")),
            })
        }

        fn run_on_draws(&self) -> Result<String, String> {
            SOURCE.set(Source::Random(Random::new(crate::draws::seed())));
            let (mut draws, mut met) = (0, 0);
            let times = crate::draws::times();
            while met < times * ENOUGH && draws < times * MOST {
                match self.run_once() {
                    End::Passed => met += 1,
                    End::NotAssumed => {}
                    End::Panicked(why) => return Err(format!("draw {draws}: {why}")),
                }
                draws += 1;
            }
            let text = format!("{met} of {draws} random draws met the assumptions");
            if met < LEAST { Err(text) } else { Ok(text) }
        }

        fn run_on(&self, values: &[f64]) -> Result<String, String> {
            SOURCE.set(Source::Stored(values.iter().rev().copied().collect()));
            let end = self.run_once();
            let unused = SOURCE.with_borrow(|source| match source {
                Source::Stored(values) => values.len(),
                _ => 0,
            });
            match end {
                _ if unused > 0 => Err(format!("{unused} of the values {values:?} are not used")),
                End::Passed => Err(format!("{values:?} do not reject the planted mistake")),
                End::NotAssumed => Err(format!("{values:?} do not meet the assumptions")),
                End::Panicked(why) if why == TOO_FEW => Err(format!("{values:?}: {why}")),
                End::Panicked(_) => Ok(format!("rejected at {values:?}")),
            }
        }

        fn run_once(&self) -> End {
            quiet_panics();
            RUNNING.set(true);
            let result = panic::catch_unwind(AssertUnwindSafe(self.body));
            RUNNING.set(false);
            match result {
                Ok(()) => End::Passed,
                Err(why) if why.is::<AssumptionFailed>() => End::NotAssumed,
                Err(why) => End::Panicked(crate::claim::said(&*why)),
            }
        }
    }

    const TOO_FEW: &str = "the counterexample has too few values";

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

    /// Any value of a type: a random one (edge values and small numbers often), or the next one of a counterexample or of all.
    pub fn any<T: Any>() -> T {
        const EDGES: [f64; 7] = [0.0, -0.0, 1.0, -1.0, 5e-324, f64::MAX, f64::NAN];
        SOURCE.with_borrow_mut(|source| match source {
            Source::Random(random) => match random.below(4) {
                0 => T::of_bits(random.bits()),
                1 => T::of_number(EDGES[random.below(EDGES.len())]),
                2 => T::of_number(random.below(19) as f64 - 9.0),
                _ => T::of_number(random.below(2001) as f64 / 8.0 - 125.0),
            },
            Source::Stored(values) => match values.pop() {
                Some(value) => T::of_number(value),
                None => panic!("{TOO_FEW}"),
            },
            Source::All(odometer) => odometer.next(),
        })
    }

    /// A type of which [`any`] value can be asked for.
    pub trait Any: Sized {
        /// How many values it has, where they can all be run.
        const COUNT: Option<u32>;

        /// The value with these bits.
        fn of_bits(bits: u64) -> Self;

        /// The value that a number stands for: itself, or its nearest neighbour; false is 0.
        fn of_number(number: f64) -> Self;
    }

    macro_rules! any_of {
        ($($type:ty, $count:expr, $of_bits:expr, $of_number:expr;)*) => {
            $(impl Any for $type {
                const COUNT: Option<u32> = $count;

                fn of_bits(bits: u64) -> $type {
                    $of_bits(bits)
                }

                fn of_number(number: f64) -> $type {
                    $of_number(number)
                }
            })*
        };
    }

    any_of! {
        f64, None, f64::from_bits, |number| number;
        bool, Some(2), |bits| bits % 2 == 1, |number| number == 1.0;
        i8, Some(1 << 8), |bits| bits as i8, |number| number as i8;
        u8, Some(1 << 8), |bits| bits as u8, |number| number as u8;
        i16, None, |bits| bits as i16, |number| number as i16;
        usize, None, |bits| bits as usize, |number| number as usize;
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        fn holds(body: fn()) -> Result<String, String> {
            Harness { name: "test", module: "props", counterexample: None, body }.run()
        }

        fn fails(body: fn(), counterexample: &'static [f64]) -> Result<String, String> {
            let counterexample = Some(counterexample);
            Harness { name: "test", module: "props", counterexample, body }.run()
        }

        fn small() {
            let value: i8 = any();
            assume(value >= 0);
            assert!(value < 100, "small");
        }

        #[test]
        fn a_harness_whose_assumptions_contradict_each_other_is_an_error() {
            assert!(holds(|| assume(any::<i16>() as i32 > 100_000)).is_err());
            assert!(holds(|| assume(any::<i8>() as i32 > 1000)).is_err());
        }

        #[test]
        fn bits_and_bytes_are_run_through_and_a_single_exception_is_found() {
            fn all_but_one() {
                let (a, b): (i8, bool) = (any(), any());
                assert!(!b || a != -77, "-77");
            }
            fn ordered() {
                let (a, b): (u8, u8) = (any(), any());
                assume(a < b);
            }
            assert!(holds(all_but_one).unwrap_err().ends_with("-77"));
            let all = "32640 of all 65536 cases meet the assumptions";
            assert_eq!(holds(ordered), Ok(all.to_owned()));
        }

        #[test]
        fn a_false_harness_is_an_error_and_so_is_a_counterexample_that_rejects_nothing() {
            assert!(holds(small).unwrap_err().ends_with("small"));
            assert_eq!(fails(small, &[100.0]), Ok("rejected at [100.0]".to_owned()));
            for (values, why) in [
                (&[99.0] as &[f64], "do not reject the planted mistake"),
                (&[-1.0], "do not meet the assumptions"),
                (&[], TOO_FEW),
                (&[100.0, 1.0], "not used"),
            ] {
                let error = fails(small, values).unwrap_err();
                assert!(error.contains(why), "{error}");
            }
        }
    }
}
