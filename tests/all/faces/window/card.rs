//! A window whose graphics card draws the picture: it looks the same, and a lost card costs nothing.

use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use rayforest::viewer::Graphics;

use super::*;
use crate::faces::SCENE;

/// A window with a scene in `scene.toml`, whole, drawn by a card that also draws the picture.
fn on_card(scene: &str, graphics: Graphics) -> (Window, RenderState) {
    let state = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    let root = folder.path().to_owned();
    let renderer = WgpuTestRenderer::from_render_state(state.clone());
    let (own, opened) = (state.clone(), path.clone());
    let builder = Harness::builder().with_size(vec2(1280.0, 720.0)).with_max_steps(1000);
    let harness = builder.renderer(renderer).build_eframe(|context| {
        let setup = Setup {
            options: Options { threads: 2, memory: 1 << 30 },
            folders: Folders::within(&root),
            dialogs: Box::new(ScriptedDialogs { answers: Vec::new() }),
            scene: Some(opened),
        };
        let mut app = App::new(&context.egui_ctx, setup);
        app.draw_on(&context.egui_ctx, &own, graphics);
        app
    });
    let mut window = Window { harness, folder };
    window.until("the scene is open", |app| app.document().path() == Some(&path));
    window.until_exact();
    (window, state)
}

/// What the part of the window looks like in which the picture is, after everything came to rest.
fn picture_on_screen(window: &mut Window) -> Vec<[u8; 4]> {
    window.harness.run_steps(10);
    let view = window.rect(Role::Image, "picture");
    let image = window.harness.render().expect("lavapipe is installed: tests/run installs it");
    let width = image.width() as usize;
    let (pixels, _) = image.as_raw().as_chunks::<4>();
    // Notices lie at the lower edge.
    let rows = view.top() as usize..view.center().y as usize;
    let columns = view.left() as usize + 1..view.right() as usize - 1;
    rows.flat_map(|y| pixels[y * width..][columns.clone()].to_vec()).collect()
}

fn largest_difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> u8 {
    assert_eq!(a.len(), b.len());
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

#[test]
fn the_cards_picture_looks_like_the_processors() {
    let (mut card, _) = on_card(SCENE, Graphics::Gpu);
    let (mut processor, _) = on_card(SCENE, Graphics::Cpu);
    assert!(card.app().shown().unwrap().card.is_some());
    assert!(processor.app().shown().unwrap().card.is_none());
    let first = picture_on_screen(&mut card);
    assert!(largest_difference(&first, &picture_on_screen(&mut processor)) <= 1);
    for window in [&mut card, &mut processor] {
        window.click("mirror");
        window.drag_slider("diffuse", 0.9);
        window.until_exact();
    }
    let edited = picture_on_screen(&mut card);
    assert!(largest_difference(&first, &edited) > 20, "the edit is seen");
    assert!(largest_difference(&edited, &picture_on_screen(&mut processor)) <= 1);
}

#[test]
fn the_cards_tone_and_marks_look_like_the_processors() {
    let bright = "[picture]\nexposure = 2\n";
    let plain = SCENE.replace("[picture]\n", bright);
    let toned = SCENE.replace("[picture]\n", &format!("{bright}tone = \"neutral\"\n"));
    let mut seen = Vec::new();
    for scene in [plain, toned] {
        let windows = [Graphics::Gpu, Graphics::Cpu].map(|graphics| on_card(&scene, graphics).0);
        let mut pictures = Vec::new();
        for mut window in windows {
            let first = picture_on_screen(&mut window);
            window.key(Modifiers::NONE, Key::X);
            window.until_text("clipped ");
            pictures.push([first, picture_on_screen(&mut window)]);
        }
        let [card, processor] = [&pictures[0], &pictures[1]];
        for (card, processor) in card.iter().zip(processor) {
            assert!(largest_difference(card, processor) <= 1);
        }
        seen.push(pictures.swap_remove(0));
    }
    let [[plain, marked], [toned, unclipped]] = [&seen[0], &seen[1]];
    assert!(largest_difference(plain, toned) > 20, "the tone curve is seen");
    assert!(largest_difference(plain, marked) > 20, "the marks are seen");
    assert!(largest_difference(toned, unclipped) == 0, "nothing is clipped");
}

#[test]
fn a_processor_that_pretends_to_be_a_card_is_not_asked_for_the_picture() {
    let (window, state) = on_card(SCENE, Graphics::Auto);
    let software = state.adapter.get_info().device_type == eframe::wgpu::DeviceType::Cpu;
    assert_eq!(window.app().shown().unwrap().card.is_none(), software);
}

#[test]
fn a_lost_card_costs_neither_work_nor_picture() {
    let (mut window, state) = on_card(SCENE, Graphics::Gpu);
    window.click("mirror");
    window.drag_slider("diffuse", 0.9);
    window.until_exact();
    let before = window.scene_of_document();
    assert!(!window.app().is_moving());
    state.device.destroy();
    let _ = state.device.poll(eframe::wgpu::PollType::wait_indefinitely());
    window.until_text("the graphics card was lost (");
    window.until_text("nothing of your work is lost");
    assert!(window.app().is_moving(), "it waits for another window");
    assert_eq!(window.scene_of_document(), before);
    window.until("the processor's picture shows", |app| {
        app.shown().is_some_and(|shown| shown.card.is_none())
    });
    // Edits go on, and are exact.
    window.drag_slider("diffuse", 0.2);
    window.until_exact();
    assert_ne!(window.scene_of_document(), before);
    assert!(window.app().document().is_unsaved());
    let shown = window.picture();
    window.save();
    assert_eq!(rgb(&shown), rendered(window.folder.path(), "scene.toml"));
}

impl Window {
    fn scene_of_document(&self) -> rayforest::scene::Scene {
        self.app().document().scene().clone()
    }
}

#[test]
fn one_pixel_that_differs_is_found() {
    let black = vec![[0, 0, 0, 255]; 12];
    let mut other = black.clone();
    other[7][1] = 3;
    assert_eq!(largest_difference(&black, &black), 0);
    assert_eq!(largest_difference(&black, &other), 3);
}
