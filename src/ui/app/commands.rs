//! The commands of the window, declared once.
//!
//! Menus, toolbar, tooltips, the palette, the shortcut sheet and the keyboard all read [`Command::info`].

use eframe::egui::{Key, KeyboardShortcut, Modifiers};
use lucide_icons::Icon;

use crate::paint::{ColorMap, FlowLayer, FocusMode, Theme, View};
use crate::view::motion::AvailableLayers;

mod info;

pub use crate::ui::panes::granularities::Granularities;

macro_rules! commands {
    ($( $(#[doc = $doc:literal])+ $name:ident, )+) => {
        /// A command of the window.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Command {
            $( $(#[doc = $doc])+ $name, )+
            /// A layer of colors over the picture.
            Layer(FlowLayer),
        }

        impl Command {
            const PLAIN: &[Command] = &[$( Command::$name, )+];

            /// Every command, in the order of the menus, the layers last.
            pub const ALL: &[Command] = &{
                let mut all = [Command::Open; Command::PLAIN.len() + FlowLayer::ALL.len()];
                let mut i = 0;
                while i < all.len() {
                    all[i] = match i.checked_sub(Command::PLAIN.len()) {
                        None => Command::PLAIN[i],
                        Some(layer) => Command::Layer(FlowLayer::ALL[layer]),
                    };
                    i += 1;
                }
                all
            };
        }
    };
}

commands! {
    /// Open a clip or a session, chosen in the system's dialog or by its path.
    Open,
    /// Open the path in the clipboard.
    PastePath,
    /// Open the right view of the clip.
    OpenRightView,
    /// Show the start page, or leave it.
    StartPage,
    /// Show the bundled samples.
    Samples,
    /// Record a clip from a camera.
    Camera,
    /// Open the next example of the estimator.
    NextExample,
    /// Show the lessons.
    Lessons,
    /// Close the lesson that is open.
    CloseLesson,
    /// Copy what is shown as a page of a lesson.
    CopyPage,
    /// Save the session file.
    SaveSession,
    /// Save the frames of the clip.
    SaveClip,
    /// Close the window.
    Quit,
    /// Choose the estimator.
    Estimators,
    /// Undo the last change of a parameter.
    Undo,
    /// Redo the change that was undone last.
    Redo,
    /// Set every parameter to its default.
    ResetParameters,
    /// Frames t and t + 1 side by side.
    SideBySide,
    /// Frame t alone.
    FrameT,
    /// Frame t + 1 alone.
    FrameNext,
    /// The difference image.
    Difference,
    /// A blend of both frames.
    Blend,
    /// Both frames in turn.
    Blink,
    /// The motion-compensated prediction of frame t.
    Prediction,
    /// The residual of the prediction.
    Residual,
    /// Zoom in.
    ZoomIn,
    /// Zoom out.
    ZoomOut,
    /// Zoom so that the whole picture fits.
    Fit,
    /// Zoom to one screen pixel per image pixel.
    ActualSize,
    /// The part at work, or the whole.
    Focus,
    /// The part at work where it is small.
    FocusWhereSmall,
    /// The part at work at every step.
    FocusAlways,
    /// The whole at every step.
    FocusNever,
    /// Dark, light, projector.
    NextTheme,
    /// Light on dark.
    DarkTheme,
    /// Dark on light.
    LightTheme,
    /// Large type and thick lines.
    ProjectorTheme,
    /// The Viridis color map for costs.
    ViridisColors,
    /// The Turbo color map for costs.
    TurboColors,
    /// The next layer of flow colors.
    NextLayer,
    /// Streaklines instead of arrows.
    Streaks,
    /// Fixes the scale of the colours, or adapts it to each step.
    LockScale,
    /// Arrows as long as there is room.
    FittingArrows,
    /// Arrows to scale.
    TrueArrows,
    /// Arrows at twice their length.
    DoubleArrows,
    /// Arrows at four times their length.
    FourfoldArrows,
    /// A larger interface.
    LargerInterface,
    /// A smaller interface.
    SmallerInterface,
    /// The interface scale of the operating system.
    NormalInterface,
    /// Show or hide the parameters.
    ShowParameters,
    /// The explanation's pane.
    ShowExplanation,
    /// The charts.
    ShowCharts,
    /// The chart in the place of the stage, or the stage again.
    EnlargeChart,
    /// The next chart.
    NextChart,
    /// Make the next picture the large one.
    NextPicture,
    /// Lean the picture back, so that the landscape of the method rises from it.
    Landscape,
    /// The chart before.
    PreviousChart,
    /// Panes where they were at first.
    ResetLayout,
    /// The lecture layout.
    Lecture,
    /// Full screen.
    FullScreen,
    /// Ask before a result is shown.
    Predict,
    /// Full screen with stage, chart and caption alone.
    Present,
    /// The second window, for the presenter.
    PresenterWindow,
    /// The large pointer.
    Pointer,
    /// The magnifying glass.
    Loupe,
    /// Blank the screen of the class, or show it again.
    Blank,
    /// The pen.
    Pen,
    /// The next colour of the pen.
    NextPenColor,
    /// Remove the ink of the step.
    ClearInk,
    /// Switch animations off.
    ReducedMotion,
    /// Play or pause.
    Play,
    /// Play backwards or pause.
    PlayBack,
    /// Next event.
    Into,
    /// Previous event.
    IntoBack,
    /// End of the next unit.
    Over,
    /// End of the previous unit.
    OverBack,
    /// End of the current group of units.
    Out,
    /// Start of the current group of units.
    OutBack,
    /// End of the next unit; a presenter's clicker sends its key.
    NextUnit,
    /// End of the previous unit.
    PreviousUnit,
    /// The next page of the lesson.
    NextPage,
    /// The previous page of the lesson.
    PreviousPage,
    /// Return to the page of a lesson from which a link led away.
    BackToPage,
    /// The next step that is marked on the timeline.
    NextMark,
    /// The marked step before.
    PreviousMark,
    /// The next marked step of the same kind.
    NextAlike,
    /// The one before.
    PreviousAlike,
    /// Start of the run.
    Start,
    /// End of the run.
    End,
    /// The comparison table of several estimators.
    Compare,
    /// Several estimators in lockstep.
    Lockstep,
    /// Walk the stage of the estimator by itself.
    IntoStage,
    /// Return to the estimator that uses the stage.
    OutOfStage,
    /// Cancel the computation in progress.
    Stop,
    /// Play slower.
    Slower,
    /// Play faster.
    Faster,
    /// Next pair of frames.
    NextFrame,
    /// Previous pair of frames.
    PreviousFrame,
    /// Save the step as a picture.
    ExportPicture,
    /// Save a range of steps as pictures.
    ExportSteps,
    /// Save the result so far.
    ExportResult,
    /// Save the scores of the class.
    ExportScores,
    /// Forget the scores of the class.
    ClearScores,
    /// Save all pages of the lesson on paper.
    SaveHandout,
    /// Save the step on paper, to be computed by hand.
    SaveWorksheet,
    /// Find a command by name.
    Palette,
    /// Find words in all texts.
    SearchText,
    /// Define the terms of the course.
    Glossary,
    /// List all shortcuts.
    Shortcuts,
    /// Version, licences and sources.
    About,
}

/// A menu of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Clips and sessions.
    File,
    /// Parameters.
    Edit,
    /// Themes, zoom, layers and panes.
    View,
    /// Moves through the run.
    Walk,
    /// Pictures and results as files.
    Export,
    /// The palette, shortcuts and version.
    Help,
}

impl Menu {
    /// Every menu, from left to right.
    pub const ALL: [Menu; 6] = [Menu::File, Menu::Edit, Menu::View, Menu::Walk, Menu::Export, Menu::Help];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Menu::File => "File",
            Menu::Edit => "Edit",
            Menu::View => "View",
            Menu::Walk => "Walk",
            Menu::Export => "Export",
            Menu::Help => "Help",
        }
    }
}

