//! How the filter is told and drawn.

use super::matrices::matrices;
use super::sensors::{Look, Sensed, Sensors};
use super::{Event, Gated, KalmanFilter, Loss, Moment, State, line};
use crate::base::words::{self, counted as count, fine, number_64 as short, percent};
use crate::methods::kalman::{Filter, Measurement, chi_square, ellipse};
use crate::run::Seen;
use crate::scene::{Arrow, Band, Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// A line of a plot: its name, its role and its points.
type Line = (&'static str, Role, Vec<[f32; 2]>);

/// A place as a person reads it.
fn place(place: [f64; 2]) -> String {
    words::place(point(place))
}

fn point(place: [f64; 2]) -> [f32; 2] {
    place.map(|c| c as f32)
}

/// What is on the way of a step: the filters before and after it, as far as it has them.
struct Now<'a> {
    frame: usize,
    before: Option<Filter>,
    predicted: Option<Filter>,
    gated: Vec<&'a Gated>,
    after: Option<Filter>,
}

impl Now<'_> {
    /// The state estimate by now, and in which role.
    fn believed(&self) -> Option<(&Filter, Role)> {
        let predicted = || self.predicted.as_ref().or(self.before.as_ref()).map(|filter| (filter, Role::Predicted));
        self.after.as_ref().map(|filter| (filter, Role::Estimate)).or_else(predicted)
    }
}

