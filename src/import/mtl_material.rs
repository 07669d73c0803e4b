//! What an MTL material becomes here: every statement is mapped, or remarked upon.

use std::path::Path;

use super::job::Job;
use super::mtl::{Description, Statement, texture};
use super::place::{At, ImportError, Place};
use super::words::Word;
use crate::color::Rgb;
use crate::scene::model::Model;
use crate::scene::range::Range;
use crate::scene::{Bump, Material, Paint, fields};

/// Height of white over black of a `bump` with the factor 1, which has no unit of length.
const BUMP_HEIGHT: f64 = 0.02;

/// The statements of a material, as far as they have a place here.
struct Parts {
    ambient: Option<Rgb>,
    diffuse: Option<Rgb>,
    specular: Option<Rgb>,
    emission: Option<Rgb>,
    filter: Option<Rgb>,
    shininess: Option<f64>,
    ior: Option<f64>,
    /// `d`, with the line.
    opacity: Option<(f64, usize)>,
    /// `Tr`, with the line.
    transparency: Option<(f64, usize)>,
    illumination: Option<u32>,
    metallic: Option<f64>,
    paint: Option<Paint>,
    bump: Bump,
}

/// The material of a description, under another name if that is taken.
pub(super) fn material(
    job: &mut Job<'_>,
    file: &Path,
    description: &Description<'_>,
    name: String,
) -> Result<Material, ImportError> {
    let mut parts = Parts {
        ambient: None,
        diffuse: None,
        specular: None,
        emission: None,
        filter: None,
        shininess: None,
        ior: None,
        opacity: None,
        transparency: None,
        illumination: None,
        metallic: None,
        paint: None,
        bump: Bump::None,
    };
    let mut reader = Reader { job, file };
    for statement in &description.statements {
        reader.statement(&mut parts, statement)?;
    }
    let opacity = reader.opacity(&parts);
    let mut material = Material { name, ..Material::new("") };
    local(&mut material, &parts);
    reader.illumination(&mut material, &parts, opacity, description.line);
    Ok(material)
}

/// Colours and highlight.
fn local(material: &mut Material, parts: &Parts) {
    let diffuse = parts.diffuse.unwrap_or(Rgb::grey(0.8));
    // Kd = color · diffuse: the hue is the colour's, the strength the coefficient's.
    let strength = if diffuse.is_black() { 1.0 } else { diffuse.max_channel() };
    let color = diffuse.map(|x| x / strength);
    let ambient = parts.ambient.unwrap_or(Rgb::BLACK);
    // Ka = color · ambient, where the colour leaves room for it.
    let fits = (0..3).all(|c| ambient.0[c] == 0.0 || color.0[c] >= 0.1);
    if fits && !diffuse.is_black() {
        material.paint = Paint::Solid(color);
        material.diffuse = Rgb::grey(strength);
        let share = |c: usize| if ambient.0[c] == 0.0 { 0.0 } else { ambient.0[c] / color.0[c] };
        material.ambient = Rgb(std::array::from_fn(share));
    } else {
        material.paint = Paint::Solid(Rgb::WHITE);
        material.diffuse = diffuse;
        material.ambient = ambient;
    }
    if let Some(Paint::Image { image, tint: _, size }) = &parts.paint {
        let tint = match &material.paint {
            Paint::Solid(color) => *color,
            _ => Rgb::WHITE,
        };
        material.paint = Paint::Image { image: image.clone(), tint, size: *size };
    }
    material.bump = parts.bump.clone();
    material.model = Model::Blinn;
    material.specular = parts.specular.unwrap_or(Rgb::BLACK);
    if let Some(shininess) = parts.shininess {
        material.shininess = shininess as f32;
    }
    material.emission = parts.emission.unwrap_or(Rgb::BLACK);
    material.metallic = parts.metallic.unwrap_or(0.0) as f32;
    material.ior = parts.ior.unwrap_or(1.5);
}

struct Reader<'j, 'a> {
    job: &'j mut Job<'a>,
    file: &'j Path,
}

impl Reader<'_, '_> {
    fn note(&mut self, line: usize, text: impl Into<String>) {
        self.job.note_at(Place::new(self.file, At::Line(line)), text);
    }

