//! Every crossing of a ray with all there is, in order: what measures solids from inside.

use fearless_simd::Simd;

use super::{Geometry, Ray, Stack};

impl Geometry {
    /// Every crossing at `t > 0`, with its primitive, of a ray that starts on no surface, sorted by `t`, then by primitive.
    /// Two of one primitive at one `t`, where the ray but touches it, are left out.
    #[inline(always)]
    pub fn all_hits<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: &Ray,
        hits: &mut Vec<(f64, u32)>,
    ) {
        self.crossings(simd, stack, ray, f64::INFINITY, None, hits);
        let mut kept = 0;
        for i in 0..hits.len() {
            if kept > 0 && hits[kept - 1] == hits[i] {
                kept -= 1;
            } else {
                hits[kept] = hits[i];
                kept += 1;
            }
        }
        hits.truncate(kept);
    }
}
