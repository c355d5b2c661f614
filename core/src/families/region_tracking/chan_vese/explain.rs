//! The explanation and the drawing of the contour without edges.

use std::sync::Arc;

use super::{ChanVese, Energy, Event, Field, Iteration, Judged, LEAST_AREA_PX, Model, STILL};
use crate::base::words::{counted, fixed, grouped, summands};
use crate::data::Mask;
use crate::geometry::Grid;
use crate::methods::contour::explain::area;
use crate::methods::numbers::{RATIO_DECIMALS, gray, ratio};
use crate::methods::region::{At, Ending, Explained, Outcome};
use crate::scene::{Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Surface, Tile};

/// The values of φ that a tile shows black and white, in px.
const RANGE_PX: f32 = 10.0;

impl Explained for ChanVese {
    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Started(field, _) => {
                let (width, height) = field.levels.size();
                said.ink(Role::Reference, "The level set function φ").text(format!(
                    " starts as the signed distance to the border of the object, positive inside, in a window of {width}×{height} px. Its \
                     gray levels from {} to {} are scaled to u = 0 to 1.",
                    field.range[0], field.range[1]
                ))
            }
            Event::Iterated(iteration) => self.iterated(iteration, said),
            Event::Judged(judged) => self.judged(judged, said),
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Started(field, phi) => means_facts(field, super::means(phi, &field.levels)).into(),
            Event::Iterated(iteration) => {
                let Energy { length, area, inside, outside } = iteration.energy;
                let mut facts = vec![Fact::new("Iteration", iteration.number.to_string(), None)];
                facts.extend(means_facts(&iteration.field, iteration.means));
                facts.extend([
                    Fact::new("Pixels that changed sides", grouped(iteration.changed), Some(Role::Candidate)),
                    Fact::new("Length energy", ratio(length), Some(Role::Predicted)),
                    Fact::new("Energy inside", ratio(inside), Some(Role::Best)),
                    Fact::new("Energy outside", ratio(outside), Some(Role::Window)),
                ]);
                facts.extend((self.nu != 0.0).then(|| Fact::new("Area energy", ratio(area), Some(Role::Measured))));
                facts
            }
            Event::Judged(judged) => vec![
                Fact::new("Area", area(judged.area[0] as f64), None),
                Fact::new("Contrast", format!("{} gray levels", gray(judged.contrast)), Some(Role::Measured)),
            ],
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        let formula = || Readout::Equation(vec![formula_of_energy()]);
        let (field, phi, around) = match at.event {
            Event::Started(field, phi) => (field, phi, [Some(formula()), None]),
            Event::Iterated(iteration) => {
                let equation = Readout::Equation(vec![formula_of_energy(), numbers(&iteration.energy)]);
                (&iteration.field, &iteration.phi[1], [Some(equation), Some(self.energies(at))])
            }
            Event::Judged(judged) => (&judged.field, &judged.phi, [None, Some(self.energies(at))]),
        };
        let [equation, energies] = around;
        let levels = [Readout::Tiles(tiles(field, phi)), Readout::Landscape(level_set(field, phi))];
        equation.into_iter().chain(levels).chain(energies).collect()
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        match at.event {
            Event::Started(field, phi) => {
                window(scene, field);
                inside(scene, (field, phi));
            }
            Event::Iterated(iteration) => {
                window(scene, &iteration.field);
                let [before, after] = &iteration.phi;
                inside(scene, (&iteration.field, after));
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Points(moved(&iteration.field, before, after)));
                scene.legend(Role::Candidate, "pixel that changed sides");
            }
            Event::Judged(judged) => {
                window(scene, &judged.field);
                let role = if judged.is_lost { Role::Rejected } else { Role::Best };
                object(scene, role, judged.object.clone());
            }
        }
    }

    fn draw_result(&self, model: &Model, scene: &mut Scene) {
        if !model.result.is_lost {
            object(scene, Role::Best, model.object.unpacked());
        }
    }

    fn advice(&self, ending: Ending, _at: &At<'_, Self>) -> String {
        match ending.outcome {
            Outcome::Followed => {
                "The means inside and outside held the contour: it needs no edges, and noise averages out. Anything as bright as the \
                 object that touches it would become a part of it."
            }
            Outcome::Grown => {
                "Something as bright as the object touched it and became a part of it. A correlation \
                 filter or mean shift is not attracted by gray levels alone."
            }
            Outcome::Shrunk => {
                "A part of the object is nearer to the mean outside than to the mean inside. An active contour works where \
                 edges separate regions of equal mean."
            }
            Outcome::Unknown => {
                "Without ground truth it is not known whether the contour is on the object. Anything as bright as the object that touches \
                 it becomes a part of it."
            }
            Outcome::Regained | Outcome::Beside | Outcome::Lost => {
                "Something as bright as the object touched it, or its surroundings came near its mean. A correlation filter or mean shift is not \
                 attracted by gray levels alone."
            }
        }
        .into()
    }
}

