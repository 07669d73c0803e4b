//! Where the handle of a light is in the picture, and where the light goes when the handle is moved.

use glam::{DVec2, DVec3, dvec2};

use crate::document::placing::tidy;
use crate::forest::camera::{Seen, View};
use crate::scene::{Camera, LightPlace};

/// Radius of the globe of directions, in parts of the picture's shorter side.
const GLOBE: f64 = 0.35;

/// Where a light is on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// Pixels from the upper left corner of the picture.
    pub(super) at: DVec2,
    /// Whether that is within the picture's edges.
    pub(super) inside: bool,
    /// For a light that comes from everywhere along one direction: the globe that it is shown on.
    pub(super) globe: Option<Globe>,
}

/// A globe in the middle of the picture, seen from afar: a light without a place shines from a point
/// of its surface towards its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Globe {
    /// Pixels.
    pub(super) center: DVec2,
    /// Pixels.
    pub(super) radius: f64,
    /// Whether the point is on the far side: the light shines towards the eye.
    pub(super) behind: bool,
}

/// Where the light is on a picture of `size` pixels; `None` for a point behind the eye.
pub(super) fn spot(view: &View, size: [u32; 2], place: &LightPlace) -> Option<Spot> {
    let size = dvec2(size[0].into(), size[1].into());
    if let Some(anchor) = place.anchor() {
        let at = DVec2::from(view.project(anchor)?.at);
        let inside = at.cmpge(DVec2::ZERO).all() && at.cmple(size).all();
        return Some(Spot { at, inside, globe: None });
    }
    match place {
        LightPlace::Direction(along) => {
            let (center, radius) = (size / 2.0, GLOBE * size.min_element());
            let from = source(view, *along)?;
            let globe = Globe { center, radius, behind: from.z > 0.0 };
            let at = center + from.truncate() * radius;
            Some(Spot { at, inside: true, globe: Some(globe) })
        }
        _ => None,
    }
}

/// The place of a light whose handle was moved by `moved` pixels: its anchor parallel to the picture,
/// or `along` the view, downwards nearer; a direction around the globe.
pub(super) fn carried(
    view: &View,
    size: [u32; 2],
    place: &LightPlace,
    moved: DVec2,
    along: bool,
) -> LightPlace {
    let seen = place.anchor().and_then(|anchor| view.project(anchor));
    match (place, seen) {
        (_, Some(seen)) => place.anchored_at(carried_point(view, size, seen, moved, along)),
        (LightPlace::Direction(direction), None) => {
            let radius = GLOBE * f64::from(size[0].min(size[1]));
            match turned(view, *direction, moved / radius) {
                Some(direction) => LightPlace::Direction(direction),
                None => place.clone(),
            }
        }
        _ => place.clone(),
    }
}

/// A point in the upper left of the picture, nearer than what the camera looks at: for a new light,
/// whose handle then shows.
pub(super) fn fresh(view: &View, camera: &Camera, size: [u32; 2]) -> LightPlace {
    let depth = 0.7 * camera.eye.distance(camera.target);
    let at = [0.3 * f64::from(size[0]), 0.2 * f64::from(size[1])];
    let pixel = view.height_at(depth) / f64::from(size[1]);
    LightPlace::Point(tidy(view.point(Seen { at, depth }), 20.0 * pixel))
}

fn carried_point(view: &View, size: [u32; 2], seen: Seen, moved: DVec2, along: bool) -> DVec3 {
    let pixel = |depth: f64| view.height_at(depth) / f64::from(size[1]);
    if !along {
        let at = DVec2::from(seen.at) + moved;
        return tidy(view.point(Seen { at: at.into(), ..seen }), pixel(seen.depth));
    }
    let step = -moved.y * pixel(seen.depth);
    // Towards the eye ever more slowly: a light that has a handle keeps it.
    let depth = match step {
        nearer if nearer < 0.0 => seen.depth * (nearer / seen.depth).exp(),
        farther => seen.depth + farther,
    };
    let [_, _, forward] = view.axes();
    tidy(view.point(seen) + forward * (depth - seen.depth), pixel(depth.min(seen.depth)))
}

/// Where the light comes from: right and down in the picture, and into it; length 1.
fn source(view: &View, along: DVec3) -> Option<DVec3> {
    let unit = (along / along.abs().max_element()).normalize();
    let [right, down, forward] = view.axes();
    unit.is_finite().then(|| -DVec3::new(unit.dot(right), unit.dot(down), unit.dot(forward)))
}

/// The direction after its point of the globe, of radius 1, was moved. Beyond the rim the way goes on
/// over the other side, back towards the middle.
fn turned(view: &View, along: DVec3, moved: DVec2) -> Option<DVec3> {
    let from = source(view, along)?;
    let to = from.truncate() + moved;
    let (reach, side) = (to.length(), if from.z > 0.0 { 1.0 } else { -1.0 });
    let (flat, side) = match reach {
        inside if inside <= 1.0 => (to, side),
        outside => (to * ((2.0 - outside).max(0.0) / outside), -side),
    };
    let into = side * (1.0 - flat.length_squared()).max(0.0).sqrt();
    let [right, down, forward] = view.axes();
    let length = Some(along.length()).filter(|length| (1e-3..1e6).contains(length)).unwrap_or(1.0);
    let turned = (right * flat.x + down * flat.y + forward * into) * -length;
    Some(tidy(turned, length * FINEST_TURN))
}

