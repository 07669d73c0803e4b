//! A session's picture: drawn at once, or when somebody asks for it.

use super::Session;
use crate::film::develop::Development;
use crate::film::{Film, Frame};
use crate::scene::Scene;
use crate::scene::change::Change;
use crate::shade::cpu::{self, Tiles};
use crate::shade::terms::TermValues;

impl Session {
    /// Draws some tiles, at once or when [`Session::catch_up`] is called.
    pub(super) fn draw(&mut self, tiles: Tiles) {
        self.canvas.owe(tiles);
        if !self.canvas.waits {
            self.catch_up();
        }
    }

    /// Lets drawing wait from now on, or no longer: somebody else shows the picture.
    pub(super) fn defer(&mut self, waits: bool) {
        self.canvas.waits = waits;
    }

    /// Whether the frame waits to be drawn.
    pub(super) fn owes_frame(&self) -> bool {
        self.canvas.owes()
    }

    /// Draws what waits.
    pub(super) fn catch_up(&mut self) {
        if !self.canvas.owes() {
            return;
        }
        let owed = self.canvas.take_owed();
        let development = Development::of(&self.scene.picture);
        let values = &self.terms.values;
        let frame = self.canvas.edit();
        cpu::frame(&self.pool, &self.transport, values, development, Tiles::Marked(&owed), frame);
    }

    /// Draws the present trees as `scene` shows them, as far as they reach: pixels that a plan for it
    /// does not name, and that have no highlight of another exponent, are final.
    pub(super) fn draw_ahead(&self, scene: &Scene, change: &Change, frame: &mut Frame) {
        let mut terms = TermValues::default();
        terms.evaluate(&self.program, &self.factors_ahead(scene, change));
        let development = Development::of(&scene.picture);
        cpu::frame(&self.pool, &self.transport, &terms.values, development, Tiles::All, frame);
    }

    /// Shades every pixel anew, as after an edit that touches everything.
    pub fn redraw(&mut self) {
        self.evaluate_terms();
        self.draw(Tiles::All);
    }

    /// The picture in linear floats, into `film`, whose memory is kept if its size fits.
    pub fn develop_film(&self, film: &mut Film) {
        if film.layout != self.transport.layout {
            *film = Film::new(self.transport.layout);
        }
        cpu::film(&self.pool, &self.transport, &self.terms.values, film);
    }

    /// The picture in linear floats.
    pub fn film(&self) -> Film {
        let mut film = Film::default();
        self.develop_film(&mut film);
        film
    }
}
