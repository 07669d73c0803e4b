//! From solids to primitives: placements applied, generated solids expanded, meshes joined.

use std::sync::Arc;

use fearless_simd::Level;
use glam::DVec3;

use super::closed::Closed;
use super::composite::{Chain, Composite, Leaf, Parts};
use super::generate;
use super::motion::Moving;
use super::placement::Placed;
use super::primitive::{Form, Plane, Shape as OtherShape, Sphere};
use super::shear::{Corner, corner};
use super::uv::Frame;
use crate::progress::{Cancelled, Progress};
use crate::scene::mesh::Mesh;
use crate::scene::seams::{Seams, seams};
use crate::scene::{Scene, Shape, Solid};

/// Elements handled between two looks at the cancel flag.
const CHECK_EVERY: usize = 1 << 14;

/// The corners of a triangle as its mesh has them.
const CORNERS: [usize; 3] = [0, 1, 2];

/// Marks a triangle without smooth normals.
pub(super) const NO_NORMAL: u32 = u32::MAX;

/// Which list a primitive is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// `Primitives::spheres`.
    Sphere,
    /// `Primitives::triangles`.
    Triangle,
    /// `Primitives::shapes`.
    Shape,
    /// `Primitives::planes`, outside the hierarchy.
    Plane,
    /// `Primitives::moving`; in the hierarchy they are shapes.
    Moving,
    /// It is in solids that are made of it, of which the primitive tells which.
    Leaf,
}

/// Where a primitive is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Item {
    /// Which list.
    pub(super) kind: Kind,
    /// Which element.
    pub(super) index: u32,
}

/// A triangle of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Into `Primitives::corners`, counter-clockwise seen from outside.
    pub(super) corners: [u32; 3],
    /// Its number among all primitives.
    pub(super) primitive: u32,
}

/// A solid of the scene: a run of primitives of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Compiled {
    /// Number of its first primitive.
    pub(super) first: u32,
    /// How many it has.
    pub(super) count: u32,
    /// Where the first one is found; the others follow.
    pub(super) item: Item,
    /// Whether it has no inside: a polygon, a mesh that is not closed.
    pub(super) thin: bool,
    /// Whether its primitives are triangles, also if it moves.
    pub(super) mesh: bool,
}

