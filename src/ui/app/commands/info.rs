//! Every command's face: its menu, icon, name, tip and keys, in one table.

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

impl Command {
    /// How it is shown and called.
    pub fn info(self) -> CommandInfo {
        use Command as C;
        let view =
            |icon, view: View, keys: &'static [KeyboardShortcut]| (Menu::View, icon, view.name(), view.tip(), keys);
        let layer = |icon, layer: FlowLayer| {
            let none: &'static [KeyboardShortcut] = &[];
            (Menu::View, icon, layer.name(), layer.tip(), none)
        };
        let (menu, icon, text, tip, keys): (_, _, _, _, &'static [KeyboardShortcut]) = match self {
            C::Open => (
                Menu::File,
                Icon::FolderOpen,
                "Open…",
                "Open a video, a folder of pictures or a session; a path can be typed as well.",
                const { &[ctrl(Key::O)] },
            ),
            C::PastePath => (
                Menu::File,
                Icon::ClipboardPaste,
                "Open the path in the clipboard",
                "Open the clip whose path was copied.",
                const { &[ctrl_shift(Key::V)] },
            ),
            C::Samples => (
                Menu::File,
                Icon::LayoutGrid,
                "Samples…",
                "Choose among the bundled clips, each named for what it teaches.",
                const { &[ctrl(Key::N)] },
            ),
            C::SaveSession => (
                Menu::File,
                Icon::Save,
                "Save session…",
                "Write clip, estimator, parameters, place and view into a small text file that reopens exactly.",
                const { &[ctrl(Key::S)] },
            ),
            C::Quit => (Menu::File, Icon::LogOut, "Quit", "Leave Motionscope.", const { &[ctrl(Key::Q)] }),
            C::Undo => (
                Menu::Edit,
                Icon::Undo2,
                "Undo",
                "Take back the last change of a parameter.",
                const { &[ctrl(Key::Z)] },
            ),
            C::Redo => (
                Menu::Edit,
                Icon::Redo2,
                "Redo",
                "Make the change again that was taken back.",
                const { &[ctrl_shift(Key::Z), ctrl(Key::Y)] },
            ),
            C::ResetParameters => {
                (Menu::Edit, Icon::RotateCcw, "Reset parameters", "Set every parameter as it was declared.", &[])
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
                "Show the picture larger, around the pointer or the block at hand; the wheel does the same.",
                const { &[key(Key::Plus), key(Key::Equals)] },
            ),
            C::ZoomOut => {
                (Menu::View, Icon::ZoomOut, "Zoom out", "Show the picture smaller.", const { &[key(Key::Minus)] })
            }
            C::Fit => {
                (Menu::View, Icon::Maximize, "Fit picture", "Show the whole picture.", const { &[key(Key::Num0)] })
            }
            C::ActualSize => (
                Menu::View,
                Icon::Scan,
                "Actual size",
                "One pixel of the picture to one pixel of the screen.",
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
                "Dark, light, and projector with large type and thick lines.",
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
                "Into the stage",
                "Step through this estimator's stage on its own, on the same frame.",
                const { &[key(Key::I)] },
            ),
            C::OutOfStage => (
                Menu::Walk,
                Icon::LogOut,
                "Back out of the stage",
                "Go back to the estimator that this stage works for.",
                const { &[shift(Key::I)] },
            ),
            C::NextLayer => (
                Menu::View,
                Icon::SwatchBook,
                "Next colours of motion",
                "Other colours over the picture: none, directions, lengths, and at the end errors and checks.",
                const { &[key(Key::M)] },
            ),
            C::NoLayer => layer(Icon::CircleOff, FlowLayer::None),
            C::WheelLayer => layer(Icon::Palette, FlowLayer::Wheel),
            C::MagnitudeLayer => layer(Icon::Gauge, FlowLayer::Magnitude),
            C::ErrorLayer => layer(Icon::Target, FlowLayer::Error),
            C::ConfidenceLayer => layer(Icon::ShieldCheck, FlowLayer::Confidence),
            C::ConsistencyLayer => layer(Icon::ArrowLeftRight, FlowLayer::Consistency),
            C::Streaks => (
                Menu::View,
                Icon::Wind,
                "Streaklines",
                "Particles carried along by the motion, in the place of arrows.",
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
                "Arrows as long as fits",
                "Lengthen displacements as far as there is room between the blocks.",
                &[],
            ),
            C::TrueArrows => (
                Menu::View,
                Icon::MoveUpRight,
                "Arrows at 1×",
                "Draw displacements as long as they are, so that each arrow ends where its block went.",
                &[],
            ),
            C::DoubleArrows => {
                (Menu::View, Icon::MoveUpRight, "Arrows at 2×", "Draw displacements twice as long as they are.", &[])
            }
            C::FourfoldArrows => (
                Menu::View,
                Icon::MoveUpRight,
                "Arrows at 4×",
                "Draw displacements four times as long as they are.",
                &[],
            ),
            C::LargerInterface => (
                Menu::View,
                Icon::AArrowUp,
                "Larger interface",
                "Make everything larger.",
                const { &[ctrl(Key::Plus), ctrl(Key::Equals)] },
            ),
            C::SmallerInterface => (
                Menu::View,
                Icon::AArrowDown,
                "Smaller interface",
                "Make everything smaller.",
                const { &[ctrl(Key::Minus)] },
            ),
            C::NormalInterface => (
                Menu::View,
                Icon::CaseSensitive,
                "Normal interface size",
                "As large as the system says.",
                const { &[ctrl(Key::Num0)] },
            ),
            C::ShowParameters => (
                Menu::View,
                Icon::PanelLeft,
                "Parameters",
                "Show or fold away the parameters.",
                const { &[ctrl(Key::Num1)] },
            ),
            C::ShowCharts => (
                Menu::View,
                Icon::PanelBottom,
                "Charts",
                "Show or fold away the cost surface, the numbers and the plots.",
                const { &[ctrl(Key::Num2)] },
            ),
            C::ShowWhy => (
                Menu::View,
                Icon::PanelRight,
                "Explanation",
                "Show or fold away the explanation of the step.",
                const { &[ctrl(Key::Num3)] },
            ),
            C::Lecture => (
                Menu::View,
                Icon::Presentation,
                "Lecture",
                "Nothing but the stage, the explanation and the transport.",
                const { &[key(Key::L)] },
            ),
            C::FullScreen => (
                Menu::View,
                Icon::Fullscreen,
                "Full screen",
                "Use the whole screen.",
                const { &[key(Key::F), key(Key::F11)] },
            ),
            C::ReducedMotion => {
                (Menu::View, Icon::Snail, "Reduced motion", "Show each step at once, without animation.", &[])
            }
            C::ResetLayout => {
                (Menu::View, Icon::LayoutDashboard, "Reset layout", "Put every pane back where it was at first.", &[])
            }
            C::Play => (
                Menu::Walk,
                Icon::Play,
                "Play",
                "Play the run, or pause it; at its end, play it again from the start.",
                const { &[key(Key::Space)] },
            ),
            C::Into => (
                Menu::Walk,
                Icon::ChevronRight,
                "Next {into}",
                "Step into: see the next {into}.",
                const { &[key(Key::ArrowRight)] },
            ),
            C::IntoBack => (
                Menu::Walk,
                Icon::ChevronLeft,
                "Previous {into}",
                "Step back to the previous {into}.",
                const { &[key(Key::ArrowLeft)] },
            ),
            C::Over => (
                Menu::Walk,
                Icon::ChevronsRight,
                "To the end of the {over}",
                "Step over: finish this {over}, or do the next one whole.",
                const { &[shift(Key::ArrowRight)] },
            ),
            C::OverBack => (
                Menu::Walk,
                Icon::ChevronsLeft,
                "Back to the {over} before",
                "Go back to the end of the {over} before.",
                const { &[shift(Key::ArrowLeft)] },
            ),
            C::Out => (
                Menu::Walk,
                Icon::ArrowRightToLine,
                "To the end of the {out}",
                "Step out: finish this {out}.",
                const { &[key(Key::U)] },
            ),
            C::OutBack => (
                Menu::Walk,
                Icon::ArrowLeftToLine,
                "Back to the start of the {out}",
                "Step out backwards, to where this {out} began.",
                const { &[shift(Key::U)] },
            ),
            C::NextUnit => (
                Menu::Walk,
                Icon::ArrowRight,
                "Next {over}",
                "Go to the end of the next {over}; a presenter's clicker does this.",
                const { &[key(Key::PageDown)] },
            ),
            C::PreviousUnit => (
                Menu::Walk,
                Icon::ArrowLeft,
                "Previous {over}",
                "Go to the end of the previous {over}; a presenter's clicker does this.",
                const { &[key(Key::PageUp)] },
            ),
            C::Start => (
                Menu::Walk,
                Icon::SkipBack,
                "Start of the run",
                "Go back to where nothing has been done yet.",
                const { &[key(Key::Home)] },
            ),
            C::End => (Menu::Walk, Icon::SkipForward, "End of the run", "Run to the end.", const { &[key(Key::End)] }),
            C::Compare => (
                Menu::Walk,
                Icon::ChartColumn,
                "Compare estimators…",
                "Run several estimators on this pair of frames, and see what each costs, finds and misses.",
                const { &[key(Key::C)] },
            ),
            C::Lockstep => (
                Menu::Walk,
                Icon::Grid2x2,
                "Estimators in lockstep",
                "Have several estimators search the same block side by side, or go on with one alone.",
                const { &[key(Key::B)] },
            ),
            C::Stop => (
                Menu::Walk,
                Icon::OctagonX,
                "Stop",
                "Give up a move or a check that takes long.",
                const { &[key(Key::Escape)] },
            ),
            C::Slower => {
                (Menu::Walk, Icon::Rewind, "Play slower", "Play at a lower speed.", const { &[key(Key::OpenBracket)] })
            }
            C::Faster => (
                Menu::Walk,
                Icon::FastForward,
                "Play faster",
                "Play at a higher speed.",
                const { &[key(Key::CloseBracket)] },
            ),
            C::NextFrame => (
                Menu::Walk,
                Icon::Film,
                "Next video frame",
                "Run on the next pair of frames.",
                const { &[key(Key::Period)] },
            ),
            C::PreviousFrame => (
                Menu::Walk,
                Icon::Film,
                "Previous video frame",
                "Run on the previous pair of frames.",
                const { &[key(Key::Comma)] },
            ),
            C::ExportPicture => (
                Menu::Export,
                Icon::ImageDown,
                "Picture of this step…",
                "Write what the stage shows as PNG or SVG, at any scale.",
                const { &[ctrl(Key::E)] },
            ),
            C::ExportSteps => (
                Menu::Export,
                Icon::Images,
                "Pictures of several steps…",
                "Write a range of steps as numbered PNGs.",
                const { &[ctrl_shift(Key::E)] },
            ),
            C::ExportResult => (
                Menu::Export,
                Icon::FileDown,
                "Result…",
                "Write the result so far: vectors, flow, features, tracks, objects or masks, in their formats.",
                &[],
            ),
            C::Palette => (
                Menu::Help,
                Icon::Search,
                "Find a command…",
                "Type a few letters of any command.",
                const { &[ctrl(Key::K)] },
            ),
            C::Shortcuts => (
                Menu::Help,
                Icon::Keyboard,
                "Keyboard shortcuts",
                "Every key on one page.",
                const { &[key(Key::Questionmark), key(Key::F1)] },
            ),
            C::About => {
                (Menu::Help, Icon::Info, "About Motionscope", "What this program is and where it comes from.", &[])
            }
        };
        CommandInfo { menu, icon, text, tip, keys }
    }
}
