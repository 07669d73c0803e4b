//! The factors of every product of parameters, and the one rule by which a branch lives or dies.
//!
//! A picture is a sum of *geometry × product of factors*. A factor is a function of the parameters
//! of one material, one texture slot or one light, and nothing else in a picture depends on them.

use super::{Background, Light, Material, Paint, Scene};
use crate::color::Rgb;

/// What a factor means. The order is the order in which terms are numbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Kind {
    /// Colour of a slot of the background, seen where a ray leaves the scene.
    Background,
    /// `reflect` of a material, for the mirror ray.
    Reflect,
    /// `transmit · filter` of a material, for the refracted ray.
    Transmit,
    /// `min(1, reflect + transmit)` of a material, for the mirror ray of total internal reflection.
    TotalReflect,
    /// `kloc · (emission + ambient · colour · ambient_light)` of a material's slot.
    Ambient,
    /// `kloc · diffuse · colour` of a material's slot.
    Diffuse,
    /// `kloc · specular`, tinted by `metallic` with the colour of the slot.
    Specular,
    /// `kloc · specular · transmit · filter`, for the highlight of a light behind the surface.
    Through,
    /// `color · intensity · falloff²` of a light (the last only where it falls off), 0 if it is off.
    Light,
    /// `transmit · filter` of a material that a shadow ray crosses, once per surface.
    Shadow,
    /// One channel alone (index 0, 1, 2), no parameter: ends a term whose coefficient is a colour.
    /// A coefficient of three numbers is three terms, one per channel.
    Channel,
}

const KINDS: [Kind; 11] = [
    Kind::Background,
    Kind::Reflect,
    Kind::Transmit,
    Kind::TotalReflect,
    Kind::Ambient,
    Kind::Diffuse,
    Kind::Specular,
    Kind::Through,
    Kind::Light,
    Kind::Shadow,
    Kind::Channel,
];

/// Name of one factor: kind in bits 28…31, slot in bits 16…23, index of material or light in bits
/// 0…15. `Factor::new(Kind::Diffuse, 2, 1)` is `0x5001_0002`. Ordered by (kind, slot, index), which
/// depends on the scene file's order alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Factor(u32);

impl Factor {
    /// The factor of this kind of the material or light with this index.
    #[inline(always)]
    pub const fn new(kind: Kind, index: u16, slot: u8) -> Factor {
        Factor((kind as u32) << 28 | (slot as u32) << 16 | index as u32)
    }

    /// What it means.
    #[inline(always)]
    pub fn kind(self) -> Kind {
        KINDS[(self.0 >> 28) as usize]
    }

    /// Index of the material, or of the light for [`Kind::Light`].
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & 0xffff) as usize
    }

    /// Slot of the material's paint.
    #[inline(always)]
    pub fn slot(self) -> usize {
        (self.0 >> 16 & 0xff) as usize
    }

    /// The bits, for hashing and for files.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0
    }

    /// The factor with these bits, or `None` if no factor has them.
    #[inline(always)]
    pub fn from_bits(bits: u32) -> Option<Factor> {
        let known = bits >> 28 < KINDS.len() as u32 && bits & 0x0f00_0000 == 0;
        known.then_some(Factor(bits))
    }

    /// Whether it leads to a further node of the ray tree.
    #[inline(always)]
    pub fn is_path(self) -> bool {
        matches!(self.kind(), Kind::Reflect | Kind::Transmit | Kind::TotalReflect)
    }

    /// Whether its index is that of a material.
    pub fn is_of_material(self) -> bool {
        match self.kind() {
            Kind::Reflect | Kind::Transmit | Kind::TotalReflect => true,
            Kind::Ambient | Kind::Diffuse | Kind::Specular => true,
            Kind::Through | Kind::Shadow => true,
            Kind::Background | Kind::Light | Kind::Channel => false,
        }
    }

    /// Text such as `diffuse(tiles.b)`, for people.
    pub fn describe(self, scene: &Scene) -> String {
        let material = || scene.materials[self.index()].name.as_str();
        let dotted = |name: &str| match name {
            "" => String::new(),
            name => format!(".{name}"),
        };
        let slot = || dotted(scene.materials[self.index()].paint.slot_name(self.slot()));
        match self.kind() {
            Kind::Background => {
                format!("background{}", dotted(scene.background.slot_name(self.slot())))
            }
            Kind::Reflect => format!("reflect({})", material()),
            Kind::Transmit => format!("transmit({})", material()),
            Kind::TotalReflect => format!("tir({})", material()),
            Kind::Ambient => format!("ambient({}{})", material(), slot()),
            Kind::Diffuse => format!("diffuse({}{})", material(), slot()),
            Kind::Specular => format!("specular({}{})", material(), slot()),
            Kind::Through => format!("through({})", material()),
            Kind::Light => format!("light({})", scene.lights[self.index()].name),
            Kind::Shadow => format!("shadow({})", material()),
            Kind::Channel => ["red", "green", "blue"][self.index()].into(),
        }
    }
}

