//! Measures rays alone: how many of each kind one thread answers, and what the hierarchy gains as
//! primitives grow in number.

use std::hint::black_box;

use fearless_simd::{Simd, dispatch};
use glam::{DVec3, dvec3};
use serde_json::{Value, json};

use super::Spread;
use crate::clock::thread_seconds;
use crate::forest::camera::View;
use crate::geometry::{Geometry, Hit, Interaction, Leaving, Ray, Stack};
use crate::progress::Progress;
use crate::scene::{LightPlace, Scene, Shape, Solid};

/// Times that a batch of rays is asked.
const RUNS: usize = 7;
/// Rays into a cloud of spheres.
const INTO_CLOUD: u32 = 20_000;
/// Largest cloud of which every sphere is asked, and the number of rays that do.
const MOST_ASKED: u32 = 100_000;
const RAYS_FOR_ALL: usize = 50;

/// A ray and the surface that it leaves.
type Start = (Ray, Option<Leaving>);

/// Million rays per second of processor time of one thread, by kind, and the time of building.
///
/// Camera rays go through the middles of the pixels, in tiles; mirror and shadow rays leave the points
/// that those meet, whatever their materials, mirror rays once in that order and once shuffled. The
/// rows of all queries hold the answers' number: the same work on every machine.
pub fn measure(name: &str, scene: &Scene) -> Value {
    let before = thread_seconds();
    let geometry = build(scene);
    let build_s = thread_seconds() - before;
    let primary = primary(scene);
    let mut hits = Vec::new();
    let mut row = json!({
        "scene": name, "primitives": geometry.primitives(), "build_s": build_s,
        "geometry_mb": geometry.bytes() as f64 / 1e6,
        "primary": rate(primary.len(), || hits = closest(&geometry, &primary)),
    });
    let stack = Stack::new(&geometry);
    let met: Vec<(Ray, Interaction)> = primary
        .iter()
        .zip(&hits)
        .filter_map(|((ray, _), hit)| Some((*ray, geometry.interaction(&stack, ray, (*hit)?))))
        .collect();
    let mut mirrored: Vec<Start> = met.iter().map(|(ray, at)| mirror(&geometry, ray, at)).collect();
    row["hits"] = json!(met.len());
    row["mirror"] = rate(mirrored.len(), || _ = black_box(closest(&geometry, &mirrored)));
    shuffle(&mut mirrored);
    row["mirror_shuffled"] = rate(mirrored.len(), || _ = black_box(closest(&geometry, &mirrored)));
    let shadow = shadows(scene, &geometry, &met);
    let mut blocked = 0;
    row["shadow"] = rate(shadow.len(), || blocked = occluded(&geometry, &shadow));
    row["blocked"] = json!(blocked);
    row
}

/// For clouds of 10 … 10^`largest` spheres of constant density: nanoseconds per ray with the hierarchy and
/// by asking every sphere, and the time of building.
pub fn growth(largest: u32) -> Value {
    let mut rows = Vec::new();
    for exponent in 1..=largest {
        let count = 10u32.pow(exponent);
        let scene = cloud(count);
        let before = thread_seconds();
        let geometry = build(&scene);
        let build_s = thread_seconds() - before;
        let rays: Vec<Start> = (0..INTO_CLOUD).map(|i| (into_cloud(i), None)).collect();
        let nanoseconds = |count: usize, job: &mut dyn FnMut()| 1e9 * median(job) / count as f64;
        let with = nanoseconds(rays.len(), &mut || _ = black_box(closest(&geometry, &rays)));
        let some = &rays[..RAYS_FOR_ALL];
        let without = (count <= MOST_ASKED).then(|| {
            let ask = |(ray, _): &Start| geometry.closest_hit_of_all(ray);
            nanoseconds(some.len(), &mut || {
                some.iter().for_each(|start| _ = black_box(ask(start)));
            })
        });
        rows.push(json!({
            "spheres": count, "build_s": build_s, "ns_per_ray": with,
            "ns_per_ray_asking_all": without, "gain": without.map(|without| without / with),
        }));
    }
    json!({ "hierarchy": rows })
}

