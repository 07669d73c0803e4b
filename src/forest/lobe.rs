//! What a light's highlight is before its exponent: pure functions of directions, one per model.
//!
//! A highlight's coefficient is `scale · Σ weight · 2^(exponent · l)`, with `exponent` and `scale`
//! from the material alone ([`Peak`](crate::scene::model::Peak)): here are `weight` and the angle
//! that l is a function of. Directions are of length 1 and point away from the surface.

use glam::DVec3;

use crate::scene::model::Model;

/// The geometry of one light's highlight at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// What [`Peak::measure`](crate::scene::model::Peak) says: 1 − cos β, or tan² α.
    pub angle: f32,
    /// What multiplies the power: ≥ 0, and 0 where no exponent gives a highlight.
    pub weight: f32,
}

impl Lobe {
    /// No highlight.
    pub const NONE: Lobe = Lobe { angle: 1.0, weight: 0.0 };

    /// A power of 1 − `x`, whose base must be a positive cosine.
    #[inline(always)]
    fn of_cosine(x: f64, weight: f64) -> Lobe {
        let lobe = Lobe { angle: x as f32, weight: weight as f32 };
        let sound = lobe.angle < 1.0 && lobe.weight > 0.0 && lobe.weight.is_finite();
        if sound { lobe } else { Lobe::NONE }
    }
}

/// The directions at a lit point, all of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lit {
    /// N: the shading normal, on the eye's side.
    pub normal: DVec3,
    /// V.
    pub to_eye: DVec3,
    /// L.
    pub to_light: DVec3,
}

/// Where −tan² α · log2 e falls below the flush of powers for every slope up to 1.
const STEEPEST: f64 = 60.0 * std::f64::consts::LN_2;
/// N·V and N·L of Cook-Torrance below which nothing is shown: its highlight has a pole at 0.
const GRAZING: f64 = 1e-6;

/// The highlight of a light in front of a surface, `eta` = index in front / index behind.
/// None where N·L ≤ 0, where the halfway vector H is undefined, and for directions that are no
/// numbers.
#[inline(always)]
pub fn highlight(model: Model, lit: &Lit, eta: f64) -> Lobe {
    let n_dot_l = lit.normal.dot(lit.to_light);
    if n_dot_l <= 0.0 {
        return Lobe::NONE;
    }
    if model == Model::Phong {
        let mirrored = lit.normal * (2.0 * n_dot_l) - lit.to_light;
        return Lobe::of_cosine((mirrored - lit.to_eye).length_squared() / 2.0, 1.0);
    }
    let half = (lit.to_light + lit.to_eye).normalize_or_zero();
    if half == DVec3::ZERO {
        return Lobe::NONE;
    }
    let from_peak = (half - lit.normal).length_squared() / 2.0;
    match model {
        Model::Phong | Model::Blinn => Lobe::of_cosine(from_peak, 1.0),
        Model::Hall => Lobe::of_cosine(from_peak, fresnel(lit.to_eye.dot(half), eta)),
        Model::CookTorrance => facets(*lit, half, n_dot_l, eta),
    }
}

/// Cook-Torrance without its slope: tan² α between N and H, and F·G / (4 N·V cos⁴ α).
///
/// G is the shadowing of V-shaped grooves, which does not depend on the slope. Cook & Torrance,
/// "A Reflectance Model for Computer Graphics" (1982), with 4 in place of their π.
fn facets(lit: Lit, half: DVec3, n_dot_l: f64, eta: f64) -> Lobe {
    let n_dot_h = lit.normal.dot(half);
    let n_dot_v = lit.normal.dot(lit.to_eye);
    let v_dot_h = lit.to_eye.dot(half);
    if n_dot_h <= 0.0 || n_dot_v < GRAZING || n_dot_l < GRAZING {
        return Lobe::NONE;
    }
    let cosine2 = n_dot_h * n_dot_h;
    // By the sine, which keeps small angles.
    let tangent2 = lit.normal.cross(half).length_squared() / cosine2;
    let groove = 2.0 * n_dot_h * n_dot_v.min(n_dot_l) / v_dot_h;
    let f_g = fresnel(v_dot_h, eta) * groove.min(1.0);
    let weight = (f_g / (4.0 * n_dot_v * cosine2 * cosine2)) as f32;
    let sound = tangent2 < STEEPEST && weight > 0.0 && weight.is_finite();
    if sound { Lobe { angle: tangent2 as f32, weight } } else { Lobe::NONE }
}

/// Hall's transmitted highlight of a light behind a surface: T·L and 1 − F(N·V), `through` = T being
/// the direction of the refracted ray, with N·V and index in front / index behind.
///
/// Out of line: inlined, F would be computed at every node before its lights.
#[inline(never)]
pub fn transmitted(through: DVec3, to_light: DVec3, (cosine, eta): (f64, f64)) -> Lobe {
    let weight = 1.0 - fresnel(cosine, eta);
    Lobe::of_cosine((through - to_light).length_squared() / 2.0, weight)
}

