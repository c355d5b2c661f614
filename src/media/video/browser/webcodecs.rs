//! The part of the browser's decoder (WebCodecs) that is used. web-sys declares it only behind an unstable flag of the compiler.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use js_sys::{Object, Promise, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_time::Duration;

use super::config::Config;
use super::picture::{KnownColors, matrix};
use crate::media::javascript::{message, object, supports};
use crate::work::Signal;

/// Samples that wait in the decoder at most.
const MOST_WAITING: u32 = 8;
/// Decoded pictures that wait at most: decoders in hardware have few.
const MOST_PICTURES: usize = 2;

#[wasm_bindgen]
extern "C" {
    type VideoDecoder;
    #[wasm_bindgen(constructor, catch)]
    fn new(callbacks: &Object) -> Result<VideoDecoder, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn configure(this: &VideoDecoder, config: &Object) -> Result<(), JsValue>;
    #[wasm_bindgen(method, catch)]
    fn decode(this: &VideoDecoder, chunk: &EncodedVideoChunk) -> Result<(), JsValue>;
    #[wasm_bindgen(method, catch)]
    fn flush(this: &VideoDecoder) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn close(this: &VideoDecoder) -> Result<(), JsValue>;
    #[wasm_bindgen(method, getter, js_name = decodeQueueSize)]
    fn decode_queue_size(this: &VideoDecoder) -> u32;
    #[wasm_bindgen(method, setter, js_name = ondequeue)]
    fn set_ondequeue(this: &VideoDecoder, callback: &JsValue);

    type EncodedVideoChunk;
    #[wasm_bindgen(constructor, catch)]
    fn new(init: &Object) -> Result<EncodedVideoChunk, JsValue>;

    /// A decoded picture, which belongs to the decoder and must be closed.
    #[derive(Clone)]
    pub(super) type VideoFrame;
    #[wasm_bindgen(method, getter)]
    fn format(this: &VideoFrame) -> Option<String>;
    #[wasm_bindgen(method, getter)]
    fn timestamp(this: &VideoFrame) -> f64;
    #[wasm_bindgen(method, getter, js_name = visibleRect)]
    fn visible_rect(this: &VideoFrame) -> JsValue;
    #[wasm_bindgen(method, getter, js_name = colorSpace)]
    fn color_space(this: &VideoFrame) -> JsValue;
    #[wasm_bindgen(method, js_name = allocationSize, catch)]
    fn allocation_size(this: &VideoFrame, options: &Object) -> Result<u32, JsValue>;
    #[wasm_bindgen(method, js_name = copyTo, catch)]
    fn copy_to(this: &VideoFrame, buffer: &Uint8Array, options: &Object) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, js_name = close)]
    fn close_frame(this: &VideoFrame);
}

fn described(config: &Config) -> Object {
    let object = object([("codec", config.codec.as_str().into())]);
    if let Some(description) = &config.description {
        drop(Reflect::set(&object, &"description".into(), &Uint8Array::from(description.as_slice())));
    }
    object
}

/// Whether the browser has a decoder for a track.
pub(super) async fn is_supported(config: &Config) -> bool {
    supports("VideoDecoder", &described(config)).await
}

/// News of a decoder.
pub(super) enum Event {
    /// A picture, in the order of their times.
    Picture(VideoFrame),
    /// It takes another sample.
    Hungry,
    /// All samples are decoded.
    Ended,
    /// It has stopped, and why.
    Failed(String),
}

#[derive(Default)]
struct Shared {
    pictures: RefCell<VecDeque<VideoFrame>>,
    end: RefCell<Option<Result<(), String>>>,
    is_closed: Cell<bool>,
    changed: Signal,
}

impl Shared {
    /// Takes a picture, unless the decoder is closed.
    fn take(&self, picture: VideoFrame) {
        if self.is_closed.get() {
            return picture.close_frame();
        }
        self.pictures.borrow_mut().push_back(picture);
        self.changed.notify();
    }

    fn end(&self, end: Result<(), JsValue>) {
        self.end.borrow_mut().get_or_insert(end.map_err(|error| message(&error)));
        self.changed.notify();
    }
}

/// A decoder at work; dropping it closes it.
pub(super) struct Decoder {
    decoder: VideoDecoder,
    shared: Rc<Shared>,
}

