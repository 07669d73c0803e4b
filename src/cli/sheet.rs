//! A contact sheet: a scene without a look and with each, side by side, from one trace where that is enough.

use std::path::Path;

use serde_json::{Value, json};

use super::watch::watched;
use super::{Failure, say};
use crate::film::sheet::{reduced, sheet};
use crate::film::write;
use crate::session::Session;

/// How much smaller than the picture its parts are, per side.
const SMALLER: u32 = 3;

/// Dresses the session's scene in every look, and writes the sheet. Gives what each cost.
pub(super) fn write(session: &mut Session, file: &Path) -> Result<Value, Failure> {
    let scene = session.scene().clone();
    let names = scene.looks.list.iter().map(|look| Some(look.name.as_str()));
    let (mut pictures, mut costs) = (Vec::new(), Vec::new());
    for name in std::iter::once(None).chain(names) {
        let dressed = scene.dressed(name).map_err(Failure::input)?;
        let edit = watched("tracing", |progress| session.edit(dressed, progress));
        let report = edit.map_err(Failure::job)?;
        let (class, rays) = (report.class.to_string(), report.rays.total());
        say(&format!(
            "{}. {}: {class}, {rays} rays",
            pictures.len() + 1,
            name.unwrap_or("no look")
        ));
        costs.push(json!({
            "look": name,
            "class": class,
            "rays": rays,
            "milliseconds": report.milliseconds,
        }));
        let said = format!("{} · {class}", name.unwrap_or("no look"));
        pictures.push((reduced(session.frame(), SMALLER), said));
    }
    write::frame(file, &sheet(&pictures)).map_err(Failure::job)?;
    Ok(Value::Array(costs))
}
