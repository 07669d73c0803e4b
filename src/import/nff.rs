//! NFF, the Neutral File Format of Eric Haines' standard scenes: v, b, l, f, s, c, p and pp.

use std::collections::HashMap;

use glam::DVec3;

use super::job::{Job, Names};
use super::place::{At, ImportError};
use super::polygon;
use super::words::Word;
use crate::color::Rgb;
use crate::scene::mesh::Mesh;
use crate::scene::range::Range;
use crate::scene::{
    Background, Lens, Light, LightPlace, Material, Paint, Scene, Shape, Solid, fields,
};

/// Most numbers behind an `f`: the last is the ambient share of the extended format.
const MOST_OF_FILL: usize = 9;

/// Polygons of one material that follow each other, on their way to one mesh.
#[derive(Default)]
struct Run {
    mesh: Mesh,
    /// The number of every corner, by the bits of its coordinates: shared edges close a solid.
    corners: HashMap<[u64; 3], u32>,
    /// Whether every polygon has normals.
    smooth: bool,
}

struct Reader<'j, 'a, 't> {
    job: &'j mut Job<'a>,
    /// What is not read yet.
    words: std::iter::Peekable<std::vec::IntoIter<Word<'t>>>,
    /// The line of the last word read.
    line: usize,
    scene: Scene,
    names: Names,
    run: Run,
}

/// Reads an NFF file; `z` is usually up, and its view says so.
pub(super) fn read(job: &mut Job<'_>, bytes: &[u8]) -> Result<Scene, ImportError> {
    let text = String::from_utf8_lossy(bytes);
    let lines = text.lines().enumerate();
    let words: Vec<Word<'_>> = lines.flat_map(|(i, line)| Word::all(line, i + 1)).collect();
    let mut reader = Reader {
        job,
        words: words.into_iter().peekable(),
        line: 1,
        scene: Scene { ambient_light: Rgb::WHITE, ..Scene::default() },
        names: Names::default(),
        run: Run::default(),
    };
    while let Some(word) = reader.words.next() {
        reader.line = word.line;
        reader.entity(word)?;
    }
    reader.end_run()?;
    reader.share_light();
    Ok(reader.scene)
}

