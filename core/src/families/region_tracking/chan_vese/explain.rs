//! The explanation and the drawing of the contour without edges.

use std::sync::Arc;

use super::{ChanVese, Energy, Event, Field, Iteration, Judged, LEAST_AREA_PX, Loss, Model, STILL, means};
use crate::base::words::further_digits_of_sum;
use crate::data::Mask;
use crate::geometry::Grid;
use crate::methods::contour::vocabulary::{AREA, value as shared};
use crate::methods::numbers::RATIO_DECIMALS;
use crate::methods::region::{At, Ending, Explained, Outcome};
use crate::scene::{Picture, Readout, Role, Scene, Series, Shape, Step, Surface, Tile, Unit};
use crate::{cases, variables};

/// The values of φ that a tile shows black and white, in px.
const RANGE_PX: f32 = 10.0;

variables! { pub(super) mod value;
    /// The gray level that is scaled to 0.
    DARKEST: "Darkest level", "", Unit::WHOLE;
    /// The gray level that is scaled to 1.
    BRIGHTEST: "Brightest level", "", Unit::WHOLE;
    /// The mean of the scaled gray levels inside.
    MEAN_INSIDE: "Mean inside c₁", "c_1", Unit::RATIO, Role::Best;
    /// The mean of the scaled gray levels outside.
    MEAN_OUTSIDE: "Mean outside c₂", "c_2", Unit::RATIO, Role::Window;
    /// The mean gray level inside.
    LEVEL_INSIDE: "Gray level inside", "", Unit::GRAY;
    /// The mean gray level outside.
    LEVEL_OUTSIDE: "Gray level outside", "", Unit::GRAY;
    /// The number of pixels that changed sides in the iteration.
    CHANGED: "Changed sides", "", Unit::count("pixel"), Role::Candidate;
    /// The weighted length of the contour.
    LENGTH_ENERGY: "Length energy", "", Unit::RATIO, Role::Predicted;
    /// The weighted area inside.
    AREA_ENERGY: "Area energy", "", Unit::RATIO, Role::Measured;
    /// The weighted squared differences from the mean inside.
    INSIDE_ENERGY: "Energy inside", "", Unit::RATIO, Role::Best;
    /// The weighted squared differences from the mean outside.
    OUTSIDE_ENERGY: "Energy outside", "", Unit::RATIO, Role::Window;
    /// The sum of the energies.
    ENERGY: "Energy", "F", Unit::RATIO, Role::Estimate;
    /// The number of iterations without a change after which the contour has converged.
    STILL: "Iterations without a change", "", Unit::count("iteration");
    /// The area of the other parts of the inside.
    OTHER_PARTS: "Other parts", "", AREA;
    /// The difference of the means inside and outside.
    CONTRAST: "Contrast", "|c_1 - c_2|", Unit::GRAY, Role::Measured;
    /// The contrast below which the object is lost.
    MIN_CONTRAST: "Smallest contrast", "", Unit::GRAY;
    /// The area of the object in the frame before.
    AREA_BEFORE: "Area before", "", AREA;
    /// The largest factor of a change of the area.
    MAX_GROWTH: "Largest growth", "", Unit::new("", 1);
}

