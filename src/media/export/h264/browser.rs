//! Encodes by the browser (WebCodecs). web-sys declares it only behind an unstable flag of the compiler.

use std::cell::{Cell, RefCell};
use std::path::Path;
use std::rc::Rc;

use js_sys::{Object, Promise, Reflect, Uint8Array};
use motionscope_core::base::Error;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_time::Duration;
use yuv::YuvStandardMatrix;

use super::Video;
use super::level::codecs;
use super::mux::{Picture, Stream};
use crate::files;
use crate::media::export::save::cannot_write;
use crate::media::javascript::{has_codec, message, object, supports};
use crate::media::{Progress, planes};
use crate::work::Signal;

/// Maximum number of pictures queued in the encoder.
const MOST_WAITING: u32 = 4;
/// Longest silence of the encoder.
const PATIENCE: Duration = Duration::from_secs(60);
/// How often a cancellation is noticed.
const POLL: Duration = Duration::from_millis(200);
/// Pictures from one key frame to the next.
const KEY_INTERVAL: usize = 60;
/// Bits per pixel at a constant rate factor of 16, so that words and thin lines stay sharp; each 6 more halve them.
const BITS_PER_PIXEL: f64 = 0.4;
/// Largest video, because a page holds it in memory.
const MOST_BYTES: usize = 256 << 20;
/// µs in a second.
const US: f64 = 1e6;

#[wasm_bindgen]
extern "C" {
    type VideoEncoder;
    #[wasm_bindgen(constructor, catch)]
    fn new(callbacks: &Object) -> Result<VideoEncoder, JsValue>;
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
    #[wasm_bindgen(method, getter)]
    fn timestamp(this: &EncodedVideoChunk) -> f64;
    #[wasm_bindgen(method, getter, js_name = byteLength)]
    fn byte_length(this: &EncodedVideoChunk) -> u32;
    #[wasm_bindgen(method, js_name = copyTo, catch)]
    fn copy_to(this: &EncodedVideoChunk, buffer: &Uint8Array) -> Result<(), JsValue>;
}

/// Output of the encoder so far.
#[derive(Default)]
struct EncoderOutput {
    pictures: RefCell<Vec<Picture>>,
    bytes: Cell<usize>,
    configuration: RefCell<Vec<u8>>,
    /// How it ended: all pictures are encoded, or why not.
    end: RefCell<Option<Result<(), String>>>,
    changed: Signal,
}

impl EncoderOutput {
    fn take(&self, chunk: &EncodedVideoChunk, metadata: &JsValue, rate_hz: f64) -> Result<(), JsValue> {
        self.bytes.set(self.bytes.get() + chunk.byte_length() as usize);
        if self.bytes.get() > MOST_BYTES {
            let most = MOST_BYTES >> 20;
            let why = format!("it is larger than {most} MiB; save fewer frames, or use the desktop edition");
            self.end(Err(why));
            return Ok(());
        }
        let bytes = Uint8Array::new_with_length(chunk.byte_length());
        chunk.copy_to(&bytes)?;
        let number = (chunk.timestamp() * rate_hz / US).round() as usize;
        let picture = Picture { bytes: bytes.to_vec(), is_key: chunk.kind() == "key", number };
        self.pictures.borrow_mut().push(picture);
        if metadata.is_object() {
            let config = Reflect::get(metadata, &"decoderConfig".into())?;
            if config.is_object() {
                let description = Reflect::get(&config, &"description".into())?;
                *self.configuration.borrow_mut() = Uint8Array::new(&description).to_vec();
            }
        }
        self.changed.notify();
        Ok(())
    }

    /// Notes the end; the first one counts.
    fn end(&self, end: Result<(), String>) {
        self.end.borrow_mut().get_or_insert(end);
        self.changed.notify();
    }
}

/// An encoder at work; dropping it closes it.
pub(in crate::media::export) struct Pipe<'a> {
    video: &'a Video,
    progress: Option<&'a dyn Progress>,
    /// Width and height in px, even, as the chroma needs them.
    size: [u16; 2],
    encoder: VideoEncoder,
    output: Rc<EncoderOutput>,
    pictures_put: usize,
}

impl<'a> Pipe<'a> {
    async fn new(video: &'a Video, progress: Option<&'a dyn Progress>) -> Result<Self, Error> {
        let instead = video.instead;
        if !has_codec("VideoEncoder") {
            let why = format!("it needs HTTPS and a browser with WebCodecs; {instead} instead");
            return Err(video.failed(&why));
        }
        let absent = || video.failed(&format!("this browser encodes no H.264 of this size; {instead} instead"));
        let [width, height] = video.size.map(|side| u16::try_from(side.next_multiple_of(2)));
        let (Ok(width), Ok(height)) = (width, height) else { return Err(absent()) };
        let config = video.configuration([width, height]).await.ok_or_else(absent)?;
        let output = Rc::<EncoderOutput>::default();
        // The browser owns the callbacks, since it may call them once more after the encoder is closed.
        let (shared, rate_hz) = (Rc::clone(&output), video.rate_hz);
        let take = Closure::<dyn FnMut(EncodedVideoChunk, JsValue)>::new(move |chunk, metadata| {
            shared.take(&chunk, &metadata, rate_hz).unwrap_or_else(|error| shared.end(Err(message(&error))));
        });
        let shared = Rc::clone(&output);
        let fail = Closure::<dyn FnMut(JsValue)>::new(move |error| shared.end(Err(message(&error))));
        let shared = Rc::clone(&output);
        let dequeue = Closure::<dyn FnMut()>::new(move || shared.changed.notify()).into_js_value();
        let callbacks = object([("output", take.into_js_value()), ("error", fail.into_js_value())]);
        let begin = || {
            let encoder = VideoEncoder::new(&callbacks)?;
            encoder.set_ondequeue(&dequeue);
            encoder.configure(&config).map(|()| encoder)
        };
        let encoder = begin().map_err(|error| video.failed(&message(&error)))?;
        Ok(Self { video, progress, size: [width, height], encoder, output, pictures_put: 0 })
    }

