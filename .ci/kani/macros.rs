//! The attributes of Kani that the harnesses use, with no effect: see kani.rs.

extern crate proc_macro;

use proc_macro::TokenStream;

macro_rules! attributes {
    ($($name:ident)*) => {
        $(#[proc_macro_attribute]
        pub fn $name(_: TokenStream, item: TokenStream) -> TokenStream {
            item
        })*
    };
}

attributes! { proof unwind should_panic }
