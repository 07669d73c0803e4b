//! The fields of every part of a scene, listed once: names, ranges, and who may visit them.

use super::light::MOST_LIGHT_SAMPLES;
use super::motion::Motion;
use super::range::Range;
use super::slot::Slot;
use super::{
    Area, Background, Bump, Camera, Lens, Light, LightPlace, Material, Paint, Picture, Placement,
    Scene, Shape, Solid, Trace,
};

/// Light, colours, and the coefficients of the local shading.
pub const COEFFICIENT: Range = Range::closed(0.0, 1e6);
/// Weights of the reflected and the refracted ray.
pub const WEIGHT: Range = Range::closed(0.0, 10.0);
/// Longest chain of reflections and refractions.
pub const DEPTH: Range = Range::closed(0.0, 64.0);
/// A share of one.
pub const SHARE: Range = Range::closed(0.0, 1.0);
/// Slope of the facets of a rough surface.
pub const ROUGHNESS: Range = Range::closed(0.02, 1.0);
/// How far a pattern is folded, in units of its size.
pub const TURBULENCE: Range = Range::closed(0.0, 100.0);
/// Positions, directions and angles.
pub const COORDINATE: Range = Range::closed(-1e12, 1e12);
/// Radii, sides and scales.
pub const LENGTH: Range = Range::above(0.0, 1e12);
/// Exponents of highlights and of the lobes that blur.
pub const EXPONENT: Range = Range::closed(0.0, 1e6);

/// Mass per cubic unit of length.
pub const DENSITY: Range = Range::above(0.0, 1e12);

/// Lengths that may be nothing.
pub const DISTANCE: Range = Range::closed(0.0, 1e12);

/// The tables that hold named things.
pub const LISTS: [&str; 3] = ["lights", "materials", "solids"];
/// The table that holds the looks.
pub const LOOKS: &str = "looks";
/// The key that names the look that is worn.
pub const LOOK: &str = "look";
/// Keys of [`Lens`].
pub const LENSES: &[&str] = &["fov_degrees", "height"];
/// Keys of [`LightPlace`].
pub const PLACES: &[&str] = &["point", "direction", "spot", "area"];
/// Keys of [`Area`].
pub const AREAS: &[&str] = &["rectangle", "disc", "sphere"];
/// Keys of [`Paint`].
pub const PAINTS: &[&str] = &["color", "texture"];
/// Keys of the patterns in a `texture`.
pub const TEXTURES: &[&str] = &["checker", "gradient", "marble", "wood", "image"];
/// Keys of [`Background`].
pub const BACKGROUNDS: &[&str] = &["color", "gradient", "image"];
/// Keys of the functions in a `bump`.
pub const BUMPS: &[&str] = &["noise", "waves", "image"];
/// Keys of [`Shape`].
pub const SHAPES: &[&str] = &[
    "sphere",
    "plane",
    "box",
    "cylinder",
    "cone",
    "torus",
    "ellipsoid",
    "quadric",
    "prism",
    "polygon",
    "mesh",
    "knot",
    "sphereflake",
    "union",
    "merge",
    "intersection",
    "difference",
    "complement",
];

/// Whether a key must stand in the scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// It has a default.
    Optional,
    /// It has none.
    Required,
    /// Exactly one of these keys must be there.
    OneOf(&'static [&'static str]),
    /// At most one of these keys may be there; the first has a default.
    EitherOf(&'static [&'static str]),
}

impl Need {
    /// Whether the key must be written even if its value is the default.
    pub fn must_be_written(self) -> bool {
        matches!(self, Need::Required | Need::OneOf(_))
    }
}

/// Something that is shown every field in turn: a reader, a writer, a list of parameters.
///
/// Visitors get `&mut`; one that only looks visits a clone (meshes are shared, so clones are cheap).
pub trait Visit {
    /// A value with its key.
    fn leaf(&mut self, key: &'static str, need: Need, slot: Slot<'_>);

    /// A table with its key; `body` visits what is inside, and may be called more than once.
    fn group(&mut self, key: &str, need: Need, body: &mut dyn FnMut(&mut dyn Visit));
}

