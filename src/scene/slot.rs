//! One editable value of a scene: its kind, its range, and how it is read from and written as TOML.

use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use glam::DVec3;
use toml::Spanned;
use toml::de::DeValue;

use super::Material;
use super::mesh::Mesh;
use super::problem::{Mistake, suggestion};
use crate::color::Rgb;

/// The numbers a parameter may hold; NaN and the infinities are never among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether `low` itself is allowed.
    pub low_included: bool,
    /// Whether `high` itself is allowed.
    pub high_included: bool,
}

impl Range {
    /// `low ≤ x ≤ high`.
    pub const fn closed(low: f64, high: f64) -> Range {
        Range { low, high, low_included: true, high_included: true }
    }

    /// `low < x ≤ high`.
    pub const fn above(low: f64, high: f64) -> Range {
        Range { low, high, low_included: false, high_included: true }
    }

    /// `low < x < high`.
    pub const fn between(low: f64, high: f64) -> Range {
        Range { low, high, low_included: false, high_included: false }
    }

    /// Whether `x` may be the value.
    pub fn contains(&self, x: f64) -> bool {
        x.is_finite()
            && (x > self.low || (self.low_included && x == self.low))
            && (x < self.high || (self.high_included && x == self.high))
    }

    /// The end of the range that `x` lies beyond, if that end is itself allowed.
    fn nearest_end(&self, x: f64) -> Option<f64> {
        if x < self.low && self.low_included {
            Some(self.low)
        } else if x > self.high && self.high_included {
            Some(self.high)
        } else {
            None
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |x: f64| if x.abs() >= 1e6 { format!("{x:e}") } else { number(x) };
        let (low, high) = (short(self.low), short(self.high));
        match (self.low_included, self.high_included) {
            (true, true) => write!(f, "{low} to {high}"),
            (false, true) => write!(f, "above {low} and at most {high}"),
            (true, false) => write!(f, "at least {low} and below {high}"),
            (false, false) => write!(f, "above {low} and below {high}"),
        }
    }
}

/// How a value is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number or `[r, g, b]`.
    Coefficient,
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// Two whole numbers.
    Pair,
    /// `true` or `false`.
    Flag,
    /// `[x, y, z]`.
    Vector,
    /// A number or `[x, y, z]`.
    Scale,
    /// `[[x, y, z], …]`.
    Points,
    /// The name of a material.
    Material,
    /// The name of a mesh file.
    File,
}

impl Kind {
    /// What must be written, as in "must be …".
    pub fn expected(self) -> &'static str {
        match self {
            Kind::Coefficient => "a number or [r, g, b]",
            Kind::Number => "a number",
            Kind::Whole => "a whole number",
            Kind::Pair => "two whole numbers [a, b]",
            Kind::Flag => "true or false",
            Kind::Vector => "three numbers [x, y, z]",
            Kind::Scale => "a number or [x, y, z]",
            Kind::Points => "a list of points [[x, y, z], …]",
            Kind::Material => "the name of a material",
            Kind::File => "the name of a file",
        }
    }
}

