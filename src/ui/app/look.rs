//! How pictures and the interface look.

use motionscope_core::base::Error;
use motionscope_core::params::Params;

use super::App;
use crate::paint::{FlowLayer, Theme};
use crate::session::VisiblePart;
use crate::ui::commands::Command;
use crate::ui::stage::Zoom;
use crate::view::look::{Changes, Look};

impl App {
    /// Sets the view option `name` from text.
    ///
    /// # Errors
    /// A sentence with the allowed values; nothing changes then.
    pub fn set_look(&mut self, name: &str, value: &str) -> Result<(), Error> {
        self.settings.look.set(name, value)
    }

    /// Sets the view option of `command`.
    pub(super) fn choose_look(&mut self, command: Command) {
        let set = command.entry().sets.map_or(Ok(()), |(name, value)| self.set_look(name, value));
        set.unwrap_or_else(|error| self.toasts.fail(error.to_string()));
    }

    /// Keeps the scale of the colours as it is here at every step, or lets it follow what is found again.
    pub(super) fn lock_scale(&mut self) {
        let Some(shown) = self.run.view.shown.as_deref() else { return };
        let tiles = shown.tiles.iter().filter_map(|tile| tile.layer.as_ref());
        let layer = shown.pictures.layer.iter().chain(tiles).find(|layer| layer.has_unit());
        let look = &mut self.settings.look;
        match (look.color_scale, layer) {
            (Some(_), _) => look.color_scale = None,
            (None, Some(layer)) => {
                let end = layer.end();
                let set = look.set("color-scale", &end.to_string());
                set.unwrap_or_else(|error| self.toasts.fail(error.to_string()));
            }
            (None, None) => self.toasts.tell("No colours with a scale in px are shown here.".to_owned()),
        }
    }

    /// Takes the next of the layers that there are, or will be at the end of the run.
    pub(super) fn next_layer(&mut self) {
        let Some(shown) = self.run.view.shown.as_deref() else { return };
        let look = &mut self.settings.look;
        let now = shown.available.chosen(look.layer);
        let mut round = FlowLayer::ALL.into_iter().cycle().skip_while(|layer| *layer != now).skip(1);
        look.layer = round.find(|layer| shown.available.why_never(*layer).is_none());
    }

    /// Takes the next of the themes.
    pub(super) fn next_theme(&mut self) {
        let look = &mut self.settings.look;
        let round = Theme::ALL.into_iter().cycle().skip_while(|theme| *theme != look.theme).nth(1);
        look.theme = round.unwrap_or_default();
    }

    /// Looks at the pictures as a session says. A view or a part of them that was chosen for what was open before goes with that.
    pub(super) fn look_as(&mut self, look: &Changes, sight: Option<VisiblePart>) {
        self.settings.look = look.over(Look { view: self.run.own_view(), ..self.settings.look });
        self.panes.states.stage.follow_again();
        if let Some(VisiblePart { center, zoom, .. }) = sight {
            self.panes.states.stage.zoom = Zoom::At { center, scale: zoom };
        }
    }

    /// Magnifies the pictures around what the step is about.
    pub(super) fn magnify(&mut self, factor: f32) {
        let at_hand = self.run.view.shown.as_ref().and_then(|shown| shown.reference()).map(|focus| focus.at);
        self.panes.states.stage.magnify(factor, at_hand);
    }

    /// Enlarges the interface by this much. Where a small window has made it smaller than was asked for, it goes on from what is seen.
    pub(super) fn resize(&mut self, by: f32) {
        self.settings.set_zoom(self.settings.seen_zoom(self.ctx.zoom_factor()) + by);
    }
}
