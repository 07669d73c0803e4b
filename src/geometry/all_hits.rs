//! Every crossing of a ray with all there is, in order: what measures solids from inside.

use fearless_simd::Simd;

use super::query::Query;
use super::{Geometry, Hit, Ray, Stack};

/// Notes everything.
struct All<'a>(&'a mut Vec<Hit>);

impl Query for All<'_> {
    const ALL: bool = true;

    #[inline(always)]
    fn limit(&self) -> f64 {
        f64::INFINITY
    }

    #[inline(always)]
    fn offer(&mut self, t: f64, primitive: u32) {
        self.0.push(Hit { t, primitive });
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        false
    }
}

impl Geometry {
    /// Every crossing at `t > 0` of a ray that starts on no surface, sorted by `t`, then by primitive.
    /// Two of one primitive at one `t`, where the ray but touches it, are left out.
    #[inline(always)]
    pub fn all_hits<S: Simd>(&self, simd: S, stack: &mut Stack, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.traverse(simd, stack, ray, None, &mut All(hits));
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
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
