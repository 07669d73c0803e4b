//! Adaptive sampling is a function of the scene: edits, threads, memory and files change no bit of it.

use rayforest::film::Film;
use rayforest::forest::signature::LEVELS;
use rayforest::geometry::Geometry;
use rayforest::progress::Progress;
use rayforest::scene::change::Change;
use rayforest::scene::path::parameters;
use rayforest::scene::{Scene, read};
use rayforest::session::Class::{self, Regrow, Reshade, Retrace};
use rayforest::session::still::Still;
use rayforest::session::trace::trace_only;
use rayforest::session::{Options, Session, cache};
use rayon::ThreadPoolBuilder;

use super::classes::row_of;
use super::table::{self, Row, SCENE, row};
use super::{PLENTY, assert_same_picture, film_difference, open, set, shipped};

/// A shipped scene with adaptive sampling.
fn adaptive(name: &str, size: [u32; 2]) -> Scene {
    let mut scene = shipped(name, size, 16);
    set(&mut scene, "trace.adaptive", "0.1");
    scene
}

#[test]
fn threads_memory_and_parts_change_no_bit() {
    for name in ["whitted", "glass"] {
        let scene = adaptive(name, [130, 70]);
        let whole = open(&scene, 2);
        let share = refined_share(&whole, 16);
        assert!(share > 0.05 && share < 0.99, "{name}: {share} of the pixels have all samples");
        assert_same_picture(&whole, &open(&scene, 1), "one thread");
        let matrix = whole.kept_bytes() - whole.forest().bytes() as u64;
        let options = Options { threads: 2, memory: matrix + whole.forest().bytes() as u64 / 3 };
        let small = Session::open(scene.clone(), options, &Progress::default()).unwrap();
        assert!(small.forest().released() > 0);
        assert_same_picture(&whole, &small, "released trees");
        let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let geometry = Geometry::build(&scene, &Progress::default()).unwrap();
        let still = Still { scene: &scene, geometry: &geometry, pool: &pool, memory: PLENTY };
        let (film, _) = still.film(&Progress::default()).unwrap();
        assert_eq!(film_difference(&film, &whole.film()), None, "{name}: a still");
        let tiles: Vec<usize> = (0..film.layout.tiles()).collect();
        let alone = trace_only((&scene, &tiles), &geometry, &pool, &Progress::default()).unwrap();
        assert_eq!(alone.rays, whole.trace_report().rays, "{name}: rays alone");
        let (tile, _) = still.light(&[4], &Progress::default()).unwrap();
        let blocks = whole.film().blocks;
        assert!(tile[..] == blocks[4 * 64..5 * 64], "{name}: one tile alone");
    }
}

/// Makes an edit and holds class, picture and sample map to those of a fresh trace; how many rays it
/// cast, and how many a trace casts.
fn edit(session: &mut Session, scene: &Scene, class: Class, what: &str) -> [u64; 2] {
    assert_eq!(session.class_of(scene), class, "{what}: beforehand");
    let report = session.edit(scene.clone(), &Progress::default()).unwrap();
    assert_eq!(report.class, class, "{what}: {:?}", report.reason);
    let fresh = open(scene, 2);
    assert_same_picture(session, &fresh, what);
    assert!(session.sample_map() == fresh.sample_map(), "{what}: numbers of samples");
    session.transport().validate();
    [report.rays.total(), fresh.trace_report().rays.total()]
}

#[test]
fn every_edit_gives_what_a_fresh_trace_gives() {
    let mut session = open(&adaptive("glass", [96, 64]), 2);
    let first = refined_share(&session, 16);
    let mut least = first;
    for (path, value, class) in [
        ("materials.ruby.color", "[0.9, 0.4, 0.4]", Class::Reshade),
        ("materials.ruby.shininess", "33", Class::Refold),
        ("materials.ruby.reflect", "0", Class::Regrow),
        ("materials.ruby.reflect", "0.3", Class::Regrow),
        ("materials.ruby.reflect", "0.29", Class::Reshade),
        ("materials.ruby.transmit", "0", Class::Regrow),
        ("materials.ruby.transmit", "0.8", Class::Regrow),
        ("materials.ruby.ior", "1.3", Class::Regrow),
        ("lights.0.on", "false", Class::Reshade),
        ("lights.0.point", "[1, -2, 6]", Class::Regrow),
        // What is seen by so many branches decides nothing.
        ("trace.depth", &(LEVELS + 1).to_string(), Class::Reshade),
        ("trace.depth", "1", Class::Regrow),
        ("trace.depth", "5", Class::Regrow),
        ("trace.depth", "6", Class::Regrow),
    ] {
        let path = path.replace("lights.0", &format!("lights.{}", session.scene().lights[0].name));
        let mut scene = session.scene().clone();
        set(&mut scene, &path, value);
        let [rays, all] = edit(&mut session, &scene, class, &format!("{path} = {value}"));
        assert!(rays < all, "{path} = {value}: {rays} of {all} rays");
        least = refined_share(&session, 16).min(least);
    }
    assert!(least < first, "without branches fewer pixels have all samples: {first}, {least}");
    let mut scene = session.scene().clone();
    scene.lights.pop();
    edit(&mut session, &scene, Class::Regrow, "a light less");
}

