//! What samples cost: re-shading many of them, adaptive sampling, an area light.

use serde_json::{Value, json};

use super::{Spread, repeat};
use crate::chart::{Deviation, deviation};
use crate::film::FilmBlock;
use crate::film::layout::{Layout, TILE_BLOCKS};
use crate::film::pixels::PixelSet;
use crate::math::exposure_factor;
use crate::progress::Progress;
use crate::scene::refine::Refine;
use crate::scene::{PILOTS, Scene, Trace};
use crate::session::still::Still;
use crate::session::trace::{TraceError, TraceReport, trace_only};
use crate::session::{Options, Session};

/// Seconds that a row may take, about: pictures are made smaller, or have fewer tiles, until they fit.
const ROW_SECONDS: f64 = 15.0;
/// Samples of the picture that errors are held against.
const REFERENCE: u32 = 1024;
/// Numbers of uniform samples, and with how many at most adaptive sampling is to reach their error.
const UNIFORM: [(u32, [u32; 3]); 2] = [(16, [18, 24, 32]), (64, [72, 96, 128])];
/// Those that are tried.
const WAYS: [Way; 3] = [(Refine::Trees, 0.1), (Refine::Contrast, 0.1), (Refine::Contrast, 0.06)];
/// Every pixel has all samples.
const EVERY: Way = (Refine::Trees, 0.0);
/// Rays of the area light.
const LIGHT_SAMPLES: [u32; 2] = [1, 64];

/// What adaptive sampling compares, and its step.
type Way = (Refine, f32);

/// A scene and what tracing it takes.
struct Bench<'a> {
    session: &'a Session,
    /// Seconds per sample.
    pace: f64,
}

/// The rows of a scene that `session` has traced.
pub(super) fn measure(session: &Session, trace: &TraceReport) -> Result<Value, TraceError> {
    let samples = trace.rays.camera.max(1) as f64;
    let bench = Bench { session, pace: trace.seconds / samples };
    Ok(json!({
        "many_samples": bench.many_samples()?,
        "adaptive": bench.adaptive()?,
        "area_light": bench.area_light()?,
    }))
}

