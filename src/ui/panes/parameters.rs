//! The parameters: what the estimator and a synthetic clip declare, as rows that align.
//!
//! What matters first stands on top, the rest in a fold below; what has no effect just now is disabled and says why.

use std::collections::BTreeSet;

use eframe::egui::collapsing_header::{self, CollapsingState};
use eframe::egui::{
    self, Align, Button, ComboBox, DragValue, Layout, Response, RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo,
    vec2,
};
use lucide_icons::Icon;
use motionscope_core::params::{Choice, Kind, PartKind, Placed, Spec, StageValue, Value};
use motionscope_core::run::lockstep;
use serde::{Deserialize, Serialize};

use crate::paint::Theme;
use crate::ui::commands::{Action, Actions, Command, Owner};
use crate::ui::drawing::style;
use crate::ui::model::document::Document;
use crate::ui::panes::clip_card;
use crate::ui::panes::glossary;
use crate::ui::parts::slider::Slider;
use crate::ui::parts::widgets;

/// What the pane or the strip shows.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// What is open and how it is set.
    pub document: &'a Document,
    /// The parameter of the estimator that is being placed on the picture, if one is.
    pub placing: Option<usize>,
    /// Whether it takes the room of other panes, which come back when it is closed.
    pub can_be_closed: bool,
    /// The look.
    pub theme: Theme,
}

/// Which advanced parameters are unfolded, remembered from one start to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    unfolded: BTreeSet<String>,
}

impl State {
    /// Unfolds the advanced parameters of the estimator with this id.
    pub fn unfold(&mut self, id: &str) {
        self.unfolded.insert(id.to_owned());
    }
}

/// Draws the whole pane.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State, actions: &mut Actions) {
    let document = input.document;
    if input.can_be_closed {
        ui.horizontal(|ui| {
            ui.label(RichText::new("Parameters").family(style::bold()));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let tip = Command::ShowParameters.with_key("Close the parameters; Esc does the same.");
                if widgets::cross(ui, "Close parameters").on_hover_text(tip).clicked() {
                    actions.command(Command::ShowParameters);
                }
            });
        });
    }
    ScrollArea::vertical().id_salt("parameters").auto_shrink(false).show(ui, |ui| {
        ui.set_width(ui.available_width());
        clip_card::show(ui, document, actions);
        ui.add_space(12.0);
        title(ui, "Estimator", Owner::Estimator, document, actions);
        estimator(ui, document, actions);
        if document.parents().len() == 0 {
            beside(ui, input, state, actions);
        }
        group(ui, Owner::Estimator, input, state, actions);
        if document.params(Owner::Difficulty).is_some() {
            ui.add_space(16.0);
            title(ui, "Difficulty of the clip", Owner::Difficulty, document, actions);
            group(ui, Owner::Difficulty, input, state, actions);
        }
        ui.add_space(16.0);
    });
}

/// Most parameters in the strip.
const MOST_IN_STRIP: usize = 3;

/// Draws the parameters that matter most in a line, as many as it has room for: the first ones that are not advanced and have an effect.
pub fn strip(ui: &mut Ui, input: Input<'_>, actions: &mut Actions) {
    ui.spacing_mut().item_spacing.x = 4.0;
    // Menus beside it have no frames; what can be changed has one.
    ui.visuals_mut().widgets.inactive.weak_bg_fill = style::color(input.theme.chrome().raised);
    let all = declared(Owner::Estimator, input).into_iter();
    let offered = all.filter(|row| !row.spec.advanced && row.idle.is_none() && row.fits_strip());
    for row in offered.take(MOST_IN_STRIP) {
        if row.strip_width(ui) > ui.available_width() {
            return;
        }
        Row { is_in_strip: true, ..row }.show(ui, actions);
    }
}

/// A heading, with a button that resets the group when anything in it was changed.
fn title(ui: &mut Ui, text: &str, owner: Owner, document: &Document, actions: &mut Actions) {
    ui.horizontal(|ui| {
        widgets::heading(ui, text);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Reset all: {text}");
            ui.add_enabled_ui(document.is_tuned(owner), |ui| {
                let button = widgets::icon_button(ui, Icon::RotateCcw, &name, false);
                if button.on_hover_text("Reset to the defaults.").clicked() {
                    actions.ask(Action::ResetAll(owner));
                }
            });
        });
    });
}

