//! What was traced is kept and opened again: no rays, same bytes; edits come first.

use super::*;
use crate::session::cache::path_of;

/// Cache files that events tell of.
fn kept(window: &Window) -> Vec<&Path> {
    let kept = window.events.iter().filter_map(|event| match event {
        Event::Kept { path, .. } => Some(path.as_path()),
        _ => None,
    });
    kept.collect()
}

fn keep(window: &mut Window, path: &Path) {
    window.live.keep(path.into());
    window.wait("kept", |w| kept(w) == [path]);
}

/// A window that opens a scene with a cache, its picture whole.
fn opening(scene: &Scene, path: &Path) -> Window {
    let mut window = Window::new(OPTIONS);
    window.live.want_kept(Arc::new(scene.clone()), path.into());
    window.wait("opened", |w| w.status.in_step);
    window
}

/// A cache of a scene, in a folder of its own.
fn cache_of(scene: &Scene) -> (tempfile::TempDir, PathBuf) {
    let folder = folder();
    let path = path_of(&folder.path().join("scene.toml"));
    keep(&mut Window::showing(scene), &path);
    (folder, path)
}

fn files(folder: &tempfile::TempDir) -> usize {
    std::fs::read_dir(folder.path()).unwrap().count()
}

#[test]
fn what_was_kept_is_opened_without_rays() {
    let scene = scene("glass", [160, 90], 4);
    let (folder, path) = cache_of(&scene);
    assert_eq!(files(&folder), 1);
    let window = opening(&scene, &path);
    assert_eq!(window.stages, [Stage::Whole]);
    window.shows_whole(&scene);
    let (report, status) = (window.last(), &window.status);
    assert_eq!((report.class, report.rays.total(), status.opened), (Class::None, 0, true));
    assert_eq!((status.job.clone(), &window.events[..]), (None, &[][..]));
    // It is a session like any other.
    let mut window = window;
    let edited = with(&scene, "materials.tiles.diffuse", "0.2");
    window.want(&edited);
    window.wait("edited", |w| w.status.in_step);
    window.shows_whole(&edited);
    assert_eq!((window.last().class, window.status.opened), (Class::Reshade, false));
    let moved = with(&edited, "lights.key.point", "[1, -2, 6]");
    window.want(&moved);
    window.wait("moved", |w| w.status.in_step);
    window.shows_whole(&moved);
}

#[test]
fn a_difference_costs_what_an_edit_costs() {
    let scene = scene("whitted", [160, 90], 4);
    let (_folder, path) = cache_of(&scene);
    for (name, value, class) in [
        ("materials.tiles.diffuse", "0.3", Class::Reshade),
        ("lights.key.point", "[1, -2, 6]", Class::Regrow),
        ("camera.fov_degrees", "31", Class::Retrace),
    ] {
        let saved = with(&scene, name, value);
        let window = opening(&saved, &path);
        window.shows_whole(&saved);
        let (report, rays) = (window.last(), class >= Class::Regrow);
        assert_eq!((report.class, report.rays.total() > 0), (class, rays), "{name}");
        assert_eq!((window.status.opened, &window.events[..]), (!rays, &[][..]), "{name}");
    }
}

/// Waits until some of a cache is written, or, on a busy machine, all of it.
fn is_written(window: &mut Window) {
    window.wait("it is written", |w| {
        let begun = |job: &Job| job.what.starts_with("keeping") && job.steps.0 > 0;
        w.status.job.as_ref().is_some_and(begun) || !kept(w).is_empty()
    });
}

