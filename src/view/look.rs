//! The view options, declared once: flags of the command line, the `[picture]` section of a session and the settings of the window
//! all follow from the entries of [`Look`].
//!
//! `Changes` are the options that are set explicitly. A new option is a line in the declaration and its effect in
//! `rendering.rs`; a test sets every option by flag, session and window and compares the pictures.

mod values;

use std::collections::BTreeMap;

use motionscope_core::base::Error;
use motionscope_core::params;
use motionscope_core::params::{Params, Spec, Value};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub use values::CaptionWords;

use crate::paint::{
    ArrowStyle, Backdrop, ColorMap, FlowLayer, FocusMode, Lengthen, LevelShown, Opacity, Phase, Pictures, Share, Style,
    SvgText, Theme, View,
};

params! {
    /// The view options of the window and of pictures.
    #[derive(Copy, PartialEq)]
    pub struct Look {
        /// Which pictures are shown; prediction and residual exist at the end of a run, auto chooses by the step.
        view: Option<View> = None;
        /// Pyramid level to show; level 0 is the full-resolution frame.
        level: LevelShown = LevelShown::AtWork;
        /// Whether the part in which a step works is shown magnified, with the whole picture as a small map.
        focus: FocusMode = FocusMode::Auto;
        /// Weight of frame t + 1 in the blend.
        blend: Share = Share::default();
        /// Colours and sizes of marks and text.
        theme: Theme = Theme::Dark;
        /// Colour map of costs and other scalars.
        colors: ColorMap = ColorMap::Viridis;
        /// Flow colours over the picture; auto chooses by the estimator.
        layer: Option<FlowLayer> = None;
        /// Opacity of the flow colours; auto chooses by the layer.
        layer_opacity: Option<Opacity> = None;
        /// Displacement or error in px at the end of the colour scale, the same at every step; auto is the range of the step.
        color_scale: Option<f32> = None, 0.01..=1000.0, "px";
        /// How the picture under the flow colours is shown.
        backdrop: Backdrop = Backdrop::Dimmed;
        /// Spacing of arrows or particles in px of the clip; auto chooses by the size of the picture.
        arrow_spacing: Option<u16> = None, 1..=256, "px";
        /// Scale factor of arrows, shown in the legend; auto fills the space between them.
        arrow_scale: Lengthen = Lengthen::Auto;
        /// Streaklines instead of arrows, at this phase of the particles' life.
        streaks: Option<Phase> = None;
        /// The picture leaned back where the costs of a step rise from it as a landscape.
        landscape: bool = false;
        /// Legend of the marks below the pictures.
        legend: bool = false;
        /// Clip, estimator, parameters and the sentence of the step, around the pictures; full adds the formula.
        caption: CaptionWords = CaptionWords::Off;
        /// Words and formulas of SVG pictures: outlines need no font where they are opened, live text can be searched and edited.
        svg_text: SvgText = SvgText::Outlines;
    }
}

/// The state of a run on which the automatic choice of a view depends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunState {
    /// Whether frame t alone shows the estimator.
    pub shows_frame_alone: bool,
    /// Whether the run is at its end.
    pub at_end: bool,
    /// Whether several estimators run in lockstep.
    pub is_lockstep: bool,
    /// Whether these search blocks of frame t + 1.
    pub is_search: bool,
    /// Whether the step relates its pictures to each other, by links or by the response of a filter.
    pub is_joined: bool,
}

