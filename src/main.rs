//! Starts the window.

fn main() -> anyhow::Result<()> {
    motionscope::ui::run(motionscope::ui::Start { path: std::env::args_os().nth(1).map(Into::into) })
}
