//! Materials to begin with: metals, glasses, paints and stones, each with a picture of a ball made of it.

use std::io::Cursor;
use std::path::Path;

use super::things::free_material_name;
use crate::film::Frame;
use crate::scene::read::{self, Known};
use crate::scene::{Material, Scene, write};

/// The presets, as a scene of materials alone; says where their numbers are from.
const TEXT: &str = include_str!("../../assets/materials.toml");
/// What [`stage`] adds its material to.
const STAGE: &str = include_str!("templates/swatch.toml");
/// A PNG with the pictures of all presets, [`COLUMNS`] in a row, each [`SIDE`] pixels wide and high.
pub const SHEET: &[u8] = include_bytes!("../../assets/materials.png");
/// Pictures in a row of the sheet.
pub const COLUMNS: u32 = 8;
/// Width and height of a picture, in pixels.
pub const SIDE: u32 = 64;

/// All presets, in the order of their pictures.
pub fn all() -> Vec<Material> {
    read::text(TEXT, Path::new("materials.toml")).expect("the presets have no mistakes").materials
}

/// The pictures of all presets, as they stand in [`SHEET`].
pub fn pictures() -> Frame {
    let mut reader = png::Decoder::new(Cursor::new(SHEET)).read_info().expect("the sheet is a PNG");
    let size = [reader.info().width, reader.info().height];
    let mut frame = Frame::new(size);
    let mut bytes = vec![0; frame.bytes.len() / 4 * 3];
    reader.next_frame(&mut bytes).expect("the sheet is a whole PNG of RGB bytes");
    let (pixels, _) = bytes.as_chunks::<3>();
    let (places, _) = frame.bytes.as_chunks_mut::<4>();
    for (place, [r, g, b]) in places.iter_mut().zip(pixels) {
        *place = [*r, *g, *b, 255];
    }
    frame
}

/// The scene of a material's picture: a ball made of it on a chequered ground.
pub fn stage(material: &Material) -> Scene {
    let mut scene = read::text(STAGE, Path::new("swatch.toml")).expect("the stage has no mistakes");
    let ball = scene.solids.last().map_or(0, |ball| ball.material);
    give(&mut scene.materials[ball], material);
    scene
}

/// Makes a material what another one is; it keeps its name.
pub fn give(material: &mut Material, what: &Material) {
    let name = std::mem::take(&mut material.name);
    *material = Material { name, ..what.clone() };
}

/// The index of a material that is what `what` is, name aside but for a number behind it: one of the
/// scene, or a new one behind all others.
pub fn provide(scene: &mut Scene, what: &Material) -> usize {
    let is_same = |material: &Material| {
        let rest = material.name.strip_prefix(&what.name);
        let numbered =
            rest.is_some_and(|rest| rest.trim_start().chars().all(|c| c.is_ascii_digit()));
        let mut other = material.clone();
        give(&mut other, what);
        numbered && other == *material
    };
    if let Some(index) = scene.materials.iter().position(is_same) {
        return index;
    }
    let name = free_material_name(scene, &what.name);
    scene.materials.push(Material { name, ..what.clone() });
    scene.materials.len() - 1
}

/// A material as a table of the scene language, to be copied.
pub fn text(material: &Material) -> String {
    let scene = Scene { materials: vec![material.clone()], ..Scene::default() };
    let text = write::text(&scene);
    text.split_once("\n\n").map_or(text.clone(), |(_, table)| table.to_owned())
}

/// The first material of a text such as [`text`] gives, or of a whole scene; what is wrong with it,
/// if it holds none. Files that it names are sought beside `scene_file`.
pub fn parse(text: &str, scene_file: &Path) -> Result<Material, String> {
    let has_version = text.lines().any(|line| line.trim_start().starts_with("version"));
    let text = match has_version {
        true => text.to_owned(),
        false => format!("version = 1\n{text}"),
    };
    let scene = read::text_with(&text, scene_file, Known::default());
    let scene = scene.map_err(|error| error.to_string())?;
    scene.materials.into_iter().next().ok_or_else(|| "it holds no material".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::check::validate;
    use crate::scene::energy::overbright;

    #[test]
    fn every_preset_is_sound_and_gives_back_no_more_light_than_it_gets() {
        let presets = all();
        assert!(presets.len() >= 20, "{}", presets.len());
        for preset in &presets {
            let stage = stage(preset);
            assert_eq!(validate(&stage), [], "{}", preset.name);
            let bright = overbright(&stage);
            assert!(bright.is_empty(), "{}: {bright:?}", preset.name);
        }
        let mut bright = presets[0].clone();
        bright.diffuse = crate::color::Rgb::grey(0.5);
        assert!(!overbright(&stage(&bright)).is_empty(), "too much is found");
    }

    #[test]
    fn reflectances_of_metals_follow_from_the_indices_beside_them() {
        let index = |text: &str| -> [f64; 2] {
            let (n, k) = text.trim().split_once(" + ").expect("n + ki");
            [n.parse().expect("n"), k.trim_end_matches('i').parse().expect("k")]
        };
        let presets = all();
        let mut metals = 0;
        let mut lines = TEXT.lines();
        while let Some(line) = lines.next() {
            let Some(indices) = line.strip_prefix("# n + ik = ") else { continue };
            let indices = indices.split(';').next().unwrap_or_default();
            let name = lines.next().expect("a table").trim_start_matches("[materials.");
            let name = name.trim_end_matches(']');
            let metal = presets.iter().find(|preset| preset.name == name).expect("the metal");
            let crate::scene::Paint::Solid(color) = metal.paint else { panic!("{name}") };
            for (channel, text) in color.0.iter().zip(indices.split(',')) {
                let [n, k] = index(text);
                let of = |m: f64| m * m + k * k;
                let reflectance = of(n - 1.0) / of(n + 1.0);
                assert!((f64::from(*channel) - reflectance).abs() < 1.5e-3, "{name} {reflectance}");
            }
            metals += 1;
        }
        assert_eq!(metals, 6);
    }

    #[test]
    fn a_material_is_copied_and_read_again_bit_for_bit() {
        for preset in all() {
            let text = text(&preset);
            assert!(text.starts_with("[materials."), "{text}");
            assert_eq!(parse(&text, Path::new("s.toml")), Ok(preset));
        }
        let whole = write::text(&stage(&all()[3]));
        assert!(parse(&whole, Path::new("s.toml")).is_ok(), "of a scene the first");
        for text in ["", "gold", "[materials.a]\nshine = 1", "[lights.a]\npoint = [0, 0, 0]"] {
            assert!(parse(text, Path::new("s.toml")).is_err(), "{text}");
        }
    }

    #[test]
    fn a_preset_is_added_once_and_under_a_name_of_its_own() {
        let gold = &all()[0];
        let mut scene = stage(&Material::new("plain"));
        let count = scene.materials.len();
        assert_eq!(provide(&mut scene, gold), count);
        assert_eq!(provide(&mut scene, gold), count, "it is there already");
        assert_eq!((scene.materials.len(), &scene.materials[count].name), (count + 1, &gold.name));
        scene.materials[count].diffuse = crate::color::Rgb::grey(0.01);
        assert_eq!(provide(&mut scene, gold), count + 1, "the edited one is another");
        assert_eq!(scene.materials[count + 1].name, "gold 2");
        assert_eq!(provide(&mut scene, gold), count + 1);
        scene.materials[count + 1].name = "golden".into();
        assert_eq!(provide(&mut scene, gold), count + 2, "a name of the user's own");
    }
}
