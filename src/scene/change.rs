//! What an edit touches, found by comparing two scenes field by field.
//!
//! Every struct is destructured without `..`: a new field does not compile until its cost is decided.

use std::sync::Arc;

use super::model::{Model, Peak};
use super::{
    Background, Bump, Camera, Light, LightPlace, Material, Paint, Picture, Placement, Scene, Shape,
    Solid, Trace,
};

/// What differs between two scenes, by consequence. The frontier of the kept trees, which a scene
/// does not know, may still turn `terms` into more work: `session` asks it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// The first parameter found that asks for more than shading, if any: trees are grown again.
    pub moves_rays: Option<&'static str>,
    /// Whether all trees are.
    pub everything: bool,
    /// Whether what differs is in the compiled geometry's hierarchy: solids.
    pub geometry: bool,
    /// Whether it is in the rest of the compiled geometry: the solids' materials, and where their
    /// colours fall.
    pub surfaces: bool,
    /// Materials of the old scene whose surfaces are to be read again, in the trees that show them
    /// or pass light through them.
    pub nodes: Vec<u16>,
    /// Whether what rays that leave the scene see is to be read again.
    pub sky: bool,
    /// Whether all surfaces are to be read again because of a light: it is new, or elsewhere.
    pub shadows: bool,
    /// Whether reading again may cast rays.
    pub casts: bool,
    /// Per light of the new scene the light of the old one to which shadow rays are the same.
    pub lights: Vec<Option<u16>>,
    /// Per light of the new scene whether its coefficients are others.
    pub relit: Vec<bool>,
    /// Per material of the new scene that of the old one.
    pub materials: Vec<Option<u16>>,
    /// Whether any index of refraction differs.
    iors: bool,
    /// Whether any lobe that blurs differs.
    lobes: bool,
    /// Materials of the new scene whose highlight has another peak: their coefficients are folded
    /// again.
    pub refold: Vec<u16>,
    /// A factor may have another value, or the rule of liveness another limit.
    pub terms: bool,
    /// Among them a factor of the seen path, or a limit of liveness: branches may come alive.
    pub branches: bool,
    /// Only how the sum is shown differs: exposure, tone.
    pub develop: bool,
}

impl Change {
    /// Compares two scenes. Names count only where there are more or fewer lights or materials: then
    /// they tell which ones are the same.
    pub fn between(old: &Scene, new: &Scene) -> Change {
        let mut change = Change::default();
        // What the worn look does is in the values; the others do nothing.
        let Scene {
            ambient_light,
            picture,
            camera,
            background,
            trace,
            lights,
            materials,
            solids,
            looks: _,
        } = old;
        change.term(*ambient_light != new.ambient_light);
        change.picture(picture, &new.picture);
        change.camera(camera, &new.camera);
        // A shutter before which nothing moves may stay open as long as it will.
        change.form(old.shutter_time() != new.shutter_time(), "camera.shutter");
        change.background(background, &new.background);
        change.trace(trace, &new.trace);
        // What is cut off by geometry is not in the terms.
        let other_cutoff = trace.cutoff != new.trace.cutoff;
        for (material, before) in materials.iter().zip(0..).filter(|_| other_cutoff) {
            change.node(material.weighs_branches(), before, "trace.cutoff");
            change.casts |= material.weighs_branches() && new.trace.cutoff < trace.cutoff;
        }
        change.form(solids.len() != new.solids.len(), "the number of solids");
        // Rays from within something clear begin with it.
        let around = old.clear_around_the_eye() != new.clear_around_the_eye();
        change.ray(around, "what the eye is in");
        change.lights(lights, &new.lights);
        change.materials = matched(materials, &new.materials, |m| &m.name);
        for (i, material) in new.materials.iter().enumerate() {
            if let Some(before) = change.materials[i] {
                change.material(i, before, &materials[before as usize], material);
            }
        }
        if change.iors {
            change.refraction(old, new);
        }
        if change.lobes {
            change.blur(old, new);
        }
        change.surfaces |= !change.keeps_materials() || materials.len() != new.materials.len();
        for (a, b) in solids.iter().zip(&new.solids) {
            change.solid(a, b);
            change.assigned(a, materials.get(a.material), b, new.materials.get(b.material));
        }
        change.nodes.sort_unstable();
        change.nodes.dedup();
        change
    }

    /// Compares indices of refraction, where they matter.
    fn refraction(&mut self, old: &Scene, new: &Scene) {
        for (i, material) in new.materials.iter().enumerate() {
            let Some(before) = self.materials[i] else { continue };
            let at = usize::from(before);
            let differs = old.materials[at].ior != material.ior;
            let shows = differs && (old.ior_matters(at) || new.ior_matters(i));
            self.node(shows, before, "ior");
            self.casts |= shows && (!material.transmit.is_black() || material.weighs_branches());
        }
    }

