//! Adds, duplicates, renames and removes lights, materials and solids: each one edit of a scene.

use super::placing::{Stand, aside, fresh};
use crate::scene::{Light, LightPlace, Material, Scene, Shape, Solid};

/// A light, a material or a solid of a scene, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Thing {
    /// The light with this index.
    Light(usize),
    /// The material with this index.
    Material(usize),
    /// The solid with this index.
    Solid(usize),
}

impl Thing {
    /// What it is, as in the names of steps.
    pub fn kind(self) -> &'static str {
        match self {
            Thing::Light(_) => "light",
            Thing::Material(_) => "material",
            Thing::Solid(_) => "solid",
        }
    }

    /// Its name.
    pub fn name(self, scene: &Scene) -> &str {
        match self {
            Thing::Light(i) => &scene.lights[i].name,
            Thing::Material(i) => &scene.materials[i].name,
            Thing::Solid(i) => &scene.solids[i].name,
        }
    }

    fn name_mut(self, scene: &mut Scene) -> &mut String {
        match self {
            Thing::Light(i) => &mut scene.lights[i].name,
            Thing::Material(i) => &mut scene.materials[i].name,
            Thing::Solid(i) => &mut scene.solids[i].name,
        }
    }

    /// Whether there is such a thing in a scene.
    pub fn is_in(self, scene: &Scene) -> bool {
        match self {
            Thing::Light(i) => i < scene.lights.len(),
            Thing::Material(i) => i < scene.materials.len(),
            Thing::Solid(i) => i < scene.solids.len(),
        }
    }

    fn index(self) -> usize {
        let (Thing::Light(i) | Thing::Material(i) | Thing::Solid(i)) = self;
        i
    }

    /// The names of all things of its kind.
    fn names(self, scene: &Scene) -> Vec<&str> {
        match self {
            Thing::Light(_) => scene.lights.iter().map(|light| light.name.as_str()).collect(),
            Thing::Material(_) => material_names(scene),
            Thing::Solid(_) => scene.solids.iter().map(|solid| solid.name.as_str()).collect(),
        }
    }
}

/// A new white light, behind all others, so that no index shifts.
pub fn add_light(scene: &mut Scene, place: LightPlace) -> Thing {
    let name = first_free("light", 1, Thing::Light(0).names(scene));
    scene.lights.push(Light { place, ..Light::new(name) });
    Thing::Light(scene.lights.len() - 1)
}

/// A new matt white material, behind all others, so that no index shifts.
pub fn add_material(scene: &mut Scene) -> Thing {
    let name = free_material_name(scene, "material");
    scene.materials.push(Material::new(name));
    Thing::Material(scene.materials.len() - 1)
}

/// A new solid of a shape with this key in a scene file, behind all others, so that no index shifts;
/// named after its key. What is made of others begins with `operand`; all else is of the material with
/// the index `material`, and of a new one in a scene without materials. A mesh is still to be read.
pub fn add_solid(
    scene: &mut Scene,
    key: &str,
    stand: Stand,
    material: usize,
    operand: usize,
) -> Thing {
    if scene.materials.is_empty() {
        add_material(scene);
    }
    let (mut shape, placement) = fresh(key, &scene.camera, stand);
    if let Shape::Csg { operation: _, operands } = &mut shape {
        *operands = vec![operand];
    }
    let material = material.min(scene.materials.len() - 1);
    let name = first_free(key, 1, Thing::Solid(0).names(scene));
    scene.solids.push(Solid { placement, ..Solid::new(name, shape, material) });
    Thing::Solid(scene.solids.len() - 1)
}

/// The first of `stem`, `stem 2`, `stem 3` … that no material has.
pub(super) fn free_material_name(scene: &Scene, stem: &str) -> String {
    first_free(stem, 1, material_names(scene))
}

