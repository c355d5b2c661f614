//! Encodes by the browser (WebCodecs). web-sys declares it only behind an unstable flag of the compiler.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use js_sys::{Object, Promise, Reflect, Uint8Array};
use motionscope_core::base::Error;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_time::Duration;
use yuv::YuvStandardMatrix;

use super::level::codecs;
use super::mux::{Picture, Stream};
use super::{Video, ratio};
use crate::files;
use crate::media::export::save::cannot_write;
use crate::media::javascript::{message, object};
use crate::media::{Progress, planes};
use crate::work::Signal;

/// Pictures that wait in the encoder at most.
const MOST_WAITING: u32 = 4;
/// Time for which the encoder may take nothing.
const PATIENCE: Duration = Duration::from_secs(60);
/// How often a cancellation is noticed.
const POLL: Duration = Duration::from_millis(200);
/// A picture after so many can be decoded without those before it.
const KEY_INTERVAL: usize = 60;
/// Bits of a pixel at a constant rate factor of 16, so that words and thin lines stay sharp; 6 more halve them.
const BITS_PER_PIXEL: f64 = 0.4;
/// µs in a second.
const US: f64 = 1e6;

#[wasm_bindgen]
extern "C" {
    type VideoEncoder;
    #[wasm_bindgen(constructor, catch)]
    fn new(callbacks: &Object) -> Result<VideoEncoder, JsValue>;
    #[wasm_bindgen(static_method_of = VideoEncoder, js_name = isConfigSupported, catch)]
    fn is_config_supported(config: &Object) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn configure(this: &VideoEncoder, config: &Object) -> Result<(), JsValue>;
    #[wasm_bindgen(method, catch)]
    fn encode(this: &VideoEncoder, frame: &VideoFrame, options: &Object) -> Result<(), JsValue>;
    #[wasm_bindgen(method, catch)]
    fn flush(this: &VideoEncoder) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn close(this: &VideoEncoder) -> Result<(), JsValue>;
    #[wasm_bindgen(method, getter, js_name = encodeQueueSize)]
    fn encode_queue_size(this: &VideoEncoder) -> u32;
    #[wasm_bindgen(method, setter, js_name = ondequeue)]
    fn set_ondequeue(this: &VideoEncoder, callback: &JsValue);

    type VideoFrame;
    #[wasm_bindgen(constructor, catch)]
    fn new(data: &Uint8Array, init: &Object) -> Result<VideoFrame, JsValue>;
    #[wasm_bindgen(method)]
    fn close(this: &VideoFrame);

    type EncodedVideoChunk;
    #[wasm_bindgen(method, getter, js_name = type)]
    fn kind(this: &EncodedVideoChunk) -> String;
    #[wasm_bindgen(method, getter, js_name = byteLength)]
    fn byte_length(this: &EncodedVideoChunk) -> u32;
    #[wasm_bindgen(method, js_name = copyTo, catch)]
    fn copy_to(this: &EncodedVideoChunk, buffer: &Uint8Array) -> Result<(), JsValue>;
}

/// What the encoder has given.
#[derive(Default)]
struct Given {
    pictures: RefCell<Vec<Picture>>,
    configuration: RefCell<Vec<u8>>,
    failure: RefCell<Option<String>>,
    changed: Signal,
}

impl Given {
    fn take(&self, chunk: &EncodedVideoChunk, about: &JsValue) -> Result<(), JsValue> {
        let bytes = Uint8Array::new_with_length(chunk.byte_length());
        chunk.copy_to(&bytes)?;
        let picture = Picture { bytes: bytes.to_vec(), is_key: chunk.kind() == "key" };
        self.pictures.borrow_mut().push(picture);
        let config = Reflect::get(about, &"decoderConfig".into())?;
        if config.is_object() {
            let description = Reflect::get(&config, &"description".into())?;
            *self.configuration.borrow_mut() = Uint8Array::new(&description).to_vec();
        }
        self.changed.notify();
        Ok(())
    }

    fn fail(&self, error: &JsValue) {
        self.failure.borrow_mut().get_or_insert_with(|| message(error));
        self.changed.notify();
    }
}