    /// Compares lobes that blur, where they show.
    fn blur(&mut self, old: &Scene, new: &Scene) {
        for (i, material) in new.materials.iter().enumerate() {
            let Some(before) = self.materials[i] else { continue };
            let was = old.materials[usize::from(before)].lobes();
            let shown = material.lobes_matter();
            for (k, what) in ["gloss", "translucency"].into_iter().enumerate() {
                let shows = shown[k] && was[k] != material.lobes()[k];
                self.node(shows, before, what);
                self.casts |= shows;
            }
        }
    }

    /// Whether every material of the new scene has its index of the old one.
    pub fn keeps_materials(&self) -> bool {
        self.materials.iter().zip(0..).all(|(&before, new)| before == Some(new))
    }

    fn lights(&mut self, old: &[Light], new: &[Light]) {
        self.lights = matched(old, new, |light| &light.name);
        for (i, light) in new.iter().enumerate() {
            let same = match self.lights[i] {
                Some(before) => self.light(&old[before as usize], light),
                None => {
                    self.shadow(true, "a light");
                    Rays::Other
                }
            };
            if same == Rays::Other {
                self.lights[i] = None;
            }
            self.relit.push(same != Rays::Same);
        }
        // What a light that is gone lit is as black as if it were off.
        self.term(old.len() != new.len());
    }

    fn shadow(&mut self, differs: bool, what: &'static str) {
        self.part(differs, what);
        self.shadows |= differs;
        self.casts |= differs;
    }

    /// Notes what moves rays of some trees.
    fn part(&mut self, differs: bool, what: &'static str) {
        if differs && self.moves_rays.is_none() {
            self.moves_rays = Some(what);
        }
    }

    /// Notes that surfaces of an old material are to be read again.
    fn node(&mut self, differs: bool, material: u16, what: &'static str) {
        self.part(differs, what);
        if differs {
            self.nodes.push(material);
        }
    }

    fn ray(&mut self, differs: bool, what: &'static str) {
        self.part(differs, what);
        self.everything |= differs;
    }

    fn form(&mut self, differs: bool, what: &'static str) {
        self.ray(differs, what);
        self.geometry |= differs;
    }

    fn term(&mut self, differs: bool) {
        self.terms |= differs;
    }

    /// Notes what makes branches live or die.
    fn limit(&mut self, differs: bool) {
        self.term(differs);
        self.branches |= differs;
    }

    fn picture(&mut self, old: &Picture, new: &Picture) {
        let Picture { size, exposure, tone } = old;
        self.ray(*size != new.size, "picture.size");
        self.develop |= *exposure != new.exposure || *tone != new.tone;
    }

    fn camera(&mut self, old: &Camera, new: &Camera) {
        let Camera { eye, target, up, lens, aperture, focus, shutter: _ } = old;
        self.ray(*eye != new.eye, "camera.eye");
        self.ray(*target != new.target, "camera.target");
        self.ray(*up != new.up, "camera.up");
        self.ray(*lens != new.lens, "the camera's lens");
        self.ray(*aperture != new.aperture, "camera.aperture");
        // A pinhole has no focus.
        let focus = *focus != new.focus && old.opening() != new.opening();
        self.ray(focus, "camera.focus");
    }

    /// Where its colours fall follows from the directions of the kept rays.
    fn background(&mut self, old: &Background, new: &Background) {
        use Background::{Color, Gradient, Image};
        let mut moved = false;
        match (old, new) {
            (Color(a), Color(b)) => self.term(a != b),
            (
                Gradient { below, level, above, up },
                Gradient { below: below2, level: level2, above: above2, up: up2 },
            ) => {
                self.term(below != below2 || level != level2 || above != above2);
                moved = up != up2;
            }
            (
                Image { image, tint, turn_degrees },
                Image { image: image2, tint: tint2, turn_degrees: turn2 },
            ) => {
                self.term(tint != tint2);
                moved = turn_degrees != turn2 || image.image != image2.image;
            }
            _ => moved = true,
        }
        self.part(moved, "the background");
        self.sky |= moved;
        self.surfaces |= moved;
    }

    /// Depth and cut-off are limits of the rule of liveness: lowering what is seen costs nothing,
    /// raising it meets the frontier.
    fn trace(&mut self, old: &Trace, new: &Trace) {
        let Trace { samples, depth, cutoff, filter, adaptive, refine } = old;
        let is_off = !old.is_adaptive() && !new.is_adaptive();
        self.ray(*adaptive != new.adaptive && !is_off, "trace.adaptive");
        self.ray(*refine != new.refine && !is_off, "trace.refine");
        self.ray(*samples != new.samples, "trace.samples");
        self.ray(*filter != new.filter, "trace.filter");
        self.limit(*depth != new.depth || *cutoff != new.cutoff);
    }

