//! What editing a parameter will cost, known before it is touched.

/// The cost of setting one parameter to another value, all others staying as they are.
///
/// Values of a colour or per-channel coefficient are compared per channel: "up to x" holds if no
/// channel is above the larger of its present value and x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// Any value is a re-shade.
    Instant,
    /// A re-shade for values ≤ this, a trace for values above it.
    InstantUpTo(f64),
    /// A re-shade for values ≥ this, a trace for values below it.
    InstantDownTo(f64),
    /// Highlights are folded again, no ray is cast.
    Refold,
    /// Everything is traced.
    TraceAll,
}
