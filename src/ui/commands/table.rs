//! The table of commands: one entry for each, which the palette, the menus, the keys, the buttons and the shortcut sheet read.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};
use lucide_icons::Icon;
use motionscope_core::run::Direction;

use super::{Entry, Menu, Situation, Submenu};
use crate::files::IN_PAGE;
use crate::paint::{ColorMap, FlowLayer, FocusMode, Theme, View};

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

const fn alt(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::ALT, key)
}

const fn alt_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::ALT.plus(Modifiers::SHIFT), key)
}

/// The tip of the command that opens files.
const OPEN: &str = if IN_PAGE {
    "Open a video, an image sequence, a folder or a session. Nothing leaves this computer."
} else {
    "Open a video, an image sequence, a folder or a session; a path can be typed as well."
};

const FILE: Entry = Entry::of(Menu::File);
const EDIT: Entry = Entry::of(Menu::Edit);
const VIEW: Entry = Entry::of(Menu::View);
const WALK: Entry = Entry::of(Menu::Walk);
const EXPORT: Entry = Entry::of(Menu::Export);
const HELP: Entry = Entry::of(Menu::Help);

const PICTURES: Entry = Entry { submenu: Some(Submenu::Pictures), enabled: |now| now.has_run, ..VIEW };
const ZOOM: Entry = Entry { submenu: Some(Submenu::Zoom), ..PICTURES };
const THEMES: Entry = Entry {
    submenu: Some(Submenu::Theme),
    section: 2,
    tags: "colours appearance beamer contrast settings preferences options",
    ..VIEW
};
const COLOURS: Entry = Entry { submenu: Some(Submenu::Colours), section: 2, ..VIEW };
const MOTION: Entry = Entry { submenu: Some(Submenu::Motion), section: 2, why_not: no_field, ..VIEW };
const ARROWS: Entry = Entry { submenu: Some(Submenu::ArrowLength), section: 2, icon: Icon::MoveUpRight, ..VIEW };
const INTERFACE: Entry = Entry {
    submenu: Some(Submenu::InterfaceSize),
    section: 2,
    tags: "font text type size scale zoom settings preferences options",
    ..VIEW
};
const PANES: Entry = Entry { submenu: Some(Submenu::Panes), section: 3, ..VIEW };
const PRESENT: Entry = Entry { submenu: Some(Submenu::Present), enabled: |now| !now.at_start_page, ..VIEW };

/// A step forward; it reveals the answer to an open question.
const FORWARD: Entry =
    Entry { way: Some(Direction::Forward), section: 5, enabled: |now| now.is_asked || now.can_go_on(), ..WALK };
const BACK: Entry = Entry { way: Some(Direction::Back), section: 5, enabled: Situation::can_go_back, ..WALK };
const PLAYBACK: Entry = Entry { section: 7, tags: "speed animate pause reverse", ..WALK };

const fn picture(view: View) -> Entry {
    Entry { text: view.name(), tip: view.tip(), sets: Some(("view", view.id())), ..PICTURES }
}

const fn focus(mode: FocusMode) -> Entry {
    Entry { text: mode.name(), tip: mode.tip(), sets: Some(("focus", mode.id())), ..ZOOM }
}

const fn theme(theme: Theme) -> Entry {
    Entry { tip: theme.tip(), sets: Some(("theme", theme.id())), ..THEMES }
}

const fn colors(map: ColorMap) -> Entry {
    Entry { tip: map.tip(), sets: Some(("colors", map.id())), ..COLOURS }
}

fn no_prediction(now: &Situation) -> Option<&'static str> {
    now.has_run.then_some("The motion-compensated prediction needs the complete result, at the end of the run.")
}

fn no_field(now: &Situation) -> Option<&'static str> {
    let lacks = now.has_run && !now.available.has_field();
    lacks.then_some("This estimator has no dense flow to colour or to follow with streaklines.")
}