/// A menu within a menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submenu {
    /// Which pictures the stage shows.
    Pictures,
    /// Zoom.
    Zoom,
    /// The themes.
    Theme,
    /// Color maps for costs.
    Colours,
    /// Flow colors and streaklines.
    Motion,
    /// The scale of arrows.
    ArrowLength,
    /// The interface scale.
    InterfaceSize,
    /// The panes around the stage.
    Panes,
    /// What is shown to a class.
    Present,
}

impl Submenu {
    /// Its name and its icon.
    pub fn info(self) -> (&'static str, Icon) {
        match self {
            Submenu::Pictures => ("Pictures", Icon::Images),
            Submenu::Zoom => ("Zoom", Icon::ZoomIn),
            Submenu::Theme => ("Theme", Icon::Contrast),
            Submenu::Colours => ("Colours", Icon::Palette),
            Submenu::Motion => ("Motion", Icon::Wind),
            Submenu::ArrowLength => ("Arrow length", Icon::MoveUpRight),
            Submenu::InterfaceSize => ("Interface size", Icon::CaseSensitive),
            Submenu::Panes => ("Panes", Icon::LayoutDashboard),
            Submenu::Present => ("Present", Icon::Presentation),
        }
    }
}

/// The name, tooltip, icon and shortcuts of a command.
pub struct CommandInfo {
    /// The menu that it lies in.
    pub menu: Menu,
    /// Its icon, where it has a button or a line in a menu.
    pub icon: Icon,
    /// Its name; `{into}`, `{over}` and `{out}` stand for the estimator's granularities.
    pub text: &'static str,
    /// What it does, in one sentence.
    pub tip: &'static str,
    /// The keys that call it, the one to show first.
    pub keys: &'static [KeyboardShortcut],
}

