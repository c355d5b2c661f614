//! The explanation and the drawing of CamShift.

use super::vocabulary::{case, value};
use super::{Background, Bins, Camshift, Event, Model, Resized, Shift};
use crate::base::words::further_digits;
use crate::data::Frame;
use crate::geometry::{Bounds, Grid};
use crate::methods::numbers::finer;
use crate::methods::region::color::Area;
use crate::methods::region::vocabulary::{case as shared, value as shared_value};
use crate::methods::region::{At, Ending, Explained, Outcome, plots};
use crate::scene::{Arrow, Picture, Readout, Role, Scene, Shape, Step, Surface};

/// The back-projection is drawn this far around the window, in px.
const AROUND_PX: f32 = 24.0;

/// The object fills an ellipse whose mean back-projection is at least this share of the first frame's.
const FILLED: f32 = 0.8;
/// Below this share of it the window is spread.
const SPREAD: f32 = 0.4;
/// An ellipse has grown if its area is at least this multiple of the first one's.
const GROWN: f32 = 2.0;
/// An object with a smaller share of the pixels of its hues does not stand out from its surroundings: where they have the hues as often,
/// it has 21 %.
const OWN: f32 = 0.4;

impl Explained for Camshift {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let step = match at.event {
            Event::Modelled(model) => self.tell_model(step, model).show(of_model(model)),
            Event::Projected(_, window) => {
                let [width, height] = window.size();
                let step = step.put(shared_value::WIDTH, width).put(shared_value::HEIGHT, height).say(case::PROJECTED);
                step.show_all(at.model.map(of_model))
            }
            Event::Shifted(_, shift) => self.tell_shift(step, shift),
            Event::Resized(_, resized) => self.tell_size(at, resized, step),
        };
        step.show_all(hills(at).map(Readout::Landscape))
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        let window = |scene: &mut Scene, Bounds { min, max }: Bounds, (role, meaning)| {
            scene.draw(Picture::CURRENT, (role, meaning), Shape::Rect { min, max });
        };
        let (frame, around) = match at.event {
            Event::Modelled(_) => return window(scene, at.region.bounds(), (Role::Window, "pixels of the histogram")),
            Event::Projected(frame, around) => (frame, *around),
            Event::Shifted(frame, shift) => (frame, shift.window),
            Event::Resized(frame, resized) => (frame, resized.window),
        };
        if let Some(model) = at.model {
            project(scene, (frame, model), around);
        }
        match at.event {
            Event::Shifted(_, shift) => {
                window(scene, shift.window, (Role::Window, "search window"));
                let shifts = at.events.iter().filter_map(|event| match event {
                    Event::Shifted(_, shift) => Some(shift),
                    _ => None,
                });
                let arrow = |shift: &Shift| {
                    let from = shift.window.center();
                    shift.by.map(|by| Arrow { from, to: [from[0] + by[0], from[1] + by[1]] })
                };
                let arrows: Vec<_> = shifts.filter_map(arrow).collect();
                if !arrows.is_empty() {
                    scene.draw(Picture::CURRENT, (Role::Predicted, "shifts"), Shape::Arrows(arrows));
                }
                if let Some(by) = shift.by {
                    window(scene, shift.window.moved(by), (Role::Best, "shifted window"));
                }
            }
            Event::Resized(_, resized) => {
                window(scene, resized.window, (Role::Window, "window with margin"));
                plots::ellipse(scene, (Role::Best, "ellipse of the moments"), resized.region);
            }
            _ => window(scene, around, (Role::Window, "search window")),
        }
    }

    fn tell_caveat(&self, at: &At<'_, Self>, step: Step) -> Step {
        let (Some(model), Event::Resized(_, resized)) = (at.model, at.event) else { return step };
        let (share, times) = (resized.share(model), resized.growth(model));
        let step = step.put(value::SHARE, 100.0 * share).put(value::TIMES, times);
        match () {
            () if share < SPREAD => step.say(case::SPREAD),
            () => step.say_if(times > GROWN, case::LARGER),
        }
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        match at.event {
            _ if at.model.is_some_and(is_empty) => step.say(case::LOST_MODEL),
            Event::Shifted(_, Shift { by: None, .. }) => step.say(case::LOST_HUES),
            _ => step,
        }
    }

    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step {
        step.say(match ending.outcome {
            _ if at.model.is_some_and(is_empty) => case::EMPTY_MODEL,
            Outcome::Followed => case::FOLLOWED,
            Outcome::Regained => case::REGAINED,
            Outcome::Grown => case::GROWN,
            Outcome::Shrunk => case::SHRUNK,
            Outcome::Beside | Outcome::Unknown => case::BESIDE,
            Outcome::Lost if ending.hidden > 0 => case::HIDDEN,
            Outcome::Lost => case::LOST,
        })
    }
}