/// The estimators in lockstep, each with its parameters in a fold, and a list to add one.
fn beside(ui: &mut Ui, input: Input<'_>, state: &mut State, actions: &mut Actions) {
    let document = input.document;
    let companions = &document.side_by_side().beside;
    for (index, companion) in companions.iter().enumerate() {
        let (owner, info) = (Owner::Beside(index), companion.estimator.info());
        let id = ui.make_persistent_id(owner);
        let mut fold = CollapsingState::load_with_default_open(ui.ctx(), id, false);
        let name = format!("{} {}", index + 2, info.name);
        ui.horizontal(|ui| {
            triangle(ui, &mut fold, &name);
            let label = egui::Label::new(name.clone()).truncate().selectable(false).sense(Sense::click());
            let room = ui.available_width() - 2.0 * ui.spacing().interact_size.x;
            let label = ui.scope(|ui| {
                ui.set_max_width(room);
                ui.add(label)
            });
            let tip = "Parameters of this estimator. Those shared with the first estimator follow it until changed.";
            if label.inner.on_hover_text(tip).clicked() {
                fold.toggle(ui);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let leave = widgets::icon_button(ui, Icon::X, &format!("Remove {name}"), false);
                if leave.on_hover_text("Take it out of the lockstep.").clicked() {
                    actions.ask(Action::RemoveBeside(index));
                }
                ui.add_enabled_ui(document.is_tuned(owner), |ui| {
                    let reset = widgets::icon_button(ui, Icon::RotateCcw, &format!("Reset all: {name}"), false);
                    if reset.on_hover_text("Follow the first estimator in every parameter.").clicked() {
                        actions.ask(Action::ResetAll(owner));
                    }
                });
            });
        });
        fold.show_body_unindented(ui, |ui| group(ui, owner, input, state, actions));
    }
    if companions.len() + 1 < *lockstep::MEMBERS.end() {
        let button = ui.button("Add in lockstep");
        let tip = "Run another estimator on the same frames beside this one, or the same one with other parameters.";
        if button.on_hover_text(tip).clicked() {
            actions.ask(Action::ChooseBeside);
        }
    }
    ui.add_space(8.0);
}

/// The estimator, and the way to another one.
fn estimator(ui: &mut Ui, document: &Document, actions: &mut Actions) {
    let info = document.estimator().info();
    let glyph = widgets::icon(ui, Icon::ChevronDown).color(ui.visuals().weak_text_color());
    let button = Button::new(info.name).right_text(glyph).wrap();
    let button = ui.add_sized(vec2(ui.available_width(), ui.spacing().interact_size.y), button);
    let name = format!("Estimator: {}", info.name);
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
    if button.on_hover_text(Command::Estimators.with_key(info.summary)).clicked() {
        actions.command(Command::Estimators);
    }
    ui.add_space(4.0);
}

/// The parameters of the estimator or of a synthetic clip.
fn group(ui: &mut Ui, owner: Owner, input: Input<'_>, state: &mut State, actions: &mut Actions) {
    let section = match owner {
        Owner::Estimator => "of the estimator".to_owned(),
        Owner::Beside(index) => format!("of the estimator beside it, {index}"),
        Owner::Difficulty => "of the clip".to_owned(),
    };
    rows(ui, &section, declared(owner, input), state, actions);
}

/// The parameters of the estimator or of a synthetic clip, as they are declared.
fn declared(owner: Owner, input: Input<'_>) -> Vec<Row<'_>> {
    let Input { document, theme, placing, .. } = input;
    let Some(params) = document.params(owner) else { return Vec::new() };
    let all = params.specs().iter().enumerate().map(|(index, spec)| {
        let (value, default) = (params.value(index), document.default_of(owner, index));
        let is_placing = owner == Owner::Estimator && placing == Some(index);
        Row {
            owner,
            index,
            within: None,
            spec,
            value,
            default,
            idle: params.idle(index),
            open: None,
            theme,
            is_placing,
            is_in_strip: false,
        }
    });
    all.collect()
}

/// Rows below each other, those that are advanced in a fold at the end.
fn rows(ui: &mut Ui, section: &str, all: Vec<Row<'_>>, state: &mut State, actions: &mut Actions) {
    let (advanced, first): (Vec<_>, Vec<_>) = all.into_iter().partition(|row| row.spec.advanced);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        first.iter().for_each(|row| row.whole(ui, state, actions));
        if !advanced.is_empty() {
            fold_advanced(ui, section, &advanced, state, actions);
        }
    });
}

