//! The number types of the engines: exact rationals, magnitudes for the bounds of rounding errors, and
//! integers for the model checker.

/// Makes a `Copy` type with `From<i32>` and `PartialEq` a number of the kernel: by its operators, and by whether a number is at
/// most 0.
macro_rules! number {
    ($number:ty: + $add:expr; - $sub:expr; * $mul:expr; / $div:expr; neg $neg:expr; nonpositive $nonpositive:expr;) => {
        number!(@operator $number, Add add $add);
        number!(@operator $number, Sub sub $sub);
        number!(@operator $number, Mul mul $mul);
        number!(@operator $number, Div div $div);

        impl std::ops::Neg for $number {
            type Output = $number;

            fn neg(self) -> $number {
                let work: fn($number) -> $number = $neg;
                work(self)
            }
        }

        signorini::entry_of_nalgebra!($number);

        impl signorini::kernel::Scalar for $number {
            fn split(
                self,
                nonpositive: impl FnOnce($number) -> $number,
                positive: impl FnOnce($number) -> $number,
            ) -> $number {
                let is_nonpositive: fn($number) -> bool = $nonpositive;
                if is_nonpositive(self) { nonpositive(self) } else { positive(self) }
            }
        }
    };
    (@operator $number:ty, $operator:ident $function:ident $work:expr) => {
        impl std::ops::$operator for $number {
            type Output = $number;

            fn $function(self, other: $number) -> $number {
                let work: fn($number, $number) -> $number = $work;
                work(self, other)
            }
        }
    };
}
pub(crate) use number;

#[cfg(not(kani))]
pub mod exact;
#[cfg(not(kani))]
pub mod magnitude;
pub mod whole;

#[cfg(not(kani))]
pub use exact::Exact;
#[cfg(not(kani))]
pub use magnitude::Magnitude;
pub use whole::Whole;
