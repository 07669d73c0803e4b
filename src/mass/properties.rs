//! Volume, centre of mass and inertia from moments, each with its error.

use glam::{DMat3, DVec3};

use super::eigen::eigen;
use super::moments::{COUNT, Estimate, Moments, VOLUME, second};

/// Standard deviations of the stated error: 99 % of normally distributed errors are below.
const CONFIDENCE: f64 = 2.576;
/// A number and what it may be wrong by, with a confidence of 99 %.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// ≥ 0.
    pub error: f64,
}

/// What a solid weighs and how it turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Properties {
    /// Cubic world units.
    pub volume: Measured,
    /// The integral of the density over it.
    pub mass: Measured,
    /// World space.
    pub center: [Measured; 3],
    /// About the centre of mass, along the world's axes: xx, yy, zz, yz, zx, xy. Those beside the
    /// diagonal are −∫yz and so on.
    pub inertia: [Measured; 6],
    /// Principal moments, in rising order.
    pub principal: [Measured; 3],
    /// Their unit axes in world space, right-handed. Of equal moments, any.
    pub axes: [DVec3; 3],
}

/// Where a solid's own frame is: `world = rotation · own + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) rotation: DMat3,
    pub(super) translation: DVec3,
    /// Half of the sides of the box around the solid, which is about the origin.
    pub(super) half: DVec3,
    /// What rounding makes of sums, relative to what is summed.
    pub(super) rounding: f64,
}

/// A number that is linear in the moments, near where they are.
#[derive(Clone, Copy)]
struct Linear {
    value: f64,
    gradient: Moments,
}

impl Linear {
    const ZERO: Linear = Linear { value: 0.0, gradient: [0.0; COUNT] };

    fn moment(mean: &Moments, index: usize) -> Linear {
        let mut gradient = [0.0; COUNT];
        gradient[index] = 1.0;
        Linear { value: mean[index], gradient }
    }

    fn plus(self, factor: f64, other: Linear) -> Linear {
        let gradient = std::array::from_fn(|k| self.gradient[k] + factor * other.gradient[k]);
        Linear { value: self.value + factor * other.value, gradient }
    }

    /// The product of two numbers, to first order.
    fn times(self, other: Linear) -> Linear {
        let gradient = std::array::from_fn(|k| {
            self.value * other.gradient[k] + other.value * self.gradient[k]
        });
        Linear { value: self.value * other.value, gradient }
    }

    fn inverse(self) -> Linear {
        let value = 1.0 / self.value;
        Linear { value, gradient: self.gradient.map(|g| -g * value * value) }
    }

    /// With its error; that of `rounding` is part of it.
    fn measured(self, estimate: &Estimate, rounding: f64) -> Measured {
        let error = CONFIDENCE * estimate.variance(&self.gradient).sqrt() + rounding;
        Measured { value: self.value, error }
    }
}

/// The properties of a solid from the moments about its frame's origin; `None` if it has no volume.
pub(super) fn properties(estimate: &Estimate, frame: &Frame) -> Option<Properties> {
    let Frame { rotation, translation, half, rounding } = *frame;
    let mean = &estimate.mean;
    let (mass, volume) = (Linear::moment(mean, 0), Linear::moment(mean, VOLUME));
    let is_positive = |x: Linear| x.value > 0.0;
    if !is_positive(volume) || !is_positive(mass) {
        return None;
    }
    let per_mass = mass.inverse();
    let own: [Linear; 3] =
        std::array::from_fn(|axis| Linear::moment(mean, 1 + axis).times(per_mass));
    let reach = rounding * half.length();
    let size = rounding * mass.value * half.length_squared();
    let center = std::array::from_fn(|axis| {
        let turned = (0..3).fold(Linear::ZERO, |sum, k| sum.plus(rotation.row(axis)[k], own[k]));
        let mut center = turned.measured(estimate, reach);
        center.value += translation[axis];
        center.error += f64::EPSILON * translation[axis].abs();
        center
    });
    let tensor = inertia(mean, &own, rotation);
    let measured = |a: usize, b: usize| tensor[a][b].measured(estimate, size);
    let matrix = DMat3::from_cols_array_2d(&tensor.map(|row| row.map(|x| x.value)));
    let (values, axes) = eigen(matrix);
    // No principal moment moves by more than the tensor does (Weyl).
    let variance = tensor.iter().flatten().map(|x| estimate.variance(&x.gradient)).sum::<f64>();
    let error = CONFIDENCE * variance.sqrt() + size;
    Some(Properties {
        volume: volume.measured(estimate, rounding * volume.value),
        mass: mass.measured(estimate, rounding * mass.value),
        center,
        inertia: [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)].map(|(a, b)| measured(a, b)),
        principal: values.to_array().map(|value| Measured { value, error }),
        axes: [axes.x_axis, axes.y_axis, axes.z_axis],
    })
}

/// The inertia tensor about the centre of mass, along the world's axes.
fn inertia(mean: &Moments, own: &[Linear; 3], rotation: DMat3) -> [[Linear; 3]; 3] {
    // Second moments about the centre of mass.
    let central = |a: usize, b: usize| {
        let shift = own[a].times(own[b]).times(Linear::moment(mean, 0));
        Linear::moment(mean, second(a, b)).plus(-1.0, shift)
    };
    let trace = (0..3).fold(Linear::ZERO, |sum, a| sum.plus(1.0, central(a, a)));
    let own_tensor: [[Linear; 3]; 3] = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let diagonal = if a == b { trace } else { Linear::ZERO };
            diagonal.plus(-1.0, central(a.min(b), a.max(b)))
        })
    });
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let mut sum = Linear::ZERO;
            for (i, row) in own_tensor.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    sum = sum.plus(rotation.row(a)[i] * rotation.row(b)[j], *entry);
                }
            }
            sum
        })
    })
}
