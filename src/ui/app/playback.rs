//! Playing: what happens as time passes.

use eframe::egui;
use motionscope_core::run::{Cursor, Direction, Move};

use super::App;
use super::run::order;

impl App {
    /// Lets the time since the last frame pass for the player.
    pub(super) fn play(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|i| i.time);
        let seconds = now - std::mem::replace(&mut self.run.played, now);
        let granularities = self.run.granularities().names().len();
        if self.run.returns_to_page() {
            return;
        }
        let Some(shown) = self.run.view.shown.as_deref().filter(|_| self.run.player.is_playing()) else { return };
        let is_over = match self.run.player.plays(Direction::Back) {
            true => shown.cursor == Cursor::default(),
            false => shown.at_end,
        };
        if is_over && !self.run.view.busy {
            self.run.player.pause();
            return;
        }
        let end = self.course.end_of_page(self.run.view.shown.as_deref());
        let is_at_end = end.is_some_and(|end| order(shown.cursor) == order(end));
        if self.run.player.plays(Direction::Forward) && is_at_end && !self.run.view.busy {
            self.run.player.pause();
            return;
        }
        self.run.player.pass(seconds);
        if !self.run.view.busy
            && let Some(to) = self.run.player.due((shown.cursor, shown.events), granularities)
        {
            // A page of a lesson is played up to its last step.
            let is_before =
                |end: &Cursor| self.run.player.plays(Direction::Forward) && order(shown.cursor) < order(*end);
            let end = end.filter(is_before);
            let to = match (end, to) {
                (Some(end), Move::To(cursor)) if order(cursor) > order(end) => Move::To(end),
                (_, to) => to,
            };
            // Where a level or a warp ends is known once the run stands there.
            self.run.approached = end.filter(|_| matches!(to, Move::Granularity(..)));
            let asks = self.run.predict.is_on() && self.run.player.plays(Direction::Forward);
            if asks {
                self.run.expect_question();
            }
            // One step at a time, or questions would be passed over.
            self.run.walker.go(if asks { Move::Granularity(granularities - 1, Direction::Forward) } else { to });
        }
        // The walker wakes the window when it is done.
        if !self.run.view.busy {
            ctx.request_repaint_after_secs(self.run.player.wait_secs() as f32);
        }
    }

    /// Plays in the direction `way`, or pauses if it does; from where it cannot go on, it begins at the other end.
    pub(super) fn toggle_play(&mut self, way: Direction) {
        if self.run.player.plays(way) {
            return self.run.player.pause();
        }
        let now = self.now();
        match way {
            Direction::Forward if self.replays_page() => {}
            Direction::Forward if now.at_end => self.run.walker.go(Move::To(Cursor::default())),
            Direction::Back if now.at_start => self.run.walker.go(Move::End),
            _ => {}
        }
        self.run.player.play(way);
    }
}