    fn statement(&mut self, parts: &mut Parts, s: &Statement<'_>) -> Result<(), ImportError> {
        let words = s.arguments.as_slice();
        match s.key.as_str() {
            "ka" => self.color(s, &mut parts.ambient)?,
            "kd" => self.color(s, &mut parts.diffuse)?,
            "ks" => self.color(s, &mut parts.specular)?,
            "ke" => self.color(s, &mut parts.emission)?,
            "tf" => self.color(s, &mut parts.filter)?,
            "ns" => parts.shininess = Some(self.number(s, words, fields::EXPONENT)?),
            "ni" => parts.ior = Some(self.number(s, words, Range::closed(0.1, 10.0))?),
            "pm" => parts.metallic = Some(self.number(s, words, fields::SHARE)?),
            "d" => parts.opacity = self.dissolve(s)?,
            "tr" => parts.transparency = self.dissolve(s)?,
            "illum" => {
                let model = self.number(s, words, Range::closed(0.0, 10.0))?;
                parts.illumination = Some(model as u32);
            }
            "map_kd" => self.image(parts, s)?,
            "bump" | "map_bump" => self.bump(parts, s)?,
            key => {
                let text = match unmapped(key) {
                    Some(what) => format!("`{}` is left out: {what}", s.written),
                    None => format!("`{}` is left out: it is no statement of MTL", s.written),
                };
                self.note(s.line, text);
            }
        }
        Ok(())
    }

    /// `r [g b]` or `xyz x [y z]`; spectral curves are left out.
    fn color(&mut self, s: &Statement<'_>, slot: &mut Option<Rgb>) -> Result<(), ImportError> {
        let (xyz, words) = match s.arguments.split_first() {
            Some((first, _)) if first.text == "spectral" => {
                let text =
                    format!("`{} spectral` is left out: colours are red, green, blue", s.written);
                self.note(s.line, text);
                return Ok(());
            }
            Some((first, rest)) if first.text == "xyz" => (true, rest),
            _ => (false, s.arguments.as_slice()),
        };
        let given = words.iter().take(3).map(|word| word.number(self.file));
        let given: Vec<f64> = given.collect::<Result<_, _>>()?;
        let rgb = match given[..] {
            [x] => [x; 3],
            [x, y, z] => [x, y, z],
            _ => {
                let place = Place::new(self.file, At::Line(s.line));
                let cause = format!("`{}` needs 1 or 3 numbers, found {}", s.written, given.len());
                return Err(ImportError::new(place, cause, "add the missing numbers"));
            }
        };
        let rgb = if xyz { linear_of_xyz(rgb) } else { rgb };
        let clamped = rgb.map(|x| fields::COEFFICIENT.clamp(x));
        if clamped != rgb {
            self.note(s.line, format!("`{}` is brought into its range, 0 to 1e6", s.written));
        }
        *slot = Some(Rgb(clamped.map(|x| x as f32)));
        Ok(())
    }

