//! One editable value of a scene: its kind, its range, and how it is read from and written as TOML.

use std::fmt;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use toml::Spanned;
use toml::de::DeValue;

use super::ImageFile;
use super::mesh::Mesh;
use super::problem::Mistake;
use super::range::{Kind, Range};
use super::toml_text::{number, one_or_three, quoted, rgb, vector};
use super::value::{Names, Target, element};
use crate::color::Rgb;

/// One of several named things.
pub trait Choice: fmt::Debug {
    /// The names of all of them, as written in a scene file.
    fn names(&self) -> &'static [&'static str];
    /// Index of the present one.
    fn chosen(&self) -> usize;
    /// Takes the one with this index among the names.
    fn choose(&mut self, index: usize);
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
    /// One of a list of names.
    Choice(&'a mut dyn Choice),
    /// A point or direction.
    Vector(&'a mut DVec3, Range),
    /// A factor per axis.
    Scale(&'a mut DVec3, Range),
    /// A list of points.
    Points(&'a mut Vec<DVec3>, Range),
    /// Loops of points in a plane; one loop is written as a list of points, several as a list of those.
    Loops(&'a mut Vec<Vec<DVec2>>, Range),
    /// Index of a material, written as its name.
    Material(&'a mut usize),
    /// Indices of solids, written as their names.
    Solids(&'a mut Vec<usize>),
    /// A mesh file and what it held when it was read.
    Mesh {
        /// As written in the scene.
        file: &'a mut String,
        /// What the file held.
        mesh: &'a mut Arc<Mesh>,
    },
    /// An image file and what it held when it was read.
    Image(&'a mut ImageFile),
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
            Slot::Choice(choice) => Kind::Choice(choice.names()),
            Slot::Vector(..) => Kind::Vector,
            Slot::Scale(..) => Kind::Scale,
            Slot::Points(..) => Kind::Points,
            Slot::Loops(..) => Kind::Loops,
            Slot::Material(_) => Kind::Material,
            Slot::Solids(_) => Kind::Solids,
            Slot::Mesh { .. } | Slot::Image(_) => Kind::File,
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
            | Slot::Points(_, range)
            | Slot::Loops(_, range) => Some(*range),
            Slot::Flag(_) | Slot::Choice(_) | Slot::Material(_) | Slot::Solids(_) => None,
            Slot::Mesh { .. } | Slot::Image(_) => None,
        }
    }

    /// The value as TOML, which reads back as the same bits.
    pub fn text(&self, names: &Names) -> String {
        match self {
            Slot::Coefficient(color, _) => rgb(**color),
            Slot::Single(x, _) => number(**x),
            Slot::Number(x, _) => number(**x),
            Slot::Whole(n, _) => n.to_string(),
            Slot::Pair([a, b], _) => format!("[{a}, {b}]"),
            Slot::Flag(on) => on.to_string(),
            Slot::Choice(choice) => quoted(choice.names()[choice.chosen()]),
            Slot::Vector(v, _) => vector(v),
            Slot::Scale(v, _) => one_or_three(v.to_array(), v.to_array().map(f64::to_bits)),
            Slot::Points(points, _) => {
                format!("[{}]", points.iter().map(vector).collect::<Vec<_>>().join(", "))
            }
            Slot::Loops(loops, _) => match loops.as_slice() {
                [points] => plane_points(points),
                loops => {
                    let loops: Vec<String> = loops.iter().map(|l| plane_points(l)).collect();
                    format!("[{}]", loops.join(", "))
                }
            },
            Slot::Material(index) => quoted(names.materials.name(**index)),
            Slot::Solids(operands) => {
                let name = |index: &usize| quoted(names.solids.name(*index));
                format!("[{}]", operands.iter().map(name).collect::<Vec<_>>().join(", "))
            }
            Slot::Mesh { file, .. } => quoted(file),
            Slot::Image(ImageFile { file, image: _ }) => quoted(file),
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
            Slot::Choice(choice) => choice.choose(target.choice(value, choice.names())?),
            Slot::Vector(v, _) => **v = DVec3::from(target.three(value)?),
            Slot::Scale(v, _) => **v = DVec3::from(target.one_or_three(value)?),
            Slot::Points(points, _) => **points = target.points(value)?,
            Slot::Loops(loops, _) => **loops = target.loops(value)?,
            Slot::Material(index) => **index = target.material(value, &names.materials)?,
            Slot::Solids(operands) => **operands = target.solids(value, &names.solids)?,
            Slot::Mesh { .. } | Slot::Image(_) => return Err(target.fixed(value)),
        }
        match self.first_outside() {
            Some((index, x)) => Err(target.out_of_range(element(value, index), x, self.show(x))),
            None => Ok(()),
        }
    }

    /// Puts another value of the range in its place, heeding no other rule: whoever asks what a
    /// change touches compares with it. The content of a file stays.
    pub fn alter(&mut self) {
        match self {
            Slot::Coefficient(rgb, range) => {
                rgb.0[0] = another(rgb.0[0], *range, |x| x as f32);
            }
            Slot::Single(x, range) => **x = another(**x, *range, |x| x as f32),
            Slot::Number(x, range) => **x = another(**x, *range, |x| x),
            Slot::Whole(n, range) => **n = another(**n, *range, |x| x as u32),
            Slot::Pair(pair, range) => pair[0] = another(pair[0], *range, |x| x as u32),
            Slot::Flag(on) => **on = !**on,
            Slot::Choice(choice) => choice.choose((choice.chosen() + 1) % choice.names().len()),
            Slot::Vector(v, range) | Slot::Scale(v, range) => v.x = another(v.x, *range, |x| x),
            Slot::Points(points, range) => {
                for point in points.iter_mut() {
                    point.x = another(point.x, *range, |x| x);
                }
            }
            Slot::Loops(loops, range) => {
                for point in loops.iter_mut().flatten() {
                    point.x = another(point.x, *range, |x| x);
                }
            }
            Slot::Material(index) => **index += 1,
            Slot::Solids(operands) => operands.push(0),
            Slot::Mesh { .. } | Slot::Image(_) => {}
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
            Slot::Single(x, range) => {
                let narrow = range.narrow();
                Some((0, f64::from(**x))).filter(|(_, x)| !narrow.contains(*x))
            }
            Slot::Number(x, _) => Some((0, **x)).filter(bad),
            Slot::Whole(n, _) => Some((0, f64::from(**n))).filter(bad),
            Slot::Pair(pair, _) => pair.map(f64::from).into_iter().enumerate().find(bad),
            Slot::Vector(v, _) | Slot::Scale(v, _) => three(v),
            Slot::Points(points, _) => {
                points.iter().flat_map(DVec3::to_array).enumerate().find(bad)
            }
            // The place of a number among loops is not looked for.
            Slot::Loops(loops, _) => {
                let all = loops.iter().flatten().flat_map(DVec2::to_array);
                all.map(|x| (usize::MAX, x)).find(bad)
            }
            Slot::Flag(_) | Slot::Choice(_) | Slot::Material(_) | Slot::Solids(_) => None,
            Slot::Mesh { .. } | Slot::Image(_) => None,
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

/// `[[x, y], …]`.
fn plane_points(points: &[DVec2]) -> String {
    let point = |p: &DVec2| format!("[{}, {}]", number(p.x), number(p.y));
    format!("[{}]", points.iter().map(point).collect::<Vec<_>>().join(", "))
}

/// The middle of a range, or, in its place, the middle of the range's lower half.
fn another<T: PartialEq>(present: T, range: Range, narrow: impl Fn(f64) -> T) -> T {
    let middle = (range.low + range.high) / 2.0;
    let value = narrow(middle);
    if value == present { narrow((range.low + middle) / 2.0) } else { value }
}
