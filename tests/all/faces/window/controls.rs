//! The slider and the colour field: fine drags, the wheel, keys, and menus that copy, paste and reset.

use eframe::egui::{MouseWheelSource, MouseWheelUnit, OutputCommand, TouchPhase};
use rayforest::color::Rgb;
use rayforest::color::notation::{hex, of_bytes};
use rayforest::scene::{Material, Paint};

use super::*;
use crate::faces::SCENE;

impl Window {
    pub(super) fn right_click_at(&mut self, at: Pos2) {
        self.harness.event(Event::PointerMoved(at));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        self.harness.run_steps(3);
    }

    /// Chooses from the menu of the one control of this role and name; what is then copied.
    #[track_caller]
    fn choose(&mut self, role: Role, name: &str, item: &str) -> Option<String> {
        let at = self.rect(role, name).center();
        self.right_click_at(at);
        let at = self.settled(item);
        self.harness.event(Event::PointerMoved(at));
        let mut copied = None;
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
            self.harness.step();
            copied = self.copied().or(copied);
        }
        self.harness.run_steps(2);
        copied
    }

    /// What the latest turn put on the clipboard.
    fn copied(&self) -> Option<String> {
        let commands = &self.harness.output().platform_output.commands;
        commands.iter().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    }

    /// Chooses an item that asks for the clipboard, which holds this text.
    #[track_caller]
    fn paste(&mut self, role: Role, name: &str, item: &str, text: &str) {
        self.choose(role, name, item);
        self.harness.event(Event::Paste(text.to_owned()));
        self.harness.step();
        self.harness.run_steps(2);
    }

    fn roll(&mut self, at: Pos2, lines: f32) {
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, lines),
            phase: TouchPhase::Move,
            source: MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        self.harness.run_steps(8);
    }

    fn material(&self, i: usize) -> &Material {
        &self.app().document().scene().materials[i]
    }

    fn diffuse(&self) -> f32 {
        self.material(1).diffuse.0[0]
    }

    /// The text of a swatch: the bytes that it shows.
    fn swatch(&self, name: &str) -> String {
        let node = self.harness.get_by_role_and_label(Role::ColorWell, name);
        node.accesskit_node().value().unwrap_or_default()
    }

    fn mirror() -> Window {
        let mut window = Window::with_scene(SCENE, Vec::new());
        window.click("mirror");
        window
    }
}

#[test]
fn shift_makes_a_drag_ten_times_finer() {
    let drag = |shift: bool| {
        let mut window = Window::mirror();
        let rect = window.rect(Role::Slider, "diffuse");
        // The handle of 0.3: a press there moves nothing.
        let radius = rect.height() / 2.5;
        let from =
            Pos2::new(rect.left() + radius + 0.3 * (rect.width() - 2.0 * radius), rect.center().y);
        let modifiers = if shift { Modifiers::SHIFT } else { Modifiers::NONE };
        window.harness.event(Event::ModifiersChanged(modifiers));
        window.drag(from, from + vec2(0.4 * rect.width(), 0.0));
        window.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        assert!(window.undo_name().expect("a step").starts_with("diffuse of mirror"));
        window.click("Undo");
        let back = window.diffuse();
        window.click("Redo");
        assert!(back == 0.3, "one step");
        window.diffuse() - 0.3
    };
    let (coarse, fine) = (drag(false), drag(true));
    assert!((0.3..0.6).contains(&coarse), "{coarse}");
    assert!((fine - coarse / 10.0).abs() < 0.01 && fine > 0.0, "{coarse} {fine}");
}

#[test]
fn the_wheel_moves_a_slider_that_has_the_keyboard_and_no_other() {
    let mut window = Window::mirror();
    let at = window.rect(Role::Slider, "diffuse").center();
    window.roll(at, 1.0);
    assert!(window.diffuse() == 0.3, "without the keyboard the panel is scrolled");
    window.click_at(at, Modifiers::NONE);
    let clicked = window.diffuse();
    let top = window.rect(Role::Slider, "diffuse").top();
    window.roll(at, -2.0);
    assert!(window.diffuse() < clicked && window.diffuse() > 0.0, "{}", window.diffuse());
    assert_eq!(window.rect(Role::Slider, "diffuse").top(), top, "the panel stays");
    window.key(Modifiers::NONE, Key::L);
    assert!(window.shows("Close the light mixer"), "letters are for the window");
}

#[test]
fn a_double_click_takes_the_saved_value_back() {
    let mut window = Window::mirror();
    let scene = window.app().document().scene().clone();
    window.type_into("diffuse value", "0.9");
    let at = window.rect(Role::Slider, "diffuse").center();
    window.double_click_at(at);
    assert!(*window.app().document().scene() == scene);
    assert!(!window.app().document().is_unsaved());
}

