//! Cameras through the browser: a stream is shown by a video element outside of the page, whose frames are drawn into a canvas and read.

use std::cell::Cell;
use std::rc::Rc;

use js_sys::{Array, Object, Reflect};
use motionscope_core::base::{Error, Stop};
use send_wrapper::SendWrapper;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    CanvasRenderingContext2d, HtmlCanvasElement, HtmlVideoElement, MediaDeviceInfo, MediaDeviceKind, MediaDevices,
    MediaStream, MediaStreamConstraints, MediaStreamTrack, MediaStreamTrackState,
};
use web_time::Duration;
use yuv::YuvStandardMatrix;

use super::{CameraFeed, Cameras, Device, Format, OpenedFeed, Size, TestPicture};
use crate::media::check_size;
use crate::media::javascript::object;
use crate::media::planes;
use crate::media::reason;
use crate::media::video::color::Matrix;
use crate::work::{self, Boxed, Signal};

/// How often a waiting task asks whether it should stop.
const POLL: Duration = Duration::from_millis(50);
/// Time that a camera may take until its first frame.
const FIRST: Duration = Duration::from_secs(12);
/// Time after which a camera that sends no frame has stopped.
const STALLED: Duration = Duration::from_secs(3);
/// Time from one frame to the next where the browser does not tell of new ones.
const FRAME: Duration = Duration::from_millis(33);

/// The cameras that the browser lets the page use.
pub(super) struct Browser;

impl Cameras for Browser {
    fn list(&self) -> Boxed<'_, (Vec<Device>, Option<Error>)> {
        Box::pin(async {
            let (mut all, error) = match named_cameras().await {
                Ok(all) => (all, None),
                Err(error) => (Vec::new(), Some(error)),
            };
            all.push(Device::TestPicture);
            (all, error)
        })
    }

    fn open<'a>(&'a self, device: &'a Device, size: Size, _: &'a Stop) -> Boxed<'a, OpenedFeed> {
        Box::pin(async move {
            let Device::Camera { name, address } = device else {
                return Ok(Box::new(TestPicture::new(size)) as Box<dyn CameraFeed>);
            };
            let wanted = object([
                ("deviceId", object([("exact", address.as_str().into())]).into()),
                ("width", ideal(size.width as f64)),
                ("height", ideal(size.height as f64)),
                ("frameRate", ideal(30.0)),
            ]);
            let stream =
                Stream::open(&wanted).await.map_err(|error| Error::new(format!("{name}: {}", refusal(&error))))?;
            let shown = Shown::new(stream, name.clone()).await;
            let shown = shown.map_err(|error| Error::new(format!("{name}: {}", refusal(&error))))?;
            Ok(Box::new(Feed(SendWrapper::new(shown))) as Box<dyn CameraFeed>)
        })
    }
}

/// A wish that a camera may come near to.
fn ideal(value: f64) -> JsValue {
    object([("ideal", value.into())]).into()
}

/// The door to cameras, which a page has only if it came by a secure connection.
fn devices() -> Result<MediaDevices, Error> {
    let navigator = web_sys::window().map(|window| window.navigator());
    let devices = navigator.and_then(|navigator| Reflect::get(&navigator, &"mediaDevices".into()).ok());
    devices.filter(JsValue::is_object).map(JsCast::unchecked_into).ok_or_else(|| {
        Error::new("this browser lets no page use a camera that was not loaded over HTTPS; open the page by an address with https")
    })
}

/// The cameras with their names, which the browser tells only once the user has allowed cameras.
async fn named_cameras() -> Result<Vec<Device>, Error> {
    let found = cameras().await?;
    let is_named = |device: &MediaDeviceInfo| !device.label().is_empty() && !device.device_id().is_empty();
    let found = match found.iter().all(is_named) {
        true => found,
        false => {
            // Asks the user.
            let allowed = Stream::open(&Object::new()).await.map_err(|error| Error::new(refusal(&error)))?;
            let found = cameras().await?;
            drop(allowed);
            found
        }
    };
    let camera = |(number, device): (usize, MediaDeviceInfo)| {
        let name = Some(device.label()).filter(|name| !name.is_empty()).unwrap_or_else(|| format!("Camera {number}"));
        Device::Camera { name, address: device.device_id() }
    };
    Ok((1..).zip(found).map(camera).collect())
}

/// The cameras as the browser lists them.
async fn cameras() -> Result<Vec<MediaDeviceInfo>, Error> {
    let unlisted = |error: JsValue| Error::new(refusal(&error));
    let all = JsFuture::from(devices()?.enumerate_devices().map_err(unlisted)?).await.map_err(unlisted)?;
    let all = Array::from(&all).iter().map(JsValue::unchecked_into::<MediaDeviceInfo>).collect::<Vec<_>>();
    Ok(all.into_iter().filter(|device| device.kind() == MediaDeviceKind::Videoinput).collect())
}

/// Why the browser opens no camera, and what to do.
fn refusal(error: &JsValue) -> String {
    let text = |key: &str| Reflect::get(error, &key.into()).ok().and_then(|text| text.as_string()).unwrap_or_default();
    match text("name").as_str() {
        "NotAllowedError" | "SecurityError" => {
            "the browser does not let this page use a camera; allow it beside the address of the page, then list the cameras again".into()
        }
        "NotFoundError" | "OverconstrainedError" => "it is not there; plug it in and list the cameras again".into(),
        "NotReadableError" | "AbortError" => {
            "another program uses it; close that program, then choose the camera again".into()
        }
        _ => format!("the browser cannot open it{}; reload the page", reason::bracketed(text("message").trim_end_matches('.'))),
    }
}

/// A camera that is on; dropping it switches it off.
struct Stream(MediaStream);

