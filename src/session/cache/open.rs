//! Opens a scene with what a cache kept of it: the difference costs what an edit costs.

use std::path::Path;
use std::sync::Arc;

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::parts::State;
use super::{CacheError, CacheReport, Cached, Fault, read};
use crate::fold::Names;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::canvas::Canvas;
use crate::session::trace::TraceError;
use crate::session::{EditReport, Options, Session};
use crate::shade::cpu::Tiles;
use crate::shade::terms::{TermProgram, TermValues};

/// How a scene was opened from a cache.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenedCache {
    /// What was read.
    pub cache: CacheReport,
    /// What the difference between the cached scene and the opened one cost.
    pub edit: EditReport,
}

impl Session {
    /// Opens a scene with the cache at `path`. On an error that is not [`Fault::Stopped`] the scene
    /// can be opened without it, by [`Session::open`].
    pub fn open_cached(
        scene: impl Into<Arc<Scene>>,
        path: &Path,
        options: Options,
        progress: &Progress,
    ) -> Result<(Session, OpenedCache), CacheError> {
        assert!(options.threads > 0, "a session needs a thread");
        let scene = scene.into();
        let stopped = |error: TraceError| Fault::from(error).of(path);
        let pool = ThreadPoolBuilder::new().num_threads(options.threads).build();
        let pool = pool.map_err(|_| stopped(TraceError::Threads { threads: options.threads }))?;
        let pool = Arc::new(pool);
        let (mut session, cache) = Session::recall(&scene, path, pool, options, progress)?;
        let edit = session.edit(scene, progress).map_err(stopped)?;
        Ok((session, OpenedCache { cache, edit }))
    }

    /// The session that the cache at `path` holds, for a scene that is to be opened: the difference
    /// between the two scenes is one edit.
    pub fn recall(
        opened: &Scene,
        path: &Path,
        pool: Arc<ThreadPool>,
        options: Options,
        progress: &Progress,
    ) -> Result<(Session, CacheReport), CacheError> {
        let cached = read(path, opened, &pool, options.memory, progress)?;
        let report = cached.report;
        Ok((Session::from_cached(cached, options, pool), report))
    }

    /// The session of the cached scene, its picture drawn.
    pub(super) fn from_cached(cached: Cached, options: Options, pool: Arc<ThreadPool>) -> Session {
        let Cached {
            scene,
            geometry,
            geometry_seconds,
            forest,
            map,
            transport,
            state,
            trace,
            report: _,
        } = cached;
        let State { keys, keys_in_trees, lights, iors, lobes, counts: _ } = state;
        let mut session = Session {
            canvas: Canvas::new(scene.picture.size),
            scene: Arc::new(scene),
            options,
            pool,
            forest,
            map,
            program: TermProgram::new(&transport.trie),
            transport,
            terms: TermValues::default(),
            before: Vec::new(),
            keys,
            keys_in_trees,
            names: Names { materials: geometry.materials().to_vec(), lights },
            iors,
            lobes,
            trace,
            geometry_seconds,
            geometry: Arc::new(geometry),
        };
        session.evaluate_terms();
        session.draw(Tiles::All);
        session
    }
}