impl Decoder {
    /// A decoder for a track.
    ///
    /// # Errors
    /// The browser's reason if it has none.
    pub(super) fn new(config: &Config) -> Result<Self, String> {
        let shared = Rc::<Shared>::default();
        let theirs = Rc::clone(&shared);
        // The browser owns them, since it may call them once more after the decoder is closed.
        let output = Closure::<dyn FnMut(VideoFrame)>::new(move |picture| theirs.take(picture)).into_js_value();
        let theirs = Rc::clone(&shared);
        let error = Closure::<dyn FnMut(JsValue)>::new(move |error| theirs.end(Err(error))).into_js_value();
        let theirs = Rc::clone(&shared);
        let dequeue = Closure::<dyn FnMut()>::new(move || theirs.changed.notify()).into_js_value();
        let callbacks = object([("output", output), ("error", error)]);
        let begin = || {
            let decoder = VideoDecoder::new(&callbacks)?;
            decoder.set_ondequeue(&dequeue);
            decoder.configure(&described(config)).map(|()| decoder)
        };
        let decoder = begin().map_err(|error| message(&error))?;
        Ok(Self { decoder, shared })
    }

    /// Gives it a sample, which is shown at `time` µs.
    pub(super) fn feed(&self, sample: &[u8], time: f64, is_key: bool) {
        let kind = if is_key { "key" } else { "delta" };
        let init = [("type", kind.into()), ("timestamp", time.into()), ("data", Uint8Array::from(sample).into())];
        let fed = EncodedVideoChunk::new(&object(init)).and_then(|chunk| self.decoder.decode(&chunk));
        if fed.is_err() {
            self.shared.end(fed);
        }
    }

    /// Has it decode what it holds back: there are no more samples.
    pub(super) fn flush(&self) {
        let shared = Rc::clone(&self.shared);
        let flushed = self.decoder.flush();
        spawn_local(async move {
            let flushed = match flushed {
                Ok(flushed) => JsFuture::from(flushed).await.map(drop),
                Err(error) => Err(error),
            };
            shared.end(flushed);
        });
    }

    /// Waits for news, but no longer than `longest`; `has_samples` tells whether there are samples that it was not given.
    pub(super) async fn event(&self, has_samples: bool, longest: Duration) -> Option<Event> {
        let look = || {
            let mut pictures = self.shared.pictures.borrow_mut();
            let is_hungry = || self.decoder.decode_queue_size() < MOST_WAITING;
            match (pictures.len(), &*self.shared.end.borrow()) {
                (0, Some(Ok(()))) => Some(Event::Ended),
                (0, Some(Err(why))) => Some(Event::Failed(why.clone())),
                (0..MOST_PICTURES, None) if has_samples && is_hungry() => Some(Event::Hungry),
                _ => pictures.pop_front().map(Event::Picture),
            }
        };
        self.shared.changed.until_within(longest, look).await
    }
}

impl Drop for Decoder {
    fn drop(&mut self) {
        self.shared.is_closed.set(true);
        // One that has failed is closed already.
        self.decoder.close().unwrap_or_default();
        self.shared.pictures.borrow_mut().drain(..).for_each(|picture| picture.close_frame());
    }
}

/// The pixels of a picture as the browser copies them.
pub(super) struct Pixels {
    /// The name of their format in WebCodecs.
    pub format: String,
    /// Width and height in px.
    pub size: (usize, usize),
    /// The planes without gaps.
    pub bytes: Vec<u8>,
    /// The colours as far as the browser tells.
    pub colors: KnownColors,
}

impl VideoFrame {
    /// The time that its sample was given, in µs.
    pub(super) fn time(&self) -> f64 {
        self.timestamp()
    }

    /// Copies the pixels, and gives the picture back to the decoder.
    ///
    /// # Errors
    /// The browser's reason if it cannot copy them.
    pub(super) async fn take_pixels(self) -> Result<Pixels, String> {
        let pixels = self.pixels().await.map_err(|error| message(&error));
        self.close_frame();
        pixels
    }

    async fn pixels(&self) -> Result<Pixels, JsValue> {
        let number = |of: &JsValue, key: &str| Reflect::get(of, &key.into()).map(|value| value.as_f64().unwrap_or(0.0));
        let rect = self.visible_rect();
        let size = (number(&rect, "width")? as usize, number(&rect, "height")? as usize);
        let space = self.color_space();
        let colors = KnownColors {
            matrix: Reflect::get(&space, &"matrix".into())?.as_string().and_then(|name| matrix(&name)),
            is_full_range: Reflect::get(&space, &"fullRange".into())?.as_bool(),
        };
        let (format, options) = match self.format() {
            Some(format) => (format, Object::new()),
            // Pixels that only the graphics card knows.
            None => ("RGBA".to_owned(), object([("format", "RGBA".into())])),
        };
        let buffer = Uint8Array::new_with_length(self.allocation_size(&options)?);
        JsFuture::from(self.copy_to(&buffer, &options)?).await?;
        Ok(Pixels { format, size, bytes: buffer.to_vec(), colors })
    }
}
