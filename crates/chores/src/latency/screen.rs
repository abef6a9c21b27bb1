//! A virtual screen whose pointer and keyboard are controlled by this program.

use super::Closed;
use anyhow::{Context as _, bail, ensure};
use lovelock_base::clock::Stopwatch;
use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConfigureWindowAux, ConnectionExt as _, ImageFormat,
    InputFocus, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, MapState, Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Key codes of the screen.
pub(crate) const KEY_C: u8 = 54;
pub(crate) const KEY_SPACE: u8 = 65;

/// What is pressed.
#[derive(Clone, Copy)]
pub(crate) enum Input {
    /// A key, by its code.
    Key(u8),
    /// A button of the pointer: 1 is the left one, 4 and 5 turn the wheel.
    Button(u8),
}

/// A rectangle of the screen, in pixels.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) x: i16,
    pub(crate) y: i16,
    pub(crate) width: u16,
    pub(crate) height: u16,
}

impl Place {
    /// The centre.
    pub(crate) fn middle(self) -> (i16, i16) {
        (self.x + self.width as i16 / 2, self.y + self.height as i16 / 2)
    }
}

/// A virtual screen (Xvfb).
pub(crate) struct Screen {
    connection: RustConnection,
    root: Window,
    name: String,
    _server: Closed,
}

impl Screen {
    /// Starts a screen of this size with a free display number.
    pub(crate) fn start(width: u16, height: u16) -> anyhow::Result<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0", &format!("{width}x{height}x24")])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("could not start Xvfb")?;
        let out = server.stdout.take().context("Xvfb has no output")?;
        let server = Closed(server);
        let mut line = String::new();
        BufReader::new(out).read_line(&mut line)?;
        ensure!(!line.trim().is_empty(), "Xvfb found no free screen");
        let name = format!(":{}", line.trim());
        let (connection, screen) = x11rb::connect(Some(&name))?;
        let root = connection.setup().roots.get(screen).context("Xvfb has no screen")?.root;
        Ok(Self { connection, root, name, _server: server })
    }

    /// The name of the display, such as `:1`.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Waits for the first window that is shown.
    pub(crate) fn wait_for_window(&self, limit: Duration) -> anyhow::Result<Window> {
        let rounds = limit.as_millis() / 100;
        for _ in 0..rounds {
            for window in self.connection.query_tree(self.root)?.reply()?.children {
                let shown =
                    self.connection.get_window_attributes(window)?.reply()?.map_state == MapState::VIEWABLE;
                let size = self.connection.get_geometry(window)?.reply()?;
                if shown && size.width > 100 && size.height > 100 {
                    return Ok(window);
                }
            }
            sleep(Duration::from_millis(100));
        }
        bail!("no window was opened within {} s", limit.as_secs())
    }

    /// Resizes a window.
    pub(crate) fn size(&self, window: Window, (width, height): (u16, u16)) -> anyhow::Result<()> {
        let size = ConfigureWindowAux::new().x(0).y(0).width(u32::from(width)).height(u32::from(height));
        self.connection.configure_window(window, &size)?.check()?;
        Ok(())
    }

    /// Presses and releases a key with a window focused.
    pub(crate) fn key(&self, window: Window, code: u8) -> anyhow::Result<()> {
        self.connection.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME)?.check()?;
        sleep(Duration::from_millis(300));
        for kind in [KEY_PRESS_EVENT, KEY_RELEASE_EVENT] {
            self.connection.xtest_fake_input(kind, code, x11rb::CURRENT_TIME, self.root, 0, 0, 0)?.check()?;
            sleep(Duration::from_millis(100));
        }
        Ok(())
    }

    /// Presses or releases a key or a button of the pointer.
    pub(crate) fn press(&self, what: Input, pressed: bool) -> anyhow::Result<()> {
        let (kind, code) = match (what, pressed) {
            (Input::Key(code), true) => (KEY_PRESS_EVENT, code),
            (Input::Key(code), false) => (KEY_RELEASE_EVENT, code),
            (Input::Button(code), true) => (BUTTON_PRESS_EVENT, code),
            (Input::Button(code), false) => (BUTTON_RELEASE_EVENT, code),
        };
        self.connection.xtest_fake_input(kind, code, x11rb::CURRENT_TIME, self.root, 0, 0, 0)?.check()?;
        Ok(())
    }

    /// Moves the pointer.
    pub(crate) fn point(&self, (x, y): (i16, i16)) -> anyhow::Result<()> {
        let root = self.root;
        let motion = MOTION_NOTIFY_EVENT;
        self.connection.xtest_fake_input(motion, 0, x11rb::CURRENT_TIME, root, x, y, 0)?.check()?;
        Ok(())
    }

    /// Moves the pointer, and waits until the image in `place` changes.
    pub(crate) fn time_to_change(&self, to: (i16, i16), place: Place) -> anyhow::Result<Duration> {
        let before = self.pixels(place)?;
        let watch = Stopwatch::start();
        self.point(to)?;
        while self.pixels(place)? == before {
            ensure!(
                watch.elapsed() < Duration::from_secs(5),
                "the pointer moved and nothing changed for 5 s"
            );
            sleep(Duration::from_millis(1));
        }
        Ok(watch.elapsed())
    }

    fn pixels(&self, Place { x, y, width, height }: Place) -> anyhow::Result<Vec<u8>> {
        let image = self.connection.get_image(ImageFormat::Z_PIXMAP, self.root, x, y, width, height, !0)?;
        Ok(image.reply()?.data)
    }
}
