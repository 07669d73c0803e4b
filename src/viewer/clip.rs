//! Marks on pixels that the screen cannot show, and how many they are.

use super::app::App;
use crate::film::clipping::Clipped;

impl App {
    /// Marks clipped pixels from now on, or no longer.
    pub(super) fn toggle_clipping(&mut self) {
        self.clipping = !self.clipping;
        self.live.mark_clipped(self.clipping);
    }

    /// How many pixels of the picture shown are clipped, if they are marked.
    pub(super) fn clipped(&self) -> Option<Clipped> {
        let marked = self.shown.as_ref()?.marked.as_ref();
        marked.filter(|_| self.clipping).map(|marked| marked.clipped)
    }
}

/// What the status line says of clipped pixels.
pub(super) fn clipped_text(Clipped { over, under, of }: Clipped) -> String {
    let share = |count: u64| match count as f64 / of.max(1) as f64 * 100.0 {
        0.0 => "0 %".to_owned(),
        percent if percent < 0.01 => "< 0.01 %".to_owned(),
        percent if percent < 10.0 => format!("{percent:.2} %"),
        percent => format!("{percent:.0} %"),
    };
    match under {
        0 => format!("clipped {}", share(over)),
        _ => format!("clipped {}, {} dark", share(over), share(under)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_told_in_few_digits() {
        let text = |over, under| clipped_text(Clipped { over, under, of: 100_000 });
        assert_eq!(text(0, 0), "clipped 0 %");
        assert_eq!(text(1, 0), "clipped < 0.01 %");
        assert_eq!(text(1234, 50), "clipped 1.23 %, 0.05 % dark");
        assert_eq!(text(43_210, 0), "clipped 43 %");
        assert_eq!(clipped_text(Clipped::default()), "clipped 0 %", "no picture");
    }
}
