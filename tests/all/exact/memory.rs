//! Within less memory than everything needs: the same picture from fewer kept trees, or a clear no.

use rayforest::progress::Progress;
use rayforest::scene::Scene;
use rayforest::session::trace::TraceError;
use rayforest::session::{Class, Options, Session};

use super::{assert_same_picture, open, set, shipped};

fn within(scene: &Scene, memory: u64) -> Result<Session, TraceError> {
    Session::open(scene.clone(), Options { threads: 2, memory }, &Progress::default())
}

/// Bytes of the matrix alone, of the highlight lists, and of the trees.
fn needs(session: &Session) -> [u64; 3] {
    let matrix: usize = session.transport().tiles.iter().map(|tile| tile.bytes()).sum();
    [matrix, session.transport().highlight_bytes(), session.forest().bytes()].map(|b| b as u64)
}

fn lists_released(session: &Session) -> usize {
    session.transport().tiles.iter().filter(|tile| tile.highlights.is_none()).count()
}

/// A picture of many tiles with highlights everywhere.
fn shiny() -> Scene {
    let mut scene = shipped("whitted", [200, 120], 4);
    set(&mut scene, "materials.tiles.specular", "0.5");
    scene
}

fn edited(session: &mut Session, path: &str, value: &str) -> Class {
    let mut scene = session.scene().clone();
    set(&mut scene, path, value);
    let report = session.edit(scene, &Progress::default()).unwrap();
    let fresh = open(session.scene(), 2);
    assert_same_picture(session, &fresh, &format!("{path} = {value}"));
    report.class
}

#[test]
fn released_trees_change_no_picture_and_grow_again_on_demand() {
    let whole = open(&shiny(), 2);
    let [matrix, lists, trees] = needs(&whole);
    let mut session = within(&shiny(), matrix + lists + trees / 2).unwrap();
    let released = session.forest().released();
    assert!(released > 0 && released < session.forest().tiles.len(), "{released} released");
    assert_eq!(lists_released(&session), 0, "trees go before highlight lists");
    assert!(session.transport() == whole.transport());
    assert_same_picture(&session, &whole, "fewer trees");
    for tile in 0..session.forest().tiles.len() {
        let trees = session.trees(tile, &Progress::default()).unwrap();
        let once = whole.trees(tile, &Progress::default()).unwrap();
        assert!(trees == once, "tile {tile} grown again");
    }
    assert_eq!(edited(&mut session, "materials.tiles.diffuse", "0.2"), Class::Reshade);
    assert_eq!(edited(&mut session, "materials.tiles.shininess", "9"), Class::Refold);
    assert_eq!(edited(&mut session, "materials.tiles.reflect", "0.4"), Class::Regrow);
    assert_eq!(edited(&mut session, "materials.tiles.reflect", "0"), Class::Reshade);
}

#[test]
fn released_highlight_lists_change_no_picture_and_a_new_exponent_says_so() {
    let whole = open(&shiny(), 2);
    let [matrix, lists, _] = needs(&whole);
    for share in [3, 2, 1] {
        let mut session = within(&shiny(), matrix + lists * share / 4).unwrap();
        assert!(lists_released(&session) > 0, "{share}/4 of the lists");
        assert_same_picture(&session, &whole, "fewer lists");
        assert_eq!(edited(&mut session, "materials.tiles.diffuse", "0.2"), Class::Reshade);
        assert_eq!(edited(&mut session, "materials.tiles.shininess", "9"), Class::Regrow);
    }
}

#[test]
fn the_matrix_alone_is_enough() {
    let whole = open(&shiny(), 2);
    let [matrix, ..] = needs(&whole);
    let mut session = within(&shiny(), matrix).unwrap();
    assert_eq!(session.forest().released(), session.forest().tiles.len());
    assert_same_picture(&session, &whole, "the matrix alone");
    assert_eq!(edited(&mut session, "lights.key.intensity", "2"), Class::Reshade);
}