/// Fresnel's reflectance of unpolarised light at a dielectric, `cosine` in [0, 1] between ray and
/// normal, `eta` = index in front / index behind: 1 in total reflection, 0 where both are equal.
/// Exact up to rounding (Born & Wolf, Principles of Optics, 1.5).
#[inline(always)]
pub fn fresnel(cosine: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let sine2 = eta * eta * (1.0 - cosine * cosine);
    if sine2 >= 1.0 {
        return 1.0;
    }
    let behind = (1.0 - sine2).sqrt();
    let s = (eta * cosine - behind) / (eta * cosine + behind);
    let p = (cosine - eta * behind) / (cosine + eta * behind);
    (s * s + p * p) / 2.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn direction(degrees: f64, azimuth: f64) -> DVec3 {
        let (theta, phi) = (degrees.to_radians(), azimuth.to_radians());
        DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    }

    fn lit(to_eye: DVec3, to_light: DVec3) -> Lit {
        Lit { normal: DVec3::Z, to_eye, to_light }
    }

    /// A material's specular coefficient per light of intensity 1, in f64 from a lobe: exponent n of
    /// a cosine, or slope m of facets.
    fn power(lobe: Lobe, model: Model, n_or_m: f64) -> f64 {
        let (angle, weight) = (f64::from(lobe.angle), f64::from(lobe.weight));
        match model {
            Model::CookTorrance => {
                let slope = 1.0 / (n_or_m * n_or_m);
                weight * slope * (-angle * slope).exp()
            }
            _ => weight * (1.0 - angle).powf(n_or_m),
        }
    }

    /// ∫ highlight / π over the hemisphere of lights (a light of intensity 1 is an irradiance π, and
    /// the highlight does not hold N·L): the share of uniform light that comes back.
    fn albedo(model: Model, to_eye: DVec3, eta: f64, n_or_m: f64) -> f64 {
        let (rings, around) = (500, 400);
        let mut sum = 0.0;
        for i in 0..rings {
            // Equal steps of θ: fine enough for m = 0.1 with the midpoint rule.
            let theta = (i as f64 + 0.5) / rings as f64 * 90.0;
            let ring = theta.to_radians().sin();
            for j in 0..around {
                let to_light = direction(theta, (j as f64 + 0.5) / around as f64 * 360.0);
                sum += ring * power(highlight(model, &lit(to_eye, to_light), eta), model, n_or_m);
            }
        }
        sum * (PI / 2.0 / rings as f64) * (2.0 * PI / around as f64) / PI
    }

    /// F = 1 everywhere but for rounding.
    const MIRROR: f64 = 1e-9;

    #[test]
    fn cook_torrance_gives_back_what_is_known_of_a_perfect_metal() {
        for (degrees, expected) in [(0.0, 1.0), (45.0, 0.9999), (75.0, 0.970)] {
            let found = albedo(Model::CookTorrance, direction(degrees, 0.0), MIRROR, 0.1);
            assert!((found - expected).abs() < 6e-4, "{degrees}°: {found}");
        }
    }

    #[test]
    fn no_model_gives_back_more_than_it_gets() {
        for degrees in [0.0, 30.0, 60.0, 80.0] {
            let eye = direction(degrees, 20.0);
            for m in [0.1, 0.3, 1.0] {
                let facets = albedo(Model::CookTorrance, eye, MIRROR, m);
                assert!(facets <= 1.0 + 1e-3, "m {m}, {degrees}°: {facets}");
            }
        }
        // Phong's at right angles is 2 / (n + 1); every other n and angle gives less.
        for n in [1.0, 10.0, 100.0] {
            let facing = albedo(Model::Phong, DVec3::Z, 1.0 / 1.5, n);
            assert!((facing - 2.0 / (n + 1.0)).abs() < 1e-4, "n {n}: {facing}");
            assert!(albedo(Model::Phong, direction(60.0, 0.0), 1.0 / 1.5, n) <= facing + 1e-4);
            for degrees in [0.0, 60.0] {
                let eye = direction(degrees, 0.0);
                let blinn = albedo(Model::Blinn, eye, 1.0 / 1.5, 4.0 * n + 8.0);
                let hall = albedo(Model::Hall, eye, 1.0 / 1.5, 4.0 * n + 8.0);
                assert!(
                    blinn <= 1.0 && hall < blinn && hall > 0.0,
                    "{n} {degrees}: {blinn} {hall}"
                );
            }
        }
    }

    #[test]
    fn light_and_eye_may_change_places() {
        let model_is_symmetric = |model: Model, with_cosine: bool| {
            let mut worst = 0.0f64;
            for (a, b, turn) in [(10.0, 40.0, 30.0), (70.0, 20.0, 170.0), (55.0, 80.0, 260.0)] {
                let (v, l) = (direction(a, 0.0), direction(b, turn));
                let one = highlight(model, &lit(v, l), 1.0 / 1.5);
                let other = highlight(model, &lit(l, v), 1.0 / 1.5);
                // Cook-Torrance's highlight is the reflectance times N·L: 1/(N·V) is left of it.
                let (p, q) = if with_cosine { (v.z, l.z) } else { (1.0, 1.0) };
                let ratio = f64::from(one.weight) * p / (f64::from(other.weight) * q);
                let angles = f64::from(one.angle) - f64::from(other.angle);
                let empty = one == Lobe::NONE && other == Lobe::NONE;
                worst = worst.max(if empty { 0.0 } else { (ratio - 1.0).abs().max(angles.abs()) });
            }
            worst < 1e-6
        };
        assert!(model_is_symmetric(Model::Phong, false));
        assert!(model_is_symmetric(Model::Blinn, false));
        assert!(model_is_symmetric(Model::Hall, false));
        assert!(model_is_symmetric(Model::CookTorrance, true));
        // The judge can fail: without its cosine Cook-Torrance's is not symmetric.
        assert!(!model_is_symmetric(Model::CookTorrance, false));
    }

    #[test]
    fn glass_fresnel_is_its_closed_forms() {
        for n in [1.1, 1.33, 1.5, 2.42, 10.0] {
            let facing = ((n - 1.0) / (n + 1.0f64)).powi(2);
            assert!((fresnel(1.0, 1.0 / n) - facing).abs() < 1e-14);
            assert!((fresnel(1.0, n) - facing).abs() < 1e-14);
            assert!((fresnel(0.0, 1.0 / n) - 1.0).abs() < 1e-14);
            // At Brewster's angle, tan θ = n, all that is reflected is polarised one way.
            let brewster = 1.0 / (1.0 + n * n).sqrt();
            let polarised = ((n * n - 1.0) / (n * n + 1.0)).powi(2) / 2.0;
            assert!((fresnel(brewster, 1.0 / n) - polarised).abs() < 1e-14);
            for i in 1..100 {
                let cosine = f64::from(i) / 100.0;
                let behind = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt();
                let (out, back) = (fresnel(cosine, 1.0 / n), fresnel(behind, n));
                assert!((out - back).abs() < 1e-10, "n {n}, cos {cosine}: {out} {back}");
            }
            let critical = (1.0 - 1.0 / (n * n)).sqrt();
            assert_eq!(fresnel(critical - 1e-9, n), 1.0);
            assert!(fresnel(critical + 1e-9, n) < 1.0);
        }
        assert_eq!(fresnel(0.3, 1.0), 0.0);
        // By Fresnel's sines and tangents: (sin²(i−t)/sin²(i+t) + tan²(i−t)/tan²(i+t))/2.
        for n in [1.1, 1.33, 1.5, 2.42, 10.0] {
            for degrees in 1..90 {
                let i = f64::from(degrees).to_radians();
                let t = (i.sin() / n).asin();
                let s = (i - t).sin() / (i + t).sin();
                let p = (i - t).tan() / (i + t).tan();
                let off = (fresnel(i.cos(), 1.0 / n) - (s * s + p * p) / 2.0).abs();
                assert!(off < 1e-12, "{degrees}° into {n}: {off:e}");
            }
        }
    }

    #[test]
    fn hall_transmits_what_it_does_not_reflect() {
        let through = transmitted(-DVec3::Z, -DVec3::Z, (1.0, 1.5));
        assert_eq!(through, Lobe { angle: 0.0, weight: 0.96 });
        assert_eq!(transmitted(-DVec3::Z, DVec3::X, (1.0, 1.5)), Lobe::NONE);
        assert_eq!(transmitted(-DVec3::Z, -DVec3::Z, (0.1, 1.5)), Lobe::NONE);
    }

    #[test]
    fn degenerate_directions_have_no_highlight_and_no_nan() {
        let odd = [0.0, 1.0, -1.0, 1e-30, 1e30, 1e-9, f64::NAN, f64::INFINITY];
        let vectors = || odd.iter().flat_map(|&x| odd.map(|z| DVec3::new(x, 0.0, z)));
        let mut lit_up = 0;
        for to_light in vectors() {
            for to_eye in vectors() {
                for model in Model::ALL {
                    for eta in [1.0 / 1.5, 1.5, 1.0, 1e-9] {
                        let lobe = highlight(model, &lit(to_eye, to_light), eta);
                        assert!(lobe.angle.is_finite() && lobe.weight.is_finite(), "{lobe:?}");
                        assert!(lobe.weight >= 0.0, "{lobe:?}");
                        lit_up += usize::from(lobe.weight > 0.0);
                    }
                    let behind = transmitted(to_eye, to_light, (0.5, 1.5));
                    assert!(behind.angle.is_finite() && behind.weight.is_finite());
                }
            }
        }
        assert!(lit_up > 0);
        let flat = lit(DVec3::X, -DVec3::X);
        for model in Model::ALL {
            assert_eq!(highlight(model, &flat, 1.0 / 1.5), Lobe::NONE);
        }
    }
}
