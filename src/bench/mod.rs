//! Measures a scene: tracing, folding, re-shading, memory, against what the memory allows.

mod classes;
pub mod gpu;
mod memory;
mod pixels;
pub mod rays;
mod sampling;
pub mod solvers;

use std::time::Instant;

use serde_json::{Value, json};

use crate::film::layout::{LANES, Place, TILE_BLOCKS};
use crate::film::{Film, Frame};
use crate::fold::transport::{HighlightList, Transport};
use crate::forest::grow::RayCounts;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::scene::path::{parameters, set};
use crate::scene::range::Kind;
use crate::session::trace::{TraceError, TraceReport, trace_only};
use crate::session::{Class, Options, Session};

/// Seconds for all repeated traces, about: there are 1 … 5.
const TRACE_SECONDS: f64 = 30.0;
/// Seconds after which no further edit is measured, of each kind.
const EDIT_SECONDS: f64 = 10.0;

/// Traces `scene` and measures everything that `rayforest bench` reports, as one JSON object.
///
/// Times are medians of several runs of one process; ratios between them are meaningful, the
/// absolute values belong to the machine.
pub fn measure(name: &str, scene: Scene, options: Options) -> Result<Value, TraceError> {
    let progress = Progress::default();
    let mut session = Session::open(scene, options, &progress)?;
    let first = session.trace_report();
    let tiles: Vec<usize> = (0..session.transport().layout.tiles()).collect();
    let (mut kept, mut alone) = (Vec::new(), Vec::new());
    // Each run traces twice.
    let runs = (TRACE_SECONDS / (2.0 * first.seconds)).clamp(1.0, 5.0) as usize;
    for _ in 0..runs {
        let wanted = (session.scene(), &tiles[..]);
        let bare = trace_only(wanted, session.geometry(), session.pool(), &progress)?;
        alone.push(bare.seconds);
        session.trace_again(&progress)?;
        kept.push(session.trace_report());
    }
    kept.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let report = kept[kept.len() / 2];
    let trace_only_s = Spread::of(alone).median;
    let shading = Shading::measure(&mut session);
    let mut row = traced(name, &session, &report, first, trace_only_s);
    row["trace_runs"] = json!(runs);
    let rate = 1.0 / (trace_only_s * options.threads as f64);
    row["rays_per_core_s"] = json!(report.rays.total() as f64 * rate);
    row["memory_limit_ms"] = json!(shading.limit.median);
    row["reshade_full_ms"] = shading.product.json();
    row["reshade_over_limit"] = json!(shading.product.median / shading.limit.median);
    row["develop_ms"] =
        json!({ "film": shading.product.median, "eight_bit": shading.eight_bit.json() });
    row["terms_ms"] = json!(shading.terms.median);
    row["speedup"] = json!(report.seconds * 1e3 / shading.eight_bit.median);
    let original = session.shared_scene();
    let edits = Edits::measure(&mut session)?;
    session.edit(original, &progress)?;
    row["edit_ms"] = edits.json();
    let by = classes::Yardstick {
        trace: report.seconds * 1e3,
        rays: report.rays.total() as f64,
        reshade: shading.eight_bit.median,
        reshade_p99: shading.eight_bit.p99,
    };
    session.trace_again(&progress)?;
    row["inspect"] = pixels::measure(&session)?;
    row["sampling"] = sampling::measure(&session, &report)?;
    row["classes"] = classes::measure(&mut session, &by)?;
    row["peak_rss_mb"] = json!(memory::peak_resident_mb());
    Ok(row)
}

/// A few lines for people.
pub fn summary(row: &Value) -> String {
    let number = |path: &str| row.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    format!(
        "{}: trace {:.2} s ({} runs; alone {:.2}, fold {:.2}), {:.2} M rays/s per core\n  \
         re-shade {:.2} ms ({:.2} × memory limit), to 8 bits {:.2} ms: {:.0} times faster\n  \
         edit {:.2} ms, p99 {:.2}; {:.1} terms per pixel; bytes per pixel: forest {:.0}, \
         transport {:.1}, highlights {:.1}; peak {:.0} MB",
        row["scene"].as_str().unwrap_or("?"),
        number("/trace_s"),
        number("/trace_runs"),
        number("/trace_only_s"),
        number("/fold_s"),
        number("/rays_per_core_s") / 1e6,
        number("/reshade_full_ms/median"),
        number("/reshade_over_limit"),
        number("/develop_ms/eight_bit/median"),
        number("/speedup"),
        number("/edit_ms/median"),
        number("/edit_ms/p99"),
        number("/terms_per_pixel/mean"),
        number("/bytes_per_pixel/forest"),
        number("/bytes_per_pixel/transport"),
        number("/bytes_per_pixel/highlights"),
        number("/peak_rss_mb"),
    ) + &classes::summary(&row["classes"])
        + &sampling::summary(&row["sampling"])
        + &pixels::summary(&row["inspect"])
}

