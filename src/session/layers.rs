//! Parts of a picture's light: columns of the matrix, chosen by light, material or bounce.

use super::Session;
use crate::film::Film;
use crate::film::plates::{Layer, Plates, Region};
use crate::fold::trie::{Marks, ROOT};
use crate::scene::factor::Kind;
use crate::shade::cpu;

/// What else than the picture a file shall hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// How much of each pixel is covered; the background that the eye sees is then left out.
    pub alpha: bool,
    /// A layer per light, per material and per bounce.
    pub layers: bool,
    /// A part of the picture alone.
    pub region: Option<Region>,
}

/// Why a picture cannot be taken apart: the cause, and a way out.
pub type LayersError = String;

/// Where a term belongs.
#[derive(Clone, Copy)]
struct Place {
    /// Reflections and refractions before the surface that is lit, or before the background.
    bounce: usize,
    source: Source,
    /// Index of the material that is lit.
    material: Option<usize>,
}

/// Which terms are in a layer.
type Chosen = Box<dyn Fn(&Place) -> bool>;

/// What a term's light comes from.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    /// Index in the matrix.
    Light(usize),
    /// Ambient light and what surfaces give off themselves.
    Ambient,
    Background,
}

impl Session {
    /// The picture with what else is wanted. Layers of one kind add up to it, but for rounding: those
    /// by light with `light.ambient` and `light.background`, by material (the one that is lit, also
    /// where it is seen in mirrors) with `material.background`, by bounce with all of them. Layers
    /// without a term are left out.
    pub fn plates(&self, extras: Extras) -> Result<Plates, LayersError> {
        let Extras { alpha, layers, region } = extras;
        region.map_or(Ok(()), |region| region.check(self.transport.layout.size))?;
        let places = self.places();
        let mut plates = Plates::of(self.film());
        if layers {
            plates.layers = self.all_layers(&places)?;
        }
        if alpha {
            plates.coverage = Some(self.coverage(&places)?);
            plates.film = self.selected(|id| !is_behind(&places[id]));
        }
        Ok(match region {
            Some(region) => plates.cropped(region),
            None => plates,
        })
    }

    /// Per term where it belongs.
    fn places(&self) -> Vec<Place> {
        let nodes = self.transport.trie.nodes();
        let start = Place { bounce: 0, source: Source::Background, material: None };
        let mut places: Vec<Place> = Vec::with_capacity(nodes.len());
        for (id, node) in nodes.iter().enumerate() {
            let mut place = if id == 0 { start } else { places[node.parent as usize] };
            let factor = node.factor;
            match factor.kind() {
                _ if id as u32 == ROOT => {}
                Kind::Background => place.source = Source::Background,
                Kind::Reflect | Kind::Transmit | Kind::TotalReflect => place.bounce += 1,
                Kind::Ambient => {
                    (place.source, place.material) = (Source::Ambient, Some(factor.index()));
                }
                Kind::Diffuse | Kind::Specular | Kind::Through => {
                    place.material = Some(factor.index());
                }
                Kind::Light => place.source = Source::Light(factor.index()),
                Kind::Shadow | Kind::Channel => {}
            }
            places.push(place);
        }
        places
    }

    /// The light of some terms.
    fn selected(&self, is_chosen: impl Fn(usize) -> bool) -> Film {
        let values = self.terms.values.iter().enumerate();
        let values: Vec<[f32; 4]> =
            values.map(|(id, value)| if is_chosen(id) { *value } else { [0.0; 4] }).collect();
        self.film_of(&values)
    }

    fn film_of(&self, values: &[[f32; 4]]) -> Film {
        let mut film = Film::new(self.transport.layout);
        cpu::film(&self.pool, &self.transport, values, &mut film);
        film
    }

