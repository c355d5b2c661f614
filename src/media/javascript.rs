//! Helpers for JavaScript objects, errors and codecs of the browser.

use js_sys::{Function, Object, Promise, Reflect};
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;

/// An object of JavaScript with these values.
pub(super) fn object<const N: usize>(entries: [(&str, JsValue); N]) -> Object {
    let object = Object::new();
    // A plain object takes every value.
    entries.into_iter().for_each(|(key, value)| drop(Reflect::set(&object, &key.into(), &value)));
    object
}

/// The message of an error of the browser.
pub(super) fn message(error: &JsValue) -> String {
    let message = Reflect::get(error, &"message".into()).ok().and_then(|message| message.as_string());
    message.filter(|message| !message.is_empty()).unwrap_or_else(|| "it gives no reason".into())
}

/// Whether the browser has `VideoDecoder` or `VideoEncoder` of WebCodecs, which pages over HTTPS and on the own machine have.
pub(super) fn has_codec(class: &str) -> bool {
    Reflect::has(&js_sys::global(), &class.into()).unwrap_or(false)
}

/// Whether `VideoDecoder` or `VideoEncoder` supports a configuration.
pub(super) async fn supports(class: &str, config: &Object) -> bool {
    let ask = || {
        let class = Reflect::get(&js_sys::global(), &class.into())?;
        let ask: Function = Reflect::get(&class, &"isConfigSupported".into())?.dyn_into()?;
        ask.call1(&class, config)?.dyn_into::<Promise>()
    };
    let Ok(answer) = ask() else { return false };
    let answer = JsFuture::from(answer).await;
    answer.and_then(|answer| Reflect::get(&answer, &"supported".into())).is_ok_and(|supported| supported.is_truthy())
}