impl ChanVese {
    fn iterated(&self, iteration: &Iteration, said: Sentence) -> Sentence {
        let [inside, outside] = iteration.means.map(ratio_of);
        let [inside_gray, outside_gray] = iteration.means.map(|mean| gray(iteration.field.gray(mean)));
        let said = said
            .text(format!("Iteration {}: the means are ", iteration.number))
            .ink(Role::Best, format!("c₁ = {inside}"))
            .text(" inside and ")
            .ink(Role::Window, format!("c₂ = {outside}"))
            .text(format!(" outside, gray levels {inside_gray} and {outside_gray}"))
            .text(". φ rises where the gray level is nearer to c₁, falls where it is nearer to c₂, and ")
            .ink(Role::Candidate, counted(iteration.changed, "pixel"))
            .text(format!(" changed sides; the total energy is now {}.", ratio(iteration.energy.total())));
        if iteration.is_still {
            said.text(format!(" None has for {STILL} iterations: converged."))
        } else if iteration.number == self.iterations {
            said.text(" It has not converged, but this is the maximum number of iterations.")
        } else {
            said
        }
    }

    fn judged(&self, judged: &Judged, said: Sentence) -> Sentence {
        let [own, all] = judged.area;
        let said = said
            .ink(Role::Best, "The largest connected part")
            .text(format!(" of the inside has {}", area(own as f64)))
            .text(match all - own {
                0 => String::new(),
                rest => format!(", and {} in other parts are left out", area(rest as f64)),
            })
            .text(". The means differ by ")
            .ink(Role::Measured, format!("{} gray levels", gray(judged.contrast)));
        let growth = format!("factor of {}", fixed(self.max_growth.into(), 1));
        if (own as f64) < LEAST_AREA_PX {
            said.text(format!(", but the area is below {}: the contour has collapsed.", area(LEAST_AREA_PX)))
        } else if all == judged.phi.cells().len() {
            said.text(", and the inside fills the window: nothing is outside.")
        } else if judged.contrast < self.min_contrast {
            said.text(format!(", less than {}: both regions look alike.", gray(self.min_contrast)))
        } else if let Some(before) = judged.before.filter(|_| judged.is_lost) {
            said.text(format!(
                ", but the area was {} in the frame before and changed by more than a {growth}: the contour has spread or the object is \
                 hidden.",
                area(before as f64)
            ))
        } else {
            said.text(format!(", not less than {}: the object is accepted.", gray(self.min_contrast)))
        }
    }

    /// The energies over the iterations of the frame.
    fn energies(&self, at: &At<'_, Self>) -> Readout {
        // In the first frame its region was chosen before.
        let first = if at.model.is_none() { 2 } else { 1 };
        let of = |(i, event): (usize, &&Event)| match event {
            Event::Iterated(iteration) => Some((first + i, iteration.number, iteration.energy)),
            _ => None,
        };
        let all: Vec<_> = at.events.iter().enumerate().filter_map(of).collect();
        let line = |name, role, of: fn(&Energy) -> f64| {
            (name, role, all.iter().map(|(_, number, energy)| [*number as f32, of(energy) as f32]).collect())
        };
        let mut lines = vec![
            line("total", Role::Estimate, Energy::total),
            line("length", Role::Predicted, |energy| energy.length),
            line("inside", Role::Best, |energy| energy.inside),
            line("outside", Role::Window, |energy| energy.outside),
        ];
        lines.extend((self.nu != 0.0).then(|| line("area", Role::Measured, |energy| energy.area)));
        Readout::Series(Series {
            title: "Energy of the partition",
            x_label: "iteration",
            y_label: "energy",
            x_max: self.iterations,
            events: all.iter().map(|(event, ..)| *event).collect(),
            lines,
            ..Series::default()
        })
    }
}