    fn all_layers(&self, places: &[Place]) -> Result<Vec<Layer>, LayersError> {
        let mut groups: Vec<(String, Chosen)> = Vec::new();
        for (i, light) in self.scene.lights.iter().enumerate() {
            let index = usize::from(self.names.lights[i]);
            let source = Source::Light(index);
            groups.push((named("light", &light.name), Box::new(move |p| p.source == source)));
        }
        for (name, source) in [("ambient", Source::Ambient), ("background", Source::Background)] {
            groups.push((format!("light.{name}"), Box::new(move |p| p.source == source)));
        }
        for (i, material) in self.scene.materials.iter().enumerate() {
            let name = named("material", &material.name);
            groups.push((name, Box::new(move |p| p.material == Some(i))));
        }
        let none = Box::new(|p: &Place| p.material.is_none());
        groups.push(("material.background".to_owned(), none));
        let deepest = places.iter().map(|place| place.bounce).max().unwrap_or(0);
        for bounce in 0..=deepest {
            groups.push((format!("bounce.{bounce}"), Box::new(move |p| p.bounce == bounce)));
        }
        let nodes = self.transport.trie.nodes();
        let is_term = |id: usize| nodes[id].marks.has(Marks::TERM);
        groups.retain(|(_, of)| places.iter().enumerate().any(|(id, p)| is_term(id) && of(p)));
        self.check_room(groups.len())?;
        let mut layers: Vec<Layer> = Vec::new();
        for (name, of) in groups {
            let film = self.selected(|id| of(&places[id]));
            let taken = |name: &str| layers.iter().any(|layer| layer.name == name);
            let numbered = (2..).map(|number| format!("{name}_{number}"));
            let name = std::iter::once(name.clone()).chain(numbered).find(|name| !taken(name));
            layers.extend(name.map(|name| Layer { name, film }));
        }
        Ok(layers)
    }

    /// Whether so many pictures fit into the memory that the session may use.
    fn check_room(&self, layers: usize) -> Result<(), LayersError> {
        let [width, height] = self.transport.layout.size.map(u64::from);
        // As films, and as the channels of the file.
        let bytes = layers as u64 * width * height * 24;
        if bytes <= self.options.memory {
            return Ok(());
        }
        let gigabytes = bytes as f64 / 1e9;
        Err(format!(
            "{layers} layers of this size take {gigabytes:.1} GB, more than the memory allowed\n  \
             help: export them at a smaller size, or a region of the picture"
        ))
    }

    /// How much of each pixel is not background.
    fn coverage(&self, places: &[Place]) -> Result<Film, LayersError> {
        let nodes = self.transport.trie.nodes();
        let is_texel = |id: usize| nodes[id].factor.kind() == Kind::Channel;
        let behind = || (1..nodes.len()).filter(|&id| is_behind(&places[id]));
        if behind().any(is_texel) {
            return Err(
                "alpha needs a background of colours: how much of a pixel an image covers is \
                        not in its light\n  help: set background.color before the export"
                    .to_owned(),
            );
        }
        let mut values = vec![[0.0; 4]; nodes.len()];
        behind().for_each(|id| values[id] = [1.0; 4]);
        let mut film = self.film_of(&values);
        for block in &mut film.blocks {
            block.0.iter_mut().flatten().for_each(|seen| *seen = 1.0 - *seen);
        }
        Ok(film)
    }
}

/// Whether a term is background that the eye sees directly.
fn is_behind(place: &Place) -> bool {
    place.bounce == 0 && place.source == Source::Background
}

