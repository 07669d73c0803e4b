//! Sets, inserts, removes, renames and moves single things in a scene's text; every other byte stays.

use super::outline::{Header, Home, Outline, Pair, Span, Value, ValueKind};
use crate::scene::toml_text::bare_or_quoted;

/// A text being edited, with its outline.
pub(super) struct Splice {
    text: String,
    outline: Outline,
    newline: &'static str,
}

/// Bytes and what replaces them.
type Edit = (Span, String);

impl Splice {
    /// `None` if the text is not TOML as scenes use it.
    pub(super) fn new(text: String) -> Option<Splice> {
        let first = text.find('\n').unwrap_or(0);
        let newline = if text[..first].ends_with('\r') { "\r\n" } else { "\n" };
        Some(Splice { outline: Outline::of(&text)?, text, newline })
    }

    pub(super) fn into_text(self) -> String {
        self.text
    }

    /// Makes edits that do not overlap.
    fn edit(&mut self, mut edits: Vec<Edit>) -> Option<()> {
        if edits.is_empty() {
            return Some(());
        }
        edits.sort_by_key(|(span, _)| span.start);
        let mut text = String::with_capacity(self.text.len() + 64);
        let mut at = 0;
        for (span, replacement) in edits {
            text.push_str(self.text.get(at..span.start)?);
            text.push_str(&replacement);
            at = span.end;
        }
        text.push_str(self.text.get(at..)?);
        self.outline = Outline::of(&text)?;
        self.text = text;
        Some(())
    }

    /// Where the line of `at` begins.
    fn line_start(&self, at: usize) -> usize {
        self.text[..at].rfind('\n').map_or(0, |newline| newline + 1)
    }

    /// Where the line after that of `at` begins.
    fn line_end(&self, at: usize) -> usize {
        self.text[at..].find('\n').map_or(self.text.len(), |newline| at + newline + 1)
    }

    /// The lines of a pair that has lines of its own.
    fn lines(&self, pair: &Pair) -> Span {
        let Span { start, end } = pair.span();
        self.line_start(start)..self.line_end(end)
    }

    fn is_comment(&self, line: Span) -> bool {
        self.text[line].trim_start().starts_with('#')
    }

    fn is_blank(&self, line: Span) -> bool {
        self.text[line].trim().is_empty()
    }

    /// The start of the comment lines directly above the line that begins at `start`.
    fn with_comments_above(&self, mut start: usize) -> usize {
        while start > 0 {
            let above = self.line_start(start - 1);
            if !self.is_comment(above..start) {
                break;
            }
            start = above;
        }
        start
    }

    /// A header with the comments directly above it, its lines, and the comments directly below them
    /// that do not belong to the next header.
    fn block(&self, index: usize) -> Span {
        let Header { span, .. } = &self.outline.headers[index];
        let start = self.with_comments_above(self.line_start(span.start));
        let home = Home::Lines(Some(index));
        let last = self.outline.pairs.iter().rev().find(|pair| pair.home == home);
        let mut end = self.line_end(last.map_or(span.end, |pair| pair.value.span.end));
        let limit = match self.outline.headers.get(index + 1) {
            Some(next) => self.with_comments_above(self.line_start(next.span.start)),
            None => self.text.len(),
        };
        while end < limit && self.is_comment(end..self.line_end(end)) {
            end = self.line_end(end);
        }
        start..end
    }

    /// Edits of a value so that it reads as `new`, where it reads as `old` now; both canonical.
    /// Elements that stay keep their spelling, and the array its spaces and comments.
    pub(super) fn set_edits(&self, path: &[String], old: &str, new: &str) -> Option<Vec<Edit>> {
        let value = &self.outline.pair(path)?.value;
        let mut edits = Vec::new();
        self.change(value, old, new, &mut edits);
        Some(edits)
    }