/// A copy, behind all others, named `NAME 2` or the next number that is free.
///
/// That of a solid stands [`aside`], so that it is seen. It is a solid of its own also where the original
/// is an operand; where that is made of others, both are made of the same ones.
pub fn duplicate(scene: &mut Scene, thing: Thing) -> Thing {
    let (stem, number) = numbered(thing.name(scene));
    let name = first_free(stem, number + 1, thing.names(scene));
    match thing {
        Thing::Light(i) => {
            scene.lights.push(Light { name, ..scene.lights[i].clone() });
            Thing::Light(scene.lights.len() - 1)
        }
        Thing::Material(i) => {
            scene.materials.push(Material { name, ..scene.materials[i].clone() });
            Thing::Material(scene.materials.len() - 1)
        }
        Thing::Solid(i) => {
            let way = aside(scene, i);
            let mut copy = Solid { name, ..scene.solids[i].clone() };
            copy.placement.translate += way;
            scene.solids.push(copy);
            Thing::Solid(scene.solids.len() - 1)
        }
    }
}

/// The name that a typed text gives a thing, spaces around it aside; or what is wrong with it.
pub fn named<'a>(scene: &Scene, thing: Thing, typed: &'a str) -> Result<&'a str, String> {
    let (name, kind) = (typed.trim(), thing.kind());
    if name.is_empty() {
        return Err(format!("a {kind} needs a name"));
    }
    let same = thing.names(scene).iter().position(|other| *other == name);
    if same.is_some_and(|other| other != thing.index()) {
        return Err(format!("there is another {kind} with the name {name}"));
    }
    Ok(name)
}

/// Gives another name, spaces around it aside; what is wrong with the name, if anything.
pub fn rename(scene: &mut Scene, thing: Thing, name: &str) -> Result<(), String> {
    *thing.name_mut(scene) = named(scene, thing, name)?.to_owned();
    Ok(())
}

/// Takes it out. A material that solids are made of stays, and so does a solid that others are made of:
/// the answer says which. What a solid was made of stays, as solids of their own.
pub fn remove(scene: &mut Scene, thing: Thing) -> Result<(), String> {
    match thing {
        Thing::Light(i) => drop(scene.lights.remove(i)),
        Thing::Material(i) => {
            let users: Vec<&str> =
                users(scene, i).into_iter().map(|i| scene.solids[i].name.as_str()).collect();
            if !users.is_empty() {
                let (name, list) = (&scene.materials[i].name, listed(&users));
                let them = if users.len() == 1 { "it" } else { "them" };
                return Err(format!(
                    "material {name} is used by {list}: give {them} another material first"
                ));
            }
            scene.materials.remove(i);
            for solid in &mut scene.solids {
                solid.material -= usize::from(solid.material > i);
            }
        }
        Thing::Solid(i) => remove_solid(scene, i)?,
    }
    Ok(())
}

fn remove_solid(scene: &mut Scene, removed: usize) -> Result<(), String> {
    let wholes: Vec<&str> =
        wholes(scene, removed).into_iter().map(|i| scene.solids[i].name.as_str()).collect();
    if !wholes.is_empty() {
        let (name, list) = (&scene.solids[removed].name, listed(&wholes));
        return Err(format!("solid {name} is part of {list}: take it out there first"));
    }
    scene.solids.remove(removed);
    for solid in &mut scene.solids {
        if let Shape::Csg { operation: _, operands } = &mut solid.shape {
            operands.iter_mut().for_each(|operand| *operand -= usize::from(*operand > removed));
        }
    }
    Ok(())
}

/// The solids that the solid with this index is an operand of.
pub fn wholes(scene: &Scene, operand: usize) -> Vec<usize> {
    let solids = scene.solids.iter().enumerate();
    let is_whole = |solid: &Solid| solid.shape.operands().contains(&operand);
    solids.filter(|(_, solid)| is_whole(solid)).map(|(i, _)| i).collect()
}

