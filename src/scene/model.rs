//! Illumination models: how a material's highlights spread, and what of that needs no ray.

use super::Material;
use super::slot::Choice;

/// The formula of a material's highlights (`model`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// `specular · (R·V)^shininess`.
    #[default]
    Phong,
    /// `specular · (N·H)^shininess`.
    Blinn,
    /// `specular · π·D·F·G / (4 N·V)` with Beckmann's distribution of slope `roughness`.
    CookTorrance,
    /// `specular · F(V·H) · (N·H)^shininess`; mirror and refracted ray weighted by Fresnel; a
    /// transmitting material also shows lights behind it, as `specular · (1−F) · (T·L)^shininess`.
    Hall,
}

impl Model {
    /// All of them, in the order of their names.
    pub const ALL: [Model; 4] = [Model::Phong, Model::Blinn, Model::CookTorrance, Model::Hall];
    /// As written in a scene file.
    pub const NAMES: &'static [&'static str] = &["phong", "blinn", "cook_torrance", "hall"];
}

impl Choice for Model {
    fn names(&self) -> &'static [&'static str] {
        Model::NAMES
    }

    fn chosen(&self) -> usize {
        *self as usize
    }

    fn choose(&mut self, index: usize) {
        *self = Model::ALL[index];
    }
}

/// How narrow and how high the highlights of a material are: all of them that changes without rays.
///
/// A highlight's coefficient is `scale · Σ weight · 2^(exponent · l)`, where `weight` and `l` are
/// geometry: l is the log2 of a cosine, or −tan² α · log2 e.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// > 0 makes it narrow; ≥ 0.
    pub exponent: f32,
    /// Factor of the whole.
    pub scale: f32,
    /// What the kept angles are.
    pub measure: Measure,
}

/// What the angle of a highlight is kept as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// 1 − cos β, of which a power is taken.
    Cosine,
    /// tan² α, for Beckmann's distribution.
    Tangent,
}

impl Peak {
    /// That of a material.
    pub fn of(material: &Material) -> Peak {
        match material.model {
            Model::Phong | Model::Blinn | Model::Hall => {
                Peak { exponent: material.shininess, scale: 1.0, measure: Measure::Cosine }
            }
            Model::CookTorrance => {
                let slope = 1.0 / (material.roughness * material.roughness);
                Peak { exponent: slope, scale: slope, measure: Measure::Tangent }
            }
        }
    }
}

/// Exponents of the lobes of mirror and refracted rays, 0 for a sharp one.
pub type Lobes = [f32; 2];

impl Material {
    /// Whether mirror and refracted ray are weighted by Fresnel's reflectance.
    pub fn weighs_branches(&self) -> bool {
        self.fresnel || self.model == Model::Hall
    }

    /// Exponents of the lobes of its mirror and its refracted ray, 0 where it is sharp.
    pub fn lobes(&self) -> Lobes {
        [self.gloss, self.translucency]
    }

    /// Which of its [`Material::lobes`] show: a black material sends no ray that they could blur.
    pub fn lobes_matter(&self) -> [bool; 2] {
        let [reflects, transmits] = [self.reflect, self.transmit].map(|share| !share.is_black());
        // Total reflection shows what is neither mirrored nor transmitted otherwise.
        [reflects || transmits, transmits]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_chooses_its_model() {
        let mut model = Model::default();
        for (index, expected) in Model::ALL.into_iter().enumerate() {
            model.choose(index);
            assert_eq!((model, model.chosen()), (expected, index));
        }
        assert_eq!(Model::NAMES.len(), Model::ALL.len());
    }

    #[test]
    fn only_the_model_s_own_parameter_shapes_its_peak() {
        let with = |model, shininess, roughness| {
            Peak::of(&Material { model, shininess, roughness, ..Material::new("m") })
        };
        for model in Model::ALL {
            let tangent = model == Model::CookTorrance;
            assert_eq!(with(model, 3.0, 0.5) == with(model, 4.0, 0.5), tangent, "{model:?}");
            assert_eq!(with(model, 3.0, 0.5) == with(model, 3.0, 0.25), !tangent, "{model:?}");
        }
        assert_eq!(with(Model::CookTorrance, 3.0, 0.5).exponent, 4.0);
    }
}
