//! Rays still to be followed, and what kept trees know of them.

use super::sampling::ROOT_PATH;
use super::scope::At;
use super::sink::Side;
use super::tree::Branch;
use crate::geometry::{Leaving, Ray};
use crate::scene::factor::PathWeight;

/// A ray still to be followed.
pub(super) struct Pending {
    pub(super) ray: Ray,
    /// Of the path from the eye to the ray's origin.
    pub(super) length: f64,
    pub(super) leaving: Option<Leaving>,
    /// The hash of its string of reflections and transmissions.
    pub(super) way: u32,
    pub(super) path: PathWeight,
    /// Product of Fresnel's reflectances on the path.
    pub(super) geometric: f32,
    pub(super) parent: Option<(u32, Side)>,
    pub(super) medium: u32,
    /// Whether other surfaces coincide with the one that it starts on.
    pub(super) touching: bool,
    pub(super) known: Known,
    /// Where it stands in the scope: only what a [scope](super::scope::Scope) names is grown.
    pub(super) scope: At,
}

impl Pending {
    /// A ray from the eye.
    #[inline(always)]
    pub(super) fn eye(ray: Ray, medium: u32, known: Known, scope: At) -> Pending {
        Pending {
            ray,
            length: 0.0,
            leaving: None,
            way: ROOT_PATH,
            path: PathWeight::EYE,
            geometric: 1.0,
            parent: None,
            medium,
            touching: false,
            known,
            scope,
        }
    }
}

/// What kept trees know of a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    /// Nothing: it is cast.
    Nothing,
    /// Its node is the next one of the kept trees.
    Hit,
    /// It left the scene.
    Missed,
    /// Nothing, but the next node of the kept trees, and all below it, is of no use: in its place
    /// stood another ray.
    Another,
    /// It is followed no longer: the next node, and all below it, is of no use.
    Dropped,
    /// Its node is the next one, and it and all below it stay as they are.
    Kept,
}

/// What kept trees know of the rays of a node's branch, in front of which the same ray arrived. `ray`
/// says whether the branch's ray is the same too, `followed` whether it is wanted.
pub(super) fn known(before: Option<Branch>, ray: bool, followed: bool) -> Known {
    match before {
        Some(Branch::Grown) if !followed => Known::Dropped,
        Some(Branch::Grown) if ray => Known::Hit,
        Some(Branch::Grown) => Known::Another,
        Some(Branch::Missed) if ray => Known::Missed,
        _ => Known::Nothing,
    }
}
