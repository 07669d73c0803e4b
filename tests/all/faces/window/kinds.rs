//! Paints, bumps and backgrounds of another kind, and images that are picked for them.

use rayforest::color::Rgb;
use rayforest::scene::{Background, Bump, Paint};

use super::*;
use crate::faces::SCENE;

/// A window whose dialog answers with files of its folder: `a.png` is an image, `bad.png` is none.
fn window(answers: &[&str]) -> Window {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().to_owned();
    std::fs::write(root.join("scene.toml"), SCENE).unwrap();
    std::fs::write(root.join("bad.png"), "no image").unwrap();
    let globe = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/globe.png");
    std::fs::copy(globe, root.join("a.png")).unwrap();
    let answers = answers.iter().rev().map(|name| Answer::File(root.join(name))).collect();
    let mut window = Window::in_folder(folder, Some(root.join("scene.toml")), answers);
    window.until("the scene is open", |app| app.document().path().is_some());
    window.until_exact();
    window
}

fn paint(window: &Window) -> Paint {
    window.app().document().scene().materials[1].paint.clone()
}

#[test]
fn a_paint_of_another_kind_keeps_its_colour_and_is_undone() {
    let mut window = window(&[]);
    window.click("mirror");
    let before = paint(&window);
    let picture = window.picture();
    window.click("kind of paint");
    window.click("marble");
    let Paint::Marble { a, .. } = paint(&window) else { panic!("{:?}", paint(&window)) };
    assert_eq!(a, before.mean());
    window.until_exact();
    assert!(window.picture() != picture);
    window.click("kind of bump");
    window.click("waves");
    let bump = || window.app().document().scene().materials[1].bump.clone();
    assert_eq!(bump(), Bump::named("waves"));
    window.save();
    let line = "bump = { waves = { height = 0.02, scale = 0.3, center = [0, 0, 0] } }";
    assert!(window.scene_text().contains(line), "{}", window.scene_text());
    window.key(Modifiers::COMMAND, Key::Z);
    window.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(paint(&window), before);
    window.until_exact();
    assert!(window.picture() == picture);
}

#[test]
fn an_image_is_picked_and_named_beside_the_scene() {
    let mut window = window(&["a.png", "bad.png", "a.png"]);
    window.click("mirror");
    window.click("kind of paint");
    window.click("image");
    window.until("the image is shown", |app| {
        matches!(app.document().scene().materials[1].paint, Paint::Image { .. })
    });
    let Paint::Image { image, .. } = paint(&window) else { unreachable!() };
    assert_eq!((image.file.as_str(), image.image.size()), ("a.png", [320, 160]));
    window.save();
    assert!(window.scene_text().contains("image = { file = \"a.png\""));
    // One that is none is refused, and the present one stays.
    window.click("pick an image file");
    window.until_text("this is no PNG, JPEG or HDR file");
    assert_eq!(paint(&window), Paint::Image { image, tint: Rgb::WHITE, size: 1.0 });
    window.click("Scene");
    window.click("kind of background");
    window.click("image");
    window.until("the image is all around", |app| {
        matches!(app.document().scene().background, Background::Image { .. })
    });
    window.until_exact();
}