/// A few lines for people.
pub fn summary(row: &Value) -> String {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    if let Some(rows) = row["hierarchy"].as_array() {
        let line = |row: &Value| {
            format!(
                "\n  {:>7} spheres: built in {:.3} s, {:.0} ns a ray, {:.0} by asking all",
                row["spheres"],
                number(&row["build_s"]),
                number(&row["ns_per_ray"]),
                number(&row["ns_per_ray_asking_all"]),
            )
        };
        return format!("the hierarchy:{}", rows.iter().map(line).collect::<String>());
    }
    format!(
        "{}: {} primitives, built in {:.3} s; M rays/s of one thread: primary {:.1}, mirror {:.1}, \
         shuffled {:.1}, shadow {:.1}",
        row["scene"].as_str().unwrap_or("?"),
        row["primitives"],
        number(&row["build_s"]),
        number(&row["primary"]["m_rays_per_s"]),
        number(&row["mirror"]["m_rays_per_s"]),
        number(&row["mirror_shuffled"]["m_rays_per_s"]),
        number(&row["shadow"]["m_rays_per_s"]),
    )
}

fn build(scene: &Scene) -> Geometry {
    Geometry::build(scene, &Progress::default()).expect("nobody cancels it")
}

/// Median processor time of several runs, in seconds.
fn median(job: &mut dyn FnMut()) -> f64 {
    let times = (0..RUNS).map(|_| {
        let before = thread_seconds();
        job();
        thread_seconds() - before
    });
    Spread::of(times.collect()).median
}

fn rate(count: usize, mut job: impl FnMut()) -> Value {
    json!({ "rays": count, "m_rays_per_s": count as f64 / median(&mut job) / 1e6 })
}

/// One ray through the middle of every pixel, tile by tile.
fn primary(scene: &Scene) -> Vec<Start> {
    const TILE: u32 = 8;
    let [width, height] = scene.picture.size;
    let view = View::new(&scene.camera, scene.picture.size);
    let tiles = |side: u32| (0..side).step_by(TILE as usize);
    let within = |start: u32, side: u32| start..(start + TILE).min(side);
    let mut rays = Vec::new();
    for (top, left) in tiles(height).flat_map(|top| tiles(width).map(move |left| (top, left))) {
        for y in within(top, height) {
            let ray = |x| (view.ray(f64::from(x) + 0.5, f64::from(y) + 0.5), None);
            rays.extend(within(left, width).map(ray));
        }
    }
    rays
}

fn mirror(geometry: &Geometry, ray: &Ray, at: &Interaction) -> Start {
    let normal = at.geometric_normal;
    let direction = ray.direction - normal * (2.0 * ray.direction.dot(normal));
    let (ray, leaving) = geometry.spawn(at, direction.normalize());
    (ray, Some(leaving))
}

/// Rays to the middles of all lights from the sides that face them.
fn shadows(scene: &Scene, geometry: &Geometry, met: &[(Ray, Interaction)]) -> Vec<(Start, f64)> {
    let mut rays = Vec::new();
    for (ray, at) in met {
        let outward = at.geometric_normal * -at.geometric_normal.dot(ray.direction).signum();
        for light in &scene.lights {
            let (direction, distance) = match &light.place {
                LightPlace::Direction(along) => (-along.normalize(), f64::INFINITY),
                place => {
                    let arm = place.anchor().unwrap_or_default() - at.point;
                    (arm.normalize_or_zero(), arm.length())
                }
            };
            if direction.dot(outward) > 0.0 {
                let (ray, leaving) = geometry.spawn(at, direction);
                rays.push(((ray, Some(leaving)), distance));
            }
        }
    }
    rays
}

/// A fixed disorder.
fn shuffle(rays: &mut [Start]) {
    let mut state = 7u64;
    for i in (1..rays.len()).rev() {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        rays.swap(i, (state >> 33) as usize % (i + 1));
    }
}

