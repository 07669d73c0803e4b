//! `--cache`: opens a scene with what is kept beside it, and keeps what had to be traced.

use std::path::Path;

use serde_json::{Value, json};

use super::watch::watched;
use super::{Failure, say};
use crate::scene::Scene;
use crate::session::cache::{self, CacheError, CacheReport, Fault, OpenedCache};
use crate::session::{Class, EditReport, Options, Session};

/// A session, and what became of its cache.
pub(crate) struct OpenedScene {
    pub(crate) session: Session,
    /// How it was opened, if the cache fitted.
    pub(crate) opened: Option<OpenedCache>,
    /// For the statistics.
    pub(crate) stats: Value,
}

/// Opens a scene with the cache beside its file. Where that does not fit, or the difference asked
/// for rays, the cache is written anew; a failure to do so is told, and the picture is made all the
/// same.
pub(crate) fn open(
    file: &Path,
    scene: Scene,
    options: Options,
    trees: bool,
) -> Result<OpenedScene, Failure> {
    let path = cache::path_of(file);
    let cached = watched("opening", |progress| {
        Session::open_cached(scene.clone(), &path, options, progress)
    });
    match cached {
        Ok((session, opened)) => {
            let OpenedCache { cache, edit } = &opened;
            let EditReport { class, rays, .. } = edit;
            let mut line = format!("{}: read in {:.2} s", path.display(), cache.seconds);
            line += &format!(", {class}, {} rays", rays.total());
            let written = (*class >= Class::Regrow).then(|| keep(&session, &path, trees));
            tell(line, written.as_ref());
            let stats = json!({
                "read": figures(cache),
                "class": class.to_string(),
                "rays": rays.total(),
                "written": written.and_then(Result::ok).as_ref().map(figures),
            });
            Ok(OpenedScene { session, opened: Some(opened), stats })
        }
        Err(CacheError { fault: Fault::Stopped(error), .. }) => Err(Failure::job(error)),
        Err(error) => {
            let opened = watched("tracing", |progress| Session::open(scene, options, progress));
            let session = opened.map_err(Failure::job)?;
            // A file that is not ours is not ours to replace.
            let foreign = error.fault == Fault::Foreign;
            let written = (!foreign).then(|| keep(&session, &path, trees));
            let reason = error.cause();
            tell(format!("{}: not used: {reason}", path.display()), written.as_ref());
            let stats = json!({
                "reason": reason,
                "written": written.and_then(Result::ok).as_ref().map(figures),
            });
            Ok(OpenedScene { session, opened: None, stats })
        }
    }
}

fn keep(session: &Session, path: &Path, trees: bool) -> Result<CacheReport, CacheError> {
    watched("keeping", |progress| cache::write(session, path, trees, progress))
}

/// One line on what was read, and what was written if anything was.
fn tell(line: String, written: Option<&Result<CacheReport, CacheError>>) {
    let end = match written {
        None => String::new(),
        Some(Ok(report)) => {
            let megabytes = report.file_bytes as f64 / 1e6;
            format!("; kept {megabytes:.1} MB in {:.2} s", report.seconds)
        }
        Some(Err(error)) => format!("; not kept: {}", error.cause()),
    };
    say(&format!("{line}{end}"));
}

fn figures(report: &CacheReport) -> Value {
    let CacheReport { file_bytes, plain_bytes, lists, trees, seconds } = *report;
    json!({
        "file_bytes": file_bytes,
        "plain_bytes": plain_bytes,
        "tiles_with_highlights": lists,
        "tiles_with_trees": trees,
        "seconds": seconds,
    })
}