/// The triangle that folds or unfolds what is called `name`.
fn triangle(ui: &mut Ui, fold: &mut CollapsingState, name: &str) -> Response {
    let pressed = fold.show_toggle_button(ui, collapsing_header::paint_default_icon);
    let words = if fold.is_open() { format!("Fold {name}") } else { format!("Unfold {name}") };
    pressed.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &words));
    pressed
}

/// The rows of advanced parameters, folded until they are asked for.
fn fold_advanced(ui: &mut Ui, section: &str, rows: &[Row<'_>], state: &mut State, actions: &mut Actions) {
    let was_open = state.unfolded.contains(section);
    let id = ui.make_persistent_id(("advanced", section));
    let mut fold = CollapsingState::load_with_default_open(ui.ctx(), id, was_open);
    fold.set_open(was_open);
    let changed = rows.iter().filter(|row| row.is_changed()).count();
    let text = if changed > 0 { format!("Advanced ({changed} changed)") } else { "Advanced".to_owned() };
    let header = ui.horizontal(|ui| {
        let pressed = triangle(ui, &mut fold, &text).clicked();
        let label = ui.add(egui::Label::new(widgets::dim(ui, &text)).wrap().selectable(false).sense(Sense::click()));
        label.widget_info(|| WidgetInfo::selected(egui::Role::DisclosureTriangle, true, was_open, &text));
        let tip = "Parameters that are seldom changed.";
        pressed != label.on_hover_text(tip).clicked()
    });
    // A click on the triangle has toggled the fold already.
    let is_open = was_open != header.inner;
    fold.set_open(is_open);
    if is_open != was_open {
        // Toggled: what was there goes, and what was not comes.
        if !state.unfolded.remove(section) {
            state.unfolded.insert(section.to_owned());
        }
    }
    fold.show_body_unindented(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        rows.iter().for_each(|row| row.whole(ui, state, actions));
    });
}

/// The parameters of a stage, set in below its name.
fn of_stage(ui: &mut Ui, parent: &Row<'_>, stage: &StageValue, state: &mut State, actions: &mut Actions) {
    let &Row { owner, index, theme, .. } = parent;
    // A stage of a stage is walked from there.
    let tip = Command::IntoStage.with_key("Step through this stage alone.");
    if parent.within.is_none() && ui.button("Step into").on_hover_text(tip).clicked() {
        actions.ask(Action::Enter(index));
    }
    let id = ui.make_persistent_id((owner, index, &parent.spec.name, stage.id()));
    let part = stage.part();
    // They are many, and good as they are until someone asks.
    let mut fold = CollapsingState::load_with_default_open(ui.ctx(), id, false);
    let header = ui.horizontal(|ui| {
        let words = format!("{} in detail", part.name());
        triangle(ui, &mut fold, &words);
        let name = widgets::dim(ui, words);
        let name = egui::Label::new(name).wrap().selectable(false).sense(Sense::click());
        if ui.add(name).on_hover_text(part.summary()).clicked() {
            fold.toggle(ui);
        }
    });
    fold.show_body_indented(&header.response, ui, |ui| {
        let (withins, is_placing) = (withins(parent, stage), false);
        let all = withins.iter().map(|within| {
            let (inner, spec) = (within.inner, &part.specs()[within.inner]);
            let usual = match &parent.default {
                Some(Value::Stage(usual)) if usual.id() == stage.id() => usual.part().value(inner),
                _ => spec.default.clone(),
            };
            let (value, default) = (part.value(inner), Some(usual));
            let idle = parent.idle.or_else(|| part.idle(inner));
            Row {
                owner,
                index,
                within: Some(within),
                spec,
                value,
                default,
                idle,
                open: None,
                theme,
                is_placing,
                is_in_strip: false,
            }
        });
        rows(ui, "of a part", all.collect(), state, actions);
    });
    ui.add_space(4.0);
}

