//! The address of the page in the browser's own bar.

use std::ffi::OsString;

use wasm_bindgen::JsValue;

use crate::ui::model::address::{AddressBar, Entry};

/// The bar of the browser.
pub(super) struct LocationBar {
    window: web_sys::Window,
}

impl LocationBar {
    /// The bar above the page.
    pub fn new(window: web_sys::Window) -> Self {
        Self { window }
    }

    /// The link that the page was opened with, if it has one.
    pub fn link(&self) -> Option<OsString> {
        let fragment = self.fragment();
        (!fragment.is_empty()).then(|| format!("#{fragment}").into())
    }
}

impl AddressBar for LocationBar {
    fn base(&self) -> String {
        let whole = self.window.location().href().unwrap_or_default();
        whole.split('#').next().unwrap_or_default().to_owned()
    }

    fn fragment(&self) -> String {
        self.window.location().hash().unwrap_or_default().trim_start_matches('#').to_owned()
    }

    fn write(&mut self, fragment: &str, entry: Entry) -> bool {
        let Ok(history) = self.window.history() else { return false };
        let address = if fragment.is_empty() { self.base() } else { format!("#{fragment}") };
        let written = match entry {
            Entry::New => history.push_state_with_url(&JsValue::NULL, "", Some(&address)),
            Entry::Same => history.replace_state_with_url(&JsValue::NULL, "", Some(&address)),
        };
        // A browser refuses entries that come too fast.
        written.is_ok()
    }
}