impl KalmanFilter {
    fn now<'a>(&self, seen: &Seen<'a, Self>) -> Now<'a> {
        let state = seen.before;
        let mut now =
            Now { frame: frame_of(state), before: state.filter, predicted: None, gated: Vec::new(), after: None };
        for event in seen.events {
            match event {
                Event::Predicted(both) => now.predicted = Some(both[1]),
                Event::Gated(gated) => now.gated.push(gated),
                Event::Updated(update) => now.after = Some(update.1),
                Event::Begun(filter, _) => now.after = Some(**filter),
                Event::Missed(filter) => now.after = filter.as_deref().copied(),
                Event::Lost(filter, _) => now.after = Some(**filter),
                Event::Smoothed(all) => (now.before, now.after) = (Some(all[0]), Some(all[1])),
                Event::Kept(filter) => {
                    (now.before, now.after) = (filter.as_deref().copied(), filter.as_deref().copied())
                }
                Event::Looked(_) => {}
            }
        }
        now
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Predicted(_)) => line::PREDICT,
            Some(Event::Looked(_)) => line::MEASURE,
            Some(Event::Begun(..) | Event::Missed(None)) => line::BEGIN_OBJECT,
            Some(Event::Gated(_)) => line::GATE,
            Some(Event::Updated(_)) => line::UPDATE,
            Some(Event::Missed(Some(_)) | Event::Lost(..)) => line::COAST_OR_END,
            Some(Event::Smoothed(_)) => line::SMOOTH,
            Some(Event::Kept(_)) => line::EACH_FRAME_BACK,
        };
        let now = self.now(seen);
        Step { line, sentence: self.sentence(seen, &now), readouts: self.readouts(seen, &now) }
    }

    fn sentence(&self, seen: &Seen<Self>, now: &Now) -> Sentence {
        let said = Sentence::default();
        let Now { frame, .. } = now;
        match seen.events.last() {
            None => said
                .text("A filter estimates the place and velocity of an object, and their covariance. In each frame it ")
                .ink(Role::Predicted, "predicts")
                .text(", looks at what is ")
                .ink(Role::Measured, "measured")
                .text(" and settles ")
                .ink(Role::Estimate, "between both")
                .text("."),
            Some(Event::Predicted(both)) => {
                let [before, after] = both.each_ref().map(deviation);
                said.text(format!("In frame {frame} the object is "))
                    .ink(Role::Predicted, format!("expected at {}", place(both[1].place())))
                    .text(format!(
                        ". A time step makes that less sure: the standard deviation goes from {} to {} px.",
                        short(before),
                        short(after)
                    ))
            }
            Some(Event::Looked(look)) => looked(frame, look, seen.before.detector.told()),
            Some(Event::Gated(gated)) => {
                let distance = short(gated.squared_distance);
                let gate = format!("the {} gate is {}", percent(self.gate), short(gated.limit));
                let said = said
                    .text(format!("{}: squared Mahalanobis distance of the innovation ", sensor(gated)))
                    .ink(Role::Measured, format!("d² = {distance}"));
                if gated.is_inside() {
                    said.text(format!("; {gate}, so the measurement is accepted."))
                } else {
                    said.ink(Role::Error, format!("; {gate}, so the measurement is rejected."))
                }
            }
            Some(Event::Updated(update)) => {
                let (gated, after) = (&update.0, &update.1);
                let from = gated.expected.place();
                said.text("The state estimate moves ").ink(Role::Estimate, format!("to {}", place(after.place()))).text(
                    format!(
                        ", by {} px; the measurement is {} px away. Its standard deviation goes from {} to {} px.",
                        short(distance(from, after.place())),
                        short(distance(from, gated.measurement().place)),
                        short(deviation(&gated.expected)),
                        short(deviation(after))
                    ),
                )
            }
            Some(Event::Begun(filter, there)) => said
                .text("An object begins with its first measurement, at ")
                .ink(Role::Estimate, place(filter.place()))
                .text(format!(
                    ". How it moves is not known: each component of its velocity is 0 ± {} px/frame.",
                    short(f64::from(self.first_speed))
                ))
                .text(if self.object > *there {
                    format!(" Object {} was asked for and {} there: it is the last one.", self.object, are(*there))
                } else {
                    String::new()
                }),
            Some(Event::Missed(None)) => said.text(match seen.before.begun {
                0 => format!("Nothing was measured up to frame {frame}: no object has begun yet."),
                _ => {
                    format!("The track was deleted, and nothing is measured in frame {frame} that could begin another.")
                }
            }),
            Some(Event::Missed(Some(filter))) => {
                let refused = now.gated.len();
                said.text(match refused {
                    0 => "Without a measurement the prediction stands: ",
                    1 => "The measurement lies outside the gate, so the prediction stands: ",
                    _ => "All measurements lie outside the gate, so the prediction stands: ",
                })
                .ink(Role::Estimate, place(filter.place()))
                .text(format!(
                    ". For {} nothing was measured that belongs to the object.",
                    count(seen.before.missed + 1, "frame")
                ))
            }
            Some(Event::Lost(filter, loss)) => said
                .text(match loss {
                    Loss::Unseen => format!("The object was not seen for more than {},", count(self.patience, "frame")),
                    Loss::Outside => {
                        format!("The prediction {} lies far outside the picture,", place(filter.place()))
                    }
                })
                .text(" so the track is deleted; the next measurement begins another."),
            Some(Event::Smoothed(all)) => {
                let far = distance(all[0].place(), all[1].place());
                said.text(format!(
                    "Frame {frame} once more, with what is known of the next: the state estimate moves by {} px ",
                    short(far)
                ))
                .ink(Role::Result, format!("to {}", place(all[1].place())))
                .text(format!(
                    ", and its standard deviation goes from {} to {} px.",
                    short(deviation(&all[0])),
                    short(deviation(&all[1]))
                ))
            }
            Some(Event::Kept(Some(_))) => said.text(format!(
                "After frame {frame} nothing more is known of the object: the state estimate stays as it is."
            )),
            Some(Event::Kept(None)) => said.text(format!("In frame {frame} there is no state estimate to smooth.")),
        }
    }

    fn readouts(&self, seen: &Seen<Self>, now: &Now) -> Vec<Readout> {
        let mut readouts = vec![Readout::Facts(self.facts(seen, now))];
        readouts.extend(self.equation(seen.events.last()));
        let moments = seen.before.moments.iter().map(|moment| &**moment);
        let matrices = matrices(seen.events.last(), now.believed(), moments);
        if !matrices.is_empty() {
            readouts.push(Readout::Matrices(matrices));
        }
        readouts.extend(self.series(seen));
        readouts
    }

    fn facts(&self, seen: &Seen<Self>, now: &Now) -> Vec<Fact> {
        let mut facts = vec![Fact::new("Frame", now.frame.to_string(), None)];
        let believed = now.believed();
        if let Some((filter, role)) = believed {
            let ([u, v], [[xx, _], [_, yy]]) = (filter.velocity(), filter.place_covariance());
            facts.push(Fact::new("Place", format!("{} px", place(filter.place())), Some(role)));
            facts.push(Fact::new(
                "Velocity",
                format!("{} px/frame, {} px/frame fast", place([u, v]), short(u.hypot(v))),
                None,
            ));
            facts.push(Fact::new(
                "Standard deviation",
                format!("{} by {} px", short(xx.sqrt()), short(yy.sqrt())),
                None,
            ));
        }
        if let Some(gated) = now.gated.last() {
            facts.push(Fact::new("Measured", format!("{} px", place(gated.measurement().place)), Some(Role::Measured)));
            facts.push(Fact::new(
                "NIS",
                format!("{}, taken up to {}", short(gated.squared_distance), short(gated.limit)),
                None,
            ));
        }
        if let (Some(truth), Some((filter, _))) = (truth(seen), believed) {
            facts.push(Fact::new("Truth", format!("{} px", place(truth)), Some(Role::Truth)));
            facts.push(Fact::new("Error", format!("{} px", short(distance(truth, filter.place()))), Some(Role::Error)));
            facts.extend(filter.squared_error(truth).map(|nees| Fact::new("NEES", short(nees), None)));
        }
        facts
    }

    /// The formula of the step with its numbers, along x.
    fn equation(&self, event: Option<&Event>) -> Option<Readout> {
        let var = Math::Var;
        let sub = |name, index| Math::indexed(Math::Var(name), Math::Var(index));
        let text = |text: &str| Math::text(text);
        let lines = match event? {
            Event::Predicted(both) => {
                let (before, after) = (&both[0], &both[1]);
                let [x, u] = [before.place()[0], before.velocity()[0]];
                vec![
                    Math::Row(vec![
                        Math::Bold("x"),
                        text(" ← "),
                        var("f"),
                        text("("),
                        Math::Bold("x"),
                        text("),  "),
                        Math::Bold("P"),
                        text(" ← "),
                        Math::Bold("F"),
                        Math::Bold("P"),
                        Math::power(Math::Bold("F"), text("T")),
                        text(" + "),
                        Math::Bold("Q"),
                    ]),
                    Math::Row(vec![
                        var("x"),
                        text(&format!(": {} and {} px/frame, after a frame ", short(x), short(u))),
                        Math::ink(Role::Predicted, short(after.place()[0])),
                    ]),
                ]
            }
            Event::Gated(gated) => {
                let numbers = gated.expected.update_numbers(gated.measurement())?;
                vec![Math::Row(vec![
                    Math::power(Math::Bold("ν"), text("T")),
                    Math::power(Math::Bold("S"), text("−1")),
                    Math::Bold("ν"),
                    text(&format!(
                        " = {} {} {}",
                        short(numbers.squared_distance),
                        if gated.is_inside() { "≤" } else { ">" },
                        short(gated.limit)
                    )),
                ])]
            }
            Event::Updated(update) => {
                let (gated, after) = (&update.0, &update.1);
                let numbers = gated.expected.update_numbers(gated.measurement())?;
                let (gain, residual) = (numbers.gain[(0, 0)], numbers.residual[0]);
                vec![
                    Math::Row(
                        [Math::Bold("x"), text(" ← "), Math::Bold("x"), text(" + "), Math::Bold("K"), Math::Bold("ν")]
                            .to_vec(),
                    ),
                    Math::Row(vec![
                        sub("x", "x"),
                        text(" = "),
                        Math::ink(Role::Predicted, fine(gated.expected.place()[0] as f32)),
                        text(&format!(" + {} · ", short(gain))),
                        Math::ink(Role::Measured, fine(residual as f32)),
                        text(" + … = "),
                        Math::ink(Role::Estimate, fine(after.place()[0] as f32)),
                    ]),
                ]
            }
            _ => return None,
        };
        Some(Readout::Equation(lines))
    }

    /// What goes from frame to frame, up to the one at hand.
    fn series(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.after.unwrap_or(seen.before);
        let moments = || state.moments.iter().enumerate();
        let x = |i: usize| (state.span.first + i) as f32;
        let line = |of: &dyn Fn(&Moment) -> Option<f64>| -> Vec<[f32; 2]> {
            moments().filter_map(|(i, moment)| Some([x(i), of(moment)? as f32])).collect()
        };
        // Two-sided: a filter that is far too unsure lies below the lower end.
        let band = |dof: usize| Band {
            name: "95 % band".into(),
            values: [0.025, 0.975].map(|p| chi_square::quantile(p, dof) as f32),
        };
        let x_max = state.span.first + state.span.frames().map_or(state.moments.len(), |frames| frames - 1);
        let series = |title, y_label, lines: Vec<Line>| Series {
            title,
            x_label: "frame",
            y_label,
            x_max,
            lines,
            ..Series::default()
        };
        if state.moments.len() < 2 {
            return Vec::new();
        }
        let sigma = line(&|moment| moment.filtered.as_ref().map(deviation));
        let smoothed = line(&|moment| moment.smoothed.as_ref().map(deviation));
        let mut deviations = vec![("filtered", Role::Estimate, sigma)];
        if !smoothed.is_empty() {
            deviations.push(("smoothed", Role::Result, smoothed));
        }
        let names = if self.sensors == Sensors::One {
            ["NIS"; 2]
        } else {
            ["NIS of the first sensor", "NIS of the second sensor"]
        };
        let mut all = Vec::new();
        for (sensor, title) in names.into_iter().enumerate() {
            // Where nothing was measured the line is broken.
            let all_of =
                line(&|moment| Some(moment.of_sensor(sensor).map_or(f64::NAN, |gated| gated.squared_distance)));
            let refused = line(&|moment| {
                let gated = moment.of_sensor(sensor).filter(|gated| !gated.is_inside())?;
                Some(gated.squared_distance)
            });
            let dof = moments().find_map(|(_, moment)| Some(moment.of_sensor(sensor)?.measurement().numbers()));
            let Some(dof) = dof else { continue };
            let mut lines = vec![("NIS", Role::Measured, all_of)];
            if !refused.is_empty() {
                lines.push(("outside the gate", Role::Rejected, refused));
            }
            let limit = chi_square::quantile(f64::from(self.gate), dof) as f32;
            let thresholds = vec![(format!("{} gate", percent(self.gate)), limit)];
            let nis = series(title, "squared distance", lines);
            all.push(Series { bands: vec![band(dof)], thresholds, ..nis });
        }
        all.push(series("Standard deviation", "px", deviations));
        let nees = line(&|moment| moment.filtered?.squared_error(moment.truth?));
        if nees.len() > 1 {
            let off = |of: fn(&Moment) -> Option<Filter>| {
                line(&move |moment: &Moment| Some(distance(of(moment)?.place(), moment.truth?)))
            };
            let nees = series("NEES", "squared distance", vec![("NEES", Role::Error, nees)]);
            all.push(Series { bands: vec![band(2)], ..nees });
            let mut errors = vec![("filtered", Role::Estimate, off(|moment| moment.filtered))];
            let measured = line(&|moment| Some(distance(moment.of_sensor(0)?.measurement().place, moment.truth?)));
            errors.push(("measured", Role::Measured, measured));
            if state.back.is_some() {
                errors.push(("smoothed", Role::Result, off(|moment| moment.smoothed)));
            }
            all.push(series("Distance from the truth", "px", errors));
        }
        all.into_iter().map(Readout::Series).collect()
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, now) = (seen.before, self.now(seen));
        trails(seen, scene);
        let detections = seen.events.iter().find_map(|event| match event {
            Event::Looked(look) => Some(&look.detections),
            _ => None,
        });
        for found in detections.into_iter().flat_map(|all| all.iter()) {
            let shape = Shape::Rect { min: found.bounds.min, max: found.bounds.max };
            scene.mark(Picture::CURRENT, Role::Reference, shape);
            scene.legend(Role::Reference, "detected");
        }
        self.truth(seen, scene);
        if let Some(predicted) = now.predicted {
            self.belief(&predicted, (Role::Predicted, "predicted"), scene);
        }
        if let Some(Event::Gated(gated)) = seen.events.last() {
            gate(gated, scene);
        }
        measured(seen, &now, scene);
        let is_back = state.back.is_some();
        if let Some(before) = now.before.filter(|_| is_back) {
            self.belief(&before, (Role::Estimate, "filtered"), scene);
        }
        if let Some(after) = now.after {
            let role = if is_back { (Role::Result, "smoothed") } else { (Role::Estimate, "estimated") };
            self.belief(&after, role, scene);
        }
        if scene.legend.is_empty() {
            scene.legend(Role::Measured, "measured");
            scene.legend(Role::Predicted, "predicted");
            scene.legend(Role::Estimate, "estimated");
        }
    }

    /// An estimated place, with its ellipse.
    fn belief(&self, filter: &Filter, (role, meaning): (Role, &'static str), scene: &mut Scene) {
        let center = filter.place();
        if let Some(shape) = ellipse(center, filter.place_covariance(), self.confidence.share()) {
            scene.mark(Picture::CURRENT, role, shape);
            scene.mark(Picture::CURRENT, role, Shape::Points(vec![point(center)]));
            scene.legend(role, meaning);
        }
    }

    fn truth(&self, seen: &Seen<Self>, scene: &mut Scene) {
        if let Some(truth) = truth(seen) {
            scene.mark(Picture::CURRENT, Role::Truth, Shape::Points(vec![point(truth)]));
            scene.legend(Role::Truth, "true place");
        }
    }
}

