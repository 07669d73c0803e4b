//! Fills the fields of a scene from a TOML table, noting every mistake on the way.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::check;
use super::fields::{self, LOOK, LOOKS, Need, Visit};
use super::mesh::{self, Mesh};
use super::problem::{Mistake, Span, suggestion};
use super::read::Known;
use super::read_looks;
use super::slot::Slot;
use super::texture;
use super::toml_text::{bare_or_quoted, quoted};
use super::value::{Names, describe};
use super::write;
use super::{ImageFile, Scene};

/// The only version of the scene format.
const VERSION: &str = "1";

/// Fills `scene`, which has the names and variants of `root`; returns the mistakes in any order.
/// Mesh and image files are sought in `folder`, unless they are `known`.
pub(super) fn fill<'a>(
    scene: &mut Scene,
    root: &'a DeTable<'a>,
    folder: &'a Path,
    known: Known,
) -> Vec<Mistake> {
    let mut reader = Reader {
        scopes: vec![Scope { key: None, span: 0..0, table: Some(root), known: Vec::new() }],
        names: Names::of(scene),
        folder,
        files: known,
        mistakes: Vec::new(),
        broken: HashSet::new(),
    };
    reader.version();
    fields::scene(scene, &mut reader);
    reader.scope().known.extend([LOOK, LOOKS].map(str::to_owned));
    reader.leave();
    reader.relations(scene, root);
    // What a look sets stands on what is there without it.
    if reader.mistakes.is_empty() {
        reader.mistakes = read_looks::looks(scene, root);
    }
    reader.mistakes
}

/// A table that is being read.
struct Scope<'a> {
    /// `None` for the root.
    key: Option<String>,
    /// Where to report what is missing: the key, or the start of the text.
    span: Span,
    /// `None` if the text does not have it.
    table: Option<&'a DeTable<'a>>,
    /// Every key that may stand in it.
    known: Vec<String>,
}

/// Fills a skeleton from the text.
struct Reader<'a> {
    scopes: Vec<Scope<'a>>,
    names: Names,
    folder: &'a Path,
    files: Known,
    mistakes: Vec<Mistake>,
    /// Tables with a mistake, by one or two keys; their relations are not checked.
    broken: HashSet<Vec<String>>,
}

/// A key and its value.
type Entry<'a> = (&'a Spanned<DeString<'a>>, &'a Spanned<DeValue<'a>>);

impl<'a> Reader<'a> {
    fn report(&mut self, mistake: Mistake) {
        self.broken.insert(self.keys().take(2).cloned().collect());
        self.mistakes.push(mistake);
    }

    /// The keys that lead to the present table.
    fn keys(&self) -> impl Iterator<Item = &String> {
        self.scopes.iter().filter_map(|scope| scope.key.as_ref())
    }

    /// The present table in words.
    fn here(&self) -> String {
        let keys: Vec<String> = self.keys().map(|key| bare_or_quoted(key)).collect();
        if keys.is_empty() { "the scene".to_owned() } else { format!("`{}`", keys.join(".")) }
    }