/// Visits a whole scene in the order in which it is written.
pub fn scene(scene: &mut Scene, v: &mut dyn Visit) {
    // A look is no parameter but a list of them: reader and writer know its table.
    let Scene {
        ambient_light,
        picture,
        camera,
        background,
        trace,
        lights,
        materials,
        solids,
        looks: _,
    } = scene;
    v.leaf("ambient_light", Need::Optional, Slot::Coefficient(ambient_light, COEFFICIENT));
    v.group("camera", Need::Optional, &mut |v| self::camera(camera, v));
    v.group("picture", Need::Optional, &mut |v| self::picture(picture, v));
    v.group("trace", Need::Optional, &mut |v| self::trace(trace, v));
    v.group("background", Need::Optional, &mut |v| self::background(background, v));
    v.group("lights", Need::Optional, &mut |v| {
        for item in lights.iter_mut() {
            v.group(&item.name.clone(), Need::Optional, &mut |v| light(item, v));
        }
    });
    v.group("materials", Need::Optional, &mut |v| {
        for item in materials.iter_mut() {
            v.group(&item.name.clone(), Need::Optional, &mut |v| material(item, v));
        }
    });
    v.group("solids", Need::Optional, &mut |v| {
        for item in solids.iter_mut() {
            v.group(&item.name.clone(), Need::Optional, &mut |v| solid(item, v));
        }
    });
}

/// Visits `[camera]`.
pub fn camera(camera: &mut Camera, v: &mut dyn Visit) {
    let Camera { eye, target, up, lens, aperture, focus, shutter } = camera;
    v.leaf("eye", Need::Optional, Slot::Vector(eye, COORDINATE));
    v.leaf("target", Need::Optional, Slot::Vector(target, COORDINATE));
    v.leaf("up", Need::Optional, Slot::Vector(up, COORDINATE));
    let need = Need::EitherOf(LENSES);
    match lens {
        Lens::Perspective { fov_degrees } => {
            v.leaf("fov_degrees", need, Slot::Number(fov_degrees, Range::between(0.0, 180.0)));
        }
        Lens::Parallel { height } => v.leaf("height", need, Slot::Number(height, LENGTH)),
    }
    v.leaf("aperture", Need::Optional, Slot::Number(aperture, DISTANCE));
    v.leaf("focus", Need::Optional, Slot::Number(focus, DISTANCE));
    v.leaf("shutter", Need::Optional, Slot::Number(shutter, SHARE));
}

/// Visits `[picture]`.
pub fn picture(picture: &mut Picture, v: &mut dyn Visit) {
    let Picture { size, exposure, tone } = picture;
    let side = Range::closed(1.0, super::MAX_SIDE as f64);
    v.leaf("size", Need::Optional, Slot::Pair(size, side));
    v.leaf("exposure", Need::Optional, Slot::Single(exposure, Range::closed(-30.0, 30.0)));
    v.leaf("tone", Need::Optional, Slot::Choice(tone));
}

/// Visits `[trace]`.
pub fn trace(trace: &mut Trace, v: &mut dyn Visit) {
    let Trace { samples, depth, cutoff, filter, adaptive, refine } = trace;
    v.leaf("samples", Need::Optional, Slot::Whole(samples, Range::closed(1.0, 4096.0)));
    v.leaf("depth", Need::Optional, Slot::Whole(depth, DEPTH));
    v.leaf("cutoff", Need::Optional, Slot::Single(cutoff, SHARE));
    v.leaf("adaptive", Need::Optional, Slot::Single(adaptive, SHARE));
    v.leaf("refine", Need::Optional, Slot::Choice(refine));
    v.leaf("filter", Need::Optional, Slot::Choice(filter));
}

/// Visits `[background]`.
pub fn background(background: &mut Background, v: &mut dyn Visit) {
    let need = Need::EitherOf(BACKGROUNDS);
    let required = Need::Required;
    match background {
        Background::Color(color) => v.leaf("color", need, Slot::Coefficient(color, COEFFICIENT)),
        Background::Gradient { below, level, above, up } => v.group("gradient", need, &mut |v| {
            v.leaf("below", required, Slot::Coefficient(below, COEFFICIENT));
            v.leaf("level", required, Slot::Coefficient(level, COEFFICIENT));
            v.leaf("above", required, Slot::Coefficient(above, COEFFICIENT));
            v.leaf("up", Need::Optional, Slot::Vector(up, COORDINATE));
        }),
        Background::Image { image, tint, turn_degrees } => v.group("image", need, &mut |v| {
            v.leaf("file", required, Slot::Image(image));
            v.leaf("tint", Need::Optional, Slot::Coefficient(tint, COEFFICIENT));
            v.leaf("turn_degrees", Need::Optional, Slot::Number(turn_degrees, COORDINATE));
        }),
    }
}

