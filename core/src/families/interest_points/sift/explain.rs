//! The explanation and the drawing of SIFT.

use std::f32::consts::SQRT_2;

use super::{Event, Oriented, Row, Sift, Stage, State, line};
use crate::base::words::{self, gray, pixel};
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::scale_space::{
    BINS, CELLS, CLAMP, Descriptor, Extremum, Histogram, Iteration, ORIENTATIONS, PEAK_RATIO, Peak, Refined, Rejection,
    SIDE, beats,
};
use crate::run::Seen;
use crate::scene::{
    Arrow, Canvas, Fact, Math, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile,
};

/// Radius of the blob to which a difference of Gaussians responds most, in standard deviations.
const BLOB_RADIUS: f32 = SQRT_2;

/// The differences of Gaussians below, at and above a pixel, with its position.
struct Around<'a> {
    at: Extremum,
    differences: [&'a Grid<f32>; 3],
}

impl Around<'_> {
    fn value(&self) -> f32 {
        self.differences[1][(self.at.x, self.at.y)]
    }
}

impl Sift {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last().copied() else {
            let sentence = "SIFT finds the same points at another scale or rotation: a blob gives an extremum of the difference of \
                            Gaussians in position and in scale. First the scale space is built.";
            return Step {
                line: line::BUILD_SPACE,
                sentence: Sentence::default().text(sentence),
                readouts: vec![Readout::Facts(self.plan(seen.before))],
            };
        };
        let (line, sentence) = self.said(seen, last);
        let sentence = if seen.after.is_some() { self.concluded(seen, sentence) } else { sentence };
        Step { line, sentence, readouts: self.readouts(seen, last) }
    }

    /// The dimensions of the scale space.
    fn plan(&self, state: &State) -> Vec<Fact> {
        let (shape, size) = (self.shape(), state.picture.size());
        let (width, height) = shape.size_of(0, size);
        vec![
            Fact::new("Octaves", shape.octaves_of(size).to_string(), None),
            Fact::new("Gaussian images per octave", format!("{} ({} scales + 3)", shape.levels(), shape.scales), None),
            Fact::new("First octave", format!("{width} × {height} px"), None),
        ]
    }

    fn said(&self, seen: &Seen<Self>, event: Event) -> (Name, Sentence) {
        let (state, said) = (seen.before, Sentence::default());
        match event {
            Event::Level => (line::BUILD_SPACE, said.text(self.level_said(state))),
            Event::Row => match seen.point().and_then(|point| self.pointed_at(state, point)) {
                Some(around) => (line::IS_EXTREMUM, compared(&around)),
                None => (line::EACH_PIXEL, said.text(self.row_said(state))),
            },
            Event::Extremum(x) => (line::IS_EXTREMUM, self.extremum_said(state, x)),
            Event::Iteration(iteration) => (line::FIT, self.iteration_said(&iteration)),
            Event::Verdict(verdict) => self.verdict_said(seen, verdict),
            Event::Histogram => (line::EACH_KEYPOINT, self.histogram_said(state)),
            Event::Peak(peak) => (line::ORIENT, peak_said(seen, peak)),
            Event::Selected => (line::SELECT, said.text(self.selection_said(state))),
            Event::Cell(cell) => (line::FILL_CELL, self.cell_said(state, cell)),
            Event::Normalised => (line::NORMALISE, self.norm_said(state)),
            Event::Clamped => (line::CLAMP, self.clamp_said(state)),
        }
    }

    fn level_said(&self, state: &State) -> String {
        let shape = self.shape();
        let (octave, level) = (state.next / shape.levels(), state.next % shape.levels());
        let sigma = gray(shape.sigma_of(level as f32));
        let pixel = shape.pixel_px(octave);
        match (octave, level) {
            (0, 0) => format!(
                "Octave 1{}: a Gaussian filter with σ = {} px raises the blur of the camera, assumed 0.50 px of the frame, to σ = {sigma} px.",
                if self.double { ", at twice the resolution of the frame" } else { "" },
                gray(shape.increment_px(0, 0)),
            ),
            (_, 0) => format!(
                "Octave {}: every second pixel of the image with twice the first σ. At half the resolution it has σ = {sigma} px again, \
                 {} px of the frame.",
                octave + 1,
                gray(shape.sigma_of(0.0) * pixel)
            ),
            _ => format!(
                "Gaussian image {}: filtering image {level} with σ = {} px gives σ = {sigma} px. Their difference responds most \
                 to blobs with a radius of about {} px of the frame.",
                level + 1,
                gray(shape.increment_px(octave, level)),
                gray(BLOB_RADIUS * shape.sigma_of(level as f32 - 1.0) * pixel)
            ),
        }
    }

    fn current_row(&self, state: &State) -> Option<Row> {
        (state.stage == Stage::Extrema).then(|| self.row(state.picture.size(), state.next)).flatten()
    }

    /// Octave and level in words, counted from 1 as octaves are.
    fn scale_name(&self, octave: usize, level: usize) -> String {
        let sigma = self.shape().sigma_of(level as f32) * self.shape().pixel_px(octave);
        format!("octave {}, difference {} (σ = {} px of the frame)", octave + 1, level + 1, gray(sigma))
    }

    fn row_said(&self, state: &State) -> String {
        let Some(Row { octave, level, y }) = self.current_row(state) else { return String::new() };
        format!(
            "Row {y} of {}: each pixel with |D| above {} gray levels, half the contrast threshold, is compared with its 26 neighbours in \
             position and scale.",
            self.scale_name(octave, level),
            gray(self.least())
        )
    }

    fn around<'a>(&self, state: &'a State, at: Extremum) -> Option<Around<'a>> {
        let all = &state.space.octaves.get(at.octave)?.differences;
        let level = |level: usize| all.get(level).map(|image| &**image);
        let differences = [level(at.level.checked_sub(1)?)?, level(at.level)?, level(at.level + 1)?];
        let (width, height) = differences[1].size();
        let is_inside = at.x > 0 && at.y > 0 && at.x + 1 < width && at.y + 1 < height;
        is_inside.then_some(Around { at, differences })
    }

    /// The pixel of the current difference under a point of the frame.
    fn pointed_at<'a>(&self, state: &'a State, point: [f32; 2]) -> Option<Around<'a>> {
        let Row { octave, level, .. } = self.current_row(state)?;
        let size = self.shape().pixel_px(octave);
        let [x, y] = point.map(|c| (c / size).round().max(0.0) as usize);
        self.around(state, Extremum { octave, level, x, y })
    }

    fn extremum_said(&self, state: &State, x: usize) -> Sentence {
        let Some(Row { octave, level, y }) = self.current_row(state) else { return Sentence::default() };
        let Some(around) = self.around(state, Extremum { octave, level, x, y }) else { return Sentence::default() };
        compared(&around)
    }

    fn iteration_said(&self, iteration: &Iteration) -> Sentence {
        let Iteration { at, offset, .. } = iteration;
        if !offset.iter().all(|c| c.is_finite()) {
            return Sentence::default()
                .text("The quadratic through the neighbourhood of ")
                .ink(Role::Candidate, pixel((at.x, at.y)))
                .text(" has a singular Hessian, so it has no extremum.");
        }
        let [dx, dy, ds] = offset.map(|c| words::fixed(c.into(), 2));
        let said = Sentence::default()
            .text("The quadratic through the neighbourhood of ")
            .ink(Role::Candidate, pixel((at.x, at.y)))
            .text(format!(" has its extremum at the offset ({dx}, {dy}) px, {ds} scales"));
        match iteration.is_converged() {
            true => said.text(": less than ½ in each direction, so the position is final."),
            false => said.text(": beyond ½, so it lies nearer to a neighbour, where the fit is repeated."),
        }
    }

    fn verdict_said(&self, seen: &Seen<Self>, verdict: Result<Refined, Rejection>) -> (Name, Sentence) {
        let said = Sentence::default();
        let Some(last) = last_iteration(seen) else { return (line::UNSTABLE, said) };
        let thresholds = self.thresholds();
        let contrast = gray(last.contrast().abs());
        let [trace, determinant] = last.curvature();
        let limit = (thresholds.edge + 1.0).powi(2) / thresholds.edge;
        match verdict {
            Err(Rejection::Unstable) => {
                let why = "The extremum leaves the scale space or still moves after the last iteration: ";
                (line::UNSTABLE, said.text(why).ink(Role::Rejected, "rejected").text(" as unstable."))
            }
            Err(Rejection::LowContrast) => {
                let outcome = format!(
                    "|D| = {contrast} gray levels at the extremum is below the contrast threshold {}: ",
                    gray(thresholds.contrast)
                );
                (line::LOW_CONTRAST, said.text(outcome).ink(Role::Rejected, "rejected").text(", noise would move it."))
            }
            Err(Rejection::Edge) if determinant <= 0.0 => {
                let outcome = "The principal curvatures have opposite signs, so this is a saddle in position: ";
                (line::ON_EDGE, said.text(outcome).ink(Role::Rejected, "rejected").text("."))
            }
            Err(Rejection::Edge) => {
                let outcome = format!(
                    "(tr H)² / det H = {} reaches (r + 1)² / r = {}: one principal curvature is at least {} times the other, an edge. ",
                    gray(trace * trace / determinant),
                    gray(limit),
                    words::fixed(thresholds.edge.into(), 0)
                );
                let why = ", its position along the edge is uncertain.";
                (line::ON_EDGE, said.text(outcome).ink(Role::Rejected, "Rejected").text(why))
            }
            Ok(refined) => {
                let (at, sigma_px) = self.in_frame(&refined);
                let outcome = said.text("Kept at ").ink(Role::Result, words::place(at)).text(format!(
                    " px of the frame with σ = {} px: |D| = {contrast} reaches the contrast threshold {}, and (tr H)² / det H = {} is below \
                     {}, so it is no edge.",
                    gray(sigma_px),
                    gray(thresholds.contrast),
                    gray(trace * trace / determinant),
                    gray(limit)
                ));
                (line::KEEP, outcome)
            }
        }
    }

    fn histogram_said(&self, state: &State) -> Sentence {
        let Some(refined) = state.refined.get(state.next) else { return Sentence::default() };
        let sigma = self.sigma_in_octave(refined);
        Sentence::default().text(format!(
            "Gradient directions within {} px of the octave, weighted by their magnitudes and a Gaussian with 1.5 σ = {} px, fill 36 bins \
             of 10°. The histogram is smoothed, and its peaks are the orientations.",
            Histogram::radius_px(sigma),
            gray(1.5 * sigma)
        ))
    }

    fn selection_said(&self, state: &State) -> String {
        let kept = self.select(state.oriented.clone());
        let all = words::grouped(state.oriented.len());
        let Some(last) = kept.last() else {
            return self.none_said(state);
        };
        match kept.len() == self.max_points && state.oriented.len() > self.max_points {
            true => format!(
                "Kept: the {} of {all} keypoints with the largest |D| (the maximum number of points); the weakest has |D| = {} gray levels.",
                words::grouped(kept.len()),
                gray(last.refined.response)
            ),
            false => format!(
                "All {} keypoints are kept, in order of decreasing |D|; the weakest has {} gray levels.",
                words::grouped(kept.len()),
                gray(last.refined.response)
            ),
        }
    }

    /// Why there are no keypoints.
    fn none_said(&self, state: &State) -> String {
        let (contrast, least) = (self.thresholds().contrast, self.least());
        let differences = state.space.octaves.iter().flat_map(|octave| &octave.differences);
        let largest = differences.flat_map(|image| image.cells()).fold(0.0, |most: f32, value| most.max(value.abs()));
        let at_extrema = state.extrema.iter().map(|at| {
            let difference = &state.space.octaves[at.octave].differences[at.level];
            difference[(at.x, at.y)].abs()
        });
        match at_extrema.fold(None, |most: Option<f32>, value| Some(most.map_or(value, |most| most.max(value)))) {
            Some(strongest) => format!(
                "No extremum passed the tests, so there are no keypoints: |D| is at most {} gray levels at the extrema ({}), the contrast threshold is \
                 {}, and none may lie on an edge. A lower contrast threshold keeps weaker ones.",
                gray(strongest),
                words::grouped(state.extrema.len()),
                gray(contrast)
            ),
            None if largest > least => "0 pixels exceed all of their 26 neighbours, so there are no keypoints: a blob has an extremum, edges and \
                                        ramps have none."
                .into(),
            None => format!(
                "|D| is at most {} gray levels, and an extremum needs more than {}, half the contrast threshold: the frame has no blobs of enough \
                 contrast, so there are no keypoints. A lower contrast threshold finds weaker ones.",
                gray(largest),
                gray(least)
            ),
        }
    }

    fn cell_said(&self, state: &State, cell: usize) -> Sentence {
        let Some(oriented) = state.oriented.get(state.next) else { return Sentence::default() };
        let bins = self.gathered(&state.space, oriented).0;
        let bins = &bins[cell * BINS..][..BINS];
        let strongest = (0..BINS).max_by(|a, b| bins[*a].total_cmp(&bins[*b])).unwrap_or_default();
        let degrees = oriented.angle_rad.to_degrees();
        Sentence::default().text(format!(
            "Cell {} of {CELLS}, turned by the orientation {}° and {} px of the octave wide: gradients relative to the orientation fill 8 bins \
             of 45°. The strongest is {}°.",
            cell + 1,
            words::fixed(degrees.into(), 0),
            gray(self.place(oriented).cell_px()),
            45 * strongest
        ))
    }

    fn norm_said(&self, state: &State) -> Sentence {
        let Some(oriented) = state.oriented.get(state.next) else { return Sentence::default() };
        let raw = self.gathered(&state.space, oriented);
        let length = raw.0.iter().map(|v| v * v).sum::<f32>().sqrt();
        Sentence::default().text(format!(
            "The {} entries have the length {}; divided by it they no longer depend on the contrast of the picture.",
            CELLS * BINS,
            gray(length)
        ))
    }

    fn clamp_said(&self, state: &State) -> Sentence {
        let Some(oriented) = state.oriented.get(state.next) else { return Sentence::default() };
        let entries = self.gathered(&state.space, oriented).normalised().0;
        let count = entries.iter().filter(|v| **v > CLAMP).count();
        let what = match count {
            0 => "No entry exceeds 0.2.".to_owned(),
            1 => "1 entry exceeds 0.2 and is limited to it.".to_owned(),
            count => format!("{count} entries exceed 0.2 and are limited to it."),
        };
        Sentence::default().text(format!(
            "{what} The limit keeps single large gradients, as at a highlight, from outweighing all others. Normalised again, this is \
             the descriptor."
        ))
    }

    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some(after) = seen.after.filter(|after| is_over(self, after)) else { return sentence };
        let kept = &after.oriented;
        if kept.is_empty() {
            return sentence.text(" End of the run without keypoints.");
        }
        let mut sigmas: Vec<f32> = kept.iter().map(|oriented| self.in_frame(&oriented.refined).1).collect();
        sigmas.sort_by(f32::total_cmp);
        let help = match kept.len() == self.max_points {
            true => "The maximum number of points is reached; a larger value admits weaker keypoints.",
            false => "A lower contrast threshold finds more, a lower edge threshold fewer on edges.",
        };
        sentence.text(format!(
            " End of the run: {} from {} extrema, σ from {} to {} px, half of them below {} px. {help}",
            words::counted(kept.len(), "keypoint"),
            words::grouped(after.extrema.len()),
            gray(sigmas[0]),
            gray(sigmas[sigmas.len() - 1]),
            gray(sigmas[sigmas.len() / 2])
        ))
    }
}

