//! The whole picture on a graphics card, beside that of the processor.

use std::sync::Arc;

use super::Shader;
use crate::film::develop::Development;
use crate::session::Session;
use crate::session::live::{Event, guarded};
use crate::shade::gpu::{Gpu, GpuError, Picture, Product};

impl Shader {
    /// Draws whole pictures by a card from now on, or no longer.
    pub(super) fn draw_on(&mut self, gpu: Option<Gpu>) {
        self.product = gpu.map(Product::new);
        self.product.iter_mut().for_each(|product| product.mark_clipped(self.marks));
        self.show();
    }

    /// Whether the processor's picture waits because a card shows it, and edits have rested.
    pub(super) fn may_catch_up(&self) -> bool {
        let owes = self.whole.as_ref().is_some_and(Session::owes_frame);
        owes && self.busy_until.is_none()
    }

    /// Draws the processor's picture, which waited while edits came.
    pub(super) fn catch_up(&mut self) {
        let Some(whole) = self.whole.as_mut().filter(|whole| whole.owes_frame()) else { return };
        whole.catch_up();
        if self.preview.is_none() && self.mending().is_none() {
            self.hand_over(self.on_card.clone());
        }
    }

    /// The whole picture as a card draws it. A card that fails is not asked again: the processor's
    /// picture is there.
    pub(super) fn on_card(&mut self) -> Option<Arc<Picture>> {
        self.on_card = self.drawn_by_card();
        self.on_card.clone()
    }

    fn drawn_by_card(&mut self) -> Option<Arc<Picture>> {
        let (product, whole) = (self.product.as_mut()?, self.whole.as_ref()?);
        let development = Development::of(&whole.scene().picture);
        let (transport, values) = (whole.transport(), &whole.terms().values);
        let cause = match guarded(|| product.frame(transport, values, development)) {
            Ok(Ok(picture)) => return Some(picture),
            Ok(Err(error)) => error,
            Err(text) => GpuError::Failed(text),
        };
        self.product = None;
        if cause.is_lost() {
            // Whoever the card belongs to knows, and says more.
            return None;
        }
        let text = format!("{cause}: the processor draws the picture from now on");
        self.board.tell(Event::Failed(text));
        None
    }
}
