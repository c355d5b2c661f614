//! How a step is looked at, declared once: the flags of pictures, the `[picture]` of a session and what the window chooses
//! follow from the entries of [`Look`].

mod values;

use std::collections::BTreeMap;

use motionscope_core::{Error, Params, Spec, Value, params};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub use values::CaptionWords;

use crate::paint::{
    ArrowStyle, ColorMap, FlowLayer, Lengthen, LevelShown, Opacity, Phase, Pictures, Share, Style, Theme, View,
};

params! {
    /// How a step is looked at, in the window and in pictures.
    #[derive(Copy, PartialEq)]
    pub struct Look {
        /// Which pictures are shown, those of the prediction only at the end of a run; auto is what suits the step.
        view: Option<View> = None;
        /// The level of a pyramid that is shown, 0 for the picture itself.
        level: LevelShown = LevelShown::AtWork;
        /// The share of frame t+1 in a blend.
        blend: Share = Share::default();
        /// Colours and sizes of marks and type.
        theme: Theme = Theme::Dark;
        /// The colours of costs and other numbers.
        colors: ColorMap = ColorMap::Viridis;
        /// The colours that tell of the motion of every pixel; auto is what suits the estimator.
        layer: Option<FlowLayer> = None;
        /// How far the colours of motion hide the picture; auto is what suits the layer.
        layer_opacity: Option<Opacity> = None;
        /// From one arrow, or one particle, to the next, in px of the clip; auto is as many as there is room for.
        arrow_spacing: Option<u16> = None, 1..=256, "px";
        /// How many times their length displacements are drawn, which the legend says; auto is as long as fits.
        arrow_scale: Lengthen = Lengthen::Auto;
        /// Streaklines in the place of arrows, at this moment of a particle's life.
        streaks: Option<Phase> = None;
        /// What the marks mean, below the pictures.
        legend: bool = false;
        /// Clip, estimator, parameters and the sentence of the step, around the pictures; full adds the formula.
        caption: CaptionWords = CaptionWords::Off;
    }
}

/// Where a run stands, as far as the choice of a view depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stands {
    /// Whether its estimator looks at single frames.
    pub is_of_single_frames: bool,
    /// Whether it is at its end.
    pub at_end: bool,
    /// Whether it is one of several in lockstep.
    pub is_lockstep: bool,
}

impl Look {
    /// What there is to choose, in the order in which a person reads it.
    pub fn entries() -> &'static [Spec] {
        Self::default().specs()
    }

    /// How the window looks until something else is chosen.
    pub fn of_window() -> Self {
        Self { view: Some(View::default()), legend: true, ..Self::default() }
    }

    /// How `pictures` are drawn.
    pub fn style(&self, pictures: &Pictures) -> Style {
        let Self { theme, colors, arrow_scale, arrow_spacing, streaks, .. } = *self;
        let streak_frames = pictures.streaks.as_ref().filter(|_| streaks.is_some()).map(|all| all.life_frames());
        let arrows = ArrowStyle { lengthen: arrow_scale, spacing_px: arrow_spacing, streak_frames };
        Style { theme, colors, arrows }
    }

    /// The view that it chooses of `pictures`, or what suits the step: a finished field needs only frame t, as an estimator of
    /// single frames does; a search needs both. Each of several in lockstep has one picture.
    pub fn view_of(&self, pictures: &Pictures, stands: Stands) -> View {
        let Stands { is_of_single_frames, at_end, is_lockstep } = stands;
        let fitting = if at_end || is_of_single_frames { View::Current } else { View::SideBySide };
        let view = self.view.unwrap_or(fitting).or_current(pictures);
        if is_lockstep { view.alone(at_end) } else { view }
    }

    /// Whether the pictures of a step stand side by side, one by one or in turn, unless something else is chosen.
    pub fn shows_beside(&self, is_of_single_frames: bool) -> bool {
        match self.view {
            None => !is_of_single_frames,
            Some(view) => matches!(view, View::SideBySide | View::Blink),
        }
    }

    /// Whether `other` shows the same of a step, as far as that is worked out before it is drawn.
    pub fn shows_same_step(&self, other: &Self) -> bool {
        let beside = |look: &Self| [false, true].map(|is_single| look.shows_beside(is_single));
        self.shows_same_motion(other) && beside(self) == beside(other)
    }

    /// Whether `other` shows the same of motion, so that nothing of it has to be worked out anew.
    pub fn shows_same_motion(&self, other: &Self) -> bool {
        let motion = |look: &Self| {
            let Self { layer, layer_opacity, colors, arrow_spacing, streaks, .. } = *look;
            (layer, layer_opacity, colors, arrow_spacing, streaks.is_some())
        };
        motion(self) == motion(other)
    }
}

/// Entries of a look that are set; the others are left as they are where it is laid [over](Changes::over) a look.
#[derive(Clone, Debug, PartialEq)]
pub struct Changes {
    /// One for each entry, in order; a value is one that the entry may have.
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
    /// Sets entry `index` of [`Look::entries`] from what a person typed.
    ///
    /// # Errors
    /// A sentence with what may be given.
    ///
    /// # Panics
    /// If there is no such entry.
    pub fn set(&mut self, index: usize, text: &str) -> Result<(), Error> {
        self.values[index] = Some(Look::entries()[index].parse(text)?);
        Ok(())
    }

    /// Whether the entry called `name` is set.
    pub fn has(&self, name: &str) -> bool {
        self.entries().any(|(spec, _)| spec.name == name)
    }

    /// The entries that are set, with their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Spec, &Value)> {
        Look::entries().iter().zip(&self.values).filter_map(|(spec, value)| Some((spec, value.as_ref()?)))
    }

    /// `look` with the entries that are set.
    #[must_use]
    pub fn over(&self, mut look: Look) -> Look {
        for (index, value) in self.values.iter().enumerate() {
            // What stands here was checked when it was set.
            value.iter().for_each(|value| look.set_value(index, value.clone()).unwrap_or_default());
        }
        look
    }

    /// The same, with what `later` sets in the place of it.
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
    /// What is not known, as another version may have written it, is left as the window has it at first.
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
    fn every_entry_is_read_as_it_is_told_and_remembered() {
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
        file.set(3, "light").unwrap();
        file.set(10, "on").unwrap();
        let mut flags = Changes::default();
        flags.set(3, "projector").unwrap();
        let before = Look { arrow_spacing: Some(9), ..Look::default() };
        let after = file.then(&flags).over(before);
        assert_eq!(after, Look { theme: Theme::Projector, legend: true, ..before });
        assert_eq!(Changes::default().over(before), before);
        assert_eq!(Changes::from(after).over(Look::of_window()), after);
    }

    #[test]
    fn what_is_worked_out_before_it_is_drawn_is_told_from_the_rest() {
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