/// Whether the run ends with this state.
fn is_over(sift: &Sift, after: &State) -> bool {
    after.stage == Stage::Description && after.next >= sift.units_of_stage(after, Stage::Description)
}

fn last_iteration(seen: &Seen<Sift>) -> Option<Iteration> {
    seen.events.iter().rev().find_map(|event| match event {
        Event::Iteration(iteration) => Some(*iteration),
        _ => None,
    })
}

/// The comparison of a pixel with its 26 neighbours.
fn compared(around: &Around) -> Sentence {
    let (value, Extremum { x, y, .. }) = (around.value(), around.at);
    let (extreme, larger) = if value > 0.0 { ("maximum", "larger") } else { ("minimum", "smaller") };
    let said = Sentence::default().ink(Role::Candidate, format!("Pixel {}", pixel((x, y))));
    match beats(around.differences, (x, y)) {
        None => said.text(format!(
            " has D = {} gray levels: none of its 26 neighbours is {larger}, a {extreme} in position and scale, the centre of a {} blob.",
            gray(value),
            if value > 0.0 { "dark" } else { "bright" }
        )),
        Some((level, at, other)) => said.text(format!(
            " has D = {} gray levels, but its neighbour {} {} has {}: no extremum.",
            gray(value),
            pixel(at),
            ["at the smaller scale", "at the same scale", "at the larger scale"][level],
            gray(other)
        )),
    }
}

