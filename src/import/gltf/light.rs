//! Lights of KHR_lights_punctual.

use std::f64::consts::PI;

use glam::{DMat4, DVec3};

use super::json::Json;
use crate::color::Rgb;
use crate::import::job::Job;
use crate::import::place::ImportError;
use crate::scene::{Light, LightPlace, fields};

/// A light of the file where its node puts it: it shines along -z.
///
/// A surface of albedo ρ that faces a light of E lux shows ρ·E/π; here it shows diffuse · intensity.
/// So a direction's intensity is E/π, and that of I candela is I/π at a distance of 1 (`falloff`).
pub(super) fn light(
    job: &mut Job<'_>,
    light: &Json<'_>,
    world: DMat4,
    number: usize,
) -> Result<Light, ImportError> {
    let at = world.transform_point3(DVec3::ZERO);
    let along = world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
    let kind = light.need("type")?;
    let (place, falloff) = match kind.text()? {
        "directional" => (LightPlace::Direction(along), 0.0),
        "point" => (LightPlace::Point(at), 1.0),
        "spot" => (spot(light, at, along)?, 1.0),
        other => return Err(kind.error(format!("there is no light of type `{other}`"))),
    };
    if let Some(range) = light.get("range") {
        job.note(range.at(), "`range` is left out: light reaches everything in its way");
    }
    let color = light.numbers("color")?.unwrap_or([1.0; 3]);
    let intensity = light.number_or("intensity", 1.0)? / PI;
    let coefficient = |x: f64| fields::COEFFICIENT.clamp(x) as f32;
    // Two nodes may show one light: names are given by number.
    let name = match light.name() {
        "" => format!("light {}", number + 1),
        name => format!("{name} {}", number + 1),
    };
    Ok(Light {
        color: Rgb(color.map(coefficient)),
        intensity: Rgb::grey(coefficient(intensity)),
        falloff,
        place,
        ..Light::new(name)
    })
}

fn spot(light: &Json<'_>, at: DVec3, along: DVec3) -> Result<LightPlace, ImportError> {
    let (inner, outer) = match light.get("spot") {
        Some(spot) => {
            (spot.number_or("innerConeAngle", 0.0)?, spot.number_or("outerConeAngle", PI / 4.0)?)
        }
        None => (0.0, PI / 4.0),
    };
    let outer = outer.clamp(1e-4, PI / 2.0);
    let edge = 1.0 - (inner / outer).clamp(0.0, 1.0);
    let towards = at + along;
    Ok(LightPlace::Spot { at, towards, angle_degrees: outer.to_degrees(), edge })
}