fn traced(
    name: &str,
    session: &Session,
    report: &TraceReport,
    first: TraceReport,
    trace_only_s: f64,
) -> Value {
    let RayCounts { camera, reflected, transmitted, shadow, lost } = report.rays;
    let (transport, forest) = (session.transport(), session.forest());
    let pixels = transport.layout.pixels() as f64;
    let (terms, distinct) = (terms_per_pixel(transport), distinct_terms(transport));
    json!({
        "scene": name,
        "size": session.scene().picture.size,
        "samples": session.scene().trace.samples,
        "threads": session.options().threads,
        "memory_budget_mb": session.options().memory as f64 / 1e6,
        "geometry_s": session.geometry_seconds(),
        "first_trace_s": first.seconds,
        "trace_s": report.seconds,
        "trace_only_s": trace_only_s,
        "fold_s": report.fold_seconds,
        "keep_over_trace_only": report.seconds / trace_only_s,
        "rays": { "total": report.rays.total(), "camera": camera, "reflected": reflected,
            "transmitted": transmitted, "shadow": shadow, "lost": lost },
        "nodes": report.nodes,
        "terms": distinct,
        "terms_per_pixel": terms,
        "bytes_per_pixel": {
            "forest": forest.bytes() as f64 / pixels,
            "transport": transport.bytes() as f64 / pixels,
            "highlights": transport.highlight_bytes() as f64 / pixels,
            "terms": session.term_bytes() as f64 / pixels,
        },
        "released_tiles": forest.released(),
        "tiles": forest.tiles.len(),
    })
}

/// Median and 99th percentile of some times in milliseconds or seconds.
pub(crate) struct Spread {
    median: f64,
    p99: f64,
    count: usize,
}

impl Spread {
    /// Of times in any order; NaN if there are none.
    pub(crate) fn of(mut times: Vec<f64>) -> Spread {
        times.sort_by(f64::total_cmp);
        let at = |share: f64| {
            times.get(((times.len() as f64 * share) as usize).min(times.len().saturating_sub(1)))
        };
        let pick = |share| at(share).copied().unwrap_or(f64::NAN);
        Spread { median: pick(0.5), p99: pick(0.99), count: times.len() }
    }

    /// With the number of times.
    pub(crate) fn json(&self) -> Value {
        json!({ "median": self.median, "p99": self.p99, "runs": self.count })
    }
}