#[test]
fn an_edit_while_it_is_written_comes_first_and_is_kept() {
    let scene = scene("glass", [400, 300], 2);
    let folder = folder();
    let path = path_of(&folder.path().join("scene.toml"));
    let mut window = Window::showing(&scene);
    let (mut wanted, mut interrupted) = (scene.clone(), 0);
    for step in 100..120 {
        window.live.keep(path.clone());
        is_written(&mut window);
        wanted = with(&scene, "materials.tiles.diffuse", &format!("0.{step}"));
        let asked = Instant::now();
        window.want(&wanted);
        window.wait("an edit", |w| *w.shown().scene == wanted);
        // Promised are 30 ms more than the edit; a busy machine is given a second.
        assert!(asked.elapsed() < Duration::from_secs(1), "{:?}", asked.elapsed());
        interrupted += usize::from(kept(&window).is_empty());
        if interrupted == 3 {
            break;
        }
        window.events.clear();
    }
    assert_eq!(interrupted, 3, "edits did not wait");
    window.wait("kept", |w| !kept(w).is_empty());
    assert_eq!((kept(&window), files(&folder)), (vec![&*path], 1));
    window.wait("no job", |w| !is_tracing(w));
    window.shows_whole(&wanted);
    let opened = opening(&wanted, &path);
    opened.shows_whole(&wanted);
    assert_eq!(opened.last().class, Class::None, "the edited picture was kept");
}

#[test]
fn what_is_kept_while_rays_are_cast_is_the_new_picture() {
    let scene = slow();
    let folder = folder();
    let path = path_of(&folder.path().join("scene.toml"));
    let mut window = Window::new(OPTIONS);
    window.want(&scene);
    window.live.keep(path.clone());
    window.wait("kept", |w| kept(w) == [&*path]);
    let opened = opening(&scene, &path);
    opened.shows_whole(&scene);
    assert!(opened.status.opened);
}

#[test]
fn keeping_is_stopped_and_leaves_nothing() {
    let scene = scene("glass", [400, 300], 2);
    let folder = folder();
    let path = path_of(&folder.path().join("scene.toml"));
    let mut window = Window::showing(&scene);
    let begin = |window: &mut Window| {
        window.events.clear();
        let _ = std::fs::remove_file(&path);
        window.live.keep(path.clone());
        is_written(window);
    };
    let stopped = (0..20).any(|_| {
        begin(&mut window);
        window.live.cancel();
        window.wait("stopped", |w| !is_tracing(w));
        kept(&window).is_empty()
    });
    assert!(stopped && files(&folder) == 0 && window.events.is_empty(), "{:?}", window.events);
    assert!(window.status.in_step && !window.status.held);
    // A window that closes leaves nothing half written.
    begin(&mut window);
    drop(window);
    assert!(files(&folder) == 0 || (files(&folder) == 1 && path.is_file()));
}

#[test]
fn what_cannot_be_kept_is_told() {
    let folder = folder();
    let mut window = Window::new(OPTIONS);
    let told = |w: &Window, text: &str| match &w.events[..] {
        [Event::Failed(told)] => told.contains(text),
        _ => false,
    };
    window.live.keep(folder.path().join("a"));
    window.wait("no scene", |w| told(w, "no scene is open"));
    let scene = scene("plain", [32, 20], 1);
    window.want(&scene);
    window.wait("whole", |w| w.status.in_step);
    window.events.clear();
    window.live.keep(folder.path().join("nowhere/a"));
    window.wait("no folder", |w| told(w, "no folder"));
    window.events.clear();
    let note = folder.path().join("note");
    std::fs::write(&note, "a note of mine").unwrap();
    window.live.keep(note.clone());
    window.wait("another file", |w| told(w, "no cache of Rayforest"));
    assert_eq!(std::fs::read(&note).unwrap(), b"a note of mine");
    assert_eq!((files(&folder), window.status.in_step), (1, true));
}

