//! Marks on what a screen cannot show, if they are wanted.

use std::sync::Arc;

use super::{Preview, Shader};
use crate::film::clipping::mark;
use crate::film::develop::Development;
use crate::session::live::Marked;

impl Shader {
    /// Marks clipped pixels in what is shown from now on, or no longer.
    pub(super) fn mark_clipped(&mut self, on: bool) {
        self.marks = on;
        if let Some(product) = &mut self.product {
            product.mark_clipped(on);
        }
        self.show();
    }

    /// What is shown, with marks, if they are wanted.
    pub(super) fn marked(&mut self) -> Option<Marked> {
        let shown = self.preview.as_ref().map(|p| &p.session).or(self.whole.as_ref());
        let session = shown.filter(|_| self.marks)?;
        session.develop_film(&mut self.film);
        let plain = session.shared_frame();
        let frame = self.preview.as_ref().map_or(plain, Preview::frame);
        let mut frame = Arc::unwrap_or_clone(frame);
        let development = Development::of(&session.scene().picture);
        let clipped = mark(&self.film, development, &mut frame);
        Some(Marked { frame: Arc::new(frame), clipped })
    }
}
