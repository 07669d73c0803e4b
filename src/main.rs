//! The `rayforest` program.

fn main() {}