/// What there is to see of a frame, in words.
fn looked(frame: &usize, look: &Look, how: &str) -> Sentence {
    let said = Sentence::default();
    let [first, second] = [0, 1].map(|sensor| look.measured.iter().find(|sensed| sensed.sensor == sensor));
    let measured = |sensed: &Sensed| {
        let Measurement { place: at, place_deviation, .. } = sensed.measurement;
        (place(at), format!(", with a standard deviation of {} px", short(place_deviation)))
    };
    let said = match first.map(measured) {
        Some((at, sure)) => said.ink(Role::Measured, format!("Measured: {at}")).text(format!(", {how}{sure}.")),
        None if look.is_hidden && second.is_some() => {
            said.text(format!("Frame {frame} is one of those in which the first sensor sees nothing of the object."))
        }
        None if look.is_hidden => {
            said.text(format!("Frame {frame} is one of those in which nothing is to be seen of the object."))
        }
        None if !look.detections.is_empty() => said
            .ink(Role::Measured, format!("{} in frame {frame}", count(look.detections.len(), "detection")))
            .text(", and none of them lies at a clicked place: the object begins where it is."),
        None => said.text(format!("Nothing is detected in frame {frame}.")),
    };
    match second.map(measured) {
        Some((at, sure)) => {
            said.ink(Role::Measured, format!(" The second sensor measures {at}")).text(format!("{sure}."))
        }
        None => said,
    }
}

