//! Writes a cache: parts are packed on all threads and follow each other into the file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::codec::Section;
use super::file::{self, Header, Numbers, Part};
use super::parts::{self, State};
use super::{CacheError, CacheReport, Fault, program};
use crate::film::write::{Unfinished, WriteError};
use crate::progress::Progress;
use crate::scene::{self, Scene};
use crate::session::Session;

/// Parts per thread that are packed before they are written: what is held beside the session.
const PARTS_AT_ONCE: usize = 8;

/// Writes what a session has traced; `trees` asks for its trees too. What was at `path` before is
/// there until the new file is whole; a file that is no cache stays.
pub fn write(
    session: &Session,
    path: &Path,
    trees: bool,
    progress: &Progress,
) -> Result<CacheReport, CacheError> {
    let mut writing = Writing::begin(session, path, trees)?;
    progress.begin(writing.parts());
    let at_once = PARTS_AT_ONCE * session.pool.current_num_threads();
    while !writing.is_complete() {
        progress.check().map_err(|cancelled| Fault::from(cancelled).of(path))?;
        for _ in 0..writing.go_on(session, at_once)? {
            progress.step();
        }
    }
    writing.finish()
}

/// A cache file that is written part by part, as long as the session stays what it is. Dropped
/// before it is finished, it leaves what was there before.
pub struct Writing {
    path: PathBuf,
    file: Unfinished,
    trees: bool,
    /// Of the session, to know it again.
    scene: Arc<Scene>,
    numbers: Numbers,
    /// Number of the next part.
    next: usize,
    header: Header,
    report: CacheReport,
    start: Instant,
}

impl Writing {
    /// Begins a file; `trees` asks for the session's trees too.
    pub fn begin(session: &Session, path: &Path, trees: bool) -> Result<Writing, CacheError> {
        let begin = || -> Result<Writing, Fault> {
            if file::is_foreign(path)? {
                return Err(Fault::Foreign);
            }
            let numbers = Numbers { tiles: session.transport.tiles.len() };
            let header = Header {
                program: program(),
                meshes: file::hashes(&session.scene),
                trace: session.trace,
                parts: vec![Part::default(); numbers.count()],
            };
            let mut file = Unfinished::begin(path)?;
            // As long as it will be when its table is filled: its place is kept free until then.
            file.out().write_all(&header.bytes())?;
            Ok(Writing {
                path: path.into(),
                file,
                trees,
                scene: session.scene.clone(),
                numbers,
                next: 0,
                header,
                report: CacheReport::default(),
                start: Instant::now(),
            })
        };
        begin().map_err(|fault| fault.of(path))
    }

    /// Whether it is a session's, as that is now.
    pub fn is_of(&self, session: &Session) -> bool {
        Arc::ptr_eq(&self.scene, &session.scene)
    }

    /// How many parts there are.
    pub fn parts(&self) -> u64 {
        self.numbers.count() as u64
    }

    /// Whether all parts are written.
    pub fn is_complete(&self) -> bool {
        self.next == self.numbers.count()
    }

    /// Writes at most so many more parts; gives how many.
    ///
    /// # Panics
    /// If the session was edited since the file was begun.
    pub fn go_on(&mut self, session: &Session, most: usize) -> Result<usize, CacheError> {
        assert!(self.is_of(session), "the session of the beginning");
        let some = self.next..self.numbers.count().min(self.next + most);
        let packed: Vec<Option<(Vec<u8>, Part)>> = session.pool.install(|| {
            let sections = some.clone().into_par_iter();
            sections
                .map_init(Section::default, |section, n| self.pack(session, n, section))
                .collect()
        });
        self.next = some.end;
        let count = some.len();
        for (number, packed) in some.zip(packed) {
            let Some((bytes, part)) = packed else { continue };
            let written = self.file.out().write_all(&bytes);
            written.map_err(|error| Fault::from(error).of(&self.path))?;
            self.count(number, &part);
            self.header.parts[number] = part;
        }
        Ok(count)
    }

    /// Puts the file in its place.
    ///
    /// # Panics
    /// If parts are missing.
    pub fn finish(self) -> Result<CacheReport, CacheError> {
        assert!(self.is_complete(), "every part is written");
        let Writing { path, mut file, header, mut report, start, .. } = self;
        let finish = || -> Result<CacheReport, Fault> {
            report.file_bytes = file.out().stream_position()?;
            file.out().rewind()?;
            file.out().write_all(&header.bytes())?;
            file.finish()?;
            Ok(CacheReport { seconds: start.elapsed().as_secs_f64(), ..report })
        };
        finish().map_err(|fault| fault.of(&path))
    }

    fn count(&mut self, number: usize, part: &Part) {
        self.report.plain_bytes += part.plain;
        self.report.trees += usize::from(number >= self.numbers.trees(0));
        let lists = self.numbers.lists(0)..self.numbers.trees(0);
        self.report.lists += usize::from(lists.contains(&number));
    }

    /// The part of this number, if there is one.
    fn pack(
        &self,
        session: &Session,
        number: usize,
        section: &mut Section,
    ) -> Option<(Vec<u8>, Part)> {
        section.clear();
        let Session { transport, forest, scene, .. } = session;
        let tiles = self.numbers.tiles;
        match number {
            Numbers::SCENE => section.array(scene::write::text(scene).as_bytes()),
            Numbers::TERMS => {
                parts::put_terms(&transport.trie, &State::of(session), section);
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

impl From<WriteError> for Fault {
    fn from(error: WriteError) -> Fault {
        let WriteError { path: _, cause } = error;
        Fault::Io { cause }
    }
}
