//! The integration tests, one binary.

mod truth; // the picture against other ways to know it
