//! Writes a scene as text that reads back as the same value.
