//! Writes an edited scene into the text it came from: only what differs is touched.

use std::collections::HashSet;
use std::path::Path;

use super::patch_looks::looks;
use super::splice::Splice;
use crate::scene::Scene;
use crate::scene::fields::{LISTS, LOOKS, Need};
use crate::scene::read::{Known, text_with};
use crate::scene::toml_text::bare_or_quoted;
use crate::scene::value::Names;
use crate::scene::write::{self, Content, Defaults, Node, tree};

/// A scene's text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patched {
    pub(super) text: String,
    /// Whether it had to be written anew, without comments.
    pub(super) comments_lost: bool,
}

/// The byte order mark.
const MARK: char = '\u{feff}';

/// The text of `new`, made from `text`, which reads as `old`. What differs is changed in place;
/// comments, order and spelling of the rest stay. It is read again to make sure.
pub(super) fn patch(text: &str, old: &Scene, new: &Scene) -> Patched {
    let body = text.strip_prefix(MARK).unwrap_or(text);
    let mark = &text[..text.len() - body.len()];
    let wanted = tree(new);
    match changed(body, old, new, &wanted).filter(|body| reads_as(body, new, &wanted)) {
        Some(body) => Patched { text: format!("{mark}{body}"), comments_lost: false },
        None => Patched { text: write::text(new), comments_lost: true },
    }
}

/// Whether a text reads as the scene with this tree, mesh and image files taken as they are.
fn reads_as(text: &str, scene: &Scene, wanted: &[Node]) -> bool {
    let read = text_with(text, Path::new(""), Known::of(scene));
    read.is_ok_and(|read| tree(&read) == wanted)
}

fn changed(text: &str, old: &Scene, new: &Scene, wanted: &[Node]) -> Option<String> {
    let mut present = tree(old);
    if present == wanted {
        return Some(text.to_owned());
    }
    let old_looks = take_looks(&mut present);
    let mut wanted = wanted.to_vec();
    let new_looks = take_looks(&mut wanted);
    let wanted = wanted.as_slice();
    let names = Names::of(new);
    let mut patch =
        Patch { splice: Splice::new(text.to_owned())?, defaults: Defaults::new(&names) };
    for (list, renames) in renames(old, new) {
        patch.splice.rename(list, &renames)?;
        for item in items_mut(&mut present, list) {
            if let Some((_, new)) = renames.iter().find(|(old, _)| *old == item.key) {
                item.key.clone_from(new);
            }
        }
    }
    let mut edits = Vec::new();
    patch.values(&mut Vec::new(), &present, wanted, &mut edits)?;
    patch.splice.apply(edits)?;
    for list in LISTS {
        patch.order(list, items(&present, list), items(wanted, list))?;
    }
    patch.structure(&mut vec![], &present, wanted)?;
    looks(&mut patch.splice, &old_looks, &new_looks)?;
    Some(patch.splice.into_text())
}

/// The looks of a tree, which are told apart from everything else: their values stand under paths.
fn take_looks(nodes: &mut Vec<Node>) -> Vec<Node> {
    match nodes.pop_if(|node| node.key == LOOKS) {
        Some(Node { content: Content::Table(looks), .. }) => looks,
        _ => Vec::new(),
    }
}

/// The named things of a list.
fn items<'a>(nodes: &'a [Node], list: &str) -> &'a [Node] {
    nodes.iter().find(|node| node.key == list).map_or(&[], children)
}

fn items_mut<'a>(nodes: &'a mut [Node], list: &str) -> &'a mut [Node] {
    match nodes.iter_mut().find(|node| node.key == list) {
        Some(Node { content: Content::Table(items), .. }) => items,
        _ => &mut [],
    }
}

pub(super) fn children(node: &Node) -> &[Node] {
    match &node.content {
        Content::Table(children) => children,
        Content::Value(_) => &[],
    }
}

/// The node with a key, which is looked for at the index `hint` first: lists are long, and mostly
/// as they were.
pub(super) fn find<'a>(nodes: &'a [Node], key: &str, hint: usize) -> Option<&'a Node> {
    let near = nodes.get(hint).filter(|node| node.key == key);
    near.or_else(|| nodes.iter().find(|node| node.key == key))
}

fn keys(nodes: &[Node]) -> Vec<String> {
    nodes.iter().map(|node| node.key.clone()).collect()
}

/// Things that have another name and are otherwise in their place, by list: old and new name.
fn renames(old: &Scene, new: &Scene) -> Vec<(&'static str, Vec<(String, String)>)> {
    let [lights, materials, solids] = LISTS;
    let names = |scene: &Scene| {
        (
            scene.lights.iter().map(|light| light.name.clone()).collect::<Vec<_>>(),
            scene.materials.iter().map(|material| material.name.clone()).collect::<Vec<_>>(),
            scene.solids.iter().map(|solid| solid.name.clone()).collect::<Vec<_>>(),
        )
    };
    let (old, new) = (names(old), names(new));
    vec![
        (lights, renamed(&old.0, &new.0)),
        (materials, renamed(&old.1, &new.1)),
        (solids, renamed(&old.2, &new.2)),
    ]
}