/// Geometric weights below 2^-60 are faint at any cut-off.
const LEAST_GEOMETRIC: f32 = 1.0 / (1u64 << 60) as f32;

/// Slots that a paint may have.
const SLOTS: usize = 2;
/// Slots that a background may have.
const SKY_SLOTS: usize = 3;

/// The value of every factor of a scene. Made from a scene's parameters, read by tracing (which
/// branches live) and by shading (what they show).
#[derive(Clone, Debug, PartialEq)]
pub struct FactorValues {
    background: [Rgb; SKY_SLOTS],
    reflect: Vec<Rgb>,
    transmit: Vec<Rgb>,
    total_reflect: Vec<Rgb>,
    ambient: Vec<[Rgb; SLOTS]>,
    diffuse: Vec<[Rgb; SLOTS]>,
    specular: Vec<[Rgb; SLOTS]>,
    through: Vec<Rgb>,
    light: Vec<Rgb>,
    limits: Limits,
}

impl FactorValues {
    /// Evaluates every factor.
    pub fn new(scene: &Scene) -> FactorValues {
        let materials = || scene.materials.iter();
        FactorValues {
            background: sky_colors(&scene.background),
            reflect: materials().map(|m| m.reflect).collect(),
            transmit: materials().map(|m| m.transmit * m.filter).collect(),
            total_reflect: materials()
                .map(|m| (m.reflect + m.transmit).map(|c| c.min(1.0)))
                .collect(),
            ambient: materials()
                .map(|m| {
                    let shown = |o| m.ambient * o * scene.ambient_light;
                    let glow = |o| m.emission + shown(o);
                    let slots = of_slots(m, glow, [&shown, &|_| m.emission]);
                    slots.map(|light| m.kloc * light)
                })
                .collect(),
            diffuse: materials()
                .map(|m| {
                    let matt = |o| m.kloc * m.diffuse * o;
                    of_slots(m, matt, [&matt, &|_| Rgb::BLACK])
                })
                .collect(),
            specular: materials()
                .map(|m| {
                    let tinted = |o| tint(o, m.metallic);
                    let (metal, white) = (|o| o * m.metallic, |_| Rgb::grey(1.0 - m.metallic));
                    of_slots(m, tinted, [&metal, &white]).map(|tint| m.kloc * m.specular * tint)
                })
                .collect(),
            through: materials().map(|m| m.kloc * m.specular * (m.transmit * m.filter)).collect(),
            light: scene.lights.iter().map(light_value).collect(),
            limits: Limits { depth: scene.trace.depth, cutoff: scene.trace.cutoff },
        }
    }

    /// The same where the factors of lights are numbered by `places`, one per light, rising; the
    /// gaps, lights that are gone, are black.
    pub fn with_lights_at(mut self, places: &[u16]) -> FactorValues {
        let count = places.last().map_or(0, |&last| last as usize + 1);
        let mut light = vec![Rgb::BLACK; count];
        for (value, &place) in self.light.iter().zip(places) {
            light[place as usize] = *value;
        }
        self.light = light;
        self
    }

    /// The value of one factor, every channel ≥ 0.
    #[inline(always)]
    pub fn value(&self, factor: Factor) -> Rgb {
        let (i, slot) = (factor.index(), factor.slot());
        match factor.kind() {
            Kind::Background => self.background[slot],
            Kind::Reflect => self.reflect[i],
            Kind::Transmit | Kind::Shadow => self.transmit[i],
            Kind::TotalReflect => self.total_reflect[i],
            Kind::Ambient => self.ambient[i][slot],
            Kind::Diffuse => self.diffuse[i][slot],
            Kind::Specular => self.specular[i][slot],
            Kind::Through => self.through[i],
            // A light after the last one is gone.
            Kind::Light => self.light.get(i).copied().unwrap_or(Rgb::BLACK),
            Kind::Channel => Rgb(std::array::from_fn(|c| if c == i { 1.0 } else { 0.0 })),
        }
    }