/// The parameters of `stage` that are shown below its row: what is placed on the picture is set where the stage is opened by
/// itself.
fn withins<'a>(parent: &Row<'a>, stage: &'a StageValue) -> Vec<Within<'a>> {
    let specs = stage.part().specs().iter().enumerate();
    let shown = specs.filter(|(_, spec)| !matches!(spec.kind, Kind::Placed(_)));
    shown.map(|(inner, _)| Within { stage, inner, above: parent.within }).collect()
}

/// A parameter of a stage.
struct Within<'a> {
    /// The stage.
    stage: &'a StageValue,
    /// Which of its parameters.
    inner: usize,
    /// The same of the stage, where that is the parameter of another one.
    above: Option<&'a Within<'a>>,
}

impl Within<'_> {
    /// The outermost stage, with `wanted` for this parameter; `None` where that is out of range.
    fn outermost(&self, wanted: Value) -> Option<Value> {
        let mut stage = self.stage.clone();
        stage.part_mut().set_value(self.inner, wanted).ok()?;
        let stage = Value::Stage(stage);
        match self.above {
            Some(above) => above.outermost(stage),
            None => Some(stage),
        }
    }
}

/// One parameter.
struct Row<'a> {
    owner: Owner,
    index: usize,
    /// Where it is among the parameters of a stage, if it is one of those; `index` is then that of the outermost stage.
    within: Option<&'a Within<'a>>,
    spec: &'a Spec,
    value: Value,
    default: Option<Value>,
    /// Why it has no effect just now, if it has none.
    idle: Option<&'static str>,
    /// The word that leaves its value open, where one may.
    open: Option<&'static str>,
    theme: Theme,
    is_placing: bool,
    /// Whether it stands in the strip, with a small label and without a slider.
    is_in_strip: bool,
}

