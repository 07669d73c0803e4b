//! Pictures written from the window.

use super::*;
use crate::faces::{SCENE, decode_png, succeed};

impl Window {
    /// Asks for the export; the dialog's answer is the file.
    fn export(&mut self, options: &[&str]) {
        self.key(Modifiers::COMMAND, Key::E);
        for option in options {
            self.click(option);
        }
        self.click("Choose file…");
        self.until_text("wrote ");
    }
}

/// A window with an edit that is not saved, and the file that the next export is asked for.
fn edited(file: &str) -> (Window, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (path, scene) = (folder.path().join(file), folder.path().join("scene.toml"));
    std::fs::write(&scene, SCENE).unwrap();
    let answers = vec![Answer::File(path.clone())];
    let mut window = Window::in_folder(folder, Some(scene), answers);
    window.until("the scene is open", |app| app.document().path().is_some());
    window.until_exact();
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.click("Scene");
    window.type_into("exposure value", "-0.7");
    window.until_exact();
    (window, path)
}

#[test]
fn an_8_bit_export_holds_the_bytes_of_the_view() {
    let (mut window, file) = edited("out");
    window.export(&[]);
    let (size, bits, bytes) = decode_png(&file.with_extension("png")).unwrap();
    assert_eq!((size, bits), ([48, 27], 8));
    assert!(bytes == rgb(&window.picture()));
}

#[test]
fn finer_formats_hold_what_a_render_of_the_saved_scene_writes() {
    for (name, option, arguments) in [
        ("deep.png", "PNG, 16 bits", &["--bits", "16"] as &[&str]),
        ("light.exr", "OpenEXR", &[]),
        ("light.hdr", "Radiance HDR", &[]),
    ] {
        let (mut window, file) = edited(name);
        window.export(&[option]);
        window.save();
        let fresh = format!("fresh-{name}");
        let render = [&["render", "scene.toml", "-o", &fresh], arguments].concat();
        succeed(window.folder.path(), &render);
        let (exported, fresh) = (std::fs::read(&file), std::fs::read(window.file(&fresh)));
        assert!(exported.unwrap() == fresh.unwrap(), "{name}");
    }
}

#[test]
fn another_size_is_what_a_render_of_that_size_writes() {
    let (mut window, file) = edited("large.png");
    let shown = window.picture();
    window.key(Modifiers::COMMAND, Key::E);
    window.type_into("export width", "80");
    window.type_into("export height", "45");
    window.until_text("Another size is traced anew");
    window.click("Choose file…");
    window.until_text("wrote ");
    let (size, bits, bytes) = decode_png(&file).unwrap();
    assert_eq!((size, bits), ([80, 45], 8));
    assert!(window.picture() == shown, "the view stays");
    window.save();
    let render = ["render", "scene.toml", "-o", "fresh.png", "--size", "80x45"];
    succeed(window.folder.path(), &render);
    assert!(decode_png(&window.file("fresh.png")).unwrap().2 == bytes);
}

#[test]
fn a_file_that_cannot_be_written_is_told() {
    let (mut window, _) = edited("no/such/folder/out.png");
    window.key(Modifiers::COMMAND, Key::E);
    window.click("Choose file…");
    window.until_button("Close");
    assert!(window.shows("no/such/folder/out.png"));
    assert!(!window.shows("wrote "));
    window.click("Close");
    assert!(!window.shows("no/such/folder/out.png"));
}
