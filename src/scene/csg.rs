//! Solids made of other solids: the operations, which solids are operands, and what cannot be one.

use super::check::Flaw;
use super::seams::Seams;
use super::{Scene, Shape};

/// Largest number of plain solids that one is made of; one that serves twice counts twice.
pub const MOST_PARTS: u64 = 1 << 16;
/// How deep solids may be made of solids.
pub const MOST_DEEP: u64 = 256;

/// What a solid made of others is the set of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// What is in any operand; by itself it keeps the surfaces that its operands have in each other.
    Union,
    /// What is in any operand: only its outer boundary is a surface.
    Merge,
    /// What is in every operand.
    Intersection,
    /// What is in the first operand and in none of the others.
    Difference,
    /// What is in no operand.
    Complement,
}

impl Operation {
    /// Every operation.
    pub const ALL: [Operation; 5] = [
        Operation::Union,
        Operation::Merge,
        Operation::Intersection,
        Operation::Difference,
        Operation::Complement,
    ];

    /// Its key in the scene file.
    pub fn key(self) -> &'static str {
        match self {
            Operation::Union => "union",
            Operation::Merge => "merge",
            Operation::Intersection => "intersection",
            Operation::Difference => "difference",
            Operation::Complement => "complement",
        }
    }

    /// The one whose key is `key`.
    pub fn named(key: &str) -> Option<Operation> {
        Operation::ALL.into_iter().find(|operation| operation.key() == key)
    }
}

impl Shape {
    /// The solids that it is made of: indices into `Scene::solids`.
    pub fn operands(&self) -> &[usize] {
        match self {
            Shape::Csg { operation: _, operands } => operands,
            _ => &[],
        }
    }

    /// Whether it is made of other solids: then it has no material of its own.
    pub fn is_composite(&self) -> bool {
        matches!(self, Shape::Csg { .. })
    }
}

impl Scene {
    /// Per solid whether another one is made of it: then it is not seen by itself.
    pub fn is_operand(&self) -> Vec<bool> {
        let mut known = vec![false; self.solids.len()];
        for &operand in self.solids.iter().flat_map(|solid| solid.shape.operands()) {
            if let Some(known) = known.get_mut(operand) {
                *known = true;
            }
        }
        known
    }
}

impl Scene {
    /// Why a solid cannot be one more operand of `whole`; `None` if it can.
    pub fn operand_refusal(&self, whole: usize, operand: usize) -> Option<String> {
        let name = |solid: usize| self.solids[solid].name.as_str();
        let mut open = vec![operand];
        let mut seen = vec![false; self.solids.len()];
        while let Some(at) = open.pop() {
            if at == whole {
                let whole = name(whole);
                return Some(match at == operand {
                    true => format!("`{whole}` cannot be made of itself"),
                    false => format!("`{}` is made of `{whole}`", name(operand)),
                });
            }
            if !std::mem::replace(&mut seen[at], true) {
                open.extend(self.solids[at].shape.operands());
            }
        }
        unfit(self, operand).map(|(message, help)| format!("{message}: {help}"))
    }
}

/// What is wrong with the solids of a scene that are made of others.
pub(super) fn flaws(scene: &Scene) -> Vec<Flaw> {
    let mut flaws = Vec::new();
    let mut closed = vec![None; scene.solids.len()];
    for solid in &scene.solids {
        let Shape::Csg { operation, operands } = &solid.shape else { continue };
        let mut report = |message: String, help: &str| {
            let path = ["solids", &solid.name, operation.key()];
            flaws.push(Flaw::new(&path, message, help));
        };
        if operands.is_empty() {
            report("it has no operands".to_owned(), "name the solids that it is made of");
        }
        for &operand in operands {
            let known = closed.get_mut(operand);
            let fault = known.map(|known| known.get_or_insert_with(|| unfit(scene, operand)));
            match fault {
                None => report(format!("there is no solid number {operand}"), "name a solid"),
                Some(Some((message, help))) => report(message.clone(), help),
                Some(None) => {}
            }
        }
    }
    flaws.extend(nesting(scene));
    flaws
}

