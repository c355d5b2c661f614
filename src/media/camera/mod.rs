//! Cameras: their list, their frames, and recordings of them as clips.
//!
//! A [`CameraFeed`] delivers frames one after the other: the pipe of the user's own ffmpeg, a stream of the browser in a page, or a moving
//! test picture. A [`Camera`] reads it in a task of its own and remembers the last seconds, of which [`keep`] makes a clip.
//!
//! Closing a camera waits a fraction of a second at most. A feed that cannot be interrupted is left behind, and the task of the next
//! camera waits until all earlier ones have ended; the application keeps these in `Closing`.

mod devices;
mod ffmpeg;
mod format;
mod keep;
#[cfg(target_arch = "wasm32")]
mod page;
mod reading;
mod stream;
mod test_picture;

use std::sync::Arc;

use motionscope_core::base::{Error, Stop};
use serde::{Deserialize, Serialize};

use crate::work::Boxed;
pub use devices::Platform;
pub use ffmpeg::Ffmpeg;
pub use format::Format;
pub use keep::{Kept, Recorded, is_unsaved, keep, record};
pub use reading::{Camera, Closing, Shot};
pub use stream::Stream;
pub use test_picture::TestPicture;

/// A source of live frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Device {
    /// A camera.
    Camera {
        /// Its name, as the system calls it.
        name: String,
        /// Its name for ffmpeg, or its id in a browser.
        address: String,
    },
    /// A moving pattern that needs no camera.
    TestPicture,
}

impl Device {
    /// The name of the test picture.
    pub const TEST_PICTURE: &'static str = "Test picture";

    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::Camera { name, .. } => name,
            Self::TestPicture => Self::TEST_PICTURE,
        }
    }

    /// The one of `all` that is called `wanted`: its name, its address, or a part of its name that no other has.
    ///
    /// # Errors
    /// A sentence that lists them, if there is none or more than one.
    pub fn find<'a>(all: &'a [Device], wanted: &str) -> Result<&'a Device, Error> {
        let lower = wanted.to_lowercase();
        let is_exact = |device: &&Device| {
            device.name().to_lowercase() == lower
                || matches!(device, Device::Camera { address, .. } if address == wanted)
        };
        if let Some(device) = all.iter().find(is_exact) {
            return Ok(device);
        }
        let mut alike = all.iter().filter(|device| device.name().to_lowercase().contains(&lower));
        let list = |why: String, of: Vec<&Device>| {
            let names: Vec<_> = of.into_iter().map(Device::name).collect();
            Err(Error::new(format!("{why}; choose one of {}", names.join(", "))))
        };
        match (alike.next(), alike.next()) {
            (Some(device), None) => Ok(device),
            (Some(first), Some(second)) => {
                let found = [first, second].into_iter().chain(alike).collect();
                list(format!("{wanted} names more than one camera"), found)
            }
            (None, _) => list(format!("there is no camera {wanted}"), all.iter().collect()),
        }
    }
}

/// Width and height of frames in px.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Size {
    /// Width in px.
    pub width: usize,
    /// Height in px.
    pub height: usize,
}

impl Size {
    /// The sizes that most cameras have.
    pub const USUAL: [Size; 3] = [Size::new(320, 240), Size::new(640, 480), Size::new(1280, 720)];

    /// A size.
    pub const fn new(width: usize, height: usize) -> Self {
        Self { width, height }
    }
}

impl Default for Size {
    fn default() -> Self {
        Self::new(640, 480)
    }
}

impl std::str::FromStr for Size {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let sides = text.split_once(['x', '×']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
        match sides {
            Some((width, height)) if (16..=7680).contains(&width) && (16..=4320).contains(&height) => {
                Ok(Self { width, height })
            }
            _ => Err(Error::new(format!("a size has the form WxH from 16x16 to 7680x4320, as in 640x480, not {text}"))),
        }
    }
}

/// Frames that come one after the other, in real time.
pub trait CameraFeed: Send {
    /// Waits for the first frame, and returns the format of all frames. Called once, before [`CameraFeed::next`].
    ///
    /// # Errors
    /// One sentence that says why there are no frames and what to do.
    fn begin<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Format, Error>>;

    /// Waits for the next frame, and returns its samples; `None` where the feed ends.
    ///
    /// # Errors
    /// One sentence that says why there are no more frames, or that `stop` was set.
    fn next<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>>;
}

/// The cameras of a computer.
pub trait Cameras: Send + Sync {
    /// Returns the sources of frames, of which the test picture is always the last, and the error that kept cameras from being
    /// listed, if there was one. May take a second.
    fn list(&self) -> Boxed<'_, (Vec<Device>, Option<Error>)>;

    /// Opens a source of frames of this size, or of the nearest one that it has; its first frames may take a while.
    ///
    /// # Errors
    /// One sentence that says why it cannot be opened and what to do, or that `stop` was set.
    fn open<'a>(&'a self, device: &'a Device, size: Size, stop: &'a Stop) -> Boxed<'a, OpenedFeed>;
}

/// A feed that was opened, or why it was not.
pub type OpenedFeed = Result<Box<dyn CameraFeed>, Error>;

/// The cameras of this computer: those that ffmpeg reaches, or in a page those of the browser.
pub fn cameras() -> Arc<dyn Cameras> {
    #[cfg(not(target_arch = "wasm32"))]
    return Arc::new(Ffmpeg::default());
    #[cfg(target_arch = "wasm32")]
    Arc::new(page::Browser)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(name: &str, address: &str) -> Device {
        Device::Camera { name: name.into(), address: address.into() }
    }

    #[test]
    fn a_device_is_found_by_what_it_is_called() {
        let all = [camera("HD Webcam", "/dev/video0"), camera("USB Webcam", "/dev/video2"), Device::TestPicture];
        let found = |wanted| Device::find(&all, wanted).map(Device::name).ok();
        assert_eq!(
            ["hd webcam", "/dev/video2", "USB", "test"].map(found),
            [Some("HD Webcam"), Some("USB Webcam"), Some("USB Webcam"), Some("Test picture")]
        );
        for (wanted, why) in [
            ("webcam", "webcam names more than one camera; choose one of HD Webcam, USB Webcam"),
            ("none", "there is no camera none; choose one of HD Webcam, USB Webcam, Test picture"),
        ] {
            assert_eq!(Device::find(&all, wanted).unwrap_err().to_string(), why);
        }
    }

    #[test]
    fn sizes_are_read() {
        assert_eq!("640x480".parse(), Ok(Size::default()));
        assert_eq!("1280×720".parse(), Ok(Size::new(1280, 720)));
        for odd in ["640", "0x0", "640x", "99999x5", "axb"] {
            assert!(odd.parse::<Size>().is_err_and(|error| error.to_string().contains("640x480")), "{odd}");
        }
    }
}