    fn change(&self, value: &Value, old: &str, new: &str, edits: &mut Vec<Edit>) {
        if old == new {
            return;
        }
        let whole = (value.span.clone(), new.to_owned());
        let ValueKind::Array(written) = &value.kind else { return edits.push(whole) };
        // One loop of an outline is a list of points, several are a list of lists.
        let depth = |text: &str| text.bytes().take_while(|byte| *byte == b'[').count();
        if depth(old) != depth(new) && depth(old).max(depth(new)) > 1 {
            return edits.push(whole);
        }
        let Some((old, new)) = elements(old, written.len()).zip(elements(new, written.len()))
        else {
            return edits.push(whole);
        };
        let has_comment = self.text[value.span.clone()].contains('#');
        if old.len() != written.len() || (new.len() != old.len() && !has_comment) {
            return edits.push(whole);
        }
        for (place, (old, new)) in written.iter().zip(old.iter().zip(&new)) {
            self.change(place, old, new, edits);
        }
        let spans: Vec<Span> = written.iter().map(|place| place.span.clone()).collect();
        match spans.last() {
            Some(last) if new.len() > old.len() => {
                let more = format!(", {}", new[old.len()..].join(", "));
                match edits.last_mut().filter(|(span, _)| span.end == last.end) {
                    Some((_, text)) => text.push_str(&more),
                    None => edits.push((last.end..last.end, more)),
                }
            }
            _ => {
                for index in new.len()..spans.len() {
                    edits.extend(self.without(&spans, index));
                }
            }
        }
    }

    /// Edits that take an entry and the comma before it out of a list; comments between stay.
    fn without(&self, entries: &[Span], index: usize) -> Vec<Edit> {
        let entry = entries[index].clone();
        let nothing = |span: Span| (span, String::new());
        let before = index.checked_sub(1).map(|before| entries[before].end);
        match (before, entries.get(index + 1)) {
            (Some(before), _) if !self.text[before..entry.start].contains('#') => {
                vec![nothing(before..entry.end)]
            }
            (Some(before), _) => {
                let comma = self.comma(before).unwrap_or(before..before);
                vec![nothing(comma), nothing(entry)]
            }
            (None, Some(next)) if !self.text[entry.end..next.start].contains('#') => {
                vec![nothing(entry.start..next.start)]
            }
            (None, _) => {
                let comma = self.comma(entry.end).unwrap_or(entry.end..entry.end);
                vec![nothing(entry), nothing(comma)]
            }
        }
    }

    /// The comma that follows, with only blanks and comments between.
    fn comma(&self, from: usize) -> Option<Span> {
        let mut in_comment = false;
        for (offset, c) in self.text[from..].char_indices() {
            match c {
                '\n' => in_comment = false,
                '#' => in_comment = true,
                ',' if !in_comment => return Some(from + offset..from + offset + 1),
                c if !in_comment && !c.is_whitespace() => return None,
                _ => {}
            }
        }
        None
    }

    /// Makes edits that [`Splice::set_edits`] gave, of different values.
    pub(super) fn apply(&mut self, edits: Vec<Edit>) -> Option<()> {
        self.edit(edits)
    }

    /// Gives the thing `name` of a list another name, wherever its name is a key.
    pub(super) fn rename(&mut self, list: &str, renames: &[(String, String)]) -> Option<()> {
        let mut edits = Vec::new();
        let mut visit = |path: &[String], base: usize, keys: &[Span]| {
            if path.len() < 2 || path[0] != list || base > 1 {
                return;
            }
            if let Some((_, new)) = renames.iter().find(|(old, _)| *old == path[1]) {
                edits.push((keys[1 - base].clone(), bare_or_quoted(new)));
            }
        };
        for header in &self.outline.headers {
            visit(&header.path, 0, &header.keys);
        }
        for pair in &self.outline.pairs {
            visit(&pair.path, pair.base(), &pair.keys);
        }
        self.edit(edits)
    }

    /// Takes everything out that says something of the value or table `path`.
    pub(super) fn remove(&mut self, path: &[String]) -> Option<()> {
        loop {
            let header = self.outline.headers_of(path).next();
            let edits = match (header, self.outline.pairs_of(path).next()) {
                (Some(index), _) => vec![(self.block_with_blanks(index), String::new())],
                (None, Some(pair)) => self.without_pair(pair),
                (None, None) => return Some(()),
            };
            let before = self.text.len();
            self.edit(edits)?;
            if self.text.len() == before {
                return None;
            }
        }
    }

    /// A block and the empty lines that it leaves without a use.
    fn block_with_blanks(&self, index: usize) -> Span {
        let Span { mut start, mut end } = self.block(index);
        while end < self.text.len() && self.is_blank(end..self.line_end(end)) {
            end = self.line_end(end);
        }
        while end == self.text.len() && start > 0 {
            let above = self.line_start(start - 1);
            if !self.is_blank(above..start) {
                break;
            }
            start = above;
        }
        start..end
    }

    fn without_pair(&self, pair: &Pair) -> Vec<Edit> {
        let Home::Inline(_) = pair.home else { return vec![(self.lines(pair), String::new())] };
        let inside = |other: &&Pair| other.home == pair.home;
        let entries: Vec<Span> = self.outline.pairs.iter().filter(inside).map(Pair::span).collect();
        let index = entries.iter().position(|span| *span == pair.span());
        self.without(&entries, index.expect("a pair is among the pairs of its table"))
    }

