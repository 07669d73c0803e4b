//! A solid made of others as regions of one density each.
//!
//! A point of a solid has the material of the first of its operands, in the order in which they are
//! written, that holds the point: where two overlap, the first one is there. What is cut out has no
//! material of its own, and the complement of a solid has none either.

use super::grid::Region;
use super::{MassError, Stuff};
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::csg::Operation;
use crate::scene::motion::Motion;
use crate::scene::{Scene, Shape, Solid};

/// A part of a solid: a solid that was added to the scene, or was there, and its material.
#[derive(Clone, Copy)]
struct Part {
    solid: usize,
    material: usize,
}

/// The regions of the first solid of a scene, and what they are made of; `density` is that of all
/// materials if it is given. One region if all of it has one density.
pub(super) fn regions(
    mut scene: Scene,
    density: Option<f64>,
    progress: &Progress,
) -> Result<(Vec<Region>, Vec<Stuff>), MassError> {
    let of = |scene: &Scene, material: usize| {
        let own = scene.materials.get(material).map_or(1.0, |material| material.density);
        density.unwrap_or(own)
    };
    let mut whole = scene.clone();
    let parts = parts(&mut scene, 0);
    let mut made_of: Vec<Stuff> = Vec::new();
    for &Part { solid: _, material } in &parts {
        let name = scene.materials.get(material).map_or("", |material| &material.name);
        if made_of.iter().all(|stuff| stuff.material != name) {
            made_of.push(Stuff { material: name.to_owned(), density: of(&scene, material) });
        }
    }
    let Some(first) = made_of.first() else { return Err(MassError::Endless) };
    let built = |scene: &Scene, density: f64| -> Result<Region, MassError> {
        Ok(Region { geometry: Geometry::build(scene, progress)?, density })
    };
    let regions = if made_of.iter().all(|stuff| stuff.density == first.density) {
        vec![built(&whole, first.density)?]
    } else {
        let region = |part: &Part| {
            whole.solids = with_operands(&scene, part.solid);
            built(&whole, of(&scene, part.material))
        };
        parts.iter().map(region).collect::<Result<_, _>>()?
    };
    Ok((regions, made_of))
}

/// Splits a solid into parts of one material each, in the space around it; adds solids to the scene.
fn parts(scene: &mut Scene, solid: usize) -> Vec<Part> {
    let Solid { name: _, shape, material, placement, motion: _ } = scene.solids[solid].clone();
    let Shape::Csg { operation, operands } = shape else { return vec![Part { solid, material }] };
    let mut all = Vec::new();
    for (place, &operand) in operands.iter().enumerate() {
        let (how, others) = match operation {
            Operation::Union | Operation::Merge => (Operation::Difference, &operands[..place]),
            Operation::Difference => (operation, &operands[1..]),
            // All operands are there: the first one that has a material tells it.
            Operation::Intersection => (operation, &operands[..]),
            Operation::Complement => break,
        };
        for Part { solid: part, material } in parts(scene, operand) {
            let made = [&[part], others].concat();
            let shape = Shape::Csg { operation: how, operands: made };
            let own = Solid { placement: placement.clone(), ..Solid::new("", shape, material) };
            scene.solids.push(own);
            all.push(Part { solid: scene.solids.len() - 1, material });
        }
        let is_known = operation == Operation::Difference
            || (operation == Operation::Intersection && !all.is_empty());
        if is_known {
            break;
        }
    }
    all
}

/// A solid and all that it is made of, at rest; it comes first.
pub(super) fn with_operands(scene: &Scene, solid: usize) -> Vec<Solid> {
    let mut needed = vec![solid];
    let mut place = vec![None; scene.solids.len()];
    place[solid] = Some(0);
    let mut next = 0;
    while let Some(&index) = needed.get(next) {
        next += 1;
        for &operand in scene.solids[index].shape.operands() {
            place[operand].get_or_insert_with(|| {
                needed.push(operand);
                needed.len() - 1
            });
        }
    }
    let at_rest = |index: usize| {
        let mut own = Solid { motion: Motion::default(), ..scene.solids[index].clone() };
        if let Shape::Csg { operation: _, operands } = &mut own.shape {
            operands.iter_mut().for_each(|operand| *operand = place[*operand].unwrap_or(0));
        }
        own
    };
    needed.into_iter().map(at_rest).collect()
}
