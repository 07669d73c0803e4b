//! How many boxes or primitives a ray is tested against at once: sixteen where the processor's vectors
//! hold as many f32, eight elsewhere.

use fearless_simd::{Level, Simd, dispatch, f32x8, f32x16, prelude::*};

/// `N` lanes.
pub(super) struct Lanes<const N: usize>;

/// That a number of lanes has vectors.
pub(super) trait Width {
    /// A vector of f32; at a level with smaller ones it is several.
    type Floats<S: Simd>: SimdFloat<S, Element = f32>;
}

impl Width for Lanes<8> {
    type Floats<S: Simd> = f32x8<S>;
}

impl Width for Lanes<16> {
    type Floats<S: Simd> = f32x16<S>;
}

/// `N` numbers.
pub(super) type Floats<S, const N: usize> = <Lanes<N> as Width>::Floats<S>;

/// Whether there are sixteen lanes at a level, else eight; known when a level's code is compiled.
#[inline(always)]
pub(super) fn are_sixteen<S: Simd>(_: S) -> bool {
    <S::f32s as SimdBase<S>>::LEN >= 16
}

/// The same of a level that is known only now.
pub(super) fn has_sixteen(level: Level) -> bool {
    dispatch!(level, simd => are_sixteen(simd))
}