    /// Puts another key and value in the place of the one pair that makes up `path`; whether it
    /// could.
    pub(super) fn replace(&mut self, path: &[String], key: &str, value: &str) -> Option<bool> {
        let pairs: Vec<&Pair> = self.outline.pairs_of(path).take(2).collect();
        let [pair] = pairs[..] else { return Some(false) };
        if pair.path != path || self.outline.headers_of(path).next().is_some() {
            return Some(false);
        }
        let last = pair.keys.last().expect("a pair has a key").clone();
        let edits = vec![(last, bare_or_quoted(key)), (pair.value.span.clone(), value.to_owned())];
        self.edit(edits).map(|()| true)
    }

    /// Whether something of `table` is spelled by pairs, in which another pair can stand.
    pub(super) fn takes_pairs(&self, table: &[String]) -> bool {
        self.outline.pairs.iter().any(|pair| pair.declares_in(table) || pair.path == table)
            || self.has_header(table)
    }

    /// Whether there is a header `[table]`.
    pub(super) fn has_header(&self, table: &[String]) -> bool {
        self.outline.headers.iter().any(|header| header.path == table)
    }

    /// Whether the value or table `path` is spelled, at least in part, by pairs that name it.
    pub(super) fn is_pairs(&self, path: &[String]) -> bool {
        self.outline.pairs_of(path).next().is_some()
    }

    /// Whether the text says anything of the value or table `path`.
    pub(super) fn spells(&self, path: &[String]) -> bool {
        self.is_pairs(path) || self.outline.headers_of(path).next().is_some()
    }

    /// Inserts `key = value` into a table that [takes pairs](Splice::takes_pairs): after the nearest
    /// of the keys `before` that is there, or else before the nearest of `after`.
    pub(super) fn insert_pair(
        &mut self,
        table: &[String],
        (key, value): (&str, &str),
        before: &[String],
        after: &[String],
    ) -> Option<()> {
        let depth = table.len();
        let declared = |key: &String| {
            let named = |pair: &&Pair| pair.declares_in(table) && pair.path[depth] == *key;
            let mut pairs = self.outline.pairs.iter().filter(named);
            let first = pairs.next()?;
            Some((first, pairs.next_back().unwrap_or(first)))
        };
        if let Some((_, last)) = before.iter().rev().find_map(declared) {
            let edit = self.beside(last, depth, (key, value), true);
            return self.edit(vec![edit]);
        }
        if let Some(header) = self.outline.headers.iter().find(|header| header.path == table) {
            let line = format!("{} = {value}", bare_or_quoted(key));
            let at = self.line_end(header.span.end);
            let edit = self.line_at(at, &line);
            return self.edit(vec![edit]);
        }
        if let Some((first, _)) = after.iter().find_map(declared) {
            let edit = self.beside(first, depth, (key, value), false);
            return self.edit(vec![edit]);
        }
        let Span { start, end } = self.outline.pair(table)?.value.span.clone();
        let inside = start + 1..end - 1;
        let text = format!(" {} = {value} ", bare_or_quoted(key));
        let blank = self.is_blank(inside.clone());
        self.edit(vec![(if blank { inside } else { start + 1..start + 1 }, text)])
    }

    /// The edit that puts a pair after or before another one, with the same leading keys.
    fn beside(&self, pair: &Pair, depth: usize, entry: (&str, &str), is_after: bool) -> Edit {
        let mut keys: Vec<String> =
            pair.path[pair.base()..depth].iter().map(|key| bare_or_quoted(key)).collect();
        keys.push(bare_or_quoted(entry.0));
        let line = format!("{} = {}", keys.join("."), entry.1);
        let Span { start, end } = pair.span();
        match pair.home {
            Home::Inline(_) if is_after => (end..end, format!(", {line}")),
            Home::Inline(_) => (start..start, format!("{line}, ")),
            Home::Lines(_) => {
                let lines = self.lines(pair);
                let indent = &self.text[lines.start..start];
                let at = match is_after {
                    true => lines.end,
                    false => self.with_comments_above(lines.start),
                };
                self.line_at(at, &format!("{indent}{line}"))
            }
        }
    }

    /// The edit that inserts a line at the start of a line, or at the end of the text.
    fn line_at(&self, at: usize, line: &str) -> Edit {
        let open = at > 0 && !self.text[..at].ends_with('\n');
        let newline = self.newline;
        let text = if open { format!("{newline}{line}") } else { format!("{line}{newline}") };
        (at..at, text)
    }

