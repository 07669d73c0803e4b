//! The scene made ready for rays: primitives in world space, their hierarchy, and the two questions
//! asked of them, `closest_hit` and `occluded`.
//!
//! Every hit is decided in f64 from the original numbers; the hierarchy only leaves out what cannot
//! be hit. The answers therefore do not depend on the tree, the SIMD width or the machine. There is
//! no epsilon with a length in it: a ray that leaves a surface knows which one ([`Leaving`]).

mod all_hits;
mod beam;
mod binary;
mod bump;
mod closed;
mod compile;
mod composite;
mod crossings;
mod frustum;
mod generate;
mod hierarchy;
mod interaction;
mod lanes;
mod motion;
mod noise;
mod packet;
mod parts;
mod pattern;
mod placement;
mod plan;
mod primitive;
mod prism;
mod quadratic;
mod quadric;
mod query;
mod runs;
mod shear;
mod sky;
pub(crate) mod solvers;
mod spans;
mod surfaces;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_acne;
#[cfg(test)]
mod tests_motion;
#[cfg(test)]
mod tests_solids;
#[cfg(test)]
mod tests_torus;
mod texel;
mod tone;
mod torus;
mod traverse;
mod uv;
mod wide;

use std::sync::Arc;

use fearless_simd::{Level, Simd};
use glam::DVec3;

use crate::progress::{Cancelled, Progress};
use crate::scene::Scene;
use compile::{Owner, Primitives};
pub(crate) use composite::MARGIN;
use hierarchy::Hierarchy;
pub use hierarchy::Stack;
pub use parts::parts;
pub use placement::{corners, rotation};
use query::{Closest, Gather, Shadow};
use surfaces::Surfaces;
pub use tone::Tone;

/// A half-line in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes, of unit length.
    pub direction: DVec3,
}

/// The first primitive a ray meets; [`Geometry::interaction`] tells the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, > 0.
    pub t: f64,
    /// The primitive's number, below [`Geometry::primitives`].
    pub primitive: u32,
}

/// The surface a ray starts on, which it must not meet again by rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaving {
    /// The primitive it starts on.
    pub primitive: u32,
    /// Whether it goes to the inner side of the geometric normal.
    pub inside: bool,
}

/// The surface at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction {
    /// The hit point, moved onto the surface: coordinates that the surface holds constant are exact.
    pub point: DVec3,
    /// Where that part of the surface was as the shutter opened: patterns are functions of it.
    pub rest: DVec3,
    /// Unit, out of the solid; of a surface without thickness, the side it is counter-clockwise from.
    pub geometric_normal: DVec3,
    /// Unit, on the side of the geometric normal: a mesh's smooth normal if it has one.
    pub shading_normal: DVec3,
    /// Index into `Scene::solids`: the operand whose surface it is, of a solid made of others.
    pub solid: u32,
    /// Index into `Scene::solids` of what it bounds: the whole, of a solid made of others.
    pub body: u32,
    /// Index into `Scene::materials`.
    pub material: u16,
    /// Slot of the material's paint, if it shows whole slots.
    pub slot: u8,
    /// Whether the shading normal was bent by a bump.
    pub bumped: bool,
    /// Whether the surface has no thickness and does not refract.
    pub thin: bool,
    /// The primitive's number.
    pub primitive: u32,
}

/// The compiled scene. Clones share everything large.
#[derive(Clone, Debug)]
pub struct Geometry {
    primitives: Arc<Primitives>,
    hierarchy: Arc<Hierarchy>,
    surfaces: Surfaces,
}

impl Geometry {
    /// Compiles a scene. A cancel is obeyed within 100 ms.
    pub fn build(scene: &Scene, progress: &Progress) -> Result<Geometry, Cancelled> {
        Geometry::build_for(Level::new(), scene, progress)
    }

    /// The same for rays at another level than the best.
    pub fn build_for(
        level: Level,
        scene: &Scene,
        progress: &Progress,
    ) -> Result<Geometry, Cancelled> {
        let primitives = Primitives::compile(scene, level, progress)?;
        let hierarchy = Hierarchy::build(&primitives, level, progress)?;
        Ok(Geometry {
            primitives: Arc::new(primitives),
            hierarchy: Arc::new(hierarchy),
            surfaces: Surfaces::of(scene),
        })
    }

    /// The level at which rays are asked about: code that does is dispatched by it.
    pub fn level(&self) -> Level {
        self.hierarchy.level
    }

    /// The geometry of a scene with the same solids, of which some may have other materials, and
    /// materials other textures: what [`Geometry::build`] would give.
    pub fn with_surfaces_of(&self, scene: &Scene) -> Geometry {
        assert_eq!(scene.solids.len(), self.surfaces.materials.len(), "the same solids");
        Geometry { surfaces: Surfaces::of(scene), ..self.clone() }
    }

