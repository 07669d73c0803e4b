//! Where a line enters and leaves a solid: sorted lists of parameters, always an even number.

use super::primitive::Start;

/// Most crossings of a closed form: two intervals, and one of no width for a ray that grazes the
/// surface that it starts on.
const MOST: usize = 6;

/// The parameters at which a line enters (even places) and leaves (odd places) a solid.
///
/// # Invariants
/// `ends[..count]` is sorted, `count` is even, no number is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spans {
    ends: [f64; MOST],
    count: usize,
}

impl Spans {
    /// The line misses.
    pub(super) const NONE: Spans = Spans { ends: [0.0; MOST], count: 0 };

    /// Adds an interval beyond all others. An empty one is left out, and one without width, but for
    /// that of a ray that grazes the surface that it starts on; so is a number that is none.
    #[inline(always)]
    pub(super) fn push(&mut self, enter: f64, leave: f64) {
        let grazes = enter == 0.0 && leave == 0.0;
        if (enter < leave || grazes) && self.count + 2 <= MOST {
            self.ends[self.count] = enter;
            self.ends[self.count + 1] = leave;
            self.count += 2;
        }
    }

    /// The crossings.
    #[inline(always)]
    pub(super) fn ends(&self) -> &[f64] {
        &self.ends[..self.count.min(MOST)]
    }

    /// Makes 0 the crossing on which a ray starts.
    pub(super) fn start_on_surface(&mut self, start: Start) {
        match own_place(self.ends(), start) {
            Place::At(index) => self.ends[index] = 0.0,
            Place::New(index) => {
                self.ends.copy_within(index..self.count, index + 2);
                self.ends[index..index + 2].fill(0.0);
                self.count += 2;
            }
            Place::Nowhere => {}
        }
    }
}

/// The same in a list of any length.
pub(super) fn start_on_surface(ends: &mut Vec<f64>, begin: usize, start: Start) {
    match own_place(&ends[begin..], start) {
        Place::At(index) => ends[begin + index] = 0.0,
        Place::New(index) => {
            ends.splice(begin + index..begin + index, [0.0; 2]);
        }
        Place::Nowhere => {}
    }
}

/// Which crossing of a line is the one that a ray on it starts on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// It starts elsewhere.
    Nowhere,
    /// The one with this index.
    At(usize),
    /// Rounding lost it: an interval without width belongs here.
    New(usize),
}

/// A ray that goes in starts where the line enters, one that goes out where it leaves: parity tells
/// which of the two crossings around 0 it is, however far rounding moved it.
fn own_place(ends: &[f64], start: Start) -> Place {
    let odd = match start {
        Start::Elsewhere => return Place::Nowhere,
        Start::Inside => 0,
        Start::Outside => 1,
    };
    let zero = ends.iter().enumerate().find(|(index, t)| index % 2 == odd && **t == 0.0);
    if let Some((index, _)) = zero {
        return Place::At(index);
    }
    let behind = ends.iter().take_while(|t| **t <= 0.0).count();
    if behind % 2 != odd && behind > 0 {
        Place::At(behind - 1)
    } else if behind % 2 == odd && behind < ends.len() {
        Place::At(behind)
    } else {
        Place::New(behind)
    }
}

/// Where a line is between two parallel planes: the interval from the first plane to the last, in the
/// coordinate across them. `None` of a line that runs along them outside; the planes belong to it.
#[inline(always)]
pub(super) fn slab([low, high]: [f64; 2], o: f64, d: f64) -> Option<(f64, f64)> {
    if d == 0.0 {
        return (low <= o && o <= high).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((low - o) / d, (high - o) / d);
    Some(if d > 0.0 { (a, b) } else { (b, a) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crossing_that_a_ray_starts_on_follows_from_parity() {
        let of = |ends: &[f64], start| {
            let mut list = vec![7.0];
            list.extend(ends);
            start_on_surface(&mut list, 1, start);
            let mut spans = Spans::NONE;
            ends.chunks(2).for_each(|pair| spans.push(pair[0], pair[1]));
            spans.start_on_surface(start);
            assert_eq!((spans.ends(), list[0]), (&list[1..], 7.0));
            list.split_off(1)
        };
        for noise in [-1e-17, 0.0, 1e-17] {
            assert_eq!(of(&[noise, 3.0], Start::Inside), [0.0, 3.0]);
            assert_eq!(of(&[-3.0, noise], Start::Outside), [-3.0, 0.0]);
            assert_eq!(of(&[-4.0, -3.0, noise, 2.0], Start::Inside), [-4.0, -3.0, 0.0, 2.0]);
            assert_eq!(of(&[-1.0, noise, 2.0, 4.0], Start::Outside), [-1.0, 0.0, 2.0, 4.0]);
            assert_eq!(of(&[noise, 3.0], Start::Elsewhere), [noise, 3.0]);
        }
        // Lost by rounding.
        assert_eq!(of(&[], Start::Inside), [0.0, 0.0]);
        assert_eq!(of(&[1.0, 2.0], Start::Outside), [0.0, 0.0, 1.0, 2.0]);
    }
}
