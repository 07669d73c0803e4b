//! A second evaluation of the kept trees: plain recursion in f64, straight from the formulas, that
//! knows nothing of folding, terms or factors.
//!
//! `I = kloc·I_local + reflect·I_reflected + transmit·filter·I_refracted`, with
//! `I_local = emission + ambient·O·Ia + Σ lights·Π(transmit·filter)·[diffuse·O·max(0, N·L) +
//! specular·tint·highlight]`, where Fresnel, if asked for, weighs what is reflected and refracted,
//! and Hall's model also shows lights behind a surface, with transmit·filter for the tint.

use glam::DVec3;

use rayforest::color::Rgb;
use rayforest::geometry::Tone;
use rayforest::progress::Progress;
use rayforest::scene::model::Model;
use rayforest::scene::path::{self, Parameter};
use rayforest::scene::{Background, Material, Paint, Scene};
use rayforest::session::{Class, Session};

use super::picture::Picture;
use super::preorder::{Limb, Lit, PixelTrees, Tree, pixels};
use super::stage::{open, shipped, shipped_names};

/// What a channel may differ: the trees keep cosines in f32, and the matrix product multiplies and
/// adds in f32, where every one of up to a hundred operations of a path rounds by 6e-8. The floor is
/// half a millionth of what 8 bits can show.
fn allowed(value: f64) -> f64 {
    1e-5 * value + 1e-7
}

/// The picture, and what the rule of liveness did.
struct Evaluated {
    picture: Picture,
    /// The same with all weights as if they were positive: what rounding is relative to.
    sizes: Picture,
    /// Branches that are stored and dead under the present scene.
    dead: usize,
    /// How close a weight came to the cut-off, as a ratio minus 1: f32 and f64 decide alike only
    /// if this is well above the rounding of f32.
    margin: f64,
    /// Branches that live under the present scene and were not grown.
    missing: usize,
}

/// Evaluates the trees under the scene.
fn evaluate(trees: &[PixelTrees], scene: &Scene) -> Evaluated {
    let mut evaluator = Evaluator { scene, dead: 0, margin: f64::INFINITY, missing: 0 };
    let [width, height] = scene.picture.size;
    let mut picture =
        Picture { size: [width, height], pixels: vec![[f64::NAN; 3]; (width * height) as usize] };
    let mut sizes = picture.clone();
    for pixel in trees {
        let (mut sum, mut size) = (DVec3::ZERO, DVec3::ZERO);
        let samples = pixel.samples.iter().zip(&pixel.skies);
        for ((tree, sky), weight) in samples.zip(&pixel.weights) {
            let light = evaluator.sample(tree.as_ref(), *sky);
            (sum, size) = (sum + *weight * light, size + weight.abs() * light);
        }
        let [x, y] = pixel.pixel;
        let at = (y * width + x) as usize;
        let count = f64::from(scene.trace.samples);
        picture.pixels[at] = (sum / count).to_array();
        sizes.pixels[at] = (size / count).to_array();
    }
    let Evaluator { scene: _, dead, margin, missing } = evaluator;
    Evaluated { picture, sizes, dead, margin, missing }
}

struct Evaluator<'a> {
    scene: &'a Scene,
    dead: usize,
    margin: f64,
    missing: usize,
}

/// Weight and depth of a node: what decides whether a branch lives.
#[derive(Clone, Copy)]
struct Path {
    weight: DVec3,
    /// Product of Fresnel's reflectances: the same rule, but no parameter counts.
    geometric: f64,
    depth: u32,
}