/// A layer's name that every reader of EXR takes: letters and digits alone behind the one dot.
fn named(kind: &str, name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    format!("{kind}.{name}")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::color::Rgb;
    use crate::progress::Progress;
    use crate::scene::read;
    use crate::session::Options;

    const TEXT: &str = "version = 1\n[picture]\nsize = [40, 24]\n[trace]\nsamples = 4\n\
        [background]\ncolor = [0.1, 0.2, 0.4]\n[lights.key]\npoint = [-4, -5, 7]\n\
        [lights.'a.b']\ndirection = [0, 1, -1]\n[materials.mirror]\nreflect = 0.5\nspecular = 0.5\n\
        [materials.glass]\ntransmit = 0.8\nreflect = 0.1\n[materials.unused]\n\
        [solids.a]\nsphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"mirror\"\n\
        [solids.b]\nsphere = { center = [1, -2, 0], radius = 0.5 }\nmaterial = \"glass\"\n";

    fn session(text: &str) -> Session {
        let scene = read::text(text, Path::new("s.toml")).unwrap();
        Session::open(scene, Options { threads: 1, memory: 1 << 28 }, &Progress::default()).unwrap()
    }

    /// Largest difference between a picture and the sum of the layers of a kind, as a share of the
    /// picture's largest value.
    fn gap(plates: &Plates, kind: &str) -> f32 {
        let (mut most, mut gap) = (0.0f32, 0.0f32);
        let [width, height] = plates.film.layout.size;
        for pixel in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
            let layers = plates.layers.iter().filter(|layer| layer.name.starts_with(kind));
            let mut sum = Rgb::BLACK;
            layers.for_each(|layer| {
                let light = layer.film.pixel(pixel).0;
                sum = Rgb(std::array::from_fn(|i| sum.0[i] + light[i]));
            });
            for (sum, whole) in sum.0.into_iter().zip(plates.film.pixel(pixel).0) {
                (most, gap) = (most.max(whole), gap.max((sum - whole).abs()));
            }
        }
        assert!(most > 0.5, "the picture is not black");
        gap / most
    }

    #[test]
    fn the_layers_of_every_kind_add_up_to_the_picture() {
        let mut session = session(TEXT);
        for turn in 0..2 {
            let extras = Extras { layers: true, ..Extras::default() };
            let mut plates = session.plates(extras).unwrap();
            let names: Vec<&str> = plates.layers.iter().map(|layer| &*layer.name).collect();
            for name in ["light.key", "light.ambient", "light.background", "material.mirror"] {
                assert!(names.contains(&name), "{names:?}");
            }
            assert_eq!(names.contains(&"light.a_b"), turn == 0, "{names:?}");
            assert!(names.contains(&"bounce.1") && !names.contains(&"material.unused"));
            for kind in ["light.", "material.", "bounce."] {
                let gap = gap(&plates, kind);
                assert!(gap < 1e-5, "{kind} {gap}");
            }
            // Without one of them they do not.
            let mirror = plates.layers.iter().position(|l| l.name == "material.mirror").unwrap();
            plates.layers.remove(mirror);
            assert!(gap(&plates, "material.") > 0.1);
            let mut scene = session.scene().clone();
            scene.lights.truncate(1);
            scene.materials[0].diffuse = Rgb([0.3, 0.6, 0.9]);
            session.edit(scene, &Progress::default()).unwrap();
        }
    }

    #[test]
    fn a_transparent_picture_over_its_background_is_the_picture() {
        let session = session(TEXT);
        let plates = session.plates(Extras { alpha: true, ..Extras::default() }).unwrap();
        let film = session.film();
        let mut partly = 0;
        for pixel in (0..24).flat_map(|y| (0..40).map(move |x| [x, y])) {
            let alpha = plates.alpha(pixel);
            partly += u32::from(alpha > 0.0 && alpha < 1.0);
            let over = plates.film.pixel(pixel).0.into_iter().zip([0.1, 0.2, 0.4]);
            for ((light, behind), whole) in over.zip(film.pixel(pixel).0) {
                let sum = light + (1.0 - alpha) * behind;
                assert!((sum - whole).abs() < 1e-6 * whole.max(1.0), "{pixel:?} {sum} {whole}");
            }
        }
        assert!(partly > 20, "edges are partly covered: {partly}");
        assert_eq!(plates.alpha([0, 0]), 0.0);
        assert_eq!(plates.alpha([20, 11]), 1.0);
    }

    #[test]
    fn a_region_is_cut_out_and_one_outside_is_refused() {
        let session = session(TEXT);
        let region = |corner| Some(Region { corner, size: [10, 5] });
        let cut = |corner| session.plates(Extras { region: region(corner), ..Extras::default() });
        let part = cut([7, 9]).unwrap().film;
        assert_eq!(part.pixel([9, 4]), session.film().pixel([16, 13]));
        assert!(cut([31, 0]).unwrap_err().contains("40×24"));
    }
}
