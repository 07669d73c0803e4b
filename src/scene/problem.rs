//! A mistake in a scene file: where it is, what is wrong, and a way out.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

/// Bytes of the source text.
pub type Span = Range<usize>;

/// What is wrong with some bytes of a text, before they are turned into line and column.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// The bytes at fault.
    pub span: Span,
    /// What is wrong, one line.
    pub message: String,
    /// A way out, one line.
    pub help: String,
}

/// A place in a text file.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Counted from 1.
    pub line: usize,
    /// Characters, counted from 1.
    pub column: usize,
    /// The whole line, without its end.
    pub text: String,
    /// Characters at fault in this line, at least 1.
    pub width: usize,
}

impl Place {
    /// Finds line and column of `span` in `source`; a span over several lines is cut at the first
    /// line's end, a span beyond the text is moved to the end of its last line.
    pub fn of(source: &str, span: &Span) -> Place {
        let floor = |at: usize| source.floor_char_boundary(at.min(source.len()));
        let mut start = floor(span.start);
        if start == source.len() {
            start = source.trim_end_matches(['\n', '\r']).len();
        }
        let line_start = source[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = source[start..].find('\n').map_or(source.len(), |at| start + at);
        let text = source[line_start..line_end].trim_end_matches('\r');
        let end = floor(span.end).clamp(start, (line_start + text.len()).max(start));
        Place {
            line: source[..line_start].matches('\n').count() + 1,
            column: source[line_start..start].chars().count() + 1,
            text: text.to_owned(),
            width: source[start..end].chars().count().max(1),
        }
    }

    /// The line that points at the fault: spaces (tabs where the text has tabs), then `^^^`.
    pub fn caret(&self) -> String {
        let blank = |c: char| if c == '\t' { '\t' } else { ' ' };
        let indent: String = self.text.chars().map(blank).take(self.column - 1).collect();
        indent + &"^".repeat(self.width)
    }
}

/// One mistake of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Where; `None` if the file as a whole cannot be read.
    pub place: Option<Place>,
    /// What is wrong, one line.
    pub message: String,
    /// A way out, one line.
    pub help: String,
}

/// Everything that is wrong with a scene file, in the order of the file; never empty.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// The scene file.
    pub file: PathBuf,
    /// At least one, at most [`MOST_PROBLEMS`].
    pub problems: Vec<Problem>,
    /// How many more there are.
    pub left_out: usize,
}

/// The largest number of problems that is reported.
pub const MOST_PROBLEMS: usize = 100;

impl SceneError {
    /// Turns mistakes into problems with line and column, sorted by place.
    pub fn new(file: PathBuf, source: &str, mut mistakes: Vec<Mistake>) -> SceneError {
        mistakes.sort_by_key(|mistake| mistake.span.start);
        let left_out = mistakes.len().saturating_sub(MOST_PROBLEMS);
        mistakes.truncate(MOST_PROBLEMS);
        let problem = |Mistake { span, message, help }| Problem {
            place: Some(Place::of(source, &span)),
            message,
            help,
        };
        SceneError { file, problems: mistakes.into_iter().map(problem).collect(), left_out }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            let Problem { place, message, help } = problem;
            let file = self.file.display();
            match place {
                Some(place) => {
                    writeln!(f, "{file}:{}:{}: {message}", place.line, place.column)?;
                    writeln!(f, "  {}", place.text)?;
                    writeln!(f, "  {}", place.caret())?;
                }
                None => writeln!(f, "{file}: {message}")?,
            }
            write!(f, "  help: {help}")?;
        }
        if self.left_out > 0 {
            write!(f, "\nand {} more", self.left_out)?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

/// The candidate that `word` was probably meant to be: at most a third of its letters differ.
pub fn nearest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (word.chars().count() / 3).max(1);
    candidates
        .map(|candidate| (strsim::osa_distance(word, candidate), candidate))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// "did you mean …", or else the whole list under its title (its start, if it is long).
pub fn suggestion<'a>(
    word: &str,
    title: &str,
    candidates: impl Iterator<Item = &'a str> + Clone,
) -> String {
    const SHOWN: usize = 20;
    if let Some(near) = nearest(word, candidates.clone()) {
        return format!("did you mean `{near}`?");
    }
    let mut list: Vec<&str> = candidates.clone().take(SHOWN).collect();
    if candidates.count() > SHOWN {
        list.push("…");
    }
    format!("{title}: {}", list.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_tabs_stay_tabs() {
        let place = Place::of("a = 1\n\tö = \"ü\" x\r\nc", &(7..11));
        assert_eq!((place.line, place.column, place.width), (2, 2, 3));
        assert_eq!(place.text, "\tö = \"ü\" x");
        let place = Place::of("a = 1\n\tö = \"ü\" x\r\nc", &(17..18));
        assert_eq!(place.caret(), "\t        ^");
    }

    #[test]
    fn a_span_at_the_end_of_the_text_points_behind_its_last_line() {
        let place = Place::of("a = [\n", &(6..6));
        assert_eq!((place.line, place.column, place.text.as_str()), (1, 6, "a = ["));
        assert_eq!(Place::of("", &(0..0)).caret(), "^");
        assert_eq!(Place::of("a\nb", &(99..120)).caret(), " ^");
    }

    #[test]
    fn a_span_over_lines_ends_with_its_first_line() {
        assert_eq!(Place::of("a = [\n1]", &(4..8)).caret(), "    ^");
    }

    #[test]
    fn suggestions() {
        let known = ["diffuse", "ambient"];
        assert_eq!(suggestion("difuse", "known", known.into_iter()), "did you mean `diffuse`?");
        assert_eq!(suggestion("size", "known", known.into_iter()), "known: diffuse, ambient");
    }
}
