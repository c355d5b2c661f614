//! The menu, icon, name, tooltip and shortcuts of every command, in one table.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};
use lucide_icons::Icon;

use crate::paint::{ColorMap, FlowLayer, FocusMode, Theme, View};
use crate::ui::app::commands::{Command, CommandInfo, Menu};

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

/// The picture of a layer in menus.
fn layer_icon(layer: FlowLayer) -> Icon {
    match layer {
        FlowLayer::None => Icon::CircleOff,
        FlowLayer::Wheel => Icon::Palette,
        FlowLayer::Magnitude => Icon::Gauge,
        FlowLayer::Error => Icon::Target,
        FlowLayer::Difference => Icon::Diff,
        FlowLayer::Confidence => Icon::ShieldCheck,
        FlowLayer::Consistency => Icon::ArrowLeftRight,
        FlowLayer::Model(_) => Icon::Layers,
    }
}

impl Command {
    /// How the command is shown and called.
    pub fn info(self) -> CommandInfo {
        use Command as C;
        let view =
            |icon, view: View, keys: &'static [KeyboardShortcut]| (Menu::View, icon, view.name(), view.tip(), keys);
        let (menu, icon, text, tip, keys): (_, _, _, _, &'static [KeyboardShortcut]) = match self {
            C::Open => (
                Menu::File,
                Icon::FolderOpen,
                "Open…",
                "Open a video, an image sequence, a folder or a session; a path can be typed as well.",
                const { &[ctrl(Key::O)] },
            ),
            C::PastePath => (
                Menu::File,
                Icon::ClipboardPaste,
                "Open path from clipboard",
                "Open the clip at the path in the clipboard.",
                const { &[ctrl_shift(Key::V)] },
            ),
            C::OpenRightView => (
                Menu::File,
                Icon::Columns2,
                "Open right view…",
                "Open the right view of the clip, from a second camera: a picture, a folder or a video. Synthetic scenes have their own views.",
                &[],
            ),
            C::StartPage => (
                Menu::File,
                Icon::House,
                "Start page",
                "Show samples, estimators, lessons and what was open lately, or return to the window.",
                const { &[ctrl(Key::H)] },
            ),
            C::Samples => (
                Menu::File,
                Icon::LayoutGrid,
                "Samples…",
                "Choose a bundled clip; each shows one effect, such as occlusion or the aperture problem.",
                const { &[ctrl(Key::N)] },
            ),
            C::Camera => (
                Menu::File,
                Icon::Camera,
                "Camera…",
                "Record a clip from a camera, or watch an estimator run on its live picture.",
                const { &[ctrl(Key::R)] },
            ),
            C::NextExample => (
                Menu::File,
                Icon::Lightbulb,
                "Next example",
                "Open the next clip on which this estimator works, or fails, with the reason.",
                const { &[key(Key::E)] },
            ),
            C::Lessons => (
                Menu::File,
                Icon::BookOpen,
                "Lessons…",
                "Choose a lesson of the course: pages of words and formulas beside the steps that they explain.",
                const { &[ctrl(Key::L)] },
            ),
            C::CloseLesson => {
                (Menu::File, Icon::BookX, "Close lesson", "Close the lesson; its clip and its run stay open.", &[])
            }
            C::CopyPage => (
                Menu::File,
                Icon::ClipboardCopy,
                "Copy as page of a lesson",
                "Copy clip, estimator, parameters, current step and view as the header of a page, to be pasted into the Markdown file of a lesson.",
                &[],
            ),
            C::SaveSession => (
                Menu::File,
                Icon::Save,
                "Save session…",
                "Save clip, estimator, parameters, current step, view and ink as a small text file (*.motionscope).",
                const { &[ctrl(Key::S)] },
            ),
            C::SaveClip => (
                Menu::File,
                Icon::Film,
                "Save clip as…",
                "Save the frames of the clip: as they came in one file, or as numbered pictures.",
                const { &[ctrl_shift(Key::S)] },
            ),
            C::Quit => (Menu::File, Icon::LogOut, "Quit", "Close Motionscope.", const { &[ctrl(Key::Q)] }),
            C::Estimators => (
                Menu::Edit,
                Icon::Grid3x3,
                "Estimators…",
                "Choose the estimator by family, with a picture of each and what suits the clip.",
                const { &[key(Key::A)] },
            ),
            C::Undo => (
                Menu::Edit,
                Icon::Undo2,
                "Undo",
                "Undo the last change of a parameter, or of the ink while the pen is on.",
                const { &[ctrl(Key::Z)] },
            ),
            C::Redo => (
                Menu::Edit,
                Icon::Redo2,
                "Redo",
                "Redo the change that was undone last.",
                const { &[ctrl_shift(Key::Z), ctrl(Key::Y)] },
            ),
            C::ResetParameters => {
                (Menu::Edit, Icon::RotateCcw, "Reset parameters", "Set every parameter to its default.", &[])
            }
            C::SideBySide => view(Icon::Columns2, View::SideBySide, const { &[key(Key::Num1)] }),
            C::FrameT => view(Icon::Square, View::Current, const { &[key(Key::Num2)] }),
            C::FrameNext => view(Icon::SquareArrowRight, View::Next, const { &[key(Key::Num3)] }),
            C::Difference => view(Icon::Diff, View::Difference, const { &[key(Key::Num4)] }),
            C::Blend => view(Icon::Blend, View::Blend, const { &[key(Key::Num5)] }),
            C::Blink => view(Icon::FlipHorizontal2, View::Blink, const { &[key(Key::Num6)] }),
            C::Prediction => view(Icon::Puzzle, View::Prediction, const { &[key(Key::Num7)] }),
            C::Residual => view(Icon::Eraser, View::Residual, const { &[key(Key::Num8)] }),
            C::ZoomIn => (
                Menu::View,
                Icon::ZoomIn,
                "Zoom in",
                "Enlarge the picture around the pointer or the current block; the mouse wheel does the same.",
                const { &[key(Key::Plus), key(Key::Equals)] },
            ),
            C::ZoomOut => (Menu::View, Icon::ZoomOut, "Zoom out", "Reduce the picture.", const { &[key(Key::Minus)] }),
            C::Fit => (
                Menu::View,
                Icon::Maximize,
                "Fit picture",
                "Zoom so that the whole picture fits.",
                const { &[key(Key::Num0)] },
            ),
            C::ActualSize => (
                Menu::View,
                Icon::Scan,
                "Actual size",
                "Zoom to one screen pixel per image pixel.",
                const { &[key(Key::Num9)] },
            ),
            C::Focus => (
                Menu::View,
                Icon::Focus,
                "Focus on the work",
                "Magnify the block, window or ellipse of the step and follow it from step to step, or show the whole picture again.",
                const { &[key(Key::G)] },
            ),
            C::FocusWhereSmall => (Menu::View, Icon::ZoomIn, FocusMode::Auto.name(), FocusMode::Auto.tip(), &[]),
            C::FocusAlways => (Menu::View, Icon::ZoomIn, FocusMode::On.name(), FocusMode::On.tip(), &[]),
            C::FocusNever => (Menu::View, Icon::Maximize, FocusMode::Off.name(), FocusMode::Off.tip(), &[]),
            C::NextTheme => (
                Menu::View,
                Icon::Contrast,
                "Next theme",
                "Switch between dark, light, and projector (large type, thick lines).",
                const { &[key(Key::T)] },
            ),
            C::DarkTheme => (Menu::View, Icon::Moon, "Dark theme", Theme::Dark.tip(), &[]),
            C::LightTheme => (Menu::View, Icon::Sun, "Light theme", Theme::Light.tip(), &[]),
            C::ProjectorTheme => (Menu::View, Icon::Projector, "Projector theme", Theme::Projector.tip(), &[]),
            C::ViridisColors => (Menu::View, Icon::Palette, "Viridis colours", ColorMap::Viridis.tip(), &[]),
            C::TurboColors => (Menu::View, Icon::Rainbow, "Turbo colours", ColorMap::Turbo.tip(), &[]),
            C::IntoStage => (
                Menu::Walk,
                Icon::LogIn,
                "Open the stage",
                "Step through the estimator that this one uses as a stage, on the same frame.",
                const { &[key(Key::I)] },
            ),
            C::OutOfStage => (
                Menu::Walk,
                Icon::LogOut,
                "Close the stage",
                "Return to the estimator that uses this stage.",
                const { &[shift(Key::I)] },
            ),
            C::NextLayer => (
                Menu::View,
                Icon::SwatchBook,
                "Next flow colours",
                "Switch the layer over the picture: none, flow wheel, magnitude, in lockstep the difference from the first estimator; at the end of the run also error, confidence and forward–backward check.",
                const { &[key(Key::M)] },
            ),
            C::Layer(layer) => (Menu::View, layer_icon(layer), layer.name(), layer.tip(), &[]),
            C::Streaks => (
                Menu::View,
                Icon::Wind,
                "Streaklines",
                "Show the flow as moving particles instead of arrows.",
                const { &[key(Key::S)] },
            ),
            C::LockScale => (
                Menu::View,
                Icon::Lock,
                "Lock the colour scale",
                "Keep the scale of the colours of motion as it is here at every step, or let it follow the values again.",
                &[],
            ),
            C::FittingArrows => (
                Menu::View,
                Icon::MoveUpRight,
                "Arrows scaled to fit",
                "Scale the arrows so that they fill the space between them; the legend shows the factor.",
                &[],
            ),
            C::TrueArrows => (
                Menu::View,
                Icon::MoveUpRight,
                "Arrows at 1×",
                "Draw displacements to scale: each arrow ends at the matching position in frame t + 1.",
                &[],
            ),
            C::DoubleArrows => {
                (Menu::View, Icon::MoveUpRight, "Arrows at 2×", "Draw displacements at twice their length.", &[])
            }
            C::FourfoldArrows => {
                (Menu::View, Icon::MoveUpRight, "Arrows at 4×", "Draw displacements at four times their length.", &[])
            }
            C::LargerInterface => (
                Menu::View,
                Icon::AArrowUp,
                "Larger interface",
                "Enlarge text, buttons and charts.",
                const { &[ctrl(Key::Plus), ctrl(Key::Equals)] },
            ),
            C::SmallerInterface => (
                Menu::View,
                Icon::AArrowDown,
                "Smaller interface",
                "Reduce text, buttons and charts.",
                const { &[ctrl(Key::Minus)] },
            ),
            C::NormalInterface => (
                Menu::View,
                Icon::CaseSensitive,
                "Normal interface size",
                "Use the scale of the operating system.",
                const { &[ctrl(Key::Num0)] },
            ),
            C::ShowParameters => (
                Menu::View,
                Icon::PanelLeft,
                "Parameters",
                "Show or hide the parameters.",
                const { &[ctrl(Key::Num1)] },
            ),
            C::ShowCharts => (
                Menu::View,
                Icon::PanelBottom,
                "Charts",
                "Show or hide the charts: cost surface, pixels, matrices, plots.",
                const { &[ctrl(Key::Num2)] },
            ),
            C::ShowExplanation => (
                Menu::View,
                Icon::PanelRight,
                "Explanation",
                "Show or hide the explanation of the step.",
                const { &[ctrl(Key::Num3)] },
            ),
            C::EnlargeChart => (
                Menu::View,
                Icon::Maximize2,
                "Enlarge chart",
                "Show the chart in the place of the stage, or the stage again.",
                const { &[key(Key::X)] },
            ),
            C::NextChart => (
                Menu::View,
                Icon::ChartColumn,
                "Next chart",
                "Show the next chart of the step.",
                const { &[key(Key::N)] },
            ),
            C::PreviousChart => (
                Menu::View,
                Icon::ChartColumn,
                "Previous chart",
                "Show the previous chart of the step.",
                const { &[shift(Key::N)] },
            ),
            C::NextPicture => (
                Menu::View,
                Icon::GalleryThumbnails,
                "Next picture large",
                "Make the next of the pictures the large one.",
                const { &[key(Key::V)] },
            ),
            C::Landscape => (
                Menu::View,
                Icon::Mountain,
                "Landscape",
                "Lean the picture back: what the method climbs or descends rises from it. Drag to turn, scroll to zoom, double-click to return; a click goes to the step of a candidate.",
                const { &[key(Key::P)] },
            ),
            C::Lecture => (
                Menu::View,
                Icon::Presentation,
                "Lecture",
                "Sentence, formula and chart in large type beside the pictures; the rest of the explanation when it is asked for.",
                const { &[key(Key::L)] },
            ),
            C::FullScreen => (
                Menu::View,
                Icon::Fullscreen,
                "Full screen",
                "Switch full screen on or off.",
                const { &[key(Key::F), key(Key::F11)] },
            ),
            C::Predict => (
                Menu::Walk,
                Icon::CircleQuestionMark,
                "Predict, then reveal",
                "Ask about each result before it is shown: click the place, count hands with the number keys, then reveal it with →.",
                const { &[key(Key::Q)] },
            ),
            C::Present => (
                Menu::View,
                Icon::Presentation,
                "Present",
                "Full screen for the class: stage, one chart (chosen by the keys 1 to 5), sentence and formula, and nothing else; a clicker steps through it.",
                const { &[key(Key::F5)] },
            ),
            C::PresenterWindow => (
                Menu::View,
                Icon::MonitorSpeaker,
                "Presenter's window",
                "Open a second window with the notes of the page, the next step and the time, for the presenter's own screen.",
                const { &[shift(Key::F)] },
            ),
            C::Pointer => (
                Menu::View,
                Icon::Pointer,
                "Pointer",
                "Point with a large dot that is visible from the last row; the explanation stays as it is.",
                const { &[key(Key::O)] },
            ),
            C::Loupe => (
                Menu::View,
                Icon::Search,
                "Magnifying glass",
                "Show the part of the picture under the pointer three times as large, with its marks and its ink.",
                const { &[key(Key::Z)] },
            ),
            C::Blank => (
                Menu::View,
                Icon::Square,
                "Blank screen",
                "Blank the full screen for the class. The next key or click shows it again. A clicker sends . or B.",
                &[],
            ),
            C::Pen => (
                Menu::View,
                Icon::Pen,
                "Pen",
                "Draw on the pictures, in full screen also on the chart. The ink stays with its step and is saved with it; pictures are exported with it.",
                const { &[key(Key::W)] },
            ),
            C::NextPenColor => (
                Menu::View,
                Icon::Palette,
                "Next colour of the pen",
                "Draw in the next colour: vermilion, yellow, blue or green.",
                const { &[key(Key::K)] },
            ),
            C::ClearInk => (
                Menu::View,
                Icon::Eraser,
                "Clear ink",
                "Remove what was drawn on this step.",
                const { &[shift(Key::W)] },
            ),
            C::ReducedMotion => (Menu::View, Icon::Snail, "Reduced motion", "Show each step without animation.", &[]),
            C::ResetLayout => (
                Menu::View,
                Icon::LayoutDashboard,
                "Reset layout",
                "Restore the default arrangement of the panes.",
                &[],
            ),
            C::Play => (
                Menu::Walk,
                Icon::Play,
                "Play",
                "Play or pause the run; at the end, play it again from the start.",
                const { &[key(Key::Space)] },
            ),
            C::PlayBack => (
                Menu::Walk,
                Icon::StepBack,
                "Play backwards",
                "Play the run backwards, or pause; at the start, play it backwards from the end.",
                const { &[shift(Key::Space)] },
            ),
            C::Into => (
                Menu::Walk,
                Icon::ChevronRight,
                "Next {into}",
                "Step forward one {into}.",
                const { &[key(Key::ArrowRight)] },
            ),
            C::IntoBack => (
                Menu::Walk,
                Icon::ChevronLeft,
                "Previous {into}",
                "Step back one {into}.",
                const { &[key(Key::ArrowLeft)] },
            ),
            C::Over => (
                Menu::Walk,
                Icon::ChevronsRight,
                "Finish this {over}",
                "Go to the end of the current {over}; from there, to the end of the next one.",
                const { &[shift(Key::ArrowRight)] },
            ),
            C::OverBack => (
                Menu::Walk,
                Icon::ChevronsLeft,
                "Back to the end of the previous {over}",
                "Go back to the last step of the previous {over}.",
                const { &[shift(Key::ArrowLeft)] },
            ),
            C::Out => (
                Menu::Walk,
                Icon::ArrowRightToLine,
                "Finish the {out}",
                "Go to the end of the current {out}.",
                const { &[key(Key::U)] },
            ),
            C::OutBack => (
                Menu::Walk,
                Icon::ArrowLeftToLine,
                "Back to the start of the {out}",
                "Go back to the first step of the current {out}.",
                const { &[shift(Key::U)] },
            ),
            C::NextUnit => (
                Menu::Walk,
                Icon::ArrowRight,
                "Result of the next {over}",
                "Skip to the end of the {over} after this one; a presenter's clicker sends this key.",
                const { &[key(Key::PageDown)] },
            ),
            C::PreviousUnit => (
                Menu::Walk,
                Icon::ArrowLeft,
                "Result of the previous {over}",
                "Skip back to the end of the {over} before this one; a presenter's clicker sends this key.",
                const { &[key(Key::PageUp)] },
            ),
            C::NextPage => (
                Menu::Walk,
                Icon::ChevronRight,
                "Next page",
                "Turn to the next page of the lesson. In a lesson → steps through the page and then turns it, and a presenter's clicker turns it.",
                const { &[ctrl(Key::PageDown)] },
            ),
            C::PreviousPage => (
                Menu::Walk,
                Icon::ChevronLeft,
                "Previous page",
                "Turn back to the previous page of the lesson.",
                const { &[ctrl(Key::PageUp)] },
            ),
            C::BackToPage => (
                Menu::Walk,
                Icon::CornerUpLeft,
                "Back to the page before the link",
                "Return to the page of a lesson, and to its step, from which a link or a search led away.",
                const { &[alt(Key::ArrowLeft)] },
            ),
            C::NextMark => (
                Menu::Walk,
                Icon::SkipForward,
                "Next marked step",
                "Go to the next step that the timeline marks, such as a union of labels, a new track or a crossing.",
                const { &[key(Key::J)] },
            ),
            C::PreviousMark => (
                Menu::Walk,
                Icon::SkipBack,
                "Previous marked step",
                "Go back to the last step before this one that the timeline marks.",
                const { &[shift(Key::J)] },
            ),
            C::NextAlike => (
                Menu::Walk,
                Icon::SkipForward,
                "Next marked step of this kind",
                "Go to the next step with the same mark as this one, such as the next rejected extremum or the next octave.",
                const { &[ctrl(Key::J)] },
            ),
            C::PreviousAlike => (
                Menu::Walk,
                Icon::SkipBack,
                "Previous marked step of this kind",
                "Go back to the last step before this one with the same mark.",
                const { &[ctrl_shift(Key::J)] },
            ),
            C::Start => (
                Menu::Walk,
                Icon::SkipBack,
                "Start of the run",
                "Go back to step 0, before the first {over}.",
                const { &[key(Key::Home)] },
            ),
            C::End => {
                (Menu::Walk, Icon::SkipForward, "End of the run", "Go to the last step.", const { &[key(Key::End)] })
            }
            C::Compare => (
                Menu::Walk,
                Icon::ChartColumn,
                "Compare estimators…",
                "Run several estimators on this pair of frames and compare time, candidates and errors in a table.",
                const { &[key(Key::C)] },
            ),
            C::Lockstep => (
                Menu::Walk,
                Icon::Grid2x2,
                "Estimators in lockstep",
                "Step several estimators through the same block side by side, or continue with one.",
                const { &[key(Key::B)] },
            ),
            C::Stop => (
                Menu::Walk,
                Icon::OctagonX,
                "Stop",
                "Cancel the computation in progress.",
                const { &[key(Key::Escape)] },
            ),
            C::Slower => (
                Menu::Walk,
                Icon::Rewind,
                "Play slower",
                "Reduce the playback speed.",
                const { &[key(Key::OpenBracket)] },
            ),
            C::Faster => (
                Menu::Walk,
                Icon::FastForward,
                "Play faster",
                "Increase the playback speed.",
                const { &[key(Key::CloseBracket)] },
            ),
            C::NextFrame => (
                Menu::Walk,
                Icon::Film,
                "Next video frame",
                "Estimate on the next pair of frames.",
                const { &[key(Key::Period)] },
            ),
            C::PreviousFrame => (
                Menu::Walk,
                Icon::Film,
                "Previous video frame",
                "Estimate on the previous pair of frames.",
                const { &[key(Key::Comma)] },
            ),
            C::ExportPicture => (
                Menu::Export,
                Icon::ImageDown,
                "Picture of this step…",
                "Save what the stage shows, with panes of your choice, as PNG, SVG or PDF.",
                const { &[ctrl(Key::E)] },
            ),
            C::ExportSteps => (
                Menu::Export,
                Icon::Images,
                "Several steps…",
                "Save a range of steps as numbered pictures, or as an animation: GIF, APNG, WebP or MP4.",
                const { &[ctrl_shift(Key::E)] },
            ),
            C::ExportResult => (
                Menu::Export,
                Icon::FileDown,
                "Result…",
                "Save the result so far: motion vectors, flow, features, tracks, objects or masks.",
                &[],
            ),
            C::ExportScores => (
                Menu::Export,
                Icon::ListChecks,
                "Scores of the class…",
                "Save the questions that the class has answered, with hands, guesses and distances, as CSV.",
                &[],
            ),
            C::ClearScores => (Menu::Export, Icon::ListX, "Clear scores", "Begin a new tally for the next class.", &[]),
            C::SaveHandout => (
                Menu::Export,
                Icon::BookOpenText,
                "Handout of the lesson…",
                "Save all pages of the lesson on sheets of paper as one PDF, with or without answers.",
                &[],
            ),
            C::SaveWorksheet => (
                Menu::Export,
                Icon::FilePenLine,
                "Worksheet of this step…",
                "Save this step as a PDF to be computed by hand: its results are left out, or filled in.",
                &[],
            ),
            C::Palette => (
                Menu::Help,
                Icon::Search,
                "Find a command…",
                "Find a command or setting by a few letters.",
                const { &[ctrl(Key::K)] },
            ),
            C::SearchText => (
                Menu::Help,
                Icon::TextSearch,
                "Search all texts…",
                "Find words in lessons, glossary, estimators, parameters, charts and examples.",
                const { &[ctrl_shift(Key::F)] },
            ),
            C::Glossary => (
                Menu::Help,
                Icon::BookOpen,
                "Glossary…",
                "Define the terms of the course, by chapter.",
                const { &[key(Key::D)] },
            ),
            C::Shortcuts => (
                Menu::Help,
                Icon::Keyboard,
                "Keyboard shortcuts",
                "List all shortcuts.",
                const { &[key(Key::Questionmark), key(Key::F1)] },
            ),
            C::About => (Menu::Help, Icon::Info, "About Motionscope", "Version, licences and sources.", &[]),
        };
        CommandInfo { menu, icon, text, tip, keys }
    }
}
