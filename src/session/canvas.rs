//! The picture as shown, drawn into memory that nobody else looks at.

use std::sync::Arc;

use crate::film::Frame;
use crate::film::layout::Layout;
use crate::shade::cpu::Tiles;

/// The newest frame, shared with those who show it. A frame that someone still holds is never
/// written: the next one takes the memory of the one before it, once that is free.
#[derive(Default)]
pub(super) struct Canvas {
    newest: Arc<Frame>,
    spare: Option<Arc<Frame>>,
    /// Per tile whether the newest frame still lacks it.
    owed: Vec<bool>,
    /// Whether drawing waits until somebody asks for the frame.
    pub(super) waits: bool,
}

impl Canvas {
    /// A black picture.
    pub(super) fn new(size: [u32; 2]) -> Canvas {
        let owed = vec![false; Layout::new(size).tiles()];
        Canvas { newest: Arc::new(Frame::new(size)), spare: None, owed, waits: false }
    }

    /// The newest frame.
    pub(super) fn newest(&self) -> &Arc<Frame> {
        &self.newest
    }

    /// Notes that these tiles are to be drawn.
    pub(super) fn owe(&mut self, tiles: Tiles) {
        self.owed.iter_mut().enumerate().for_each(|(tile, owed)| *owed |= tiles.has(tile));
    }

    /// Whether the newest frame lacks tiles.
    pub(super) fn owes(&self) -> bool {
        self.owed.contains(&true)
    }

    /// The tiles that the newest frame lacks, which the caller draws.
    pub(super) fn take_owed(&mut self) -> Vec<bool> {
        let none = vec![false; self.owed.len()];
        std::mem::replace(&mut self.owed, none)
    }

    /// The newest frame, to be changed.
    pub(super) fn edit(&mut self) -> &mut Frame {
        if Arc::get_mut(&mut self.newest).is_none() {
            let mut next = self.spare.take().unwrap_or_default();
            let frame = Arc::make_mut(&mut next);
            frame.size = self.newest.size;
            frame.bytes.clone_from(&self.newest.bytes);
            self.spare = Some(std::mem::replace(&mut self.newest, next));
        }
        Arc::make_mut(&mut self.newest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_is_held_keeps_its_bytes_and_memory_is_used_again() {
        let mut canvas = Canvas::new([2, 1]);
        let alone = Arc::as_ptr(canvas.newest());
        canvas.edit().bytes[0] = 1;
        assert_eq!(Arc::as_ptr(canvas.newest()), alone, "nobody looked");
        let held = canvas.newest().clone();
        canvas.edit().bytes[1] = 2;
        assert_eq!((&held.bytes[..2], &canvas.newest().bytes[..2]), (&[1, 0][..], &[1, 2][..]));
        drop(held);
        let second = canvas.newest().clone();
        canvas.edit().bytes[2] = 3;
        assert_eq!(Arc::as_ptr(canvas.newest()), alone, "the first memory was free");
        assert_eq!((second.bytes[2], &canvas.newest().bytes[..3]), (0, &[1, 2, 3][..]));
    }

    #[test]
    fn what_is_owed_adds_up_until_it_is_taken() {
        let mut canvas = Canvas::new([64, 32]);
        assert!(!canvas.owes());
        canvas.owe(Tiles::Marked(&[false, true]));
        canvas.owe(Tiles::Marked(&[false, false]));
        assert!(canvas.owes());
        assert_eq!(canvas.take_owed(), [false, true]);
        assert!(!canvas.owes());
        canvas.owe(Tiles::All);
        assert_eq!(canvas.take_owed(), [true, true]);
    }
}
