//! A line of text as a picture, in the font of the window.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::Frame;

/// Height of a line in pixels.
pub const LINE: u32 = 20;

/// What text in SVG is drawn with: the window's font for every family.
///
/// `None` if the font has no name, which it has.
pub fn drawing_options() -> Option<Options<'static>> {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next()?.families.first()?.0.clone();
    fonts.set_sans_serif_family(family);
    Some(Options { fontdb: Arc::new(fonts), ..Options::default() })
}

/// Text as SVG wants it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Light text at the left of a black line of `width` pixels; what is longer is cut off. Characters that
/// the font or XML lacks are left out.
///
/// `None` if there is no memory for it.
pub fn caption(words: &str, width: u32) -> Option<Frame> {
    let words: String = words.chars().filter(|c| !c.is_control()).collect();
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{LINE}\">\
         <rect width=\"{width}\" height=\"{LINE}\" fill=\"black\"/>\
         <text x=\"3\" y=\"14.5\" font-family=\"sans-serif\" font-size=\"13\" \
         fill=\"#dddddd\">{}</text></svg>",
        escaped(&words)
    );
    let tree = Tree::from_str(&svg, &drawing_options()?).ok()?;
    let mut pixmap = Pixmap::new(width, LINE)?;
    resvg::render(&tree, Transform::identity(), &mut pixmap.as_mut());
    // All of it is opaque: its colours are not multiplied with anything.
    Some(Frame { size: [width, LINE], bytes: pixmap.take() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bright(frame: &Frame) -> usize {
        frame.bytes.chunks_exact(4).filter(|pixel| pixel[0] > 100).count()
    }

    #[test]
    fn longer_words_are_brighter_and_whatever_they_are_there_is_a_line() {
        let [none, short, long] =
            ["", "iris", "iris & <b>wood</b>"].map(|words| caption(words, 200).unwrap());
        assert_eq!(none.size, [200, LINE]);
        assert_eq!(bright(&none), 0);
        assert!(bright(&short) > 20 && bright(&long) > 2 * bright(&short));
        assert!(caption("\u{0}\u{7}x", 40).is_some());
    }
}
