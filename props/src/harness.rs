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

    /// So many draws shall meet the assumptions of a harness,
    const ENOUGH: u32 = 20_000;
    /// out of so many at most,
    const MOST: u32 = 200_000;
    /// and so many must.
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
            let Some(count) = T::COUNT else {
                self.endless = true;
                return T::nth(0);
            };
            if self.asked == self.digits.len() {
                self.digits.push([0, count]);
            }
            self.asked += 1;
            T::nth(self.digits[self.asked - 1][0])
        }

        /// Whether there are too many values.
        fn is_endless(&self) -> bool {
            let cases = self.digits.iter().map(|[_, count]| u64::from(*count));
            self.endless || cases.fold(1, u64::saturating_mul) > ALL
        }

        /// The values after these; none if these were the last.
        fn step(&mut self) -> Option<()> {
            self.digits.truncate(std::mem::take(&mut self.asked));
            while let Some([digit, count]) = self.digits.pop() {
                if digit + 1 < count {
                    self.digits.push([digit + 1, count]);
                    return Some(());
                }
            }
            None
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

        /// Its name for what it is when it runs on random draws: not for all, but for random numbers.
        pub fn name_on_draws(&self) -> String {
            self.name.replace("_for_all_", "_for_random_")
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
                let next = SOURCE.with_borrow_mut(|source| match source {
                    Source::All(odometer) if odometer.is_endless() => None,
                    Source::All(odometer) => Some(odometer.step().is_some()),
                    _ => None,
                });
                let more = next?;
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
                _ if met == cases => Ok(format!("all {cases} cases")),
                _ => Ok(format!("all {met} cases that meet the assumptions")),
            })
        }

        fn run_on_draws(&self) -> Result<String, String> {
            SOURCE.set(Source::Random(Random::new(crate::draws::seed())));
            let (mut draws, mut met) = (0, 0);
            while met < ENOUGH && draws < MOST {
                match self.run_once() {
                    End::Passed => met += 1,
                    End::NotAssumed => {}
                    End::Panicked(why) => return Err(format!("draw {draws}: {why}")),
                }
                draws += 1;
            }
            match met {
                0 => Err("no draw met the assumptions".to_owned()),
                _ if met < LEAST => Err(format!("only {met} of {draws} draws met the assumptions")),
                _ if met == draws => Ok(format!("{met} random draws")),
                _ => Ok(format!(
                    "{met} random draws, of {draws} that did not all meet the assumptions"
                )),
            }
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

    /// Any value of a type: here, a random one or the next one of a counterexample.
    pub fn any<T: Any>() -> T {
        SOURCE.with_borrow_mut(|source| match source {
            Source::Random(random) => T::draw(random),
            Source::Stored(values) => match values.pop() {
                Some(value) => T::from_number(value),
                None => panic!("{TOO_FEW}"),
            },
            Source::All(odometer) => odometer.next(),
        })
    }

    /// A type of which [`any`] value can be asked for.
    pub trait Any: Sized {
        /// How many values it has, where they can all be run.
        const COUNT: Option<u32>;

        /// Value number `n`.
        fn nth(n: u32) -> Self {
            Self::from_number(f64::from(n))
        }

        /// A random value, edge values often.
        fn draw(random: &mut Random) -> Self;

        /// The value that a number stands for: itself, and 0 and 1 for false and true.
        fn from_number(number: f64) -> Self;
    }

    impl Any for f64 {
        const COUNT: Option<u32> = None;

        fn draw(random: &mut Random) -> f64 {
            const EDGES: [f64; 7] = [0.0, -0.0, 1.0, -1.0, 5e-324, f64::MAX, f64::NAN];
            match random.below(4) {
                0 => EDGES[random.below(EDGES.len())],
                1 => f64::from_bits(random.bits()),
                _ => random.below(2001) as f64 / 8.0 - 125.0,
            }
        }

        fn from_number(number: f64) -> f64 {
            number
        }
    }

    impl Any for bool {
        const COUNT: Option<u32> = Some(2);

        fn draw(random: &mut Random) -> bool {
            random.below(2) == 0
        }

        fn from_number(number: f64) -> bool {
            number == 1.0
        }
    }

    macro_rules! any_integer {
        ($($type:ty),*) => {
            $(impl Any for $type {
                const COUNT: Option<u32> =
                    if <$type>::BITS == 8 { Some(1 << <$type>::BITS) } else { None };

                fn nth(n: u32) -> $type {
                    n as $type
                }

                fn draw(random: &mut Random) -> $type {
                    match random.below(3) {
                        0 => random.below(9) as $type,
                        1 => (0 as $type).wrapping_sub(random.below(9) as $type),
                        _ => random.bits() as $type,
                    }
                }

                fn from_number(number: f64) -> $type {
                    number as $type
                }
            })*
        };
    }

    any_integer!(i8, u8, i16, i32, u32, usize);

    #[cfg(test)]
    mod tests {
        use super::*;

        fn holds(body: fn()) -> Result<String, String> {
            Harness { name: "test", module: "props", counterexample: None, body }.run()
        }

        fn fails(body: fn(), counterexample: &'static [f64]) -> Result<String, String> {
            Harness { name: "test", module: "props", counterexample: Some(counterexample), body }
                .run()
        }

        fn small() {
            let value: i8 = any();
            assume(value >= 0);
            assert!(value < 100, "small");
        }

        #[test]
        fn a_harness_whose_assumptions_contradict_each_other_is_an_error() {
            let contradiction = holds(|| assume(any::<i16>() as i32 > 100_000));
            assert_eq!(contradiction, Err("no draw met the assumptions".to_owned()));
            let contradiction = holds(|| assume(any::<i8>() as i32 > 1000));
            assert_eq!(contradiction, Err("no value meets the assumptions".to_owned()));
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
            assert_eq!(holds(ordered), Ok("all 32640 cases that meet the assumptions".to_owned()));
            fn three_bits() {
                let _: (bool, bool, bool) = (any(), any(), any());
            }
            assert_eq!(holds(three_bits), Ok("all 8 cases".to_owned()));
            fn three_bytes() {
                let _: (u8, u8, u8) = (any(), any(), any());
            }
            assert_eq!(holds(three_bytes), Ok("20000 random draws".to_owned()));
        }

        #[test]
        fn a_false_harness_is_an_error_and_its_counterexample_rejects_it() {
            assert!(holds(small).unwrap_err().ends_with("small"));
            assert_eq!(fails(small, &[100.0]), Ok("rejected at [100.0]".to_owned()));
        }

        #[test]
        fn a_counterexample_that_rejects_nothing_is_an_error() {
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