impl Reader<'_, '_, '_> {
    fn entity(&mut self, word: Word<'_>) -> Result<(), ImportError> {
        if !["p", "pp"].contains(&word.text) {
            self.end_run()?;
        }
        match word.text {
            "v" => self.view(),
            "b" => {
                let color = self.color("b")?;
                self.scene.background = Background::Color(color);
                Ok(())
            }
            "l" => self.light(),
            "f" => self.fill(),
            "s" => self.sphere(),
            "c" => self.cone(),
            "p" => self.polygon(false),
            "pp" => self.polygon(true),
            other if other.starts_with(|c: char| c.is_alphabetic()) => {
                self.skip_line();
                let text = format!("`{other}` is left out: it is no entity of NFF");
                self.job.note(word.at(), text);
                Ok(())
            }
            other => {
                let cause = format!("`{other}` is no entity of NFF");
                let way_out = "NFF has v, b, l, f, s, c, p and pp, each with its numbers";
                Err(self.job.error(word.at(), cause, way_out))
            }
        }
    }

    /// The next number, one of those of `entity`.
    fn number(&mut self, entity: &str) -> Result<f64, ImportError> {
        match self.words.next() {
            Some(word) => {
                self.line = word.line;
                word.number(self.job.source)
            }
            None => {
                let cause = format!("the file ends within `{entity}`");
                let way_out = "the file was cut off: take it from its source again";
                Err(self.job.error(At::Line(self.line), cause, way_out))
            }
        }
    }

    /// A point of space; the largest coordinates of a scene bound it.
    fn point(&mut self, entity: &str) -> Result<DVec3, ImportError> {
        let mut point = DVec3::ZERO;
        for axis in 0..3 {
            let x = self.number(entity)?;
            if !fields::COORDINATE.contains(x) {
                let cause = format!("the coordinate {x} is beyond 1e12");
                return Err(self.job.error(
                    At::Line(self.line),
                    cause,
                    "use a larger unit of length",
                ));
            }
            point[axis] = x;
        }
        Ok(point)
    }

    fn color(&mut self, entity: &str) -> Result<Rgb, ImportError> {
        let mut rgb = [0.0; 3];
        for channel in &mut rgb {
            let x = self.number(entity)?;
            *channel = self.inside(x, fields::COEFFICIENT, entity) as f32;
        }
        Ok(Rgb(rgb))
    }

    /// A number brought into its range.
    fn inside(&mut self, x: f64, range: Range, entity: &str) -> f64 {
        let clamped = range.clamp(x);
        if clamped != x {
            let text =
                format!("a number of `{entity}` is brought into its range: {clamped}, not {x}");
            self.job.note(At::Line(self.line), text);
        }
        clamped
    }

    /// The numbers that follow on the same line, at most `most`.
    fn numbers_of_line(&mut self, most: usize) -> Result<Vec<f64>, ImportError> {
        let (line, mut numbers) = (self.line, Vec::new());
        while numbers.len() < most
            && let Some(word) = self.words.next_if(|word| word.line == line)
        {
            numbers.push(word.number(self.job.source)?);
        }
        Ok(numbers)
    }

    /// Passes over what follows on the same line.
    fn skip_line(&mut self) {
        let line = self.line;
        while self.words.next_if(|word| word.line == line).is_some() {}
    }

    fn view(&mut self) -> Result<(), ImportError> {
        let keys = ["from", "at", "up", "angle", "hither", "yon", "resolution"];
        let camera = |scene: &mut Scene| std::mem::take(&mut scene.camera);
        let mut view = camera(&mut self.scene);
        while let Some(word) = self.words.next_if(|word| keys.contains(&word.text)) {
            self.line = word.line;
            match word.text {
                "from" => view.eye = self.point("from")?,
                "at" => view.target = self.point("at")?,
                "up" => view.up = self.point("up")?,
                "angle" => {
                    let angle = self.number("angle")?;
                    let fov_degrees = self.inside(angle, Range::closed(1e-3, 179.9), "angle");
                    view.lens = Lens::Perspective { fov_degrees };
                }
                "resolution" => {
                    for side in 0..2 {
                        let pixels = self.number("resolution")?.round();
                        let pixels =
                            self.inside(pixels, Range::closed(1.0, 16_384.0), "resolution");
                        self.scene.picture.size[side] = pixels as u32;
                    }
                }
                key => {
                    self.number(key)?;
                    let text = format!("`{key}` is left out: rays see from the eye on");
                    self.job.note(word.at(), text);
                }
            }
        }
        self.scene.camera = view;
        Ok(())
    }

    /// `l x y z [r g b]`, in the extended format `l x y z intensity r g b`.
    fn light(&mut self) -> Result<(), ImportError> {
        let point = self.point("l")?;
        let rest = self.numbers_of_line(4)?;
        let name = format!("light {}", self.scene.lights.len() + 1);
        let mut light = Light { place: LightPlace::Point(point), ..Light::new(name) };
        let rest: Vec<f64> =
            rest.into_iter().map(|x| self.inside(x, fields::COEFFICIENT, "l")).collect();
        match rest[..] {
            [] => light.intensity = Rgb::BLACK,
            [r, g, b] => light.intensity = Rgb([r, g, b].map(|x| x as f32)),
            [intensity, r, g, b] => {
                light.intensity = Rgb::grey(intensity as f32);
                light.color = Rgb([r, g, b].map(|x| x as f32));
            }
            _ => {
                let cause = format!("`l` needs 3, 6 or 7 numbers, found {}", 3 + rest.len());
                return Err(self.job.error(At::Line(self.line), cause, "add the missing numbers"));
            }
        }
        self.scene.lights.push(light);
        Ok(())
    }

    /// Lights without a strength share it: 1/√n each, as the format's author suggests.
    fn share_light(&mut self) {
        let dark = |light: &&mut Light| light.intensity == Rgb::BLACK;
        let count = self.scene.lights.len();
        let strength = (1.0 / (count as f64).sqrt()) as f32;
        let mut shared = 0;
        for light in self.scene.lights.iter_mut().filter(dark) {
            light.intensity = Rgb::grey(strength);
            shared += 1;
        }
        if shared > 0 {
            let text = format!("guessed: {shared} lights without a strength get 1/√{count} each");
            self.job.note(At::File, text);
        }
    }

    /// `f r g b Kd Ks shine T ior [Ka]`.
    fn fill(&mut self) -> Result<(), ImportError> {
        let color = self.color("f")?;
        let rest = self.numbers_of_line(MOST_OF_FILL - 3)?;
        let (numbers, ambient) = match rest[..] {
            [kd, ks, shine, t, ior] => ([kd, ks, shine, t, ior], 0.0),
            [kd, ks, shine, t, ior, ka] => ([kd, ks, shine, t, ior], ka),
            _ => {
                let cause = format!("`f` needs 8 or 9 numbers, found {}", 3 + rest.len());
                let way_out = "write f red green blue Kd Ks Shine T index_of_refraction";
                return Err(self.job.error(At::Line(self.line), cause, way_out));
            }
        };
        let [kd, ks, shine, t, ior] = numbers;
        let mut share = |x, range| self.inside(x, range, "f") as f32;
        let (diffuse, specular) = (share(kd, fields::COEFFICIENT), share(ks, fields::COEFFICIENT));
        let (shininess, transmit) = (share(shine, fields::EXPONENT), share(t, fields::WEIGHT));
        let ambient = share(ambient, fields::COEFFICIENT);
        // 0 stands for an index that does not matter.
        let ior = if ior == 0.0 { 1.0 } else { self.inside(ior, Range::closed(0.1, 10.0), "f") };
        let material = Material {
            paint: Paint::Solid(color),
            ambient: Rgb::grey(ambient),
            diffuse: Rgb::grey(diffuse),
            specular: Rgb::grey(specular),
            shininess,
            reflect: Rgb::grey(specular.min(fields::WEIGHT.high as f32)),
            transmit: Rgb::grey(transmit),
            ior,
            ..Material::new(format!("fill {}", self.scene.materials.len() + 1))
        };
        self.scene.materials.push(material);
        Ok(())
    }

    /// The material of what comes now.
    fn material(&mut self) -> usize {
        if self.scene.materials.is_empty() {
            let text = "there is no `f` before the first solid: it is made matt white";
            self.job.note(At::Line(self.line), text);
            self.scene.materials.push(Material::new("fill"));
        }
        self.scene.materials.len() - 1
    }

    fn sphere(&mut self) -> Result<(), ImportError> {
        let center = self.point("s")?;
        let radius = self.number("s")?;
        if radius < 0.0 {
            self.job.note(
                At::Line(self.line),
                "a sphere seen from inside alone is seen from both sides",
            );
        }
        let radius = radius.abs();
        if !fields::LENGTH.contains(radius) {
            let cause = format!("a sphere of radius {radius} has no size");
            return Err(self.job.error(At::Line(self.line), cause, "give a radius above 0"));
        }
        self.add("ball", Shape::Sphere { center, radius });
        Ok(())
    }

    fn add(&mut self, kind: &str, shape: Shape) {
        let material = self.material();
        let name = self.names.take(&format!("{kind} {}", self.scene.solids.len() + 1), kind);
        self.scene.solids.push(Solid::new(name, shape, material));
    }

    /// `c` base, base radius, apex, apex radius.
    fn cone(&mut self) -> Result<(), ImportError> {
        let line = self.line;
        let (from, radius) = (self.point("c")?, self.number("c")?.abs());
        let (to, tip) = (self.point("c")?, self.number("c")?.abs());
        let fits = |x: f64| x == 0.0 || fields::LENGTH.contains(x);
        if from == to || radius == tip && tip == 0.0 || !fits(radius) || !fits(tip) {
            let cause = "a cone without length or radius";
            return Err(self.job.error(
                At::Line(line),
                cause,
                "give two ends and a radius above 0",
            ));
        }
        self.job.note(
            At::Line(line),
            "cones and cylinders are open in NFF, here their ends are closed",
        );
        if radius == tip {
            self.add("cylinder", Shape::Cylinder { from, to, radius });
        } else if radius > tip {
            self.add("cone", Shape::Cone { from, to, radius, tip });
        } else {
            self.add("cone", Shape::Cone { from: to, to: from, radius: tip, tip: radius });
        }
        Ok(())
    }

    /// `p n` with n points, or `pp n` with n points and normals.
    fn polygon(&mut self, patch: bool) -> Result<(), ImportError> {
        let entity = if patch { "pp" } else { "p" };
        let line = self.line;
        let count = self.number(entity)?;
        if !(3.0..=1e9).contains(&count) || count.fract() != 0.0 {
            let cause = format!("`{entity} {count}` is no number of corners");
            return Err(self.job.error(At::Line(line), cause, "a polygon has 3 corners or more"));
        }
        // The number is not trusted: memory is taken as corners come.
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for _ in 0..count as u64 {
            points.push(self.point(entity)?);
            if patch {
                normals.push(self.point(entity)?);
            }
        }
        if self.run.mesh.triangles.is_empty() {
            self.run.smooth = patch;
        } else if self.run.smooth != patch {
            self.end_run()?;
            self.run.smooth = patch;
        }
        let (triangles, whole) = polygon::triangles(&points);
        if !whole {
            let text = "a polygon that crosses itself, or has too many corners, is cut into a fan";
            self.job.note(At::Line(line), text);
        }
        self.run.add(&points, &normals, &triangles);
        Ok(())
    }

    /// Makes a solid of the polygons that came.
    fn end_run(&mut self) -> Result<(), ImportError> {
        let Run { mesh, corners: _, smooth: _ } = std::mem::take(&mut self.run);
        if mesh.triangles.is_empty() {
            return Ok(());
        }
        let name = format!("faces {}", self.scene.solids.len() + 1);
        let shape = self.job.mesh_of(&name, &mesh)?;
        self.add("faces", shape);
        Ok(())
    }
}

impl Run {
    fn add(&mut self, points: &[DVec3], normals: &[DVec3], triangles: &[[u32; 3]]) {
        let Run { mesh, corners, smooth: _ } = self;
        let index: Vec<u32> = points
            .iter()
            .map(|point| {
                // 0 and -0 are one place.
                let bits = (*point + DVec3::ZERO).to_array().map(f64::to_bits);
                *corners.entry(bits).or_insert_with(|| {
                    mesh.positions.push(*point);
                    mesh.positions.len() as u32 - 1
                })
            })
            .collect();
        let first_normal = mesh.normals.len() as u32;
        mesh.normals.extend(normals);
        for triangle in triangles {
            mesh.triangles.push(triangle.map(|k| index[k as usize]));
            if !normals.is_empty() {
                mesh.triangle_normals.push(triangle.map(|k| first_normal + k));
            }
        }
    }
}