fn peak_said(seen: &Seen<Sift>, peak: Peak) -> Sentence {
    let peaks = seen.events.iter().filter(|event| matches!(event, Event::Peak(_))).count();
    let degrees = words::fixed(peak.angle_rad.to_degrees().into(), 1);
    let said = Sentence::default().text("Orientation ").ink(Role::Result, format!("{degrees}°"));
    match peak.share == 1.0 {
        true => said.text(", the highest peak, interpolated between bins. The descriptor is turned by it, so that it turns with the picture."),
        false => said.text(format!(
            ": a peak of {} of the highest, at least the required 80 %, so keypoint {peaks} has the same place and another orientation.",
            words::percent((1000.0 * peak.share).round() / 1000.0)
        )),
    }
}

/// The charts and numbers.
impl Sift {
    fn readouts(&self, seen: &Seen<Self>, event: Event) -> Vec<Readout> {
        let state = seen.before;
        match event {
            Event::Level => {
                let mut all = vec![Readout::Facts(self.level_facts(state)), Readout::Tiles(self.octave_tiles(seen))];
                all.extend(self.stack(seen.after.unwrap_or(state)).map(Readout::Stack));
                all
            }
            Event::Row => match seen.point().and_then(|point| self.pointed_at(state, point)) {
                Some(around) => vec![Readout::Tiles(neighbourhood(&around))],
                None => vec![Readout::Facts(self.row_facts(seen))],
            },
            Event::Extremum(x) => {
                let at = self.current_row(state).map(|Row { octave, level, y }| Extremum { octave, level, x, y });
                let around = at.and_then(|at| self.around(state, at));
                let mut all = vec![Readout::Facts(self.row_facts(seen))];
                all.extend(around.map(|around| Readout::Tiles(neighbourhood(&around))));
                all
            }
            Event::Iteration(iteration) => self.fit_readouts(state, &iteration),
            Event::Verdict(_) => last_iteration(seen).map_or_else(Vec::new, |last| self.verdict_readouts(state, &last)),
            Event::Histogram | Event::Peak(_) => self.orientation_readouts(state),
            Event::Selected => vec![Readout::Facts(vec![
                Fact::new("Extrema", words::grouped(state.extrema.len()), None),
                Fact::new("After the tests", words::grouped(state.refined.len()), None),
                Fact::new("With orientations", words::grouped(state.oriented.len()), None),
                Fact::new("Maximum number of points", words::grouped(self.max_points), None),
            ])],
            Event::Cell(_) | Event::Normalised | Event::Clamped => self.descriptor_readouts(seen, event),
        }
    }

