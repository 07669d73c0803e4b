//! The integration tests, one binary.

#[cfg(test)]
mod exact;
#[cfg(test)]
mod faces;
