//! Where every table, key and value of a scene's text stands, to the byte.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

use toml_parser::Source;
use toml_parser::parser::{Event, EventKind, parse_document};

/// Bytes of the text.
pub(super) type Span = Range<usize>;

/// The headers and the pairs of a TOML text, in its order; the pairs inside of an inline table
/// follow the pair that holds the table.
#[derive(Debug, Default)]
pub(super) struct Outline {
    pub(super) headers: Vec<Header>,
    pub(super) pairs: Vec<Pair>,
    /// Index of the pair with a path.
    by_path: HashMap<Vec<String>, usize>,
}

/// `[a.b]`.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) path: Vec<String>,
    /// One span a key.
    pub(super) keys: Vec<Span>,
    /// From `[` to `]`.
    pub(super) span: Span,
}

/// `c.d = value`, on a line of its own or in an inline table.
#[derive(Debug)]
pub(super) struct Pair {
    /// From the root: the keys of the header or of the tables around it, then its own.
    pub(super) path: Vec<String>,
    /// Its own keys, one span each.
    pub(super) keys: Vec<Span>,
    pub(super) value: Value,
    pub(super) home: Home,
}

/// What a pair stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// Its own lines below the header with this index, or above all headers.
    Lines(Option<usize>),
    /// The inline table of the pair with this index.
    Inline(usize),
}

/// A value and what it is made of.
#[derive(Debug)]
pub(super) struct Value {
    pub(super) span: Span,
    pub(super) kind: ValueKind,
}

/// Kinds of values.
#[derive(Debug)]
pub(super) enum ValueKind {
    Scalar,
    /// The elements.
    Array(Vec<Value>),
    /// The inside is among the pairs of the outline.
    Table,
}

impl Pair {
    /// How many keys of its path are not its own.
    pub(super) fn base(&self) -> usize {
        self.path.len() - self.keys.len()
    }

    /// From its first key to the end of its value.
    pub(super) fn span(&self) -> Span {
        self.keys[0].start..self.value.span.end
    }

    /// Whether it names, with a key of its own, something directly in `table`.
    pub(super) fn declares_in(&self, table: &[String]) -> bool {
        self.path.starts_with(table) && (self.base()..self.path.len()).contains(&table.len())
    }
}

impl Outline {
    /// The outline of a text; `None` if it is not TOML as scenes use it (no arrays of tables).
    pub(super) fn of(text: &str) -> Option<Outline> {
        let tokens = Source::new(text).lex().into_vec();
        let mut events: Vec<Event> = Vec::with_capacity(tokens.len());
        let mut errors = None;
        parse_document(&tokens, &mut events, &mut errors);
        let blank = [EventKind::Whitespace, EventKind::Comment, EventKind::Newline];
        events.retain(|event| !blank.contains(&event.kind()));
        events.reverse();
        let mut scan = Scan { text, events, outline: Outline::default() };
        scan.document()?;
        errors.is_none().then_some(scan.outline)
    }

    /// The pair whose path is `path`.
    pub(super) fn pair(&self, path: &[String]) -> Option<&Pair> {
        self.by_path.get(path).map(|index| &self.pairs[*index])
    }

    /// Headers of the table `path` and of what is in it, by index.
    pub(super) fn headers_of(&self, path: &[String]) -> impl DoubleEndedIterator<Item = usize> {
        let inside = |header: &Header| header.path.starts_with(path);
        (0..self.headers.len()).filter(move |index| inside(&self.headers[*index]))
    }

    /// Pairs that say, with a key of their own, something of the value or table `path`.
    pub(super) fn pairs_of(&self, path: &[String]) -> impl DoubleEndedIterator<Item = &Pair> {
        let (_, table) = path.split_last().expect("the root is no value");
        self.pairs.iter().filter(move |pair| pair.path.starts_with(path) && pair.declares_in(table))
    }
}

/// Reads events, the next one last.
struct Scan<'a> {
    text: &'a str,
    events: Vec<Event>,
    outline: Outline,
}