/// Why a solid cannot be an operand, with a way out.
fn unfit(scene: &Scene, operand: usize) -> Option<(String, &'static str)> {
    let solid = &scene.solids[operand];
    let name = &solid.name;
    match &solid.shape {
        Shape::Polygon { .. } => {
            let help = "take a solid that has an inside, such as a thin box";
            Some((format!("the polygon `{name}` has no inside to be an operand"), help))
        }
        Shape::Sphereflake { .. } => {
            let help = "take single spheres, or a `merge` of some";
            Some((format!("the sphereflake `{name}` is too many solids to be an operand"), help))
        }
        Shape::Mesh { file: _, mesh } => match mesh.seams() {
            Seams::Closed => None,
            Seams::Empty => {
                let help = "take a mesh that has triangles";
                Some((format!("the mesh of `{name}` is empty and cannot be an operand"), help))
            }
            Seams::Open([a, b]) => {
                let [from, to] = [a, b].map(|v| mesh.positions[v as usize]);
                let help = "close the mesh: every edge belongs to two triangles, which run along it \
                            in opposite directions";
                let message = format!(
                    "the mesh of `{name}` is not closed and cannot be an operand: see its edge from \
                     [{}, {}, {}] to [{}, {}, {}]",
                    from.x, from.y, from.z, to.x, to.y, to.z
                );
                Some((message, help))
            }
        },
        _ => None,
    }
}

/// What is wrong with how solids are made of each other.
fn nesting(scene: &Scene) -> Option<Flaw> {
    let order = match operands_first(scene) {
        Ok(order) => order,
        Err(flaw) => return Some(flaw),
    };
    let mut sizes = vec![(1u64, 0u64); scene.solids.len()];
    for solid in order {
        let Shape::Csg { operation, operands } = &scene.solids[solid].shape else { continue };
        let known = || operands.iter().filter_map(|&operand| sizes.get(operand));
        let parts = known().fold(0u64, |sum, (parts, _)| sum.saturating_add(*parts));
        let depth = known().map(|(_, depth)| depth + 1).max().unwrap_or(1);
        sizes[solid] = (parts, depth);
        let message = if parts > MOST_PARTS {
            format!("it is made of {parts} parts: at most {MOST_PARTS}")
        } else if depth > MOST_DEEP {
            format!("solids are made of solids {depth} deep: at most {MOST_DEEP}")
        } else {
            continue;
        };
        let path = ["solids", &scene.solids[solid].name, operation.key()];
        return Some(Flaw::new(&path, message, "make it of fewer solids"));
    }
    None
}

/// All solids, each after those that it is made of; or what is, in the end, made of itself.
fn operands_first(scene: &Scene) -> Result<Vec<usize>, Flaw> {
    /// How far the walk is with a solid.
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        Unseen,
        Open,
        Done,
    }
    let mut marks = vec![Mark::Unseen; scene.solids.len()];
    let mut order = Vec::with_capacity(marks.len());
    for start in 0..scene.solids.len() {
        if marks[start] == Mark::Done {
            continue;
        }
        // A solid and how many of its operands were walked.
        let mut way = vec![(start, 0)];
        while let Some((at, walked)) = way.pop() {
            marks[at] = Mark::Open;
            let Some(&next) = scene.solids[at].shape.operands().get(walked) else {
                marks[at] = Mark::Done;
                order.push(at);
                continue;
            };
            way.push((at, walked + 1));
            match marks.get(next) {
                Some(Mark::Open) => return Err(made_of_itself(scene, &way, next)),
                Some(Mark::Unseen) => way.push((next, 0)),
                Some(Mark::Done) | None => {}
            }
        }
    }
    Ok(order)
}

/// Most names of a circle that a message lists.
const MOST_NAMED: usize = 8;

