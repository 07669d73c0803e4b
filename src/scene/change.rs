//! What an edit touches, found by comparing two scenes field by field.
//!
//! Every struct is destructured without `..`: a new field does not compile until its cost is decided.

use std::sync::Arc;

use super::model::Peak;
use super::{
    Background, Camera, Light, LightPlace, Material, Paint, Picture, Placement, Scene, Shape,
    Solid, Trace,
};

/// What differs between two scenes, by consequence. The frontier of the kept trees, which a scene
/// does not know, may still turn `terms` into more work: `session` asks it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// The first parameter found that moves rays, if any: everything is traced again.
    pub moves_rays: Option<&'static str>,
    /// Whether what moves rays is in the compiled geometry: solids, and where their colours fall.
    pub geometry: bool,
    /// Materials whose highlight has another peak: their coefficients are folded again.
    pub refold: Vec<u16>,
    /// A factor may have another value, or the rule of liveness another limit.
    pub terms: bool,
    /// Only how the sum is shown differs: exposure.
    pub develop: bool,
}

impl Change {
    /// Compares two scenes. Names never count.
    pub fn between(old: &Scene, new: &Scene) -> Change {
        let mut change = Change::default();
        let Scene { ambient_light, picture, camera, background, trace, lights, materials, solids } =
            old;
        change.term(*ambient_light != new.ambient_light);
        change.picture(picture, &new.picture);
        change.camera(camera, &new.camera);
        let Background { color } = background;
        change.term(*color != new.background.color);
        change.trace(trace, &new.trace);
        let weighs = |s: &Scene| s.materials.iter().any(Material::weighs_branches);
        let other_cutoff = trace.cutoff != new.trace.cutoff;
        // What is cut off by geometry is not in the terms.
        change.ray(other_cutoff && (weighs(old) || weighs(new)), "trace.cutoff");
        change.ray(lights.len() != new.lights.len(), "the number of lights");
        change.form(materials.len() != new.materials.len(), "the number of materials");
        change.form(solids.len() != new.solids.len(), "the number of solids");
        for (a, b) in lights.iter().zip(&new.lights) {
            change.light(a, b);
        }
        for (i, (a, b)) in materials.iter().zip(&new.materials).enumerate() {
            change.material(i, a, b);
        }
        for (a, b) in solids.iter().zip(&new.solids) {
            change.solid(a, b);
        }
        change
    }

    fn ray(&mut self, differs: bool, what: &'static str) {
        if differs && self.moves_rays.is_none() {
            self.moves_rays = Some(what);
        }
    }

    fn form(&mut self, differs: bool, what: &'static str) {
        self.ray(differs, what);
        self.geometry |= differs;
    }

    fn term(&mut self, differs: bool) {
        self.terms |= differs;
    }

    fn picture(&mut self, old: &Picture, new: &Picture) {
        let Picture { size, exposure } = old;
        self.ray(*size != new.size, "picture.size");
        self.develop |= *exposure != new.exposure;
    }

    fn camera(&mut self, old: &Camera, new: &Camera) {
        let Camera { eye, target, up, lens } = old;
        self.ray(*eye != new.eye, "camera.eye");
        self.ray(*target != new.target, "camera.target");
        self.ray(*up != new.up, "camera.up");
        self.ray(*lens != new.lens, "the camera's lens");
    }

    /// Depth and cut-off are limits of the rule of liveness: lowering what is seen costs nothing,
    /// raising it meets the frontier.
    fn trace(&mut self, old: &Trace, new: &Trace) {
        let Trace { samples, depth, cutoff } = old;
        self.ray(*samples != new.samples, "trace.samples");
        self.term(*depth != new.depth || *cutoff != new.cutoff);
    }

    fn light(&mut self, old: &Light, new: &Light) {
        let Light { name: _, color, intensity, on, place } = old;
        self.term(*color != new.color || *intensity != new.intensity || *on != new.on);
        match (place, &new.place) {
            (LightPlace::Point(a), LightPlace::Point(b)) => self.ray(a != b, "a light's point"),
            (LightPlace::Direction(a), LightPlace::Direction(b)) => {
                self.ray(a != b, "a light's direction");
            }
            _ => self.ray(true, "a light's place"),
        }
    }

    fn material(&mut self, index: usize, old: &Material, new: &Material) {
        let Material {
            name: _,
            paint,
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
            fresnel,
        } = old;
        self.paint(paint, &new.paint);
        let local = *kloc != new.kloc || *ambient != new.ambient || *diffuse != new.diffuse;
        let gloss = *specular != new.specular || *metallic != new.metallic;
        self.term(local || gloss || *emission != new.emission);
        let path = *reflect != new.reflect || *transmit != new.transmit || *filter != new.filter;
        self.term(path);
        // `shininess` and `roughness`: only the one that the model heeds shapes its peak.
        if *model == new.model && Peak::of(old) != Peak::of(new) {
            self.refold.push(index as u16);
        }
        self.ray(*model != new.model, "model");
        self.ray(*ior != new.ior, "ior");
        self.ray(*fresnel != new.fresnel, "fresnel");
    }

    fn paint(&mut self, old: &Paint, new: &Paint) {
        match (old, new) {
            (Paint::Solid(a), Paint::Solid(b)) => self.term(a != b),
            (Paint::Checker { a, b, size }, Paint::Checker { a: a2, b: b2, size: size2 }) => {
                self.term(a != a2 || b != b2);
                self.form(size != size2, "texture.checker.size");
            }
            _ => self.form(true, "the kind of texture"),
        }
    }

    fn solid(&mut self, old: &Solid, new: &Solid) {
        let Solid { name: _, shape, material, placement } = old;
        // A mesh that is shared is not compared vertex by vertex.
        let same_mesh = match (shape, &new.shape) {
            (Shape::Mesh { mesh: a, .. }, Shape::Mesh { mesh: b, .. }) => Arc::ptr_eq(a, b),
            _ => false,
        };
        self.form(!same_mesh && *shape != new.shape, "a solid's shape");
        self.form(*material != new.material, "a solid's material");
        let Placement { translate, rotate_degrees, scale } = placement;
        self.form(*translate != new.placement.translate, "translate");
        self.form(*rotate_degrees != new.placement.rotate_degrees, "rotate_degrees");
        self.form(*scale != new.placement.scale, "scale");
    }
}