/// An encoder at work; dropping it closes it.
pub(in crate::media::export) struct Pipe<'a> {
    video: &'a Video,
    progress: Option<&'a dyn Progress>,
    /// Width and height in px, even, as the chroma needs them.
    size: (u32, u32),
    encoder: VideoEncoder,
    given: Rc<Given>,
    /// How many pictures it was given.
    count: usize,
}

impl<'a> Pipe<'a> {
    async fn new(video: &'a Video, progress: Option<&'a dyn Progress>) -> Result<Self, Error> {
        let size = video.size.map(|side| side.next_multiple_of(2) as u32);
        let absent = || video.failed(&format!("this browser encodes no H.264 of this size; {} instead", video.instead));
        let config = video.configuration(size).await.ok_or_else(absent)?;
        let given = Rc::<Given>::default();
        // The browser owns them, since it may call them once more after the encoder is closed.
        let theirs = Rc::clone(&given);
        let output = Closure::<dyn FnMut(EncodedVideoChunk, JsValue)>::new(move |chunk, about| {
            theirs.take(&chunk, &about).unwrap_or_else(|error| theirs.fail(&error));
        });
        let theirs = Rc::clone(&given);
        let error = Closure::<dyn FnMut(JsValue)>::new(move |error| theirs.fail(&error)).into_js_value();
        let theirs = Rc::clone(&given);
        let dequeue = Closure::<dyn FnMut()>::new(move || theirs.changed.notify()).into_js_value();
        let callbacks = object([("output", output.into_js_value()), ("error", error)]);
        let begin = || {
            let encoder = VideoEncoder::new(&callbacks)?;
            encoder.set_ondequeue(&dequeue);
            encoder.configure(&config).map(|()| encoder)
        };
        let encoder = begin().map_err(|error| video.failed(&message(&error)))?;
        Ok(Self { video, progress, size: size.into(), encoder, given, count: 0 })
    }

    /// Appends a picture: rows of RGB.
    ///
    /// # Errors
    /// If the browser fails or the work was cancelled.
    pub async fn put(&mut self, rgb: &[u8]) -> Result<(), Error> {
        let (width, height) = self.size;
        let rgba = padded(rgb, self.video.size, self.size);
        let planes = planes::yuv420(&rgba, self.size, YuvStandardMatrix::Bt709);
        let planes = planes.ok_or_else(|| self.video.failed(&"a picture has another size"))?;
        let space = [("primaries", "bt709"), ("transfer", "bt709"), ("matrix", "bt709")];
        let space = object(space.map(|(key, value)| (key, value.into())));
        drop(Reflect::set(&space, &"fullRange".into(), &false.into()));
        let init = object([
            ("format", "I420".into()),
            ("codedWidth", width.into()),
            ("codedHeight", height.into()),
            ("timestamp", (self.count as f64 * US / self.video.rate_hz).round().into()),
            ("duration", (US / self.video.rate_hz).round().into()),
            ("colorSpace", space.into()),
        ]);
        self.settled(|encoder| encoder.encode_queue_size() < MOST_WAITING).await?;
        let encode = || {
            let frame = VideoFrame::new(&Uint8Array::from(planes.as_slice()), &init)?;
            let options = object([("keyFrame", self.count.is_multiple_of(KEY_INTERVAL).into())]);
            let encoded = self.encoder.encode(&frame, &options);
            frame.close();
            encoded
        };
        encode().map_err(|error| self.video.failed(&message(&error)))?;
        self.count += 1;
        Ok(())
    }

    /// Waits until the encoder `is_ready`.
    async fn settled(&self, is_ready: impl Fn(&VideoEncoder) -> bool) -> Result<(), Error> {
        let look = || match &*self.given.failure.borrow() {
            Some(why) => Some(Err(self.video.failed(why))),
            None => is_ready(&self.encoder).then_some(Ok(())),
        };
        // Counted, because a tab that sleeps has all the time in the world.
        let mut silent = Duration::ZERO;
        while silent < PATIENCE {
            if let Some(settled) = self.given.changed.until_within(POLL, look).await {
                return settled;
            }
            if self.progress.is_some_and(|progress| progress.cancelled()) {
                return Err(Error::new("saving was cancelled"));
            }
            silent += POLL;
        }
        let why = format!("the browser took nothing for {} s; {} instead", PATIENCE.as_secs(), self.video.instead);
        Err(self.video.failed(&why))
    }