impl Bench<'_> {
    /// A full re-shade to 8 bits with 64 samples per pixel, against one with 1.
    fn many_samples(&self) -> Result<Value, TraceError> {
        let size = self.size_for(65.0);
        let mut scene = self.session.scene().clone();
        scene.picture.size = size;
        let times = |samples| -> Result<(Spread, f64), TraceError> {
            let scene = Scene { trace: trace_of(&scene, samples, EVERY), ..scene.clone() };
            // Beside the trees of the session that is measured; these need none.
            let options = Options { memory: self.options().memory / 4, ..self.options() };
            let mut session = Session::open(scene, options, &Progress::default())?;
            let bytes = session.transport().bytes() as f64;
            let pixels = session.transport().layout.pixels() as f64;
            Ok((repeat(|| session.redraw()), bytes / pixels))
        };
        let [(one, one_bytes), (many, many_bytes)] = [times(1)?, times(64)?];
        Ok(json!({
            "size": size, "ms_1": one.json(), "ms_64": many.json(),
            "over_1": many.median / one.median,
            "bytes_per_pixel": [one_bytes, many_bytes],
        }))
    }

    /// Rays and errors of adaptive sampling against uniform sampling of some of the picture's tiles.
    fn adaptive(&self) -> Result<Value, TraceError> {
        let most: u32 = UNIFORM.iter().flat_map(|(_, most)| most).sum();
        let samples = f64::from(REFERENCE + most * WAYS.len() as u32);
        let tiles = self.tiles_for(samples);
        let around = self.around(&tiles)?;
        let (truth, _) = self.light(&tiles, REFERENCE, EVERY)?;
        let mut rows = Vec::new();
        for (uniform, most) in UNIFORM {
            let (light, rays) = self.light(&tiles, uniform, EVERY)?;
            let error = self.error(&tiles, &light, &truth);
            let mut tried = Vec::new();
            for samples in most {
                for way in WAYS {
                    let (light, adaptive) = self.light(&tiles, samples, way)?;
                    let share = (adaptive as f64 - around) / rays as f64;
                    tried.push((samples, way, share, self.error(&tiles, &light, &truth)));
                }
            }
            let reaching = tried.iter().filter(|(.., reached)| reached.codes <= error.codes);
            let best = reaching.min_by(|a, b| a.2.total_cmp(&b.2)).map(row_of);
            rows.push(json!({
                "uniform": uniform, "rays": rays, "error_codes": error.codes,
                "error_linear": error.linear, "best": best,
                "tried": tried.iter().map(row_of).collect::<Vec<_>>(),
            }));
        }
        Ok(json!({ "reference": REFERENCE, "tiles": tiles.len(), "rows": rows }))
    }

    /// What an area light of 64 samples takes beyond one of 1, traced, kept and folded, against its
    /// shadow rays alone, of which nothing is kept. `null` of a scene without an area light.
    fn area_light(&self) -> Result<Value, TraceError> {
        let scene = self.session.scene();
        let Some(light) = scene.lights.iter().position(|light| light.place.is_spread()) else {
            return Ok(Value::Null);
        };
        let tiles = self.tiles_for(f64::from(scene.trace.samples * 6 * LIGHT_SAMPLES[1]));
        let progress = Progress::default();
        let mut taken = Vec::new();
        for samples in LIGHT_SAMPLES {
            let mut scene = scene.clone();
            scene.lights[light].samples = samples;
            let still = self.still(&scene);
            let (mut whole, mut alone, mut rays) = (Vec::new(), Vec::new(), 0);
            for _ in 0..3 {
                let (_, report) = still.light(&tiles, &progress)?;
                whole.push(report.seconds);
                rays = report.rays.shadow;
                let (geometry, pool) = (self.session.geometry(), self.session.pool());
                alone.push(trace_only((&scene, &tiles), geometry, pool, &progress)?.seconds);
            }
            taken.push((Spread::of(whole).median, Spread::of(alone).median, rays as f64));
        }
        let [(whole_1, alone_1, rays_1), (whole, alone, rays)] = taken[..] else {
            return Ok(Value::Null);
        };
        Ok(json!({
            "light": scene.lights[light].name, "tiles": tiles.len(), "runs": 3,
            "shadow_rays": [rays_1, rays],
            "seconds": [whole_1, whole], "rays_alone_seconds": [alone_1, alone],
            "over_shadow_rays": (whole - whole_1) / (alone - alone_1),
            "ns_per_shadow_ray": (whole - whole_1) / (rays - rays_1) * 1e9,
        }))
    }

    fn options(&self) -> Options {
        self.session.options()
    }

    fn still<'a>(&'a self, scene: &'a Scene) -> Still<'a> {
        let (geometry, pool) = (self.session.geometry(), self.session.pool());
        Still { scene, geometry, pool, memory: self.options().memory }
    }

    /// The scene's size, smaller where so many samples per pixel would take too long.
    fn size_for(&self, samples: f64) -> [u32; 2] {
        let [w, h] = self.session.scene().picture.size.map(f64::from);
        let scale = (ROW_SECONDS / (self.pace * samples * w * h)).sqrt().min(1.0);
        [w, h].map(|side| ((side * scale) as u32).max(16))
    }

    /// As many of the picture's tiles, evenly spread, as take not too long with so many samples.
    fn tiles_for(&self, samples: f64) -> Vec<usize> {
        let layout = Layout::new(self.session.scene().picture.size);
        let per_tile = self.pace * samples * layout.pixels() as f64 / layout.tiles() as f64;
        let count = ((ROW_SECONDS / per_tile) as usize).clamp(1, layout.tiles());
        (0..count).map(|i| (2 * i + 1) * layout.tiles() / (2 * count)).collect()
    }

    /// About how many rays the first samples of the pixels around some tiles take, of which a whole
    /// picture has none: as many for each as for the tiles' own.
    fn around(&self, tiles: &[usize]) -> Result<f64, TraceError> {
        let layout = Layout::new(self.session.scene().picture.size);
        let own = PixelSet::of_tiles(layout, tiles.iter().copied());
        let [all, own_count] = [own.widened().places().count(), own.places().count()];
        let rays = self.light(tiles, PILOTS, EVERY)?.1;
        Ok(rays as f64 * (all as f64 / own_count as f64 - 1.0))
    }

    /// The light of some tiles, and how many rays were cast.
    fn light(
        &self,
        tiles: &[usize],
        samples: u32,
        way: Way,
    ) -> Result<(Vec<FilmBlock>, u64), TraceError> {
        let scene = self.session.scene();
        let progress = Progress::default();
        let wanted = Scene { trace: trace_of(scene, samples, way), ..scene.clone() };
        let (light, report) = self.still(&wanted).light(tiles, &progress)?;
        Ok((light, report.rays.total()))
    }

    fn error(&self, tiles: &[usize], light: &[FilmBlock], truth: &[FilmBlock]) -> Deviation {
        let scene = self.session.scene();
        let layout = Layout::new(scene.picture.size);
        let blocks = tiles.iter().flat_map(|&tile| (0..TILE_BLOCKS).map(move |b| (tile, b)));
        let pixels = blocks.map(|(tile, block)| u64::from(layout.lanes(tile, block).count_ones()));
        deviation(light, truth, pixels.sum(), exposure_factor(scene.picture.exposure))
    }
}

/// The scene's way to trace, with so many samples, adaptive by `refine` with a step.
fn trace_of(scene: &Scene, samples: u32, (refine, adaptive): Way) -> Trace {
    Trace { samples, adaptive, refine, ..scene.trace.clone() }
}

fn row_of(&(samples, (refine, step), share, error): &(u32, Way, f64, Deviation)) -> Value {
    json!({
        "samples": samples, "refine": Refine::NAMES[refine as usize], "step": step, "share_of_rays": share,
        "error_codes": error.codes, "error_linear": error.linear,
    })
}

/// A few lines for people.
pub(super) fn summary(rows: &Value) -> String {
    let number = |row: &Value, path: &str| row.pointer(path).and_then(Value::as_f64);
    let of = |row: &Value, path: &str| number(row, path).unwrap_or(f64::NAN);
    let mut text = format!(
        "\n  re-shade at 64 samples {:.2} ms, {:.2} × at 1 ({} × {})",
        of(rows, "/many_samples/ms_64/median"),
        of(rows, "/many_samples/over_1"),
        of(rows, "/many_samples/size/0"),
        of(rows, "/many_samples/size/1"),
    );
    for row in rows["adaptive"]["rows"].as_array().into_iter().flatten() {
        text += &match number(row, "/best/share_of_rays") {
            Some(share) => format!(
                "\n  the error of {} uniform samples with {share:.2} of their rays: at most {} \
                 samples, {} with step {:.2} ({} tiles)",
                row["uniform"],
                row["best"]["samples"],
                row["best"]["refine"].as_str().unwrap_or("?"),
                of(row, "/best/step"),
                rows["adaptive"]["tiles"],
            ),
            None => format!("\n  the error of {} uniform samples: not reached", row["uniform"]),
        };
    }
    if let Some(over) = number(rows, "/area_light/over_shadow_rays") {
        let one = of(rows, "/area_light/ns_per_shadow_ray");
        text += &format!("\n  area light of 64 samples {over:.2} × its rays ({one:.0} ns each)");
    }
    text
}