/// Visits `[lights.NAME]`.
pub fn light(light: &mut Light, v: &mut dyn Visit) {
    let Light { name: _, color, intensity, on, falloff, samples, place } = light;
    light_place(place, v);
    v.leaf("color", Need::Optional, Slot::Coefficient(color, COEFFICIENT));
    v.leaf("intensity", Need::Optional, Slot::Coefficient(intensity, COEFFICIENT));
    v.leaf("on", Need::Optional, Slot::Flag(on));
    v.leaf("falloff", Need::Optional, Slot::Number(falloff, DISTANCE));
    let most = Range::closed(1.0, MOST_LIGHT_SAMPLES as f64);
    v.leaf("samples", Need::Optional, Slot::Whole(samples, most));
}

/// Visits the key of a light that places it.
pub fn light_place(place: &mut LightPlace, v: &mut dyn Visit) {
    let need = Need::OneOf(PLACES);
    match place {
        LightPlace::Point(point) => v.leaf("point", need, Slot::Vector(point, COORDINATE)),
        LightPlace::Direction(along) => v.leaf("direction", need, Slot::Vector(along, COORDINATE)),
        LightPlace::Spot { at, towards, angle_degrees, edge } => {
            v.group("spot", need, &mut |v| {
                v.leaf("at", Need::Required, Slot::Vector(at, COORDINATE));
                v.leaf("towards", Need::Required, Slot::Vector(towards, COORDINATE));
                let angle = Range::above(0.0, 180.0);
                v.leaf("angle_degrees", Need::Required, Slot::Number(angle_degrees, angle));
                v.leaf("edge", Need::Required, Slot::Number(edge, SHARE));
            });
        }
        LightPlace::Area(area) => v.group("area", need, &mut |v| {
            let key = match area {
                Area::Rectangle { .. } => "rectangle",
                Area::Disc { .. } => "disc",
                Area::Sphere { .. } => "sphere",
            };
            v.group(key, Need::OneOf(AREAS), &mut |v| self::area(area, v));
        }),
    }
}

/// Visits what stands in the table of a light's surface.
fn area(area: &mut Area, v: &mut dyn Visit) {
    let need = Need::Required;
    match area {
        Area::Rectangle { center, along, across } => {
            v.leaf("center", need, Slot::Vector(center, COORDINATE));
            v.leaf("along", need, Slot::Vector(along, COORDINATE));
            v.leaf("across", need, Slot::Vector(across, COORDINATE));
        }
        Area::Disc { center, normal, radius } => {
            v.leaf("center", need, Slot::Vector(center, COORDINATE));
            v.leaf("normal", need, Slot::Vector(normal, COORDINATE));
            v.leaf("radius", need, Slot::Number(radius, LENGTH));
        }
        Area::Sphere { center, radius } => {
            v.leaf("center", need, Slot::Vector(center, COORDINATE));
            v.leaf("radius", need, Slot::Number(radius, LENGTH));
        }
    }
}

/// Visits `[materials.NAME]`.
pub fn material(material: &mut Material, v: &mut dyn Visit) {
    let Material {
        name: _,
        paint,
        bump,
        kloc,
        ambient,
        diffuse,
        model,
        specular,
        shininess,
        roughness,
        metallic,
        emission,
        reflect,
        transmit,
        filter,
        ior,
        priority,
        fresnel,
        gloss,
        translucency,
        density,
    } = material;
    self::paint(paint, v);
    v.leaf("kloc", Need::Optional, Slot::Coefficient(kloc, COEFFICIENT));
    v.leaf("ambient", Need::Optional, Slot::Coefficient(ambient, COEFFICIENT));
    v.leaf("diffuse", Need::Optional, Slot::Coefficient(diffuse, COEFFICIENT));
    v.leaf("model", Need::Optional, Slot::Choice(model));
    v.leaf("specular", Need::Optional, Slot::Coefficient(specular, COEFFICIENT));
    v.leaf("shininess", Need::Optional, Slot::Single(shininess, EXPONENT));
    v.leaf("roughness", Need::Optional, Slot::Single(roughness, ROUGHNESS));
    v.leaf("metallic", Need::Optional, Slot::Single(metallic, SHARE));
    v.leaf("emission", Need::Optional, Slot::Coefficient(emission, COEFFICIENT));
    v.leaf("reflect", Need::Optional, Slot::Coefficient(reflect, WEIGHT));
    v.leaf("transmit", Need::Optional, Slot::Coefficient(transmit, WEIGHT));
    v.leaf("filter", Need::Optional, Slot::Coefficient(filter, COEFFICIENT));
    v.leaf("ior", Need::Optional, Slot::Number(ior, Range::closed(0.1, 10.0)));
    let most = Range::closed(0.0, f64::from(super::MAX_PRIORITY));
    v.leaf("priority", Need::Optional, Slot::Whole(priority, most));
    v.leaf("fresnel", Need::Optional, Slot::Flag(fresnel));
    v.leaf("gloss", Need::Optional, Slot::Single(gloss, EXPONENT));
    v.leaf("translucency", Need::Optional, Slot::Single(translucency, EXPONENT));
    v.leaf("density", Need::Optional, Slot::Number(density, DENSITY));
    self::bump(bump, v);
}