    fn level_facts(&self, state: &State) -> Vec<Fact> {
        let shape = self.shape();
        let (octave, level) = (state.next / shape.levels(), state.next % shape.levels());
        let (width, height) = shape.size_of(octave, state.picture.size());
        let sigma = shape.sigma_of(level as f32);
        vec![
            Fact::new("Octave", format!("{}, {width} × {height} px", octave + 1), None),
            Fact::new("Gaussian image", format!("{} of {}", level + 1, shape.levels()), None),
            Fact::new("σ in px of the octave", gray(sigma), None),
            Fact::new("σ in px of the frame", gray(sigma * shape.pixel_px(octave)), None),
        ]
    }

    fn row_facts(&self, seen: &Seen<Self>) -> Vec<Fact> {
        let Some(Row { octave, level, y }) = self.current_row(seen.before) else { return Vec::new() };
        let found = seen.events.iter().filter(|event| matches!(event, Event::Extremum(_))).count();
        vec![
            Fact::new("Searched", self.scale_name(octave, level), None),
            Fact::new("Row", y.to_string(), None),
            Fact::new("Extrema so far", words::grouped(seen.before.extrema.len() + found), Some(Role::Candidate)),
        ]
    }

    fn fit_readouts(&self, state: &State, iteration: &Iteration) -> Vec<Readout> {
        let [gx, gy, gs] = iteration.gradient.map(gray);
        let [xx, yy, ss, xy, xs, ys] = iteration.hessian.map(gray);
        let offset = iteration.offset.map(|c| Math::ink(Role::Result, gray(c)));
        let row = |entries: [&String; 3]| entries.map(|entry| Math::text(entry.clone())).to_vec();
        let symbols = Math::Row(vec![
            Math::Bold("d"),
            Math::text(" = −"),
            Math::power(Math::Bold("H"), Math::text("−1")),
            Math::text(" ∇"),
            Math::Var("D"),
        ]);
        let numbers = Math::Row(vec![
            Math::text("= −"),
            Math::power(
                Math::Matrix(vec![row([&xx, &xy, &xs]), row([&xy, &yy, &ys]), row([&xs, &ys, &ss])]),
                Math::text("−1"),
            ),
            Math::text(" "),
            Math::column([gx, gy, gs].map(Math::text)),
            Math::text(" = "),
            Math::column(offset),
        ]);
        let mut all = vec![Readout::Equation(vec![symbols, numbers])];
        all.extend(self.around(state, iteration.at).map(|around| Readout::Tiles(neighbourhood(&around))));
        all
    }

