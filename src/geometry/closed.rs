//! The solids that have a frame and functions of their own: cylinders, cones, tori, quadrics, prisms.

use glam::DVec3;

use super::Ray;
use super::frustum::Frustum;
use super::placement::Placed;
use super::primitive::Start;
use super::prism::Prism;
use super::quadric::Quadric;
use super::query::Query;
use super::spans::Spans;
use super::torus::Torus;
use super::traverse::offer_roots;
use super::uv::{self, Uv};
use crate::scene::Shape;

/// A solid in a frame of its own.
#[derive(Clone, Debug)]
pub(super) struct Closed {
    placed: Placed,
    body: Body,
}

#[derive(Clone, Debug)]
enum Body {
    Frustum(Frustum),
    Torus(Torus),
    Quadric(Quadric),
    Prism(Prism),
}

impl Closed {
    /// That of a shape, which is one of these solids.
    pub(super) fn new(placed: &Placed, shape: &Shape) -> Closed {
        let frustum = |from: DVec3, to: DVec3, radii: [f64; 2]| {
            let (placed, height) = placed.along(from, to);
            Closed { placed, body: Body::Frustum(Frustum { radii, height }) }
        };
        let body = match shape {
            Shape::Cylinder { from, to, radius } => return frustum(*from, *to, [*radius; 2]),
            Shape::Cone { from, to, radius, tip } => return frustum(*from, *to, [*radius, *tip]),
            Shape::Torus { major, minor } => Body::Torus(Torus { major: *major, minor: *minor }),
            Shape::Quadric { squares, products, linear, constant, min, max } => {
                let [squares, products, linear] = [squares, products, linear].map(|c| c.to_array());
                let coefficients = (squares, products, linear, *constant);
                Body::Quadric(Quadric::new(coefficients, [*min, *max]))
            }
            Shape::Prism { outline, bottom, top } => {
                Body::Prism(Prism::new(outline, [*bottom, *top]))
            }
            _ => unreachable!("the other shapes are compiled elsewhere"),
        };
        Closed { placed: *placed, body }
    }

    /// Offers where a ray enters and leaves it beyond its start: the first time only, unless the query
    /// wants all.
    pub(super) fn meet<Q: Query>(&self, ray: &Ray, start: Start, primitive: u32, query: &mut Q) {
        let (o, d) = self.placed.ray_to_object(ray.origin, ray.direction);
        let offer = |spans: Spans, query: &mut Q| {
            for &t in spans.ends().iter().filter(|t| **t > 0.0) {
                query.offer(t, primitive);
                if !Q::ALL {
                    return;
                }
            }
        };
        match &self.body {
            Body::Frustum(frustum) => offer_roots(frustum.roots(o, d, start), primitive, query),
            Body::Torus(torus) => offer(torus.spans(o, d, start), query),
            Body::Quadric(quadric) => offer(quadric.spans(o, d, start), query),
            Body::Prism(prism) => prism.ahead(o, d, start, Q::ALL, |t| query.offer(t, primitive)),
        }
    }

    /// Appends the parameters at which a ray's whole line enters (even places) and leaves (odd places)
    /// the solid, sorted, an even number of them. If the ray starts on the surface, one of them is 0:
    /// an entry if it goes inside, an exit if it goes outside.
    pub(super) fn crossings(&self, ray: &Ray, start: Start, out: &mut Vec<f64>) {
        let (o, d) = self.placed.ray_to_object(ray.origin, ray.direction);
        match &self.body {
            Body::Frustum(frustum) => frustum.crossings(o, d, start, out),
            Body::Torus(torus) => torus.crossings(o, d, start, out),
            Body::Quadric(quadric) => quadric.crossings(o, d, start, out),
            Body::Prism(prism) => prism.crossings(o, d, start, out),
        }
    }

    /// Point and unit normal where a ray meets it at `t`.
    pub(super) fn surface(&self, ray: &Ray, t: f64) -> (DVec3, DVec3) {
        let (o, d) = self.placed.ray_to_object(ray.origin, ray.direction);
        let (point, normal) = match &self.body {
            Body::Frustum(frustum) => frustum.surface(o, d, t),
            Body::Torus(torus) => torus.surface(o, d, t),
            Body::Quadric(quadric) => quadric.surface(o, d, t),
            Body::Prism(prism) => prism.surface(o, d, t),
        };
        (self.placed.point(point), self.placed.normal(normal).normalize())
    }

    /// World corners of a box around it.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let around = |[min, max]: [DVec3; 2]| {
            let half = (max - min) * 0.5;
            let (middle, half) = (self.placed.point(min + half), self.placed.box_extent(half));
            [middle - half, middle + half]
        };
        match &self.body {
            Body::Frustum(frustum) => {
                let discs = frustum.ends().map(|(center, radius)| {
                    let half = self.placed.disc_extent(radius);
                    let center = self.placed.point(center);
                    [center - half, center + half]
                });
                let [[a, b], [c, d]] = discs;
                [a.min(c), b.max(d)]
            }
            Body::Torus(Torus { major, minor }) => {
                let half = self.placed.disc_extent(*major) + self.placed.sphere_extent(*minor);
                let center = self.placed.point(DVec3::ZERO);
                [center - half, center + half]
            }
            Body::Quadric(quadric) => around(quadric.bounds()),
            Body::Prism(prism) => around(prism.bounds()),
        }
    }

    /// u and v at a point of its surface with this geometric normal.
    pub(super) fn uv(&self, point: DVec3, normal: DVec3) -> Uv {
        let p = self.placed.point_to_object(point);
        let normal = self.placed.normal_to_object(normal);
        let (at, gradients) = match &self.body {
            Body::Frustum(frustum) => frustum.uv(p, normal),
            Body::Torus(torus) => torus.uv(p),
            Body::Quadric(quadric) => return uv::block(p, normal, quadric.bounds(), &self.placed),
            Body::Prism(prism) => prism.uv(p, normal),
        };
        Uv { at, gradients: gradients.map(|g| self.placed.normal(g)), poles: false }
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Closed>()
            + match &self.body {
                Body::Prism(prism) => prism.bytes(),
                Body::Frustum(_) | Body::Torus(_) | Body::Quadric(_) => 0,
            }
    }
}