impl Evaluator<'_> {
    fn sample(&mut self, tree: Option<&Tree>, seen: Option<Tone>) -> DVec3 {
        match tree {
            Some(tree) => self.light(tree, Path { weight: DVec3::ONE, geometric: 1.0, depth: 0 }),
            None => sky(self.scene, seen),
        }
    }

    fn light(&mut self, tree: &Tree, path: Path) -> DVec3 {
        let scene = self.scene;
        let m = &scene.materials[tree.material];
        let (reflect, transmit) = (rgb(m.reflect), rgb(m.transmit));
        let mirror = if tree.total { (reflect + transmit).min(DVec3::ONE) } else { reflect };
        let f = tree.fresnel;
        let weighed = m.fresnel || m.model == Model::Hall;
        assert_eq!(f.is_some(), weighed, "reflectance where the material asks for it");
        let passed = transmit * rgb(m.filter);
        let towards = |by: f64| Path { geometric: path.geometric * by, ..path };
        let (through_mirror, through) = (f.unwrap_or(1.0), f.map_or(1.0, |f| 1.0 - f));
        rgb(m.kloc) * local(scene, tree, m)
            + through_mirror * mirror * self.limb(&tree.reflected, mirror, towards(through_mirror))
            + through * passed * self.limb(&tree.transmitted, passed, towards(through))
    }

    /// What comes back along a branch: nothing if it is dead under the present scene.
    fn limb(&mut self, limb: &Limb, factor: DVec3, path: Path) -> DVec3 {
        let child = self.follow(factor, path);
        match (limb, child) {
            (Limb::Absent, _) | (Limb::Cut(_), None) => DVec3::ZERO,
            (Limb::Cut(_), Some(_)) => {
                self.missing += 1;
                DVec3::ZERO
            }
            (Limb::Missed(_) | Limb::Grown(_), None) => {
                self.dead += 1;
                DVec3::ZERO
            }
            (Limb::Missed(seen), Some(_)) => sky(self.scene, *seen),
            (Limb::Grown(tree), Some(child)) => self.light(tree, child),
        }
    }

    /// The rule of liveness: no factor zero, depth within the limit, weight not below the cut-off.
    fn follow(&mut self, factor: DVec3, path: Path) -> Option<Path> {
        if factor == DVec3::ZERO || path.depth >= self.scene.trace.depth {
            return None;
        }
        let weight = path.weight * factor.min(DVec3::ONE);
        let cutoff = f64::from(self.scene.trace.cutoff);
        if path.geometric < cutoff.max(2f64.powi(-60)) {
            return None;
        }
        if cutoff > 0.0 {
            let margin = |weight: f64| (weight / cutoff - 1.0).abs();
            self.margin = self.margin.min(margin(weight.max_element()));
            self.margin = self.margin.min(margin(path.geometric));
        }
        (weight.max_element() >= cutoff).then_some(Path { weight, depth: path.depth + 1, ..path })
    }
}

/// Ambient light, lamps, and what the surface gives off, without kloc.
fn local(scene: &Scene, tree: &Tree, m: &Material) -> DVec3 {
    let o = match (&m.paint, tree.tone) {
        (Paint::Solid(color), None) => rgb(*color),
        (Paint::Checker { a, b, .. }, None) => rgb([*a, *b][tree.slot]),
        (Paint::Image { tint, .. }, Some(Tone::Texel(texel))) => rgb(texel) * rgb(*tint),
        (
            Paint::Gradient { a, b, .. } | Paint::Marble { a, b, .. } | Paint::Wood { a, b, .. },
            Some(Tone::Blend { slot: 0, share }),
        ) => rgb(*a).lerp(rgb(*b), share.into()),
        other => panic!("{other:?}"),
    };
    let lamps: DVec3 = tree.lights.iter().map(|lit| lamp(scene, lit, m, o)).sum();
    rgb(m.emission) + rgb(m.ambient) * o * rgb(scene.ambient_light) + lamps
}

/// What a ray sees that left the scene.
fn sky(scene: &Scene, seen: Option<Tone>) -> DVec3 {
    match (&scene.background, seen) {
        (Background::Color(color), None) => rgb(*color),
        (Background::Gradient { below, level, above, .. }, Some(Tone::Blend { slot, share })) => {
            let colors = [*below, *level, *above].map(rgb);
            colors[usize::from(slot)].lerp(colors[usize::from(slot) + 1], share.into())
        }
        (Background::Image { tint, .. }, Some(Tone::Texel(texel))) => rgb(texel) * rgb(*tint),
        other => panic!("{other:?}"),
    }
}

fn lamp(scene: &Scene, lit: &Lit, m: &Material, o: DVec3) -> DVec3 {
    let light = &scene.lights[lit.light];
    let Some(crossed) = &lit.crossed else { return DVec3::ZERO };
    let behind = lit.n_dot_l <= 0.0 && lit.weight > 0.0;
    if !light.on || (lit.n_dot_l <= 0.0 && !behind) {
        return DVec3::ZERO;
    }
    let through = crossed.iter().map(|&m| &scene.materials[m]);
    let shadow: DVec3 = through.map(|m| rgb(m.transmit) * rgb(m.filter)).product();
    let metallic = f64::from(m.metallic);
    let tint = DVec3::splat(1.0 - metallic) + o * metallic;
    let spread = match m.model {
        Model::CookTorrance => {
            let slope = f64::from(m.roughness).powi(-2);
            slope * (-lit.angle * slope).exp()
        }
        _ => (1.0 - lit.angle).powf(m.shininess.into()),
    };
    let tint = if behind { rgb(m.transmit) * rgb(m.filter) } else { tint };
    let arriving = if light.falls_off() { light.falloff.powi(2) } else { 1.0 };
    rgb(light.color)
        * rgb(light.intensity)
        * arriving
        * shadow
        * (rgb(m.diffuse) * o * lit.n_dot_l.max(0.0) + rgb(m.specular) * tint * lit.weight * spread)
}

