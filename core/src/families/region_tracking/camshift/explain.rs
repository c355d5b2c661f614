//! The explanation and the drawing of CamShift.

use super::{Background, Bins, Camshift, Event, Model, Resized, Shift};
use crate::base::words::{counted, fixed, grouped, place};
use crate::data::Frame;
use crate::geometry::{Bounds, Grid};
use crate::methods::numbers::{px, ratio};
use crate::methods::region::color::Area;
use crate::methods::region::{At, Ending, Explained, Outcome, plots};
use crate::products::Region;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Role, Scene, Sentence, Shape, Surface};

/// The back-projection is drawn this far around the window, in px.
const AROUND_PX: f32 = 24.0;

/// An ellipse is filled by the object from this share of the mean back-projection of the first frame on.
const FILLED: f32 = 0.8;
/// Below this share of it the window is spread.
const SPREAD: f32 = 0.4;
/// An ellipse of so many times the area of the first one has grown.
const GROWN: f32 = 2.0;
/// An object with a smaller share of the pixels of its hues does not stand out from its surroundings: where they have the hues as often,
/// it has 21 %.
const OWN: f32 = 0.4;

fn degrees(angle_rad: f32) -> String {
    format!("{}°", fixed(angle_rad.to_degrees().into(), 1))
}

fn size([width, height]: [f32; 2]) -> String {
    format!("{}×{} px", px(width.into()), px(height.into()))
}

impl Explained for Camshift {
    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Modelled(model) => self.modelled(model, said),
            Event::Projected(_, window) => said
                .text("Back-projection: each pixel takes the value of its bin in the ")
                .ink(Role::Reference, "model q")
                .text(format!(
                    ", 1 for the commonest hue of the object. The search starts in the last window, {}.",
                    size(window.size())
                )),
            Event::Shifted(_, shift) => self.shifted(shift, said),
            Event::Resized(_, resized) => self.resized(at, resized, said),
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Shifted(_, shift) => vec![
                Fact::new("Shift", shift.iteration.to_string(), None),
                Fact::new("Zeroth moment M₀₀", fixed(shift.mass, 1), None),
            ],
            Event::Resized(_, resized) => {
                let [xx, xy, yy] = resized.moments.covariance().unwrap_or_default();
                vec![
                    Fact::new("Axes", size(resized.region.size), Some(Role::Best)),
                    Fact::new("Angle", degrees(resized.region.angle_rad), None),
                    Fact::new("Variances along x, y", format!("{}, {} px²", fixed(xx, 1), fixed(yy, 1)), None),
                    Fact::new("Covariance", format!("{} px²", fixed(xy, 1)), None),
                ]
            }
            Event::Modelled(_) | Event::Projected(..) => Vec::new(),
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        let moment = |index: &str| Math::indexed(Math::Var("M"), Math::text(index));
        let ratio_of = |over: &str| Math::over(moment(over), moment("00"));
        let mut readouts = match at.event {
            Event::Modelled(model) => vec![of_model(model)],
            Event::Projected(..) => at.model.map(of_model).into_iter().collect(),
            Event::Shifted(_, shift) => {
                let center = shift.by.map(|by| [0, 1].map(|i| shift.window.center()[i] + by[i]));
                let mut parts = vec![
                    Math::text("("),
                    Math::Var("x"),
                    Math::text(", "),
                    Math::Var("y"),
                    Math::text(") = ("),
                    ratio_of("10"),
                    Math::text(", "),
                    ratio_of("01"),
                    Math::text(")"),
                ];
                parts.extend(center.map(|at| Math::ink(Role::Best, format!(" = {} px", place(at)))));
                vec![Readout::Equation(vec![Math::Row(parts)])]
            }
            Event::Resized(_, resized) => {
                let [xx, xy, yy] = resized.moments.covariance().unwrap_or_default();
                let moment = |index| Math::indexed(Math::Var("σ"), Math::Var(index));
                let formula = Math::Row(vec![
                    Math::text("θ"),
                    Math::text(" = "),
                    Math::text("½ atan2(2 "),
                    moment("xy"),
                    Math::text(", "),
                    moment("xx"),
                    Math::text(" − "),
                    moment("yy"),
                    Math::text(")"),
                ]);
                let numbers = Math::Row(vec![
                    Math::text("= "),
                    Math::text(format!("½ atan2({}, {})", fixed(2.0 * xy, 1), fixed(xx - yy, 1))),
                    Math::text(" = "),
                    Math::ink(Role::Best, degrees(resized.region.angle_rad)),
                ]);
                vec![Readout::Equation(vec![formula, numbers])]
            }
        };
        readouts.extend(hills(at).map(Readout::Landscape));
        readouts
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        let window = |scene: &mut Scene, Bounds { min, max }: Bounds, (role, meaning)| {
            scene.mark(Picture::CURRENT, role, Shape::Rect { min, max });
            scene.legend(role, meaning);
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
                    scene.mark(Picture::CURRENT, Role::Predicted, Shape::Arrows(arrows));
                    scene.legend(Role::Predicted, "shifts");
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

    fn caveat(&self, at: &At<'_, Self>) -> Option<String> {
        let (model, Event::Resized(_, resized)) = (at.model?, at.event) else { return None };
        let (started, first) = model.first;
        let area = |region: &Region| region.size[0] * region.size[1];
        let times = f64::from(area(&resized.region) / area(&started));
        let share = 100.0 * f64::from(resized.similarity / first);
        if resized.similarity < SPREAD * first {
            return Some(format!(
                "The mean back-projection is {} % of that in the first frame: the window has spread over scattered pixels and no longer shows \
                 where the object is.",
                fixed(share, 0)
            ));
        }
        (times > f64::from(GROWN)).then(|| {
            format!(
                "The ellipse has {} times the area of the first one: the object has come nearer, or the window has spread over a background of \
                 like hue. The hue cannot tell these apart.",
                fixed(times, 1)
            )
        })
    }

    fn loss(&self, at: &At<'_, Self>) -> Option<String> {
        match at.event {
            _ if at.model.is_some_and(is_empty) => Some("the model has no hue".into()),
            Event::Shifted(_, Shift { by: None, .. }) => Some("no pixel of the window has a hue of the object".into()),
            _ => None,
        }
    }

    fn advice(&self, ending: Ending, at: &At<'_, Self>) -> String {
        if at.model.is_some_and(is_empty) {
            return "The model is empty, because no pixel of the region is saturated and bright enough to have a hue. Lower the minimum \
                    saturation or value, or place the region on a coloured object."
                .into();
        }
        match ending.outcome {
            Outcome::Followed => {
                "The hue of the object stood out. Every pixel with the hue counts, wherever it is, so on a background of like hue the window \
                 would grow over it."
            }
            Outcome::Regained => {
                "The window left the object and met it again. CamShift predicts no velocity, so it finds only what comes back into the window."
            }
            Outcome::Grown => {
                "The window spread over a background of like hue, because every pixel with the hue counts, wherever it is. Mean shift compares \
                 shares of all colours, and a correlation filter knows the pattern."
            }
            Outcome::Shrunk => "The window shrank to the part of the object that has the hues of the model.",
            Outcome::Beside | Outcome::Unknown => {
                "The window holds a part of the object only: the moments follow all pixels with its hue, those of the background too."
            }
            Outcome::Lost if ending.hidden > 0 => {
                return format!(
                    "The object was hidden in {}, and the window has no velocity that carries it on, unlike the particles of a particle filter.",
                    counted(ending.hidden, "frame")
                );
            }
            Outcome::Lost => {
                "Pixels of like hue beside the object, or an occlusion, took the window away, or the object left it between two frames. Fewer \
                 colours of the background in the region, a higher minimum saturation, or mean shift with a background-weighted histogram help."
            }
        }
        .into()
    }
}

impl Camshift {
    fn shifted(&self, shift: &Shift, said: Sentence) -> Sentence {
        let Some(by) = shift.by else {
            return said
                .text("The zeroth moment is 0: no pixel of the window has a hue of the object, so the window stays.");
        };
        let said = said
            .text(format!("The window has a zeroth moment of {}. Its centroid lies ", fixed(shift.mass, 1)))
            .ink(Role::Best, format!("{} px", place(by)))
            .text(format!(" off the middle, a shift of {} px: ", px(shift.length().into())));
        let epsilon = px(self.epsilon.into());
        if shift.length() < self.epsilon {
            said.text(format!("shorter than ε = {epsilon} px, converged."))
        } else if shift.iteration == self.iterations {
            said.text(format!("the limit of {} shifts is reached.", self.iterations))
        } else {
            said.text(format!(
                "not shorter than ε = {epsilon} px, so the window moves and the moments are computed anew."
            ))
        }
    }

