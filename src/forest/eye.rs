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
    pub(super) fn weights(&self, pixel: [u32; 2]) -> Weights {
        self.filter.weights(pixel, self.samples)
    }

    /// The ray of a sample, whose time the stack is set to and whose weight the sink is told. The
    /// only sample of a pixel is in the middle of everything.
    #[inline(never)]
    fn ray<K: Sink>(
        &self,
        view: &View,
        at: Sample,
        weights: Weights,
        stack: &mut Stack,
        sink: &mut K,
    ) -> Ray {
        let Eye { samples, filter, opening, shutter } = self;
        let numbers = |effect| match samples {
            1 => [0.5; 2],
            _ => at.numbers(effect, ROOT_PATH),
        };
        let (place, negative) = filter.place(numbers(Effect::Position));
        if filter.is_signed() {
            sink.weigh(weights.of(negative));
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

impl Grower<'_> {
    /// The ray of a sample; its time is the worker's from now on, and the sink knows its weight.
    #[inline(always)]
    pub(super) fn eye_ray<K: Sink>(
        &self,
        eye: Option<(&Eye, Weights)>,
        at: Sample,
        worker: &mut Worker,
        sink: &mut K,
    ) -> Ray {
        match eye {
            None => {
                let [x, y] = at.pixel.map(f64::from);
                let [u, v] = sampling::in_pixel(at.pixel, at.index, self.samples);
                self.view.ray(x + u, y + v)
            }
            Some((eye, weights)) => eye.ray(&self.view, at, weights, &mut worker.stack, sink),
        }
    }
}
