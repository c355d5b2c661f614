//! How corner detection is told and drawn.

use super::corners::{Corners, Event, Measure, Stage, State};
use super::declare::line;
use super::select::{Peaks, Settings};
use crate::base::words::{self, pixel};
use crate::geometry::Grid;
use crate::methods::differential::{Tensor, explain};
use crate::run::Seen;
use crate::scene::{Fact, Math, Name, Picture, Readout, Role, Scene, Sentence, Shape, Step, Tile};

fn point((x, y): (usize, usize)) -> [f32; 2] {
    [x as f32, y as f32]
}

/// The pixel that is explained and what is known of it.
struct Looked {
    place: (usize, usize),
    /// Whether it is not the pixel at work but the one pointed at.
    is_pointed_at: bool,
    tensor: Tensor,
    response: f32,
}

impl<M: Measure> Corners<M> {
    /// The pixel pointed at, or else the one at work.
    fn look(&self, seen: &Seen<Self>) -> Option<Looked> {
        let state = seen.before;
        let at_work = match seen.events.last()? {
            Event::Response(_) => (seen.events.len() - 1, state.row),
            Event::Row => (0, state.row),
            Event::Over(place, _) => *place,
            Event::Ranked => state.strongest()?,
            Event::Peak(peak, _) => state.place(*peak),
        };
        let place = seen.point().and_then(|point| state.map.cell_at(point)).unwrap_or(at_work);
        let is_pointed_at = place != at_work;
        let tensor = self.tensors(state).at(place);
        Some(Looked { place, is_pointed_at, tensor, response: self.0.response([tensor.xx, tensor.xy, tensor.yy]) })
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else {
            let sentence = "A place can be found again if gradients around it point in several directions. How much of a \
                            corner each pixel is, its structure tensor tells.";
            return Step {
                line: line::TAKE_DERIVATIVES,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let at_work = match last {
            Event::Response(_) => line::RESPOND,
            Event::Row => line::EACH_STRONG,
            Event::Over(..) => line::SUPPRESS,
            Event::Ranked => line::EACH_PEAK,
            Event::Peak(_, Some(_)) => line::DROP_NEAR,
            Event::Peak(_, None) => line::KEEP,
        };
        let looked = self.look(seen);
        // Words, numbers and the line speak of one pixel.
        let (line, sentence) = match &looked {
            Some(looked) if looked.is_pointed_at && seen.before.stage == Stage::Response => {
                (line::RESPOND, responds(looked))
            }
            Some(looked) if looked.is_pointed_at => {
                let (line, verdict) = self.verdict(seen, looked);
                (line, responds(looked).text(format!(" So far: {verdict}.")))
            }
            looked => (at_work, self.sentence(seen, *last, looked.as_ref())),
        };
        let readouts = looked.map_or_else(
            || vec![Readout::Facts(vec![Fact { label: "Peaks", value: "none".into(), role: None }])],
            |looked| self.readouts(seen, &looked),
        );
        Step { line, sentence, readouts }
    }

    fn sentence(&self, seen: &Seen<Self>, event: Event, looked: Option<&Looked>) -> Sentence {
        let (state, peaks, said) = (seen.before, self.peaks(seen.before), Sentence::default());
        let Settings { threshold, max_points, min_distance, .. } = self.0.settings();
        match event {
            Event::Response(_) => match looked {
                Some(looked) => responds(looked),
                None => said.text("The response of each pixel follows from its structure tensor."),
            },
            Event::Row if peaks.over(state.row).next().is_none() => said.text(format!(
                "No pixel of row {} can be a peak: {}.",
                state.row,
                match state.row == 0 || state.row + 1 == state.map.height() {
                    true => "at the border, neighbours are missing".to_owned(),
                    false => format!(
                        "each response is below {}, which is {} % of the largest",
                        words::number(peaks.limit),
                        words::number(100.0 * threshold)
                    ),
                }
            )),
            Event::Row => said.text(format!(
                "The largest response is {}. Pixels of row {} that reach {} % of it, {}: {}. Each is a corner only if it is a peak.",
                words::number(state.largest),
                state.row,
                words::number(100.0 * threshold),
                words::number(peaks.limit),
                peaks.over(state.row).count()
            )),
            Event::Over(place, by) => over(&peaks, place, by),
            Event::Ranked if state.peaks.is_empty() => said.text("There is no peak, and so no corner."),
            Event::Ranked => said.text(format!(
                "The peaks, {} in all, are put in order of strength. At most {max_points} are kept, each at least {min_distance} px \
                 from those before.",
                state.peaks.len()
            )),
            Event::Peak(peak, near) => self.chosen(seen, peak, near),
        }
    }

    /// What becomes of a peak.
    fn chosen(&self, seen: &Seen<Self>, peak: u32, near: Option<u32>) -> Sentence {
        let state = seen.before;
        let response = |peak: u32| state.map[state.place(peak)];
        let with = format!(" with {}", words::number(response(peak)));
        let said = Sentence::default().text("Peak ");
        let Some(near) = near else {
            let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
            return said.ink(Role::Result, pixel(state.place(peak))).text(format!("{with} is kept: corner {count}."));
        };
        let why = if response(near) > response(peak) { "is stronger" } else { "is as strong and comes first" };
        said.ink(Role::Rejected, pixel(state.place(peak)))
            .text(format!("{with} is nearer than {} px to ", self.0.settings().min_distance))
            .ink(Role::Result, pixel(state.place(near)))
            .text(format!(", which {why}: dropped."))
    }

    fn readouts(&self, seen: &Seen<Self>, looked: &Looked) -> Vec<Readout> {
        let (state, Looked { place, tensor, response, .. }) = (seen.before, looked);
        let fact = |label, value: String, role| Fact { label, value, role };
        let [large, small] = tensor.eigenvalues().map(words::number);
        let Tensor { xx, xy, yy, .. } = *tensor;
        let [a, b, c] = [xx, xy, yy].map(words::number);
        let mut facts = vec![
            fact("Pixel", pixel(*place), Some(Role::Reference)),
            fact("Tensor, Σ w = 1", format!("I_x² {a}, I_x I_y {b}, I_y² {c}"), None),
            fact("Eigenvalues", format!("{large} and {small}"), None),
            fact("Response", words::number(*response), Some(Role::Result)),
        ];
        if state.stage != Stage::Response {
            facts.push(fact("Threshold", words::number(self.peaks(state).limit), None));
            facts.push(fact("Verdict", self.verdict(seen, looked).1, None));
        }
        let tile = |label, values: Grid<f32>, range| Tile { label, role: None, values, range };
        let radius = (self.0.settings().window / 2 + 1).min(5);
        let [symbols, numbers] = self.0.equation(tensor);
        let mut tiles = vec![tile("Frame t", explain::around(state.picture.luma(), *place, radius), [0.0, 255.0])];
        if state.stage != Stage::Response {
            let shown = explain::around(&state.map.map(|response| M::shown(*response)), *place, radius);
            let most = shown.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(*v));
            tiles.push(tile("Response, as painted", shown, [0.0, most]));
        }
        vec![Readout::Facts(facts), Readout::Equation(vec![matrix(), symbols, numbers]), Readout::Tiles(tiles)]
    }

    /// What has become of a pixel by now, once all responses are known, and the line that decided it.
    fn verdict(&self, seen: &Seen<Self>, looked: &Looked) -> (Name, String) {
        let (state, peaks, place) = (seen.before, self.peaks(seen.before), looked.place);
        if !peaks.is_over(place.0, place.1) {
            let (width, height) = state.map.size();
            let is_border = place.0 == 0 || place.1 == 0 || place.0 + 1 == width || place.1 + 1 == height;
            let why = if is_border { "at the border" } else { "below the threshold" };
            return (line::EACH_STRONG, why.into());
        }
        if let Some(by) = peaks.suppressed_by(place) {
            return (line::SUPPRESS, format!("suppressed by {}", pixel(by)));
        }
        let Settings { min_distance, max_points, .. } = self.0.settings();
        let index = (place.1 * state.map.width() + place.0) as u32;
        let choice = seen.events.iter().find_map(|event| match event {
            Event::Peak(peak, near) if *peak == index => Some(*near),
            _ => None,
        });
        match choice {
            Some(None) => (line::KEEP, "corner, kept".into()),
            Some(Some(near)) => {
                (line::DROP_NEAR, format!("peak, nearer than {min_distance} px to {}", pixel(state.place(near))))
            }
            None if seen.after.is_some() && state.stage == Stage::Choice => {
                (line::KEEP, format!("peak, not among the {max_points} strongest"))
            }
            None => (line::SUPPRESS, "peak".into()),
        }
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        self.draw_map(seen, scene);
        let mut points = |role, meaning, places: Vec<(usize, usize)>| {
            if !places.is_empty() {
                scene.mark(Picture::CURRENT, role, Shape::Points(places.into_iter().map(point).collect()));
                scene.legend(role, meaning);
            }
        };
        let places = |peaks: &[u32]| peaks.iter().map(|peak| state.place(*peak)).collect::<Vec<_>>();
        match state.stage {
            Stage::Response => {}
            Stage::Suppression => {
                let over = |is_peak: bool| {
                    let of_row = seen.events.iter().filter_map(move |event| match event {
                        Event::Over(place, by) if by.is_none() == is_peak => Some(*place),
                        _ => None,
                    });
                    of_row.collect::<Vec<_>>()
                };
                points(Role::Rejected, "suppressed by a neighbour", over(false));
                points(Role::Best, "peak", [places(&state.peaks), over(true)].concat());
            }
            Stage::Choice => {
                let looked_at = |is_kept: bool| {
                    let peaks = seen.events.iter().filter_map(move |event| match event {
                        Event::Peak(peak, near) if near.is_none() == is_kept => Some(*peak),
                        _ => None,
                    });
                    places(&peaks.collect::<Vec<_>>())
                };
                let (kept, dropped) = (looked_at(true), looked_at(false));
                let done: Vec<_> = kept.iter().chain(&dropped).copied().collect();
                // What the last step left was not asked for.
                let mut is_done = Grid::new(state.map.width(), state.map.height(), seen.after.is_some());
                done.iter().for_each(|place| is_done[*place] = true);
                let waiting = places(&state.peaks).into_iter().filter(|place| !is_done[*place]).collect();
                points(Role::Candidate, "peak that waits", waiting);
                points(Role::Rejected, "too near to one kept before", dropped);
                points(Role::Result, "corner", kept);
            }
        }
        self.draw_pixel(seen, scene);
    }

    /// The responses so far; in later stages only those over the threshold.
    fn draw_map(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, peaks) = (seen.before, self.peaks(seen.before));
        let (width, height) = state.map.size();
        let values = Grid::from_fn(width, height, |x, y| match (state.stage, seen.events.get(x)) {
            (Stage::Response, Some(Event::Response(response))) if y == state.row => M::shown(*response),
            (Stage::Response, _) if y < state.row => M::shown(state.map[(x, y)]),
            (Stage::Suppression | Stage::Choice, _) if peaks.is_over(x, y) => M::shown(state.map[(x, y)]),
            _ => f32::NAN,
        });
        if values.cells().iter().any(|value| value.is_finite()) {
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
            scene.heat = Some(M::SHOWN);
        }
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(looked) = self.look(seen) else { return };
        let (x, y) = (looked.place.0 as i32, looked.place.1 as i32);
        let Settings { window, min_distance, .. } = self.0.settings();
        if let (Some(Event::Peak(..)), None) = (seen.events.last(), seen.point()) {
            let radius = min_distance as f32;
            let shape = Shape::Ellipse { center: point(looked.place), radii: [radius; 2], angle_rad: 0.0 };
            scene.mark(Picture::CURRENT, Role::Window, shape);
            scene.legend(Role::Window, "least distance");
        } else {
            let reach = (window / 2) as i32;
            let side = 2 * reach as usize + 1;
            scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x - reach, y - reach, side, side));
            scene.legend(Role::Window, "window");
        }
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x, y, 1, 1));
        scene.legend(Role::Reference, "pixel");
    }
}