/// The entry of a layer of colours over the picture.
fn layer(layer: FlowLayer) -> Entry {
    let (icon, tags) = match layer {
        FlowLayer::None => (Icon::CircleOff, "flow colour layer overlay motion"),
        FlowLayer::Wheel => (Icon::Palette, "flow colour layer overlay motion"),
        FlowLayer::Magnitude => (Icon::Gauge, "flow colour layer overlay motion"),
        FlowLayer::Error => (Icon::Target, "flow colour layer overlay motion"),
        FlowLayer::Difference => (Icon::Diff, "flow colour layer overlay compare lockstep"),
        FlowLayer::Confidence => (Icon::ShieldCheck, "flow colour layer overlay occlusion forward backward"),
        FlowLayer::Consistency => (Icon::ArrowLeftRight, "flow colour layer overlay occlusion forward backward"),
        FlowLayer::Model(_) => (Icon::Layers, "model quantity background variance sigma layer overlay"),
    };
    let (text, tip, sets) = (layer.name(), layer.tip(), Some(("layer", layer.id())));
    Entry { icon, text, tip, sets, tags, enabled: |now| now.has_run, ..MOTION }
}

macro_rules! commands {
    ($( $name:ident: $entry:expr, )+) => {
        /// A command of the window.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[expect(missing_docs, reason = "the tooltip of its entry says what each command does")]
        pub enum Command {
            $( $name, )+
            /// A layer of colours over the picture.
            Layer(FlowLayer),
        }

        impl Command {
            const PLAIN: &[Command] = &[$( Command::$name, )+];

            /// Its entry in the table.
            pub fn entry(self) -> Entry {
                let entry = match self {
                    $( Command::$name => const { $entry }, )+
                    Command::Layer(shown) => layer(shown),
                };
                entry.here()
            }
        }
    };
}