    /// Puts a line behind the last one below the header `[table]`.
    pub(super) fn append(&mut self, table: &[String], line: &str) -> Option<()> {
        let index = self.outline.headers.iter().position(|header| header.path == table)?;
        let home = Home::Lines(Some(index));
        let last = self.outline.pairs.iter().rev().find(|pair| pair.home == home);
        let end = last.map_or(self.outline.headers[index].span.end, |pair| pair.value.span.end);
        let edit = self.line_at(self.line_end(end), line);
        self.edit(vec![edit])
    }

    /// Inserts a block, which begins with an empty line and ends with a line's end: after the last
    /// header of the nearest of `before` that has one, or else before the first of `after`, or else
    /// at the end.
    pub(super) fn insert_block(
        &mut self,
        block: &str,
        before: &[Vec<String>],
        after: &[Vec<String>],
    ) -> Option<()> {
        let last = |path: &Vec<String>| self.outline.headers_of(path).next_back();
        let first = |path: &Vec<String>| self.outline.headers_of(path).next();
        let block = block.replace('\n', self.newline);
        let newline = self.newline;
        let edit = if let Some(index) = before.iter().rev().find_map(last) {
            let at = self.block(index).end;
            (at..at, self.closed(at) + &block)
        } else if let Some(index) = after.iter().find_map(first) {
            let at = self.block(index).start;
            let is_apart = at == 0 || self.is_blank(self.line_start(at - 1)..at);
            let block = block.strip_prefix(newline).filter(|_| is_apart).unwrap_or(&block);
            (at..at, format!("{block}{newline}"))
        } else {
            let at = self.text.len();
            (at..at, self.closed(at) + &block)
        };
        self.edit(vec![edit])
    }

    /// What ends the line before `at`.
    fn closed(&self, at: usize) -> String {
        let open = at > 0 && !self.text[..at].ends_with('\n');
        if open { self.newline.to_owned() } else { String::new() }
    }

    /// Puts the things of a list into the order of `names`, which are all of them. Each must stand
    /// in one piece.
    pub(super) fn reorder(&mut self, list: &str, names: &[String]) -> Option<()> {
        let mut places = Vec::new();
        for name in names {
            places.push(self.piece(&[list.to_owned(), name.clone()])?);
        }
        let mut slots = places.clone();
        slots.sort_by_key(|span| span.start);
        if slots.windows(2).any(|pair| pair[0].end > pair[1].start) {
            return None;
        }
        let text = |span: &Span| self.text[span.clone()].to_owned();
        let edits = slots.iter().zip(&places).map(|(slot, place)| {
            let (old, mut new) = (text(slot), text(place));
            // the last line of the text may lack its end
            if old.ends_with('\n')
                && !new.ends_with('\n')
                && places.iter().all(|p| self.is_lines(p))
            {
                new.push_str(self.newline);
            }
            (slot.clone(), new)
        });
        let edits = edits.collect();
        self.edit(edits)
    }

    fn is_lines(&self, span: &Span) -> bool {
        self.line_start(span.start) == span.start && self.line_end(span.end - 1) == span.end
    }

    /// Everything that a thing is spelled by, if it stands in one piece.
    fn piece(&self, path: &[String]) -> Option<Span> {
        let headers: Vec<usize> = self.outline.headers_of(path).collect();
        let pairs: Vec<&Pair> = self.outline.pairs_of(path).collect();
        match (headers.first(), headers.last(), pairs.first(), pairs.last()) {
            (Some(first), Some(last), None, _) if last - first + 1 == headers.len() => {
                Some(self.block(*first).start..self.block(*last).end)
            }
            (None, _, Some(first), Some(last)) => match first.home {
                Home::Lines(_) => {
                    let start = self.with_comments_above(self.lines(first).start);
                    Some(start..self.lines(last).end)
                }
                Home::Inline(_) => Some(first.span().start..last.span().end),
            },
            _ => None,
        }
    }
}

/// The elements of a canonical array; a number stands for `count` equal ones.
fn elements(canonical: &str, count: usize) -> Option<Vec<String>> {
    if !canonical.starts_with('[') {
        return Some(vec![canonical.to_owned(); count]);
    }
    let line = format!("x = {canonical}");
    let outline = Outline::of(&line)?;
    let ValueKind::Array(elements) = &outline.pairs.first()?.value.kind else { return None };
    Some(elements.iter().map(|element| line[element.span.clone()].to_owned()).collect())
}
