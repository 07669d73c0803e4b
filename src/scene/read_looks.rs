//! Reads the looks of a scene's text: `[looks.NAME]` with lines of the form `path = value`.

use std::collections::{HashMap, HashSet};

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::fields::{LOOK, LOOKS};
use super::look::{Look, Setting};
use super::path::{parameters, walk_among};
use super::problem::{Mistake, Span, suggestion};
use super::toml_text::bare_or_quoted;
use super::value::{Names, describe};
use super::{Scene, check};

/// Reads the looks into a scene that has all its values, and puts on the one that the text names. The
/// scene has no look if there is a mistake.
pub(super) fn looks(scene: &mut Scene, root: &DeTable<'_>) -> Vec<Mistake> {
    let mut mistakes = Vec::new();
    let mut list = Vec::new();
    if let Some(value) = root.get(LOOKS) {
        match value.get_ref().as_table() {
            None => mistakes.push(no_table(LOOKS, value)),
            Some(table) => {
                for (name, value) in table {
                    match value.get_ref().as_table() {
                        None => mistakes.push(no_table(name.get_ref(), value)),
                        Some(table) => list.push(look(scene, name, table, &mut mistakes)),
                    }
                }
            }
        }
    }
    if mistakes.is_empty() {
        scene.looks.list = list;
        mistakes.extend(root.get(LOOK).and_then(|value| put_on(scene, value)));
    }
    mistakes
}

fn no_table(key: &str, value: &Spanned<DeValue<'_>>) -> Mistake {
    Mistake {
        span: value.span(),
        message: format!("`{key}` must be a table, found {}", describe(value.get_ref())),
        help: "write `[looks.NAME]`, and below it lines such as `lights.key.on = false`".to_owned(),
    }
}

/// A line of a look.
struct Line<'a> {
    /// Of its last key.
    key: Span,
    value: &'a Spanned<DeValue<'a>>,
}

/// The lines of a table and of those in it, by their paths.
fn lines<'a>(table: &'a DeTable<'a>, prefix: &str, all: &mut HashMap<String, Line<'a>>) {
    for (key, value) in table {
        let path = format!("{prefix}{}", bare_or_quoted(key.get_ref()));
        match value.get_ref().as_table() {
            Some(inner) => lines(inner, &format!("{path}."), all),
            None => drop(all.insert(path, Line { key: key.span(), value })),
        }
    }
}

/// One look; what is wrong with it is noted.
fn look(
    scene: &Scene,
    name: &Spanned<DeString<'_>>,
    table: &DeTable<'_>,
    mistakes: &mut Vec<Mistake>,
) -> Look {
    let mut all = HashMap::new();
    lines(table, "", &mut all);
    let names = Names::of(scene);
    let wanted: HashSet<&str> = all.keys().map(String::as_str).collect();
    let (mut settings, mut seen) = (Vec::new(), HashSet::new());
    let mut dressed = scene.clone();
    let found = mistakes.len();
    walk_among(&mut dressed, &wanted, &mut |path, key, mut slot| {
        seen.insert(path.to_owned());
        match slot.assign(key, all[path].value, &names) {
            Ok(()) => {
                settings.push(Setting { path: path.to_owned(), value: slot.text(&names) });
            }
            Err(mistake) => mistakes.push(mistake),
        }
    });
    for (path, line) in all.iter().filter(|(path, _)| !seen.contains(*path)) {
        let known = parameters(scene);
        mistakes.push(Mistake {
            span: line.key.clone(),
            message: format!("there is no parameter `{path}`"),
            help: suggestion(path, "parameters", known.iter().map(|p| p.path.as_str())),
        });
    }
    let name_text = name.get_ref().to_string();
    if mistakes.len() == found {
        let before = check::relations(scene);
        let flaws = check::relations(&dressed).into_iter().filter(|flaw| !before.contains(flaw));
        mistakes.extend(flaws.map(|flaw| Mistake {
            span: name.span(),
            message: format!("the look `{name_text}` makes no sense: {}", flaw.message),
            help: flaw.help,
        }));
    }
    Look { name: name_text, settings }
}

/// Puts on the look that `value` names; what is wrong with it.
fn put_on(scene: &mut Scene, value: &Spanned<DeValue<'_>>) -> Option<Mistake> {
    let mistake = |message: String, help: &str| {
        Some(Mistake { span: value.span(), message, help: help.to_owned() })
    };
    let Some(name) = value.get_ref().as_str() else {
        let found = describe(value.get_ref());
        let message = format!("`{LOOK}` must be the name of a look, found {found}");
        return mistake(message, "for example `look = \"night\"`");
    };
    match scene.dressed(Some(name)) {
        Ok(dressed) => {
            *scene = dressed;
            None
        }
        Err(error) => {
            let (message, help) = error.split_once("\n  help: ").unwrap_or((&error, ""));
            mistake(message.to_owned(), help)
        }
    }
}
