//! Looks while a person edits: what belongs to the worn one, and what becomes of all when things go.

use super::patch::renamed;
use crate::scene::Scene;
use crate::scene::look::{Look, Setting};
use crate::scene::path::segments;
use crate::scene::toml_text::{bare_or_quoted, quoted};

/// Whether edits of a parameter belong to the look that is worn: what things look like and how they
/// are lit, not where they are, nor whence they are seen. Others belong to a look only if it names them
/// already.
pub fn is_of_looks(path: &str) -> bool {
    let starts = |prefixes: &[&str]| prefixes.iter().any(|prefix| path.starts_with(prefix));
    starts(&["materials.", "lights.", "background."])
        || ["ambient_light", "picture.exposure", "picture.tone"].contains(&path)
        || path.starts_with("solids.") && path.ends_with(".material")
}

/// Brings the looks of an edited scene in step with its edit: settings follow what was renamed and go
/// with what is gone, and what was changed while a look is worn is taken into it, or out of it where it
/// is again what it is without. Nothing is done where the looks themselves were edited.
pub fn follow(before: &Scene, after: &mut Scene) {
    if after.looks.list.is_empty() || after.looks != before.looks {
        return;
    }
    let renames = renames(before, after);
    let is_same_structure = renames.is_empty() && same_things(before, after);
    if after.looks.worn().is_some() {
        take_in(before, after, &renames);
    }
    if !is_same_structure {
        let plain = after.undressed();
        let sound = |settings: &[Setting]| {
            let renamed: Vec<Setting> = settings.iter().map(|s| rename(s, &renames)).collect();
            plain.possible(&renamed)
        };
        for look in &mut after.looks.list {
            look.settings = sound(&look.settings);
        }
    }
}

/// Takes what was edited into the worn look.
fn take_in(before: &Scene, after: &mut Scene, renames: &[Rename]) {
    let Some(worn) = after.looks.worn().map(str::to_owned) else { return };
    let mut base: Vec<Setting> = after.looks.base().iter().map(|s| rename(s, renames)).collect();
    let knows = |base: &[Setting], path: &str| base.iter().any(|s| s.path == path);
    for old in before.differences(after) {
        if !knows(&base, &old.path) && is_of_looks(&old.path) {
            base.push(old);
        }
    }
    // In order, and without what is gone; then without what is what it is without the look.
    let mut plain = after.clone();
    plain.looks.set_base(Vec::new());
    let base = plain.possible(&base);
    let paths: Vec<Setting> = base.clone();
    let shown = after.present(&paths);
    let (base, settings): (Vec<Setting>, Vec<Setting>) =
        base.into_iter().zip(shown).filter(|(base, shown)| base != shown).unzip();
    if let Some(look) = after.looks.list.iter_mut().find(|look| look.name == worn) {
        look.settings = settings;
    }
    after.looks.set_base(base);
}

/// A thing of a list that has another name.
struct Rename {
    list: &'static str,
    from: String,
    to: String,
}

