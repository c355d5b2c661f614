//! Values for the browser, and its errors.

use js_sys::{Object, Reflect};
use wasm_bindgen::JsValue;

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