impl Row<'_> {
    /// The row with what belongs to it, disabled where it has no effect.
    fn whole(&self, ui: &mut Ui, state: &mut State, actions: &mut Actions) {
        ui.add_enabled_ui(self.idle.is_none(), |ui| {
            self.show(ui, actions);
            self.space(ui);
        });
        if let Value::Stage(stage) = &self.value {
            match self.within {
                None => of_stage(ui, self, stage, state, actions),
                Some(_) => drop(ui.indent(("inner", &self.spec.name), |ui| of_stage(ui, self, stage, state, actions))),
            }
        }
    }

    /// Whether it is set by one small widget.
    fn fits_strip(&self) -> bool {
        matches!(self.value, Value::Int(_) | Value::Real(_) | Value::Switch(_) | Value::Choice(_))
            && !matches!(self.spec.kind, Kind::Optional { .. })
    }

    /// Width in the strip, in points.
    fn strip_width(&self, ui: &Ui) -> f32 {
        let (label, spacing) = (self.strip_label(ui), ui.spacing());
        let widget = match self.value {
            Value::Switch(_) => 1.2 * spacing.interact_size.y,
            Value::Choice(_) => self.strip_list(ui),
            _ => self.strip_field(ui),
        };
        STRIP_GAP + label + widget + 3.0 * spacing.item_spacing.x
    }

    fn strip_label(&self, ui: &Ui) -> f32 {
        let font = TextStyle::Small.resolve(ui.style());
        ui.painter().layout_no_wrap(self.spec.label.clone(), font, egui::Color32::PLACEHOLDER).size().x
    }

    /// Width of the field of a number: as wide as its ends.
    fn strip_field(&self, ui: &Ui) -> f32 {
        let ends = match self.spec.kind {
            Kind::Int { min, max } => [min.to_string(), max.to_string()],
            Kind::Real { min, max } => [min, max].map(|end| format!("{end:.*}", decimals(max - min))),
            _ => Default::default(),
        };
        let now = self.value.to_string();
        let widest = ends.iter().chain([&now]).map(|text| text_width(ui, text)).fold(0.0, f32::max);
        widest + text_width(ui, &self.unit()) + 2.0 * ui.spacing().button_padding.x
    }

    /// Width of a list: as wide as the chosen entry.
    fn strip_list(&self, ui: &Ui) -> f32 {
        text_width(ui, &self.shown(&self.value)) + ui.spacing().icon_width + 3.0 * ui.spacing().button_padding.x
    }

    /// The unit behind a number, with a space before it.
    fn unit(&self) -> String {
        if self.spec.unit.is_empty() { String::new() } else { format!(" {}", self.spec.unit) }
    }

    /// Whether it is not as it was at first.
    fn is_changed(&self) -> bool {
        self.default.as_ref().is_some_and(|default| *default != self.value)
    }

    fn show(&self, ui: &mut Ui, actions: &mut Actions) {
        let (wanted, done) = match (&self.spec.kind, &self.value) {
            (Kind::Int { min, max }, Value::Int(value)) => {
                let (wanted, done) = self.number(ui, (*min as f64, *max as f64), *value as f64, actions);
                (Value::Int(wanted.round() as i64), done)
            }
            (Kind::Real { min, max }, Value::Real(value)) => {
                let (wanted, done) = self.number(ui, (*min, *max), *value, actions);
                (Value::Real(wanted), done)
            }
            (Kind::Switch, Value::Switch(on)) => {
                let wanted = self.switch(ui, *on, actions);
                (Value::Switch(wanted), wanted != *on)
            }
            (Kind::Choice(choices), Value::Choice(name)) => {
                let wanted = self.choice(ui, choices, name, actions);
                (Value::Choice(wanted), wanted != *name)
            }
            (Kind::Placed(_), Value::Placed(placed)) => return self.placed(ui, placed, actions),
            (Kind::Stage(kind), Value::Stage(stage)) => match self.stage(ui, kind, stage, actions) {
                Some(wanted) => (Value::Stage(wanted), true),
                None => return,
            },
            (Kind::Optional { of, word }, _) => return self.optional(ui, of, word, actions),
            _ => return,
        };
        if wanted != self.value {
            self.ask(wanted, actions);
        }
        // The frame that ends a gesture may still change the value: that belongs to the gesture.
        if done {
            actions.ask(Action::Settle);
        }
    }

    /// What may be left open: a button with the word for that stands beside the value, or in its place.
    fn optional(&self, ui: &mut Ui, of: &Kind, word: &'static str, actions: &mut Actions) {
        let is_open = self.value == Value::Choice(word);
        if let Kind::Choice(choices) = of {
            let open = Choice { name: word, label: word, doc: "Chosen automatically." };
            let spec = Spec { kind: Kind::Choice([&[open], choices.as_slice()].concat()), ..self.spec.clone() };
            return self.of(&spec, None).show(ui, actions);
        }
        if !is_open {
            let spec = Spec { kind: of.clone(), ..self.spec.clone() };
            return self.of(&spec, Some(word)).show(ui, actions);
        }
        let needed = text_width(ui, word) + 2.0 * ui.spacing().button_padding.x + 4.0;
        let pressed = self.line(ui, needed, actions, |ui, _| {
            let response = ui.selectable_label(true, word);
            let name = format!("{}: {word}", self.spec.label);
            response.widget_info(|| WidgetInfo::selected(egui::Role::Button, ui.is_enabled(), true, &name));
            self.explained(response).clicked()
        });
        if let Some(value) = first_value(of).filter(|_| pressed) {
            self.ask(value, actions);
            actions.ask(Action::Settle);
        }
    }

    /// The same row with another declaration.
    fn of<'b>(&'b self, spec: &'b Spec, open: Option<&'static str>) -> Row<'b> {
        let (value, default) = (self.value.clone(), self.default.clone());
        Row { spec, open, value, default, ..*self }
    }

    /// `response` with what the parameter does, and why it does nothing, on hover.
    fn explained(&self, response: Response) -> Response {
        match self.idle {
            Some(why) => response.on_disabled_hover_text(format!("{why}\n{}", self.tip())),
            None => response.on_hover_ui(|ui| glossary::tooltip(ui, &self.tip())),
        }
    }

    /// The button that leaves the value open, where one may.
    fn opener(&self, ui: &mut Ui, actions: &mut Actions) {
        let Some(word) = self.open else { return };
        let response = ui.selectable_label(false, word);
        let name = format!("{}: {word}", self.spec.label);
        response.widget_info(|| WidgetInfo::selected(egui::Role::Button, ui.is_enabled(), false, &name));
        if self.explained(response).clicked() {
            self.ask(Value::Choice(word), actions);
            actions.ask(Action::Settle);
        }
    }

    /// Asks for another value.
    fn ask(&self, wanted: Value, actions: &mut Actions) {
        let wanted = match self.within {
            // Rows offer nothing that is out of range.
            Some(within) => match within.outermost(wanted) {
                Some(wanted) => wanted,
                None => return,
            },
            None => wanted,
        };
        actions.ask(Action::Set(self.owner, self.index, wanted));
    }

    fn space(&self, ui: &mut Ui) {
        ui.add_space(if matches!(self.spec.kind, Kind::Int { .. } | Kind::Real { .. }) { 6.0 } else { 4.0 });
    }

    /// Which estimator works as this stage; gives another one that was chosen.
    fn stage(&self, ui: &mut Ui, kind: &PartKind, now: &StageValue, actions: &mut Actions) -> Option<StageValue> {
        let mut wanted = None;
        let size = TextStyle::Body.resolve(ui.style()).size;
        let chosen = text_width(ui, now.part().name()) + ui.spacing().interact_size.y + 8.0;
        let list = chosen.max(12.0 * size).min(ui.available_width() - ui.spacing().interact_size.y - 8.0);
        self.line(ui, list, actions, |ui, label| {
            let combo =
                ComboBox::from_id_salt((self.owner, self.index, &self.spec.name)).selected_text(now.part().name());
            let response = combo.width(list).wrap().show_ui(ui, |ui| {
                for part in (kind.all)() {
                    let row = ui.selectable_label(part.id() == now.id(), part.name());
                    if row.on_hover_text(part.summary()).clicked() && part.id() != now.id() {
                        wanted = match &self.default {
                            Some(Value::Stage(usual)) if usual.id() == part.id() => Some(usual.clone()),
                            _ => Some(StageValue::new(part)),
                        };
                    }
                }
            });
            self.explained(response.response.labelled_by(label.id));
        });
        wanted
    }

    /// Label left, `add` right; between them the way back if the value was changed.
    ///
    /// Where both do not fit, `add`, which needs `needed_pt`, lies on a line of its own.
    fn line<R>(
        &self,
        ui: &mut Ui,
        needed_pt: f32,
        actions: &mut Actions,
        add: impl FnOnce(&mut Ui, &Response) -> R,
    ) -> R {
        if self.is_in_strip {
            ui.add_space(STRIP_GAP);
            let label = egui::Label::new(widgets::dim(ui, &self.spec.label).small()).sense(Sense::hover());
            let label = self.explained(ui.add(label));
            return add(ui, &label);
        }
        let height = ui.spacing().interact_size.y;
        let changed = self.is_changed();
        let opener = self.open.map_or(0.0, |word| text_width(ui, word) + 2.0 * ui.spacing().button_padding.x + 8.0);
        let back = opener + if changed { height + 8.0 } else { 0.0 };
        if text_width(ui, &self.spec.label) + 8.0 + back + needed_pt > ui.available_width() {
            let label = ui.add(egui::Label::new(&self.spec.label).wrap().sense(Sense::hover()));
            let label = self.explained(label);
            let row = vec2(ui.available_width(), height);
            return ui
                .allocate_ui_with_layout(row, Layout::left_to_right(Align::Center), |ui| {
                    let result = add(ui, &label);
                    self.opener(ui, actions);
                    if changed {
                        self.way_back(ui, actions);
                    }
                    result
                })
                .inner;
        }
        ui.allocate_ui_with_layout(vec2(ui.available_width(), height), Layout::left_to_right(Align::Center), |ui| {
            let label = ui.add(egui::Label::new(&self.spec.label).truncate().sense(Sense::hover()));
            let label = self.explained(label);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let result = add(ui, &label);
                self.opener(ui, actions);
                if changed {
                    self.way_back(ui, actions);
                }
                result
            })
            .inner
        })
        .inner
    }

    fn way_back(&self, ui: &mut Ui, actions: &mut Actions) {
        let Some(default) = &self.default else { return };
        let name = format!("Reset {}", self.spec.label.to_lowercase());
        let button = widgets::icon_button(ui, Icon::RotateCcw, &name, false);
        if button.on_hover_text(format!("Back to {}{}.", self.shown(default), self.unit())).clicked() {
            actions.ask(Action::Settle);
            self.ask(default.clone(), actions);
            actions.ask(Action::Settle);
        }
    }

    fn shown(&self, value: &Value) -> String {
        match (&self.spec.kind, value) {
            (Kind::Choice(choices), Value::Choice(name)) => {
                choices.iter().find(|c| c.name == *name).map_or(*name, |c| c.label).to_owned()
            }
            _ => value.to_string(),
        }
    }

    fn tip(&self) -> String {
        format!("{}\n{}", self.spec.doc, self.spec.allowed())
    }

    /// A field to type into over a slider; gives the value, and whether a gesture is over.
    fn number(&self, ui: &mut Ui, (min, max): (f64, f64), value: f64, actions: &mut Actions) -> (f64, bool) {
        let mut wanted = value;
        let size = TextStyle::Body.resolve(ui.style()).size;
        let whole = matches!(self.value, Value::Int(_));
        let decimals = if whole { 0 } else { decimals(max - min) };
        let usual = text_width(ui, self.spec.unit) + 4.2 * size;
        let width = if self.is_in_strip { self.strip_field(ui) } else { usual };
        let typed = self.line(ui, width, actions, |ui, label| {
            // What was typed stands there as exactly as it was typed, however coarse the slider is.
            let most = if whole { 0 } else { TYPED_DECIMALS };
            let mut field = DragValue::new(&mut wanted).range(min..=max).suffix(self.unit()).max_decimals(most);
            field = field.speed((max - min) / 200.0);
            let response = ui.add_sized(vec2(width, ui.spacing().interact_size.y), field);
            self.explained(response.labelled_by(label.id))
        });
        if self.is_in_strip {
            return (wanted, is_over(&typed));
        }
        let default = self.default.as_ref().and_then(|default| match *default {
            Value::Int(value) => Some(value as f64),
            Value::Real(value) => Some(value),
            Value::Switch(_) | Value::Choice(_) | Value::Placed(_) | Value::Stage(_) => None,
        });
        let step = 10f64.powi(-(decimals as i32));
        let slider = Slider { name: &self.spec.label, range: (min, max), step, default, theme: self.theme };
        let slid = slider.show(ui, &mut wanted);
        let slid = self.explained(slid);
        (wanted, [&typed, &slid].into_iter().any(is_over))
    }

    fn switch(&self, ui: &mut Ui, on: bool, actions: &mut Actions) -> bool {
        let width = 1.2 * ui.spacing().interact_size.y;
        let response = self.line(ui, width, actions, |ui, _| toggle(ui, on, self.theme));
        let name = &self.spec.label;
        let enabled = ui.is_enabled();
        response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, enabled, on, name));
        on != self.explained(response).clicked()
    }

    /// What is placed on the picture, and the button with which that is done.
    fn placed(&self, ui: &mut Ui, placed: &Placed, actions: &mut Actions) {
        let (text, size) = (placed.words(), TextStyle::Body.resolve(ui.style()).size);
        let verb = if self.is_placing { "Done" } else { "Place" };
        let needed = text_width(ui, &text) + text_width(ui, verb) + 3.0 * size;
        let dim = ui.visuals().weak_text_color();
        let pressed = self.line(ui, needed, actions, |ui, _| {
            let button = ui.add(Button::new(verb).selected(self.is_placing));
            let name = format!("Place {}", self.spec.label.to_lowercase());
            button.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, self.is_placing, &name));
            ui.label(RichText::new(text).color(dim));
            button.on_hover_text(format!("{}\nWith the mouse, on the picture.", self.spec.doc)).clicked()
        });
        if pressed {
            actions.ask(Action::Place((!self.is_placing).then_some(self.index)));
        }
    }

    /// Short choices lie side by side, long ones in a list.
    fn choice(&self, ui: &mut Ui, choices: &[Choice], now: &'static str, actions: &mut Actions) -> &'static str {
        let mut wanted = now;
        let size = TextStyle::Body.resolve(ui.style()).size;
        let padding = 2.0 * ui.spacing().button_padding.x + 4.0;
        let needed: f32 = choices.iter().map(|choice| text_width(ui, choice.label) + padding).sum();
        let fits = !self.is_in_strip && needed + text_width(ui, &self.spec.label) + 16.0 < ui.available_width();
        let shown = choices.iter().find(|choice| choice.name == now).map_or(now, |choice| choice.label);
        let chosen = text_width(ui, shown) + ui.spacing().interact_size.y + 8.0;
        let usual = chosen.max(9.5 * size).min(ui.available_width() - ui.spacing().interact_size.y - 8.0);
        let list = if self.is_in_strip { self.strip_list(ui) } else { usual };
        self.line(ui, if fits { needed } else { list }, actions, |ui, label| {
            if fits {
                ui.spacing_mut().item_spacing.x = 2.0;
                for choice in choices.iter().rev() {
                    let name = format!("{}: {}", self.spec.label, choice.label);
                    let response = ui.selectable_label(choice.name == now, choice.label);
                    let selected = choice.name == now;
                    let enabled = ui.is_enabled();
                    response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, enabled, selected, &name));
                    let response = match self.idle {
                        Some(_) => self.explained(response),
                        None => response.on_hover_text(choice.doc),
                    };
                    if response.clicked() {
                        wanted = choice.name;
                    }
                }
                return;
            }
            let combo = ComboBox::from_id_salt((self.owner, self.index, &self.spec.name)).selected_text(shown);
            let response = combo.width(list).wrap().show_ui(ui, |ui| {
                for choice in choices {
                    let row = ui.selectable_label(choice.name == now, choice.label);
                    if row.on_hover_text(choice.doc).clicked() {
                        wanted = choice.name;
                    }
                }
            });
            self.explained(response.response.labelled_by(label.id));
        });
        wanted
    }
}

