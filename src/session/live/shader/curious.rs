//! Pixels that are taken apart, one by one, while nothing else is to be done.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use super::Shader;
use crate::session::live::Inspected;
use crate::session::trace::TraceError;

/// What is known of the pixels that the window asks for, and what is still to be asked.
#[derive(Default)]
pub(super) struct Curiosity {
    wanted: Vec<[u32; 2]>,
    open: VecDeque<[u32; 2]>,
    known: BTreeMap<[u32; 2], Inspected>,
}

impl Curiosity {
    /// Names the pixels. What is known of others is forgotten.
    pub(super) fn want(&mut self, pixels: Vec<[u32; 2]>) {
        self.known.retain(|pixel, _| pixels.contains(pixel));
        self.open = pixels.iter().copied().filter(|p| !self.known.contains_key(p)).collect();
        self.wanted = pixels;
    }

    /// The picture shows another scene now. What was known of the one before stays until it is
    /// known again.
    pub(super) fn renew(&mut self) {
        self.open = self.wanted.iter().copied().collect();
    }
}

impl Shader {
    /// How long until there is a pixel to be taken apart.
    pub(super) fn curious_wait(&self) -> Option<Duration> {
        (!self.curious.open.is_empty() && self.in_step()).then_some(Duration::ZERO)
    }

    /// Takes one pixel apart, if one is wanted and the picture is whole. A wish interrupts it.
    pub(super) fn work_on_pixels(&mut self) {
        if self.curious_wait().is_none() {
            return;
        }
        let (Some(whole), Some(pixel)) = (&self.whole, self.curious.open.pop_front()) else {
            return;
        };
        let [width, height] = whole.scene().picture.size;
        if pixel[0] >= width || pixel[1] >= height {
            self.curious.known.remove(&pixel);
            return;
        }
        let progress = self.board.begin_inspection();
        match whole.inspect(pixel, &progress) {
            Err(TraceError::Cancelled) => self.curious.open.push_front(pixel),
            found => {
                let found = found.map(Arc::new).map_err(|error| error.to_string());
                self.curious.known.insert(pixel, found);
                self.board.show_pixels(self.curious.known.clone());
            }
        }
    }
}
