//! Traces a scene at every value of every setting, and compares the pictures.

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::advice::{best, mark_front};
use super::{Advice, Chart, Cost, Deviation, Goal, Point, SETTINGS, Setting, Sweep, text_of};
use crate::clock::thread_seconds;
use crate::color::srgb_code;
use crate::film::{Film, FilmBlock};
use crate::geometry::Geometry;
use crate::math::exposure_factor;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::path::set;
use crate::session::Options;
use crate::session::still::Still;
use crate::session::trace::TraceError;

/// What is to be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wishes {
    /// Samples per pixel of the reference, 8 … 4096.
    pub reference: u32,
    /// The error that is wanted.
    pub goal: Goal,
}

impl Default for Wishes {
    fn default() -> Wishes {
        Wishes { reference: 1024, goal: Goal::default() }
    }
}

/// What a measurement tells while it runs.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// The next picture is being traced.
    Traces {
        /// What it is: "trace.samples = 4".
        what: String,
        /// How many were traced before.
        done: usize,
        /// How many there will be at most.
        of: usize,
    },
    /// A point of the sweep of this setting was measured.
    Measured(&'static str, Point),
}

/// Sweeps every setting of a scene. Steps of `progress` are tiles of the picture being traced.
pub fn measure(
    scene: &Scene,
    options: Options,
    wishes: Wishes,
    progress: &Progress,
    tell: &mut dyn FnMut(News),
) -> Result<Chart, TraceError> {
    let Options { threads, memory } = options;
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|_| TraceError::Threads { threads })?;
    let geometry = Geometry::build(scene, progress)?;
    let of = SETTINGS.iter().filter_map(|s| s.values(scene, wishes.reference)).flatten().count();
    let tracer = Tracer { scene, geometry, pool, memory, progress };
    let mut run = Run { tracer, tell, done: 0, of: of + 2 };
    let (_, present) = run.timed("the scene as it is", scene)?;
    let mut sweeps: Vec<Sweep> = Vec::new();
    for setting in SETTINGS {
        if let Some(values) = setting.values(scene, wishes.reference) {
            sweeps.push(run.sweep(*setting, &values)?);
        }
    }
    let (values, error, reached) = best(&sweeps, present, wishes.goal);
    let mut advised = scene.clone();
    for (sweep, value) in sweeps.iter().zip(&values) {
        with(&mut advised, sweep.setting.path, &text_of(*value));
    }
    let (_, cost) = run.timed("the recommended settings", &advised)?;
    Ok(Chart {
        size: scene.picture.size,
        threads,
        reference: wishes.reference,
        goal: wishes.goal,
        present,
        present_error: present_error(&sweeps),
        sweeps,
        advice: Advice { values, error, cost, reached },
    })
}

/// What the errors of the scene's own values add up to.
fn present_error(sweeps: &[Sweep]) -> Option<Deviation> {
    sweeps.iter().try_fold(Deviation::default(), |sum, sweep| {
        let Deviation { linear, codes } = sweep.at(sweep.present)?.error;
        Some(Deviation { linear: sum.linear + linear, codes: sum.codes + codes })
    })
}

/// Sets what is known to be a parameter, to a value of its range.
fn with(scene: &mut Scene, path: &str, value: &str) {
    set(scene, path, value).unwrap_or_else(|error| panic!("a value of the ladder: {error}"));
}

/// What traces pictures of one scene.
struct Tracer<'a> {
    scene: &'a Scene,
    geometry: Geometry,
    pool: ThreadPool,
    memory: u64,
    progress: &'a Progress,
}

/// A measurement that runs.
struct Run<'a> {
    tracer: Tracer<'a>,
    tell: &'a mut dyn FnMut(News),
    done: usize,
    of: usize,
}

impl Run<'_> {
    /// Sweeps one setting, the truth first.
    fn sweep(&mut self, setting: Setting, values: &[f64]) -> Result<Sweep, TraceError> {
        let (&truth, values) = values.split_last().expect("a truth");
        let of = |value: f64| (self.tracer.scene.clone(), text_of(value));
        let (mut exact, text) = of(truth);
        with(&mut exact, setting.path, &text);
        setting.exact.iter().for_each(|(path, value)| with(&mut exact, path, value));
        let scenes: Vec<_> = values.iter().map(|&value| (value, of(value))).collect();
        let (truth_film, _) = self.traced(&format!("the truth of {}", setting.path), &exact)?;
        let gain = exposure_factor(exact.picture.exposure);
        let mut points = Vec::new();
        for (value, (mut scene, text)) in scenes {
            with(&mut scene, setting.path, &text);
            let (film, cost) = self.timed(&format!("{} = {text}", setting.path), &scene)?;
            let pixels = film.layout.pixels();
            let error = deviation(&film.blocks, &truth_film.blocks, pixels, gain);
            let point = Point { value, cost, error, front: false };
            (self.tell)(News::Measured(setting.path, point.clone()));
            points.push(point);
            if error == Deviation::default() {
                break;
            }
        }
        mark_front(&mut points);
        let present = setting.present(self.tracer.scene).unwrap_or(truth);
        Ok(Sweep { setting, present, truth, points })
    }

    /// Traces a scene once.
    fn traced(&mut self, what: &str, scene: &Scene) -> Result<(Film, Cost), TraceError> {
        let Run { tracer, tell, done, of } = self;
        tell(News::Traces { what: what.to_owned(), done: *done, of: *of });
        *done += 1;
        tracer.film(scene)
    }

    /// Traces a scene, again if that was quick: five times below half a second, three times below
    /// three.
    fn timed(&mut self, what: &str, scene: &Scene) -> Result<(Film, Cost), TraceError> {
        let (film, first) = self.traced(what, scene)?;
        let more = match first.seconds {
            s if s < 0.5 => 4,
            s if s < 3.0 => 2,
            _ => 0,
        };
        let mut times = vec![first.seconds];
        for _ in 0..more {
            times.push(self.tracer.film(scene)?.1.seconds);
        }
        times.sort_by(f64::total_cmp);
        Ok((film, Cost { seconds: times[times.len() / 2], runs: times.len(), ..first }))
    }
}

