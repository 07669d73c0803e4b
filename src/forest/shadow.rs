//! What the lights show of themselves at a point: their shadow rays and records.

use fearless_simd::Simd;
use glam::DVec3;

use super::grow::{Grower, MOST_CROSSED, Stop, Worker};
use super::kept::{Met, Recalled};
use super::lamp::{Aim, Beam};
use super::lobe::{self, Lit, Lobe};
use super::search::Sought;
use super::sequence::Sequence;
use super::sink::Sink;
use super::surface::Surface;
use super::tree::LightHit;
use crate::geometry::Interaction;
use crate::scene::model::Model;

/// A node that is lit.
pub(super) struct Site<'a> {
    pub(super) at: &'a Interaction,
    pub(super) surface: &'a Surface,
    /// The hash of the path that leads to it.
    pub(super) path: u32,
    /// The lists of solids in front of and behind it.
    pub(super) media: [u32; 2],
    /// Whether other surfaces coincide with it.
    pub(super) touching: bool,
}

/// How a light's ray reaches a surface.
#[derive(Clone, Copy, PartialEq)]
enum Reach {
    /// From the front.
    Front,
    /// From behind, where this is what shines through.
    Behind(Lobe),
}

impl Grower<'_> {
    /// Sends the shadow rays from a node to a light, of which `recalled` knows what they met before.
    ///
    /// Every ray to the light's front has a record. Of a light with several rays so have those in
    /// between that have nothing to show, so that the record j is of ray j; none of them has if none
    /// has anything to show.
    #[inline(always)]
    pub(super) fn light<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        site: &Site<'_>,
        light: usize,
        recalled: &mut Option<Recalled<'_>>,
        sink: &mut K,
    ) -> Result<(), Stop> {
        let (lamp, key, light) = (&self.lamps[light], self.keys[light], light as u16);
        let aim = lamp.aim(site.at.point);
        let points = match aim {
            Aim::Sharp(_) => Sequence::default(),
            Aim::Spread(_) => Sequence::of_lights(worker.sample, site.path),
        };
        let first = worker.sample.index * lamp.rays;
        let (mut begun, mut known) = (false, true);
        let mut ray = 0;
        loop {
            // Either all of its rays are known or none.
            let met = recalled.as_mut().filter(|_| known).and_then(|r| r.light(key));
            known = met.is_some();
            let beam = match &aim {
                Aim::Sharp(beam) => *beam,
                Aim::Spread(spread) => spread.beam(points.point(first + ray)),
            };
            if let Some(reach) = self.reach(site, &beam) {
                if !begun {
                    (0..ray).for_each(|_| sink.light(LightHit::idle(light), &[]));
                    begun = true;
                }
                self.ray(simd, worker, site, (light, &beam, reach), met, sink)?;
            } else if begun {
                sink.light(LightHit::idle(light), &[]);
            }
            ray += 1;
            if ray >= lamp.rays {
                return Ok(());
            }
        }
    }

    /// Whether a light's ray is in front of the geometric surface, or shines through it.
    #[inline(always)]
    fn reach(&self, site: &Site<'_>, beam: &Beam) -> Option<Reach> {
        if beam.weight == 0.0 {
            return None;
        }
        if site.surface.geometric.dot(beam.to_light) > 0.0 {
            return Some(Reach::Front);
        }
        let behind = self.behind(site.at.material, site.surface, beam.to_light);
        (behind != Lobe::NONE).then_some(Reach::Behind(behind))
    }

    /// What a light that shines onto the surface from behind shows of itself: none without Hall.
    #[inline(always)]
    fn behind(&self, material: u16, surface: &Surface, to_light: DVec3) -> Lobe {
        let is_behind = surface.geometric.dot(to_light) < 0.0;
        match self.models[material as usize] {
            Model::Hall if is_behind => surface.refracted().map_or(Lobe::NONE, |through| {
                let cosine = surface.normal.dot(surface.to_eye).min(1.0);
                lobe::transmitted(through, to_light, (cosine, surface.contrast))
            }),
            _ => Lobe::NONE,
        }
    }

    /// Sends a shadow ray, unless `met` still stands. Where nothing passes, the surface's own solid
    /// is what stops a light behind it.
    #[inline(always)]
    fn ray<S: Simd, K: Sink>(
        &self,
        simd: S,
        worker: &mut Worker,
        site: &Site<'_>,
        (light, beam, reach): (u16, &Beam, Reach),
        met: Option<Met<'_>>,
        sink: &mut K,
    ) -> Result<(), Stop> {
        let Site { at, surface, path: _, media, touching: _ } = site;
        let stopped = LightHit::stopped(light);
        if reach != Reach::Front && self.opaque[at.solid as usize] {
            sink.light(stopped, &[at.solid]);
            return Ok(());
        }
        let blocker = match met {
            Some(Met::Blocker(solid)) if self.opaque[solid as usize] => Some(solid),
            Some(Met::Crossed(solids)) => {
                worker.crossed.clear();
                worker.crossed.extend_from_slice(solids);
                None
            }
            _ => {
                let medium = media[usize::from(reach != Reach::Front)];
                self.cast_shadow(simd, worker, site, medium, beam)
            }
        };
        if let Some(solid) = blocker {
            sink.light(stopped, &[solid]);
            return Ok(());
        }
        let crossed = &mut worker.crossed;
        if crossed.len() > MOST_CROSSED {
            return Err(Stop::Surfaces);
        }
        crossed.sort_unstable();
        let to_light = beam.to_light;
        let (n_dot_l, Lobe { angle, weight }) = match reach {
            Reach::Front => {
                let lit = Lit { normal: surface.normal, to_eye: surface.to_eye, to_light };
                let model = self.models[at.material as usize];
                let lobe = lobe::highlight(model, &lit, surface.contrast);
                let softening = surface.softening(to_light);
                let n_dot_l = (surface.normal.dot(to_light) * softening) as f32;
                (n_dot_l, Lobe { weight: lobe.weight * softening as f32, ..lobe })
            }
            Reach::Behind(lobe) => (0.0, lobe),
        };
        let (n_dot_l, weight) = (n_dot_l * beam.weight, weight * beam.weight);
        let crossings = crossed.len() as u16;
        sink.light(LightHit { light, crossed: crossings, n_dot_l, angle, weight }, crossed);
        Ok(())
    }

    /// The opaque solid between a point and a light, or, if there is none, all solids crossed, in
    /// `worker.crossed`.
    #[inline(always)]
    fn cast_shadow<S: Simd>(
        &self,
        simd: S,
        worker: &mut Worker,
        site: &Site<'_>,
        medium: u32,
        beam: &Beam,
    ) -> Option<u32> {
        worker.rays.shadow += 1;
        let (ray, leaving) = self.geometry.spawn(site.at, beam.to_light);
        if site.touching || !self.priorities.is_empty() {
            let (t_max, touching) = (beam.distance, site.touching);
            let sought = Sought { ray: &ray, leaving: Some(leaving), t_max, touching, medium };
            return self.search_shadow(simd, worker, sought);
        }
        let Worker { stack, crossed, .. } = worker;
        self.geometry.occluded(
            simd,
            stack,
            &ray,
            beam.distance,
            Some(leaving),
            &self.opaque,
            crossed,
        )
    }
}