impl Camshift {
    /// The model of the object.
    fn tell_model(&self, step: Step, model: &Model) -> Step {
        let step = plots::put_bins(step, &model.histogram).put(value::OWN, 100.0 * model.own).say(case::MODELLED);
        if is_empty(model) {
            return step.say(case::NO_HUE);
        }
        let step = step.say(match self.background {
            Background::Ignored => case::SCALED,
            Background::Weighted => case::WEIGHTED,
        });
        step.say_if(model.own < OWN, case::FEW_OWN).say_if(model.histogram.is_flat(), shared::FLAT)
    }

    fn tell_shift(&self, step: Step, shift: &Shift) -> Step {
        let step = step.fact(value::ITERATION, shift.iteration).fact(value::MASS, shift.mass);
        let formula = r"(x, y) = (\frac{M_{10}}{M_{00}}, \frac{M_{01}}{M_{00}})";
        let Some(by) = shift.by else { return step.say(case::NO_MASS).formula(formula) };
        let step = step.put(value::OFFSET, by).put(value::CENTROID, shift.window.moved(by).center());
        let step = step.put(value::SHIFT_LENGTH, shift.length()).put(value::EPSILON, self.epsilon);
        let step = step.put(value::ITERATIONS, self.iterations).say(case::SHIFTED);
        let step = step.say(if self.has_converged(shift) {
            case::CONVERGED
        } else if shift.iteration == self.iterations {
            case::EXHAUSTED
        } else {
            case::NOT_CONVERGED
        });
        step.formula(format!("{formula} = {{centroid:unit}}"))
    }

    fn tell_size(&self, at: &At<'_, Self>, resized: &Resized, step: Step) -> Step {
        let (Some(model), Resized { window, region, similarity, moments }) = (at.model, resized) else { return step };
        let (share, times) = (resized.share(model), resized.growth(model));
        let [along, across] = region.size;
        let step = step.put(value::MARGIN, self.margin).fact(value::FIRST_AXIS, along);
        let step = step.fact(value::SECOND_AXIS, across).fact(value::AXIS_ANGLE, region.angle_rad.to_degrees());
        let step = step
            .put(value::PROJECTION, *similarity)
            .put(value::FIRST_PROJECTION, model.first.1)
            .put(value::TIMES, times);
        let is_at_border = region.bounds().area() / window.area() > 0.9;
        let step = step.say(case::RESIZED).say(match () {
            () if share < SPREAD => case::SCATTERED,
            () if is_at_border => case::AT_BORDER,
            () if times > GROWN => case::FILLED_LARGER,
            () if share < FILLED => case::PARTLY_FILLED,
            () => case::FILLED,
        });
        let Some([xx, xy, yy]) = moments.covariance() else { return step };
        let terms = |further: usize| {
            let all = [(value::VARIANCE_X, xx), (value::VARIANCE_Y, yy), (value::COVARIANCE, xy)];
            all.map(|(of, number)| finer(of, number, further))
        };
        let further = further_digits(|further| {
            let [xx, yy, xy] = terms(*further).map(|term| term.rounded().unwrap_or(f64::NAN));
            let angle = (2.0 * xy).atan2(xx - yy) / 2.0;
            value::AXIS_ANGLE.is(angle.to_degrees()).rounded()
                == value::AXIS_ANGLE.is(region.angle_rad.to_degrees()).rounded()
        });
        let step = terms(0).into_iter().fold(step, Step::fact_of);
        let step = terms(further).into_iter().fold(step, Step::put_value);
        step.formula(r"\theta = \text{½ atan2}(2 \sigma_{xy}, \sigma_{xx} - \sigma_{yy})")
            .formula(r"\theta = \text{½ atan2}(2 \cdot {covariance}, {variance_x} - {variance_y}) = {axis_angle:unit}")
    }
}

impl Resized {
    /// The mean back-projection as a share of that in the first frame.
    fn share(&self, model: &Model) -> f32 {
        self.similarity / model.first.1
    }

    /// The area of the ellipse as a multiple of that in the first frame.
    fn growth(&self, model: &Model) -> f32 {
        let [now, first] = [self.region, model.first.0].map(|region| region.size[0] * region.size[1]);
        now / first
    }
}

/// Whether no pixel of the region has a hue.
fn is_empty(model: &Model) -> bool {
    model.histogram.support.is_empty()
}

