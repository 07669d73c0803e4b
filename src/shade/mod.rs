//! From parameters and the transport matrix to light: no ray is ever cast here.

pub mod cpu;
pub mod gpu;
pub mod terms;
