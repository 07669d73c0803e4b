//! Reads scene text; every mistake is reported with its place and a way out.
