//! Handouts and worksheets from the window.

use super::files::write_to;
use super::*;

fn opened(name: &str) -> Window {
    Window::with(vec2(1280.0, 720.0), Start { open: Some(name.into()) })
}

/// The number of pages of a PDF.
fn pages(file: &Path) -> usize {
    let pdf = fs::read(file).expect("a file");
    assert!(pdf.starts_with(b"%PDF-"), "{}", file.display());
    let word = b"/Type /Page\n";
    pdf.windows(word.len()).filter(|found| *found == word).count()
}

#[test]
fn a_lesson_is_saved_as_a_handout_from_the_dialog() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = opened("lesson:gradient-constraint");
    let count = motionscope::session::lesson::all()[4].pages.len();
    window.command(Command::SaveHandout);
    let offered = window.harness.query_all_by_role(Role::TextInput).find_map(|node| node.accesskit_node().value());
    assert!(offered.is_some_and(|path| path.ends_with("gradient-constraint_handout.pdf")), "named after its lesson");
    window.click_role(Role::Button, "4");
    let file = folder.path().join("handout.pdf");
    write_to(&mut window, &file);
    let message = window.app().message().unwrap_or_default().to_owned();
    assert!(message.contains("Saved"), "{message}");
    assert_eq!(pages(&file), count.div_ceil(4));
}

#[test]
fn a_step_is_saved_as_a_worksheet_and_one_without_results_says_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = opened("lesson:horn-schunck/2");
    window.key(Key::ArrowRight);
    window.command(Command::SaveWorksheet);
    let file = folder.path().join("sheet.pdf");
    write_to(&mut window, &file);
    let message = window.app().message().unwrap_or_default().to_owned();
    assert!(message.contains("Saved") && pages(&file) > 0, "{message}");

    let mut window = opened("lesson:horn-schunck/1");
    window.command(Command::SaveWorksheet);
    let nothing = folder.path().join("nothing.pdf");
    write_to(&mut window, &nothing);
    let message = window.app().message().unwrap_or_default().to_owned();
    assert!(message.contains("choose a step") && !nothing.exists(), "{message}");
}
