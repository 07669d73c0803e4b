//! Adds, duplicates, renames and removes lights and materials: each one edit of a scene.

use crate::scene::{Light, LightPlace, Material, Scene, Solid};

/// A light or a material of a scene, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Thing {
    /// The light with this index.
    Light(usize),
    /// The material with this index.
    Material(usize),
}

impl Thing {
    /// What it is, as in the names of steps.
    pub fn kind(self) -> &'static str {
        match self {
            Thing::Light(_) => "light",
            Thing::Material(_) => "material",
        }
    }

    /// Its name.
    pub fn name(self, scene: &Scene) -> &str {
        match self {
            Thing::Light(i) => &scene.lights[i].name,
            Thing::Material(i) => &scene.materials[i].name,
        }
    }

    fn name_mut(self, scene: &mut Scene) -> &mut String {
        match self {
            Thing::Light(i) => &mut scene.lights[i].name,
            Thing::Material(i) => &mut scene.materials[i].name,
        }
    }
}

/// A new white light, behind all others, so that no index shifts.
pub fn add_light(scene: &mut Scene, place: LightPlace) -> Thing {
    let name = first_free("light", 1, light_names(scene));
    scene.lights.push(Light { place, ..Light::new(name) });
    Thing::Light(scene.lights.len() - 1)
}

/// A new matt white material, behind all others, so that no index shifts.
pub fn add_material(scene: &mut Scene) -> Thing {
    let name = free_material_name(scene, "material");
    scene.materials.push(Material::new(name));
    Thing::Material(scene.materials.len() - 1)
}

/// The first of `stem`, `stem 2`, `stem 3` … that no material has.
pub(super) fn free_material_name(scene: &Scene, stem: &str) -> String {
    first_free(stem, 1, material_names(scene))
}

/// A copy, behind all others, named `NAME 2` or the next number that is free.
pub fn duplicate(scene: &mut Scene, thing: Thing) -> Thing {
    let (stem, number) = numbered(thing.name(scene));
    match thing {
        Thing::Light(i) => {
            let name = first_free(stem, number + 1, light_names(scene));
            scene.lights.push(Light { name, ..scene.lights[i].clone() });
            Thing::Light(scene.lights.len() - 1)
        }
        Thing::Material(i) => {
            let name = first_free(stem, number + 1, material_names(scene));
            scene.materials.push(Material { name, ..scene.materials[i].clone() });
            Thing::Material(scene.materials.len() - 1)
        }
    }
}

/// Gives another name, spaces around it aside; what is wrong with the name, if anything.
pub fn rename(scene: &mut Scene, thing: Thing, name: &str) -> Result<(), String> {
    let (name, kind) = (name.trim(), thing.kind());
    if name.is_empty() {
        return Err(format!("a {kind} needs a name"));
    }
    let same = match thing {
        Thing::Light(_) => light_names(scene).iter().position(|other| *other == name),
        Thing::Material(_) => material_names(scene).iter().position(|other| *other == name),
    };
    let (Thing::Light(own) | Thing::Material(own)) = thing;
    if same.is_some_and(|other| other != own) {
        return Err(format!("there is another {kind} with the name {name}"));
    }
    *thing.name_mut(scene) = name.to_owned();
    Ok(())
}

/// Takes it out; a material that solids are made of stays, and the answer says which.
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
    }
    Ok(())
}

/// The solids made of the material with this index.
pub fn users(scene: &Scene, material: usize) -> Vec<usize> {
    let solids = scene.solids.iter().enumerate();
    let own = |solid: &Solid| !solid.shape.is_composite() && solid.material == material;
    solids.filter(|(_, solid)| own(solid)).map(|(i, _)| i).collect()
}

fn light_names(scene: &Scene) -> Vec<&str> {
    scene.lights.iter().map(|light| light.name.as_str()).collect()
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
        assert_eq!(check::validate(edited), []);
        let patched = patch(TEXT, &scene(), edited);
        assert!(!patched.comments_lost);
        let back = text_with(&patched.text, Path::new("s.toml"), Known::default()).unwrap();
        assert!(tree(&back) == tree(edited));
        patched.text
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

    #[test]
    fn a_list_of_names_ends_in_time() {
        assert_eq!(listed(&["a", "b"]), "a and b");
        assert_eq!(listed(&["a", "b", "c", "d", "e"]), "a, b, c, d and e");
        assert_eq!(listed(&["a", "b", "c", "d", "e", "f"]), "a, b, c, d and 2 more solids");
    }
}