impl Command {
    /// Its name, with the estimator's own names for the granularities of the ladder.
    pub fn text(self, granularities: &Granularities) -> String {
        granularities.fill(self.info().text)
    }

    /// What it does, with the estimator's own names for the granularities of the ladder.
    pub fn tip(self, granularities: &Granularities) -> String {
        granularities.fill(self.info().tip)
    }

    /// The key that calls it, in words; nothing if there is none.
    pub fn key(self) -> String {
        self.info().keys.first().map_or_else(String::new, |key| key_text(*key))
    }

    /// `tip` with the key that calls the command below it.
    pub fn with_key(self, tip: &str) -> String {
        match self.key() {
            key if key.is_empty() => tip.to_owned(),
            key => format!("{tip}\n{key}"),
        }
    }

    /// Every key that does the same, the one to show first.
    pub fn keys(self, granularities: &Granularities) -> Vec<KeyboardShortcut> {
        let twin = match self {
            Command::Start => Command::OutBack,
            Command::End => Command::Out,
            _ => self,
        };
        let others = if twin.is_listed(granularities) { &[] } else { twin.info().keys };
        [self.info().keys, others].concat()
    }

    /// Whether it is shown beside the others: out of the outermost granularity is the end of the run, which is there already.
    pub fn is_listed(self, granularities: &Granularities) -> bool {
        !(matches!(self, Command::Out | Command::OutBack) && granularities.group() == 0)
    }