/// The solids made of the material with this index.
pub fn users(scene: &Scene, material: usize) -> Vec<usize> {
    let solids = scene.solids.iter().enumerate();
    let own = |solid: &Solid| !solid.shape.is_composite() && solid.material == material;
    solids.filter(|(_, solid)| own(solid)).map(|(i, _)| i).collect()
}

fn material_names(scene: &Scene) -> Vec<&str> {
    scene.materials.iter().map(|material| material.name.as_str()).collect()
}

/// Most names that a message lists.
const MOST_LISTED: usize = 5;

/// Names in a sentence.
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] if names.len() <= MOST_LISTED => {
            format!("{} and {last}", most.join(", "))
        }
        _ => {
            let first = &names[..MOST_LISTED - 1];
            format!("{} and {} more solids", first.join(", "), names.len() - first.len())
        }
    }
}

/// A name without the number of a duplicate, and that number: 1 if there is none.
fn numbered(name: &str) -> (&str, u64) {
    let parts = name.rsplit_once(' ').filter(|(stem, _)| !stem.is_empty());
    let number = |digits: &str| digits.parse().ok().filter(|n| (2..u64::MAX).contains(n));
    match parts.and_then(|(stem, digits)| Some((stem, number(digits)?))) {
        // `key 02` and `key +2` are nobody's duplicates
        Some((stem, n)) if name == format!("{stem} {n}") => (stem, n),
        _ => (name, 1),
    }
}