#[test]
fn a_value_is_copied_as_the_file_writes_it_and_pasted_elsewhere() {
    let mut window = Window::mirror();
    window.type_into("diffuse value", "0.33333334");
    let copied = window.choose(Role::Slider, "diffuse", "Copy value").expect("a copy");
    assert_eq!(copied.parse(), Ok(window.diffuse()), "with all its bits");
    assert_ne!(copied, "0.33333", "which the field does not show");
    window.paste(Role::SpinButton, "kloc value", "Paste value", &copied);
    assert_eq!(window.material(1).kloc, Rgb::grey(copied.parse().unwrap()));
    assert!(window.undo_name().expect("a step").starts_with("kloc of mirror"));

    let before = window.material(1).clone();
    window.paste(Role::Slider, "diffuse", "Paste value", "a word");
    window.until_text("`a word` was not pasted: it is no number");
    assert!(*window.material(1) == before);
    window.paste(Role::Slider, "diffuse", "Paste value", " −3 ");
    assert_eq!(window.diffuse(), 0.0, "the nearest that the range allows");
    window.paste(Role::Slider, "diffuse", "Paste value", "42");
    assert_eq!(window.diffuse(), 42.0, "the slider widens");
    window.drag_slider("diffuse", 0.5);
    assert!((15.0..27.0).contains(&window.diffuse()), "in its own span: {}", window.diffuse());
    window.click("Undo");
    window.harness.event(Event::Paste("1".into()));
    window.harness.run_steps(2);
    assert_eq!(window.diffuse(), 42.0, "nobody asked");
}

#[test]
fn a_menu_takes_back_what_was_saved_and_the_default() {
    let mut window = Window::mirror();
    let scene = window.app().document().scene().clone();
    window.type_into("diffuse value", "0.9");
    window.choose(Role::SpinButton, "diffuse value", "Reset to default");
    assert_eq!(window.diffuse(), 0.7);
    window.choose(Role::Slider, "diffuse", "Reset to saved");
    assert!(*window.app().document().scene() == scene, "bit for bit");
    window.choose(Role::Slider, "diffuse", "Reset to saved");
    assert!(!window.app().document().is_unsaved(), "it is what is saved");
    window.key(Modifiers::NONE, Key::Escape);

    window.click("ball");
    window.type_into("center y value", "0.25");
    window.choose(Role::SpinButton, "center y value", "Reset to default");
    let y = |window: &Window| window.scene_text_of("center");
    assert!(y(&window).contains("0.25"), "it has none: {}", y(&window));
    window.key(Modifiers::NONE, Key::Escape);
    window.choose(Role::SpinButton, "center y value", "Reset to saved");
    assert!(*window.app().document().scene() == scene);
}

impl Window {
    /// The values of all parameters whose path ends so.
    fn scene_text_of(&self, key: &str) -> String {
        let all = rayforest::scene::path::parameters(self.app().document().scene());
        let found = all.into_iter().filter(|p| p.path.ends_with(key)).map(|p| p.value);
        found.collect::<Vec<_>>().join("; ")
    }

    fn color(&self) -> Rgb {
        match self.material(1).paint {
            Paint::Solid(color) => color,
            _ => panic!("a texture"),
        }
    }

    fn open_picker(&mut self, name: &str) {
        let at = self.rect(Role::ColorWell, name).center();
        self.click_at(at, Modifiers::NONE);
    }

    fn type_text(&mut self, name: &str, text: &str, end: Key) {
        let at = self.rect(Role::TextInput, name).center();
        self.click_at(at, Modifiers::NONE);
        self.key(Modifiers::COMMAND, Key::A);
        self.write(text);
        self.key(Modifiers::NONE, end);
    }
}

#[test]
fn a_colour_is_typed_in_hexadecimal_and_every_other_notation() {
    let mut window = Window::mirror();
    let scene = window.app().document().scene().clone();
    window.open_picker("color");
    window.type_text("hex of color", "c8f", Key::Enter);
    assert_eq!(window.color(), of_bytes([0xcc, 0x88, 0xff]));
    window.type_text("hex of color", "#102030", Key::Escape);
    assert_eq!(window.color(), of_bytes([0xcc, 0x88, 0xff]), "Escape keeps it");
    // which closes the picker too
    window.open_picker("color");
    window.type_text("hex of color", "mauve", Key::Enter);
    assert_eq!(window.color(), of_bytes([0xcc, 0x88, 0xff]), "no colour");
    for (field, text) in
        [("hue of color", "240"), ("saturation of color", "100"), ("value of color", "100")]
    {
        window.type_into(field, text);
    }
    let [r, g, b] = window.color().0;
    assert!(r < 1e-6 && g < 1e-6 && (b - 1.0).abs() < 1e-6, "{r} {g} {b}");
    window.type_into("green of color", "0.25");
    assert_eq!(window.color().0[1], 0.25);
    while window.undo_name().is_some() {
        window.key(Modifiers::COMMAND, Key::Z);
    }
    assert!(*window.app().document().scene() == scene);
}