/// Visits `color` or `texture`.
pub fn paint(paint: &mut Paint, v: &mut dyn Visit) {
    let need = Need::EitherOf(PAINTS);
    match paint {
        Paint::Solid(color) => v.leaf("color", need, Slot::Coefficient(color, COEFFICIENT)),
        _ => v.group("texture", need, &mut |v| {
            v.group(texture_key(paint), Need::OneOf(TEXTURES), &mut |v| texture(paint, v));
        }),
    }
}

/// The key of a paint in its `texture`; of one colour, where there is none, `color`.
pub fn texture_key(paint: &Paint) -> &'static str {
    match paint {
        Paint::Solid(_) => "color",
        Paint::Checker { .. } => "checker",
        Paint::Gradient { .. } => "gradient",
        Paint::Marble { .. } => "marble",
        Paint::Wood { .. } => "wood",
        Paint::Image { .. } => "image",
    }
}

/// Visits what stands in the table of a pattern.
pub fn texture(paint: &mut Paint, v: &mut dyn Visit) {
    let (need, optional) = (Need::Required, Need::Optional);
    let colors = |a, b, v: &mut dyn Visit| {
        v.leaf("a", need, Slot::Coefficient(a, COEFFICIENT));
        v.leaf("b", need, Slot::Coefficient(b, COEFFICIENT));
    };
    match paint {
        Paint::Solid(_) => {}
        Paint::Checker { a, b, size } => {
            colors(a, b, v);
            v.leaf("size", need, Slot::Number(size, LENGTH));
        }
        Paint::Gradient { a, b, from, to } => {
            colors(a, b, v);
            v.leaf("from", need, Slot::Vector(from, COORDINATE));
            v.leaf("to", need, Slot::Vector(to, COORDINATE));
        }
        Paint::Marble { a, b, size, direction, turbulence } => {
            colors(a, b, v);
            v.leaf("size", need, Slot::Number(size, LENGTH));
            v.leaf("direction", optional, Slot::Vector(direction, COORDINATE));
            v.leaf("turbulence", optional, Slot::Number(turbulence, TURBULENCE));
        }
        Paint::Wood { a, b, size, center, axis, turbulence } => {
            colors(a, b, v);
            v.leaf("size", need, Slot::Number(size, LENGTH));
            v.leaf("center", optional, Slot::Vector(center, COORDINATE));
            v.leaf("axis", optional, Slot::Vector(axis, COORDINATE));
            v.leaf("turbulence", optional, Slot::Number(turbulence, TURBULENCE));
        }
        Paint::Image { image, tint, size } => {
            v.leaf("file", need, Slot::Image(image));
            v.leaf("tint", optional, Slot::Coefficient(tint, COEFFICIENT));
            v.leaf("size", optional, Slot::Number(size, LENGTH));
        }
    }
}

/// The key of a bump; empty of none.
pub fn bump_key(bump: &Bump) -> &'static str {
    match bump {
        Bump::None => "",
        Bump::Noise { .. } => "noise",
        Bump::Waves { .. } => "waves",
        Bump::Image { .. } => "image",
    }
}

/// Visits `bump`; its table is empty where there is none.
pub fn bump(bump: &mut Bump, v: &mut dyn Visit) {
    v.group("bump", Need::Optional, &mut |v| {
        if *bump != Bump::None {
            let need = Need::OneOf(BUMPS);
            v.group(bump_key(bump), need, &mut |v| unevenness(bump, v));
        }
    });
}