commands! {
    Open: Entry {
        icon: Icon::FolderOpen, text: "Open…", keys: &[ctrl(Key::O)],
        tip: OPEN,
        tags: "load file video clip movie image folder import detections truth ground", ..FILE
    },
    PastePath: Entry {
        icon: Icon::ClipboardPaste, text: "Open path from clipboard", keys: &[ctrl_shift(Key::V)],
        tip: "Open the clip at the path in the clipboard.",
        tags: "load file video clip movie image folder import detections truth ground", ..FILE
    },
    OpenRightView: Entry {
        icon: Icon::Columns2, text: "Open right view…",
        tip: "Open the right view of the clip, from a second camera: a picture, a folder or a video. Synthetic scenes have their own views.",
        enabled: |now| now.has_pictures, tags: "load stereo second view camera calibration", ..FILE
    },
    StartPage: Entry {
        icon: Icon::House, text: "Start page", keys: &[ctrl(Key::H)],
        in_page: Some(&[shift(Key::H)]),
        tip: "Show samples, estimators, lessons and what was open lately, or return to the window.",
        ..FILE
    },
    Samples: Entry {
        icon: Icon::LayoutGrid, text: "Samples…", keys: &[ctrl(Key::N)],
        in_page: Some(&[shift(Key::S)]),
        tip: "Choose a bundled clip; each shows one effect, such as occlusion or the aperture problem.",
        tags: "example synthetic scene demo", ..FILE
    },
    Camera: Entry {
        icon: Icon::Camera, text: "Camera…", keys: &[ctrl(Key::R)],
        in_page: Some(&[shift(Key::R)]),
        tip: "Record a clip from a camera, or watch an estimator run on its live picture.",
        ..FILE
    },
    NextExample: Entry {
        icon: Icon::Lightbulb, text: "Next example", keys: &[key(Key::E)],
        tip: "Open the next clip on which this estimator works, or fails, with the reason.",
        ..FILE
    },
    Lessons: Entry {
        icon: Icon::BookOpen, text: "Lessons…", keys: &[ctrl(Key::L)],
        in_page: Some(&[shift(Key::L)]),
        tip: "Choose a lesson of the course: pages of words and formulas beside the steps that they explain.",
        tags: "course chapter teach learn page", ..FILE
    },
    CloseLesson: Entry {
        icon: Icon::BookX, text: "Close lesson",
        tip: "Close the lesson; its clip and its run stay open.",
        enabled: |now| now.in_lesson, ..FILE
    },
    CopyPage: Entry {
        icon: Icon::ClipboardCopy, text: "Copy as page of a lesson",
        tip: "Copy clip, estimator, parameters, current step and view as the header of a page, to be pasted into the Markdown file of a lesson.",
        enabled: |now| now.has_run, tags: "lesson markdown write", ..FILE
    },
    CopyLink: Entry {
        icon: Icon::Link, text: "Copy link", keys: &[shift(Key::K)],
        tip: "Copy a link that opens this clip, estimator, step and view in a browser or in Motionscope.",
        enabled: |now| now.has_run, tags: "share address url web browser moodle embed clipboard", ..FILE
    },
    SaveSession: Entry {
        icon: Icon::Save, text: "Save session…", keys: &[ctrl(Key::S)], section: 1,
        tip: "Save clip, estimator, parameters, current step, view and ink as a small text file (*.motionscope).",
        enabled: |now| now.has_run, tags: "file store keep", ..FILE
    },
    SaveClip: Entry {
        icon: Icon::Film, text: "Save clip as…", keys: &[ctrl_shift(Key::S)],
        tip: "Save the frames of the clip: as they came in one file, or as numbered pictures.",
        enabled: |now| now.has_run, ..FILE
    },
    Quit: Entry {
        icon: Icon::LogOut, text: "Quit", keys: &[ctrl(Key::Q)],
        in_page: Some(&[]), section: 3,
        tip: "Close Motionscope.",
        ..FILE
    },
    Estimators: Entry {
        icon: Icon::Grid3x3, text: "Estimators…", keys: &[key(Key::A)],
        tip: "Choose the estimator by family, with a picture of each and what suits the clip.",
        tags: "method algorithm choose family list", ..EDIT
    },
    Undo: Entry {
        icon: Icon::Undo2, text: "Undo", keys: &[ctrl(Key::Z)], repeats: true,
        tip: "Undo the last change of a parameter, or of the ink while the pen is on.",
        enabled: |now| now.can_undo, tags: "history default change", ..EDIT
    },
    Redo: Entry {
        icon: Icon::Redo2, text: "Redo", keys: &[ctrl_shift(Key::Z), ctrl(Key::Y)], repeats: true,
        tip: "Redo the change that was undone last.",
        enabled: |now| now.can_redo, tags: "history default change", ..EDIT
    },
    ResetParameters: Entry {
        icon: Icon::RotateCcw, text: "Reset parameters", section: 1,
        tip: "Set every parameter to its default.",
        enabled: |now| now.has_clip && now.is_tuned, tags: "history default change", ..EDIT
    },
    SideBySide: Entry { icon: Icon::Columns2, keys: &[key(Key::Num1)], ..picture(View::SideBySide) },
    FrameT: Entry { icon: Icon::Square, keys: &[key(Key::Num2)], ..picture(View::Current) },
    FrameNext: Entry { icon: Icon::SquareArrowRight, keys: &[key(Key::Num3)], ..picture(View::Next) },
    Difference: Entry { icon: Icon::Diff, keys: &[key(Key::Num4)], ..picture(View::Difference) },
    Blend: Entry { icon: Icon::Blend, keys: &[key(Key::Num5)], ..picture(View::Blend) },
    Blink: Entry { icon: Icon::FlipHorizontal2, keys: &[key(Key::Num6)], ..picture(View::Blink) },
    Prediction: Entry {
        icon: Icon::Puzzle, keys: &[key(Key::Num7)], enabled: |now| now.has_run && now.at_end,
        why_not: no_prediction, ..picture(View::Prediction)
    },
    Residual: Entry {
        icon: Icon::Eraser, keys: &[key(Key::Num8)], enabled: |now| now.has_run && now.at_end,
        why_not: no_prediction, ..picture(View::Residual)
    },
    ZoomIn: Entry {
        icon: Icon::ZoomIn, text: "Zoom in", keys: &[key(Key::Plus), key(Key::Equals)], repeats: true,
        tip: "Enlarge the picture around the pointer or the current block; the mouse wheel does the same.",
        tags: "magnify larger smaller", ..ZOOM
    },
    ZoomOut: Entry {
        icon: Icon::ZoomOut, text: "Zoom out", keys: &[key(Key::Minus)], repeats: true,
        tip: "Reduce the picture.",
        tags: "magnify larger smaller", ..ZOOM
    },
    Fit: Entry {
        icon: Icon::Maximize, text: "Fit picture", keys: &[key(Key::Num0)],
        tip: "Zoom so that the whole picture fits.",
        tags: "zoom whole scale pixel", ..ZOOM
    },
    ActualSize: Entry {
        icon: Icon::Scan, text: "Actual size", keys: &[key(Key::Num9)],
        tip: "Zoom to one screen pixel per image pixel.",
        tags: "zoom whole scale pixel", ..ZOOM
    },
    Focus: Entry {
        icon: Icon::Focus, text: "Focus on the work", keys: &[key(Key::G)],
        tip: "Magnify the block, window or ellipse of the step and follow it from step to step, or show the whole picture again.",
        ..ZOOM
    },
    FocusWhereSmall: Entry { icon: Icon::ZoomIn, ..focus(FocusMode::Auto) },
    FocusAlways: Entry { icon: Icon::ZoomIn, ..focus(FocusMode::On) },
    FocusNever: Entry { icon: Icon::Maximize, ..focus(FocusMode::Off) },
    NextTheme: Entry {
        icon: Icon::Contrast, text: "Next theme", keys: &[key(Key::T)],
        tip: "Switch between dark, light, and projector (large type, thick lines).",
        ..THEMES
    },
    DarkTheme: Entry { icon: Icon::Moon, text: "Dark theme", ..theme(Theme::Dark) },
    LightTheme: Entry { icon: Icon::Sun, text: "Light theme", ..theme(Theme::Light) },
    ProjectorTheme: Entry { icon: Icon::Projector, text: "Projector theme", ..theme(Theme::Projector) },
    ViridisColors: Entry { icon: Icon::Palette, text: "Viridis colours", ..colors(ColorMap::Viridis) },
    TurboColors: Entry { icon: Icon::Rainbow, text: "Turbo colours", ..colors(ColorMap::Turbo) },
    NextLayer: Entry {
        icon: Icon::SwatchBook, text: "Next flow colours", keys: &[key(Key::M)],
        tip: "Switch the layer over the picture: none, flow wheel, magnitude, in lockstep the difference from the first estimator; at the end of the run also error, confidence and forward–backward check.",
        enabled: |now| now.has_run && now.available.has_colors(), ..MOTION
    },
    Streaks: Entry {
        icon: Icon::Wind, text: "Streaklines", keys: &[key(Key::S)],
        tip: "Show the flow as moving particles instead of arrows.",
        enabled: |now| now.has_run && now.available.has_field(),
        is_on: Some(|now| now.look.streaks.is_some()), ..MOTION
    },
    LockScale: Entry {
        icon: Icon::Lock, text: "Lock the colour scale",
        tip: "Keep the scale of the colours of motion as it is here at every step, or let it follow the values again.",
        enabled: |now| now.has_run && now.available.has_field(),
        is_on: Some(|now| now.look.color_scale.is_some()), ..MOTION
    },
    FittingArrows: Entry {
        text: "Arrows scaled to fit",
        tip: "Scale the arrows so that they fill the space between them; the legend shows the factor.",
        sets: Some(("arrow-scale", "auto")), ..ARROWS
    },
    TrueArrows: Entry {
        text: "Arrows at 1×",
        tip: "Draw displacements to scale: each arrow ends at the matching position in frame t + 1.",
        sets: Some(("arrow-scale", "1")), ..ARROWS
    },
    DoubleArrows: Entry {
        text: "Arrows at 2×",
        tip: "Draw displacements at twice their length.",
        sets: Some(("arrow-scale", "2")), ..ARROWS
    },
    FourfoldArrows: Entry {
        text: "Arrows at 4×",
        tip: "Draw displacements at four times their length.",
        sets: Some(("arrow-scale", "4")), ..ARROWS
    },
    LargerInterface: Entry {
        icon: Icon::AArrowUp, text: "Larger interface", keys: &[ctrl(Key::Plus), ctrl(Key::Equals)],
        in_page: Some(&[]), repeats: true,
        tip: "Enlarge text, buttons and charts.",
        enabled: |now| now.can_be_larger, why_not: |_| Some("The interface is as large as fits into this window."),
        ..INTERFACE
    },
    SmallerInterface: Entry {
        icon: Icon::AArrowDown, text: "Smaller interface", keys: &[ctrl(Key::Minus)],
        in_page: Some(&[]), repeats: true,
        tip: "Reduce text, buttons and charts.",
        ..INTERFACE
    },
    NormalInterface: Entry {
        icon: Icon::CaseSensitive, text: "Normal interface size", keys: &[ctrl(Key::Num0)],
        in_page: Some(&[]),
        tip: "Use the scale of the operating system.",
        ..INTERFACE
    },
    ShowParameters: Entry {
        icon: Icon::PanelLeft, text: "Parameters", keys: &[ctrl(Key::Num1)],
        in_page: Some(&[alt(Key::P)]),
        tip: "Show or hide the parameters.",
        is_on: Some(|now| now.shows_parameters), tags: "settings preferences options sliders values", ..PANES
    },
    ShowExplanation: Entry {
        icon: Icon::PanelRight, text: "Explanation", keys: &[ctrl(Key::Num3)],
        in_page: Some(&[alt(Key::X)]),
        tip: "Show or hide the explanation of the step.",
        is_on: Some(|now| now.shows_explanation), ..PANES
    },
    ShowCharts: Entry {
        icon: Icon::PanelBottom, text: "Charts", keys: &[ctrl(Key::Num2)],
        in_page: Some(&[alt(Key::C)]),
        tip: "Show or hide the charts: cost surface, pixels, matrices, plots.",
        is_on: Some(|now| now.shows_charts), ..PANES
    },
    EnlargeChart: Entry {
        icon: Icon::Maximize2, text: "Enlarge chart", keys: &[key(Key::X)],
        tip: "Show the chart in the place of the stage, or the stage again.",
        enabled: |now| now.has_charts, is_on: Some(|now| now.has_enlarged), ..PANES
    },
    NextChart: Entry {
        icon: Icon::ChartColumn, text: "Next chart", keys: &[key(Key::N)],
        tip: "Show the next chart of the step.",
        enabled: |now| now.has_charts, ..PANES
    },
    NextPicture: Entry {
        icon: Icon::GalleryThumbnails, text: "Next picture large", keys: &[key(Key::V)],
        tip: "Make the next of the pictures the large one.",
        enabled: |now| now.has_large_picture, ..PANES
    },
    Landscape: Entry {
        icon: Icon::Mountain, text: "Landscape", keys: &[key(Key::P)],
        tip: "Lean the picture back: what the method climbs or descends rises from it. Drag to turn, scroll to zoom, double-click to return; a click goes to the step of a candidate.",
        enabled: |now| now.has_landscape,
        why_not: |now| now.has_run.then_some("This step has no landscape: it works out no cost, response or density over the picture."),
        ..PANES
    },
    PreviousChart: Entry {
        icon: Icon::ChartColumn, text: "Previous chart", keys: &[shift(Key::N)],
        tip: "Show the previous chart of the step.",
        enabled: |now| now.has_charts, ..PANES
    },
    ResetLayout: Entry {
        icon: Icon::LayoutDashboard, text: "Reset layout",
        tip: "Restore the default arrangement of the panes.",
        ..PANES
    },
    Lecture: Entry {
        icon: Icon::Presentation, text: "Lecture", keys: &[key(Key::L)], section: 3,
        tip: "Sentence, formula and chart in large type beside the pictures; the rest of the explanation when it is asked for.",
        is_on: Some(|now| now.lecture), tags: "presentation projector beamer class", ..VIEW
    },
    FullScreen: Entry {
        icon: Icon::Fullscreen, text: "Full screen", keys: &[key(Key::F), key(Key::F11)],
        in_page: Some(&[key(Key::F)]), section: 3,
        tip: "Switch full screen on or off.",
        tags: "presentation projector beamer class", ..VIEW
    },
    Predict: Entry {
        icon: Icon::CircleQuestionMark, text: "Predict, then reveal", keys: &[key(Key::Q)],
        tip: "Ask about each result before it is shown: click the place, count hands with the number keys, then reveal it with →.",
        enabled: |now| !now.in_lockstep && !now.at_start_page,
        why_not: |now| now.in_lockstep.then_some("Questions are about one estimator. Leave the lockstep first."),
        ..WALK
    },
    Present: Entry {
        icon: Icon::Presentation, text: "Present", keys: &[key(Key::F5)],
        in_page: Some(&[shift(Key::P)]),
        tip: "Full screen for the class: stage, one chart (chosen by the keys 1 to 5), sentence and formula, and nothing else; a clicker steps through it.",
        ..PRESENT
    },
    PresenterWindow: Entry {
        icon: Icon::MonitorSpeaker, text: "Presenter's window", keys: &[shift(Key::F)],
        tip: "Open a second window with the notes of the page, the next step and the time, for the presenter's own screen.",
        ..PRESENT
    },
    Pointer: Entry {
        icon: Icon::Pointer, text: "Pointer", keys: &[key(Key::O)],
        tip: "Point with a large dot that is visible from the last row; the explanation stays as it is.",
        ..PRESENT
    },
    Loupe: Entry {
        icon: Icon::Search, text: "Magnifying glass", keys: &[key(Key::Z)],
        tip: "Show the part of the picture under the pointer three times as large, with its marks and its ink.",
        enabled: |now| now.has_run, ..PRESENT
    },
    Blank: Entry {
        icon: Icon::Square, text: "Blank screen",
        tip: "Blank the full screen for the class. The next key or click shows it again. A clicker sends . or B.",
        enabled: |now| now.is_presenting, ..PRESENT
    },
    Pen: Entry {
        icon: Icon::Pen, text: "Pen", keys: &[key(Key::W)],
        tip: "Draw on the pictures, in full screen also on the chart. The ink stays with its step and is saved with it; pictures are exported with it.",
        enabled: |now| now.has_run, ..PRESENT
    },
    NextPenColor: Entry {
        icon: Icon::Palette, text: "Next colour of the pen", keys: &[key(Key::K)],
        tip: "Draw in the next colour: vermilion, yellow, blue or green.",
        enabled: |now| now.is_drawing, ..PRESENT
    },
    ClearInk: Entry {
        icon: Icon::Eraser, text: "Clear ink", keys: &[shift(Key::W)],
        tip: "Remove what was drawn on this step.",
        enabled: |now| now.has_ink, ..PRESENT
    },
    ReducedMotion: Entry {
        icon: Icon::Snail, text: "Reduced motion", section: 3,
        tip: "Show each step without animation.",
        is_on: Some(|now| now.reduced_motion), tags: "animation accessibility settings preferences options", ..VIEW
    },
    Play: Entry {
        icon: Icon::Play, text: "Play", keys: &[key(Key::Space)],
        tip: "Play or pause the run; at the end, play it again from the start.",
        enabled: |now| now.has_run, ..PLAYBACK
    },
    PlayBack: Entry {
        icon: Icon::StepBack, text: "Play backwards", keys: &[shift(Key::Space)],
        tip: "Play the run backwards, or pause; at the start, play it backwards from the end.",
        enabled: |now| now.has_run, ..PLAYBACK
    },
    Into: Entry {
        icon: Icon::ChevronRight, text: "Next {into}", keys: &[key(Key::ArrowRight)], repeats: true,
        tip: "Step forward one {into}.",
        enabled: Situation::can_step, ..FORWARD
    },
    IntoBack: Entry {
        icon: Icon::ChevronLeft, text: "Previous {into}", keys: &[key(Key::ArrowLeft)], repeats: true,
        tip: "Step back one {into}.",
        enabled: Situation::can_step_back, ..BACK
    },
    Over: Entry {
        icon: Icon::ChevronsRight, text: "Finish this {over}", keys: &[shift(Key::ArrowRight)], repeats: true,
        tip: "Go to the end of the current {over}; from there, to the end of the next one.",
        ..FORWARD
    },
    OverBack: Entry {
        icon: Icon::ChevronsLeft, text: "Back to the end of the previous {over}", keys: &[shift(Key::ArrowLeft)],
        repeats: true,
        tip: "Go back to the last step of the previous {over}.",
        ..BACK
    },
    Out: Entry {
        icon: Icon::ArrowRightToLine, text: "Finish the {out}", keys: &[key(Key::U)],
        tip: "Go to the end of the current {out}.",
        ..FORWARD
    },
    OutBack: Entry {
        icon: Icon::ArrowLeftToLine, text: "Back to the start of the {out}", keys: &[shift(Key::U)],
        tip: "Go back to the first step of the current {out}.",
        ..BACK
    },
    NextUnit: Entry {
        icon: Icon::ArrowRight, text: "Result of the next {over}", keys: &[key(Key::PageDown)], repeats: true,
        section: 6,
        tip: "Skip to the end of the {over} after this one; a presenter's clicker sends this key.",
        enabled: Situation::can_step, ..FORWARD
    },
    PreviousUnit: Entry {
        icon: Icon::ArrowLeft, text: "Result of the previous {over}", keys: &[key(Key::PageUp)], repeats: true,
        section: 6,
        tip: "Skip back to the end of the {over} before this one; a presenter's clicker sends this key.",
        enabled: Situation::can_step_back, ..BACK
    },
    NextPage: Entry {
        icon: Icon::ChevronRight, text: "Next page", keys: &[ctrl(Key::PageDown)],
        in_page: Some(&[shift(Key::PageDown)]),
        tip: "Turn to the next page of the lesson. In a lesson → steps through the page and then turns it, and a presenter's clicker turns it.",
        enabled: |now| now.in_lesson && !now.at_last_page, tags: "lesson turn", ..WALK
    },
    PreviousPage: Entry {
        icon: Icon::ChevronLeft, text: "Previous page", keys: &[ctrl(Key::PageUp)],
        in_page: Some(&[shift(Key::PageUp)]),
        tip: "Turn back to the previous page of the lesson.",
        enabled: |now| now.in_lesson && !now.at_first_page, tags: "lesson turn", ..WALK
    },
    BackToPage: Entry {
        icon: Icon::CornerUpLeft, text: "Back to the page before the link", keys: &[alt(Key::ArrowLeft)],
        in_page: Some(&[key(Key::Backspace)]),
        tip: "Return to the page of a lesson, and to its step, from which a link or a search led away.",
        enabled: |now| now.has_trail, ..WALK
    },
    NextMark: Entry {
        icon: Icon::SkipForward, text: "Next marked step", keys: &[key(Key::J)], section: 6,
        tip: "Go to the next step that the timeline marks, such as a union of labels, a new track or a crossing.",
        enabled: Situation::can_go_on, ..FORWARD
    },
    PreviousMark: Entry {
        icon: Icon::SkipBack, text: "Previous marked step", keys: &[shift(Key::J)], section: 6,
        tip: "Go back to the last step before this one that the timeline marks.",
        ..BACK
    },
    NextAlike: Entry {
        icon: Icon::SkipForward, text: "Next marked step of this kind", keys: &[ctrl(Key::J)],
        in_page: Some(&[alt(Key::J)]), section: 6,
        tip: "Go to the next step with the same mark as this one, such as the next rejected extremum or the next octave.",
        enabled: Situation::can_go_on, ..FORWARD
    },
    PreviousAlike: Entry {
        icon: Icon::SkipBack, text: "Previous marked step of this kind", keys: &[ctrl_shift(Key::J)],
        in_page: Some(&[alt_shift(Key::J)]), section: 6,
        tip: "Go back to the last step before this one with the same mark.",
        ..BACK
    },
    Start: Entry {
        icon: Icon::SkipBack, text: "Start of the run", keys: &[key(Key::Home)], section: 6,
        tip: "Go back to step 0, before the first {over}.",
        enabled: Situation::can_go_back, ..WALK
    },
    End: Entry {
        icon: Icon::SkipForward, text: "End of the run", keys: &[key(Key::End)], section: 6,
        tip: "Go to the last step.",
        enabled: |now| now.is_asked || now.can_go_on(), ..WALK
    },
    Compare: Entry {
        icon: Icon::ChartColumn, text: "Compare estimators…", keys: &[key(Key::C)], section: 9,
        tip: "Run several estimators on this pair of frames and compare time, candidates and errors in a table.",
        enabled: |now| now.has_clip, tags: "side by side table benchmark versus", ..WALK
    },
    Lockstep: Entry {
        icon: Icon::Grid2x2, text: "Estimators in lockstep", keys: &[key(Key::B)], section: 9,
        tip: "Step several estimators through the same block side by side, or continue with one.",
        enabled: |now| now.has_clip && !now.in_stage,
        why_not: |now| now.in_stage.then_some("Lockstep compares whole estimators. Leave this stage first."),
        is_on: Some(|now| now.in_lockstep), tags: "side by side table benchmark versus", ..WALK
    },
    IntoStage: Entry {
        icon: Icon::LogIn, text: "Open the stage", keys: &[key(Key::I)],
        tip: "Step through the estimator that this one uses as a stage, on the same frame.",
        enabled: |now| now.has_run && now.has_stage && !now.in_lockstep,
        why_not: |now| (now.has_stage && now.in_lockstep).then_some("A stage belongs to one estimator. Leave the lockstep first."),
        ..WALK
    },
    OutOfStage: Entry {
        icon: Icon::LogOut, text: "Close the stage", keys: &[shift(Key::I)],
        tip: "Return to the estimator that uses this stage.",
        enabled: |now| now.in_stage, ..WALK
    },
    Stop: Entry {
        icon: Icon::OctagonX, text: "Stop", keys: &[key(Key::Escape)], section: 7,
        tip: "Cancel the computation in progress.",
        enabled: |now| now.busy || now.checking || now.playing, ..WALK
    },
    Slower: Entry {
        icon: Icon::Rewind, text: "Play slower", keys: &[key(Key::OpenBracket)],
        tip: "Reduce the playback speed.",
        ..PLAYBACK
    },
    Faster: Entry {
        icon: Icon::FastForward, text: "Play faster", keys: &[key(Key::CloseBracket)],
        tip: "Increase the playback speed.",
        ..PLAYBACK
    },
    NextFrame: Entry {
        icon: Icon::Film, text: "Next video frame", keys: &[key(Key::Period)], repeats: true, section: 8,
        tip: "Estimate on the next pair of frames.",
        enabled: |now| now.has_clip && !now.at_last_frame, tags: "pair time", ..WALK
    },
    PreviousFrame: Entry {
        icon: Icon::Film, text: "Previous video frame", keys: &[key(Key::Comma)], repeats: true, section: 8,
        tip: "Estimate on the previous pair of frames.",
        enabled: |now| now.has_clip && !now.at_first_frame, tags: "pair time", ..WALK
    },
    ExportPicture: Entry {
        icon: Icon::ImageDown, text: "Picture of this step…", keys: &[ctrl(Key::E)],
        tip: "Save what the stage shows, with panes of your choice, as PNG, SVG or PDF.",
        enabled: |now| now.has_run, tags: "export save image screenshot figure png svg pdf slides", ..EXPORT
    },
    ExportSteps: Entry {
        icon: Icon::Images, text: "Several steps…", keys: &[ctrl_shift(Key::E)],
        tip: "Save a range of steps as numbered pictures, or as an animation.",
        enabled: |now| now.has_run, tags: "export save image screenshot figure png svg pdf slides", ..EXPORT
    },
    ExportResult: Entry {
        icon: Icon::FileDown, text: "Result…",
        tip: "Save the result so far: motion vectors, flow, features, tracks, objects or masks.",
        // The run stands at the step that is held back.
        enabled: |now| now.has_run && !now.is_asked,
        why_not: |now| now.is_asked.then_some("The result is held back. Reveal it first (→)."),
        tags: "export save flow vectors csv table flo kitti mot tracks masks npy", ..EXPORT
    },
    ExportScores: Entry {
        icon: Icon::ListChecks, text: "Scores of the class…",
        tip: "Save the questions that the class has answered, with hands, guesses and distances, as CSV.",
        enabled: |now| now.has_run && now.has_scores, ..EXPORT
    },
    ClearScores: Entry {
        icon: Icon::ListX, text: "Clear scores",
        tip: "Begin a new tally for the next class.",
        enabled: |now| now.has_scores, ..EXPORT
    },
    SaveHandout: Entry {
        icon: Icon::BookOpenText, text: "Handout of the lesson…",
        tip: "Save all pages of the lesson on sheets of paper as one PDF, with or without answers.",
        enabled: |now| now.in_lesson && now.has_run, tags: "print paper pdf pages contact sheet students", ..EXPORT
    },
    SaveWorksheet: Entry {
        icon: Icon::FilePenLine, text: "Worksheet of this step…",
        tip: "Save this step as a PDF to be computed by hand: its results are left out, or filled in.",
        enabled: |now| now.has_run, tags: "print paper pdf exercise homework blank students", ..EXPORT
    },
    Palette: Entry {
        icon: Icon::Search, text: "Find a command…", keys: &[ctrl(Key::K)],
        tip: "Find a command or setting by a few letters.",
        ..HELP
    },
    SearchText: Entry {
        icon: Icon::TextSearch, text: "Search all texts…", keys: &[ctrl_shift(Key::F)],
        tip: "Find words in lessons, glossary, estimators, parameters, charts and examples.",
        ..HELP
    },
    Glossary: Entry {
        icon: Icon::BookOpen, text: "Glossary…", keys: &[key(Key::D)],
        tip: "Define the terms of the course, by chapter.",
        tags: "definition term meaning", ..HELP
    },
    Shortcuts: Entry {
        icon: Icon::Keyboard, text: "Keyboard shortcuts", keys: &[key(Key::Questionmark), key(Key::F1)],
        tip: "List all shortcuts.",
        tags: "keys help", ..HELP
    },
    About: Entry { icon: Icon::Info, text: "About Motionscope", tip: "Version, licences and sources.", ..HELP },
}

impl Command {
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
