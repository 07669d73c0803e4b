//! Writes edited looks into the text of a scene: lines that stay keep their spelling and comments.

use super::patch::{children, find};
use super::splice::Splice;
use crate::scene::fields::LOOKS;
use crate::scene::path::segments;
use crate::scene::toml_text::bare_or_quoted;
use crate::scene::write::Node;

/// Changes the looks `old` of a text, each with a value per path, to `new`.
pub(super) fn looks(splice: &mut Splice, old: &[Node], new: &[Node]) -> Option<()> {
    for (index, look) in old.iter().enumerate() {
        if find(new, &look.key, index).is_none() {
            splice.remove(&[LOOKS.to_owned(), look.key.clone()])?;
        }
    }
    for (index, look) in new.iter().enumerate() {
        match find(old, &look.key, index) {
            Some(before) if before == look => {}
            Some(before) => change(splice, before, look)?,
            None => insert(splice, look)?,
        }
    }
    Some(())
}

fn change(splice: &mut Splice, old: &Node, new: &Node) -> Option<()> {
    let table = vec![LOOKS.to_owned(), new.key.clone()];
    let whole = |path: &str| Some([table.clone(), segments(path)?].concat());
    if !splice.has_header(&table) {
        splice.remove(&table)?;
        return insert(splice, new);
    }
    for (index, node) in children(old).iter().enumerate() {
        if find(children(new), &node.key, index).is_none() {
            splice.remove(&whole(&node.key)?)?;
        }
    }
    for (index, node) in children(new).iter().enumerate() {
        match find(children(old), &node.key, index) {
            Some(before) if before == node => {}
            Some(before) => {
                let path = whole(&node.key)?;
                let edits = splice.set_edits(&path, &before.inline(), &node.inline())?;
                splice.apply(edits)?;
            }
            None => splice.append(&table, &format!("{} = {}", node.key, node.inline()))?,
        }
    }
    Some(())
}

/// Inserts a look behind the others, or at the end.
fn insert(splice: &mut Splice, look: &Node) -> Option<()> {
    let mut block = format!("\n[{LOOKS}.{}]\n", bare_or_quoted(&look.key));
    for node in children(look) {
        block.push_str(&format!("{} = {}\n", node.key, node.inline()));
    }
    splice.insert_block(&block, &[vec![LOOKS.to_owned()]], &[])
}