impl State {
    /// The place of the strongest peak.
    fn strongest(&self) -> Option<(usize, usize)> {
        let better = |a: u32, b: u32| if self.map[self.place(b)] > self.map[self.place(a)] { b } else { a };
        self.peaks.iter().copied().reduce(better).map(|peak| self.place(peak))
    }
}

/// How much of a corner a pixel is.
fn responds(looked: &Looked) -> Sentence {
    let [large, small] = looked.tensor.eigenvalues().map(words::number);
    Sentence::default()
        .ink(Role::Reference, format!("Pixel {}", pixel(looked.place)))
        .text(format!(" has a tensor with eigenvalues {large} and {small}. Its response is "))
        .ink(Role::Result, words::number(looked.response))
        .text(".")
}

/// What becomes of a pixel over the threshold, which `by` suppresses, if there is such a neighbour.
fn over(peaks: &Peaks<'_>, place: (usize, usize), by: Option<(usize, usize)>) -> Sentence {
    let (said, response) = (Sentence::default(), |place| words::number(peaks.map[place]));
    let Some(by) = by else {
        let limit = words::number(peaks.limit);
        return said.ink(Role::Best, format!("Pixel {}", pixel(place))).text(format!(
            " has {}, over the threshold of {limit}, and no neighbour is stronger: a peak.",
            response(place)
        ));
    };
    said.ink(Role::Rejected, format!("Pixel {}", pixel(place)))
        .text(format!(" is over the threshold with {}, but its neighbour ", response(place)))
        .ink(Role::Best, pixel(by))
        .text(if peaks.map[by] > peaks.map[place] {
            format!(" has {}: suppressed.", response(by))
        } else {
            " is as strong and comes first: suppressed.".into()
        })
}

/// The structure tensor in symbols.
fn matrix() -> Math {
    let product =
        |parts: Vec<Math>| Math::Row([vec![Math::text("Σ "), Math::Var("w"), Math::text(" ")], parts].concat());
    let squared = |along| product(vec![Math::power(explain::derivative(along), Math::text("2"))]);
    let mixed = || product(vec![explain::derivative("x"), explain::derivative("y")]);
    Math::Row(vec![
        Math::Bold("T"),
        Math::text(" = "),
        Math::Matrix(vec![vec![squared("x"), mixed()], vec![mixed(), squared("y")]]),
    ])
}