    /// Gives what becomes of its shadow rays.
    fn light(&mut self, old: &Light, new: &Light) -> Rays {
        let Light { name: _, color, intensity, on, falloff, samples: _, place } = old;
        self.term(*color != new.color || *intensity != new.intensity || *on != new.on);
        self.term(*falloff != new.falloff && old.falls_off());
        let moved = match (place, &new.place) {
            (LightPlace::Point(a), LightPlace::Point(b)) => (a != b).then_some("a light's point"),
            (LightPlace::Direction(a), LightPlace::Direction(b)) => {
                (a != b).then_some("a light's direction")
            }
            (LightPlace::Spot { at: a, .. }, LightPlace::Spot { at: b, .. }) => {
                (a != b).then_some("a light's spot")
            }
            (LightPlace::Area(a), LightPlace::Area(b)) => (a != b).then_some("a light's area"),
            _ => Some("a light's place"),
        };
        let resampled = (old.rays() != new.rays()).then_some("a light's samples");
        if let Some(what) = moved.or(resampled) {
            self.shadow(true, what);
            return Rays::Other;
        }
        // A cone weighs the rays within it, and lets some be cast that were outside.
        let other_cone = *place != new.place;
        self.shadow(other_cone, "a light's cone");
        let other_law = old.falls_off() != new.falls_off();
        self.part(other_law, "a light's falloff");
        self.shadows |= other_law;
        if other_cone || other_law { Rays::Weighed } else { Rays::Same }
    }

    fn material(&mut self, index: usize, before: u16, old: &Material, new: &Material) {
        let Material {
            name: _,
            paint,
            bump,
            kloc,
            ambient,
            diffuse,
            model,
            specular,
            shininess: _,
            roughness: _,
            metallic,
            emission,
            reflect,
            transmit,
            filter,
            ior,
            priority,
            fresnel: _,
            gloss: _,
            translucency: _,
            // Mass is not seen.
            density: _,
        } = old;
        self.ray(*priority != new.priority, "priority");
        self.paint(before, paint, &new.paint);
        self.bump(before, bump, new);
        let local = *kloc != new.kloc || *ambient != new.ambient || *diffuse != new.diffuse;
        let gloss = *specular != new.specular || *metallic != new.metallic;
        self.term(local || gloss || *emission != new.emission);
        let path = *reflect != new.reflect || *transmit != new.transmit || *filter != new.filter;
        self.limit(path);
        // `shininess` and `roughness`: only the one that the model heeds shapes its peak. Hall's model
        // has Fresnel's weights, whatever `fresnel` says.
        if *model == new.model && Peak::of(old) != Peak::of(new) {
            self.refold.push(index as u16);
        }
        self.node(*model != new.model, before, "model");
        self.node(old.weighs_branches() != new.weighs_branches(), before, "fresnel");
        let branches = !new.reflect.is_black() || !new.transmit.is_black();
        // Fresnel takes light from branches; without it more of them are worth following.
        self.casts |= branches && old.weighs_branches() && !new.weighs_branches();
        // Hall's model shows lights behind what transmits.
        let hall = *model != Model::Hall && new.model == Model::Hall;
        self.casts |= hall && !new.transmit.is_black();
        self.iors |= *ior != new.ior;
        self.lobes |= old.lobes() != new.lobes();
    }

    /// Where colours fall is a function of the kept points.
    fn paint(&mut self, before: u16, old: &Paint, new: &Paint) {
        use Paint::{Checker, Gradient, Image, Marble, Solid, Wood};
        let moved = match (old, new) {
            (Solid(a), Solid(b)) => {
                self.term(a != b);
                None
            }
            (Checker { a, b, size }, Checker { a: a2, b: b2, size: size2 }) => {
                self.term(a != a2 || b != b2);
                (size != size2).then_some("texture.checker.size")
            }
            (Gradient { a, b, from, to }, Gradient { a: a2, b: b2, from: from2, to: to2 }) => {
                self.term(a != a2 || b != b2);
                (from != from2 || to != to2).then_some("texture.gradient")
            }
            (Marble { a, b, size, direction, turbulence }, Marble { a: a2, b: b2, .. }) => {
                self.term(a != a2 || b != b2);
                let moved = *new
                    != Marble {
                        a: *a2,
                        b: *b2,
                        size: *size,
                        direction: *direction,
                        turbulence: *turbulence,
                    };
                moved.then_some("texture.marble")
            }
            (Wood { a, b, size, center, axis, turbulence }, Wood { a: a2, b: b2, .. }) => {
                self.term(a != a2 || b != b2);
                let moved = *new
                    != Wood {
                        a: *a2,
                        b: *b2,
                        size: *size,
                        center: *center,
                        axis: *axis,
                        turbulence: *turbulence,
                    };
                moved.then_some("texture.wood")
            }
            (Image { image, tint, size }, Image { image: image2, tint: tint2, size: size2 }) => {
                self.term(tint != tint2);
                let moved = size != size2 || image.image != image2.image;
                moved.then_some("texture.image")
            }
            _ => Some("the kind of texture"),
        };
        if let Some(what) = moved {
            self.node(true, before, what);
            self.surfaces = true;
        }
    }

