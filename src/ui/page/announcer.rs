//! Writes a summary of the window into the page: screen readers hear the sentence, and tests read the rest.

use web_sys::{Element, HtmlCanvasElement};

use crate::ui::app::Summary;

/// The id of the element that screen readers read aloud when it changes.
const SPOKEN: &str = "sentence";

/// The attribute of the canvas with the summary, as JSON.
const ATTRIBUTE: &str = "data-shown";

/// Writes the summary into the page.
pub struct Announcer {
    canvas: HtmlCanvasElement,
    spoken: Option<Element>,
    last: Option<Summary>,
}

impl Announcer {
    /// An announcer at the canvas.
    pub fn new(canvas: HtmlCanvasElement) -> Self {
        let spoken = canvas.owner_document().and_then(|document| document.get_element_by_id(SPOKEN));
        Self { canvas, spoken, last: None }
    }

    /// Writes the summary if it has changed.
    pub fn announce(&mut self, summary: Summary) {
        if self.last.as_ref() == Some(&summary) {
            return;
        }
        // The window goes on where an extension of the browser has changed the page so that it refuses.
        let json = serde_json::to_string(&summary).unwrap_or_default();
        self.canvas.set_attribute(ATTRIBUTE, &json).ok();
        let words = summary.error.as_deref().or(summary.sentence.as_deref()).unwrap_or_default();
        if let Some(spoken) = self.spoken.as_ref().filter(|spoken| spoken.text_content().as_deref() != Some(words)) {
            spoken.set_text_content(Some(words));
        }
        self.last = Some(summary);
    }
}
