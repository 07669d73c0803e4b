//! TOML values into numbers, names and points; every refusal says what was expected and what was found.

use std::collections::HashMap;
use std::str::FromStr;

use glam::{DVec2, DVec3};
use toml::Spanned;
use toml::de::DeValue;

use super::Scene;
use super::problem::{Mistake, suggestion};
use super::range::{Kind, Range};
use super::toml_text::{bare_or_quoted, number};

/// The names of what a scene's parameters refer to, for writing and finding an index.
#[derive(Clone, Debug, Default)]
pub struct Names {
    pub(super) materials: NameList,
    pub(super) solids: NameList,
}

impl Names {
    /// Those of a scene.
    pub fn of(scene: &Scene) -> Names {
        Names {
            materials: NameList::of(scene.materials.iter().map(|material| &material.name)),
            solids: NameList::of(scene.solids.iter().map(|solid| &solid.name)),
        }
    }

    /// The materials' names in the order of their indices.
    pub fn materials(&self) -> &[String] {
        &self.materials.list
    }
}

/// The names of one of a scene's lists.
#[derive(Clone, Debug, Default)]
pub(super) struct NameList {
    list: Vec<String>,
    index: HashMap<String, usize>,
}

impl NameList {
    fn of<'a>(names: impl Iterator<Item = &'a String>) -> NameList {
        let list: Vec<String> = names.cloned().collect();
        let index = list.iter().cloned().enumerate().map(|(i, name)| (name, i)).collect();
        NameList { list, index }
    }

    /// The name with this index.
    pub(super) fn name(&self, index: usize) -> &str {
        self.list.get(index).map_or("NAME", |name| name.as_str())
    }

    /// The index of a name, or what is wrong: there is no such `kind` in the scene.
    fn find(&self, value: &Spanned<DeValue<'_>>, name: &str, kind: &str) -> Result<usize, Mistake> {
        self.index.get(name).copied().ok_or_else(|| Mistake {
            span: value.span(),
            message: format!("there is no {kind} `{name}`"),
            help: if self.list.is_empty() {
                format!("add a table `[{kind}s.{}]`", bare_or_quoted(name))
            } else {
                suggestion(name, &format!("{kind}s"), self.list.iter().map(String::as_str))
            },
        })
    }
}

/// What a value is read for: the words of its error messages.
pub(super) struct Target<'a> {
    pub(super) key: &'a str,
    pub(super) kind: Kind,
    pub(super) range: Option<Range>,
    pub(super) example: String,
}

