//! The thread that writes picture files, and traces those of another size than the view's.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};

use super::shader::Message;
use super::tracer::Compiled;
use super::{Export, guarded, pool};
use crate::film::develop::Development;
use crate::film::plates::Plates;
use crate::film::write::{Format, check_writable, picture};
use crate::forest::Forest;
use crate::geometry::Geometry;
use crate::progress::Progress;
use crate::scene::{Scene, write};
use crate::session::layers::Extras;
use crate::session::trace::{Kept, TraceError};
use crate::session::{Options, Session, Start};

/// A picture file to make.
pub(super) enum Task {
    /// Of light that is there.
    Write { path: PathBuf, format: Format, plates: Plates, scene: Arc<Scene> },
    /// Of a scene that has the size of the file.
    Render {
        path: PathBuf,
        format: Format,
        extras: Extras,
        scene: Arc<Scene>,
        known: Option<Compiled>,
        progress: Arc<Progress>,
    },
}

impl Task {
    /// The scene at the size of an export.
    pub(super) fn resized(scene: &Scene, export: &Export) -> Arc<Scene> {
        let mut resized = scene.clone();
        resized.picture.size = export.size;
        Arc::new(resized)
    }
}

/// How a task ended: the file, `None` after a cancel, or what went wrong.
pub(super) type Outcome = Result<Option<PathBuf>, String>;

/// Works until nobody sends tasks any more. Tasks end in the order in which they came.
pub(super) fn run(options: Options, tasks: Receiver<Task>, results: Sender<Message>) {
    for task in tasks {
        let outcome = guarded(|| export(options, task)).unwrap_or_else(Err);
        // Nobody receives once the shader has ended.
        let _ = results.send(Message::Exported(outcome));
    }
}

fn export(options: Options, task: Task) -> Outcome {
    let (path, format, plates, scene) = match task {
        Task::Write { path, format, plates, scene } => (path, format, plates, scene),
        Task::Render { path, format, extras, scene, known, progress } => {
            check_writable(&path).map_err(|e| e.to_string())?;
            match session(options, &scene, known, &progress) {
                Ok(session) => {
                    let plates = session.plates(extras);
                    let wrong = |e| format!("{} was not written: {e}", path.display());
                    (path.clone(), format, plates.map_err(wrong)?, scene)
                }
                Err(TraceError::Cancelled) => return Ok(None),
                Err(error) => return Err(format!("{} was not written: {error}", path.display())),
            }
        }
    };
    let text = write::text(&scene);
    picture(&path, format, &plates, Development::of(&scene.picture), &text)
        .map_err(|e| e.to_string())?;
    Ok(Some(path))
}

/// A scene, traced with threads of its own; no trees are kept.
fn session(
    options: Options,
    scene: &Arc<Scene>,
    known: Option<Compiled>,
    progress: &Progress,
) -> Result<Session, TraceError> {
    let known = known.and_then(|compiled| compiled.of(scene));
    let geometry = match known {
        Some(geometry) => geometry,
        None => Arc::new(Geometry::build(scene, progress)?),
    };
    let (scene, pool, reuse) = (scene.clone(), pool(options), Forest::default());
    let start = Start { scene, geometry, pool, options, kept: Kept::Matrix, reuse };
    Session::begin(start, progress)
}