fn names(scene: &Scene) -> [(&'static str, Vec<String>); 3] {
    [
        ("lights", scene.lights.iter().map(|light| light.name.clone()).collect()),
        ("materials", scene.materials.iter().map(|material| material.name.clone()).collect()),
        ("solids", scene.solids.iter().map(|solid| solid.name.clone()).collect()),
    ]
}

fn renames(before: &Scene, after: &Scene) -> Vec<Rename> {
    let pairs = names(before).into_iter().zip(names(after));
    let of = |((list, old), (_, new)): ((&'static str, Vec<String>), (_, Vec<String>))| {
        let renamed = if old == new { Vec::new() } else { renamed(&old, &new) };
        renamed.into_iter().map(move |(from, to)| Rename { list, from, to })
    };
    pairs.flat_map(of).collect()
}

/// Whether two scenes have the same things with parameters of the same names.
fn same_things(before: &Scene, after: &Scene) -> bool {
    let shapes = |scene: &Scene| -> Vec<_> {
        let light = scene.lights.iter().map(|l| std::mem::discriminant(&l.place));
        let paint = scene
            .materials
            .iter()
            .map(|m| (std::mem::discriminant(&m.paint), std::mem::discriminant(&m.bump)));
        let shape = scene.solids.iter().map(|s| std::mem::discriminant(&s.shape));
        vec![(light.collect::<Vec<_>>(), paint.collect::<Vec<_>>(), shape.collect::<Vec<_>>())]
    };
    let others = |scene: &Scene| {
        let lens = std::mem::discriminant(&scene.camera.lens);
        (lens, std::mem::discriminant(&scene.background))
    };
    names(before) == names(after)
        && shapes(before) == shapes(after)
        && others(before) == others(after)
}

/// A setting with the names that things have now.
fn rename(setting: &Setting, renames: &[Rename]) -> Setting {
    let mut setting = setting.clone();
    for Rename { list, from, to } in renames {
        let keys = segments(&setting.path).unwrap_or_default();
        if let [first, name, rest @ ..] = keys.as_slice()
            && first == list
            && name == from
        {
            let rest = rest.iter().map(|key| format!(".{}", bare_or_quoted(key)));
            setting.path = format!("{list}.{}{}", bare_or_quoted(to), rest.collect::<String>());
        }
        // Solids name materials, and solids.
        if setting.path.starts_with("solids.") && setting.value.contains('"') {
            setting.value = setting.value.replace(&quoted(from), &quoted(to));
        }
    }
    setting
}

/// A new look of a scene, with a name that no other has: all that differs from its present look's
/// absence, or nothing.
pub fn added(scene: &Scene, name: &str) -> Result<Scene, String> {
    let mut edited = scene.clone();
    edited.looks.list = scene.looks_now();
    let settings = scene.present(scene.looks.base());
    edited.looks.list.push(Look { name: name.to_owned(), settings });
    edited.dressed(Some(name))
}

/// The scene without a look; what it set is gone from the picture too, if it was worn.
pub fn removed(scene: &Scene, name: &str) -> Scene {
    let mut edited = match scene.looks.worn() == Some(name) {
        true => scene.undressed(),
        false => scene.clone(),
    };
    edited.looks.list.retain(|look| look.name != name);
    edited
}

/// A name for a new look.
pub fn free_name(scene: &Scene) -> String {
    let taken = |name: &str| scene.looks.find(name).is_some();
    let mut names = (1..).map(|number| format!("look {number}"));
    names.find(|name| !taken(name)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::document::Document;
    use crate::document::things::{Thing, duplicate, remove, rename};

    const TEXT: &str = "version = 1 # mine\n[camera]\nheight = 4\n[lights.key]\npoint = [0, 0, 5]\n\
        [materials.tiles]\ndiffuse = 0.75 # dull\n[materials.rug]\n\
        [solids.a]\nsphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"tiles\"\n\
        [looks.night]\n# the lamp is out\nlights.key.on = false\nmaterials.tiles.diffuse = 0.50\n\
        solids.a.material = \"rug\"\n";

    fn document() -> Document {
        Document::untitled("s", TEXT).unwrap()
    }

    fn text(document: &Document) -> String {
        let folder = tempfile::tempdir().unwrap();
        let save = document.save(&folder.path().join("s.toml")).unwrap();
        assert!(!save.comments_lost, "{}", save.text);
        save.text
    }

    fn edit(document: &mut Document, edit: impl FnOnce(&mut Scene)) {
        let mut scene = document.scene().clone();
        edit(&mut scene);
        document.change(scene);
        document.end_gesture();
    }

    #[test]
    fn putting_a_look_on_changes_one_line_of_the_text_and_is_one_step() {
        let mut document = document();
        let night = document.scene().dressed(Some("night")).unwrap();
        document.change(night);
        document.end_gesture();
        assert_eq!(document.undo_name(), Some("look night"));
        let expected = TEXT.replacen("# mine\n", "# mine\nlook = \"night\"\n", 1);
        assert_eq!(text(&document), expected);
        document.undo();
        assert_eq!(text(&document), TEXT);
    }

    #[test]
    fn edits_of_a_worn_look_are_the_look_s_and_those_of_the_camera_are_not() {
        let mut document = document();
        let night = document.scene().dressed(Some("night")).unwrap();
        document.change(night);
        document.end_gesture();
        edit(&mut document, |scene| scene.materials[0].diffuse = Rgb::grey(0.25));
        edit(&mut document, |scene| scene.materials[0].specular = Rgb::grey(0.125));
        edit(&mut document, |scene| scene.camera.eye.x = 3.0);
        let expected = TEXT
            .replacen("# mine\n", "# mine\nlook = \"night\"\n", 1)
            .replacen("0.50", "0.25", 1)
            .replacen("\"rug\"\n", "\"rug\"\nmaterials.tiles.specular = 0.125\n", 1)
            .replacen("[camera]\n", "[camera]\neye = [3, -6, 2]\n", 1);
        assert_eq!(text(&document), expected);
        // what is again as it is without the look is no difference
        edit(&mut document, |scene| scene.materials[0].specular = Rgb::BLACK);
        edit(&mut document, |scene| scene.lights[0].on = true);
        let plain = document.scene().undressed();
        assert_eq!(plain.materials[0].diffuse, Rgb::grey(0.75));
        let paths: Vec<&str> = plain.looks.list[0].settings.iter().map(|s| &*s.path).collect();
        assert_eq!(paths, ["materials.tiles.diffuse", "solids.a.material"]);
    }

    #[test]
    fn looks_follow_renames_and_lose_what_is_gone() {
        for worn in [None, Some("night")] {
            let mut document = document();
            let dressed = document.scene().dressed(worn).unwrap();
            document.change(dressed);
            edit(&mut document, |scene| scene.materials[1].name = "my rug".into());
            edit(&mut document, |scene| scene.materials[0].name = "t.iles".into());
            let written = text(&document);
            assert!(written.contains("materials.\"t.iles\".diffuse = 0.5"), "{written}");
            assert!(written.contains("solids.a.material = \"my rug\""), "{written}");
            edit(&mut document, |scene| scene.lights.clear());
            let plain = document.scene().undressed();
            let paths: Vec<&str> = plain.looks.list[0].settings.iter().map(|s| &*s.path).collect();
            assert_eq!(paths, ["materials.\"t.iles\".diffuse", "solids.a.material"], "{worn:?}");
            assert_eq!(plain.solids[0].material, 0, "{worn:?}");
        }
    }

    #[test]
    fn looks_follow_solids_that_are_copied_renamed_and_deleted() {
        for worn in [None, Some("night")] {
            let mut document = document();
            let dressed = document.scene().dressed(worn).unwrap();
            document.change(dressed);
            let settings = |document: &Document| -> Vec<String> {
                let plain = document.scene().undressed();
                plain.looks.list[0].settings.iter().map(|s| s.path.clone()).collect()
            };
            let paths = |solid: &str| {
                let solid = format!("solids.{solid}.material");
                ["lights.key.on".into(), "materials.tiles.diffuse".into(), solid]
            };
            edit(&mut document, |scene| assert!(duplicate(scene, Thing::Solid(0)).is_in(scene)));
            assert_eq!(settings(&document), paths("a"), "{worn:?}: the copy has none of its own");
            assert_eq!(document.scene().undressed().solids[0].material, 0, "{worn:?}");
            edit(&mut document, |scene| rename(scene, Thing::Solid(0), "b c").unwrap());
            assert_eq!(settings(&document), paths("\"b c\""), "{worn:?}");
            edit(&mut document, |scene| remove(scene, Thing::Solid(1)).unwrap());
            assert_eq!(settings(&document), paths("\"b c\""), "{worn:?}");
            edit(&mut document, |scene| remove(scene, Thing::Solid(0)).unwrap());
            assert_eq!(settings(&document), paths("")[..2], "{worn:?}");
            let written = text(&document);
            assert!(!written.contains("solids.") && written.contains("# dull"), "{written}");
            for _ in 0..4 {
                assert!(document.undo());
            }
            assert_eq!(settings(&document), paths("a"), "{worn:?}");
        }
    }

    #[test]
    fn a_look_is_added_and_removed_and_only_differences_are_kept() {
        let mut document = document();
        let scene = added(document.scene(), &free_name(document.scene())).unwrap();
        document.change(scene);
        document.end_gesture();
        assert_eq!(document.undo_name(), Some("add look look 1"));
        edit(&mut document, |scene| scene.materials[0].diffuse = Rgb::grey(0.25));
        let expected = TEXT.replacen("# mine\n", "# mine\nlook = \"look 1\"\n", 1)
            + "\n[looks.\"look 1\"]\nmaterials.tiles.diffuse = 0.25\n";
        assert_eq!(text(&document), expected);
        let scene = removed(document.scene(), "look 1");
        document.change(scene);
        document.end_gesture();
        assert_eq!(text(&document), TEXT);
    }
}