impl Tracer<'_> {
    fn film(&self, scene: &Scene) -> Result<(Film, Cost), TraceError> {
        let Tracer { scene: _, geometry, pool, memory, progress } = self;
        let still = Still { scene, geometry, pool, memory: *memory };
        let before = processor_seconds(pool);
        let (film, report) = still.film(progress)?;
        let seconds = processor_seconds(pool) - before;
        Ok((film, Cost { seconds, runs: 1, rays: report.rays.total() }))
    }
}

/// Processor time that the threads of a pool have taken so far.
fn processor_seconds(pool: &ThreadPool) -> f64 {
    pool.broadcast(|_| thread_seconds()).into_iter().sum()
}

/// How far the blocks of a picture are from the truth: as many of the same tiles, with so many pixels
/// in all. `gain` is the exposure's factor.
pub fn deviation(blocks: &[FilmBlock], truth: &[FilmBlock], pixels: u64, gain: f32) -> Deviation {
    assert_eq!(blocks.len(), truth.len(), "blocks of the same tiles");
    let (mut linear, mut codes) = (0.0, 0.0);
    for (a, b) in blocks.iter().zip(truth) {
        // Lanes beside the picture are 0 in both.
        for (&a, &b) in a.0.as_flattened().iter().zip(b.0.as_flattened()) {
            let light = f64::from(a * gain) - f64::from(b * gain);
            let code = f64::from(srgb_code(a * gain)) - f64::from(srgb_code(b * gain));
            linear += light * light;
            codes += code * code;
        }
    }
    let count = (pixels * 3) as f64;
    Deviation { linear: (linear / count).sqrt(), codes: (codes / count).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::layout::{Layout, TILE_BLOCKS};

    fn grey(value: f32, size: [u32; 2]) -> Film {
        let mut film = Film::new(Layout::new(size));
        for y in 0..size[1] {
            for x in 0..size[0] {
                let place = film.layout.place([x, y]);
                let block = &mut film.blocks[place.tile * TILE_BLOCKS + place.block];
                block.0.iter_mut().for_each(|row| row[place.lane] = value);
            }
        }
        film
    }

    #[test]
    fn deviations_are_those_of_the_definition() {
        let size = [50, 33];
        let (black, half) = (grey(0.0, size), grey(0.5, size));
        let deviation =
            |a: &Film, b: &Film, gain| deviation(&a.blocks, &b.blocks, a.layout.pixels(), gain);
        assert_eq!(deviation(&half, &half, 1.0), Deviation::default());
        let one = deviation(&half, &black, 1.0);
        assert!((one.linear - 0.5).abs() < 1e-12, "{one:?}");
        assert!((one.codes - f64::from(srgb_code(0.5))).abs() < 1e-9, "{one:?}");
        // Brighter than white: light counts, code values are clipped.
        let bright = deviation(&half, &black, 4.0);
        let white = f64::from(srgb_code(1.0));
        assert!((bright.linear - 2.0).abs() < 1e-12 && (bright.codes - white).abs() < 1e-9);
        // One channel of one pixel.
        let mut other = black.clone();
        other.blocks[3].0[1][2] = 1.0;
        let count: f64 = 50.0 * 33.0 * 3.0;
        assert!((deviation(&other, &black, 1.0).linear - (1.0 / count).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn values_hold_the_scene_s_own_and_end_with_the_truth() {
        let values = |setting: usize, path: &str, value: &str| {
            let mut scene = Scene::default();
            with(&mut scene, path, value);
            SETTINGS[setting].values(&scene, 64).expect("values")
        };
        assert_eq!(values(0, "trace.samples", "4"), [1., 2., 4., 8., 16., 64.]);
        assert_eq!(values(0, "trace.samples", "5"), [1., 2., 4., 5., 8., 16., 64.]);
        // Too near to the truth to be compared with it.
        assert_eq!(values(0, "trace.samples", "48"), [1., 2., 4., 8., 16., 64.]);
        assert_eq!(values(0, "trace.samples", "256"), [1., 2., 4., 8., 16., 64., 256.]);
        let fine = values(2, "trace.cutoff", "0");
        assert_eq!(fine.last(), Some(&0.0));
        let usual = values(2, "trace.cutoff", "0.003921569");
        assert_eq!(usual.len() + 1, fine.len(), "the usual value is among them: {usual:?}");
        assert_eq!(values(2, "trace.cutoff", "0.5")[0], 0.5);
        assert!(values(1, "trace.depth", "5").contains(&5.0));
    }
}