    /// The menu within its menu that it lies in.
    pub fn submenu(self) -> Option<Submenu> {
        use Command as C;
        match self {
            C::SideBySide | C::FrameT | C::FrameNext | C::Difference => Some(Submenu::Pictures),
            C::Blend | C::Blink | C::Prediction | C::Residual => Some(Submenu::Pictures),
            C::ZoomIn | C::ZoomOut | C::Fit | C::ActualSize => Some(Submenu::Zoom),
            C::Focus | C::FocusWhereSmall | C::FocusAlways | C::FocusNever => Some(Submenu::Zoom),
            C::NextTheme | C::DarkTheme | C::LightTheme | C::ProjectorTheme => Some(Submenu::Theme),
            C::ViridisColors | C::TurboColors => Some(Submenu::Colours),
            C::NextLayer | C::Streaks | C::LockScale => Some(Submenu::Motion),
            _ if self.layer().is_some() => Some(Submenu::Motion),
            C::FittingArrows | C::TrueArrows | C::DoubleArrows | C::FourfoldArrows => Some(Submenu::ArrowLength),
            C::LargerInterface | C::SmallerInterface | C::NormalInterface => Some(Submenu::InterfaceSize),
            C::ShowParameters | C::ShowExplanation | C::ShowCharts | C::ResetLayout => Some(Submenu::Panes),
            C::EnlargeChart | C::NextChart | C::PreviousChart | C::NextPicture | C::Landscape => Some(Submenu::Panes),
            C::Present | C::PresenterWindow | C::Pointer | C::Loupe | C::Blank => Some(Submenu::Present),
            C::Pen | C::NextPenColor | C::ClearInk => Some(Submenu::Present),
            _ => None,
        }
    }

    /// The entry of the look that it sets, by its name, and the value that it gives to it.
    pub fn look(self) -> Option<(&'static str, &'static str)> {
        use Command as C;
        Some(match self {
            C::SideBySide => ("view", View::SideBySide.id()),
            C::FrameT => ("view", View::Current.id()),
            C::FrameNext => ("view", View::Next.id()),
            C::Difference => ("view", View::Difference.id()),
            C::Blend => ("view", View::Blend.id()),
            C::Blink => ("view", View::Blink.id()),
            C::Prediction => ("view", View::Prediction.id()),
            C::Residual => ("view", View::Residual.id()),
            C::FocusWhereSmall => ("focus", FocusMode::Auto.id()),
            C::FocusAlways => ("focus", FocusMode::On.id()),
            C::FocusNever => ("focus", FocusMode::Off.id()),
            C::DarkTheme => ("theme", Theme::Dark.id()),
            C::LightTheme => ("theme", Theme::Light.id()),
            C::ProjectorTheme => ("theme", Theme::Projector.id()),
            C::ViridisColors => ("colors", ColorMap::Viridis.id()),
            C::TurboColors => ("colors", ColorMap::Turbo.id()),
            C::FittingArrows => ("arrow-scale", "auto"),
            C::TrueArrows => ("arrow-scale", "1"),
            C::DoubleArrows => ("arrow-scale", "2"),
            C::FourfoldArrows => ("arrow-scale", "4"),
            _ => ("layer", self.layer()?.id()),
        })
    }

    /// The layer of colours that it shows, if it shows one.
    pub fn layer(self) -> Option<FlowLayer> {
        match self {
            Command::Layer(layer) => Some(layer),
            _ => None,
        }
    }