fn are(there: usize) -> String {
    if there == 1 { "only one is".into() } else { format!("only {there} are") }
}

/// The frame at work.
fn frame_of(state: &State) -> usize {
    let count = state.moments.len();
    state.span.first + state.back.map_or(count, |done| count.saturating_sub(done + 1))
}

fn sensor(gated: &Gated) -> &'static str {
    if gated.sensed.sensor == 0 { "The measurement" } else { "The second sensor's measurement" }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The standard deviation of a place, the mean over both axes.
fn deviation(filter: &Filter) -> f64 {
    let [[xx, _], [_, yy]] = filter.place_covariance();
    ((xx + yy) / 2.0).sqrt()
}

/// The true place in the frame at hand.
fn truth(seen: &Seen<KalmanFilter>) -> Option<[f64; 2]> {
    let told = seen.events.iter().find_map(|event| match event {
        Event::Looked(look) => look.truth,
        _ => None,
    });
    let index = frame_of(seen.before) - seen.before.span.first;
    told.or_else(|| seen.before.moments.get(index)?.truth)
}

/// The estimated places up to here, and where what came later puts it.
fn trails(seen: &Seen<KalmanFilter>, scene: &mut Scene) {
    let state = seen.before;
    let mut draw = |of: fn(&Moment) -> Option<Filter>, role: Role, meaning: &'static str| {
        let mut runs: Vec<Vec<[f32; 2]>> = Vec::new();
        for moment in &state.moments {
            match of(moment) {
                Some(filter) => {
                    if runs.is_empty() || moment.begins {
                        runs.push(Vec::new());
                    }
                    if let Some(run) = runs.last_mut() {
                        run.push(point(filter.place()));
                    }
                }
                None => runs.push(Vec::new()),
            }
        }
        for points in runs.into_iter().filter(|points| points.len() > 1) {
            scene.mark(Picture::CURRENT, role, Shape::Path { points, closed: false });
            scene.legend(role, meaning);
        }
    };
    draw(|moment| moment.filtered, Role::Estimate, if state.back.is_some() { "filtered" } else { "estimated" });
    if state.back.is_some() {
        draw(|moment| moment.smoothed, Role::Result, "smoothed");
    }
}