cases! { pub(super) over value, shared;
    ALIKE: "the gray levels in the window around it differ by {gray_range} at most, less than {least_gray_range}, so there are no two regions with \
            different means.",
    STARTED: "{reference|The level set function φ} starts as the signed distance to the border of the object, positive inside, in a window of \
              {window_width}×{window_height}. Its gray levels from {darkest} to {brightest} are scaled to u = 0 to 1.",
    MEAN_INSIDE: "{mean_inside} (gray level {level_inside:bare})",
    MEAN_OUTSIDE: "{mean_outside} (gray level {level_outside:bare})",
    ITERATED: "Iteration {iteration}: the means are {best|c₁ =} {mean_inside} inside and {window|c₂ =} {mean_outside} outside, gray levels \
               {level_inside:bare} and {level_outside:bare}. φ rises where the gray level is nearer to c₁, falls where it is nearer to c₂, and \
               {changed} changed sides; the total energy is now {energy}.",
    CONVERGED: "None has for {still}: converged.",
    EXHAUSTED: "It has not converged, but this is the maximum number of iterations.",
    JUDGED: "{best|The largest connected part} of the inside has {area}",
    OTHERS_LEFT_OUT: ", and {other_parts} in other parts are left out",
    CONTRAST: ". The means differ by {contrast}",
    COLLAPSED: ", but the area is below {least_area}: the contour has collapsed.",
    FULL: ", and the inside fills the window: nothing is outside.",
    LOW_CONTRAST: ", less than {min_contrast:bare}: both regions look alike.",
    SPREAD: ", but the area was {area_before} in the frame before and changed by more than a factor of {max_growth}: the contour has spread or the \
             object is hidden.",
    ACCEPTED: ", not less than {min_contrast:bare}: the object is accepted.",
    HELD: "The means inside and outside held the contour: it needs no edges, and noise averages out. Anything as bright as the object that touches it \
           would become a part of it.",
    MERGED: "Something as bright as the object touched it and became a part of it. A correlation filter or mean shift is not attracted by gray levels \
             alone.",
    SHRUNK: "A part of the object is nearer to the mean outside than to the mean inside. An active contour works where edges separate regions of equal \
             mean.",
    ASTRAY: "Something as bright as the object touched it, or its surroundings came near its mean. A correlation filter or mean shift is not attracted \
             by gray levels alone.",
}

/// The energy of the partition.
const ENERGY: &str = r"F = \mu \text{ length} + \nu \text{ area} + \lambda_1 \sum_{\text{inside}} (u - c_1)^2 + \lambda_2 \sum_{\text{outside}} (u - c_2)^2";

impl Explained for ChanVese {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let add_charts = |step: Step, field, phi| {
            step.show(Readout::Tiles(tiles(field, phi))).show(Readout::Landscape(level_set(field, phi)))
        };
        match at.event {
            Event::Started(field, phi) => {
                let ((width, height), [low, high]) = (field.levels.size(), field.range);
                let step = put_means(step, field, means(phi, &field.levels)).put(value::DARKEST, low);
                let step = step.put(shared::WINDOW_WIDTH, width).put(shared::WINDOW_HEIGHT, height);
                add_charts(step.put(value::BRIGHTEST, high).say(case::STARTED).formula(ENERGY), field, phi)
            }
            Event::Iterated(iteration) => {
                let step = self.tell_iteration(step, iteration);
                add_charts(step, &iteration.field, &iteration.phi[1]).show(self.energies(at))
            }
            Event::Judged(judged) => {
                add_charts(self.tell_verdict(step, judged), &judged.field, &judged.phi).show(self.energies(at))
            }
        }
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
                scene.draw(
                    Picture::CURRENT,
                    (Role::Candidate, "pixel that changed sides"),
                    Shape::Points(moved(&iteration.field, before, after)),
                );
            }
            Event::Judged(judged) => {
                window(scene, &judged.field);
                let role = if judged.loss.is_some() { Role::Rejected } else { Role::Best };
                object(scene, role, judged.object.clone());
            }
        }
    }

    fn draw_result(&self, model: &Model, scene: &mut Scene) {
        if !model.result.is_lost {
            object(scene, Role::Best, model.object.unpacked());
        }
    }

    fn advise(&self, ending: Ending, _: &At<'_, Self>, step: Step) -> Step {
        step.say(match ending.outcome {
            Outcome::Followed => case::HELD,
            Outcome::Grown => case::MERGED,
            Outcome::Shrunk => case::SHRUNK,
            Outcome::Regained | Outcome::Beside | Outcome::Lost | Outcome::Unknown => case::ASTRAY,
        })
    }
}