/// Names that stand alone between the same neighbours, or in the same place of a list as long.
pub(super) fn renamed(old: &[String], new: &[String]) -> Vec<(String, String)> {
    let olds: HashSet<&String> = old.iter().collect();
    let news: HashSet<&String> = new.iter().collect();
    let mut gone: Vec<(usize, &String)> =
        old.iter().enumerate().filter(|(_, name)| !news.contains(name)).collect();
    let fresh: Vec<(usize, &String)> =
        new.iter().enumerate().filter(|(_, name)| !olds.contains(name)).collect();
    // one thing removed and another added elsewhere is no renaming
    gone.retain(|(place, _)| fresh.iter().any(|(other, _)| other == place));
    let pair = |(place, name): &(usize, &String)| {
        let (_, other) = fresh.iter().find(|(other, _)| other == place)?;
        Some(((*name).clone(), (*other).clone()))
    };
    if old.len() == new.len() { gone.iter().filter_map(pair).collect() } else { Vec::new() }
}

struct Patch {
    splice: Splice,
    defaults: Defaults,
}

impl Patch {
    /// Collects the edits of all values that are spelled in the text and differ.
    fn values(
        &self,
        path: &mut Vec<String>,
        present: &[Node],
        wanted: &[Node],
        edits: &mut Vec<(std::ops::Range<usize>, String)>,
    ) -> Option<()> {
        for (index, node) in wanted.iter().enumerate() {
            let Some(old) = find(present, &node.key, index) else { continue };
            if old == node {
                continue;
            }
            path.push(node.key.clone());
            match (&old.content, &node.content) {
                (Content::Value(old), Content::Value(new)) => {
                    edits.extend(self.splice.set_edits(path, old, new).unwrap_or_default());
                }
                (Content::Table(old), Content::Table(new)) => {
                    self.values(path, old, new, edits)?;
                }
                _ => return None,
            }
            path.pop();
        }
        Some(())
    }

    /// Puts the things of a list that stay into their new order.
    fn order(&mut self, list: &str, present: &[Node], wanted: &[Node]) -> Option<()> {
        let kept = |from: &[Node], others: &[Node]| -> Vec<String> {
            let others: HashSet<&String> = others.iter().map(|node| &node.key).collect();
            keys(from).into_iter().filter(|key| others.contains(key)).collect()
        };
        let (now, then) = (kept(present, wanted), kept(wanted, present));
        if now == then {
            return Some(());
        }
        // a thing that goes keeps its place until then
        let stays: HashSet<&String> = then.iter().collect();
        let mut next = then.iter();
        let mut names = Vec::new();
        for Node { key, .. } in present {
            names.push(if stays.contains(key) { next.next()?.clone() } else { key.clone() });
        }
        self.splice.reorder(list, &names)
    }

    /// Inserts what is not spelled yet and removes what is gone.
    fn structure(
        &mut self,
        path: &mut Vec<String>,
        present: &[Node],
        wanted: &[Node],
    ) -> Option<()> {
        let goes = |(index, node): &(usize, &Node)| find(wanted, &node.key, *index).is_none();
        let mut gone: Vec<&Node> =
            present.iter().enumerate().filter(goes).map(|(_, node)| node).collect();
        for (index, node) in wanted.iter().enumerate() {
            let old = find(present, &node.key, index);
            if old == Some(node) {
                continue;
            }
            let place = || Place {
                path: path.clone(),
                before: keys(&wanted[..index]),
                after: keys(&wanted[index + 1..]),
            };
            match (old, &node.content) {
                // A table within a thing that is not spelled stands in one line.
                (Some(_), Content::Table(_))
                    if path.len() == 2 && !self.splice.spells(&place().of(&node.key)) =>
                {
                    self.insert(&place(), node)?;
                }
                (Some(old), Content::Table(new)) => {
                    path.push(node.key.clone());
                    self.structure(path, children(old), new)?;
                    path.pop();
                }
                (Some(_), Content::Value(_)) => self.value(&place(), node)?,
                (None, _) if is_list(path) => self.thing(&place(), node, present)?,
                (None, _) => {
                    let rival = gone.iter().position(|old| are_rivals(old, node));
                    let rival = rival.map(|index| gone.remove(index));
                    self.variant(&place(), node, rival)?;
                }
            }
        }
        for node in gone {
            path.push(node.key.clone());
            self.splice.remove(path)?;
            path.pop();
        }
        Some(())
    }