/// Times `job` in milliseconds: 15 … 101 runs within about two seconds, after one to warm up.
fn repeat(mut job: impl FnMut()) -> Spread {
    let started = Instant::now();
    job();
    let mut times = Vec::new();
    while times.len() < 15 || (times.len() < 101 && started.elapsed().as_secs_f64() < 2.0) {
        let start = Instant::now();
        job();
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Spread::of(times)
}

/// Times of a full re-shade and its parts.
struct Shading {
    limit: Spread,
    terms: Spread,
    product: Spread,
    eight_bit: Spread,
}

impl Shading {
    fn measure(session: &mut Session) -> Shading {
        let mut film = Film::new(session.transport().layout);
        let limit =
            repeat(|| memory::read_and_write(session.pool(), session.transport(), &mut film));
        let product = repeat(|| session.develop_film(&mut film));
        let terms = repeat(|| session.evaluate_terms());
        let eight_bit = repeat(|| session.redraw());
        Shading { limit, terms, product, eight_bit }
    }
}

/// Random edits of one parameter each, from the edit to the finished 8-bit picture.
struct Edits {
    times: Spread,
    refolds: usize,
    changed_share: f64,
    too_small: usize,
    needing_rays: usize,
}

impl Edits {
    /// Takes up to 100 edits that change at least 1 % of the pixels and cast no ray, of every parameter
    /// that can: coefficients, exponents, switches, exposure. Asking for the class beforehand, as a
    /// badge does, is not part of the time.
    fn measure(session: &mut Session) -> Result<Edits, TraceError> {
        let mut random = Random(0x5eed);
        let kinds = [Kind::Coefficient, Kind::Number, Kind::Flag];
        let names: Vec<String> = parameters(session.scene())
            .into_iter()
            .filter(|p| kinds.contains(&p.kind))
            .map(|p| p.path)
            .collect();
        let (mut times, mut share) = (Vec::new(), 0.0);
        let (mut refolds, mut too_small, mut needing_rays) = (0, 0, 0);
        let started = Instant::now();
        for _ in 0..3000 {
            let late = started.elapsed().as_secs_f64() > EDIT_SECONDS;
            if times.len() == 100 || names.is_empty() || late {
                break;
            }
            let name = &names[random.below(names.len())];
            let Some(edited) = random_edit(session.scene(), name, &mut random) else { continue };
            if session.class_of(&edited) > Class::Refold {
                needing_rays += 1;
                continue;
            }
            let before = session.frame().clone();
            let report = session.edit(edited, &Progress::default())?;
            let changed = changed_share(&before, session.frame());
            if changed < 0.01 {
                too_small += 1;
                continue;
            }
            share += changed;
            refolds += usize::from(report.class == Class::Refold);
            times.push(report.milliseconds);
        }
        let changed_share = share / times.len().max(1) as f64;
        Ok(Edits { times: Spread::of(times), refolds, changed_share, too_small, needing_rays })
    }

    fn json(&self) -> Value {
        let mut value = self.times.json();
        value["refolds"] = json!(self.refolds);
        value["changed_share"] = json!(self.changed_share);
        value["too_small"] = json!(self.too_small);
        value["needing_rays"] = json!(self.needing_rays);
        value
    }
}

/// The scene with one parameter at a random value of a sensible range.
fn random_edit(scene: &Scene, name: &str, random: &mut Random) -> Option<Scene> {
    let mut edited = scene.clone();
    let unit = random.unit();
    let value = match name.rsplit('.').next() {
        Some("on") => (unit < 0.5).to_string(),
        Some("shininess") => format!("{:.2}", 1.0 + 199.0 * unit),
        Some("exposure") => format!("{:.3}", 4.0 * unit - 2.0),
        _ => format!("{:.3}", 0.05 + 0.9 * unit),
    };
    set(&mut edited, name, &value).ok().map(|()| edited)
}

fn changed_share(a: &Frame, b: &Frame) -> f64 {
    let pairs = a.bytes.chunks_exact(4).zip(b.bytes.chunks_exact(4));
    pairs.filter(|(a, b)| a != b).count() as f64 / (a.bytes.len() / 4) as f64
}

/// SplitMix64: reproducible edits.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

/// How many terms each pixel has: coefficients that are not zero, or would not be for another
/// exponent.
fn terms_per_pixel(transport: &Transport) -> Value {
    let mut counts = Vec::with_capacity(transport.layout.pixels() as usize);
    for (index, tile) in transport.tiles.iter().enumerate() {
        let mut masks: Vec<u32> = tile.planes.iter().map(|p| nonzero_lanes(&p.0)).collect();
        for list in tile.highlights.iter().flat_map(|h| &h.lists) {
            if list.at & HighlightList::SINGLE == 0 {
                masks[list.at as usize] |= u32::from(list.mask);
            }
        }
        for block in 0..TILE_BLOCKS {
            let (from, to) =
                (tile.starts[block].plane as usize, tile.starts[block + 1].plane as usize);
            let mut lanes = [0u32; LANES];
            for single in tile.block(block).singles {
                lanes[single.lane()] += 1;
            }
            for (lane, &singles) in lanes.iter().enumerate() {
                if transport.layout.pixel(Place { tile: index, block, lane }).is_some() {
                    let planes = masks[from..to].iter().filter(|&&m| m >> lane & 1 != 0).count();
                    counts.push(singles + planes as u32);
                }
            }
        }
    }
    counts.sort_unstable();
    let mean = counts.iter().map(|&c| f64::from(c)).sum::<f64>() / counts.len() as f64;
    let at = |share: f64| counts[((counts.len() as f64 * share) as usize).min(counts.len() - 1)];
    json!({ "mean": mean, "median": at(0.5), "p99": at(0.99) })
}

fn nonzero_lanes(plane: &[f32; LANES]) -> u32 {
    plane.iter().enumerate().fold(0, |mask, (i, &c)| mask | u32::from(c != 0.0) << i)
}

fn distinct_terms(transport: &Transport) -> usize {
    let marked = crate::fold::trie::Marks::TERM;
    transport.trie.nodes().iter().filter(|n| n.marks.has(marked)).count()
}
