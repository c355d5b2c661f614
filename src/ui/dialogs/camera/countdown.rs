//! The countdown before a recording, in which the lecturer steps before the camera.

use eframe::egui::{Align2, Color32, Context, FontId, Rect, Ui};
use web_time::{Duration, Instant};

use crate::ui::drawing::style;

/// Its length in seconds.
pub const SECONDS: u32 = 3;
/// How often the number is looked at: it changes in time even where no frame comes.
const NEWS: Duration = Duration::from_millis(50);
/// Height of the number and radius of the disc behind it, in shares of the height of the picture.
const NUMBER: f32 = 0.4;
const DISC: f32 = 0.3;

/// A countdown that is running.
pub struct Countdown {
    ends: Instant,
}

impl Countdown {
    /// A countdown that begins at `now`.
    pub fn from(now: Instant) -> Self {
        Self { ends: now + Duration::from_secs(SECONDS.into()) }
    }

    /// The number that is shown at `now`, in seconds; `None` once it is over.
    pub fn number(&self, now: Instant) -> Option<u32> {
        let left = self.ends.saturating_duration_since(now);
        (!left.is_zero()).then(|| left.as_secs_f32().ceil() as u32)
    }

    /// Has the number drawn again in time.
    pub fn tend(&self, ctx: &Context) {
        ctx.request_repaint_after(NEWS);
    }

    /// Paints the number over the picture in `rect`, large enough to be read from before the camera.
    pub fn paint(&self, ui: &Ui, rect: Rect) {
        let height = rect.height().min(rect.width());
        let Some(number) = self.number(Instant::now()).filter(|_| height > 1.0) else { return };
        let painter = ui.painter();
        // On a picture of any colours.
        painter.circle_filled(rect.center(), DISC * height, Color32::from_black_alpha(190));
        let font = FontId::new((NUMBER * height).round(), style::bold());
        painter.text(rect.center(), Align2::CENTER_CENTER, number.to_string(), font, Color32::WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_counts_from_three_to_one() {
        let begun = Instant::now();
        let countdown = Countdown::from(begun);
        let shown = [0, 900, 1100, 2100, 2999, 3000, 9000];
        let shown = shown.map(|ms| countdown.number(begun + Duration::from_millis(ms)));
        assert_eq!(shown, [Some(3), Some(3), Some(2), Some(1), Some(1), None, None]);
    }
}
