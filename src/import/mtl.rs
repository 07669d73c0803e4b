//! MTL files of Wavefront OBJ: every statement of a material, with its place.

use std::path::Path;

use super::place::{At, ImportError, Place};
use super::words::Word;

/// A material as its file describes it.
#[derive(Debug)]
pub(super) struct Description<'a> {
    /// What `newmtl` calls it.
    pub(super) name: String,
    /// The line of its `newmtl`, counted from 1.
    pub(super) line: usize,
    /// In the order of the file.
    pub(super) statements: Vec<Statement<'a>>,
}

/// A line of a material.
#[derive(Debug)]
pub(super) struct Statement<'a> {
    /// In lower case: programs do not agree about it.
    pub(super) key: String,
    /// As it is written.
    pub(super) written: &'a str,
    pub(super) line: usize,
    pub(super) arguments: Vec<Word<'a>>,
}

/// Reads a file; statements before the first `newmtl` are an error.
pub(super) fn read<'a>(text: &'a str, file: &Path) -> Result<Vec<Description<'a>>, ImportError> {
    let mut all: Vec<Description<'a>> = Vec::new();
    for (index, line_text) in text.lines().enumerate() {
        let line = index + 1;
        let words = Word::all(line_text, line);
        let Some((first, arguments)) = words.split_first() else { continue };
        if first.text.eq_ignore_ascii_case("newmtl") {
            let name = rest(line_text, first);
            all.push(Description { name, line, statements: Vec::new() });
            continue;
        }
        let Some(last) = all.last_mut() else {
            let cause = format!("`{}` stands before the first `newmtl`", first.text);
            let place = Place::new(file, At::Line(line));
            return Err(ImportError::new(place, cause, "export the materials again"));
        };
        last.statements.push(Statement {
            key: first.text.to_lowercase(),
            written: first.text,
            line,
            arguments: arguments.to_vec(),
        });
    }
    Ok(all)
}

/// What stands behind the first word of a line: names may hold spaces.
pub(super) fn rest(line: &str, first: &Word<'_>) -> String {
    let code = line.split('#').next().unwrap_or_default().trim_start();
    code.get(first.text.len()..).unwrap_or_default().trim().to_owned()
}

/// A texture: its options, and the file.
#[derive(Debug, Default)]
pub(super) struct Texture {
    /// Of `-s`: how often the image is repeated in u and v.
    pub(super) repeats: [f64; 2],
    /// Of `-bm`.
    pub(super) height: f64,
    /// Options that a scene cannot hold.
    pub(super) strange: Vec<String>,
    /// As written; empty if there is none.
    pub(super) file: String,
}

/// Reads the arguments of `map_Kd`, `bump` and the like.
pub(super) fn texture(arguments: &[Word<'_>], file: &Path) -> Result<Texture, ImportError> {
    let mut texture = Texture { repeats: [1.0; 2], height: 1.0, ..Texture::default() };
    let mut words = arguments;
    while let Some((first, rest)) = words.split_first() {
        let option = first.text.to_lowercase();
        let most = match option.as_str() {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-texres" | "-bm" | "-imfchan" | "-type"
            | "-boost" => 1,
            _ => break,
        };
        let numeric = most != 1 || option == "-bm";
        let own = |word: &&Word<'_>| !numeric || word.text.parse::<f64>().is_ok();
        // A file may be called `1.png`, but the last word is always the file.
        let room = rest.len().saturating_sub(1).min(most);
        let count = rest[..room].iter().take_while(own).count();
        let (values, after) = rest.split_at(count);
        words = after;
        match (option.as_str(), values) {
            ("-s", [u, more @ ..]) => {
                let u = u.number(file)?;
                let v = more.first().map_or(Ok(1.0), |v| v.number(file))?;
                texture.repeats = [u, v];
            }
            ("-bm", [height]) => texture.height = height.number(file)?,
            _ => texture.strange.push(option),
        }
    }
    let names: Vec<&str> = words.iter().map(|word| word.text).collect();
    texture.file = names.join(" ");
    Ok(texture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_keep_their_places() {
        let text = "# made\nnewmtl my glass \r\nKd 1 0 0 # red\n\tNI 1.5\nnewmtl b\n";
        let all = read(text, Path::new("a.mtl")).unwrap();
        assert_eq!((all[0].name.as_str(), all[0].line, all.len()), ("my glass", 2, 2));
        let keys: Vec<_> = all[0].statements.iter().map(|s| (s.key.as_str(), s.line)).collect();
        assert_eq!(keys, [("kd", 3), ("ni", 4)]);
        let error = read("\nKd 1 1 1", Path::new("a.mtl")).unwrap_err();
        assert_eq!(error.place.to_string(), "a.mtl:2");
    }

    #[test]
    fn options_stand_before_the_file() {
        let read = |line: &str| texture(&Word::all(line, 1), Path::new("a.mtl")).unwrap();
        let found = read("-s 2 2 1 -clamp on -bm 0.5 my wood.png");
        assert_eq!((found.repeats, found.height), ([2.0, 2.0], 0.5));
        assert_eq!(
            (found.strange, found.file.as_str()),
            (vec!["-clamp".to_owned()], "my wood.png")
        );
        assert_eq!(read("-s 2 1.png").file, "1.png");
        assert_eq!(read("-o 1 2 3 4").file, "4");
        assert_eq!(read("").file, "");
    }
}
