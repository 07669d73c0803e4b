//! What it costs to take a pixel apart, as the window's panel does.

use std::time::Instant;

use serde_json::{Value, json};

use super::Spread;
use crate::progress::Progress;
use crate::session::Session;
use crate::session::inspect::{TreeNode, bars, merged};
use crate::session::trace::TraceError;

/// Pixels along both sides of the picture.
const GRID: [u32; 2] = [24, 14];
/// How often the largest one is measured.
const RUNS: usize = 9;

/// Times from a click to a tree put together, with its bars.
pub(super) fn measure(session: &Session) -> Result<Value, TraceError> {
    let [width, height] = session.scene().picture.size;
    let [columns, rows] = GRID;
    let at = |i: u32, side: u32, count: u32| (2 * i + 1) * side / (2 * count);
    let pixels = (0..rows)
        .flat_map(|y| (0..columns).map(move |x| [x, y]))
        .map(|[x, y]| [at(x, width, columns), at(y, height, rows)]);
    let (mut times, mut largest) = (Vec::new(), (0, [0, 0]));
    for pixel in pixels {
        let (nodes, ms) = inspect(session, pixel)?;
        times.push(ms);
        largest = largest.max((nodes, pixel));
    }
    let (nodes, pixel) = largest;
    let again: Result<Vec<f64>, TraceError> =
        (0..RUNS).map(|_| Ok(inspect(session, pixel)?.1)).collect();
    let most = Spread::of(again?);
    Ok(json!({
        "pixels": times.len(),
        "ms": Spread::of(times).json(),
        "largest": { "pixel": pixel, "nodes": nodes, "ms": most.json() },
        "ms_per_1000_nodes": most.median * 1000.0 / nodes.max(1) as f64,
    }))
}

/// A line for people.
pub(super) fn summary(row: &Value) -> String {
    let number = |path: &str| row.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    format!(
        "\n  pixels taken apart: {:.2} ms, p99 {:.2}; the largest, of {:.0} nodes, {:.2} ms: {:.2} ms \
         per 1000 nodes",
        number("/ms/median"),
        number("/ms/p99"),
        number("/largest/nodes"),
        number("/largest/ms/median"),
        number("/ms_per_1000_nodes"),
    )
}

/// The nodes of a pixel's trees, and the milliseconds that it took.
fn inspect(session: &Session, pixel: [u32; 2]) -> Result<(usize, f64), TraceError> {
    let start = Instant::now();
    let tree = session.inspect(pixel, &Progress::default())?;
    let together = merged(tree.samples.iter().cloned());
    let bars = bars(&together);
    let ms = start.elapsed().as_secs_f64() * 1e3;
    drop(bars);
    Ok((tree.samples.iter().map(nodes).sum(), ms))
}

/// A node and all below it.
fn nodes(node: &TreeNode) -> usize {
    1 + node.below.iter().map(nodes).sum::<usize>()
}
