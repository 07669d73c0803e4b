//! The scene that a picture file holds.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::meta::MetaData;

use super::hdr;
use super::write::{Format, SCENE_KEY};

/// The text of the scene in a picture that this program wrote. The error says what is wrong, and a way
/// out.
pub fn scene_text(path: &Path) -> Result<String, String> {
    let shown = path.display();
    let read = match Format::of(path, false) {
        Ok(Format::Exr) => of_exr(path),
        Ok(Format::Hdr) => hdr::scene(path),
        Ok(_) => of_png(path),
        Err(error) => Err(error.cause),
    };
    match read {
        Ok(Some(text)) => Ok(text),
        Ok(None) => Err(format!(
            "{shown} holds no scene\n  help: pictures hold one that this program exported, and that \
             nothing else has written since"
        )),
        Err(cause) => {
            Err(format!("{shown} cannot be read as a picture: {cause}\n  help: open a scene"))
        }
    }
}

fn of_png(path: &Path) -> Result<Option<String>, String> {
    let file = BufReader::new(File::open(path).map_err(|error| error.to_string())?);
    let reader = png::Decoder::new(file).read_info().map_err(|error| error.to_string())?;
    let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == SCENE_KEY);
    let text = chunk.map(|chunk| chunk.get_text().map_err(|error| error.to_string()));
    Ok(text.transpose()?.filter(|text| !text.is_empty()))
}

fn of_exr(path: &Path) -> Result<Option<String>, String> {
    let meta = MetaData::read_from_file(path, false).map_err(|error| error.to_string())?;
    let comments = meta.headers.first().and_then(|header| header.own_attributes.comments.as_ref());
    let bytes = comments.map(|text| text.bytes().to_vec()).unwrap_or_default();
    Ok(String::from_utf8(bytes).ok().filter(|text| !text.is_empty()))
}

/// Whether a file is named as a picture, which may hold a scene.
pub fn is_picture(path: &Path) -> bool {
    Format::of(path, false).is_ok()
}