    fn verdict_readouts(&self, state: &State, last: &Iteration) -> Vec<Readout> {
        let (thresholds, [trace, determinant]) = (self.thresholds(), last.curvature());
        let limit = (thresholds.edge + 1.0).powi(2) / thresholds.edge;
        let ratio = if determinant > 0.0 { gray(trace * trace / determinant) } else { "negative".into() };
        let facts = vec![
            Fact::new(
                "|D| at the extremum",
                format!("{} gray levels", gray(last.contrast().abs())),
                Some(Role::Result),
            ),
            Fact::new("Contrast threshold", format!("{} gray levels", gray(thresholds.contrast)), None),
            Fact::new("(tr H)² / det H", ratio, Some(Role::Result)),
            Fact::new("Edge limit (r + 1)² / r", gray(limit), None),
        ];
        let mut all = vec![Readout::Facts(facts)];
        all.extend(self.around(state, last.at).map(|around| Readout::Tiles(neighbourhood(&around))));
        all
    }

    fn orientation_readouts(&self, state: &State) -> Vec<Readout> {
        let Some(refined) = state.refined.get(state.next) else { return Vec::new() };
        let histogram = self.histogram(&state.space, refined);
        let points = |bins: &[f32; ORIENTATIONS]| {
            bins.iter().enumerate().map(|(bin, weight)| [10.0 * bin as f32, *weight]).collect::<Vec<_>>()
        };
        let series = Series {
            title: "Orientation histogram",
            x_label: "gradient direction, degrees",
            y_label: "weight",
            x_max: 350,
            lines: vec![
                ("before smoothing", Role::Rejected, points(&histogram.raw)),
                ("smoothed", Role::Result, points(&histogram.bins)),
            ],
            thresholds: vec![("80 % of the highest".to_owned(), PEAK_RATIO * histogram.highest())],
            is_sweep: true,
            ..Series::default()
        };
        let patch = self.patch(state, refined);
        vec![Readout::Series(series), Readout::Tiles(vec![patch])]
    }