#[test]
fn looking_at_a_colour_changes_no_bit_of_it() {
    let odd = SCENE.replace("[0.9, 0.9, 0.95]", "[0.123456789, 0.3, 2.5]");
    let mut window = Window::with_scene(&odd, Vec::new());
    window.click("mirror");
    let scene = window.app().document().scene().clone();
    assert_eq!(window.swatch("color"), hex(window.color()));
    window.open_picker("color");
    window.harness.run_steps(5);
    let same = hex(window.color());
    window.type_text("hex of color", &same, Key::Enter);
    window.key(Modifiers::NONE, Key::Escape);
    window.choose(Role::ColorWell, "color", "Copy colour");
    window.paste(Role::ColorWell, "color", "Paste colour", &same);
    assert!(*window.app().document().scene() == scene && window.undo_name().is_none());
    let linear = window.choose(Role::ColorWell, "color", "Copy linear colour");
    assert_eq!(linear.as_deref(), Some("[0.12345679, 0.3, 2.5]"));
    window.paste(Role::ColorWell, "color", "Paste colour", "#fff");
    assert_eq!(window.color(), Rgb::WHITE);
    window.paste(Role::ColorWell, "color", "Paste colour", &linear.unwrap());
    assert!(*window.app().document().scene() == scene, "linear light keeps all bits");
    window.paste(Role::ColorWell, "color", "Paste colour", "blueish");
    window.until_text("`blueish` was not pasted: it is no colour");
    window.choose(Role::ColorWell, "color", "Reset to default");
    assert_eq!(window.color(), Rgb::WHITE);
    window.choose(Role::ColorWell, "color", "Reset to saved");
    assert!(*window.app().document().scene() == scene);
}

#[test]
fn a_drag_in_the_picker_is_one_step_and_keeps_the_hue_of_a_grey() {
    let mut window = Window::mirror();
    window.open_picker("color");
    let area = window.rect(Role::Slider, "saturation and value of color");
    let hue = window.rect(Role::Slider, "hue of color");
    window.drag(area.center(), area.right_top() + vec2(-1.0, 1.0));
    let pure = window.color();
    assert!(pure.max_channel() > 0.9 && pure.0.iter().any(|c| *c < 0.02), "{pure:?}");
    assert!(window.undo_name().expect("a step").starts_with("color of mirror"));
    window.drag(area.center(), area.left_center());
    let [r, g, b] = window.color().0;
    assert!(r == g && g == b, "a grey");
    window.drag(area.center(), area.right_top() + vec2(-1.0, 1.0));
    assert_eq!(hex(window.color()), hex(pure), "the hue is not forgotten");
    window.drag(hue.left_center() + vec2(1.0, 0.0), hue.center());
    assert!(window.color().0[1] > 0.9, "cyan: {:?}", window.color());
    for _ in 0..4 {
        window.key(Modifiers::COMMAND, Key::Z);
    }
    assert!(window.undo_name().is_none(), "four drags are four steps");
}

#[test]
fn a_light_has_a_temperature_where_its_colour_is() {
    let mut window = Window::with_scene(SCENE, Vec::new());
    window.click("key");
    window.open_picker("color");
    window.type_into("kelvin of color value", "3000");
    let color = window.app().document().scene().lights[0].color;
    assert_eq!(color, rayforest::color::blackbody(3000.0));
    window.key(Modifiers::NONE, Key::Escape);
    window.click("mirror");
    window.open_picker("color");
    let none = window.harness.query_by_role_and_label(Role::Slider, "kelvin of color");
    assert!(none.is_none(), "a material has none");
}

#[test]
fn swatch_picture_and_file_agree_about_a_colour() {
    let lamp = SCENE.replace("[trace]", "[background]\ncolor = [0.2, 0.5, 0.03]\n\n[trace]");
    let mut window = Window::with_scene(&lamp, Vec::new());
    window.click("Scene");
    let [r, g, b] = [0, 1, 2].map(|i| window.picture()[i]);
    assert_eq!(window.swatch("color"), format!("#{r:02x}{g:02x}{b:02x}"));
    window.paste(Role::ColorWell, "color", "Paste colour", "#3a7bd5");
    window.until_exact();
    assert_eq!(window.picture()[..3], [0x3a, 0x7b, 0xd5]);
    window.save();
    assert!(rgb(&window.picture()) == rendered(window.folder.path(), "scene.toml"));
}
