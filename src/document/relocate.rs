//! Paths of mesh and image files, which are relative to the scene's file, when that file moves.

use std::path::Path;

use crate::scene::Scene;
use crate::scene::relative::{relative, resolved};

/// Rewrites the relative mesh and image paths of a scene that moves from one folder to another, so that they
/// point to the same files; absolute ones stay. A path that cannot be written in UTF-8 stays too.
pub(super) fn relocate(scene: &mut Scene, from: &Path, to: &Path) {
    if resolved(from) == resolved(to) {
        return;
    }
    scene.each_file(&mut |file| {
        if !Path::new(file).is_absolute()
            && let Some(moved) = relative(&from.join(&*file), to)
        {
            *file = moved;
        }
    });
}