impl ChanVese {
    fn tell_iteration(&self, step: Step, iteration: &Iteration) -> Step {
        let Energy { length, area, inside, outside } = iteration.energy;
        let parts = [
            (value::LENGTH_ENERGY, length),
            (value::INSIDE_ENERGY, inside),
            (value::OUTSIDE_ENERGY, outside),
            (value::AREA_ENERGY, area),
        ];
        let step = step.fact(shared::ITERATION, iteration.number);
        let step = put_means(step, &iteration.field, iteration.means).fact(value::CHANGED, iteration.changed);
        let has_area = |of| of != value::AREA_ENERGY || self.nu != 0.0;
        let step = parts.iter().fold(step, |step, (of, energy)| step.fact_if(of, has_area(*of).then_some(*energy)));
        let step = step.put(value::ENERGY, iteration.energy.total()).put(value::STILL, STILL).say(case::ITERATED);
        let is_exhausted = !iteration.is_still && iteration.number == self.iterations;
        let step = step.say_if(iteration.is_still, case::CONVERGED).say_if(is_exhausted, case::EXHAUSTED);
        let further = further_digits_of_sum(&[length, area, inside, outside], RATIO_DECIMALS);
        let unit = Unit::RATIO.finer(further as u8);
        let step = parts.iter().fold(step, |step, (of, energy)| step.put_value(of.is(*energy).in_unit(unit)));
        let numbers = "= {length_energy}{area_energy:signed}{inside_energy:signed}{outside_energy:signed} = {energy}";
        step.formula(ENERGY).formula(numbers)
    }

    fn tell_verdict(&self, step: Step, judged: &Judged) -> Step {
        let [own, all] = judged.area;
        let step =
            step.fact(shared::AREA, own).fact(value::CONTRAST, judged.contrast).put(value::OTHER_PARTS, all - own);
        let step = step.put(shared::LEAST_AREA, LEAST_AREA_PX).put(value::MIN_CONTRAST, self.min_contrast);
        let step = step.say(case::JUDGED).say_if(all > own, case::OTHERS_LEFT_OUT).say(case::CONTRAST);
        match judged.loss {
            None => step.say(case::ACCEPTED),
            Some(Loss::Collapsed) => step.say(case::COLLAPSED),
            Some(Loss::Full) => step.say(case::FULL),
            Some(Loss::Alike) => step.say(case::LOW_CONTRAST),
            Some(Loss::Spread(before)) => {
                step.put(value::AREA_BEFORE, before).put(value::MAX_GROWTH, self.max_growth).say(case::SPREAD)
            }
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
            events: all.iter().map(|(event, ..)| *event).collect(),
            ..Series::new("Energy of the partition", ["iteration", "energy"], self.iterations, lines)
        })
    }
}

/// φ over the picture, with the contour where it is 0.
fn level_set(field: &Field, phi: &Grid<f32>) -> Surface {
    let surface = Surface::over_pixels(("φ", "px"), (Picture::CURRENT, field.origin), phi);
    Surface { is_similarity: true, contour: Some(0.0), ..surface }
}

/// Puts the means inside and outside, and their gray levels.
fn put_means(step: Step, field: &Field, means: [f32; 2]) -> Step {
    let [inside, outside] = means.map(|mean| field.gray(mean));
    let step = step.put(value::LEVEL_INSIDE, inside).put(value::LEVEL_OUTSIDE, outside);
    let step = step.fact_as(value::MEAN_INSIDE.is(means[0]), case::MEAN_INSIDE);
    step.fact_as(value::MEAN_OUTSIDE.is(means[1]), case::MEAN_OUTSIDE)
}

fn tiles(field: &Field, phi: &Grid<f32>) -> Vec<Tile> {
    vec![
        Tile::new("gray levels u", field.levels.clone(), [0.0, 1.0]).with_role(Role::Window),
        Tile::new("level set φ", phi.clone(), [-RANGE_PX, RANGE_PX]).with_role(Role::Best),
    ]
}

fn window(scene: &mut Scene, field: &Field) {
    let ([x, y], (width, height)) = (field.origin.map(|c| c as i32), field.levels.size());
    scene.draw(Picture::CURRENT, (Role::Window, "window"), Shape::pixels(x, y, width, height));
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
    scene.draw(Picture::CURRENT, (Role::Best, "inside, φ ≥ 0"), Shape::Mask(Arc::new(mask)));
}

fn object(scene: &mut Scene, role: Role, mask: Mask) {
    scene.draw(Picture::CURRENT, (role, "object"), Shape::Mask(Arc::new(mask)));
}

/// The pixels that changed sides.
fn moved(field: &Field, before: &Grid<f32>, after: &Grid<f32>) -> Vec<[f32; 2]> {
    let (width, height) = before.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let is_moved = |place: &(usize, usize)| (before[*place] < 0.0) != (after[*place] < 0.0);
    let [left, top] = field.origin;
    places.filter(is_moved).map(|(x, y)| [(left + x) as f32, (top + y) as f32]).collect()
}