    fn resized(&self, at: &At<'_, Self>, resized: &Resized, said: Sentence) -> Sentence {
        let Resized { window, region, similarity, .. } = resized;
        let (started, first) = at.model.map_or((at.region, 0.0), |model| model.first);
        let said = said
            .text(format!("The second moments in the window with its margin of {} px give an ellipse of ", self.margin))
            .ink(Role::Best, size(region.size))
            .text(format!(
                " turned by {}. Its mean back-projection is {}, {} in the first frame: ",
                degrees(region.angle_rad),
                ratio((*similarity).into()),
                ratio(first.into())
            ));
        let grown = region.bounds().area() / window.area();
        let area = |region: &Region| region.size[0] * region.size[1];
        let times = area(region) / area(&started);
        if *similarity >= SPREAD * first && grown <= 0.9 && times > GROWN {
            return said.text(format!(
                "the hues of the object fill an ellipse of {} times the area of that in the first frame. Unless the object has come nearer, \
                 it holds more than the object.",
                fixed(times.into(), 1)
            ));
        }
        said.text(if *similarity < SPREAD * first {
            "most pixels inside have another hue, so the window is spread over scattered pixels."
        } else if grown > 0.9 {
            "the hue reaches to the border of the window, which will grow further."
        } else if *similarity < FILLED * first {
            "a part of the ellipse has another hue. The window of the next frame is the box around it."
        } else {
            "the hues of the object fill the ellipse. The window of the next frame is the box around it."
        })
    }

    /// The model of the object.
    fn modelled(&self, model: &Model, said: Sentence) -> Sentence {
        let filled = model.histogram.support.len();
        let said = said.text("The ").ink(Role::Reference, "model q").text(format!(
            " is the {} histogram of the ellipse in the region: {} of {} bins are filled",
            model.histogram.binning.name(),
            grouped(filled),
            grouped(model.projection.len())
        ));
        if filled == 0 {
            said.text(
            ". No pixel is saturated and bright enough to have a hue, so nothing can be found; lower the minimum saturation or value.",
        )
        } else {
            let said = said.text(match self.background {
            Background::Ignored => ", and the fullest is scaled to 1.",
            Background::Weighted => {
                ". Each is multiplied by the share of its pixels, in the object and around it, that lie in the object, and the fullest is scaled \
                 to 1."
            }
        });
            let share = fixed(100.0 * f64::from(model.own), 0);
            let said = match model.own < OWN {
            true => said.text(format!(
                " Only {share} % of the pixels with these hues lie in the object: its surroundings have them too, so the window may spread."
            )),
            false => said,
        };
            plots::warned(said, &model.histogram)
        }
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
