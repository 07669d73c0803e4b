//! Measures the matrix product on a graphics card, by the card's clock, and how its picture differs.

use std::time::Instant;

use serde_json::{Value, json};

use super::Spread;
use crate::film::Frame;
use crate::film::develop::Development;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::{Options, Session};
use crate::shade::gpu::{Gpu, Product};

/// Uploads of the whole matrix, each with one dispatch.
const UPLOADS: usize = 15;
/// Edits as the window makes them.
const EDITS: usize = 101;

/// Traces `scene` and measures its product on a card, as one JSON object.
///
/// `values_upload_ms` and `dispatch_ms` are by the card's clock, and missing if it has none; all others
/// are what a thread of the processor waits. Cards that are the processor itself prove the shader;
/// their times tell nothing of a card.
pub fn measure(name: &str, scene: Scene, options: Options, gpu: &Gpu) -> Result<Value, String> {
    let mut session = Session::open(scene, options, &Progress::default());
    let session = session.as_mut().map_err(|e| e.to_string())?;
    let development = Development::of(&session.scene().picture);
    let mut product = Product::new(gpu.clone());
    let (mut uploads, mut values, mut dispatches) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..UPLOADS {
        let terms = &session.terms().values;
        let times =
            product.measure(session.transport(), terms, development).map_err(|e| e.to_string())?;
        uploads.push(times.matrix);
        values.extend(times.values);
        dispatches.extend(times.dispatch);
    }
    let mut calls = Vec::new();
    for _ in 0..EDITS {
        let begun = Instant::now();
        let picture = product.frame(session.transport(), &session.terms().values, development);
        calls.push(begun.elapsed().as_secs_f64() * 1e3);
        // The next edit comes when this one is done.
        picture.and_then(|_| gpu.wait()).map_err(|e| e.to_string())?;
    }
    let picture = product.frame(session.transport(), &session.terms().values, development);
    let frame = picture.and_then(|picture| picture.read(gpu)).map_err(|e| e.to_string())?;
    let (differing, most) = differences(session.frame(), &frame);
    let processor = super::repeat(|| session.redraw());
    let transport = session.transport();
    let spread = |times: Vec<f64>| (!times.is_empty()).then(|| Spread::of(times).json());
    Ok(json!({
        "scene": name,
        "size": session.scene().picture.size,
        "samples": session.scene().trace.samples,
        "threads": options.threads,
        "device": gpu.name(),
        "software": gpu.is_software(),
        "bindings": product.parts(),
        "terms": session.terms().values.len(),
        "transport_bytes": transport.bytes(),
        "matrix_upload_ms": Spread::of(uploads).json(),
        "values_upload_ms": spread(values),
        "dispatch_ms": spread(dispatches),
        "edit_call_ms": Spread::of(calls).json(),
        "processor_ms": processor.json(),
        "differing_share": differing,
        "largest_difference": most,
    }))
}

/// The share of pixels that differ, and by how many code values at most.
fn differences(a: &Frame, b: &Frame) -> (f64, u8) {
    let most = a.bytes.iter().zip(&b.bytes).map(|(a, b)| a.abs_diff(*b)).max();
    (super::changed_share(a, b), most.unwrap_or(0))
}

/// A few lines for people.
pub fn summary(row: &Value) -> String {
    let number = |path: &str| row.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    format!(
        "{} on {}: upload of the matrix {:.1} ms, of {} terms {:.3} ms\n  dispatch {:.2} ms, p99 \
         {:.2}; the call {:.2} ms, p99 {:.2}; the processor {:.2} ms; {:.3} % of the pixels differ, \
         by {} code values at most",
        row["scene"].as_str().unwrap_or("?"),
        row["device"].as_str().unwrap_or("?"),
        number("/matrix_upload_ms/median"),
        row["terms"],
        number("/values_upload_ms/median"),
        number("/dispatch_ms/median"),
        number("/dispatch_ms/p99"),
        number("/edit_call_ms/median"),
        number("/edit_call_ms/p99"),
        number("/processor_ms/median"),
        number("/differing_share") * 100.0,
        row["largest_difference"],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_counted_by_pixels_and_measured_by_channels() {
        let black = Frame::new([4, 2]);
        assert_eq!(differences(&black, &black.clone()), (0.0, 0));
        let mut other = black.clone();
        (other.bytes[5], other.bytes[6]) = (3, 1);
        assert_eq!(differences(&black, &other), (0.125, 3));
    }
}