/// What a screen tells apart on the globe, in radians.
const FINEST_TURN: f64 = 0.005;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Lens;

    const SIZE: [u32; 2] = [640, 360];

    fn views() -> [View; 2] {
        [Lens::Perspective { fov_degrees: 50.0 }, Lens::Parallel { height: 7.0 }].map(|lens| {
            let eye = DVec3::new(3.0, -8.0, 5.0);
            let target = DVec3::new(-1.0, 0.5, 1.0);
            View::new(&Camera { eye, target, up: DVec3::Z, lens, ..Camera::default() }, SIZE)
        })
    }

    fn at(view: &View, place: &LightPlace) -> DVec2 {
        spot(view, SIZE, place).expect("it has a handle").at
    }

    #[test]
    fn a_point_follows_the_pointer_parallel_to_the_picture() {
        for view in views() {
            let place = LightPlace::Point(DVec3::new(0.5, 1.0, 2.0));
            let before = at(&view, &place);
            for moved in [dvec2(40.0, -25.0), dvec2(-7.0, 90.0)] {
                let carried = carried(&view, SIZE, &place, moved, false);
                assert!((at(&view, &carried) - before - moved).length() < 0.4, "{carried:?}");
                let (LightPlace::Point(a), LightPlace::Point(b)) = (&place, &carried) else {
                    panic!("a point stays a point")
                };
                let depths = [a, b].map(|p| view.project(*p).unwrap().depth);
                assert!((depths[0] - depths[1]).abs() < 0.01, "{depths:?}");
                assert!(format!("{b}").len() < 26, "few digits: {b}");
            }
        }
    }

    #[test]
    fn along_the_view_it_comes_nearer_and_never_passes_the_eye() {
        for view in views() {
            let place = LightPlace::Point(DVec3::new(0.5, 1.0, 2.0));
            let depth = |moved: f64| {
                let carried = carried(&view, SIZE, &place, dvec2(30.0, moved), true);
                let LightPlace::Point(point) = carried else { panic!("a point stays a point") };
                view.project(point).expect("it keeps its handle").depth
            };
            let depths = [-1000.0, -50.0, 0.0, 50.0, 1000.0].map(depth);
            assert!(depths.is_sorted_by(|a, b| a > b), "{depths:?}");
        }
    }

    #[test]
    fn what_is_beside_the_picture_or_behind_the_eye_is_told() {
        let [view, _] = views();
        let (eye, target) = (DVec3::new(3.0, -8.0, 5.0), DVec3::new(-1.0, 0.5, 1.0));
        let spot = |point: DVec3| spot(&view, SIZE, &LightPlace::Point(point));
        let seen = |point: DVec3| spot(point).is_some_and(|spot| spot.inside);
        assert!(seen(target) && spot(eye).is_none() && spot(eye * 2.0 - target).is_none());
        let [right, down, _] = view.axes();
        let half = view.height_at(eye.distance(target)) / 2.0;
        assert!(seen(target + down * half * 0.99) && !seen(target + down * half * 1.01));
        assert!(seen(target + right * half * 1.7) && !seen(target - right * half * 1.8));
    }

    #[test]
    fn a_direction_turns_with_the_pointer_and_over_the_rim() {
        for view in views() {
            let [right, _, forward] = view.axes();
            let radius = GLOBE * 360.0;
            // Shining away from the eye: in the middle of the near side.
            let place = LightPlace::Direction(forward * 3.0);
            assert!((at(&view, &place) - dvec2(320.0, 180.0)).length() < 1e-9);
            let turn = |by: f64| carried(&view, SIZE, &place, dvec2(by * radius, 0.0), false);
            let halfway = turn(0.5);
            assert!((at(&view, &halfway).x - 320.0 - radius / 2.0).abs() < 0.5);
            assert!(!spot(&view, SIZE, &halfway).unwrap().globe.unwrap().behind);
            let LightPlace::Direction(rim) = turn(1.0) else { panic!("it stays a direction") };
            assert!(
                (rim + right * 3.0).length() < 0.02,
                "from the right, as long as before: {rim}"
            );
            let over = spot(&view, SIZE, &turn(1.5)).unwrap();
            assert!(over.globe.unwrap().behind, "it shines towards the eye");
            assert!((over.at.x - 320.0 - radius / 2.0).abs() < 0.5);
            let LightPlace::Direction(opposite) = turn(2.0) else { panic!("it stays a direction") };
            assert!((opposite + forward * 3.0).length() < 0.02, "{opposite}");
        }
    }
}
