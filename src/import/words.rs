//! The words of a text with their places, for formats that are lists of words and numbers.

use std::path::Path;

use super::place::{At, ImportError, Place};

/// A word of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'a> {
    pub(super) text: &'a str,
    /// Counted from 1.
    pub(super) line: usize,
    /// Characters, counted from 1.
    pub(super) column: usize,
}

impl<'a> Word<'a> {
    /// The words of one line, up to a `#`.
    pub(super) fn all(line_text: &'a str, line: usize) -> Vec<Word<'a>> {
        let code = line_text.split('#').next().unwrap_or_default();
        let mut words = Vec::new();
        let (mut counted, mut column) = (0, 1);
        for text in code.split_whitespace() {
            let offset = text.as_ptr() as usize - code.as_ptr() as usize;
            column += code[counted..offset].chars().count();
            counted = offset;
            words.push(Word { text, line, column });
        }
        words
    }

    /// Where it stands.
    pub(super) fn at(&self) -> At {
        At::Column(self.line, self.column)
    }

    /// A finite number.
    pub(super) fn number(&self, file: &Path) -> Result<f64, ImportError> {
        let place = Place::new(file, self.at());
        match self.text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            Ok(_) => {
                let cause = format!("`{}` is not a finite number", self.text);
                Err(ImportError::new(place, cause, "write numbers such as 0.5 or -1e-3"))
            }
            Err(_) => {
                let cause = format!("`{}` is not a number", self.text);
                Err(ImportError::new(place, cause, "write numbers such as 0.5 or -1e-3"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_comments_are_no_words() {
        let words = Word::all("\té  2.5 # x", 7);
        let found: Vec<_> = words.iter().map(|w| (w.text, w.line, w.column)).collect();
        assert_eq!(found, [("é", 7, 2), ("2.5", 7, 5)]);
        assert_eq!(words[1].number(Path::new("a")), Ok(2.5));
        let error = words[0].number(Path::new("a")).unwrap_err();
        assert_eq!(error.place.to_string(), "a:7:2");
    }
}