    /// Whether, per material, nothing passes through: `transmit · filter` is zero.
    pub fn opaque(&self) -> Vec<bool> {
        self.transmit.iter().map(|t| t.is_black()).collect()
    }

    /// Whether a branch of this geometric weight, a product of Fresnel's reflectances, is too faint
    /// to be followed whatever its parameters are: below the cut-off, or lost in any sum.
    #[inline(always)]
    pub fn faint(&self, geometric: f32) -> bool {
        geometric < self.limits.cutoff.max(LEAST_GEOMETRIC)
    }

    /// Follows a branch that carries the path factor `factor` from a node reached with weight
    /// `path`: the weight of the child, or why the branch ends here.
    ///
    /// **The one rule of liveness**: tracing stops by it and shading gives a dead column 0 by it.
    /// Only `reflect`, `transmit·filter` and `tir` of the seen path count, each clamped to 1.
    #[inline(always)]
    pub fn follow(&self, path: PathWeight, factor: Factor) -> Result<PathWeight, End> {
        let value = self.value(factor);
        if value.is_black() {
            return Err(End::Zero);
        }
        if path.depth >= self.limits.depth {
            return Err(End::Depth);
        }
        let weight = path.weight * value.map(|c| c.min(1.0));
        if weight.max_channel() < self.limits.cutoff {
            return Err(End::Weight);
        }
        Ok(PathWeight { weight, depth: path.depth + 1 })
    }
}

/// Where branches stop: `[trace]`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Limits {
    depth: u32,
    cutoff: f32,
}

/// Parameter weight and depth of a node of a ray tree: functions of its path factors alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathWeight {
    /// Product of the path's factors, each clamped to 1.
    pub weight: Rgb,
    /// Number of path factors.
    pub depth: u32,
}

impl PathWeight {
    /// The eye: weight 1, depth 0.
    pub const EYE: PathWeight = PathWeight { weight: Rgb::WHITE, depth: 0 };
}

/// Why a branch was not followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Its factor is zero.
    Zero,
    /// Its weight is below the cut-off.
    Weight,
    /// It would be deeper than the limit.
    Depth,
    /// Its geometric weight is below the cut-off.
    Faint,
    /// Its direction, drawn from a lobe, lies on the wrong side of the surface.
    Astray,
}

/// What the colour of each slot makes of a surface. `whole` is for a colour that the slot knows. Of an
/// image it knows the tint alone: the first part of `split` is what texels multiply, the second what
/// they do not.
fn of_slots(
    material: &Material,
    whole: impl Fn(Rgb) -> Rgb,
    split: [&dyn Fn(Rgb) -> Rgb; SLOTS],
) -> [Rgb; SLOTS] {
    match &material.paint {
        Paint::Solid(color) => [whole(*color); SLOTS],
        Paint::Checker { a, b, size: _ } => [whole(*a), whole(*b)],
        Paint::Gradient { a, b, .. } | Paint::Marble { a, b, .. } | Paint::Wood { a, b, .. } => {
            [whole(*a), whole(*b)]
        }
        Paint::Image { tint, image: _, size: _ } => split.map(|part| part(*tint)),
    }
}

fn sky_colors(background: &Background) -> [Rgb; SKY_SLOTS] {
    match background {
        Background::Color(color) => [*color, Rgb::BLACK, Rgb::BLACK],
        Background::Gradient { below, level, above, up: _ } => [*below, *level, *above],
        // The second only says where the image is seen.
        Background::Image { tint, .. } => [*tint, Rgb::BLACK, Rgb::BLACK],
    }
}

fn tint(color: Rgb, metallic: f32) -> Rgb {
    color.map(|c| (1.0 - metallic) + metallic * c)
}

/// What a light gives of itself; where it falls off, at distance 1: its coefficients hold 1/d².
fn light_value(light: &Light) -> Rgb {
    let strength = light.color * light.intensity;
    match (light.on, light.falls_off()) {
        (false, _) => Rgb::BLACK,
        (true, false) => strength,
        (true, true) => strength * (light.falloff * light.falloff) as f32,
    }
}
