//! Names a step of the history by what it changed, such as `diffuse of tiles 0.70 → 0.42`.

use super::patch::renamed;
use crate::color::{Rgb, srgb_byte};
use crate::scene::fields::{self, BUMPS, TEXTURES, Visit};
use crate::scene::look::Looks;
use crate::scene::value::Names;
use crate::scene::write::{Content, Node, nodes};
use crate::scene::{Material, Scene};

/// What differs from `before` to `after`; only things that differ are looked into.
pub(super) fn name(before: &Scene, after: &Scene) -> String {
    if let Some(name) = lists(before, after).or_else(|| looks(before, after)) {
        return name;
    }
    let differences = differences(before, after);
    match differences.as_slice() {
        [] => "no change".to_owned(),
        [one] => one.name(),
        [first, rest @ ..] if rest.iter().all(|other| other.owner == first.owner) => {
            match &first.owner {
                Owner::Table("camera") => "camera".to_owned(),
                owner => format!("{} parameters{}", differences.len(), owner.of()),
            }
        }
        all => format!("{} parameters", all.len()),
    }
}

/// Name of a step that adds, removes, renames or moves something.
fn lists(before: &Scene, after: &Scene) -> Option<String> {
    let lights = |scene: &Scene| scene.lights.iter().map(|l| l.name.clone()).collect();
    let materials = |scene: &Scene| scene.materials.iter().map(|m| m.name.clone()).collect();
    let solids = |scene: &Scene| scene.solids.iter().map(|s| s.name.clone()).collect();
    let list = |kind: &str, old: Vec<String>, new: Vec<String>| list(kind, &old, &new);
    list("light", lights(before), lights(after))
        .or_else(|| list("material", materials(before), materials(after)))
        .or_else(|| list("solid", solids(before), solids(after)))
}

/// Name of a step that adds, removes, renames or changes looks.
fn looks(before: &Scene, after: &Scene) -> Option<String> {
    let names = |scene: &Scene| scene.looks.list.iter().map(|look| look.name.clone()).collect();
    let (old, new): (Vec<String>, Vec<String>) = (names(before), names(after));
    list("look", &old, &new).or_else(|| match (before.looks.worn(), after.looks.worn()) {
        (before, after) if before == after => None,
        (_, Some(name)) => Some(format!("look {name}")),
        (_, None) => Some("no look".to_owned()),
    })
}

fn list(kind: &str, old: &[String], new: &[String]) -> Option<String> {
    if old == new {
        return None;
    }
    if let [(from, to)] = renamed(old, new).as_slice() {
        return Some(format!("rename {kind} {from} → {to}"));
    }
    let only = |a: &[String], b: &[String]| -> Vec<String> {
        a.iter().filter(|name| !b.contains(name)).cloned().collect()
    };
    let (gone, fresh) = (only(old, new), only(new, old));
    Some(match (gone.as_slice(), fresh.as_slice()) {
        ([], []) => format!("order of {kind}s"),
        ([], [one]) => format!("add {kind} {one}"),
        ([one], []) => format!("remove {kind} {one}"),
        ([], many) => format!("add {} {kind}s", many.len()),
        (many, []) => format!("remove {} {kind}s", many.len()),
        _ => format!("other {kind}s"),
    })
}