impl Stream {
    /// Switches on a camera that is like `wanted`.
    async fn open(wanted: &Object) -> Result<Self, JsValue> {
        let constraints = MediaStreamConstraints::new();
        constraints.set_video(wanted);
        let devices = devices().map_err(|error| object([("message", error.to_string().into())]))?;
        let stream = JsFuture::from(devices.get_user_media_with_constraints(&constraints)?).await?;
        Ok(Self(stream.unchecked_into()))
    }

    fn tracks(&self) -> impl Iterator<Item = MediaStreamTrack> {
        self.0.get_tracks().iter().map(JsValue::unchecked_into).collect::<Vec<_>>().into_iter()
    }

    fn has_ended(&self) -> bool {
        self.tracks().any(|track| track.ready_state() == MediaStreamTrackState::Ended)
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        self.tracks().for_each(|track| track.stop());
    }
}

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(extends = HtmlVideoElement)]
    type Video;
    #[wasm_bindgen(method, catch, js_name = requestVideoFrameCallback)]
    fn request_frame(this: &Video, callback: &JsValue) -> Result<u32, JsValue>;
}

/// A camera that is shown by an element outside of the page.
struct Shown {
    stream: Stream,
    name: String,
    video: Video,
    canvas: HtmlCanvasElement,
    context: CanvasRenderingContext2d,
    news: Rc<News>,
    /// Called with the next frame; the browser owns it, since it may call it once more after the camera is off.
    callback: JsValue,
    size: (u32, u32),
}

/// Tells of new frames.
#[derive(Default)]
struct News {
    is_new: Cell<bool>,
    signal: Signal,
}

impl Shown {
    async fn new(stream: Stream, name: String) -> Result<Self, JsValue> {
        let document = web_sys::window().and_then(|window| window.document()).ok_or(JsValue::NULL)?;
        let video: Video = document.create_element("video")?.unchecked_into();
        video.set_muted(true);
        video.set_attribute("playsinline", "")?;
        video.set_src_object(Some(&stream.0));
        let canvas: HtmlCanvasElement = document.create_element("canvas")?.unchecked_into();
        let options = object([("willReadFrequently", true.into())]);
        let context = canvas.get_context_with_context_options("2d", &options)?.ok_or(JsValue::NULL)?.unchecked_into();
        let news = Rc::<News>::default();
        let theirs = Rc::clone(&news);
        let callback = Closure::<dyn FnMut()>::new(move || {
            theirs.is_new.set(true);
            theirs.signal.notify();
        });
        let callback = callback.into_js_value();
        // It plays as soon as frames come, which are waited for.
        let _ = video.play()?;
        Ok(Self { stream, name, video, canvas, context, news, callback, size: (0, 0) })
    }

    fn error(&self, why: &str) -> Error {
        Error::new(format!("{}: {why}", self.name))
    }

    /// Waits for a new frame, but no longer than `patience` while the page is seen.
    async fn wait(&self, stop: &Stop, patience: Duration) -> Result<(), Error> {
        // Counted, because a tab that sleeps has all the time in the world.
        let mut silent = Duration::ZERO;
        self.news.is_new.set(false);
        if self.video.request_frame(&self.callback).is_err() {
            work::sleep(FRAME).await;
            self.news.is_new.set(true);
        }
        loop {
            stop.check()?;
            if self.stream.has_ended() {
                return Err(self.error("it sends no more frames; plug it in again and choose it again"));
            }
            let news = self.news.signal.until_within(POLL, || self.news.is_new.get().then_some(())).await;
            if news.is_some() {
                return Ok(());
            }
            // A browser shows no frames in a tab that is not seen.
            if !web_sys::window().and_then(|window| window.document()).is_some_and(|document| document.hidden()) {
                silent += POLL;
            }
            if silent > patience {
                let seconds = patience.as_secs();
                return Err(self.error(&format!(
                    "no frame came for {seconds} s; plug the camera in again, or choose another one"
                )));
            }
        }
    }

    /// Reads the frame that is shown, as planes of luma and chroma.
    fn read(&self) -> Result<Vec<u8>, Error> {
        let (width, height) = self.size;
        if (self.video.video_width(), self.video.video_height()) != self.size {
            return Err(self.error("its picture was turned, or has another size; choose the camera again"));
        }
        let unread = || self.error("the browser does not let its frames be read; reload the page");
        let draw = || {
            self.context.draw_image_with_html_video_element_and_dw_and_dh(
                &self.video,
                0.0,
                0.0,
                width.into(),
                height.into(),
            )?;
            self.context.get_image_data(0.0, 0.0, width.into(), height.into())
        };
        let pixels = draw().map_err(|_| unread())?.data();
        let matrix = match Matrix::by_height(height as usize) {
            Matrix::Bt709 => YuvStandardMatrix::Bt709,
            _ => YuvStandardMatrix::Bt601,
        };
        planes::yuv420(&pixels, self.size, matrix).ok_or_else(unread)
    }
}

/// The frames of a camera. A page has one thread.
struct Feed(SendWrapper<Shown>);

impl CameraFeed for Feed {
    fn begin<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
        Box::pin(async {
            self.0.wait(stop, FIRST).await?;
            let size = (self.0.video.video_width(), self.0.video.video_height());
            check_size(size.0 as usize, size.1 as usize).map_err(|error| self.0.error(&error.to_string()))?;
            self.0.size = size;
            self.0.canvas.set_width(size.0);
            self.0.canvas.set_height(size.1);
            Format::parse(format!("YUV4MPEG2 W{} H{} F30:1 Ip A1:1 C420jpeg", size.0, size.1).as_bytes())
        })
    }

    fn next<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
        Box::pin(async {
            self.0.wait(stop, STALLED).await?;
            self.0.read().map(Some)
        })
    }
}
