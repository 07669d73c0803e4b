//! Rayforest traces a scene once, keeps every pixel's ray tree, and from then on re-evaluates only
//! the shading.
//!
//! The road of the data, each arrow one function that takes `&` of its left and gives its right:
//!
//! ```text
//! scene text → Scene → Geometry → grow → Forest → fold → Transport → shade → Film → develop → file
//! ```
//!
//! The `mod` list below is the map. It stands in the order of the floors, ground first: **a file
//! names only modules of floors below its own** (and its own module's files); a test reads this list
//! and the `use` paths and holds every file to it.

// ground
pub mod color;
pub mod math;
pub mod progress;
// what the user wrote
pub mod scene;
// what the eye gets
pub mod film;
// ready for rays
pub mod geometry;
// ray trees
pub mod forest;
// trees to transport
pub mod fold;
// parameters and transport to light
pub mod shade;
// the program without a face
pub mod session;
// faces
pub mod bench;
pub mod cli;
