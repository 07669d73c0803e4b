//! Pictures of the window for the eye, in sizes, zooms and themes.