    fn scope(&mut self) -> &mut Scope<'a> {
        self.scopes.last_mut().expect("the root scope stays until the end")
    }

    /// Finds a key of the present table; reports it if it must be there and is not.
    fn find(
        &mut self,
        key: &str,
        need: Need,
        example: &mut dyn FnMut() -> String,
    ) -> Option<Entry<'a>> {
        let rivals: &[&str] = match need {
            Need::OneOf(keys) | Need::EitherOf(keys) => keys,
            Need::Optional | Need::Required => &[],
        };
        let scope = self.scope();
        if rivals.is_empty() {
            scope.known.push(key.to_owned());
        }
        scope.known.extend(rivals.iter().map(|rival| (*rival).to_owned()));
        let (table, span) = (scope.table?, scope.span.clone());
        if let Some(rival) =
            rivals.iter().find(|rival| **rival != key && table.contains_key(**rival))
            && let (Some((first, _)), Some((second, _))) =
                (table.get_key_value(key), table.get_key_value(*rival))
        {
            let later = if first.span().start > second.span().start { first } else { second };
            self.report(Mistake {
                span: later.span(),
                message: format!("`{key}` and `{rival}` exclude each other"),
                help: "keep one of the two".to_owned(),
            });
        }
        let found = table.get_key_value(key);
        if found.is_none() && need.must_be_written() {
            let list: Vec<String> = rivals.iter().map(|key| format!("`{key}`")).collect();
            let message = match need {
                Need::OneOf(keys) if keys.len() > 1 => {
                    format!("{} needs one of {}", self.here(), list.join(", "))
                }
                _ => format!("{} needs the key `{key}`", self.here()),
            };
            self.report(Mistake { span, message, help: format!("add `{key} = {}`", example()) });
        }
        found
    }

    fn version(&mut self) {
        let Some((_, value)) = self.find("version", Need::Required, &mut || VERSION.to_owned())
        else {
            return;
        };
        let right = value.get_ref().as_integer().is_some_and(|v| v.to_string() == VERSION);
        if !right {
            self.report(Mistake {
                span: value.span(),
                message: format!(
                    "this program reads version {VERSION} of the scene format, found {}",
                    describe(value.get_ref())
                ),
                help: format!("write `version = {VERSION}`, or use a newer program"),
            });
        }
    }

    /// Ends the present table: whatever was not asked for is unknown.
    fn leave(&mut self) {
        let here = self.here();
        let scope = self.scope();
        let known = std::mem::take(&mut scope.known);
        let table = scope.table;
        let set: HashSet<&str> = known.iter().map(String::as_str).collect();
        for (key, _) in table.into_iter().flat_map(DeTable::iter) {
            let name: &str = key.get_ref();
            if !set.contains(name) {
                self.report(Mistake {
                    span: key.span(),
                    message: format!("unknown key `{name}` in {here}"),
                    help: suggestion(name, "known keys", known.iter().map(String::as_str)),
                });
            }
        }
    }

    fn mesh(&mut self, value: &Spanned<DeValue<'_>>, name: &mut String, mesh: &mut Arc<Mesh>) {
        if !self.file_name(value, name, "mesh.obj") {
            return;
        }
        if let Some(known) = self.files.meshes.get(name) {
            *mesh = Arc::clone(known);
            return;
        }
        match mesh::read_obj(&self.folder.join(name.as_str())) {
            Ok(read) => {
                *mesh = Arc::new(read);
                self.files.meshes.insert(name.clone(), Arc::clone(mesh));
            }
            Err(error) => self.report(Mistake {
                span: value.span(),
                message: format!("the mesh {} cannot be used: {}", quoted(name), error.what()),
                help: error.way_out,
            }),
        }
    }

    fn image(&mut self, value: &Spanned<DeValue<'_>>, file: &mut ImageFile) {
        if !self.file_name(value, &mut file.file, "image.png") {
            return;
        }
        if let Some(known) = self.files.images.get(&file.file) {
            file.image = Arc::clone(known);
            return;
        }
        match texture::read(&self.folder.join(&file.file)) {
            Ok(read) => {
                file.image = Arc::new(read);
                self.files.images.insert(file.file.clone(), Arc::clone(&file.image));
            }
            Err(error) => self.report(Mistake {
                span: value.span(),
                message: format!(
                    "the image {} cannot be used: {}",
                    quoted(&file.file),
                    error.what()
                ),
                help: error.way_out,
            }),
        }
    }

    /// Reads the name of a file; whether it is one.
    fn file_name(
        &mut self,
        value: &Spanned<DeValue<'_>>,
        name: &mut String,
        example: &str,
    ) -> bool {
        let DeValue::String(text) = value.get_ref() else {
            self.report(Mistake {
                span: value.span(),
                message: format!(
                    "`file` must be the name of a file, found {}",
                    describe(value.get_ref())
                ),
                help: format!("for example `file = \"{example}\"`"),
            });
            return false;
        };
        *name = text.to_string();
        true
    }

    /// Reports what makes no sense, in tables without other mistakes.
    fn relations(&mut self, scene: &Scene, root: &'a DeTable<'a>) {
        for check::Flaw { path, message, help } in check::relations(scene) {
            let parents = path.len() - 1;
            if !self.broken.contains(&path[..parents.min(2)]) {
                self.mistakes.push(Mistake { span: place(root, &path), message, help });
            }
        }
    }
}

/// Where the value at `path` stands, or the innermost table on the way to it.
fn place(root: &DeTable<'_>, path: &[String]) -> Span {
    let mut span = 0..0;
    let mut table = Some(root);
    for (index, key) in path.iter().enumerate() {
        let Some((name, value)) = table.and_then(|table| table.get_key_value(key.as_str())) else {
            break;
        };
        let last = index + 1 == path.len() && !value.get_ref().is_table();
        span = if last { value.span() } else { name.span() };
        table = value.get_ref().as_table();
    }
    span
}

impl Visit for Reader<'_> {
    fn leaf(&mut self, key: &'static str, need: Need, slot: Slot<'_>) {
        let names = std::mem::take(&mut self.names);
        let found = self.find(key, need, &mut || slot.text(&names));
        let assigned = match (found, slot) {
            (None, _) => Ok(()),
            (Some((_, value)), Slot::Mesh { file, mesh }) => {
                self.mesh(value, file, mesh);
                Ok(())
            }
            (Some((_, value)), Slot::Image(file)) => {
                self.image(value, file);
                Ok(())
            }
            (Some((_, value)), mut slot) => slot.assign(key, value, &names),
        };
        self.names = names;
        if let Err(mistake) = assigned {
            self.report(mistake);
        }
    }

    fn group(&mut self, key: &str, need: Need, body: &mut dyn FnMut(&mut dyn Visit)) {
        let names = std::mem::take(&mut self.names);
        let found = self.find(key, need, &mut || format!("{{ {} }}", write::inline(&names, body)));
        self.names = names;
        let mut table = None;
        let mut span = self.scope().span.clone();
        if let Some((name, value)) = found {
            span = name.span();
            table = value.get_ref().as_table();
            if table.is_none() {
                self.report(Mistake {
                    span: value.span(),
                    message: format!(
                        "`{key}` must be a table, found {}",
                        describe(value.get_ref())
                    ),
                    help: table_help(&self.keys().cloned().collect::<Vec<_>>(), key),
                });
            }
        }
        self.scopes.push(Scope { key: Some(key.to_owned()), span, table, known: Vec::new() });
        body(self);
        self.leave();
        self.scopes.pop();
    }
}

/// How to write the table `key` below `parents`.
fn table_help(parents: &[String], key: &str) -> String {
    let key = bare_or_quoted(key);
    match parents {
        [] if fields::LISTS.contains(&key.as_str()) => format!("write `[{key}.NAME]`"),
        [] => format!("write `[{key}]`"),
        [list] => format!("write `[{list}.{key}]`"),
        _ => format!("write `{key} = {{ … }}`"),
    }
}