/// The first of `stem`, `stem 2`, `stem 3` … from a number on that nobody has.
fn first_free(stem: &str, from: u64, taken: Vec<&str>) -> String {
    let name = |n: u64| if n == 1 { stem.to_owned() } else { format!("{stem} {n}") };
    let free = |name: &String| !taken.contains(&name.as_str());
    (from..).map(name).find(free).expect("there are more numbers than names")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::document::patch::patch;
    use crate::scene::fields::{SHAPES, shape_key};
    use crate::scene::read::{Known, text_with};
    use crate::scene::{check, write::tree};

    const TEXT: &str = r#"version = 1 # first

# the lights
[lights]
key = { point = [1, 2, 3], intensity = 0.5 } # warm
fill = { direction = [0, 0, -1], on = false }

[materials.red] # a colour
color = [1, 0, 0] # pure

# nobody's
[materials.spare]
reflect = 0.5 # half

[materials.blue]
color = [0, 0, 1]

[solids] # all
ball = { sphere = { center = [0, 0, 0], radius = 1 }, material = "red" } # round
cube = { box = { min = [0, 0, 0], max = [1, 1, 1] }, material = "blue" }
"#;

    fn scene() -> Scene {
        text_with(TEXT, Path::new("s.toml"), Known::default()).unwrap()
    }

    /// The text that saving the edited scene gives; it reads back as that scene.
    fn saved(edited: &Scene) -> String {
        saved_over(TEXT, edited)
    }

    /// Comments that a text lacks.
    fn lost(text: &str) -> Vec<&'static str> {
        let comments = TEXT.lines().filter_map(|line| Some(line.split_once("# ")?.1));
        comments.filter(|comment| !text.contains(comment)).collect()
    }

    #[test]
    fn what_is_added_stands_behind_and_every_comment_stays() {
        let mut edited = scene();
        let place = LightPlace::Point(DVec3::new(0.0, 1.5, 2.0));
        assert_eq!(add_light(&mut edited, place.clone()), Thing::Light(2));
        assert_eq!(add_light(&mut edited, place), Thing::Light(3));
        assert_eq!(add_material(&mut edited), Thing::Material(3));
        let text = saved(&edited);
        assert_eq!(lost(&text), [""; 0]);
        let lines = "on = false }\nlight = { point = [0, 1.5, 2] }\n\"light 2\" = { point = [0, 1.5, 2] }\n";
        assert!(text.contains(lines), "{text}");
        assert!(text.contains("[materials.material]\n"), "{text}");
        assert_eq!(
            lost("# first"),
            ["the lights", "warm", "a colour", "pure", "nobody's", "half"]
                .into_iter()
                .chain(["all", "round"])
                .collect::<Vec<_>>(),
            "what is lost is found"
        );
    }

    #[test]
    fn a_duplicate_differs_in_its_name_alone() {
        let mut edited = scene();
        assert_eq!(duplicate(&mut edited, Thing::Light(0)), Thing::Light(2));
        assert_eq!(duplicate(&mut edited, Thing::Light(2)), Thing::Light(3));
        assert_eq!(duplicate(&mut edited, Thing::Light(0)), Thing::Light(4));
        assert_eq!(duplicate(&mut edited, Thing::Material(1)), Thing::Material(3));
        let names: Vec<_> = edited.lights.iter().map(|light| light.name.as_str()).collect();
        assert_eq!(names, ["key", "fill", "key 2", "key 3", "key 4"]);
        let named = |name: &str, light: &Light| Light { name: name.into(), ..light.clone() };
        assert_eq!(edited.lights[3], named("key 3", &edited.lights[0]));
        assert_eq!(edited.materials[3].name, "spare 2");
        assert_eq!(edited.materials[3].reflect, edited.materials[1].reflect);
        let text = saved(&edited);
        assert_eq!(lost(&text), [""; 0]);
        assert!(text.contains("\n\"key 2\" = { point = [1, 2, 3], intensity = 0.5 }\n"), "{text}");
    }

    #[test]
    fn numbers_of_duplicates_are_read_off_the_name() {
        let cases = [("key", ("key", 1)), ("key 2", ("key", 2)), ("key 1", ("key 1", 1))];
        for (name, expected) in cases {
            assert_eq!(numbered(name), expected);
        }
        for name in ["key 02", "key +2", " 2", "2", "key 18446744073709551615", "a  "] {
            assert_eq!(numbered(name), (name, 1));
        }
        assert_eq!(first_free("key 1", 2, vec!["key 1 2"]), "key 1 3");
    }

    #[test]
    fn a_new_name_is_changed_wherever_it_stands() {
        let mut edited = scene();
        rename(&mut edited, Thing::Material(0), " dark red ").unwrap();
        rename(&mut edited, Thing::Light(1), "rim").unwrap();
        let text = saved(&edited);
        assert_eq!(lost(&text), [""; 0]);
        let kept = TEXT.replace("[materials.red]", "[materials.\"dark red\"]");
        let kept = kept.replace("material = \"red\"", "material = \"dark red\"");
        assert_eq!(text, kept.replace("fill =", "rim ="));
    }

    #[test]
    fn names_stay_unique_and_are_never_empty() {
        let mut edited = scene();
        let refused = rename(&mut edited, Thing::Light(1), "key").unwrap_err();
        assert_eq!(refused, "there is another light with the name key");
        let refused = rename(&mut edited, Thing::Material(0), "  ").unwrap_err();
        assert_eq!(refused, "a material needs a name");
        assert!(edited == scene(), "what is refused changes nothing");
        assert_eq!(rename(&mut edited, Thing::Light(1), "fill"), Ok(()));
        assert_eq!(
            rename(&mut edited, Thing::Light(1), "red"),
            Ok(()),
            "a material's name is free"
        );
    }

    #[test]
    fn only_what_nobody_uses_is_removed() {
        let mut edited = scene();
        let refused = remove(&mut edited, Thing::Material(0)).unwrap_err();
        assert_eq!(refused, "material red is used by ball: give it another material first");
        assert!(edited == scene());
        remove(&mut edited, Thing::Material(1)).unwrap();
        remove(&mut edited, Thing::Light(0)).unwrap();
        let [ball, cube] =
            [0, 1].map(|i| edited.materials[edited.solids[i].material].name.as_str());
        assert_eq!([ball, cube], ["red", "blue"]);
        let text = saved(&edited);
        assert_eq!(
            lost(&text),
            ["warm", "nobody's", "half"],
            "what was said of them goes with them"
        );
    }

    /// The scene with a whole of the ball and the cube, and a whole of that.
    fn with_wholes() -> (String, Scene) {
        let wholes = "part = { merge = [\"ball\", \"cube\"] } # both\n\
                      all = { union = [\"part\", \"cube\"] }\n";
        let text = format!("{TEXT}{wholes}");
        let scene = text_with(&text, Path::new("s.toml"), Known::default()).unwrap();
        (text, scene)
    }

    /// The text that saving an edit of a text gives; it reads back as the edited scene.
    fn saved_over(text: &str, edited: &Scene) -> String {
        assert_eq!(check::validate(edited), []);
        let before = text_with(text, Path::new("s.toml"), Known::default()).unwrap();
        let patched = patch(text, &before, edited);
        assert!(!patched.comments_lost);
        let known = || Known::of(edited);
        let back = text_with(&patched.text, Path::new("s.toml"), known()).unwrap();
        assert!(tree(&back) == tree(edited));
        patched.text
    }

    fn solid_names(scene: &Scene) -> Vec<&str> {
        Thing::Solid(0).names(scene)
    }

    #[test]
    fn every_kind_of_solid_is_added_behind_the_others_and_saved() {
        let mut edited = scene();
        let stand = Stand { at: DVec3::new(0.5, 0.0, 1.5), half: 0.7 };
        for (i, key) in SHAPES.iter().enumerate() {
            assert_eq!(add_solid(&mut edited, key, stand, 1, 0), Thing::Solid(2 + i));
            let solid = edited.solids.last().unwrap();
            assert_eq!((shape_key(&solid.shape), solid.name.as_str()), (*key, *key));
            assert_eq!(solid.material, 1);
        }
        assert_eq!(add_solid(&mut edited, "sphere", stand, 99, 0), Thing::Solid(2 + SHAPES.len()));
        let last = edited.solids.last().unwrap();
        assert_eq!((last.name.as_str(), last.material), ("sphere 2", 2));
        let text = saved(&edited);
        assert_eq!(lost(&text), [""; 0]);
        let line = "\nsphere = { sphere = { center = [0, 0, 0], radius = 1 }, material = \"spare\", \
                    translate = [0.5, 0, 1.5], scale = 0.7 }\n";
        assert!(text.contains(line), "{text}");
        assert!(text.contains("\ndifference = { difference = [\"ball\"] }\n"), "{text}");
    }

    #[test]
    fn the_first_solid_of_a_scene_brings_its_material() {
        let text = "version = 1 # empty\n";
        let mut edited = text_with(text, Path::new("s.toml"), Known::default()).unwrap();
        let stand = Stand { at: DVec3::ZERO, half: 1.0 };
        add_solid(&mut edited, "box", stand, 0, 0);
        assert_eq!((edited.materials.len(), edited.solids[0].material), (1, 0));
        assert!(saved_over(text, &edited).starts_with(text));
    }

    #[test]
    fn a_copy_of_a_solid_stands_beside_it_and_is_made_of_the_same() {
        let (text, mut edited) = with_wholes();
        edited.solids[0].motion.translate = DVec3::Y;
        let text = saved_over(&text, &edited);
        assert_eq!(duplicate(&mut edited, Thing::Solid(0)), Thing::Solid(4));
        assert_eq!(duplicate(&mut edited, Thing::Solid(2)), Thing::Solid(5));
        assert_eq!(duplicate(&mut edited, Thing::Solid(5)), Thing::Solid(6));
        let names = ["ball", "cube", "part", "all", "ball 2", "part 2", "part 3"];
        assert_eq!(solid_names(&edited), names);
        let [ball, copy] = [0, 4].map(|i| edited.solids[i].clone());
        assert_eq!(copy.placement.translate, DVec3::X * 2.2);
        let placement = ball.placement.clone();
        assert_eq!(Solid { name: "ball".into(), placement, ..copy }, ball, "all else is the same");
        assert_eq!(edited.solids[5].shape.operands(), [0, 1]);
        assert_eq!(edited.solids[6].placement.translate, DVec3::X * 4.4);
        let written = saved_over(&text, &edited);
        assert!(written.contains("\n\"part 2\" = { merge = [\"ball\", \"cube\"]"), "{written}");
        assert!(written.starts_with(text.trim_end()), "{written}");
        // what is copied and deleted again leaves nothing
        for i in [6, 5, 4] {
            remove(&mut edited, Thing::Solid(i)).unwrap();
        }
        assert_eq!(saved_over(&text, &edited), text);
    }

    #[test]
    fn an_operand_stays_and_says_of_what_and_a_whole_frees_its_operands() {
        let (text, mut edited) = with_wholes();
        let before = edited.clone();
        let refused = [0, 1, 2].map(|i| remove(&mut edited, Thing::Solid(i)).unwrap_err());
        let [ball, cube, part] = refused;
        assert_eq!(ball, "solid ball is part of part: take it out there first");
        assert_eq!(cube, "solid cube is part of part and all: take it out there first");
        assert_eq!(part, "solid part is part of all: take it out there first");
        assert!(edited == before, "what is refused changes nothing");
        remove(&mut edited, Thing::Solid(3)).unwrap();
        remove(&mut edited, Thing::Solid(2)).unwrap();
        assert_eq!(solid_names(&edited), ["ball", "cube"]);
        assert_eq!(edited.is_operand(), [false, false]);
        assert_eq!(saved_over(&text, &edited), TEXT);
    }

    #[test]
    fn operands_are_the_same_solids_when_others_are_gone() {
        let (text, mut edited) = with_wholes();
        let Shape::Csg { operation: _, operands } = &mut edited.solids[2].shape else {
            panic!("a whole")
        };
        operands.retain(|operand| *operand == 1);
        remove(&mut edited, Thing::Solid(0)).unwrap();
        let made_of = |whole: usize| -> Vec<&str> {
            let operands = edited.solids[whole].shape.operands();
            operands.iter().map(|i| edited.solids[*i].name.as_str()).collect()
        };
        assert_eq!((made_of(1), made_of(2)), (vec!["cube"], vec!["part", "cube"]));
        let written = saved_over(&text, &edited);
        assert!(written.contains("part = { merge = [\"cube\"] } # both\n"), "{written}");
    }

    #[test]
    fn a_solid_is_renamed_wherever_it_stands_and_names_stay_unique() {
        let (text, mut edited) = with_wholes();
        let refused = rename(&mut edited, Thing::Solid(0), "cube").unwrap_err();
        assert_eq!(refused, "there is another solid with the name cube");
        assert_eq!(rename(&mut edited, Thing::Solid(0), "red"), Ok(()), "a material's is free");
        rename(&mut edited, Thing::Solid(1), "the cube").unwrap();
        let expected = text.replace("ball", "red").replace("\"cube\"", "\"the cube\"");
        assert_eq!(saved_over(&text, &edited), expected.replace("cube =", "\"the cube\" ="));
    }

    #[test]
    fn all_solids_may_go_and_no_reference_is_left() {
        let (text, mut edited) = with_wholes();
        for i in (0..4).rev() {
            remove(&mut edited, Thing::Solid(i)).unwrap();
        }
        assert!(edited.solids.is_empty());
        saved_over(&text, &edited);
    }

    #[test]
    fn a_list_of_names_ends_in_time() {
        assert_eq!(listed(&["a", "b"]), "a and b");
        assert_eq!(listed(&["a", "b", "c", "d", "e"]), "a, b, c, d and e");
        assert_eq!(listed(&["a", "b", "c", "d", "e", "f"]), "a, b, c, d and 2 more solids");
    }
}
