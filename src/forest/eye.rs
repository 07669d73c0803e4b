//! Camera rays of scenes whose samples have more than a place in their pixel: filter, lens, shutter.

use super::camera::View;
use super::filter::{Reconstruction, Weights};
use super::grow::{Grower, Worker};
use super::sampling::{self, Effect, ROOT_PATH, Sample};
use super::sink::Sink;
use crate::geometry::{Ray, Stack};
use crate::scene::Scene;
use crate::scene::filter::Filter;
use crate::scene::motion::Opening;

/// Filter, lens and shutter of a scene that uses at least one of them.
pub(super) struct Eye {
    samples: u32,
    filter: Reconstruction,
    /// The lens, unless it is a pinhole.
    opening: Option<Opening>,
    /// When the shutter closes, if anything moves.
    shutter: Option<f64>,
}

impl Eye {
    /// That of a scene; `None` if all of it is as simple as can be.
    pub(super) fn of(scene: &Scene) -> Option<Eye> {
        let (opening, shutter) = (scene.camera.opening(), scene.shutter_time());
        let (filter, samples) = (scene.trace.filter, scene.trace.samples);
        let simple = filter == Filter::Box && opening.is_none() && shutter.is_none();
        let filter = || Reconstruction::new(filter);
        (!simple).then(|| Eye { samples, filter: filter(), opening, shutter })
    }

    /// The weights of a pixel's samples.
    fn weights(&self, pixel: [u32; 2], samples: u32) -> Weights {
        self.filter.weights(pixel, samples)
    }

    /// The ray of a sample, whose time the stack is set to and whose weight the sink is told. The
    /// only sample of a pixel is in the middle of everything.
    #[inline(never)]
    fn ray<K: Sink>(
        &self,
        view: &View,
        at: Sample,
        (weights, share): (Weights, Option<f32>),
        stack: &mut Stack,
        sink: &mut K,
    ) -> Ray {
        let Eye { samples, filter, opening, shutter } = self;
        let numbers = |effect| match samples {
            1 => [0.5; 2],
            _ => at.numbers(effect, ROOT_PATH),
        };
        let (place, negative) = filter.place(numbers(Effect::Position));
        match (filter.is_signed(), share) {
            (true, share) => sink.weigh(weights.of(negative) * share.unwrap_or(1.0)),
            (false, Some(share)) => sink.weigh(share),
            (false, None) => {}
        }
        if let Some(shutter) = shutter {
            stack.set_time(shutter * numbers(Effect::Time)[0]);
        }
        let [x, y] = [0, 1].map(|i| f64::from(at.pixel[i]) + place[i]);
        match opening {
            None => view.ray(x, y),
            Some(opening) => view.ray_through_lens([x, y], *opening, numbers(Effect::Lens)),
        }
    }
}

/// What is the same for all samples of a pixel.
#[derive(Clone, Copy)]
pub(super) struct PixelEye<'a> {
    eye: Option<(&'a Eye, Weights)>,
    /// All samples over those that the pixel has, where sampling is adaptive.
    share: Option<f32>,
}

impl PixelEye<'_> {
    /// Whether samples have no weights of their own, no time and no place on a lens.
    #[inline(always)]
    pub(super) fn is_plain(self) -> bool {
        self.eye.is_none() && self.share.is_none()
    }
}

impl Grower<'_> {
    /// The eye for a pixel that has `count` samples.
    #[inline(always)]
    pub(super) fn pixel_eye(&self, pixel: [u32; 2], count: u32) -> PixelEye<'_> {
        let eye = self.eye.as_ref().map(|eye| (eye, eye.weights(pixel, count)));
        let share = self.map.is_some().then(|| self.samples as f32 / count as f32);
        PixelEye { eye, share }
    }

    /// The ray of a sample; its time is the worker's from now on, and the sink knows its weight.
    #[inline(always)]
    pub(super) fn eye_ray<K: Sink>(
        &self,
        PixelEye { eye, share }: PixelEye<'_>,
        at: Sample,
        worker: &mut Worker,
        sink: &mut K,
    ) -> Ray {
        match eye {
            None => {
                if let Some(share) = share {
                    sink.weigh(share);
                }
                let [x, y] = at.pixel.map(f64::from);
                let [u, v] = sampling::in_pixel(at.pixel, at.index, self.samples);
                self.view.ray(x + u, y + v)
            }
            Some((eye, weights)) => {
                eye.ray(&self.view, at, (weights, share), &mut worker.stack, sink)
            }
        }
    }
}
