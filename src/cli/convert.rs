//! `rayforest convert`: another program's file becomes a scene.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, print, say};
use crate::film::write::check_writable;
use crate::import::{self, Imported, MAPPING};

/// What to convert.
#[derive(Debug, Args)]
#[command(after_help = MAPPING)]
pub(crate) struct Convert {
    /// A file that ends in .obj, .gltf, .glb or .nff.
    input: PathBuf,
    /// The scene file to write; what it needs beside itself goes into the folder NAME-parts.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl Convert {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let Convert { input, output } = &self;
        if output.extension() != Some("toml".as_ref()) {
            return Err(Failure::input("-o: the name of a scene ends in .toml"));
        }
        check_writable(output).map_err(Failure::job)?;
        let imported = import::file(input, output).map_err(Failure::input)?;
        imported.write(output).map_err(Failure::job)?;
        imported.notes.iter().for_each(|note| say(&note.to_string()));
        print(&summary(&imported, output));
        Ok(())
    }
}

fn summary(imported: &Imported, output: &Path) -> String {
    let Imported { scene, parts, notes } = imported;
    format!(
        "wrote {}: {} solids, {} materials, {} lights; {} files beside it; {} remarks",
        output.display(),
        scene.solids.len(),
        scene.materials.len(),
        scene.lights.len(),
        parts.len(),
        notes.len()
    )
}