    /// What is said when it is called by its key and is not enabled, where nothing on the screen says why.
    pub fn why_disabled(self, now: &Situation) -> Option<&'static str> {
        use Command as C;
        match self {
            C::LargerInterface => Some("The interface is as large as fits into this window."),
            C::Prediction | C::Residual if now.has_run => {
                Some("The motion-compensated prediction needs the complete result, at the end of the run.")
            }
            C::NextLayer | C::Layer(_) | C::Streaks | C::LockScale if now.has_run && !now.available.has_field() => {
                Some("This estimator has no dense flow to colour or to follow with streaklines.")
            }
            C::Landscape if now.has_run => {
                Some("This step has no landscape: it works out no cost, response or density over the picture.")
            }
            C::ExportResult if now.is_asked => Some("The result is held back. Reveal it first (→)."),
            C::Predict if now.in_lockstep => Some("Questions are about one estimator. Leave the lockstep first."),
            C::Lockstep if now.in_stage => Some("Lockstep compares whole estimators. Leave this stage first."),
            _ => None,
        }
    }

    /// Whether it makes sense just now.
    pub fn enabled(self, now: &Situation) -> bool {
        use Command as C;
        match self {
            C::Undo => now.can_undo,
            C::Redo => now.can_redo,
            C::ResetParameters => now.has_clip && now.is_tuned,
            // In a lesson they turn its pages as well.
            C::IntoBack | C::PreviousUnit if now.in_lesson && !now.at_first_page => true,
            // At the end of the last one they offer the next lesson.
            C::Into | C::NextUnit if now.lesson_goes_on => true,
            C::IntoBack | C::OverBack | C::OutBack | C::PreviousUnit | C::Start => now.has_run && !now.at_start,
            C::PreviousMark | C::PreviousAlike => now.has_run && !now.at_start,
            // They reveal the answer.
            C::Into | C::Over | C::Out | C::NextUnit | C::End if now.is_asked => true,
            C::Into | C::Over | C::Out | C::NextUnit | C::End => now.has_run && !now.at_end,
            C::NextMark | C::NextAlike => now.has_run && !now.at_end,
            C::Play | C::PlayBack => now.has_run,
            C::Compare => now.has_clip,
            C::OpenRightView => now.has_pictures,
            C::Lockstep => now.has_clip && !now.in_stage,
            C::IntoStage => now.has_run && now.has_stage && !now.in_lockstep,
            C::OutOfStage => now.in_stage,
            C::Stop => now.busy || now.checking || now.playing,
            C::NextFrame => now.has_clip && !now.at_last_frame,
            C::PreviousFrame => now.has_clip && !now.at_first_frame,
            // The run stands at the step that is held back.
            C::ExportResult => now.has_run && !now.is_asked,
            C::SaveSession | C::SaveClip | C::ExportPicture | C::ExportSteps => now.has_run,
            C::SideBySide | C::FrameT | C::FrameNext | C::Difference | C::Blend | C::Blink => now.has_run,
            C::Prediction | C::Residual => now.has_run && now.at_end,
            C::ZoomIn | C::ZoomOut | C::Fit | C::ActualSize => now.has_run,
            C::Focus | C::FocusWhereSmall | C::FocusAlways | C::FocusNever => now.has_run,
            C::NextLayer => now.has_run && now.available.has_colors(),
            C::Streaks | C::LockScale => now.has_run && now.available.has_field(),
            C::Layer(_) => now.has_run && self.layer().is_some_and(|layer| now.available.why_never(layer).is_none()),
            C::StartPage | C::SearchText | C::Estimators => true,
            C::BackToPage => now.has_trail,
            C::Open | C::PastePath | C::Samples | C::Camera | C::NextExample | C::Lessons | C::Quit => true,
            C::CloseLesson => now.in_lesson,
            C::SaveHandout => now.in_lesson && now.has_run,
            C::SaveWorksheet => now.has_run,
            C::CopyPage => now.has_run,
            C::NextPage => now.in_lesson && !now.at_last_page,
            C::PreviousPage => now.in_lesson && !now.at_first_page,
            C::NextTheme | C::DarkTheme | C::LightTheme | C::ProjectorTheme => true,
            C::SmallerInterface | C::NormalInterface => true,
            C::ViridisColors | C::TurboColors => true,
            C::FittingArrows | C::TrueArrows | C::DoubleArrows | C::FourfoldArrows => true,
            C::EnlargeChart | C::NextChart | C::PreviousChart => now.has_charts,
            C::NextPicture => now.has_large_picture,
            C::Landscape => now.has_landscape,
            C::LargerInterface => now.can_be_larger,
            C::ShowParameters | C::ShowExplanation | C::ShowCharts => true,
            C::Predict => !now.in_lockstep && !now.at_start_page,
            C::ExportScores => now.has_run && now.has_scores,
            C::ClearScores => now.has_scores,
            C::Present | C::PresenterWindow | C::Pointer => !now.at_start_page,
            C::Lecture | C::FullScreen => true,
            C::Pen | C::Loupe => now.has_run,
            C::Blank => now.is_presenting,
            C::NextPenColor => now.is_drawing,
            C::ClearInk => now.has_ink,
            C::ReducedMotion | C::ResetLayout | C::Slower | C::Faster => true,
            C::Palette | C::Glossary | C::Shortcuts | C::About => true,
        }
    }

    /// Whether holding its key down repeats it.
    fn repeats(self) -> bool {
        use Command as C;
        matches!(
            self,
            C::Into
                | C::IntoBack
                | C::Over
                | C::OverBack
                | C::NextUnit
                | C::PreviousUnit
                | C::NextFrame
                | C::PreviousFrame
                | C::Undo
                | C::Redo
                | C::ZoomIn
                | C::ZoomOut
                | C::LargerInterface
                | C::SmallerInterface
        )
    }

    /// The command that a key calls.
    pub fn of_key(key: Key, modifiers: Modifiers, repeat: bool) -> Option<Command> {
        let called = |command: &Command| command.info().keys.iter().any(|shortcut| presses(*shortcut, key, modifiers));
        Self::ALL.iter().copied().find(called).filter(|command| !repeat || command.repeats())
    }
}

