//! The command `signorini`.
fn main() {}
