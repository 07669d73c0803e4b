//! Pictures of other scenes from the trees that are there: looks, and what a comparison shows.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Shader;
use crate::film::sheet::reduced;
use crate::scene::Scene;
use crate::session::Session;
use crate::session::live::{Glance, Glimpse};

/// How long edits must have rested before small pictures are made; large ones are waited for.
const REST: Duration = Duration::from_millis(150);

/// What is wanted, and what is known of it.
#[derive(Default)]
pub(in crate::session::live) struct Glances {
    wanted: Vec<Glance>,
    known: Vec<Glimpse>,
    /// Per wanted glance whether its cost is that of the present scene.
    fresh: Vec<bool>,
    edited: Option<Instant>,
}

impl Glances {
    /// Names what is wanted; what is known of the same scenes stays.
    fn watch(&mut self, wanted: Vec<Glance>) {
        self.known.retain(|known| wanted.iter().any(|glance| known.is_of(glance)));
        self.fresh = vec![false; wanted.len()];
        self.wanted = wanted;
    }

    /// The picture shown is another one: pictures stay, what they cost may not.
    pub(super) fn renew(&mut self) {
        self.fresh.fill(false);
        self.edited = Some(Instant::now());
    }

    /// The next to be looked at, and how long until then.
    fn next(&self) -> Option<(usize, Duration)> {
        let rested = self.edited.map_or(REST, |edited| edited.elapsed());
        let stale =
            self.wanted.iter().zip(&self.fresh).enumerate().filter(|(_, (_, fresh))| !*fresh);
        let waits = stale.map(|(i, (glance, _))| {
            let wait =
                if glance.smaller > 1 { REST.saturating_sub(rested) } else { Duration::ZERO };
            (i, wait)
        });
        waits.min_by_key(|(i, wait)| (*wait, *i))
    }

    /// How long until there is something to do.
    pub(super) fn wait(&self) -> Option<Duration> {
        self.next().map(|(_, wait)| wait)
    }
}

impl Shader {
    pub(super) fn watch_glances(&mut self, wanted: Vec<Glance>) {
        self.glances.watch(wanted);
        self.board.glimpse(self.glances.known.clone());
    }

    /// Makes one picture, if there is one to make and the picture shown is whole.
    pub(super) fn glance(&mut self) {
        if !self.in_step() {
            return;
        }
        let Some((index, Duration::ZERO)) = self.glances.next() else { return };
        let glance = self.glances.wanted[index].clone();
        let Some(whole) = self.whole.as_mut() else { return };
        let present = whole.shared_scene();
        let class = whole.class_of(&glance.scene);
        let old = self.glances.known.iter().position(|known| known.is_of(&glance));
        let old = old.map(|old| self.glances.known.swap_remove(old));
        let frame = match old.and_then(|known| known.frame) {
            Some(frame) => Some(frame),
            None => picture(whole, &glance, &present),
        };
        let stays = Arc::ptr_eq(&whole.shared_scene(), &present);
        let Glance { scene, smaller } = glance;
        self.glances.known.push(Glimpse { scene, smaller, frame, class });
        self.glances.fresh[index] = true;
        self.board.glimpse(self.glances.known.clone());
        self.board.wake();
        // The trees that gave the picture shown give it again; if not, it is traced.
        if !stays {
            self.settle(Instant::now());
        }
    }

    /// How long until there is a picture to be made; nothing is waited for while that must wait.
    pub(super) fn glance_wait(&self) -> Option<Duration> {
        self.glances.wait().filter(|_| self.in_step())
    }
}

/// The picture of another scene, if shading is enough for it; the session then shows `present` again.
fn picture(
    whole: &mut Session,
    glance: &Glance,
    present: &Arc<Scene>,
) -> Option<Arc<crate::film::Frame>> {
    whole.edit_without_rays(&glance.scene).ok()?;
    whole.catch_up();
    let frame = match glance.smaller {
        0 | 1 => whole.shared_frame(),
        smaller => Arc::new(reduced(whole.frame(), smaller)),
    };
    // Whether it worked shows in the session's scene.
    let _ = whole.edit_without_rays(present);
    Some(frame)
}