#[test]
fn by_contrast_every_edit_decides_again() {
    let mut scene = adaptive("whitted", [96, 64]);
    set(&mut scene, "trace.refine", "contrast");
    let mut session = open(&scene, 2);
    let before = refined_share(&session, 16);
    for (path, value, class) in [
        ("materials.tiles.texture.checker.a", "[0.9, 0.9, 0.1]", Class::Regrow),
        ("materials.tiles.shininess", "40", Class::Regrow),
        ("picture.exposure", "1", Class::Reshade),
        ("materials.tiles.kloc", "0", Class::Regrow),
        ("materials.tiles.kloc", "0.8", Class::Regrow),
        ("materials.tiles.reflect", "0.2", Class::Regrow),
        ("materials.tiles.kloc", "0", Class::Regrow),
    ] {
        let mut scene = session.scene().clone();
        set(&mut scene, path, value);
        edit(&mut session, &scene, class, &format!("{path} = {value}"));
    }
    let after = refined_share(&session, 16);
    assert!(after < before, "a black floor has no contrast: {before} {after}");
}

/// What costs something else than where every pixel has all samples.
const ROWS: &[Row] = &[
    row("trace.adaptive", &[("0.1", Retrace), ("0", Retrace), ("@", Retrace)]),
    row("trace.refine", &[("contrast", Retrace), ("trees", Retrace), ("@", Class::None)]),
    // What is seen by more than two branches decides nothing.
    row(
        "trace.depth",
        &[
            ("3", Reshade),
            ("4", Reshade),
            ("2", Regrow),
            ("4", Regrow),
            ("0", Regrow),
            ("5", Regrow),
        ],
    ),
    row("materials.plain.reflect", BECOMES_MIRROR),
    row("materials.tiles.reflect", BECOMES_MIRROR),
    row("materials.lamp.reflect", BECOMES_MIRROR),
    row("materials.plain.transmit", LETS_LIGHT_THROUGH),
    row("materials.mirror.transmit", LETS_LIGHT_THROUGH),
    row("materials.mirror.reflect", &[("0.49", Reshade), ("0", Regrow), ("@", Regrow)]),
    row("materials.glass.transmit", &[("0.79", Reshade), ("0", Regrow), ("@", Regrow)]),
];
const BECOMES_MIRROR: &[(&str, Class)] = &[
    ("0.004", Reshade),
    ("0.01", Regrow),
    ("0.009", Regrow),
    ("0.5", Regrow),
    ("0.49", Reshade),
    ("0", Regrow),
    ("[0, 0.004, 0]", Reshade),
    ("@", Reshade),
];
const LETS_LIGHT_THROUGH: &[(&str, Class)] =
    &[("0.004", Regrow), ("0", Regrow), ("0.5", Regrow), ("0", Regrow), ("@", Class::None)];

/// What a step of a table costs where sampling is adaptive, if one can tell: reading trees again may
/// give some pixel more samples.
fn cost_here(path: &str, change: &Change, class: Class) -> Option<Class> {
    let key = path.rsplit('.').next().unwrap_or_default();
    let wakes = ["reflect", "transmit", "filter", "depth", "cutoff"].contains(&key);
    let listed = ROWS.iter().any(|row| row.path == path);
    match class {
        Class::Refold if change.moves_rays.is_some() => Some(Regrow),
        class => (listed || !wakes).then_some(class),
    }
}

#[test]
fn every_parameter_costs_what_the_table_says() {
    let mut scene = read::text(SCENE, std::path::Path::new("all-kinds.toml")).unwrap();
    set(&mut scene, "trace.samples", "9");
    set(&mut scene, "trace.adaptive", "0.2");
    let first = open(&scene, 2);
    let counts = first.sample_map().unwrap().to_list();
    let fewer = counts.iter().filter(|count| **count < 9).count();
    assert!(fewer > 100 && counts.contains(&8) && counts.contains(&9));
    let mut known = 0;
    for parameter in parameters(&scene) {
        let path = parameter.path.as_str();
        let row = row_of(ROWS, path).or_else(|_| row_of(table::ROWS, path)).unwrap();
        let mut session = open(&scene, 2);
        for (value, class) in row.steps {
            let value = if *value == "@" { parameter.value.as_str() } else { value };
            let what = format!("{path} = {value}");
            let mut edited = session.scene().clone();
            set(&mut edited, path, value);
            let change = Change::between(session.scene(), &edited);
            let class = match *session.scene() == edited {
                true => Some(Class::None),
                false => cost_here(path, &change, *class),
            };
            known += usize::from(class.is_some());
            let class = class.unwrap_or_else(|| session.class_of(&edited));
            let [rays, all] = edit(&mut session, &edited, class, &what);
            assert!(
                if class == Retrace { rays == all } else { rays < all },
                "{what}: {rays}, {all}"
            );
            assert!(class >= Regrow || rays == 0, "{what}");
        }
    }
    assert!(known > 200, "{known}");
}