impl Scan<'_> {
    fn document(&mut self) -> Option<()> {
        let mut table = Vec::new();
        while let Some(event) = self.events.last() {
            match event.kind() {
                EventKind::StdTableOpen => {
                    let start = event.span().start();
                    self.events.pop();
                    let (path, keys, end) = self.keys(EventKind::StdTableClose)?;
                    table.clone_from(&path);
                    self.outline.headers.push(Header { path, keys, span: start..end });
                }
                EventKind::SimpleKey => {
                    let header = self.outline.headers.len().checked_sub(1);
                    self.pair(&table, Home::Lines(header))?;
                }
                _ => return None,
            }
        }
        Some(())
    }

    /// Keys joined by dots, up to an event of this kind, with its end.
    fn keys(&mut self, last: EventKind) -> Option<(Vec<String>, Vec<Span>, usize)> {
        let (mut names, mut spans) = (Vec::new(), Vec::new());
        loop {
            let event = self.events.pop()?;
            let span = event.span();
            match event.kind() {
                EventKind::SimpleKey => {
                    let raw = Source::new(self.text).get(event)?;
                    let mut name = Cow::Borrowed("");
                    raw.decode_key(&mut name, &mut ());
                    names.push(name.into_owned());
                    spans.push(span.start()..span.end());
                }
                EventKind::KeySep => {}
                kind if kind == last && !names.is_empty() => {
                    return Some((names, spans, span.end()));
                }
                _ => return None,
            }
        }
    }

    fn pair(&mut self, table: &[String], home: Home) -> Option<()> {
        let (own, keys, end) = self.keys(EventKind::KeyValSep)?;
        let path = [table, &own].concat();
        let index = self.outline.pairs.len();
        let value = Value { span: end..end, kind: ValueKind::Scalar };
        self.outline.by_path.insert(path.clone(), index);
        self.outline.pairs.push(Pair { path: path.clone(), keys, value, home });
        self.outline.pairs[index].value = self.value(&path, index)?;
        Some(())
    }

    /// The value of the pair with this path and index.
    fn value(&mut self, path: &[String], index: usize) -> Option<Value> {
        let event = self.events.pop()?;
        let start = event.span().start();
        let (end, kind) = match event.kind() {
            EventKind::Scalar => (event.span().end(), ValueKind::Scalar),
            EventKind::ArrayOpen => {
                let mut elements = Vec::new();
                while self.inside(EventKind::ArrayClose)? {
                    elements.push(self.value(path, index)?);
                }
                (self.events.pop()?.span().end(), ValueKind::Array(elements))
            }
            EventKind::InlineTableOpen => {
                while self.inside(EventKind::InlineTableClose)? {
                    self.pair(path, Home::Inline(index))?;
                }
                (self.events.pop()?.span().end(), ValueKind::Table)
            }
            _ => return None,
        };
        Some(Value { span: start..end, kind })
    }

    /// Skips a comma; whether something stands before the closing bracket.
    fn inside(&mut self, close: EventKind) -> Option<bool> {
        if self.events.last()?.kind() == EventKind::ValueSep {
            self.events.pop();
        }
        Some(self.events.last()?.kind() != close)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_and_value_is_found() {
        let text = "version = 1 # one\r\n[\"a.b\" . 'c']\nd.e = { f = [1, [ 2.5, -3e2 ],], \"ü\" = 'x' }\n";
        let outline = Outline::of(text).unwrap();
        assert_eq!(outline.headers[0].path, ["a.b", "c"]);
        assert_eq!(&text[outline.headers[0].span.clone()], "[\"a.b\" . 'c']");
        let paths: Vec<String> = outline.pairs.iter().map(|pair| pair.path.join("/")).collect();
        assert_eq!(paths, ["version", "a.b/c/d/e", "a.b/c/d/e/f", "a.b/c/d/e/ü"]);
        assert_eq!(outline.pairs[2].home, Home::Inline(1));
        assert_eq!(&text[outline.pairs[2].span()], "f = [1, [ 2.5, -3e2 ],]");
        let ValueKind::Array(elements) = &outline.pairs[2].value.kind else { panic!() };
        assert_eq!(&text[elements[1].span.clone()], "[ 2.5, -3e2 ]");
        assert!(Outline::of("[[a]]").is_none() && Outline::of("a = [").is_none());
    }
}