    /// The Gaussian image around a keypoint.
    fn patch(&self, state: &State, refined: &Refined) -> Tile {
        let Extremum { octave, level, x, y } = refined.at;
        let image = &state.space.octaves[octave].gaussians[level];
        let values = explain::around(image, (x, y), 8);
        Tile { label: "Gaussian image", role: None, values, range: [0.0, 255.0], framed: Vec::new() }
    }

    fn descriptor_readouts(&self, seen: &Seen<Self>, event: Event) -> Vec<Readout> {
        let state = seen.before;
        let Some(oriented) = state.oriented.get(state.next) else { return Vec::new() };
        let raw = self.gathered(&state.space, oriented);
        let (shown, label, filled) = match event {
            Event::Cell(cell) => (raw, "weight", cell + 1),
            Event::Normalised => (raw.normalised(), "entry of length 1", CELLS),
            _ => (raw.finished(), "entry of length 1", CELLS),
        };
        let (at, sigma_px) = self.in_frame(&oriented.refined);
        let facts = vec![
            Fact::new("Keypoint", format!("{} of {}", state.next + 1, state.oriented.len()), None),
            Fact::new("Position", format!("{} px", words::place(at)), Some(Role::Reference)),
            Fact::new("σ in px of the frame", gray(sigma_px), None),
            Fact::new("Orientation", format!("{}°", words::fixed(oriented.angle_rad.to_degrees().into(), 1)), None),
        ];
        let series = descriptor_series(&shown, label, filled, matches!(event, Event::Normalised));
        vec![Readout::Facts(facts), Readout::Series(series), Readout::Tiles(vec![self.patch(state, &oriented.refined)])]
    }
}

/// The 3 × 3 × 3 neighbourhood of a pixel, as three tiles.
fn neighbourhood(around: &Around) -> Vec<Tile> {
    let place = (around.at.x, around.at.y);
    let labels = ["D, smaller scale", "D, this scale", "D, larger scale"];
    let values = around.differences.map(|difference| explain::around(difference, place, 1));
    let most = values.iter().flat_map(|grid| grid.cells()).fold(0.0f32, |most, v| most.max(v.abs())).max(1.0);
    let tile = |(label, values)| Tile { label, role: None, values, range: [-most, most], framed: Vec::new() };
    labels.into_iter().zip(values).map(tile).collect()
}

/// The 128 entries of a descriptor, those of the first `filled` cells.
fn descriptor_series(descriptor: &Descriptor, y_label: &'static str, filled: usize, shows_clamp: bool) -> Series {
    let points = Series::bars(descriptor.0.iter().take(filled * BINS).copied());
    Series {
        title: "Descriptor",
        x_label: "entry: 8 directions of each of 16 cells",
        y_label,
        x_max: CELLS * BINS,
        x_ticks: (0..=SIDE).map(|row| (row * SIDE * BINS).max(1) as f32).collect(),
        sections: Series::cells(SIDE, BINS),
        lines: vec![("entries", Role::Result, points)],
        thresholds: if shows_clamp { vec![("limit".to_owned(), CLAMP)] } else { Vec::new() },
        is_sweep: true,
        ..Series::default()
    }
}

