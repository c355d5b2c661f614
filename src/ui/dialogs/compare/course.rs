//! The course's table in the comparison dialog.

use eframe::egui::{Grid, Label, RichText, TextStyle, Ui};

use crate::experiment::course_table::{CourseRow, Verdict};
use crate::ui::drawing::style;
use crate::ui::model::background::Background;

/// Shows the course's table once it is measured.
pub fn measured(ui: &mut Ui, course: &Background<Vec<CourseRow>>) {
    course.look(|outcome| match outcome {
        None => drop(ui.spinner()),
        Some(Err(error)) => drop(ui.label(RichText::new(error.to_string()).color(ui.visuals().error_fg_color))),
        Some(Ok(course_table)) => {
            Grid::new("course").striped(true).spacing([16.0, 6.0]).show(ui, |ui| {
                for heading in ["Measured", "Sequential", "Logarithmic", "Hierarchical", "Statements of the course"] {
                    ui.label(RichText::new(heading).small().family(style::bold()));
                }
                ui.end_row();
                course_table.iter().for_each(|row| line(ui, row));
            });
        }
    });
}

/// Shows a row: the feature, the three measurements, and whether the statement holds.
fn line(ui: &mut Ui, row: &CourseRow) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.vertical(|ui| {
        ui.set_max_width(15.0 * size);
        let (what, unit) = row.feature.split_once(": ").unwrap_or((&row.feature, ""));
        ui.add(Label::new(RichText::new(what).family(style::bold())).wrap());
        ui.add(Label::new(RichText::new(unit).small().weak()).wrap());
    });
    for cell in &row.measured {
        ui.label(RichText::new(cell).monospace());
    }
    ui.vertical(|ui| {
        // The rest of the dialog's width, which the measurements leave.
        ui.set_max_width((ui.clip_rect().max.x - ui.cursor().min.x - 12.0).clamp(12.0 * size, 24.0 * size));
        let verdict = row.verdict();
        let text = RichText::new(verdict.text());
        ui.add(Label::new(if verdict == Verdict::Holds { text } else { text.family(style::bold()) }).wrap());
        for claim in &row.claims {
            let mark = match claim.holds {
                Some(true) => "holds: ",
                Some(false) => "not so: ",
                None => "",
            };
            ui.add(Label::new(RichText::new(format!("{mark}{}", claim.quoted())).small().weak()).wrap());
        }
    });
    ui.end_row();
}
