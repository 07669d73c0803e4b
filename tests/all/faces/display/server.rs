//! A display without a screen: Xvfb, looked at and driven as a person would.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use eframe::egui::{Pos2, Rect};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    ClientMessageEvent, ConfigureWindowAux, ConnectionExt, EventMask, ImageFormat, InputFocus,
    MapState, Window,
};
use x11rb::rust_connection::RustConnection;

/// A process that ends with the test, also when the test panics.
pub(super) struct Ending(pub(super) Child);

impl Drop for Ending {
    fn drop(&mut self) {
        // it may have ended by itself
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// An X server of its own, with one screen and without a window manager.
pub(super) struct Server {
    /// Such as `:7`.
    pub(super) name: String,
    connection: RustConnection,
    root: Window,
    size: [u16; 2],
    _xvfb: Ending,
}

impl Server {
    /// Starts on the first display that is free.
    pub(super) fn start(size: [u16; 2]) -> Server {
        let [width, height] = size;
        let mut xvfb = Command::new("Xvfb");
        xvfb.args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0"]);
        xvfb.arg(format!("{width}x{height}x24")).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut xvfb = Ending(xvfb.spawn().expect("Xvfb is installed: tests/run installs it"));
        let mut number = String::new();
        let said = xvfb.0.stdout.take().expect("a pipe");
        BufReader::new(said).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb found no free display");
        let name = format!(":{}", number.trim());
        let (connection, screen) = x11rb::connect(Some(&name)).expect("Xvfb answers");
        let root = connection.setup().roots[screen].root;
        Server { name, connection, root, size, _xvfb: xvfb }
    }

    /// What the screen shows, without the pointer.
    pub(super) fn shot(&self) -> Shot {
        let [width, height] = self.size;
        let format = ImageFormat::Z_PIXMAP;
        let image = self.connection.get_image(format, self.root, 0, 0, width, height, !0);
        let bytes = image.unwrap().reply().expect("the screen can be read").data;
        let (pixels, rest) = bytes.as_chunks::<4>();
        assert!(rest.is_empty(), "32 bits per pixel");
        let pixels = pixels.iter().map(|&[b, g, r, _]| [r, g, b]).collect();
        Shot { size: self.size.map(usize::from), pixels }
    }

    /// The window that fills most of the screen, if it shows.
    pub(super) fn window(&self) -> Option<Window> {
        let tree = self.connection.query_tree(self.root).unwrap().reply().unwrap();
        tree.children.into_iter().find(|&window| {
            // a window may go away at any time
            let attributes = self.connection.get_window_attributes(window).unwrap().reply();
            let place = self.connection.get_geometry(window).unwrap().reply();
            attributes.is_ok_and(|a| a.map_state == MapState::VIEWABLE)
                && place.is_ok_and(|g| g.width >= self.size[0] / 2)
        })
    }

    /// Lets a window fill the screen and have the keyboard, as a window manager would.
    pub(super) fn show_whole(&self, window: Window) {
        let [width, height] = self.size.map(u32::from);
        let place = ConfigureWindowAux::new().x(0).y(0).width(width).height(height);
        self.connection.configure_window(window, &place).unwrap();
        self.connection.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME).unwrap();
        self.connection.sync();
    }

    /// Presses the close button that a window manager would draw.
    pub(super) fn ask_to_close(&self, window: Window) {
        let atom = |name: &str| {
            self.connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom
        };
        let data = [atom("WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
        let message = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
        self.connection.send_event(false, window, EventMask::NO_EVENT, message).unwrap();
        self.connection.sync();
    }

    /// Gives orders to pointer and keyboard.
    pub(super) fn xdotool(&self, orders: &[&str]) {
        let mut command = Command::new("xdotool");
        let status = command.env("DISPLAY", &self.name).args(orders).status();
        let status = status.expect("xdotool is installed: tests/run installs it");
        assert!(status.success(), "xdotool {orders:?}");
    }

    pub(super) fn move_to(&self, at: Pos2) {
        let [x, y] = [at.x, at.y].map(|v| v.round().to_string());
        self.xdotool(&["mousemove", &x, &y]);
    }
}

trait Sync {
    /// Returns when the server has done all that was asked before.
    fn sync(&self);
}

impl Sync for RustConnection {
    fn sync(&self) {
        self.get_input_focus().unwrap().reply().expect("the server answers");
    }
}

/// A picture of the screen.
#[derive(Clone, PartialEq)]
pub(super) struct Shot {
    pub(super) size: [usize; 2],
    pub(super) pixels: Vec<[u8; 3]>,
}

impl Shot {
    /// The pixels whose channels differ by more than `tolerance`, as far as they lie in `within`
    /// and in none of `apart`.
    pub(super) fn differences(
        &self,
        other: &Shot,
        within: Rect,
        apart: &[Rect],
        tolerance: u8,
    ) -> Vec<[usize; 2]> {
        assert_eq!(self.size, other.size);
        let counts = |x: usize, y: usize| {
            let middle = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
            within.contains(middle) && !apart.iter().any(|r| r.contains(middle))
        };
        let width = self.size[0];
        let pairs = self.pixels.iter().zip(&other.pixels).enumerate();
        pairs
            .filter(|(_, (a, b))| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > tolerance))
            .map(|(i, _)| [i % width, i / width])
            .filter(|&[x, y]| counts(x, y))
            .collect()
    }

    /// The pixel at a point.
    pub(super) fn pixel(&self, at: Pos2) -> [u8; 3] {
        self.pixels[at.y as usize * self.size[0] + at.x as usize]
    }

    /// The whole of it.
    pub(super) fn all(&self) -> Rect {
        Rect::from_min_size(Pos2::ZERO, self.size.map(|n| n as f32).into())
    }

    /// Writes it to `target/test-pictures` and says where.
    pub(super) fn keep(&self, name: &str) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/test-pictures");
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("{name}.png"));
        let file = std::io::BufWriter::new(std::fs::File::create(&path).unwrap());
        let [width, height] = self.size.map(|n| n as u32);
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(self.pixels.as_flattened()).unwrap();
        path
    }
}

#[test]
fn one_foreign_pixel_is_found() {
    let size = [40, 30];
    let before = Shot { size, pixels: vec![[10, 20, 30]; 40 * 30] };
    let mut after = before.clone();
    let (all, part) = (before.all(), Rect::from_min_max((5.0, 5.0).into(), (20.0, 10.0).into()));
    assert_eq!(before.differences(&after, all, &[], 0), [[0; 2]; 0]);
    // one inside the part, one just outside of it
    after.pixels[9 * 40 + 19] = [10, 21, 30];
    after.pixels[9 * 40 + 20] = [10, 20, 28];
    assert_eq!(before.differences(&after, all, &[part], 0), [[20, 9]]);
    assert_eq!(before.differences(&after, part, &[], 0), [[19, 9]]);
    assert_eq!(before.differences(&after, all, &[], 1), [[20, 9]]);
    assert_eq!(before.differences(&after, all, &[], 2), [[0; 2]; 0]);
}