#[test]
fn less_than_the_matrix_is_refused_and_says_how_much() {
    let [matrix, ..] = needs(&open(&shiny(), 2));
    for budget in [0, 1, matrix / 2, matrix - 1] {
        assert_eq!(within(&shiny(), budget).err(), Some(TraceError::Memory { budget }));
    }
    let words = TraceError::Memory { budget: 3 << 30 }.to_string();
    assert!(words.contains("3.00 GiB"), "{words}");
}

#[test]
fn an_edit_that_fits_when_traced_afresh_fits_after_any_history() {
    let [low, high] = low_and_high();
    let budget = needs(&open(&low, 2)).iter().sum();
    let mut session = within(&low, budget).unwrap();
    assert_eq!(session.forest().released(), 0, "the budget is filled with trees");
    let afresh = within(&high, budget).unwrap();
    let report = session.edit(high, &Progress::default()).unwrap();
    assert_eq!(report.class, Class::Retrace);
    assert_same_picture(&session, &afresh, "one after the other");
    assert_eq!(lists_released(&session), lists_released(&afresh), "highlight lists");
}

/// Two views: the first has its trees in the lower tiles, the second its matrix in the upper ones.
fn low_and_high() -> [Scene; 2] {
    let mut low = shiny();
    set(&mut low, "picture.size", "[480, 128]");
    set(&mut low, "camera.target", "[0.25, 0, 2.6]");
    set(&mut low, "trace.depth", "0");
    set(&mut low, "trace.samples", "16");
    set(&mut low, "lights.key.point", "[0, 0, -50]");
    let mut high = shiny();
    set(&mut high, "picture.size", "[480, 128]");
    set(&mut high, "camera.target", "[0.25, 0, -1.4]");
    set(&mut high, "solids.floor.plane.offset", "-40");
    [low, high]
}

#[test]
fn an_edit_that_does_not_fit_leaves_the_old_picture() {
    let [matrix, lists, trees] = needs(&open(&shiny(), 2));
    let mut session = within(&shiny(), matrix + lists + trees).unwrap();
    let (frame, film) = (session.frame().clone(), session.film());
    let mut larger = session.scene().clone();
    set(&mut larger, "picture.size", "[2000, 1200]");
    let error = session.edit(larger, &Progress::default()).unwrap_err();
    assert_eq!(error, TraceError::Memory { budget: matrix + lists + trees });
    assert!(*session.scene() == shiny() && *session.frame() == frame && session.film() == film);
    assert_eq!(edited(&mut session, "materials.mirror.reflect", "0.3"), Class::Reshade);
    assert_eq!(edited(&mut session, "materials.mirror.shininess", "30"), Class::Refold);
}

/// Glass that neither weight nor cut-off stops: every ray branches in two, 64 times.
fn endless() -> Scene {
    let mut scene = shipped("glass", [32, 18], 1);
    set(&mut scene, "trace.cutoff", "0");
    set(&mut scene, "trace.depth", "64");
    for material in &mut scene.materials {
        material.reflect = rayforest::color::Rgb::WHITE;
        material.transmit = rayforest::color::Rgb::WHITE;
    }
    scene
}

#[test]
fn rays_that_branch_without_end_are_refused_and_not_followed_until_memory_ends() {
    let error = within(&endless(), 1 << 20).err();
    assert_eq!(error, Some(TraceError::Branches { budget: 1 << 20 }));
    assert!(TraceError::Branches { budget: 1 << 20 }.to_string().contains("trace.depth"));
}

#[test]
fn rays_that_branch_without_end_can_be_cancelled() {
    let progress = Progress::default();
    let options = Options { threads: 2, memory: 1 << 33 };
    std::thread::scope(|scope| {
        let job = scope.spawn(|| Session::open(endless(), options, &progress).err());
        std::thread::sleep(std::time::Duration::from_millis(100));
        progress.cancel();
        assert_eq!(job.join().unwrap(), Some(TraceError::Cancelled));
    });
}