    /// Appends a picture `times` times: rows of RGB.
    ///
    /// # Errors
    /// If the browser fails or the work was cancelled.
    pub async fn put(&mut self, rgb: &[u8], times: u32) -> Result<(), Error> {
        let size = self.size.map(u32::from);
        let rgba = padded(rgb, self.video.size, size);
        let planes = planes::yuv420(&rgba, size.into(), YuvStandardMatrix::Bt709);
        let planes = planes.ok_or_else(|| self.video.failed(&"a picture has another size"))?;
        let planes = Uint8Array::from(planes.as_slice());
        for _ in 0..times {
            self.settled(|pipe| pipe.encoder.encode_queue_size() < MOST_WAITING).await?;
            self.encode(&planes).map_err(|error| self.video.failed(&message(&error)))?;
            self.pictures_put += 1;
        }
        Ok(())
    }

    fn encode(&self, planes: &Uint8Array) -> Result<(), JsValue> {
        let names = ["primaries", "transfer", "matrix"].map(|key| (key, "bt709".into()));
        let colors = object(names);
        Reflect::set(&colors, &"fullRange".into(), &false.into())?;
        let rate_hz = self.video.rate_hz;
        let init = object([
            ("format", "I420".into()),
            ("codedWidth", self.size[0].into()),
            ("codedHeight", self.size[1].into()),
            ("timestamp", (self.pictures_put as f64 * US / rate_hz).round().into()),
            ("duration", (US / rate_hz).round().into()),
            ("colorSpace", colors.into()),
        ]);
        let frame = VideoFrame::new(planes, &init)?;
        let options = object([("keyFrame", self.pictures_put.is_multiple_of(KEY_INTERVAL).into())]);
        let encoded = self.encoder.encode(&frame, &options);
        frame.close();
        encoded
    }

    /// Waits until the encoder `is_ready`.
    async fn settled(&self, is_ready: impl Fn(&Self) -> bool) -> Result<(), Error> {
        let look = || match &*self.output.end.borrow() {
            Some(Err(why)) => Some(Err(self.video.failed(why))),
            _ => is_ready(self).then_some(Ok(())),
        };
        // Counted in polls: a sleeping tab must not time out.
        let mut silent = Duration::ZERO;
        while silent < PATIENCE {
            if self.progress.is_some_and(|progress| progress.cancelled()) {
                return Err(Error::new("saving was cancelled"));
            }
            if let Some(settled) = self.output.changed.until_within(POLL, look).await {
                return settled;
            }
            silent += POLL;
        }
        let why = format!("the browser took nothing for {} s; {} instead", PATIENCE.as_secs(), self.video.instead);
        Err(self.video.failed(&why))
    }

    /// The file of all pictures.
    async fn finish(self) -> Result<Vec<u8>, Error> {
        let (flushed, output) = (self.encoder.flush(), Rc::clone(&self.output));
        spawn_local(async move {
            let flushed = match flushed {
                Ok(flushed) => JsFuture::from(flushed).await.map(drop),
                Err(error) => Err(error),
            };
            output.end(flushed.map_err(|error| message(&error)));
        });
        self.settled(|pipe| pipe.output.end.borrow().is_some()).await?;
        let (pictures, configuration) = (self.output.pictures.take(), self.output.configuration.take());
        if pictures.len() != self.pictures_put || configuration.is_empty() {
            let [encoded, put] = [pictures.len(), self.pictures_put];
            let why = format!("the browser encoded {encoded} of {put} pictures; {} instead", self.video.instead);
            return Err(self.video.failed(&why));
        }
        let stream = Stream { size: self.size, rate: self.video.rate(), configuration, pictures };
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
    async fn configuration(&self, [width, height]: [u16; 2]) -> Option<Object> {
        let bits_per_pixel = BITS_PER_PIXEL * ((16.0 - f64::from(self.crf)) / 6.0).exp2();
        let bits_per_second = (f64::from(width) * f64::from(height) * self.rate_hz * bits_per_pixel).round();
        for codec in codecs([width, height], self.rate_hz, bits_per_second) {
            let config = object([
                ("codec", codec.into()),
                ("width", width.into()),
                ("height", height.into()),
                ("framerate", self.rate_hz.into()),
                ("bitrate", bits_per_second.into()),
                ("latencyMode", "quality".into()),
                ("avc", object([("format", "avc".into())]).into()),
            ]);
            if supports("VideoEncoder", &config).await {
                return Some(config);
            }
        }
        None
    }
}

/// The pixels in RGBA, with black beyond the right and lower edge where `to` is larger.
fn padded(rgb: &[u8], [width, height]: [usize; 2], to: [u32; 2]) -> Vec<u8> {
    let [row, rows] = to.map(|side| side as usize);
    let mut rgba = [0, 0, 0, u8::MAX].repeat(row * rows);
    for (to, from) in rgba.chunks_exact_mut(4 * row).zip(rgb.chunks_exact(3 * width)).take(height) {
        for (to, from) in to.chunks_exact_mut(4).zip(from.chunks_exact(3)) {
            to[..3].copy_from_slice(from);
        }
    }
    rgba
}
