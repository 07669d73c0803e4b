//! Materials that give back more light than they get, which facing surfaces multiply.

use super::{Material, Scene};
use crate::color::Rgb;

/// A sum of coefficients may exceed 1 by this, the rounding of a few `f32`.
const ROUNDING: f32 = 1e-5;

/// A material whose `kloc·(ambient + diffuse) + reflect + transmit` exceeds 1 in a channel;
/// with Fresnel's weights the larger of the last two counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Overbright {
    /// Index into `Scene::materials`.
    pub material: usize,
    /// The sum, per channel.
    pub sum: Rgb,
}

impl Overbright {
    /// The same as one sentence.
    pub fn sentence(&self, scene: &Scene) -> String {
        let Overbright { material, sum: Rgb([r, g, b]) } = self;
        format!(
            "material {}: kloc·(ambient + diffuse) + reflect + transmit is [{r:.2}, {g:.2}, \
             {b:.2}], above 1: it gives back more light than it gets",
            scene.materials[*material].name
        )
    }
}

/// Every material of a scene that gives back more than it gets.
pub fn overbright(scene: &Scene) -> Vec<Overbright> {
    let sums = scene.materials.iter().map(returned).enumerate();
    let above = sums.filter(|(_, sum)| sum.max_channel() > 1.0 + ROUNDING);
    above.map(|(material, sum)| Overbright { material, sum }).collect()
}

fn returned(material: &Material) -> Rgb {
    let local = material.kloc * (material.ambient + material.diffuse);
    if material.weighs_branches() {
        // F·reflect + (1 − F)·transmit is between the two.
        local + Rgb(std::array::from_fn(|c| material.reflect.0[c].max(material.transmit.0[c])))
    } else {
        local + material.reflect + material.transmit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_above_one_in_any_channel_is_found() {
        let mut scene = Scene { materials: vec![Material::new("a")], ..Scene::default() };
        assert_eq!(overbright(&scene), []);
        scene.materials[0].reflect = Rgb([0.2, 0.1, 0.25]);
        let found = overbright(&scene);
        assert_eq!(found.len(), 1);
        assert!((found[0].sum.0[2] - 1.05).abs() < 1e-6);
        scene.materials[0].transmit = Rgb::grey(0.24);
        assert!((overbright(&scene)[0].sum.0[2] - 1.29).abs() < 1e-6);
        scene.materials[0].fresnel = true;
        assert!((overbright(&scene)[0].sum.0[2] - 1.05).abs() < 1e-6);
        scene.materials[0].transmit = Rgb::BLACK;
        scene.materials[0].kloc = Rgb::grey(0.5);
        assert_eq!(overbright(&scene), []);
    }
}