fn rgb(color: Rgb) -> DVec3 {
    DVec3::from_array(color.0.map(f64::from))
}

/// Whether a picture is what an evaluation says; if not, what is wrong.
fn judge(ours: &Picture, truth: &Evaluated) -> Result<(), String> {
    if truth.missing > 0 {
        return Err(format!("{} branches live and were not grown", truth.missing));
    }
    if truth.margin < 1e-5 {
        return Err(format!("a weight is within {:e} of the cut-off", truth.margin));
    }
    // Where weights have signs, sums are rounded as those of all that is added and taken away.
    let pixels = ours.pixels.iter().zip(&truth.picture.pixels).zip(&truth.sizes.pixels);
    let off = |((a, b), size): ((&[f64; 3], &[f64; 3]), &[f64; 3])| -> [f64; 3] {
        std::array::from_fn(|i| size[i] + (a[i] - b[i]))
    };
    let ours = Picture { size: ours.size, pixels: pixels.map(off).collect() };
    let comparison = ours.compare(&truth.sizes, allowed);
    let (units, [x, y]) = comparison.worst;
    match comparison.share {
        0.0 => Ok(()),
        _ => Err(format!("pixel ({x}, {y}) differs by {units} times what is allowed")),
    }
}

/// Holds a session against the second evaluation; gives the number of dead branches.
fn check(session: &Session, trees: &[PixelTrees], name: &str) -> usize {
    let truth = evaluate(trees, session.scene());
    let ours = Picture::of_film(&session.film());
    if let Err(why) = judge(&ours, &truth) {
        let files = ours.leave(&truth.picture, &format!("evaluator-{name}"));
        panic!("{name}: {why}\n{files}");
    }
    truth.dead
}

/// A sequence of numbers in [0, 1).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }
}

/// A new value for a parameter that an edit without rays may change, `None` for others and for most
/// of those. Path factors stay within `reach` times what was traced.
fn new_value(
    original: &Parameter,
    dice: &mut Dice,
    reach: f64,
    by_parameters_alone: bool,
) -> Option<String> {
    let Parameter { path, value, .. } = original;
    let key = path.rsplit('.').next().unwrap_or_default();
    if dice.roll() < 0.6 {
        return None;
    }
    let mut triple = |scale: f64| {
        let channels = [scale * dice.roll(), scale * dice.roll(), scale * dice.roll()];
        format!("{channels:?}")
    };
    Some(match key {
        "ambient_light" | "color" | "a" | "b" | "kloc" | "ambient" | "diffuse" | "specular"
        | "tint" | "below" | "level" | "above" => triple(1.0),
        "emission" => triple(0.2),
        "intensity" => triple(1.5),
        "reflect" | "transmit" | "filter" if original.range.is_some() => match dice.roll() {
            r if r < 0.1 => "0".to_owned(),
            _ => scaled(value, &[0; 3].map(|_| reach * dice.roll())),
        },
        "falloff" if value.parse::<f64>().ok()? > 0.0 => format!("{}", 0.1 + 6.0 * dice.roll()),
        "shininess" => format!("{}", 1000f64.powf(dice.roll())),
        "roughness" => format!("{}", 0.02f64.powf(dice.roll())),
        "metallic" => format!("{}", dice.roll()),
        "on" => format!("{}", dice.roll() < 0.7),
        "depth" => format!("{}", (value.parse::<f64>().ok()? * (0.5 + 0.5 * dice.roll())).floor()),
        // With Fresnel what is cut off by geometry is not in the terms.
        "cutoff" if by_parameters_alone => {
            format!("{}", value.parse::<f64>().ok()? * (1.0 + 4.0 * dice.roll()))
        }
        _ => return None,
    })
}