    /// The first number of `words`, brought into its range.
    fn number(
        &mut self,
        s: &Statement<'_>,
        words: &[Word<'_>],
        range: Range,
    ) -> Result<f64, ImportError> {
        let Some(word) = words.first() else {
            let cause = format!("`{}` needs a number", s.written);
            let place = Place::new(self.file, At::Line(s.line));
            return Err(ImportError::new(place, cause, "add the number, or take the line out"));
        };
        let x = word.number(self.file)?;
        let inside = range.clamp(x);
        if inside != x {
            let text =
                format!("`{}` is brought into its range, {inside} in place of {x}", s.written);
            self.note(s.line, text);
        }
        Ok(inside)
    }

    /// `d [-halo] x` or `Tr x`.
    fn dissolve(&mut self, s: &Statement<'_>) -> Result<Option<(f64, usize)>, ImportError> {
        let mut words = s.arguments.as_slice();
        if let Some((first, rest)) = words.split_first()
            && first.text == "-halo"
        {
            words = rest;
            self.note(s.line, "`-halo` is left out: transparency is the same from every side");
        }
        Ok(Some((self.number(s, words, fields::SHARE)?, s.line)))
    }

    fn image(&mut self, parts: &mut Parts, s: &Statement<'_>) -> Result<(), ImportError> {
        let texture = texture(&s.arguments, self.file)?;
        let size = self.texture_size(s, &texture);
        let place = Place::new(self.file, At::Line(s.line));
        if let Some(image) = self.job.image(&texture.file, place) {
            parts.paint = Some(Paint::Image { image, tint: Rgb::WHITE, size });
        }
        Ok(())
    }

    fn bump(&mut self, parts: &mut Parts, s: &Statement<'_>) -> Result<(), ImportError> {
        let texture = texture(&s.arguments, self.file)?;
        let size = self.texture_size(s, &texture);
        let place = Place::new(self.file, At::Line(s.line));
        if let Some(image) = self.job.image(&texture.file, place) {
            let height = fields::COORDINATE.clamp(texture.height * BUMP_HEIGHT);
            let text = format!(
                "`{}` has no unit of length: white is {height} higher than black",
                s.written
            );
            self.note(s.line, text);
            parts.bump = Bump::Image { image, height, size };
        }
        Ok(())
    }

    /// What an image covers in u and v; remarks on options that are left out.
    fn texture_size(&mut self, s: &Statement<'_>, texture: &super::mtl::Texture) -> f64 {
        for option in &texture.strange {
            self.note(s.line, format!("the option `{option}` of `{}` is left out", s.written));
        }
        let [u, v] = texture.repeats;
        let size = 1.0 / u;
        if !fields::LENGTH.contains(size) || u != v {
            let text =
                format!("`-s` of `{}` is left out: only equal scales above 0 are kept", s.written);
            self.note(s.line, text);
            return 1.0;
        }
        size
    }

    /// The share of what is local, from `d` and `Tr`.
    fn opacity(&mut self, parts: &Parts) -> f64 {
        match (parts.opacity, parts.transparency) {
            (Some((d, _)), Some((tr, line))) => {
                if (d + tr - 1.0).abs() > 1e-3 {
                    let text =
                        format!("`Tr` is {tr} and `d` is {d}, but 1 - d should be Tr: d counts");
                    self.note(line, text);
                }
                d
            }
            (Some((d, _)), None) => d,
            (None, Some((tr, line))) => {
                let text =
                    format!("`Tr` alone is taken as 1 - d, as it should be: d is {}", 1.0 - tr);
                self.note(line, text);
                1.0 - tr
            }
            (None, None) => 1.0,
        }
    }

    /// Which rays there are, by `illum` and what is transparent.
    fn illumination(&mut self, m: &mut Material, parts: &Parts, opacity: f64, line: usize) {
        let clear = (1.0 - opacity) as f32;
        let model = parts.illumination;
        m.kloc = Rgb::grey(opacity as f32);
        m.transmit = Rgb::grey(clear);
        m.filter = parts.filter.unwrap_or(Rgb::WHITE);
        let mirror = m.specular.map(|x| x.min(1.0));
        match model {
            Some(0) => {
                // Kd alone, whatever the light.
                m.emission = m.emission + parts.diffuse.unwrap_or(Rgb::grey(0.8));
                (m.diffuse, m.ambient, m.specular) = (Rgb::BLACK, Rgb::BLACK, Rgb::BLACK);
            }
            Some(1) => m.specular = Rgb::BLACK,
            Some(3 | 4) => m.reflect = mirror,
            Some(5) => (m.reflect, m.fresnel) = (mirror, true),
            Some(6) => m.reflect = mirror,
            Some(7) => (m.reflect, m.fresnel) = (mirror, true),
            Some(8) => self.note(line, "`illum 8`, reflection without rays, is taken as 2"),
            Some(10) => self.note(line, "`illum 10`, a catcher of shadows, is taken as 2"),
            _ => {}
        }
        let refracts = matches!(model, Some(6 | 7)) || (model.is_none() && parts.ior.is_some());
        if matches!(model, Some(6 | 7)) && clear == 0.0 && parts.filter.is_some() {
            // Glass of these models is given by its filter alone.
            m.transmit = Rgb(m.reflect.0.map(|x| 1.0 - x));
            m.kloc = Rgb::BLACK;
            if m.fresnel {
                m.transmit = Rgb::WHITE;
            }
            self.note(line, "`illum 6` and `7` without `d`: what `Tf` lets through is transparent");
        } else if clear > 0.0 && !refracts {
            if parts.ior.is_some_and(|ior| ior != 1.0) {
                self.note(
                    line,
                    "transparent without refraction, as `illum` says: ior is 1, not `Ni`",
                );
            }
            m.ior = 1.0;
        } else if clear == 0.0 && parts.filter.is_some_and(|filter| filter != Rgb::WHITE) {
            self.note(line, "`Tf` has no effect: the material is opaque");
        }
    }
}

/// Why a known statement has no place in a scene; `None` of one that is not known.
fn unmapped(key: &str) -> Option<&'static str> {
    Some(match key {
        "map_ka" => "the ambient light is multiplied by the colour, and so by map_Kd",
        "map_ks" | "map_ns" | "map_ke" | "map_tf" | "map_ni" => {
            "images colour surfaces and bumps alone"
        }
        "map_d" | "map_tr" => "transparency is the same all over a material",
        "decal" | "disp" => "images colour surfaces and bumps alone",
        "norm" => "bumps are images of heights, not of normals",
        "refl" => "reflections are traced",
        "map_aat" => "antialiasing is the scene's, trace.samples",
        "sharpness" => "reflections are traced and as sharp as `gloss` says",
        "pr" | "ps" | "pc" | "pcr" | "aniso" | "anisor" => "the highlight is given by Ks and Ns",
        "map_pr" | "map_pm" | "map_ps" | "map_pc" | "map_pcr" => {
            "images colour surfaces and bumps alone"
        }
        _ => return None,
    })
}

/// CIE XYZ as linear Rec. 709 (IEC 61966-2-1).
fn linear_of_xyz([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.240_625 * x - 1.537_208 * y - 0.498_629 * z,
        -0.968_931 * x + 1.875_756 * y + 0.041_518 * z,
        0.055_710 * x - 0.204_021 * y + 1.056_996 * z,
    ]
}