/// The model over the bins.
fn of_model(model: &Model) -> Readout {
    let lines = vec![("model q", Role::Reference, plots::bars(model.projection.iter().copied()))];
    let axis = if model.histogram.binning.name() == "hue" { "bin of hue" } else { "bin of gray levels" };
    Readout::Series(plots::histograms("Histogram of the object", [axis, "q"], lines))
}

/// The back-projection around the first window of the frame, with the path of the window's centre.
fn hills(at: &At<'_, Camshift>) -> Option<Surface> {
    let (frame, window) = at.events.iter().find_map(|event| match event {
        Event::Projected(frame, window) => Some((frame, *window)),
        _ => None,
    })?;
    let (origin, values) = projection((frame, at.model?), window)?;
    let shifts = at.events.iter().filter_map(|event| match event {
        Event::Shifted(_, shift) => Some(shift.window.moved(shift.by?).center()),
        _ => None,
    });
    let surface = Surface::over_pixels(("back-projection", ""), (Picture::CURRENT, origin), &values);
    Some(Surface { is_similarity: true, ..surface.with_trail([window.center()].into_iter().chain(shifts)) })
}

/// The back-projection around a window, with its first pixel; `None` outside the picture.
fn projection((frame, model): (&Frame, &Model), window: Bounds) -> Option<([usize; 2], Grid<f32>)> {
    let wide = Bounds { min: window.min.map(|c| c - AROUND_PX), max: window.max.map(|c| c + AROUND_PX) };
    let Area { from, to } = Area::within(wide, frame.size());
    let mut bins = Bins::new(frame, model.histogram.binning);
    bins.cover(wide);
    let size = [0, 1].map(|i| to[i] - from[i]);
    let value = |x, y| bins.at(from[0] + x, from[1] + y).map_or(0.0, |bin| model.projection[usize::from(bin)]);
    (!size.contains(&0)).then(|| (from, Grid::from_fn(size[0], size[1], value)))
}

/// Draws the back-projection around a window as a heat map.
fn project(scene: &mut Scene, seen: (&Frame, &Model), window: Bounds) {
    let Some((origin, values)) = projection(seen, window) else { return };
    scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: origin.map(|c| c as f32), values });
    scene.heat = Some("back-projection");
    scene.heat_scale = Some([0.0, 1.0]);
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::methods::region::RegionModel as _;
    use crate::products::Region;

    /// A red disc on gray, with its centre here.
    fn frame(center: [f32; 2]) -> Arc<Frame> {
        let is_red = |x: usize, y: usize| (x as f32 - center[0]).hypot(y as f32 - center[1]) < 8.0;
        let color = |x, y| if is_red(x, y) { [220, 30, 20] } else { [90 + (x % 7) as u8; 3] };
        Arc::new(Frame::rgb(Grid::from_fn(70, 60, color)))
    }

    #[test]
    fn the_hills_are_the_back_projection_and_the_window_climbs_them() {
        let (tracker, seen) = (Camshift::default(), frame([36.0, 30.0]));
        let region = Region { center: [30.0, 27.0], size: [18.0, 18.0], angle_rad: 0.0 };
        let (mut model, _) = tracker.begin(&frame(region.center), region, &mut ());
        let (before, mut events) = (model.clone(), Vec::<Event>::new());
        let found = tracker.follow(&mut model, &seen, region, &mut events);
        let all: Vec<_> = events.iter().collect();
        let event = *all.last().expect("events");
        let at = At { model: Some(&before), region, events: all, event, pose: None, poses: Box::new(|_| None) };
        let surface = hills(&at).expect("inside the picture");
        let mut bins = Bins::new(&seen, before.histogram.binning);
        bins.cover(Bounds { min: [0.0; 2], max: [70.0, 60.0] });
        let (width, height) = surface.values.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let place = surface.axes.at([0, 1].map(|i| [x, y][i] as f32 + surface.origin[i] as f32));
            let bin = bins.at(place[0] as usize, place[1] as usize);
            let expected = bin.map_or(0.0, |bin| before.projection[usize::from(bin)]);
            assert_eq!(surface.values[(x, y)], expected, "at {place:?}");
        }
        let [first, .., last] = surface.trail[..] else { panic!("no shifts: {:?}", surface.trail) };
        let [first, last] = [first, last].map(|at| surface.axes.at(at));
        let off = |at: [f32; 2]| (at[0] - 36.0).hypot(at[1] - 30.0);
        assert!(off(first) > 6.0 && off(last) < 1.0, "{first:?} to {last:?}");
        assert!(off(found.region.center) < 1.0, "{:?}", found.region);
    }
}