/// Whether a gesture on a number is over.
fn is_over(response: &Response) -> bool {
    response.drag_stopped() || response.clicked() || response.lost_focus()
}

/// A value to begin with where one was left open: of numbers one in the lower part of their range.
fn first_value(kind: &Kind) -> Option<Value> {
    Some(match kind {
        Kind::Int { min, max } => Value::Int(min + (max - min) / 4),
        Kind::Real { min, max } => Value::Real((min + (max - min) / 4.0).round().clamp(*min, *max)),
        Kind::Switch => Value::Switch(true),
        Kind::Choice(choices) => Value::Choice(choices.first()?.name),
        Kind::Placed(figure) => Value::Placed(figure.none()),
        Kind::Stage(_) | Kind::Optional { .. } => return None,
    })
}

/// Space before a parameter in the strip, in points.
const STRIP_GAP: f32 = 10.0;
/// Decimals of a real number that may be typed.
const TYPED_DECIMALS: usize = 6;

/// How wide `text` is as a label.
fn text_width(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(text.into(), font, egui::Color32::PLACEHOLDER).size().x
}

/// Decimals that a real number of this span is worth.
fn decimals(span: f64) -> usize {
    if span <= 2.0 {
        3
    } else if span <= 10.0 {
        2
    } else {
        1
    }
}

/// A switch that slides.
fn toggle(ui: &mut Ui, on: bool, theme: Theme) -> Response {
    let chrome = theme.chrome();
    let height = (ui.spacing().interact_size.y * 0.66).round();
    let (rect, response) = ui.allocate_exact_size(vec2(height * 1.8, height), Sense::click());
    let how = ui.ctx().animate_bool_responsive(response.id, on);
    let off = if response.hovered() { chrome.hovered.mix(chrome.text, 0.15) } else { chrome.hovered };
    let fill = off.mix(chrome.accent, how);
    let radius = rect.height() / 2.0;
    ui.painter().rect_filled(rect, radius, style::color(fill));
    let x = egui::lerp(rect.left() + radius..=rect.right() - radius, how);
    let off = if theme == Theme::Light { chrome.panel } else { chrome.text };
    let knob = off.mix(chrome.on_accent, how);
    ui.painter().circle_filled(egui::pos2(x, rect.center().y), radius - 3.0, style::color(knob));
    response
}

#[cfg(test)]
mod tests {
    use super::decimals;

    #[test]
    fn narrow_ranges_have_more_decimals() {
        assert_eq!([0.5, 4.0, 50.0, 500.0].map(decimals), [3, 2, 1, 1]);
    }
}
