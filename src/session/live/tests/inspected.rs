//! Pixels taken apart behind the threads: what is wanted becomes known, follows edits, and goes.

use super::*;
use crate::session::inspect::PixelTree;

impl Window {
    /// The tree of a pixel of the scene wanted last.
    fn tree(&mut self, pixel: [u32; 2], scene: &Scene) -> Arc<PixelTree> {
        let known = |w: &Window| {
            let found = w.live.inspected().get(&pixel)?.clone().ok()?;
            (*found.scene == *scene).then_some(found)
        };
        self.wait("a pixel is taken apart", |w| known(w).is_some());
        known(self).unwrap()
    }
}

#[test]
fn a_wanted_pixel_follows_every_edit_until_it_is_no_longer_wanted() {
    let scene = scene("whitted", [64, 36], 4);
    let mut window = Window::new(OPTIONS);
    let (pixel, other) = ([30, 22], [5, 30]);
    window.live.inspect(vec![pixel, [64, 0]]);
    window.want(&scene);
    let film = fresh(&scene).film();
    assert_eq!(window.tree(pixel, &scene).light, film.pixel(pixel));

    let edited = with(&scene, "materials.tiles.diffuse", "0.2");
    window.want(&edited);
    let tree = window.tree(pixel, &edited);
    assert_eq!(tree.light, fresh(&edited).film().pixel(pixel));
    assert_ne!(tree.light, film.pixel(pixel), "the edit is seen there");

    let lit = with(&edited, "materials.tiles.reflect", "0.4");
    window.want(&lit);
    window.live.inspect(vec![pixel, other]);
    assert_eq!(window.tree(pixel, &lit).light, fresh(&lit).film().pixel(pixel));
    assert_eq!(window.tree(other, &lit).light, fresh(&lit).film().pixel(other));
    assert!(!window.live.inspected().contains_key(&[64, 0]), "there is no such pixel");

    window.live.inspect(vec![other]);
    window.want(&edited);
    window.tree(other, &edited);
    assert!(!window.live.inspected().contains_key(&pixel), "it is forgotten");
}
