//! The fields of every part of a scene, listed once: names, ranges, and who may visit them.