fn made_of_itself(scene: &Scene, way: &[(usize, usize)], again: usize) -> Flaw {
    let name = |solid: usize| scene.solids[solid].name.as_str();
    let circle = way.iter().skip_while(|(solid, _)| *solid != again).map(|(solid, _)| name(*solid));
    let mut circle: Vec<String> = circle.map(|name| format!("`{name}`")).collect();
    circle.push(format!("`{}`", name(again)));
    if circle.len() > MOST_NAMED {
        let left = circle.len() + 1 - MOST_NAMED;
        circle.splice(MOST_NAMED - 2..circle.len() - 1, [format!("{left} more")]);
    }
    let key = match &scene.solids[again].shape {
        Shape::Csg { operation, operands: _ } => operation.key(),
        _ => "",
    };
    let message = format!("a solid cannot be made of itself: {}", circle.join(" of "));
    Flaw::new(&["solids", name(again), key], message, "take one of them out")
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::scene::mesh::Mesh;
    use crate::scene::{Material, Solid};

    fn scene(solids: &[(&str, Shape)]) -> Scene {
        let solid = |(name, shape): &(&str, Shape)| Solid::new(*name, shape.clone(), 0);
        Scene {
            materials: vec![Material::new("m")],
            solids: solids.iter().map(solid).collect(),
            ..Scene::default()
        }
    }

    fn csg(operation: Operation, operands: &[usize]) -> Shape {
        Shape::Csg { operation, operands: operands.to_vec() }
    }

    fn messages(scene: &Scene) -> Vec<String> {
        flaws(scene)
            .into_iter()
            .map(|flaw| format!("{}: {}", flaw.path.join("."), flaw.message))
            .collect()
    }

    #[test]
    fn an_operand_may_serve_twice_but_not_itself() {
        use Operation::{Difference, Merge, Union};
        let ball = || ("ball", Shape::named("sphere"));
        let fine = scene(&[ball(), ("a", csg(Difference, &[0, 0])), ("b", csg(Merge, &[1, 0, 1]))]);
        assert_eq!(messages(&fine), [""; 0]);
        assert_eq!(fine.is_operand(), [true, true, false]);
        let knotted = scene(&[
            ball(),
            ("a", csg(Difference, &[0, 2])),
            ("b", csg(Union, &[0, 3])),
            ("c", csg(Merge, &[1])),
        ]);
        assert_eq!(
            messages(&knotted),
            ["solids.a.difference: a solid cannot be made of itself: `a` of `b` of `c` of `a`"]
        );
        let own = scene(&[("a", csg(Union, &[0])), ("b", csg(Union, &[]))]);
        assert_eq!(
            messages(&own),
            [
                "solids.b.union: it has no operands",
                "solids.a.union: a solid cannot be made of itself: `a` of `a`"
            ]
        );
    }

    #[test]
    fn a_long_circle_is_told_in_short() {
        let names: Vec<String> = (0..100_000).map(|i| format!("s{i}")).collect();
        let next = |i: usize| csg(Operation::Merge, &[(i + 1) % names.len()]);
        let solids: Vec<(&str, Shape)> =
            names.iter().enumerate().map(|(i, name)| (name.as_str(), next(i))).collect();
        assert_eq!(
            messages(&scene(&solids)),
            ["solids.s0.merge: a solid cannot be made of itself: `s0` of `s1` of `s2` of `s3` of \
              `s4` of `s5` of 99994 more of `s0`"]
        );
    }

    #[test]
    fn what_may_become_an_operand() {
        use Operation::{Difference, Merge};
        let scene = scene(&[
            ("ball", Shape::named("sphere")),
            ("sheet", Shape::named("polygon")),
            ("a", csg(Difference, &[0])),
            ("b", csg(Merge, &[2, 0])),
            ("c", csg(Merge, &[3])),
        ]);
        let refusal = |whole, operand| scene.operand_refusal(whole, operand).unwrap_or_default();
        for (whole, operand) in [(2, 0), (3, 0), (3, 2), (4, 2), (4, 3)] {
            assert_eq!(refusal(whole, operand), "");
        }
        assert_eq!(refusal(2, 2), "`a` cannot be made of itself");
        assert_eq!(refusal(2, 3), "`b` is made of `a`");
        assert_eq!(refusal(2, 4), "`c` is made of `a`");
        let sheet = "the polygon `sheet` has no inside to be an operand: take a solid that has an \
                     inside, such as a thin box";
        assert_eq!(refusal(2, 1), sheet);
    }

    #[test]
    fn what_grows_without_end_is_refused() {
        // Each is made of the one before it, twice.
        let name = |i: usize| format!("s{i}");
        let names: Vec<String> = (0..300).map(name).collect();
        let nested = |twice: bool| {
            let shape = |i: usize| match i.checked_sub(1) {
                None => Shape::named("sphere"),
                Some(below) if twice => csg(Operation::Merge, &[below, below]),
                Some(below) => csg(Operation::Merge, &[below]),
            };
            let solids: Vec<(&str, Shape)> =
                names.iter().enumerate().map(|(i, name)| (name.as_str(), shape(i))).collect();
            messages(&scene(&solids))
        };
        assert_eq!(nested(true), ["solids.s17.merge: it is made of 131072 parts: at most 65536"]);
        let deep = ["solids.s257.merge: solids are made of solids 257 deep: at most 256"];
        assert_eq!(nested(false), deep);
    }

    #[test]
    fn what_has_no_inside_is_refused_with_the_edge() {
        let mesh = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]],
            ..Mesh::default()
        };
        let open = Shape::Mesh { file: "open.obj".into(), mesh: Arc::new(mesh) };
        let scene = scene(&[
            ("open", open),
            ("sheet", Shape::named("polygon")),
            ("cut", csg(Operation::Difference, &[0, 1])),
        ]);
        assert_eq!(
            messages(&scene),
            [
                "solids.cut.difference: the mesh of `open` is not closed and cannot be an operand: \
                 see its edge from [0, 0, 0] to [0, 1, 0]",
                "solids.cut.difference: the polygon `sheet` has no inside to be an operand"
            ]
        );
    }
}