/// φ over the picture, with the contour where it is 0.
fn level_set(field: &Field, phi: &Grid<f32>) -> Surface {
    let surface = Surface::over_pixels(("φ", "px"), (Picture::CURRENT, field.origin), phi);
    Surface { is_similarity: true, contour: Some(0.0), ..surface }
}

/// A scaled gray level as text.
fn ratio_of(level: f32) -> String {
    ratio(level.into())
}

fn means_facts(field: &Field, means: [f32; 2]) -> [Fact; 2] {
    let [inside, outside] = means.map(|mean| format!("{} (gray level {})", ratio_of(mean), gray(field.gray(mean))));
    [Fact::new("Mean inside c₁", inside, Some(Role::Best)), Fact::new("Mean outside c₂", outside, Some(Role::Window))]
}

/// F = μ length + ν area + λ₁ Σ inside (u − c₁)² + λ₂ Σ outside (u − c₂)².
fn formula_of_energy() -> Math {
    let sum = |of: &str| Math::Sum(Box::new(Math::text(of)));
    let square = |mean: &str| Math::squared(Math::text(format!("(u − {mean})")));
    Math::Row(vec![
        Math::Var("F"),
        Math::text(" = μ length + ν area + λ₁ "),
        sum("inside"),
        square("c₁"),
        Math::text(" + λ₂ "),
        sum("outside"),
        square("c₂"),
    ])
}

/// The energies of an iteration in that formula.
fn numbers(of: &Energy) -> Math {
    let [length, area, inside, outside] = summands([of.length, of.area, of.inside, of.outside], RATIO_DECIMALS);
    Math::Row(vec![
        Math::text("= "),
        Math::ink(Role::Predicted, length),
        Math::ink(Role::Measured, area),
        Math::ink(Role::Best, inside),
        Math::ink(Role::Window, outside),
        Math::text(" = "),
        Math::ink(Role::Estimate, ratio(of.total())),
    ])
}

fn tiles(field: &Field, phi: &Grid<f32>) -> Vec<Tile> {
    let tile = |label, role, values: &Grid<f32>, range| Tile {
        label,
        role,
        values: values.clone(),
        range,
        framed: Vec::new(),
    };
    vec![
        tile("gray levels u", Some(Role::Window), &field.levels, [0.0, 1.0]),
        tile("level set φ", Some(Role::Best), phi, [-RANGE_PX, RANGE_PX]),
    ]
}

/// Draws the window.
fn window(scene: &mut Scene, field: &Field) {
    let ([x, y], (width, height)) = (field.origin.map(|c| c as i32), field.levels.size());
    scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x, y, width, height));
    scene.legend(Role::Window, "window");
}

/// Draws the pixels of the window with φ ≥ 0.
fn inside(scene: &mut Scene, (field, phi): (&Field, &Grid<f32>)) {
    let [left, top] = field.origin;
    let (width, height) = phi.size();
    let is_inside = |x: usize, y: usize| {
        let at = (x.checked_sub(left)?, y.checked_sub(top)?);
        phi.get(at.0, at.1).map(|phi| *phi >= 0.0)
    };
    let mask = Mask::from_fn(left + width, top + height, |x, y| is_inside(x, y).unwrap_or(false));
    scene.mark(Picture::CURRENT, Role::Best, Shape::Mask(Arc::new(mask)));
    scene.legend(Role::Best, "inside, φ ≥ 0");
}

/// Draws the object.
fn object(scene: &mut Scene, role: Role, mask: Mask) {
    scene.mark(Picture::CURRENT, role, Shape::Mask(Arc::new(mask)));
    scene.legend(role, "object");
}

/// The pixels that changed sides.
fn moved(field: &Field, before: &Grid<f32>, after: &Grid<f32>) -> Vec<[f32; 2]> {
    let (width, height) = before.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let is_moved = |place: &(usize, usize)| (before[*place] < 0.0) != (after[*place] < 0.0);
    let [left, top] = field.origin;
    places.filter(is_moved).map(|(x, y)| [(left + x) as f32, (top + y) as f32]).collect()
}