/// Visits what stands in the table of a bump's function.
fn unevenness(bump: &mut Bump, v: &mut dyn Visit) {
    let (need, optional) = (Need::Required, Need::Optional);
    match bump {
        Bump::None => {}
        Bump::Noise { height, scale } => {
            v.leaf("height", need, Slot::Number(height, COORDINATE));
            v.leaf("scale", need, Slot::Number(scale, LENGTH));
        }
        Bump::Waves { height, scale, center } => {
            v.leaf("height", need, Slot::Number(height, COORDINATE));
            v.leaf("scale", need, Slot::Number(scale, LENGTH));
            v.leaf("center", optional, Slot::Vector(center, COORDINATE));
        }
        Bump::Image { image, height, size } => {
            v.leaf("file", need, Slot::Image(image));
            v.leaf("height", need, Slot::Number(height, COORDINATE));
            v.leaf("size", optional, Slot::Number(size, LENGTH));
        }
    }
}

/// Visits `[solids.NAME]`.
pub fn solid(solid: &mut Solid, v: &mut dyn Visit) {
    let Solid { name: _, shape, material, placement, motion } = solid;
    let key = shape_key(shape);
    if let Shape::Csg { operation: _, operands } = shape {
        v.leaf(key, Need::OneOf(SHAPES), Slot::Solids(operands));
    } else {
        v.group(key, Need::OneOf(SHAPES), &mut |v| self::shape(shape, v));
        v.leaf("material", Need::Required, Slot::Material(material));
    }
    self::placement(placement, v);
    v.group("motion", Need::Optional, &mut |v| self::motion(motion, v));
}

/// Visits the keys of a solid that place it.
pub fn placement(placement: &mut Placement, v: &mut dyn Visit) {
    let Placement { translate, rotate_degrees, scale } = placement;
    v.leaf("rotate_degrees", Need::Optional, Slot::Vector(rotate_degrees, COORDINATE));
    v.leaf("translate", Need::Optional, Slot::Vector(translate, COORDINATE));
    v.leaf("scale", Need::Optional, Slot::Scale(scale, LENGTH));
}

/// Visits the motion of a solid.
pub fn motion(motion: &mut Motion, v: &mut dyn Visit) {
    let Motion { translate, rotate_degrees } = motion;
    v.leaf("rotate_degrees", Need::Optional, Slot::Vector(rotate_degrees, COORDINATE));
    v.leaf("translate", Need::Optional, Slot::Vector(translate, COORDINATE));
}

/// The key of a shape in its solid.
pub fn shape_key(shape: &Shape) -> &'static str {
    match shape {
        Shape::Sphere { .. } => "sphere",
        Shape::Plane { .. } => "plane",
        Shape::Box { .. } => "box",
        Shape::Cylinder { .. } => "cylinder",
        Shape::Cone { .. } => "cone",
        Shape::Torus { .. } => "torus",
        Shape::Ellipsoid { .. } => "ellipsoid",
        Shape::Quadric { .. } => "quadric",
        Shape::Prism { .. } => "prism",
        Shape::Polygon { .. } => "polygon",
        Shape::Mesh { .. } => "mesh",
        Shape::Knot { .. } => "knot",
        Shape::Sphereflake { .. } => "sphereflake",
        Shape::Csg { operation, operands: _ } => operation.key(),
    }
}

