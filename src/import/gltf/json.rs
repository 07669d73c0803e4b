//! Values of a glTF document with their places, so that every fault names its key.

use std::path::Path;

use serde_json::{Map, Value};

use crate::import::place::{At, ImportError, Place};

/// A value of the document.
#[derive(Clone)]
pub(super) struct Json<'a> {
    value: &'a Value,
    file: &'a Path,
    /// The keys that lead to it, as `materials[3].name`; empty of the document.
    key: String,
}

impl<'a> Json<'a> {
    pub(super) fn root(value: &'a Value, file: &'a Path) -> Json<'a> {
        Json { value, file, key: String::new() }
    }

    /// Where it stands.
    pub(super) fn at(&self) -> At {
        if self.key.is_empty() { At::File } else { At::Key(self.key.clone()) }
    }

    pub(super) fn error(&self, cause: impl Into<String>) -> ImportError {
        let place = Place::new(self.file, self.at());
        ImportError::new(place, cause, "export the file again; it breaks the rules of glTF 2.0")
    }

    /// What stands behind a key of an object; `None` if nothing does.
    pub(super) fn get(&self, key: &str) -> Option<Json<'a>> {
        let value = self.value.as_object()?.get(key)?;
        let dot = if self.key.is_empty() { "" } else { "." };
        Some(Json { value, file: self.file, key: format!("{}{dot}{key}", self.key) })
    }

    /// The same, which must be there.
    pub(super) fn need(&self, key: &str) -> Result<Json<'a>, ImportError> {
        self.get(key).ok_or_else(|| self.error(format!("`{key}` is missing")))
    }

    /// The keys of an object.
    pub(super) fn keys(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.value.as_object().into_iter().flat_map(Map::keys).map(String::as_str)
    }

    /// The elements of an array.
    pub(super) fn items(&self) -> Result<Vec<Json<'a>>, ImportError> {
        let list = self.value.as_array().ok_or_else(|| self.error("this is no array"))?;
        let item = |(i, value)| Json { value, file: self.file, key: format!("{}[{i}]", self.key) };
        Ok(list.iter().enumerate().map(item).collect())
    }

    /// The elements behind a key; none if it is not there.
    pub(super) fn list(&self, key: &str) -> Result<Vec<Json<'a>>, ImportError> {
        self.get(key).map_or(Ok(Vec::new()), |list| list.items())
    }

    /// The element that this index names of the list `list` of the document, or of another part of it.
    pub(super) fn follow(&self, root: &Json<'a>, list: &str) -> Result<Json<'a>, ImportError> {
        let index = self.whole()?;
        let all =
            root.get(list).and_then(|all| all.value.as_array()).map_or(&[][..], Vec::as_slice);
        let value =
            usize::try_from(index).ok().and_then(|index| all.get(index)).ok_or_else(|| {
                self.error(format!("there is no {list}[{index}]; the file has {}", all.len()))
            })?;
        let dot = if root.key.is_empty() { "" } else { "." };
        Ok(Json { value, file: self.file, key: format!("{}{dot}{list}[{index}]", root.key) })
    }

    pub(super) fn text(&self) -> Result<&'a str, ImportError> {
        self.value.as_str().ok_or_else(|| self.error("this is no text"))
    }

    pub(super) fn whole(&self) -> Result<u64, ImportError> {
        // Some writers put 3.0 for 3.
        let exact = |x: f64| ((0.0..1e15).contains(&x) && x.fract() == 0.0).then_some(x as u64);
        let whole = self.value.as_u64().or_else(|| self.value.as_f64().and_then(exact));
        whole.ok_or_else(|| self.error("this is no whole number from 0"))
    }

    pub(super) fn number(&self) -> Result<f64, ImportError> {
        let number = self.value.as_f64().filter(|x| x.is_finite());
        number.ok_or_else(|| self.error("this is no number"))
    }

    /// Whether it is `true`.
    pub(super) fn is_true(&self) -> bool {
        self.value == &Value::Bool(true)
    }

    /// The number behind a key, or what it is by default.
    pub(super) fn number_or(&self, key: &str, default: f64) -> Result<f64, ImportError> {
        self.get(key).map_or(Ok(default), |number| number.number())
    }

    /// The whole number behind a key, or what it is by default.
    pub(super) fn whole_or(&self, key: &str, default: u64) -> Result<u64, ImportError> {
        self.get(key).map_or(Ok(default), |number| number.whole())
    }

    /// The numbers behind a key; `None` if it is not there.
    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
    ) -> Result<Option<[f64; N]>, ImportError> {
        let Some(list) = self.get(key) else { return Ok(None) };
        let numbers: Vec<f64> = list.items()?.iter().map(Json::number).collect::<Result<_, _>>()?;
        let count = numbers.len();
        let numbers = numbers.try_into();
        numbers.map(Some).map_err(|_| list.error(format!("{N} numbers are needed, found {count}")))
    }

    /// What an extension says here.
    pub(super) fn extension(&self, name: &str) -> Option<Json<'a>> {
        self.get("extensions")?.get(name)
    }

    /// The name, if it has one.
    pub(super) fn name(&self) -> &'a str {
        self.value.get("name").and_then(Value::as_str).unwrap_or_default()
    }

    pub(super) fn key(&self) -> &str {
        &self.key
    }
}