/// Whether `key` with `modifiers` is `shortcut`. Signs may need Shift on some keyboards, so it is ignored for them.
fn presses(shortcut: KeyboardShortcut, key: Key, mut modifiers: Modifiers) -> bool {
    if matches!(key, Key::Plus | Key::Equals | Key::Minus | Key::Questionmark | Key::OpenBracket | Key::CloseBracket) {
        modifiers.shift = false;
    }
    shortcut.logical_key == key && modifiers.matches_exact(shortcut.modifiers)
}

/// What is the case just now, as far as commands care.
#[derive(Clone, Copy, Debug, Default)]
pub struct Situation {
    /// A clip is open.
    pub has_clip: bool,
    /// It is of pictures or a video in files.
    pub has_pictures: bool,
    /// A run is shown.
    pub has_run: bool,
    /// It stands at its start.
    pub at_start: bool,
    /// It stands at its end.
    pub at_end: bool,
    /// A long move is at work.
    pub busy: bool,
    /// The reverse pair is being run.
    pub checking: bool,
    /// It is playing.
    pub playing: bool,
    /// The window is in the lecture layout because the person wants it.
    pub lecture: bool,
    /// The parameters take the room of other panes.
    pub has_open_parameters: bool,
    /// The step has charts.
    pub has_charts: bool,
    /// Whether one of several pictures is larger than the others.
    pub has_large_picture: bool,
    /// Whether something rises from a picture, or can.
    pub has_landscape: bool,
    /// A chart stands in the place of the stage.
    pub has_enlarged: bool,
    /// The interface can be larger in a window of this size.
    pub can_be_larger: bool,
    /// Several estimators go in lockstep.
    pub in_lockstep: bool,
    /// The estimator has a stage that can be walked by itself.
    pub has_stage: bool,
    /// It is itself the stage of another that waits.
    pub in_stage: bool,
    /// A pixel was clicked and stays explained.
    pub holds_pixel: bool,
    /// A parameter is being placed on the picture.
    pub is_placing: bool,
    /// The mouse draws.
    pub is_drawing: bool,
    /// Something was drawn by hand on the step.
    pub has_ink: bool,
    /// A magnifying glass follows the mouse.
    pub has_loupe: bool,
    /// The mouse is a large pointer.
    pub is_pointing: bool,
    /// Stage, chart and caption are shown alone.
    pub is_presenting: bool,
    /// The screen of the class is black.
    pub is_blank: bool,
    /// Which layers tell of motion.
    pub available: AvailableLayers,
    /// There is a change to take back.
    pub can_undo: bool,
    /// There is a change to make again.
    pub can_redo: bool,
    /// A parameter is not as declared.
    pub is_tuned: bool,
    /// Results are asked about.
    pub asks: bool,
    /// A question waits for its answer.
    pub is_asked: bool,
    /// The answer to a question is shown: late hands do nothing.
    pub is_answered: bool,
    /// Questions were answered.
    pub has_scores: bool,
    /// A lesson is open.
    pub in_lesson: bool,
    /// It is open at its first page.
    pub at_first_page: bool,
    /// It is open at its last page.
    pub at_last_page: bool,
    /// Whether → still has something to show in the lesson: a page, the next lesson, or that it ends.
    pub lesson_goes_on: bool,
    /// A link has led away from a page of a lesson.
    pub has_trail: bool,
    /// The start page is shown.
    pub at_start_page: bool,
    /// No earlier pair of frames.
    pub at_first_frame: bool,
    /// No later pair of frames.
    pub at_last_frame: bool,
}