/// The region in which a measurement is taken.
fn gate(gated: &Gated, scene: &mut Scene) {
    let Some(numbers) = gated.expected.update_numbers(gated.measurement()) else { return };
    let covariance = [0, 1].map(|i| [0, 1].map(|j| numbers.covariance[(j, i)]));
    // The share that lies within this limit in the plane of places.
    let share = chi_square::share(gated.limit, 2);
    if let Some(shape) = ellipse(gated.expected.place(), covariance, share) {
        scene.mark(Picture::CURRENT, Role::Window, shape);
        scene.legend(Role::Window, "gate");
    }
}

/// What was measured, and the way there from what was expected.
fn measured(seen: &Seen<KalmanFilter>, now: &Now, scene: &mut Scene) {
    let looked = seen.events.iter().find_map(|event| match event {
        Event::Looked(look) => Some(&look.measured),
        _ => None,
    });
    let Some(all) = looked.filter(|all| !all.is_empty()) else { return };
    let is_refused =
        |sensed: &&Sensed| now.gated.iter().any(|gated| gated.sensed.sensor == sensed.sensor && !gated.is_inside());
    let (refused, taken): (Vec<&Sensed>, Vec<&Sensed>) = all.iter().partition(is_refused);
    for (role, sensed) in [(Role::Measured, taken), (Role::Rejected, refused)] {
        if !sensed.is_empty() {
            let points = sensed.iter().map(|sensed| point(sensed.measurement.place)).collect();
            scene.mark(Picture::CURRENT, role, Shape::Points(points));
            scene.legend(role, if role == Role::Rejected { "measured, and refused by the gate" } else { "measured" });
        }
    }
    // The innovation of the sensor at work: one that was refused moves nothing.
    if let Some(gated) = now.gated.last() {
        let arrow = Arrow { from: point(gated.expected.place()), to: point(gated.measurement().place) };
        let role = if gated.is_inside() { Role::Best } else { Role::Rejected };
        scene.mark(Picture::CURRENT, role, Shape::Arrows(vec![arrow]));
        scene.legend(Role::Best, "innovation ν");
    }
}