/// The drawing.
impl Sift {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        match seen.before.stage {
            Stage::Space => self.draw_space(seen, scene),
            Stage::Extrema => self.draw_extrema(seen, scene),
            Stage::Refinement => self.draw_refinement(seen, scene),
            Stage::Orientation => self.draw_orientation(seen, scene),
            Stage::Selection | Stage::Description => self.draw_description(seen, scene),
        }
    }

    fn circle(&self, refined: &Refined) -> Shape {
        let (center, sigma_px) = self.in_frame(refined);
        Shape::Ellipse { center, radii: [BLOB_RADIUS * sigma_px; 2], angle_rad: 0.0 }
    }

    fn point_of(&self, at: &Extremum) -> [f32; 2] {
        let size = self.shape().pixel_px(at.octave);
        [at.x as f32 * size, at.y as f32 * size]
    }

    fn draw_extrema(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let Some(Row { octave, level, y }) = self.current_row(state) else { return };
        self.show_difference(state, (octave, level), scene);
        let in_row = seen.events.iter().filter_map(|event| match event {
            Event::Extremum(x) => Some(Extremum { octave, level, x: *x, y }),
            _ => None,
        });
        let points: Vec<_> = state.extrema.iter().copied().chain(in_row).map(|at| self.point_of(&at)).collect();
        let size = self.shape().pixel_px(octave);
        let row = (y as f32 * size, state.picture.size().0 as f32);
        let ends = vec![[-0.5, row.0], [row.1 - 0.5, row.0]];
        scene.mark(Picture::RESPONSE, Role::Window, Shape::Path { points: ends, closed: false });
        scene.legend(Role::Window, "row searched");
        if !points.is_empty() {
            scene.mark(Picture::RESPONSE, Role::Candidate, Shape::Points(points));
            scene.legend(Role::Candidate, "extremum in position and scale");
        }
        if let Some(Event::Extremum(x)) = seen.events.last() {
            let at = Extremum { octave, level, x: *x, y };
            let found = Refined { at, offset: [0.0; 3], response: 0.0 };
            scene.mark(Picture::RESPONSE, Role::Best, self.circle(&found));
            scene.legend(Role::Best, "extremum of this step, radius √2 σ");
        }
        if let Some(around) = seen.point().and_then(|point| self.pointed_at(state, point)) {
            let [x, y] = self.point_of(&around.at);
            let reach = [1.5 * size; 2];
            let square = Shape::Rect { min: [x - reach[0], y - reach[1]], max: [x + reach[0], y + reach[1]] };
            scene.mark(Picture::RESPONSE, Role::Reference, square);
        }
    }

    fn draw_refinement(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        if let Some(at) = state.extrema.get(state.next) {
            self.show_difference(state, (at.octave, at.level), scene);
        }
        let waiting: Vec<_> = state.extrema[state.next..].iter().map(|at| self.point_of(at)).collect();
        if !waiting.is_empty() {
            scene.mark(Picture::RESPONSE, Role::Candidate, Shape::Points(waiting));
            scene.legend(Role::Candidate, "extremum in position and scale");
        }
        self.draw_circles(Picture::RESPONSE, state.refined.iter(), scene);
        if let Some(last) = last_iteration(seen) {
            let verdict = seen.events.iter().find_map(|event| match event {
                Event::Verdict(verdict) => Some(*verdict),
                _ => None,
            });
            let shown = Refined { at: last.at, offset: last.offset.map(|c| c.clamp(-2.0, 2.0)), response: 0.0 };
            let role = match verdict {
                None => Role::Reference,
                Some(Ok(_)) => Role::Best,
                Some(Err(_)) => Role::Rejected,
            };
            scene.mark(Picture::RESPONSE, role, self.circle(&shown));
            scene.legend(
                role,
                match verdict {
                    None => "candidate being refined",
                    Some(Ok(_)) => "kept",
                    Some(Err(_)) => "rejected",
                },
            );
        }
    }

    fn draw_circles<'a>(&self, on: Picture, all: impl Iterator<Item = &'a Refined>, scene: &mut Scene) {
        let mut is_any = false;
        for refined in all {
            scene.mark(on, Role::Result, self.circle(refined));
            is_any = true;
        }
        if is_any {
            scene.legend(Role::Result, "keypoint, radius √2 σ");
        }
    }

    fn draw_orientation(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
        self.draw_circles(Picture::CURRENT, state.refined.iter(), scene);
        let Some(refined) = state.refined.get(state.next) else { return };
        let (center, _) = self.in_frame(refined);
        let pixel_px = self.shape().pixel_px(refined.at.octave);
        let radius = Histogram::radius_px(self.sigma_in_octave(refined)) as f32 * pixel_px;
        let window = Shape::Ellipse { center, radii: [radius; 2], angle_rad: 0.0 };
        scene.mark(Picture::CURRENT, Role::Window, window);
        scene.legend(Role::Window, "window of the histogram");
        let peaks = seen.events.iter().filter_map(|event| match event {
            Event::Peak(peak) => Some(peak.angle_rad),
            _ => None,
        });
        let arrows: Vec<Arrow> = peaks.map(|angle| arrow(center, angle, radius)).collect();
        if !arrows.is_empty() {
            scene.mark(Picture::CURRENT, Role::Best, Shape::Arrows(arrows));
            scene.legend(Role::Best, "orientation");
        }
    }

    fn draw_description(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, is_end) = (seen.before, seen.after.is_some_and(|after| is_over(self, after)));
        let shown = if state.stage == Stage::Selection { seen.after.unwrap_or(state) } else { state };
        let refined: Vec<Refined> = shown.oriented.iter().map(|oriented| oriented.refined).collect();
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
        self.draw_circles(Picture::CURRENT, refined.iter(), scene);
        let radii = shown.oriented.iter().map(|oriented| {
            let (center, sigma_px) = self.in_frame(&oriented.refined);
            arrow(center, oriented.angle_rad, BLOB_RADIUS * sigma_px)
        });
        for Arrow { from, to } in radii {
            scene.mark(Picture::CURRENT, Role::Result, Shape::Path { points: vec![from, to], closed: false });
        }
        let current = state.oriented.get(state.next).filter(|_| state.stage == Stage::Description && !is_end);
        if let Some(oriented) = current {
            self.draw_window(seen, oriented, scene);
        }
    }

    /// The rotated grid of cells, each filled one with the directions of its histogram.
    fn draw_window(&self, seen: &Seen<Self>, oriented: &Oriented, scene: &mut Scene) {
        let (place, pixel_px) = (self.place(oriented), self.shape().pixel_px(oriented.refined.at.octave));
        let at = |cells: [f32; 2]| place.at_cells(cells).map(|c| c * pixel_px);
        let half = SIDE as f32 / 2.0;
        for i in 0..=SIDE {
            let k = i as f32 - half;
            for ends in [[[-half, k], [half, k]], [[k, -half], [k, half]]] {
                let points = ends.map(at).to_vec();
                scene.mark(Picture::CURRENT, Role::Window, Shape::Path { points, closed: false });
            }
        }
        scene.legend(Role::Window, "cells of the descriptor");
        scene.work = Some(around_all([[-half, -half], [half, -half], [half, half], [-half, half]].map(at)));
        let filled = seen.events.iter().filter(|event| matches!(event, Event::Cell(_))).count();
        let entries = self.gathered(&seen.before.space, oriented).0;
        let most = entries.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let cell_px = place.cell_px() * pixel_px;
        let mut arrows = Vec::new();
        for cell in 0..filled {
            let middle = at([(cell % SIDE) as f32 + 0.5 - half, (cell / SIDE) as f32 + 0.5 - half]);
            for bin in 0..BINS {
                let angle = place.angle_rad + bin as f32 * std::f32::consts::FRAC_PI_4;
                arrows.push(arrow(middle, angle, 0.5 * cell_px * entries[cell * BINS + bin] / most));
            }
        }
        if !arrows.is_empty() {
            let rays =
                arrows.into_iter().map(|Arrow { from, to }| Shape::Path { points: vec![from, to], closed: false });
            rays.for_each(|ray| scene.mark(Picture::CURRENT, Role::Best, ray));
            scene.legend(Role::Best, "weights of the 8 directions of a cell");
        }
    }
}

/// The smallest rectangle around corners, as min and max.
fn around_all(corners: [[f32; 2]; 4]) -> [[f32; 2]; 2] {
    let along = |i: usize, pick: fn(f32, f32) -> f32| corners.iter().map(|at| at[i]).fold(corners[0][i], pick);
    [f32::min, f32::max].map(|pick| [along(0, pick), along(1, pick)])
}

/// An arrow from a point in a direction.
fn arrow(from: [f32; 2], angle_rad: f32, length: f32) -> Arrow {
    let (sin, cos) = angle_rad.sin_cos();
    Arrow { from, to: [from[0] + length * cos, from[1] + length * sin] }
}