    /// A bump bends the shading normal: of what neither reflects nor transmits no ray goes on by it.
    fn bump(&mut self, before: u16, old: &Bump, new: &Material) {
        let differs = !old.bends_like(&new.bump);
        self.node(differs, before, "bump");
        self.surfaces |= differs;
        self.casts |= differs && (!new.reflect.is_black() || !new.transmit.is_black());
    }

    /// Compares what a solid is made of.
    fn assigned(
        &mut self,
        old: &Solid,
        old_material: Option<&Material>,
        new: &Solid,
        new_material: Option<&Material>,
    ) {
        if new.shape.is_composite() {
            return;
        }
        let before = old.material as u16;
        let differs = self.materials.get(new.material) != Some(&Some(before));
        let ranks = old_material.zip(new_material).is_some_and(|(a, b)| a.priority != b.priority);
        self.ray(differs && ranks, "a solid's priority");
        self.node(differs, before, "a solid's material");
        self.surfaces |= differs;
        let alike = old_material.zip(new_material).is_some_and(|(a, b)| a.leads_rays_like(b));
        self.casts |= differs && !alike;
    }

    fn solid(&mut self, old: &Solid, new: &Solid) {
        let Solid { name: _, shape, material: _, placement, motion } = old;
        // A mesh that is shared is not compared vertex by vertex.
        let same_mesh = match (shape, &new.shape) {
            (Shape::Mesh { mesh: a, .. }, Shape::Mesh { mesh: b, .. }) => Arc::ptr_eq(a, b),
            _ => false,
        };
        self.form(!same_mesh && *shape != new.shape, "a solid's shape");
        let Placement { translate, rotate_degrees, scale } = placement;
        self.form(*translate != new.placement.translate, "translate");
        self.form(*rotate_degrees != new.placement.rotate_degrees, "rotate_degrees");
        self.form(*scale != new.placement.scale, "scale");
        self.form(*motion != new.motion, "motion");
    }
}

/// What becomes of the shadow rays to a light.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rays {
    /// They are cast anew.
    Other,
    /// What is known of them stands, but they weigh otherwise, or more of them are cast.
    Weighed,
    /// They stay as they are.
    Same,
}

/// Per new thing the old one that it is: the one at the same place in a list as long as the old one,
/// the next one of the same name in another.
fn matched<T>(old: &[T], new: &[T], name: impl Fn(&T) -> &str) -> Vec<Option<u16>> {
    if old.len() == new.len() {
        return (0..).map(Some).take(new.len()).collect();
    }
    let mut from = 0;
    let find = |thing: &T| {
        let at = from + old[from..].iter().position(|o| name(o) == name(thing))?;
        from = at + 1;
        Some(at as u16)
    };
    new.iter().map(find).collect()
}

impl Material {
    /// Whether the rays of the seen path and shadow rays go on from it as from `other`.
    fn leads_rays_like(&self, other: &Material) -> bool {
        let Material {
            name: _,
            paint: _,
            bump,
            kloc: _,
            ambient: _,
            diffuse: _,
            model,
            specular: _,
            shininess: _,
            roughness: _,
            metallic: _,
            emission: _,
            reflect,
            transmit,
            filter,
            ior,
            priority,
            fresnel: _,
            gloss,
            translucency,
            density: _,
        } = self;
        let path = (reflect, transmit, filter, ior, priority);
        let lobes = [*gloss, *translucency];
        let hall = |model| model == Model::Hall;
        let goes_on = !reflect.is_black() || !transmit.is_black();
        path == (&other.reflect, &other.transmit, &other.filter, &other.ior, &other.priority)
            && lobes == other.lobes()
            && (!goes_on || bump.bends_like(&other.bump))
            && self.weighs_branches() == other.weighs_branches()
            && hall(*model) == hall(other.model)
    }
}
