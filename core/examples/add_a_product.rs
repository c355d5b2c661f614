//! A kind of result that does not exist yet: one displacement for the whole picture.

use motionscope_core::base::Error;
use motionscope_core::data::Flow;
use motionscope_core::geometry::Grid;
use motionscope_core::products::table::{Cell, Table};
use motionscope_core::products::{Assessment, Column, Measure, Motion, Output, Product, ProductKind, Reference, Score};
use motionscope_core::scene::Fact;

/// The displacement of the whole picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Shift {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// Displacement `[u, v]` in px/frame.
    pub displacement: [f32; 2],
}

/// A figure by which it is assessed: its key in JSON, its sentence, and its column in a comparison.
const LENGTH: Measure = Measure::new("shift_px", "Length of the displacement of the whole picture in px.")
    .in_column_as(Column { heading: "shift px", name: "shift_px", per: 1.0, digits: 2 });

impl Product for Shift {
    const KIND: &'static ProductKind = &ProductKind {
        id: "shift",
        name: "Shift",
        summary: "One displacement for the whole picture.",
        motion: Motion::Pixels,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&[LENGTH]],
    };

    fn table(&self) -> Option<Table> {
        let [u, v] = self.displacement.map(Cell::Single);
        Some(Table::new(["u_px", "v_px"], [[u, v]]))
    }

    fn assess(&self, _reference: &Reference<'_>) -> Result<Assessment, Error> {
        let [u, v] = self.displacement;
        let length = f64::from(u.hypot(v));
        let text = format!("{length:.2} px");
        Ok(Assessment {
            scores: vec![Score { measure: &LENGTH, value: length.into() }],
            facts: vec![Fact::new("Shift", text.clone(), None)],
            headline: text,
            ..Assessment::default()
        })
    }

    // With a flow comes everything that has to do with one: colours over the picture, streaklines, .flo files.
    fn flow(&self) -> Option<Flow> {
        Some(Flow(Grid::new(self.picture.0, self.picture.1, self.displacement)))
    }
}

fn main() {
    let output = Output::of(Shift { picture: (4, 3), displacement: [3.0, -4.0] });
    let shift = output.get::<Shift>().expect("it was put there");
    println!("{:?}, as a flow {:?}", shift.displacement, output.flow().and_then(|flow| flow.at(0, 0)));
}