impl Target<'_> {
    pub(super) fn wrong_type(&self, found: &Spanned<DeValue<'_>>) -> Mistake {
        Mistake {
            span: found.span(),
            message: format!(
                "`{}` must be {}, found {}",
                self.key,
                self.kind.expected(),
                describe(found.get_ref())
            ),
            help: format!("for example `{} = {}`", self.key, self.example),
        }
    }

    pub(super) fn out_of_range(
        &self,
        found: &Spanned<DeValue<'_>>,
        x: f64,
        shown: String,
    ) -> Mistake {
        let (message, help) = self.outside(x, shown);
        Mistake { span: found.span(), message, help }
    }

    pub(super) fn outside(&self, x: f64, shown: String) -> (String, String) {
        let Target { key, range, .. } = self;
        let allowed = range.map_or_else(String::new, |range| range.to_string());
        if !x.is_finite() {
            return (
                format!("`{key}` is {shown}, not a finite number"),
                format!("choose a value in its range: {allowed}"),
            );
        }
        let help = match range.and_then(|range| range.nearest_end(x)) {
            Some(end) => format!("the nearest allowed value is {}", number(end)),
            None => format!("choose a value {allowed}"),
        };
        (format!("`{key}` is {shown}, out of its range: {allowed}"), help)
    }

    pub(super) fn fixed(&self, found: &Spanned<DeValue<'_>>) -> Mistake {
        Mistake {
            span: found.span(),
            message: format!("`{}` can only be changed in the scene file", self.key),
            help: "edit the scene file and open it again".to_owned(),
        }
    }

    pub(super) fn float<T: FromStr>(&self, value: &Spanned<DeValue<'_>>) -> Result<T, Mistake> {
        let parsed = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(whole) if whole.radix() == 10 => whole.as_str().parse().ok(),
            DeValue::Integer(whole) => i128::from_str_radix(whole.as_str(), whole.radix())
                .ok()
                .and_then(|whole| whole.to_string().parse().ok()),
            _ => None,
        };
        parsed.ok_or_else(|| self.wrong_type(value))
    }

    fn array<'v, const N: usize>(
        &self,
        value: &'v Spanned<DeValue<'v>>,
    ) -> Result<[&'v Spanned<DeValue<'v>>; N], Mistake> {
        let items = value.get_ref().as_array().map(|array| array.iter().collect::<Vec<_>>());
        items.and_then(|items| items.try_into().ok()).ok_or_else(|| self.wrong_type(value))
    }

    pub(super) fn three<T: FromStr>(
        &self,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<[T; 3], Mistake> {
        let [x, y, z] = self.array(value)?;
        Ok([self.float(x)?, self.float(y)?, self.float(z)?])
    }

    pub(super) fn one_or_three<T: FromStr + Copy>(
        &self,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<[T; 3], Mistake> {
        if value.get_ref().is_array() { self.three(value) } else { Ok([self.float(value)?; 3]) }
    }

    pub(super) fn points(&self, value: &Spanned<DeValue<'_>>) -> Result<Vec<DVec3>, Mistake> {
        let list = value.get_ref().as_array().ok_or_else(|| self.wrong_type(value))?;
        list.iter().map(|point| Ok(DVec3::from(self.three(point)?))).collect()
    }

    /// One loop of points, or a list of loops.
    pub(super) fn loops(&self, value: &Spanned<DeValue<'_>>) -> Result<Vec<Vec<DVec2>>, Mistake> {
        let list = value.get_ref().as_array().ok_or_else(|| self.wrong_type(value))?;
        let inner = |value: &Spanned<DeValue<'_>>| {
            value.get_ref().as_array().and_then(|a| a.first()).map(|v| v.get_ref().is_array())
        };
        let points = |value: &Spanned<DeValue<'_>>| {
            let list = value.get_ref().as_array().ok_or_else(|| self.wrong_type(value))?;
            let point = |value| {
                let [x, y] = self.array(value)?;
                Ok(DVec2::new(self.float(x)?, self.float(y)?))
            };
            list.iter().map(point).collect()
        };
        if list.first().and_then(inner).unwrap_or(false) {
            list.iter().map(points).collect()
        } else {
            Ok(vec![points(value)?])
        }
    }

    pub(super) fn whole(&self, value: &Spanned<DeValue<'_>>) -> Result<u32, Mistake> {
        let DeValue::Integer(text) = value.get_ref() else {
            return Err(self.wrong_type(value));
        };
        let whole = i128::from_str_radix(text.as_str(), text.radix()).unwrap_or(i128::MAX);
        u32::try_from(whole)
            .map_err(|_| self.out_of_range(value, whole as f64, text.as_str().to_owned()))
    }

    pub(super) fn pair(&self, value: &Spanned<DeValue<'_>>) -> Result<[u32; 2], Mistake> {
        let [a, b] = self.array(value)?;
        Ok([self.whole(a)?, self.whole(b)?])
    }

    /// Index of the name among `names`.
    pub(super) fn choice(
        &self,
        value: &Spanned<DeValue<'_>>,
        names: &[&str],
    ) -> Result<usize, Mistake> {
        let name = value.get_ref().as_str().ok_or_else(|| self.wrong_type(value))?;
        names.iter().position(|known| *known == name).ok_or_else(|| Mistake {
            span: value.span(),
            message: format!("there is no {} `{name}`", self.key),
            help: suggestion(name, "known names", names.iter().copied()),
        })
    }

    pub(super) fn material(
        &self,
        value: &Spanned<DeValue<'_>>,
        names: &NameList,
    ) -> Result<usize, Mistake> {
        let name = value.get_ref().as_str().ok_or_else(|| self.wrong_type(value))?;
        names.find(value, name, "material")
    }

    pub(super) fn solids(
        &self,
        value: &Spanned<DeValue<'_>>,
        names: &NameList,
    ) -> Result<Vec<usize>, Mistake> {
        let list = value.get_ref().as_array().ok_or_else(|| self.wrong_type(value))?;
        let solid = |value: &Spanned<DeValue<'_>>| {
            let name = value.get_ref().as_str().ok_or_else(|| self.wrong_type(value))?;
            names.find(value, name, "solid")
        };
        list.iter().map(solid).collect()
    }
}

/// The element of a TOML value that holds the `index`-th number.
pub(super) fn element<'v>(
    value: &'v Spanned<DeValue<'v>>,
    index: usize,
) -> &'v Spanned<DeValue<'v>> {
    let Some(array) = value.get_ref().as_array() else { return value };
    match array.get(index / 3).and_then(|point| point.get_ref().as_array()) {
        Some(point) => point.get(index % 3).unwrap_or(value),
        None => array.get(index).unwrap_or(value),
    }
}

/// What the user wrote, as in "found …".
pub(super) fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(_) => "a string".to_owned(),
        DeValue::Integer(whole) => format!("the whole number {whole}"),
        DeValue::Float(float) => format!("the number {float}"),
        DeValue::Boolean(on) => format!("`{on}`"),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(array) if array.len() == 1 => "an array of 1 value".to_owned(),
        DeValue::Array(array) => format!("an array of {} values", array.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back_as_the_same_bits() {
        assert_eq!(number(0.1f32), "0.1");
        assert_eq!(number(1.0f64), "1");
        assert_eq!(number(-0.0f64), "-0.0");
        assert_eq!(number(1e-7f64), "1e-7");
        assert_eq!(number(1e12f64), "1000000000000");
        let mut bits = 1u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
            let (wide, narrow) = (f64::from_bits(bits), f32::from_bits((bits >> 32) as u32));
            if wide.is_finite() {
                assert_eq!(read::<f64>(&number(wide)).to_bits(), wide.to_bits());
            }
            if narrow.is_finite() {
                assert_eq!(read::<f32>(&number(narrow)).to_bits(), narrow.to_bits());
            }
        }
    }

    fn read<T: FromStr>(text: &str) -> T {
        let value = DeValue::parse(text).unwrap();
        let target = Target { key: "x", kind: Kind::Number, range: None, example: String::new() };
        target.float(&value).unwrap()
    }
}