/// Visits what stands in the table of a shape.
pub fn shape(shape: &mut Shape, v: &mut dyn Visit) {
    let need = Need::Required;
    match shape {
        Shape::Sphere { center, radius } => {
            v.leaf("center", need, Slot::Vector(center, COORDINATE));
            v.leaf("radius", need, Slot::Number(radius, LENGTH));
        }
        Shape::Plane { normal, offset } => {
            v.leaf("normal", need, Slot::Vector(normal, COORDINATE));
            v.leaf("offset", need, Slot::Number(offset, COORDINATE));
        }
        Shape::Box { min, max } => {
            v.leaf("min", need, Slot::Vector(min, COORDINATE));
            v.leaf("max", need, Slot::Vector(max, COORDINATE));
        }
        Shape::Cylinder { from, to, radius } => {
            v.leaf("from", need, Slot::Vector(from, COORDINATE));
            v.leaf("to", need, Slot::Vector(to, COORDINATE));
            v.leaf("radius", need, Slot::Number(radius, LENGTH));
        }
        Shape::Cone { from, to, radius, tip } => {
            v.leaf("from", need, Slot::Vector(from, COORDINATE));
            v.leaf("to", need, Slot::Vector(to, COORDINATE));
            v.leaf("radius", need, Slot::Number(radius, LENGTH));
            v.leaf("tip", Need::Optional, Slot::Number(tip, DISTANCE));
        }
        Shape::Torus { major, minor } => {
            v.leaf("major", need, Slot::Number(major, LENGTH));
            v.leaf("minor", need, Slot::Number(minor, LENGTH));
        }
        Shape::Ellipsoid { center, radii } => {
            v.leaf("center", need, Slot::Vector(center, COORDINATE));
            v.leaf("radii", need, Slot::Vector(radii, LENGTH));
        }
        Shape::Quadric { squares, products, linear, constant, min, max } => {
            v.leaf("squares", need, Slot::Vector(squares, COORDINATE));
            v.leaf("products", Need::Optional, Slot::Vector(products, COORDINATE));
            v.leaf("linear", Need::Optional, Slot::Vector(linear, COORDINATE));
            v.leaf("constant", need, Slot::Number(constant, COORDINATE));
            v.leaf("min", need, Slot::Vector(min, COORDINATE));
            v.leaf("max", need, Slot::Vector(max, COORDINATE));
        }
        Shape::Prism { outline, bottom, top } => {
            v.leaf("outline", need, Slot::Loops(outline, COORDINATE));
            v.leaf("bottom", need, Slot::Number(bottom, COORDINATE));
            v.leaf("top", need, Slot::Number(top, COORDINATE));
        }
        Shape::Polygon { points } => v.leaf("points", need, Slot::Points(points, COORDINATE)),
        Shape::Mesh { file, mesh } => v.leaf("file", need, Slot::Mesh { file, mesh }),
        Shape::Knot { turns, tube, segments } => {
            v.leaf("turns", need, Slot::Pair(turns, Range::closed(1.0, 1000.0)));
            v.leaf("tube", need, Slot::Number(tube, LENGTH));
            v.leaf("segments", need, Slot::Pair(segments, Range::closed(3.0, 65_536.0)));
        }
        Shape::Sphereflake { center, radius, levels } => {
            v.leaf("center", need, Slot::Vector(center, COORDINATE));
            v.leaf("radius", need, Slot::Number(radius, LENGTH));
            v.leaf("levels", need, Slot::Whole(levels, Range::closed(1.0, 6.0)));
        }
        // Its key holds the operands themselves.
        Shape::Csg { operation: _, operands: _ } => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_a_choice_makes_the_variant_with_that_key() {
        for key in SHAPES {
            assert_eq!(shape_key(&Shape::named(key)), *key);
        }
        let first_key = |visit: &mut dyn FnMut(&mut dyn Visit)| {
            let mut keys = Keys(Vec::new());
            visit(&mut keys);
            keys.0
        };
        for key in PAINTS {
            let keys = first_key(&mut |v| paint(&mut Paint::named(key), v));
            assert_eq!(keys, [*key]);
        }
        for key in TEXTURES {
            assert_eq!(texture_key(&Paint::named(key)), *key);
        }
        for key in BUMPS {
            assert_eq!(bump_key(&Bump::named(key)), *key);
        }
        assert_eq!(first_key(&mut |v| bump(&mut Bump::None, v)), ["bump"]);
        for key in BACKGROUNDS {
            let keys = first_key(&mut |v| background(&mut Background::named(key), v));
            assert_eq!(keys, [*key]);
        }
        for key in LENSES {
            let mut value = Camera { lens: Lens::named(key), ..Camera::default() };
            assert!(first_key(&mut |v| camera(&mut value, v)).contains(&key.to_string()));
        }
        for key in PLACES {
            let mut value = Light { place: LightPlace::named(key), ..Light::new("a") };
            assert!(first_key(&mut |v| light(&mut value, v)).contains(&key.to_string()));
        }
        for key in AREAS {
            assert_eq!(LightPlace::of_kind(key), LightPlace::Area(Area::named(key)));
            assert_eq!(LightPlace::of_kind(key).kind(), *key);
        }
    }

    /// Notes the keys of the outermost level.
    struct Keys(Vec<String>);

    impl Visit for Keys {
        fn leaf(&mut self, key: &'static str, _: Need, _: Slot<'_>) {
            self.0.push(key.to_owned());
        }
        fn group(&mut self, key: &str, _: Need, _: &mut dyn FnMut(&mut dyn Visit)) {
            self.0.push(key.to_owned());
        }
    }
}