/// What knows the surface of a primitive.
#[derive(Clone, Copy, Debug)]
pub(super) enum Owner<'a> {
    /// The primitive itself.
    Still,
    /// The solid with this index among those that move.
    Moving(u32, &'a Moving),
    /// A leaf of a solid made of others.
    Leaf(&'a Leaf),
}

/// All primitives, numbered in the order of the solids.
#[derive(Debug, Default)]
pub(super) struct Primitives {
    pub(super) spheres: Vec<Sphere>,
    pub(super) planes: Vec<Plane>,
    pub(super) shapes: Vec<OtherShape>,
    pub(super) triangles: Vec<Triangle>,
    /// Three per triangle, into `normals`.
    pub(super) triangle_normals: Vec<[u32; 3]>,
    pub(super) corners: Vec<Corner>,
    pub(super) normals: Vec<DVec3>,
    pub(super) moving: Vec<Moving>,
    pub(super) composites: Vec<Composite>,
    /// Those among them that have no end: they are outside the hierarchy.
    pub(super) unbounded: Vec<u32>,
    /// Every composite's first primitive, ascending, with its index.
    places: Vec<(u32, u32)>,
    pub(super) solids: Vec<Compiled>,
    /// How images lie on each solid.
    pub(super) frames: Vec<Frame>,
    /// The solid of each primitive.
    pub(super) solid_of: Vec<u32>,
    /// The number of the first primitive: another than 0 for those of a solid that moves.
    first: u32,
}

impl Primitives {
    /// Expands every solid of the scene, for rays at a level.
    pub(super) fn compile(
        scene: &Scene,
        level: Level,
        progress: &Progress,
    ) -> Result<Primitives, Cancelled> {
        let mut all = Primitives::default();
        let shutter = scene.shutter_time();
        let Parts { plain, made } = Parts::of(scene);
        for ((solid, chain), made) in scene.solids.iter().zip(plain).zip(made) {
            progress.check()?;
            match (chain, shutter.filter(|_| solid.moves())) {
                (None, _) => all.add_nothing(solid),
                (Some(chain), Some(shutter)) if chain.is_single() => {
                    all.add_moving(solid, shutter, level, progress)?;
                }
                (Some(chain), _) => all.add(solid, chain.at(0.0), progress)?,
            }
            for made in made {
                all.add_composite(scene, made, level, progress)?;
            }
        }
        Ok(all)
    }

    /// Expands one solid, whose primitives are numbered from `first` on.
    pub(super) fn part(
        solid: &Solid,
        placed: Placed,
        first: u32,
        progress: &Progress,
    ) -> Result<Primitives, Cancelled> {
        let mut all = Primitives { first, ..Primitives::default() };
        all.add(solid, placed, progress)?;
        Ok(all)
    }

    /// How many primitives there are.
    pub(super) fn count(&self) -> usize {
        self.solid_of.len()
    }

    /// The next primitive's number.
    fn number(&self) -> u32 {
        self.first + self.count() as u32
    }

    /// The solid that a primitive belongs to.
    #[inline(always)]
    pub(super) fn solid(&self, primitive: u32) -> &Compiled {
        &self.solids[self.solid_of[primitive as usize] as usize]
    }

    /// Index of the solid that a primitive belongs to.
    pub(super) fn solid_index(&self, primitive: u32) -> u32 {
        self.solid_of[primitive as usize]
    }

    /// The corners of a triangle.
    #[inline(always)]
    pub(super) fn triangle_corners(&self, triangle: &Triangle) -> [&Corner; 3] {
        let [a, b, c] = triangle.corners;
        [&self.corners[a as usize], &self.corners[b as usize], &self.corners[c as usize]]
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let polygons = self.shapes.iter().map(|shape| match &shape.form {
            Form::Polygon(corners, _) => size_of_val(&**corners),
            Form::Closed(closed) => closed.bytes(),
            Form::Cuboid(_) | Form::Moving(_) | Form::Composite(_) => 0,
            Form::PlacedCuboid(placed, _) | Form::Ellipsoid(placed, _, _) => size_of_val(&**placed),
        });
        size_of_val(&*self.spheres)
            + size_of_val(&*self.planes)
            + size_of_val(&*self.shapes)
            + polygons.sum::<usize>()
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.triangle_normals)
            + size_of_val(&*self.corners)
            + size_of_val(&*self.normals)
            + self.moving.iter().map(Moving::bytes).sum::<usize>()
            + self.composites.iter().map(Composite::bytes).sum::<usize>()
            + size_of_val(&*self.solids)
            + size_of_val(&*self.frames)
            + size_of_val(&*self.solid_of)
    }

    fn add(&mut self, solid: &Solid, placed: Placed, progress: &Progress) -> Result<(), Cancelled> {
        let first = self.number();
        let mut order = CORNERS;
        let (item, thin) = match &solid.shape {
            Shape::Sphere { center, radius } => self.sphere(&placed, *center, *radius),
            Shape::Plane { normal, offset } => self.plane(&placed, *normal, *offset),
            Shape::Box { min, max } => self.cuboid(&placed, [*min, *max]),
            Shape::Polygon { points } => self.polygon(&placed, points),
            Shape::Ellipsoid { center, radii } => {
                self.sphere(&placed.stretched(*center, *radii), DVec3::ZERO, 1.0)
            }
            shape @ (Shape::Cylinder { .. }
            | Shape::Cone { .. }
            | Shape::Torus { .. }
            | Shape::Quadric { .. }
            | Shape::Prism { .. }) => self.closed(&placed, shape),
            Shape::Mesh { file: _, mesh } => {
                let (item, thin, turned) = self.mesh(&placed, mesh, progress)?;
                order = turned;
                (item, thin)
            }
            Shape::Knot { turns, tube, segments } => {
                let mesh = Arc::new(generate::knot(*turns, *tube, *segments, progress)?);
                let (item, thin, turned) = self.mesh(&placed, &mesh, progress)?;
                order = turned;
                (item, thin)
            }
            Shape::Sphereflake { center, radius, levels } => {
                self.sphereflake(&placed, generate::sphereflake(*center, *radius, *levels))
            }
            Shape::Csg { .. } => unreachable!("its operands are compiled"),
        };
        let count = self.count_of(item.kind) as u32 - item.index;
        self.solid_of.resize(self.count() + count as usize, self.solids.len() as u32);
        let mesh = item.kind == Kind::Triangle;
        self.solids.push(Compiled { first, count, item, thin, mesh });
        self.frames.push(Frame::new(solid, placed, order));
        Ok(())
    }

    /// Adds a solid that has no primitives of its own: others are made of it, or it of others.
    fn add_nothing(&mut self, solid: &Solid) {
        let item = Item { kind: Kind::Leaf, index: 0 };
        let (first, count, thin, mesh) = (self.number(), 0, false, false);
        self.solids.push(Compiled { first, count, item, thin, mesh });
        self.frames.push(Frame::new(solid, Placed::new(&solid.placement), CORNERS));
    }

    /// Adds a solid that is made of others; its primitives are its operands'.
    fn add_composite(
        &mut self,
        scene: &Scene,
        made: (usize, Chain),
        level: Level,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        let (first, index) = (self.number(), self.composites.len() as u32);
        let whole = Composite::new(scene, made, first, level, progress)?;
        for leaf in &whole.leaves {
            self.solid_of.resize(self.count() + leaf.count() as usize, leaf.solid);
        }
        let [lo, hi] = whole.bounds();
        if lo.is_finite() && hi.is_finite() {
            if lo.cmple(hi).all() {
                self.shapes.push(OtherShape { form: Form::Composite(index), primitive: first });
            }
        } else {
            self.unbounded.push(index);
        }
        self.composites.push(whole);
        self.places.push((first, index));
        Ok(())
    }

    /// The composite and its leaf that a primitive belongs to.
    pub(super) fn leaf(&self, primitive: u32) -> (&Composite, &Leaf) {
        let place = self.places.partition_point(|(first, _)| *first <= primitive) - 1;
        let whole = &self.composites[self.places[place].1 as usize];
        let leaf = whole.leaves.partition_point(|leaf| leaf.first <= primitive) - 1;
        (whole, &whole.leaves[leaf])
    }

    /// What knows the surface of a primitive.
    pub(super) fn owner(&self, primitive: u32) -> Owner<'_> {
        let item = self.solid(primitive).item;
        match item.kind {
            Kind::Moving => Owner::Moving(item.index, &self.moving[item.index as usize]),
            Kind::Leaf => Owner::Leaf(self.leaf(primitive).1),
            _ => Owner::Still,
        }
    }

    /// Adds a solid that moves until the shutter closes.
    fn add_moving(
        &mut self,
        solid: &Solid,
        shutter: f64,
        level: Level,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        let (first, index) = (self.number(), self.moving.len() as u32);
        let moving = Moving::new(solid, first, shutter, level, progress)?;
        let Compiled { first: _, count, item: _, thin, mesh } = *moving.solid();
        self.moving.push(moving);
        self.shapes.push(OtherShape { form: Form::Moving(index), primitive: first });
        self.solid_of.resize(self.count() + count as usize, self.solids.len() as u32);
        let item = Item { kind: Kind::Moving, index };
        self.solids.push(Compiled { first, count, item, thin, mesh });
        // Images lie on it as it rests.
        self.frames.push(Frame::new(solid, Placed::new(&solid.placement), CORNERS));
        Ok(())
    }

    fn count_of(&self, kind: Kind) -> usize {
        match kind {
            Kind::Sphere => self.spheres.len(),
            Kind::Triangle => self.triangles.len(),
            Kind::Shape => self.shapes.len(),
            Kind::Plane => self.planes.len(),
            Kind::Moving => self.moving.len(),
            Kind::Leaf => 0,
        }
    }

    /// The next free place of a kind.
    fn next(&self, kind: Kind) -> Item {
        Item { kind, index: self.count_of(kind) as u32 }
    }

    fn sphere(&mut self, placed: &Placed, center: DVec3, radius: f64) -> (Item, bool) {
        self.sphereflake(placed, vec![(center, radius)])
    }

    fn sphereflake(&mut self, placed: &Placed, spheres: Vec<(DVec3, f64)>) -> (Item, bool) {
        let first = self.number();
        let numbered = spheres.into_iter().zip(first..);
        let Some(scale) = placed.similarity() else {
            let item = self.next(Kind::Shape);
            self.shapes.extend(numbered.map(|((center, radius), primitive)| {
                let form = Form::Ellipsoid(Box::new(*placed), center, radius);
                OtherShape { form, primitive }
            }));
            return (item, false);
        };
        let item = self.next(Kind::Sphere);
        self.spheres.extend(numbered.map(|((center, radius), primitive)| Sphere {
            center: placed.point(center),
            radius: radius * scale,
            primitive,
        }));
        (item, false)
    }

    fn plane(&mut self, placed: &Placed, normal: DVec3, offset: f64) -> (Item, bool) {
        let item = self.next(Kind::Plane);
        let unit = exact_normalize(normal);
        let point = placed.point(unit * offset);
        let normal = exact_normalize(placed.normal(unit));
        let plane = Plane { normal, offset: normal.dot(point), primitive: self.number() };
        self.planes.push(plane);
        (item, false)
    }

    fn cuboid(&mut self, placed: &Placed, corners: [DVec3; 2]) -> (Item, bool) {
        let item = self.next(Kind::Shape);
        let form = if placed.keeps_axes() {
            let [a, b] = corners.map(|c| placed.point(c));
            Form::Cuboid([a.min(b), a.max(b)])
        } else {
            Form::PlacedCuboid(Box::new(*placed), corners)
        };
        self.shapes.push(OtherShape { form, primitive: self.number() });
        (item, false)
    }

    fn closed(&mut self, placed: &Placed, shape: &Shape) -> (Item, bool) {
        let item = self.next(Kind::Shape);
        let form = Form::Closed(Box::new(Closed::new(placed, shape)));
        self.shapes.push(OtherShape { form, primitive: self.number() });
        (item, false)
    }

    fn polygon(&mut self, placed: &Placed, points: &[DVec3]) -> (Item, bool) {
        let item = self.next(Kind::Shape);
        let points: Vec<DVec3> = points.iter().map(|p| placed.point(*p)).collect();
        let normal = exact_normalize(newell_normal(&points));
        let corners = points.into_iter().map(corner).collect();
        let form = Form::Polygon(corners, normal);
        self.shapes.push(OtherShape { form, primitive: self.number() });
        (item, true)
    }

    /// Also gives the order in which the corners of its triangles stand.
    fn mesh(
        &mut self,
        placed: &Placed,
        mesh: &Mesh,
        progress: &Progress,
    ) -> Result<(Item, bool, [usize; 3]), Cancelled> {
        let item = self.next(Kind::Triangle);
        let (first, corner_base) = (self.number(), self.corners.len() as u32);
        let normal_base = self.normals.len() as u32;
        let closed = seams(&mesh.triangles, progress)? == Seams::Closed;
        // A closed mesh that is wound inside out is turned: its inside is what it encloses.
        let order = if closed && volume(mesh) < 0.0 { [0, 2, 1] } else { CORNERS };
        self.corners.extend(mesh.positions.iter().map(|p| corner(placed.point(*p))));
        self.normals.extend(mesh.normals.iter().map(|n| exact_normalize(placed.normal(*n))));
        for (i, (triangle, primitive)) in mesh.triangles.iter().zip(first..).enumerate() {
            if i % CHECK_EVERY == 0 {
                progress.check()?;
            }
            let corners = order.map(|k: usize| corner_base + triangle[k]);
            self.triangles.push(Triangle { corners, primitive });
            let normals = mesh.triangle_normals.get(i);
            self.triangle_normals.push(match normals {
                Some(normals) => order.map(|k| normal_base + normals[k]),
                None => [NO_NORMAL; 3],
            });
        }
        Ok((item, !closed, order))
    }
}

/// Unit length; a vector along an axis stays exactly along it. Zero stays zero.
pub(super) fn exact_normalize(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize() } else { DVec3::ZERO }
}

/// The normal of a polygon, by Newell's sum about its first corner; as long as twice its area.
pub(super) fn newell_normal(points: &[DVec3]) -> DVec3 {
    let Some(&origin) = points.first() else { return DVec3::ZERO };
    points.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

/// Six times the signed volume that a closed mesh encloses.
fn volume(mesh: &Mesh) -> f64 {
    let origin = mesh.positions.first().copied().unwrap_or_default();
    let at = |v: u32| mesh.positions[v as usize] - origin;
    mesh.triangles.iter().map(|[a, b, c]| at(*a).dot(at(*b).cross(at(*c)))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_normals_are_exact() {
        assert_eq!(exact_normalize(DVec3::new(0.0, -3e-200, 0.0)), DVec3::NEG_Y);
        assert_eq!(exact_normalize(DVec3::ZERO), DVec3::ZERO);
        let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        assert_eq!(newell_normal(&square), DVec3::new(0.0, 0.0, 2.0));
    }
}
