//! Temporary.
use super::*;
use rayforest::progress::Progress;
use rayforest::session::{Options, Session};
#[test]
fn timing() {
    for name in ["whitted"] {
        let scene = shipped(name, [960, 540], 16);
        let options = Options { threads: 2, memory: 4 << 30 };
        let t = std::time::Instant::now();
        let mut session = Session::open(scene, options, &Progress::default()).unwrap();
        eprintln!(
            "{name} trace {:.2} s fold {:.2}",
            t.elapsed().as_secs_f64(),
            session.trace_report().fold_seconds
        );
        let bytes = session.transport().highlight_bytes();
        let tiles = &session.transport().tiles;
        let lists: usize = tiles.iter().flat_map(|t| &t.highlights).map(|h| h.lists.len()).sum();
        let full: usize = tiles
            .iter()
            .flat_map(|t| &t.highlights)
            .flat_map(|h| &h.lists)
            .filter(|l| l.full > 0)
            .count();
        let fulls: usize = tiles
            .iter()
            .flat_map(|t| &t.highlights)
            .flat_map(|h| &h.lists)
            .map(|l| usize::from(l.full) * 16)
            .sum();
        let singles: usize = tiles
            .iter()
            .flat_map(|t| &t.highlights)
            .flat_map(|h| &h.lists)
            .filter(|l| l.at >> 31 != 0)
            .count();
        let lanes: usize = tiles.iter().flat_map(|t| &t.highlights).map(|h| h.counts.len()).sum();
        let samples: usize =
            tiles.iter().flat_map(|t| &t.highlights).map(|h| h.logarithms.len()).sum();
        eprintln!(
            "bytes {:.1} MB lists {lists} full {full} (samples {fulls}) singles {singles} lanes {lanes} samples {samples}",
            bytes as f64 / 1e6
        );
        let mut all = Vec::new();
        for i in 0..30 {
            let mut edited = session.scene().clone();
            for m in &mut edited.materials {
                m.shininess = 20.0 + i as f32;
            }
            let t = std::time::Instant::now();
            let report = session.edit(edited, &Progress::default()).unwrap();
            all.push(t.elapsed().as_secs_f64() * 1e3);
            assert_eq!(report.rays.total(), 0);
        }
        all.sort_by(f64::total_cmp);
        eprintln!("refold all: min {:.1} median {:.1} p90 {:.1} ms", all[0], all[15], all[27]);
        let mut draws = Vec::new();
        for _ in 0..30 {
            let t = std::time::Instant::now();
            session.redraw();
            draws.push(t.elapsed().as_secs_f64() * 1e3);
        }
        draws.sort_by(f64::total_cmp);
        eprintln!("redraw: min {:.1} median {:.1}", draws[0], draws[15]);
        let names: Vec<_> =
            session.scene().materials.iter().map(|m| m.name.clone()).take(4).collect();
        for (m, name) in names.iter().enumerate() {
            let mut times = Vec::new();
            for i in 0..15 {
                let mut edited = session.scene().clone();
                edited.materials[m].shininess = 20.5 + i as f32;
                let t = std::time::Instant::now();
                session.edit(edited, &Progress::default()).unwrap();
                times.push(t.elapsed().as_secs_f64() * 1e3);
            }
            times.sort_by(f64::total_cmp);
            eprintln!("  {name}: min {:.1} median {:.1}", times[0], times[7]);
        }
    }
}