/// A place in a scene that holds a value.
#[derive(Debug)]
pub enum Slot<'a> {
    /// One number per channel.
    Coefficient(&'a mut Rgb, Range),
    /// One number of the shading.
    Single(&'a mut f32, Range),
    /// One number of the geometry.
    Number(&'a mut f64, Range),
    /// A count.
    Whole(&'a mut u32, Range),
    /// Two counts.
    Pair(&'a mut [u32; 2], Range),
    /// A switch.
    Flag(&'a mut bool),
    /// A point or direction.
    Vector(&'a mut DVec3, Range),
    /// A factor per axis.
    Scale(&'a mut DVec3, Range),
    /// A list of points.
    Points(&'a mut Vec<DVec3>, Range),
    /// Index of a material, written as its name.
    Material(&'a mut usize),
    /// A mesh file and what it held when it was read.
    Mesh {
        /// As written in the scene.
        file: &'a mut String,
        /// What the file held.
        mesh: &'a mut Arc<Mesh>,
    },
}

/// The names of a scene's materials, for writing and finding an index.
#[derive(Clone, Debug, Default)]
pub struct Names {
    list: Vec<String>,
    index: HashMap<String, usize>,
}

impl Names {
    /// Names in the order of the list.
    pub fn of(materials: &[Material]) -> Names {
        let list: Vec<String> = materials.iter().map(|material| material.name.clone()).collect();
        let index = list.iter().cloned().enumerate().map(|(i, name)| (name, i)).collect();
        Names { list, index }
    }
}

impl Slot<'_> {
    /// How the value is written.
    pub fn kind(&self) -> Kind {
        match self {
            Slot::Coefficient(..) => Kind::Coefficient,
            Slot::Single(..) | Slot::Number(..) => Kind::Number,
            Slot::Whole(..) => Kind::Whole,
            Slot::Pair(..) => Kind::Pair,
            Slot::Flag(_) => Kind::Flag,
            Slot::Vector(..) => Kind::Vector,
            Slot::Scale(..) => Kind::Scale,
            Slot::Points(..) => Kind::Points,
            Slot::Material(_) => Kind::Material,
            Slot::Mesh { .. } => Kind::File,
        }
    }

    /// What every number of the value must keep to; `None` if it is not made of numbers.
    pub fn range(&self) -> Option<Range> {
        match self {
            Slot::Coefficient(_, range)
            | Slot::Single(_, range)
            | Slot::Number(_, range)
            | Slot::Whole(_, range)
            | Slot::Pair(_, range)
            | Slot::Vector(_, range)
            | Slot::Scale(_, range)
            | Slot::Points(_, range) => Some(*range),
            Slot::Flag(_) | Slot::Material(_) | Slot::Mesh { .. } => None,
        }
    }

    /// The value as TOML, which reads back as the same bits.
    pub fn text(&self, names: &Names) -> String {
        match self {
            Slot::Coefficient(Rgb(channels), _) => {
                one_or_three(*channels, channels.map(f32::to_bits))
            }
            Slot::Single(x, _) => number(**x),
            Slot::Number(x, _) => number(**x),
            Slot::Whole(n, _) => n.to_string(),
            Slot::Pair([a, b], _) => format!("[{a}, {b}]"),
            Slot::Flag(on) => on.to_string(),
            Slot::Vector(v, _) => vector(v),
            Slot::Scale(v, _) => one_or_three(v.to_array(), v.to_array().map(f64::to_bits)),
            Slot::Points(points, _) => {
                format!("[{}]", points.iter().map(vector).collect::<Vec<_>>().join(", "))
            }
            Slot::Material(index) => {
                quoted(names.list.get(**index).map_or("NAME", |name| name.as_str()))
            }
            Slot::Mesh { file, .. } => quoted(file),
        }
    }

    /// Writes a TOML value into the slot. After an error the slot may hold a value out of range.
    pub fn assign(
        &mut self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        names: &Names,
    ) -> Result<(), Mistake> {
        let example = self.text(names);
        let target = Target { key, kind: self.kind(), range: self.range(), example };
        match self {
            Slot::Coefficient(rgb, _) => **rgb = Rgb(target.one_or_three(value)?),
            Slot::Single(x, _) => **x = target.float(value)?,
            Slot::Number(x, _) => **x = target.float(value)?,
            Slot::Whole(n, _) => **n = target.whole(value)?,
            Slot::Pair(pair, _) => **pair = target.pair(value)?,
            Slot::Flag(on) => {
                **on = value.get_ref().as_bool().ok_or_else(|| target.wrong_type(value))?;
            }
            Slot::Vector(v, _) => **v = DVec3::from(target.three(value)?),
            Slot::Scale(v, _) => **v = DVec3::from(target.one_or_three(value)?),
            Slot::Points(points, _) => **points = target.points(value)?,
            Slot::Material(index) => **index = target.material(value, names)?,
            Slot::Mesh { .. } => return Err(target.fixed(value)),
        }
        match self.first_outside() {
            Some((index, x)) => Err(target.out_of_range(element(value, index), x, self.show(x))),
            None => Ok(()),
        }
    }

    /// What is wrong with the present value by its range alone, with a way out.
    pub fn fault(&self, key: &str, names: &Names) -> Option<(String, String)> {
        let (_, x) = self.first_outside()?;
        let target =
            Target { key, kind: self.kind(), range: self.range(), example: self.text(names) };
        Some(target.outside(x, self.show(x)))
    }

    /// The first number out of range, with its index among all numbers of the slot.
    fn first_outside(&self) -> Option<(usize, f64)> {
        let range = self.range()?;
        let bad = |(_, x): &(usize, f64)| !range.contains(*x);
        let three = |v: &DVec3| v.to_array().into_iter().enumerate().find(bad);
        match self {
            Slot::Coefficient(rgb, _) => rgb.0.map(f64::from).into_iter().enumerate().find(bad),
            Slot::Single(x, _) => Some((0, f64::from(**x))).filter(bad),
            Slot::Number(x, _) => Some((0, **x)).filter(bad),
            Slot::Whole(n, _) => Some((0, f64::from(**n))).filter(bad),
            Slot::Pair(pair, _) => pair.map(f64::from).into_iter().enumerate().find(bad),
            Slot::Vector(v, _) | Slot::Scale(v, _) => three(v),
            Slot::Points(points, _) => {
                points.iter().flat_map(DVec3::to_array).enumerate().find(bad)
            }
            Slot::Flag(_) | Slot::Material(_) | Slot::Mesh { .. } => None,
        }
    }

    /// A number of this slot in its own precision.
    fn show(&self, x: f64) -> String {
        match self {
            Slot::Coefficient(..) | Slot::Single(..) => number(x as f32),
            _ => number(x),
        }
    }
}

/// What a value is read for: the words of its error messages.
struct Target<'a> {
    key: &'a str,
    kind: Kind,
    range: Option<Range>,
    example: String,
}

impl Target<'_> {
    fn wrong_type(&self, found: &Spanned<DeValue<'_>>) -> Mistake {
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

    fn out_of_range(&self, found: &Spanned<DeValue<'_>>, x: f64, shown: String) -> Mistake {
        let (message, help) = self.outside(x, shown);
        Mistake { span: found.span(), message, help }
    }

    fn outside(&self, x: f64, shown: String) -> (String, String) {
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

    fn fixed(&self, found: &Spanned<DeValue<'_>>) -> Mistake {
        Mistake {
            span: found.span(),
            message: format!("`{}` can only be changed in the scene file", self.key),
            help: "edit the scene file and open it again".to_owned(),
        }
    }

    fn float<T: FromStr>(&self, value: &Spanned<DeValue<'_>>) -> Result<T, Mistake> {
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

    fn three<T: FromStr>(&self, value: &Spanned<DeValue<'_>>) -> Result<[T; 3], Mistake> {
        let [x, y, z] = self.array(value)?;
        Ok([self.float(x)?, self.float(y)?, self.float(z)?])
    }

    fn one_or_three<T: FromStr + Copy>(
        &self,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<[T; 3], Mistake> {
        if value.get_ref().is_array() { self.three(value) } else { Ok([self.float(value)?; 3]) }
    }

    fn points(&self, value: &Spanned<DeValue<'_>>) -> Result<Vec<DVec3>, Mistake> {
        let list = value.get_ref().as_array().ok_or_else(|| self.wrong_type(value))?;
        list.iter().map(|point| Ok(DVec3::from(self.three(point)?))).collect()
    }

    fn whole(&self, value: &Spanned<DeValue<'_>>) -> Result<u32, Mistake> {
        let DeValue::Integer(text) = value.get_ref() else {
            return Err(self.wrong_type(value));
        };
        let whole = i128::from_str_radix(text.as_str(), text.radix()).unwrap_or(i128::MAX);
        u32::try_from(whole)
            .map_err(|_| self.out_of_range(value, whole as f64, text.as_str().to_owned()))
    }

    fn pair(&self, value: &Spanned<DeValue<'_>>) -> Result<[u32; 2], Mistake> {
        let [a, b] = self.array(value)?;
        Ok([self.whole(a)?, self.whole(b)?])
    }

    fn material(&self, value: &Spanned<DeValue<'_>>, names: &Names) -> Result<usize, Mistake> {
        let name = value.get_ref().as_str().ok_or_else(|| self.wrong_type(value))?;
        names.index.get(name).copied().ok_or_else(|| Mistake {
            span: value.span(),
            message: format!("there is no material `{name}`"),
            help: if names.list.is_empty() {
                format!("add a table `[materials.{}]`", bare_or_quoted(name))
            } else {
                suggestion(name, "materials", names.list.iter().map(String::as_str))
            },
        })
    }
}

/// The element of a TOML value that holds the `index`-th number.
fn element<'v>(value: &'v Spanned<DeValue<'v>>, index: usize) -> &'v Spanned<DeValue<'v>> {
    let Some(array) = value.get_ref().as_array() else { return value };
    match array.get(index / 3).and_then(|point| point.get_ref().as_array()) {
        Some(point) => point.get(index % 3).unwrap_or(value),
        None => array.get(index).unwrap_or(value),
    }
}

/// What the user wrote, as in "found …".
pub fn describe(value: &DeValue<'_>) -> String {
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

/// The shortest decimal that reads back as the same bits.
pub fn number<T: Copy + Into<f64> + fmt::Display + fmt::LowerExp>(x: T) -> String {
    let wide: f64 = x.into();
    if wide == 0.0 && wide.is_sign_negative() {
        "-0.0".to_owned()
    } else if wide == 0.0 || !wide.is_finite() || (1e-5..1e15).contains(&wide.abs()) {
        format!("{x}").replace("NaN", "nan")
    } else {
        format!("{x:e}")
    }
}

fn vector(v: &DVec3) -> String {
    let DVec3 { x, y, z } = *v;
    format!("[{}, {}, {}]", number(x), number(y), number(z))
}

fn one_or_three<T, B>(values: [T; 3], bits: [B; 3]) -> String
where
    T: Copy + Into<f64> + fmt::Display + fmt::LowerExp,
    B: PartialEq,
{
    let [x, y, z] = values.map(number);
    if bits[0] == bits[1] && bits[1] == bits[2] { x } else { format!("[{x}, {y}, {z}]") }
}

/// A TOML basic string.
pub fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A TOML key: bare if that is possible.
pub fn bare_or_quoted(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(bare) { key.to_owned() } else { quoted(key) }
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

    #[test]
    fn ranges_say_what_they_hold() {
        assert_eq!(Range::closed(0.0, 1e6).to_string(), "0 to 1e6");
        assert_eq!(Range::between(0.0, 180.0).to_string(), "above 0 and below 180");
        assert!(Range::closed(0.0, 1.0).contains(1.0) && !Range::above(0.0, 1.0).contains(0.0));
        assert!(!Range::closed(0.0, 1.0).contains(f64::NAN));
        assert!(!Range::between(0.0, 180.0).contains(180.0));
    }

    #[test]
    fn keys_are_quoted_only_if_needed() {
        assert_eq!(bare_or_quoted("tiles-2_b"), "tiles-2_b");
        assert_eq!(bare_or_quoted("my tiles"), "\"my tiles\"");
        assert_eq!(bare_or_quoted(""), "\"\"");
        assert_eq!(quoted("a\"b\\c\n"), "\"a\\\"b\\\\c\\u000A\"");
    }
}
