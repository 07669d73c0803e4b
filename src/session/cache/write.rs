//! Writes a cache: parts are packed on all threads and follow each other into the file.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;

use super::codec::Section;
use super::file::{self, Header, Numbers, Part};
use super::parts;
use super::{CacheError, CacheReport, Fault, program};
use crate::film::write::{WriteSeek, atomically};
use crate::progress::{Cancelled, Progress};
use crate::scene;
use crate::session::Session;

/// Parts per thread that are packed before they are written: what is held beside the session.
const PARTS_AT_ONCE: usize = 8;

/// Writes what a session has traced; `trees` asks for its trees too. What was at `path` before is
/// there until the new file is whole.
pub fn write(
    session: &Session,
    path: &Path,
    trees: bool,
    progress: &Progress,
) -> Result<CacheReport, CacheError> {
    let start = Instant::now();
    let mut writer = Writer::new(session, trees, progress);
    let mut cancelled = false;
    let written = atomically(path, |out| {
        writer.all(out).map_err(|stop| match stop {
            Stop::Cancelled => {
                cancelled = true;
                String::new()
            }
            Stop::Io(error) => error.to_string(),
        })
    });
    match written {
        Ok(()) => Ok(CacheReport { seconds: start.elapsed().as_secs_f64(), ..writer.report }),
        Err(_) if cancelled => Err(Fault::from(Cancelled).of(path)),
        Err(error) => Err(Fault::Io { cause: error.to_string() }.of(path)),
    }
}

/// Why the file did not become whole.
enum Stop {
    Cancelled,
    Io(std::io::Error),
}

impl From<Cancelled> for Stop {
    fn from(_: Cancelled) -> Stop {
        Stop::Cancelled
    }
}

impl From<std::io::Error> for Stop {
    fn from(error: std::io::Error) -> Stop {
        Stop::Io(error)
    }
}

struct Writer<'a> {
    session: &'a Session,
    trees: bool,
    progress: &'a Progress,
    numbers: Numbers,
    header: Header,
    report: CacheReport,
}

impl<'a> Writer<'a> {
    fn new(session: &'a Session, trees: bool, progress: &'a Progress) -> Writer<'a> {
        let numbers = Numbers { tiles: session.transport.tiles.len() };
        progress.begin(numbers.count() as u64);
        let header = Header {
            program: program(),
            meshes: file::hashes(&session.scene),
            trace: session.trace,
            parts: vec![Part::default(); numbers.count()],
        };
        Writer { session, trees, progress, numbers, header, report: CacheReport::default() }
    }

    /// The header is as long when its table is filled, so its place is kept free until then.
    fn all(&mut self, out: &mut dyn WriteSeek) -> Result<(), Stop> {
        out.write_all(&self.header.bytes())?;
        let at_once = PARTS_AT_ONCE * self.session.pool.current_num_threads();
        for first in (0..self.numbers.count()).step_by(at_once) {
            self.progress.check()?;
            let some = first..self.numbers.count().min(first + at_once);
            let packed: Vec<Option<(Vec<u8>, Part)>> = self.session.pool.install(|| {
                let sections = some.clone().into_par_iter();
                sections.map_init(Section::default, |section, n| self.pack(n, section)).collect()
            });
            for (number, packed) in some.zip(packed) {
                if let Some((bytes, part)) = packed {
                    out.write_all(&bytes)?;
                    self.count(number, &part);
                    self.header.parts[number] = part;
                }
                self.progress.step();
            }
        }
        self.report.file_bytes = out.stream_position()?;
        out.rewind()?;
        out.write_all(&self.header.bytes())?;
        Ok(())
    }

    fn count(&mut self, number: usize, part: &Part) {
        self.report.plain_bytes += part.plain;
        self.report.trees += usize::from(number >= self.numbers.trees(0));
        let lists = self.numbers.lists(0)..self.numbers.trees(0);
        self.report.lists += usize::from(lists.contains(&number));
    }

    /// The part of this number, if there is one.
    fn pack(&self, number: usize, section: &mut Section) -> Option<(Vec<u8>, Part)> {
        section.clear();
        let Session { transport, forest, scene, .. } = self.session;
        let tiles = self.numbers.tiles;
        match number {
            Numbers::SCENE => section.array(scene::write::text(scene).as_bytes()),
            Numbers::TERMS => {
                let (keys, lights) = (self.session.keys.clone(), self.session.names.lights.clone());
                let state = parts::State { keys, lights, iors: self.session.iors.clone() };
                parts::put_terms(&transport.trie, &state, section);
            }
            n if n < self.numbers.lists(0) => {
                parts::put_matrix(&transport.tiles[n - self.numbers.matrix(0)], section);
            }
            n if n < self.numbers.trees(0) => {
                let lists = transport.tiles[n - self.numbers.lists(0)].highlights.as_ref();
                parts::put_highlights(lists?, section);
            }
            n if self.trees && tiles > 0 => {
                let trees = forest.tiles[n - self.numbers.trees(0)].as_ref();
                parts::put_trees(trees?, section);
            }
            _ => return None,
        }
        Some(file::pack(section))
    }
}
