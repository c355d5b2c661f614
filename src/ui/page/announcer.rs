//! Tells the page what is shown: screen readers hear the sentence, and tests read the rest.

use web_sys::{Element, HtmlCanvasElement};

use crate::ui::app::Shown;

/// The id of the element that screen readers read aloud when it changes.
const SPOKEN: &str = "sentence";

/// The attribute of the canvas that holds what is shown, as JSON.
const ATTRIBUTE: &str = "data-shown";

/// Writes what is shown into the page.
pub struct Announcer {
    canvas: HtmlCanvasElement,
    spoken: Option<Element>,
    last: Option<Shown>,
}

impl Announcer {
    /// An announcer at the canvas.
    pub fn new(canvas: HtmlCanvasElement) -> Self {
        let spoken = canvas.owner_document().and_then(|document| document.get_element_by_id(SPOKEN));
        Self { canvas, spoken, last: None }
    }

    /// Writes what is shown if it has changed.
    pub fn announce(&mut self, shown: Shown) {
        if self.last.as_ref() == Some(&shown) {
            return;
        }
        // A page that was changed by an extension of the browser may refuse; the window goes on without it.
        let json = serde_json::to_string(&shown).unwrap_or_default();
        self.canvas.set_attribute(ATTRIBUTE, &json).ok();
        let words = shown.error.as_deref().or(shown.sentence.as_deref()).unwrap_or_default();
        if let Some(spoken) = self.spoken.as_ref().filter(|spoken| spoken.text_content().as_deref() != Some(words)) {
            spoken.set_text_content(Some(words));
        }
        self.last = Some(shown);
    }
}