    /// The hit with the smallest `t > 0`; of equal ones, that of the lowest primitive.
    #[inline(always)]
    pub fn closest_hit<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: &Ray,
        leaving: Option<Leaving>,
    ) -> Option<Hit> {
        let mut query = Closest::new();
        self.traverse(simd, stack, ray, leaving, &mut query);
        query.hit()
    }

    /// [`Geometry::closest_hit`] by asking every primitive, at the time 0.
    pub fn closest_hit_of_all(&self, ray: &Ray) -> Option<Hit> {
        let mut query = Closest::new();
        self.traverse_all(0.0, ray, None, &mut query);
        query.hit()
    }

    /// [`Geometry::closest_hit`], and the `t` of the hit after it, which is right if it is larger by less than one part
    /// in 10⁸: then surfaces may coincide.
    #[inline(always)]
    pub fn first_two<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: &Ray,
        leaving: Option<Leaving>,
    ) -> Option<(Hit, f64)> {
        let mut query = Closest::new();
        self.traverse(simd, stack, ray, leaving, &mut query);
        query.hit().map(|hit| (hit, query.second()))
    }

    /// All crossings at `0 < t < t_max` with their primitives, in order; `hits` is cleared first.
    #[inline(always)]
    pub fn crossings<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: &Ray,
        t_max: f64,
        leaving: Option<Leaving>,
        hits: &mut Vec<(f64, u32)>,
    ) {
        hits.clear();
        self.traverse(simd, stack, ray, leaving, &mut Gather { hits, t_max });
        hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    /// What stands between the ray's origin and a light at `0 < t < t_max`.
    ///
    /// Returns the solid of an opaque surface if there is one (`opaque` is indexed by solid).
    /// Otherwise `crossed` holds the solid of every transparent surface crossing, in no particular
    /// order; it is cleared first.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the hot path's scratch is passed in, not boxed")]
    pub fn occluded<S: Simd>(
        &self,
        simd: S,
        stack: &mut Stack,
        ray: &Ray,
        t_max: f64,
        leaving: Option<Leaving>,
        opaque: &[bool],
        crossed: &mut Vec<u32>,
    ) -> Option<u32> {
        crossed.clear();
        let mut query = Shadow::new(&self.primitives, t_max, opaque, crossed);
        self.traverse(simd, stack, ray, leaving, &mut query);
        query.blocker()
    }

    /// A ray from the interaction's point towards the unit vector `direction`, with what the queries
    /// need in order not to meet the same surface again.
    #[inline(always)]
    pub fn spawn(&self, at: &Interaction, direction: DVec3) -> (Ray, Leaving) {
        let inside = direction.dot(at.geometric_normal) < 0.0;
        (Ray { origin: at.point, direction }, Leaving { primitive: at.primitive, inside })
    }

    /// Whether colours and bumps are no more than a checker's anywhere: then [`Geometry::finish`] and
    /// [`Geometry::sky`] have nothing to do.
    #[inline(always)]
    pub fn is_plain(&self) -> bool {
        self.surfaces.is_plain()
    }

    /// The shading normal at a hit if its material's bump bends it, and the tone of its colour, `None` if
    /// it is that of its slot. A piece of the surface `footprint` wide is looked at.
    pub fn finish(
        &self,
        stack: &Stack,
        at: Interaction,
        footprint: f64,
    ) -> (Option<DVec3>, Option<Tone>) {
        let look = self.surfaces.look(at.material);
        let owner = self.primitives.owner(at.primitive);
        let uv = || match owner {
            Owner::Still => self.primitives.uv(at.solid, &at),
            Owner::Moving(index, moving) => moving.uv(index, &stack.moment, &at),
            Owner::Leaf(leaf) => leaf.uv(stack.time(), &at),
        };
        let mut gradient = look.relief.gradient(at.rest, footprint, uv);
        let tone = look.pattern.tone(at.rest, footprint, uv);
        gradient = match owner {
            Owner::Still => gradient,
            Owner::Moving(index, moving) => moving.turned(index, &stack.moment, gradient),
            Owner::Leaf(leaf) => leaf.turned(stack.time(), gradient),
        };
        (bump::bent(at.shading_normal, gradient), tone)
    }

    /// The tone of the background in a unit direction, of which a cone `angle` radians wide is looked
    /// at; `None` of one colour.
    pub fn sky(&self, direction: DVec3, angle: f64) -> Option<Tone> {
        self.surfaces.sky.tone(direction, angle)
    }

    /// The solid that a primitive belongs to: an index into `Scene::solids`.
    pub fn solid(&self, primitive: u32) -> u32 {
        self.primitives.solid_index(primitive)
    }

    /// The material of a primitive: an index into `Scene::materials`.
    #[inline(always)]
    pub fn material(&self, primitive: u32) -> u16 {
        self.surfaces.materials[self.primitives.solid_index(primitive) as usize]
    }

    /// Per solid an index into `Scene::materials`.
    pub fn materials(&self) -> &[u16] {
        &self.surfaces.materials
    }

    /// What every solid's material has.
    pub fn of_solids<T: Copy>(&self, of_materials: &[T]) -> Vec<T> {
        self.materials().iter().map(|&material| of_materials[material as usize]).collect()
    }

    /// How many primitives there are.
    pub fn primitives(&self) -> usize {
        self.primitives.count()
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        self.primitives.bytes() + self.hierarchy.bytes()
    }

    /// Lowest and highest corner of a box around everything but the infinite planes; `None` if there
    /// is nothing else.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.hierarchy.bounds()
    }
}
