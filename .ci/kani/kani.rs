//! What the harnesses use of Kani's library, by its signatures: with it they are compiled as `cargo kani` compiles them, on
//! a machine without Kani. Nothing is checked but types and names.

pub use kani_macros::*;

pub trait Arbitrary {
    fn any() -> Self;
}

macro_rules! arbitrary {
    ($($type:ty)*) => {
        $(impl Arbitrary for $type {
            fn any() -> Self {
                unimplemented!("only Kani has a value")
            }
        })*
    };
}

arbitrary! { bool i8 u8 i16 u16 i32 u32 usize f64 }

impl<T: Arbitrary, const N: usize> Arbitrary for [T; N] {
    fn any() -> Self {
        std::array::from_fn(|_| T::any())
    }
}

pub fn any<T: Arbitrary>() -> T {
    T::any()
}

pub fn assume(condition: bool) {
    assert!(condition);
}