#[test]
fn a_kept_cache_opens_without_a_ray() {
    let scene = adaptive("whitted", [70, 50]);
    let session = open(&scene, 2);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.rayforest");
    for trees in [false, true] {
        cache::write(&session, &path, trees, &Progress::default()).unwrap();
        let options = Options { threads: 2, memory: PLENTY };
        let opened = Session::open_cached(scene.clone(), &path, options, &Progress::default());
        let (mut opened, report) = opened.unwrap();
        assert_eq!(report.edit.rays.total(), 0);
        assert_same_picture(&opened, &session, "opened");
        assert_eq!(opened.is_adaptive(), session.is_adaptive());
        let mut redder = scene.clone();
        set(&mut redder, "materials.mirror.color", "[1, 0.2, 0.2]");
        opened.edit(redder.clone(), &Progress::default()).unwrap();
        assert_same_picture(&opened, &open(&redder, 1), "edited");
    }
}

/// Root of the mean squared difference of two pictures.
fn error(a: &Film, b: &Film) -> f64 {
    let [width, height] = a.layout.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let square = |pixel| {
        let (a, b) = (a.pixel(pixel).0, b.pixel(pixel).0);
        a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / 3.0
    };
    (pixels.map(square).sum::<f64>() / f64::from(width * height)).sqrt()
}

#[test]
fn fewer_rays_are_spent_where_they_matter() {
    let truth = open(&shipped("whitted", [192, 128], 128), 2).film();
    let uniform = open(&shipped("whitted", [192, 128], 16), 2);
    let few = open(&shipped("whitted", [192, 128], 4), 2);
    let adaptive = open(&adaptive("whitted", [192, 128]), 2);
    let rays = |session: &Session| session.trace_report().rays.total() as f64;
    assert!(rays(&adaptive) < 0.85 * rays(&uniform));
    let [coarse, fine, own] = [&few, &uniform, &adaptive].map(|s| error(&s.film(), &truth));
    assert!(own < 1.2 * fine && own < 0.7 * coarse, "errors {coarse} {fine} {own}");
}

/// A white bar before black, seen in parallel: as wide as a tenth of a pixel, at an angle.
fn wire(adaptive: f32) -> Scene {
    let text = format!(
        "version = 1\nambient_light = 1\n[picture]\nsize = [96, 64]\n[camera]\neye = [0, 0, 50]\n\
         target = [0, 0, 0]\nup = [0, 1, 0]\nheight = 64\n[background]\ncolor = 0\n\
         [trace]\nsamples = 1024\nadaptive = {adaptive}\n[materials.white]\nambient = 1\n\
         [solids.wire]\nbox = {{ min = [-40, -0.05, -0.05], max = [40, 0.05, 0.05] }}\n\
         rotate_degrees = [0, 0, 17]\nmaterial = \"white\"\n"
    );
    read::text(&text, std::path::Path::new("wire.toml"))
        .unwrap_or_else(|e| panic!("a sound scene: {e}"))
}

#[test]
fn a_wire_of_a_tenth_of_a_pixel_keeps_its_light_and_has_no_gaps() {
    let session = open(&wire(0.1), 2);
    let film = session.film();
    let [width, height] = film.layout.size;
    let light = |x: u32| (0..height).map(|y| f64::from(film.pixel([x, y]).0[0])).sum::<f64>();
    let columns: Vec<f64> = (0..width).map(light).collect();
    // Inside of its ends; a column shows its width over the cosine of its angle.
    let inside = &columns[12..84];
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    let truth = 0.1 / libm::cos(17f64.to_radians());
    assert!((mean / truth - 1.0).abs() < 0.03, "{mean} for {truth}");
    let gap = inside.windows(2).any(|pair| pair == [0.0, 0.0]);
    assert!(!gap, "two columns without any of it");
    assert!(refined_share(&session, 1024) < 0.2, "only the wire gets all samples");
}

/// The share of the pixels that have so many samples.
fn refined_share(session: &Session, samples: u32) -> f64 {
    let [width, height] = session.scene().picture.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let all = pixels.filter(|&pixel| session.samples_of(pixel) == samples).count();
    all as f64 / f64::from(width * height)
}