    /// The file of all pictures.
    async fn finish(self) -> Result<Vec<u8>, Error> {
        let failed = |error: JsValue| self.video.failed(&message(&error));
        JsFuture::from(self.encoder.flush().map_err(failed)?).await.map_err(failed)?;
        self.settled(|_| self.given.pictures.borrow().len() == self.count).await?;
        let side = |side: u32| u16::try_from(side).map_err(|error| self.video.failed(&error));
        let stream = Stream {
            size: [side(self.size.0)?, side(self.size.1)?],
            rate: ratio(self.video.rate_hz),
            configuration: self.given.configuration.take(),
            pictures: self.given.pictures.take(),
        };
        stream.into_file().map_err(|why| self.video.failed(&why))
    }
}

impl Drop for Pipe<'_> {
    fn drop(&mut self) {
        // One that has failed is closed already.
        self.encoder.close().unwrap_or_default();
    }
}

impl Video {
    /// Encodes the pictures that `pour` puts into the pipe.
    ///
    /// # Errors
    /// If the browser cannot encode H.264 of this size, or `pour` failed or was cancelled.
    pub async fn encode(
        &self,
        progress: Option<&dyn Progress>,
        pour: impl AsyncFnOnce(&mut Pipe<'_>) -> Result<(), Error>,
    ) -> Result<Vec<u8>, Error> {
        let mut pipe = Pipe::new(self, progress).await?;
        pour(&mut pipe).await?;
        pipe.finish().await
    }

    /// Encodes the pictures that `pour` puts into the pipe as the new file `file`.
    ///
    /// # Errors
    /// As [`Video::encode`], and if the file cannot be written.
    pub async fn write(
        &self,
        file: &Path,
        progress: Option<&dyn Progress>,
        pour: impl AsyncFnOnce(&mut Pipe<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let bytes = self.encode(progress, pour).await?;
        files::write_from(file, &mut bytes.as_slice()).map_err(|error| cannot_write(file, &error))
    }

    /// The best configuration that the browser has an encoder for.
    async fn configuration(&self, [width, height]: [u32; 2]) -> Option<Object> {
        if !Reflect::has(&js_sys::global(), &"VideoEncoder".into()).unwrap_or(false) {
            return None;
        }
        let bits = BITS_PER_PIXEL * ((16.0 - f64::from(self.crf)) / 6.0).exp2();
        let bits_per_second = (f64::from(width * height) * self.rate_hz * bits).round();
        for codec in codecs([width, height], self.rate_hz) {
            let config = object([
                ("codec", codec.into()),
                ("width", width.into()),
                ("height", height.into()),
                ("framerate", self.rate_hz.into()),
                ("bitrate", bits_per_second.into()),
                ("latencyMode", "quality".into()),
            ]);
            drop(Reflect::set(&config, &"avc".into(), &object([("format", "avc".into())])));
            let Ok(answer) = VideoEncoder::is_config_supported(&config) else { continue };
            let answer = JsFuture::from(answer).await;
            if answer.and_then(|answer| Reflect::get(&answer, &"supported".into())).is_ok_and(|is| is.is_truthy()) {
                return Some(config);
            }
        }
        None
    }
}

/// The pixels in RGBA, with black beyond the right and lower edge where `to` is larger.
fn padded(rgb: &[u8], [width, height]: [usize; 2], to: (u32, u32)) -> Vec<u8> {
    let row = 4 * to.0 as usize;
    let mut rgba = [0, 0, 0, u8::MAX].repeat(to.0 as usize * to.1 as usize);
    for (to, from) in rgba.chunks_exact_mut(row).zip(rgb.chunks_exact(3 * width)).take(height) {
        for (to, from) in to.chunks_exact_mut(4).zip(from.chunks_exact(3)) {
            to[..3].copy_from_slice(from);
        }
    }
    rgba
}
