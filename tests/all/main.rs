//! The integration tests, one binary.

#[cfg(test)]
mod broken; // files that are not what they should be
#[cfg(test)]
mod exact; // bit for bit, whatever the edits, threads and memory
#[cfg(test)]
mod faces; // what a person or a script sees
mod truth; // the picture against other ways to know it