/// A number or `[r, g, b]` times three numbers.
fn scaled(value: &str, by: &[f64; 3]) -> String {
    let numbers = value.trim_matches(['[', ']']).split(',').map(|n| n.trim().parse());
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().expect("numbers");
    let channel = |i: usize| numbers.get(i).unwrap_or(&numbers[0]) * by[i];
    format!("{:?}", [0, 1, 2].map(channel))
}

/// The scene with some of its parameters changed.
fn edited(now: &Scene, originals: &[Parameter], dice: &mut Dice, reach: f64) -> Scene {
    let mut scene = now.clone();
    let alone = !scene.materials.iter().any(Material::weighs_branches);
    for original in originals {
        if let Some(value) = new_value(original, dice, reach, alone) {
            path::set(&mut scene, &original.path, &value).unwrap_or_else(|error| panic!("{error}"));
        }
    }
    scene
}

/// The name of a scene that is not shipped: whitted's, in other illumination models.
const MODELS: &str = "models";

/// A shipped scene, or [`MODELS`].
fn scene(name: &str) -> Scene {
    if name != MODELS {
        return shipped(name);
    }
    let mut scene = shipped("whitted");
    for (path, value) in [
        ("materials.tiles.model", "blinn"),
        ("materials.tiles.specular", "0.4"),
        ("materials.glass.model", "hall"),
        ("materials.mirror.model", "cook_torrance"),
        ("materials.mirror.fresnel", "true"),
    ] {
        path::set(&mut scene, path, value).unwrap_or_else(|error| panic!("{error}"));
    }
    scene
}

#[test]
fn every_shipped_scene_is_what_the_formulas_say_as_traced_and_after_edits() {
    let mut dice = Dice(1);
    let mut dead = 0;
    let mut seen = [0; 3];
    let names = shipped_names().into_iter().chain([MODELS.to_owned()]);
    for name in names {
        let mut session = open(scene(&name));
        let originals = path::parameters(session.scene());
        let trees = pixels(&session);
        assert_eq!(
            check(&session, &trees, &name),
            0,
            "{name}: a fresh trace stores no dead branch"
        );
        for round in 0..6 {
            // A raised path factor may ask for rays: then lowered ones, which never do.
            let raised = edited(session.scene(), &originals, &mut dice, 1.1);
            let without_rays = session.class_of(&raised) <= Class::Refold;
            let next = match without_rays && raised.trace.depth > 0 {
                true => raised,
                false => edited(session.scene(), &originals, &mut dice, 1.0),
            };
            let report = session.edit(next, &Progress::default()).unwrap();
            assert!(report.class <= Class::Refold, "{name}, round {round}: {:?}", report.reason);
            assert_eq!(report.rays.total(), 0, "{name}, round {round}");
            seen[report.class as usize] += 1;
            dead += check(&session, &trees, &format!("{name}-{round}"));
        }
    }
    let [none, reshade, refold] = seen;
    assert!(none == 0 && reshade > 0 && refold > 0, "classes of edits: {seen:?}");
    assert!(dead > 1000, "edits left only {dead} stored branches dead");
}

#[test]
fn the_comparison_fails_for_another_scene_or_other_trees() {
    let session = open(shipped("whitted"));
    let ours = Picture::of_film(&session.film());
    let right = session.scene();
    let trees = pixels(&session);
    let under = |scene: &Scene| judge(&ours, &evaluate(&trees, scene));
    assert_eq!(under(right), Ok(()));
    for (path, value, complaint) in [
        ("materials.tiles.diffuse", "0.70003", "differs"),
        ("materials.glass.specular", "0.999", "differs"),
        ("materials.glass.transmit", "0.84997", "differs"),
        ("materials.mirror.reflect", "0.55002", "differs"),
        ("materials.mirror.shininess", "100.1", "differs"),
        ("materials.glass.filter", "[1, 1, 0.9999]", "differs"),
        ("background.color", "[0.08, 0.16, 0.30001]", "differs"),
        ("ambient_light", "[1, 1, 0.999]", "differs"),
        ("trace.depth", "5", "differs"),
        ("trace.cutoff", "0.05", "differs"),
        ("lights.key.on", "false", "differs"),
        ("trace.cutoff", "0.0005", "were not grown"),
    ] {
        let mut wrong = right.clone();
        path::set(&mut wrong, path, value).unwrap();
        let why = under(&wrong).expect_err(path);
        assert!(why.contains(complaint), "{path} = {value}: {why}");
    }
}