/// A shortcut in words: `Ctrl+Shift+Z`, `→`.
pub fn key_text(shortcut: KeyboardShortcut) -> String {
    let KeyboardShortcut { modifiers, logical_key } = shortcut;
    let mut text = String::new();
    let command = if cfg!(target_os = "macos") { "⌘" } else { "Ctrl+" };
    for (held, name) in [(modifiers.command, command), (modifiers.alt, "Alt+"), (modifiers.shift, "Shift+")] {
        if held {
            text += name;
        }
    }
    text + match logical_key {
        Key::ArrowLeft => "←",
        Key::ArrowRight => "→",
        Key::PageDown => "PgDn",
        Key::PageUp => "PgUp",
        Key::Escape => "Esc",
        Key::Comma => ",",
        Key::Period => ".",
        Key::Plus => "+",
        Key::Equals => "=",
        Key::Minus => "−",
        Key::Questionmark => "?",
        Key::OpenBracket => "[",
        Key::CloseBracket => "]",
        other => other.name(),
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::params::Params;

    use super::*;
    use crate::view::look::Look;

    #[test]
    fn no_two_commands_share_a_key() {
        let keys = |c: &Command| c.info().keys.iter().map(|k| (*k, *c)).collect::<Vec<_>>();
        let all: Vec<_> = Command::ALL.iter().flat_map(keys).collect();
        for (shortcut, command) in &all {
            assert_eq!(Command::of_key(shortcut.logical_key, shortcut.modifiers, false), Some(*command));
        }
    }

    #[test]
    fn every_command_is_named_and_explained() {
        let granularities = Granularities::new(&["frame", "block", "probe"]);
        let mut names: Vec<_> = Command::ALL.iter().map(|c| c.text(&granularities)).collect();
        assert!(names.iter().all(|name| !name.contains('{')) && names.contains(&"Next probe".to_owned()));
        names.sort();
        names.dedup();
        assert_eq!(names.len(), Command::ALL.len());
        assert!(Command::ALL.iter().all(|c| c.tip(&granularities).ends_with('.')));
    }

    #[test]
    fn what_a_command_sets_is_an_entry_of_the_look() {
        let sets: Vec<_> = Command::ALL.iter().filter_map(|command| command.look()).collect();
        for (name, value) in &sets {
            let mut look = Look::default();
            look.set(name, value).unwrap();
            assert_eq!(look.get(name).unwrap().to_string(), *value);
        }
        assert!(sets.len() > 20, "{}", sets.len());
    }

    #[test]
    fn a_short_ladder_lists_the_end_of_the_run_once() {
        let (long, short) = (
            Granularities::new(&["frame", "level", "block", "probe"]),
            Granularities::new(&["frame", "block", "probe"]),
        );
        assert!(Command::Out.is_listed(&long) && !Command::Out.is_listed(&short));
        let keys = |granularities| Command::End.keys(granularities).into_iter().map(key_text).collect::<Vec<_>>();
        assert_eq!((keys(&long), keys(&short)), (vec!["End".to_owned()], vec!["End".to_owned(), "U".to_owned()]));
    }

    #[test]
    fn a_held_key_steps_on_but_does_not_toggle() {
        assert_eq!(Command::of_key(Key::ArrowRight, Modifiers::NONE, true), Some(Command::Into));
        assert_eq!(Command::of_key(Key::Space, Modifiers::NONE, true), None);
        assert_eq!(Command::of_key(Key::Questionmark, Modifiers::SHIFT, false), Some(Command::Shortcuts));
    }
}