impl Look {
    /// Returns the options, in the order in which they are shown.
    pub fn entries() -> &'static [Spec] {
        Self::default().specs()
    }

    /// Returns the defaults of the window.
    pub fn of_window() -> Self {
        Self { view: Some(View::default()), legend: true, ..Self::default() }
    }

    /// Returns the options with which the window opens a run: both frames for an estimator of pairs, frame t for one of single frames.
    pub fn opening(shows_frame_alone: bool) -> Self {
        let view = if shows_frame_alone { View::Current } else { View::default() };
        Self { view: Some(view), ..Self::of_window() }
    }

    /// Returns the style in which `pictures` are drawn.
    pub fn style(&self, pictures: &Pictures) -> Style {
        let Self { theme, colors, arrow_scale, arrow_spacing, streaks, .. } = *self;
        let streak_frames = pictures.streaks.as_ref().filter(|_| streaks.is_some()).map(|all| all.life_frames());
        let arrows = ArrowStyle { lengthen: arrow_scale, spacing_px: arrow_spacing, streak_frames };
        Style { theme, colors, arrows }
    }

    /// Returns the chosen view of `pictures`, or the automatic one: frame t for a finished field or an estimator of single frames,
    /// both frames during a search and where the step relates them, and one picture for each estimator in lockstep.
    pub fn view_of(&self, pictures: &Pictures, stands: RunState) -> View {
        let RunState { shows_frame_alone, at_end, is_lockstep, is_search, is_joined } = stands;
        let is_alone = !is_joined && (at_end || shows_frame_alone);
        let fitting = if is_alone { View::Current } else { View::SideBySide };
        let view = self.view.unwrap_or(fitting).or_current(pictures);
        if is_lockstep { view.alone(is_search && !at_end) } else { view }
    }

    /// Whether the pictures of a step are shown side by side or in turn.
    pub fn shows_beside(&self, shows_frame_alone: bool) -> bool {
        match self.view {
            None => !shows_frame_alone,
            Some(view) => matches!(view, View::SideBySide | View::Blink),
        }
    }

    /// Whether `other` shares everything of a step that is computed before drawing.
    pub fn shows_same_step(&self, other: &Self) -> bool {
        let beside = |look: &Self| [false, true].map(|is_single| look.shows_beside(is_single));
        self.shows_same_motion(other) && beside(self) == beside(other)
    }

    /// Whether `other` shares the flow layer, so that it need not be recomputed.
    pub fn shows_same_motion(&self, other: &Self) -> bool {
        let motion = |look: &Self| {
            let Self { layer, layer_opacity, color_scale, colors, arrow_spacing, streaks, .. } = *look;
            (layer, layer_opacity, color_scale, colors, arrow_spacing, streaks.is_some())
        };
        motion(self) == motion(other)
    }
}

/// Options that are set explicitly; the others stay when [applied](Changes::over) to a look.
#[derive(Clone, Debug, PartialEq)]
pub struct Changes {
    /// One valid value or `None` for each option, in order.
    values: Vec<Option<Value>>,
}

impl Default for Changes {
    fn default() -> Self {
        Self { values: vec![None; Look::entries().len()] }
    }
}

impl From<Look> for Changes {
    fn from(look: Look) -> Self {
        Self { values: look.values().into_iter().map(|(_, value)| Some(value)).collect() }
    }
}

impl Changes {
    /// Sets option `index` of [`Look::entries`] from text.
    ///
    /// # Errors
    /// A sentence with the allowed values.
    ///
    /// # Panics
    /// If there is no such option.
    pub fn set(&mut self, index: usize, text: &str) -> Result<(), Error> {
        self.values[index] = Some(Look::entries()[index].parse(text)?);
        Ok(())
    }

    /// Returns these options without `name`.
    #[must_use]
    pub fn without(mut self, name: &str) -> Self {
        let all = self.values.iter_mut().zip(Look::entries());
        all.filter(|(_, spec)| spec.name == name).for_each(|(value, _)| *value = None);
        self
    }

    /// Whether the option `name` is set.
    pub fn has(&self, name: &str) -> bool {
        self.entries().any(|(spec, _)| spec.name == name)
    }

    /// Returns the options that are set, with their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Spec, &Value)> {
        Look::entries().iter().zip(&self.values).filter_map(|(spec, value)| Some((spec, value.as_ref()?)))
    }

    /// Returns `look` with these options set.
    #[must_use]
    pub fn over(&self, mut look: Look) -> Look {
        for (index, value) in self.values.iter().enumerate() {
            // The values were checked when they were set.
            value.iter().for_each(|value| look.set_value(index, value.clone()).unwrap_or_default());
        }
        look
    }

    /// Returns `look` with these options as in `before`.
    #[must_use]
    pub fn undone(&self, look: Look, before: Look) -> Look {
        let before = Changes::from(before);
        let values = self.values.iter().zip(before.values).map(|(set, before)| set.as_ref().and(before));
        Changes { values: values.collect() }.over(look)
    }

    /// Returns these options with those of `later` in their place.
    #[must_use]
    pub fn then(self, later: &Self) -> Self {
        let values = self.values.into_iter().zip(&later.values).map(|(then, now)| now.clone().or(then));
        Self { values: values.collect() }
    }
}