#[test]
fn a_cache_that_does_not_fit_is_told_and_the_scene_is_traced() {
    let scene = scene("whitted", [64, 40], 2);
    let (_folder, path) = cache_of(&scene);
    let sound = std::fs::read(&path).unwrap();
    let mut changed = sound.clone();
    changed[sound.len() / 2] ^= 4;
    for (bytes, cause) in [
        (&sound[..sound.len() - 9], "cut"),
        (&changed, "damaged"),
        (b"a note of mine", "no cache of Rayforest"),
    ] {
        std::fs::write(&path, bytes).unwrap();
        let window = opening(&scene, &path);
        window.shows_whole(&scene);
        let [Event::Failed(text)] = &window.events[..] else { panic!("{:?}", window.events) };
        assert!(text.contains(cause) && text.contains("scene.rayforest-cache"), "{text}");
        assert!(text.contains("help: "), "{text}");
        assert_eq!((window.last().class, window.status.opened), (Class::Retrace, false));
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "the file is left alone");
    }
    std::fs::write(&path, sound).unwrap();
    let larger = with(&scene, "picture.size", "[65, 40]");
    let window = opening(&larger, &path);
    window.shows_whole(&larger);
    let [Event::Failed(text)] = &window.events[..] else { panic!("{:?}", window.events) };
    assert!(text.contains("64×40"), "{text}");
    std::fs::remove_file(&path).unwrap();
    let window = opening(&scene, &path);
    window.shows_whole(&scene);
    assert_eq!(window.events, [], "what was never kept is not missed");
}

#[test]
fn an_edit_right_after_the_opening_does_not_forget_the_cache() {
    let scene = scene("whitted", [160, 90], 4);
    let (_folder, path) = cache_of(&scene);
    let mut window = Window::new(OPTIONS);
    window.live.want_kept(Arc::new(scene.clone()), path);
    let edited = with(&scene, "materials.tiles.diffuse", "0.3");
    window.want(&edited);
    window.wait("opened", |w| w.status.in_step);
    window.shows_whole(&edited);
    assert_eq!((window.stages.as_slice(), window.last().rays.total()), (&[Stage::Whole][..], 0));
}

#[test]
fn a_document_that_is_left_is_kept_as_it_was_and_opens_again_without_rays() {
    let folder = folder();
    let place = |name: &str| path_of(&folder.path().join(name));
    let (first, second) = (place("first.toml"), place("second.toml"));
    let glass = scene("glass", [400, 300], 2);
    let whitted = scene("whitted", [160, 90], 4);
    let mut window = Window::showing(&glass);
    window.live.keep(first.clone());
    window.live.leave();
    window.live.want_kept(Arc::new(whitted.clone()), second.clone());
    window.wait("the second", |w| w.status.in_step && *w.shown().scene == whitted);
    window.shows_whole(&whitted);
    assert_eq!(window.last().reason.as_deref(), Some("the scene is new"));
    // At once, whether the first is written to its end or not.
    window.live.keep(second.clone());
    for (scene, path) in [(&glass, &first), (&whitted, &second), (&glass, &first)] {
        window.live.leave();
        window.live.want_kept(Arc::new(scene.clone()), path.clone());
        window.wait("again", |w| w.status.in_step && *w.shown().scene == *scene);
        window.shows_whole(scene);
        assert_eq!((window.last().rays.total(), window.status.opened), (0, true));
    }
    window.wait("no job", |w| !is_tracing(w));
    assert_eq!(kept(&window), [&*first, &*second]);
}

#[test]
fn what_is_not_whole_when_it_is_left_is_not_kept() {
    let folder = folder();
    let path = path_of(&folder.path().join("scene.toml"));
    let mut window = Window::new(OPTIONS);
    window.want(&slow());
    window.wait("a preview", |w| w.newest.is_some());
    window.live.keep(path);
    window.live.leave();
    let plain = scene("plain", [64, 40], 1);
    window.want(&plain);
    window.wait("the other", |w| w.status.in_step && *w.shown().scene == plain);
    let [Event::Failed(text)] = &window.events[..] else { panic!("{:?}", window.events) };
    assert!(text.contains("another scene was opened") && files(&folder) == 0, "{text}");
}

#[test]
fn another_document_is_opened_from_its_cache_while_one_is_traced() {
    let whitted = scene("whitted", [160, 90], 4);
    let (_folder, path) = cache_of(&whitted);
    let mut window = Window::new(OPTIONS);
    window.want(&slow());
    window.wait("a preview", |w| w.newest.is_some());
    window.live.want_kept(Arc::new(whitted.clone()), path);
    window.wait("opened", |w| w.status.in_step);
    window.shows_whole(&whitted);
    assert_eq!((window.last().rays.total(), window.status.opened), (0, true));
}