/// What a parameter belongs to.
#[derive(Clone, Debug, PartialEq)]
enum Owner {
    /// A table of the scene, or the root by the empty name.
    Table(&'static str),
    Light(String),
    /// A material or a solid.
    Thing(String),
}

impl Owner {
    fn of(&self) -> String {
        match self {
            Owner::Table("") => " of the scene".to_owned(),
            Owner::Table(table) => format!(" of {table}"),
            Owner::Light(name) => format!(" of light {name}"),
            Owner::Thing(name) => format!(" of {name}"),
        }
    }
}

/// A parameter that has another value, or that only one of the two scenes has.
struct Difference {
    owner: Owner,
    key: String,
    old: Option<String>,
    new: Option<String>,
}

impl Difference {
    fn name(&self) -> String {
        let Difference { owner, key, old, new } = self;
        // keys of the scene's own tables speak for themselves, but for these
        let of = match owner {
            Owner::Table(_) if key != "color" && key != "up" => String::new(),
            owner => owner.of(),
        };
        match (old, new) {
            (Some(_), Some(new)) if key == "on" => {
                let name = match owner {
                    Owner::Light(name) => name,
                    _ => "",
                };
                format!("light {name} {}", if new == "true" { "on" } else { "off" })
            }
            (Some(old), Some(new)) => match values(key, old, new) {
                Some((old, new)) => format!("{key}{of} {old} → {new}"),
                None => format!("{key}{of}"),
            },
            // another variant: only its key is known
            (Some(_), None) | (None, _) => format!("{key}{of}"),
        }
    }
}

fn differences(before: &Scene, after: &Scene) -> Vec<Difference> {
    let (old_names, new_names) = (Names::of(before), Names::of(after));
    let mut all = Vec::new();
    let mut compare = |owner: Owner, old: Vec<Node>, new: Vec<Node>| {
        collect(&owner, "", &old, &new, &mut all);
    };
    let tables = |scene: &Scene, names: &Names| {
        let bare = Scene {
            lights: Vec::new(),
            materials: Vec::new(),
            solids: Vec::new(),
            ambient_light: scene.ambient_light,
            picture: scene.picture.clone(),
            camera: scene.camera.clone(),
            background: scene.background.clone(),
            trace: scene.trace.clone(),
            looks: Looks::default(),
        };
        nodes(names, &mut |v: &mut dyn Visit| fields::scene(&mut bare.clone(), v))
    };
    let pairs = tables(before, &old_names).into_iter().zip(tables(after, &new_names));
    for (old, new) in pairs {
        let table = ["camera", "picture", "trace", "background"];
        match table.iter().find(|table| **table == old.key) {
            Some(table) => compare(Owner::Table(table), inside(old), inside(new)),
            None => compare(Owner::Table(""), vec![old], vec![new]),
        }
    }
    for (old, new) in before.lights.iter().zip(&after.lights).filter(|(old, new)| old != new) {
        let tree = |light: &crate::scene::Light| {
            nodes(&old_names, &mut |v: &mut dyn Visit| fields::light(&mut light.clone(), v))
        };
        compare(Owner::Light(new.name.clone()), tree(old), tree(new));
    }
    for (old, new) in before.materials.iter().zip(&after.materials).filter(|(old, new)| old != new)
    {
        let tree = |material: &Material| {
            nodes(&old_names, &mut |v: &mut dyn Visit| fields::material(&mut material.clone(), v))
        };
        compare(Owner::Thing(new.name.clone()), tree(old), tree(new));
    }
    for (old, new) in before.solids.iter().zip(&after.solids).filter(|(old, new)| old != new) {
        let tree = |solid: &crate::scene::Solid, names: &Names| {
            nodes(names, &mut |v: &mut dyn Visit| fields::solid(&mut solid.clone(), v))
        };
        compare(Owner::Thing(new.name.clone()), tree(old, &old_names), tree(new, &new_names));
    }
    all
}

fn inside(node: Node) -> Vec<Node> {
    match node.content {
        Content::Table(inside) => inside,
        Content::Value(_) => vec![node],
    }
}

/// Notes every leaf that differs; of a variant that is gone only the new one's key.
fn collect(owner: &Owner, table: &str, old: &[Node], new: &[Node], all: &mut Vec<Difference>) {
    for node in new {
        // the colours of a pattern are told apart from the surface's by its name
        let key = match table {
            _ if is_pattern(table) => format!("{table} {}", node.key),
            _ => node.key.clone(),
        };
        let other = old.iter().find(|other| other.key == node.key);
        match (other.map(|other| &other.content), &node.content) {
            (Some(Content::Value(old)), Content::Value(new)) if old == new => {}
            (Some(Content::Value(old)), Content::Value(new)) => all.push(Difference {
                owner: owner.clone(),
                key,
                old: Some(old.clone()),
                new: Some(new.clone()),
            }),
            (Some(Content::Table(old)), Content::Table(new)) => {
                collect(owner, &node.key, old, new, all);
            }
            _ => all.push(Difference { owner: owner.clone(), key, old: None, new: None }),
        }
    }
}

/// Whether the keys of a table say little without it.
fn is_pattern(table: &str) -> bool {
    table != "color" && TEXTURES.iter().chain(BUMPS).any(|key| *key == table)
}

/// Both values in short, told apart; `None` if they are too long to show.
fn values(key: &str, old: &str, new: &str) -> Option<(String, String)> {
    if let (Some(old), Some(new)) = (text(old), text(new)) {
        return Some((old, new));
    }
    let (old, new) = (numbers(old)?, numbers(new)?);
    let last = key.rsplit(' ').next().unwrap_or_default();
    let is_color = ["color", "filter", "ambient_light"].contains(&key)
        || ["a", "b", "tint", "below", "level", "above"].contains(&last) && last != key;
    let pair = if is_color { hex(&old).zip(hex(&new)) } else { None };
    pair.filter(|(old, new)| old != new).or_else(|| Some(short(&old, &new)))
}

/// The inside of a quoted string.
fn text(value: &str) -> Option<String> {
    let inside = value.strip_prefix('"')?.strip_suffix('"')?;
    Some(inside.replace("\\\"", "\"").replace("\\\\", "\\"))
}

/// One number, or the numbers of an array.
fn numbers(value: &str) -> Option<Vec<f64>> {
    let inside = value.strip_prefix('[').and_then(|value| value.strip_suffix(']'));
    inside.unwrap_or(value).split(',').map(|number| number.trim().parse().ok()).collect()
}

/// A colour of channels 0 … 1 in sRGB.
fn hex(channels: &[f64]) -> Option<String> {
    let [r, g, b] = match channels {
        [one] => [*one; 3],
        [r, g, b] => [*r, *g, *b],
        _ => return None,
    };
    let inside = [r, g, b].iter().all(|channel| (0.0..=1.0).contains(channel));
    let bytes = Rgb([r as f32, g as f32, b as f32]).0.map(srgb_byte);
    inside.then(|| format!("#{:02x}{:02x}{:02x}", bytes[0], bytes[1], bytes[2]))
}

/// Enough to tell any two numbers apart.
const MOST_DIGITS: usize = 17;

/// As few digits as tell the two apart and are within a half per cent of the larger number.
fn short(old: &[f64], new: &[f64]) -> (String, String) {
    let all = || old.iter().chain(new);
    let largest = all().fold(0.0f64, |largest, x| largest.max(x.abs()));
    let is_plain = largest == 0.0 || (1e-3..1e7).contains(&largest);
    let mut digits = 0;
    loop {
        let one = |x: &f64| match is_plain {
            // whole numbers need no zeros
            true if x.fract() == 0.0 => format!("{x:.0}"),
            true => format!("{x:.digits$}"),
            false => format!("{x:.digits$e}"),
        };
        // as numbers: 1.00 is not told apart from 1
        let rounded = |x: &f64| one(x).parse::<f64>().unwrap_or(*x);
        let exact = |x: &f64| (rounded(x) - x).abs() <= 0.005 * largest;
        let each = |numbers: &[f64]| numbers.iter().map(one).collect::<Vec<_>>();
        let list = |numbers: &[f64]| match numbers {
            [number] => one(number),
            numbers => format!("[{}]", each(numbers).join(", ")),
        };
        let count = old.len().max(new.len());
        let mut pairs = old.iter().cycle().zip(new.iter().cycle()).take(count);
        let is_told_apart = pairs.any(|(old, new)| rounded(old) != rounded(new));
        if digits == MOST_DIGITS || (all().all(exact) && is_told_apart) {
            return (list(old), list(new));
        }
        digits += 1;
    }
}