fn closest(geometry: &Geometry, rays: &[Start]) -> Vec<Option<Hit>> {
    #[inline(always)]
    fn all<S: Simd>(simd: S, geometry: &Geometry, rays: &[Start]) -> Vec<Option<Hit>> {
        // A loop, because a closure would be compiled without the vector instructions.
        let (mut stack, mut hits) = (Stack::new(geometry), Vec::with_capacity(rays.len()));
        for (ray, leaving) in rays {
            hits.push(geometry.closest_hit(simd, &mut stack, ray, *leaving));
        }
        hits
    }
    dispatch!(geometry.level(), simd => all(simd, geometry, rays))
}

/// How many of the rays something stands in the way of; all solids are taken for opaque.
fn occluded(geometry: &Geometry, rays: &[(Start, f64)]) -> usize {
    #[inline(always)]
    fn all<S: Simd>(simd: S, geometry: &Geometry, rays: &[(Start, f64)]) -> usize {
        let (mut stack, mut crossed) = (Stack::new(geometry), Vec::new());
        let opaque = vec![true; geometry.materials().len()];
        let mut blocked = 0;
        for ((ray, leaving), distance) in rays {
            let crossed = &mut crossed;
            let (stack, opaque) = (&mut stack, &opaque[..]);
            let blocker = geometry.occluded(simd, stack, ray, *distance, *leaving, opaque, crossed);
            blocked += usize::from(blocker.is_some());
        }
        blocked
    }
    dispatch!(geometry.level(), simd => all(simd, geometry, rays))
}

/// A point of the unit cube, the next of an even sequence (Roberts 2018, by powers of 1/1.22074…).
fn even(i: u32) -> DVec3 {
    let step = dvec3(0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3);
    (step * f64::from(i) + 0.5).fract()
}

/// Spheres in the unit cube, which take a twentieth of it.
fn cloud(count: u32) -> Scene {
    let radius = (0.05 / f64::from(count) * 0.75 / std::f64::consts::PI).cbrt();
    let sphere = |i| Solid::new(format!("s{i}"), Shape::Sphere { center: even(i), radius }, 0);
    Scene { solids: (0..count).map(sphere).collect(), ..crate::scene::Scene::default() }
}

/// From one face of the cube to another place in it.
fn into_cloud(i: u32) -> Ray {
    let (from, to) = (even(i).with_z(-1.0), even(i.wrapping_mul(7) + 3));
    Ray { origin: from, direction: (to - from).normalize() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hierarchy_and_asking_all_give_the_same() {
        let geometry = build(&cloud(300));
        let rays: Vec<Start> = (0..500).map(|i| (into_cloud(i), None)).collect();
        let all: Vec<_> = rays.iter().map(|(ray, _)| geometry.closest_hit_of_all(ray)).collect();
        assert!(all == closest(&geometry, &rays));
        assert!(all.iter().any(Option::is_some) && all.iter().any(Option::is_none));
    }

    #[test]
    fn growth_has_a_row_per_power_of_ten() {
        let row = growth(2);
        let spheres: Vec<_> = row["hierarchy"].as_array().unwrap().iter().collect();
        assert_eq!([&spheres[0]["spheres"], &spheres[1]["spheres"]], [10, 100]);
        assert!(spheres.iter().all(|row| row["gain"].as_f64().is_some_and(|gain| gain > 0.0)));
        assert!(summary(&row).contains("100 spheres: built in"));
    }

    #[test]
    fn every_pixel_has_one_ray_and_every_kind_a_number() {
        let scene = crate::document::Document::built_in().scene().clone();
        let scene = Scene {
            picture: crate::scene::Picture { size: [21, 13], ..Default::default() },
            ..scene
        };
        assert_eq!(primary(&scene).len(), 21 * 13);
        let row = measure("small", &scene);
        for kind in ["primary", "mirror", "mirror_shuffled", "shadow"] {
            assert!(row[kind]["m_rays_per_s"].as_f64().is_some_and(|rate| rate > 0.0), "{row}");
        }
        assert!(summary(&row).contains("small: "));
    }
}
