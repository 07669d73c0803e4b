//! The part of the picture that the person works on: traced before the rest.

use std::sync::Arc;

use super::{Preview, Running, Shader};
use crate::film::Frame;
use crate::film::layout::{Layout, TILE};
use crate::film::plates::Region;
use crate::session::live::Stage;

impl Shader {
    /// Traces another part first from now on. Who draws a region while everything is traced does not want
    /// to wait for that: it begins anew, unless most of it is done.
    pub(super) fn look_first(&mut self, region: Option<Region>) {
        let is_new = region.is_some() && region != self.region;
        self.region = region;
        let is_early = |job: &Running| {
            let (done, all) = job.control.progress.steps();
            job.mending.is_none() && job.is_trace() && 2 * done < all
        };
        self.job.iter_mut().filter(|job| is_new && is_early(job)).for_each(Running::drop_it);
    }
}

impl Preview {
    /// The picture. Beside the region, if only that was traced, it is the one before, if there is one.
    pub(super) fn frame(&self) -> Arc<Frame> {
        let frame = self.session.shared_frame();
        let (Stage::Region, Some(behind)) = (self.stage, &self.behind) else { return frame };
        let mut composed = Frame::clone(&frame);
        let coarse = behind.session.frame();
        let columns = Layout::new(frame.size).grid()[0];
        let [width, height] = frame.size;
        for y in 0..height {
            for x in 0..width {
                let tile = (y / TILE) as usize * columns + (x / TILE) as usize;
                if self.session.transport().tiles[tile].terms.is_empty() {
                    let [w, h] = coarse.size;
                    let at = (y as usize * width as usize + x as usize) * 4;
                    let pixel = coarse.pixel([x * w / width, y * h / height]);
                    composed.bytes[at..at + 4].copy_from_slice(&pixel);
                }
            }
        }
        Arc::new(composed)
    }
}