    /// Inserts a value that was left out because it was the default.
    fn value(&mut self, place: &Place, node: &Node) -> Option<()> {
        if self.splice.is_pairs(&place.of(&node.key)) {
            return Some(());
        }
        self.insert(place, node)
    }

    /// Inserts a value or a table of another kind, and removes the one in its place.
    fn variant(&mut self, place: &Place, node: &Node, rival: Option<&Node>) -> Option<()> {
        let table: Vec<&str> = place.path.iter().map(String::as_str).collect();
        let rival = rival.map(|rival| place.of(&rival.key));
        // in the place of what was spelled out, a default is spelled out too: it may be all there is
        let is_spelled = rival.as_ref().is_some_and(|rival| self.splice.spells(rival));
        let is_asked_for = is_spelled || self.defaults.asks_for(&table, node);
        if let Some(rival) = &rival
            && is_asked_for
            && self.splice.replace(rival, &node.key, &node.inline())?
        {
            return Some(());
        }
        if is_asked_for {
            self.insert(place, node)?;
        }
        rival.map_or(Some(()), |rival| self.splice.remove(&rival))
    }

    fn insert(&mut self, place: &Place, node: &Node) -> Option<()> {
        let Place { path, before, after } = place;
        if self.splice.takes_pairs(path) {
            let mut before = before.clone();
            before.insert(0, "version".to_owned());
            return self.splice.insert_pair(path, (&node.key, &node.inline()), &before, after);
        }
        let header: Vec<String> = path.iter().map(|key| bare_or_quoted(key)).collect();
        let block = format!("\n[{}]\n{} = {}\n", header.join("."), node.key, node.inline());
        let (groups, lists) = (["camera", "picture", "trace", "background"], LISTS);
        let alone = |key: &&str| vec![(*key).to_owned()];
        match path.len() {
            1 => {
                let before: Vec<Vec<String>> = groups.iter().map(alone).collect();
                let after: Vec<Vec<String>> = lists.iter().map(alone).collect();
                self.splice.insert_block(&block, &before, &after)
            }
            _ => self.splice.insert_block(&block, &[], std::slice::from_ref(path)),
        }
    }

    /// Inserts a light, a material or a solid, spelled like its neighbours.
    fn thing(&mut self, place: &Place, node: &Node, present: &[Node]) -> Option<()> {
        let Place { path, before, after } = place;
        let mut after = after.clone();
        after.extend(keys(present));
        let spelled = |key: &&String| self.splice.spells(&place.of(key));
        let neighbour = before.last().or_else(|| after.iter().find(spelled));
        let neighbour = neighbour.map(|key| place.of(key));
        let is_pair = match &neighbour {
            Some(neighbour) => self.splice.is_pairs(neighbour),
            None => self.splice.takes_pairs(path) && !self.splice.has_header(path),
        };
        let table = [path[0].as_str(), node.key.as_str()];
        if is_pair {
            let asked = |child: &&Node| self.defaults.asks_for(&table, child);
            let inside: Vec<String> = children(node)
                .iter()
                .filter(asked)
                .map(|child| format!("{} = {}", child.key, child.inline()))
                .collect();
            let value = match inside.is_empty() {
                true => "{}".to_owned(),
                false => format!("{{ {} }}", inside.join(", ")),
            };
            return self.splice.insert_pair(path, (&node.key, &value), before, &after);
        }
        let mut block = String::new();
        write::table(&table, node, &self.defaults, &mut block);
        let paths = |keys: &[String]| keys.iter().map(|key| place.of(key)).collect::<Vec<_>>();
        if !before.is_empty() || !after.is_empty() {
            return self.splice.insert_block(&block, &paths(before), &paths(&after));
        }
        let own = LISTS.iter().position(|list| *list == path[0])?;
        let lists: Vec<Vec<String>> = LISTS.iter().map(|list| vec![(*list).to_owned()]).collect();
        self.splice.insert_block(&block, &lists[..=own], &lists[own + 1..])
    }
}

/// Where something is inserted.
struct Place {
    /// The table.
    path: Vec<String>,
    /// Keys of the table that come before it.
    before: Vec<String>,
    /// Keys of the table that come after it.
    after: Vec<String>,
}

impl Place {
    fn of(&self, key: &str) -> Vec<String> {
        let mut path = self.path.clone();
        path.push(key.to_owned());
        path
    }
}

fn is_list(path: &[String]) -> bool {
    path.len() == 1 && LISTS.contains(&path[0].as_str())
}

/// Whether two keys exclude each other.
fn are_rivals(old: &Node, new: &Node) -> bool {
    match (old.need, new.need) {
        (Need::OneOf(a), Need::OneOf(b)) | (Need::EitherOf(a), Need::EitherOf(b)) => a == b,
        _ => false,
    }
}