impl Serialize for Look {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let all: BTreeMap<_, _> = self.values().into_iter().map(|(name, value)| (name, value.to_string())).collect();
        all.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Look {
    /// Unknown options or values, as another version may have written them, keep the defaults of the window.
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let mut look = Self::of_window();
        for (name, text) in BTreeMap::<String, String>::deserialize(from)? {
            look.set(&name, &text).unwrap_or_default();
        }
        Ok(look)
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::params::Kind;

    use super::*;

    /// Some values of an entry, and the word for none.
    fn tried(kind: &Kind) -> Vec<Value> {
        match kind {
            Kind::Int { min, max } => vec![Value::Int(*min), Value::Int(*max)],
            Kind::Real { min, max } => vec![Value::Real(*min), Value::Real((min + max) / 2.0), Value::Real(*max)],
            Kind::Switch => vec![Value::Switch(true), Value::Switch(false)],
            Kind::Choice(all) => all.iter().map(|choice| Value::Choice(choice.name)).collect(),
            Kind::Optional { of, word } => [tried(of), vec![Value::Choice(word)]].concat(),
            Kind::Placed(_) | Kind::Stage(_) => Vec::new(),
        }
    }

    #[test]
    fn every_entry_is_read_as_it_is_reported_and_remembered() {
        let mut count = 0;
        for (index, spec) in Look::entries().iter().enumerate() {
            for value in tried(&spec.kind) {
                let mut look = Look::of_window();
                look.set_value(index, value.clone()).unwrap();
                assert_eq!(look.value(index), value, "{}", spec.name);
                let mut changes = Changes::default();
                changes.set(index, &value.to_string()).unwrap();
                assert!(changes.has(&spec.name) && changes.over(Look::of_window()) == look, "{} {value}", spec.name);
                let text = serde_json::to_string(&look).unwrap();
                assert_eq!(serde_json::from_str::<Look>(&text).unwrap(), look);
                count += 1;
            }
            assert!(spec.doc.ends_with('.'), "{}", spec.name);
        }
        assert!(count > 30, "{count}");
    }

    #[test]
    fn what_is_not_set_is_left_as_it_is() {
        let mut file = Changes::default();
        file.set(4, "light").unwrap();
        file.set(14, "on").unwrap();
        let mut flags = Changes::default();
        flags.set(4, "projector").unwrap();
        let before = Look { arrow_spacing: Some(9), ..Look::default() };
        let after = file.then(&flags).over(before);
        assert_eq!(after, Look { theme: Theme::Projector, legend: true, ..before });
        assert_eq!(Changes::default().over(before), before);
        assert_eq!(Changes::from(after).over(Look::of_window()), after);
    }

    #[test]
    fn what_is_worked_out_before_it_is_drawn_is_reported_from_the_rest() {
        let look = Look::of_window();
        let drawn = Look { theme: Theme::Light, legend: false, arrow_scale: Lengthen::Times(2.0), ..look };
        assert!(look.shows_same_step(&drawn) && look.shows_same_motion(&drawn));
        let alone = Look { view: Some(View::Current), ..look };
        assert!(look.shows_same_motion(&alone) && !look.shows_same_step(&alone), "its pictures stand alone");
        assert!(alone.shows_same_step(&Look { view: Some(View::Next), ..look }));
        for other in [
            Look { layer: Some(FlowLayer::Error), ..look },
            Look { streaks: Some(Phase::default()), ..look },
            Look { arrow_spacing: Some(9), ..look },
            Look { colors: ColorMap::Turbo, ..look },
        ] {
            assert!(!look.shows_same_motion(&other) && !look.shows_same_step(&other), "{other:?}");
        }
        let later = Phase::new(0.5).ok();
        assert!(Look { streaks: later, ..look }.shows_same_step(&Look { streaks: Some(Phase::default()), ..look }));
    }

    #[test]
    fn what_another_version_remembered_is_no_error() {
        let look: Look = serde_json::from_str("{\"view\":\"gone\",\"theme\":\"light\",\"new\":\"1\"}").unwrap();
        assert_eq!(look, Look { theme: Theme::Light, ..Look::of_window() });
    }
}
