//! The steps of a background subtraction in words, numbers and marks.

use std::sync::Arc;

use super::declare::line;
use super::exposure::Transfer;
use super::{Background, Channel, Conclusion, Event, Explanation, FrameComparison, Initial, Past, State, Subtraction};
use crate::base::words::{self, capital, counted as count, grouped, pixel};
use crate::data::{Detection, Frame, Mask, MaskErrors};
use crate::methods::differential::explain;
use crate::methods::numbers::{fixed, percent};
use crate::products::{Record, objects::score::Matches};
use crate::run::{Seen, Span};
use crate::scene::{Fact, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

/// Radius of the tiles around the explained pixel, in px.
const TILE_REACH_PX: usize = 4;

/// The share of the picture that differs from the background where the camera or the light has changed, not objects.
const FLOODED: f64 = 0.3;
/// That share where the camera is known to have moved.
const FLOODED_BY_MOTION: f64 = 0.15;

/// From this F₁ score on the errors are too few for advice.
const GOOD_F1: f64 = 0.9;

/// The masks and components of a frame up to a step.
pub(crate) struct MaskHistory<'a> {
    events: &'a [Event],
}

/// A number of pixels with its unit.
fn pixels(count: usize) -> String {
    format!("{} px", grouped(count))
}

/// A radius as the side of its square structuring element.
fn square(radius: usize) -> String {
    format!("{0}×{0} square", 2 * radius + 1)
}

impl<'a> MaskHistory<'a> {
    pub(crate) fn new(events: &'a [Event]) -> Self {
        Self { events }
    }

    fn frame(&self) -> Option<&'a Arc<Frame>> {
        self.events.iter().find_map(|event| match event {
            Event::Begun(frame) | Event::Registered(frame) | Event::Compared(frame, _) => Some(frame),
            _ => None,
        })
    }

    /// The frame before its exposure was corrected, and the transfer to it.
    fn exposed(&self) -> Option<(&'a Frame, &'a Transfer)> {
        self.events.iter().find_map(|event| match event {
            Event::Exposed(frame, transfer) => Some((&**frame, &**transfer)),
            _ => None,
        })
    }

    /// The shift of the model with the camera in px.
    fn shift(&self) -> [f32; 2] {
        let by = self.events.iter().find_map(|event| if let Event::Followed(by, _) = event { Some(*by) } else { None });
        by.unwrap_or_default()
    }

    /// The masks so far, the last one last.
    fn masks(&self) -> impl DoubleEndedIterator<Item = &'a Arc<Mask>> {
        self.events.iter().filter_map(|event| match event {
            Event::Decided(mask)
            | Event::Shadows(mask, _)
            | Event::Steadied(mask, _)
            | Event::Opened(mask)
            | Event::Closed(mask) => Some(mask),
            _ => None,
        })
    }

    /// The last mask and the one before it, that one first.
    fn change(&self) -> Option<[&'a Arc<Mask>; 2]> {
        let mut masks = self.masks().rev();
        let after = masks.next()?;
        Some([masks.next()?, after])
    }

    fn kept(&self) -> Option<&'a [Vec<Detection>; 2]> {
        self.events.iter().find_map(|event| if let Event::Kept(blobs) = event { Some(&**blobs) } else { None })
    }

    /// The effect of each stage after the threshold on a pixel, and that of the last stage in any case.
    fn of_pixel(&self, (x, y): (usize, usize)) -> Sentence {
        let mut said = Sentence::default();
        let mut was_set = false;
        for (i, event) in self.events.iter().enumerate() {
            let is_last = i + 1 == self.events.len();
            said = match event {
                Event::Shadows(_, shadows) if shadows.get(x, y) => {
                    said.text(" It is a ").ink(Role::Rejected, "cast shadow").text(" and removed from the mask.")
                }
                Event::Shadows(..) if is_last => said.text(" It is not a shadow."),
                Event::Steadied(_, displaced) if displaced.get(x, y) => said
                    .text(" The background of a neighbour explains it: ")
                    .ink(Role::Rejected, "displaced background")
                    .text(", removed from the mask."),
                Event::Steadied(..) if is_last => said.text(match was_set {
                    true => " The background of no neighbour explains it.",
                    false => " Shake suppression does not change it.",
                }),
                Event::Opened(mask) if was_set && !mask.get(x, y) => {
                    said.text(" Opening ").ink(Role::Rejected, "removes").text(" it.")
                }
                Event::Opened(_) if is_last => said.text(" Opening does not change it."),
                Event::Closed(mask) if !was_set && mask.get(x, y) => {
                    said.text(" Closing ").ink(Role::Estimate, "fills").text(" it.")
                }
                Event::Closed(_) if is_last => said.text(" Closing does not change it."),
                Event::Labelled(labels, _) if labels[(x, y)] > 0 => said
                    .text(format!(" It belongs to component {}", labels[(x, y)]))
                    .text(match self.kept().map(|[_, dropped]| dropped.iter().any(|d| label(d) == labels[(x, y)])) {
                        None => ".",
                        Some(true) => ", which is rejected: its area is below the minimum area.",
                        Some(false) => ", which becomes a blob.",
                    }),
                Event::Labelled(..) if is_last => said.text(" It belongs to no component."),
                Event::Kept(_) if is_last && !was_set => said.text(" It belongs to no blob."),
                _ => said,
            };
            if let Event::Decided(mask)
            | Event::Shadows(mask, _)
            | Event::Steadied(mask, _)
            | Event::Opened(mask)
            | Event::Closed(mask) = event
            {
                was_set = mask.get(x, y);
            }
        }
        said
    }

    /// The result of the last stage, given the radii of opening and closing and the minimum area.
    pub(crate) fn sentence(&self, settings: super::Settings, picture: (usize, usize)) -> Option<Sentence> {
        let (said, least_area) = (Sentence::default(), settings.least_area(picture));
        let [gone, new] = self
            .change()
            .map_or([0, 0], |[before, after]| [before.without(after).count(), after.without(before).count()]);
        Some(match self.events.last()? {
            Event::Opened(_) => {
                let opening = format!("Opening (erosion, then dilation with a {})", square(settings.opening));
                let [how, which] = match (settings.opening, settings.area_opening) {
                    (0, least) => [
                        "Area opening".to_owned(),
                        format!(
                            "components of fewer than {}, which are too small to be told from noise",
                            pixels(least)
                        ),
                    ],
                    (_, 0 | 1) => [opening, "regions narrower than the square".into()],
                    (_, least) => [
                        format!("{opening} and area opening"),
                        format!("regions narrower than the square and components of fewer than {}", pixels(least)),
                    ],
                };
                said.text(format!("{how} removed ")).ink(Role::Rejected, pixels(gone)).text(format!(" in {which}."))
            }
            Event::Closed(_) => said
                .text(format!("Closing (dilation, then erosion with a {}) filled ", square(settings.closing)))
                .ink(Role::Estimate, pixels(new))
                .text(" in gaps narrower than the square."),
            Event::Labelled(_, all) => said
                .text("Labelling with ")
                .text(format!("{}-connectivity finds ", settings.connectivity.label()))
                .ink(Role::Candidate, count(*all as usize, "connected component"))
                .text("."),
            Event::Kept(blobs) => {
                let [kept, dropped] = &**blobs;
                said.ink(Role::Result, count(kept.len(), "blob"))
                    .text(format!(" with at least {}; ", pixels(least_area)))
                    .ink(Role::Rejected, count(dropped.len(), "smaller component"))
                    .text(" rejected as noise.")
            }
            _ => return None,
        })
    }

    /// The numbers of the frame so far.
    pub(crate) fn facts(&self) -> Vec<Fact> {
        let mut facts = Vec::new();
        for event in self.events {
            facts.extend(match event {
                Event::Decided(mask) => {
                    Some(Fact::new("Foreground by the threshold", pixels(mask.count()), Some(Role::Candidate)))
                }
                Event::Shadows(_, mask) => Some(Fact::new("Shadows", pixels(mask.count()), Some(Role::Rejected))),
                Event::Followed(_, [x, y]) => {
                    let moved = format!("{}, {} px", fixed(f64::from(*x), 2), fixed(f64::from(*y), 2));
                    Some(Fact::new("Camera displacement", moved, Some(Role::Reference)))
                }
                Event::Exposed(_, transfer) => {
                    let change = format!("{} gray levels", signed(transfer.median));
                    Some(Fact::new("Change of exposure", change, Some(Role::Reference)))
                }
                Event::Steadied(_, mask) => {
                    Some(Fact::new("Displaced background", pixels(mask.count()), Some(Role::Rejected)))
                }
                Event::Opened(mask) => Some(Fact::new("After opening", pixels(mask.count()), None)),
                Event::Closed(mask) => Some(Fact::new("After closing", pixels(mask.count()), None)),
                Event::Labelled(_, count) => Some(Fact::new("Components", count.to_string(), None)),
                Event::Kept(blobs) => Some(Fact::new("Blobs", blobs[0].len().to_string(), Some(Role::Result))),
                Event::Updated(conclusion) => {
                    let scored = |all: Matches| {
                        let [precision, recall, f1] = scores(all);
                        Fact::new(
                            "Box precision, recall, F₁",
                            format!("{precision}, {recall}, {f1}"),
                            Some(Role::Truth),
                        )
                    };
                    conclusion.run.or(conclusion.frame).map(scored)
                }
                _ => None,
            });
        }
        if let Some(Event::Updated(conclusion)) = self.events.last() {
            facts.extend(conclusion.pixels().map(|all| {
                let [precision, recall, f1] = scores(all);
                let values = format!("{precision}, {recall}, {f1}");
                Fact::new("Mask precision, recall, F₁", values, Some(Role::Truth))
            }));
        }
        facts
    }

    /// Draws the result of the last stage.
    pub(crate) fn draw(&self, scene: &mut Scene) {
        let [gone, new] = match self.change() {
            Some([before, after]) => {
                [before.without(after), after.without(before)].map(|m| (m.count() > 0).then_some(m))
            }
            None => [None, None],
        };
        match self.events.last() {
            Some(Event::Opened(mask)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                gone.into_iter().for_each(|gone| layer(scene, Role::Rejected, "removed by opening", Arc::new(gone)));
            }
            Some(Event::Closed(mask)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                new.into_iter().for_each(|new| layer(scene, Role::Estimate, "filled by closing", Arc::new(new)));
            }
            Some(Event::Labelled(labels, _)) => {
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Labels(Arc::clone(labels)));
                scene.legend(Role::Candidate, "connected components, one colour each");
            }
            Some(Event::Kept(blobs)) => {
                draw_blobs(scene, &blobs[1], (Role::Rejected, "below the minimum area"));
                draw_blobs(scene, &blobs[0], (Role::Result, "blob"));
                draw_shapes(scene, &blobs[0]);
            }
            _ => {}
        }
    }
}

/// Precision, recall and F₁ score as text.
fn scores(all: Matches) -> [String; 3] {
    [all.precision(), all.recall(), all.f1()].map(|share| Matches::text(share, 2))
}

impl Conclusion {
    /// The pixels of all masks compared with the truth at the end of the run, of this one before.
    fn pixels(&self) -> Option<Matches> {
        self.run_pixels.or_else(|| self.errors.as_ref().map(Matches::of_pixels))
    }

    /// The quality of the mask against the true foreground.
    fn of_mask(&self) -> String {
        let Some(all) = self.pixels() else { return String::new() };
        if self.run_pixels.is_none() && self.errors.as_ref().is_some_and(|errors| errors.labelled == 0) {
            return " The ground truth labels no pixel of this frame, so its mask is not scored.".to_owned();
        }
        if all.f1().is_none() {
            return " Neither the mask nor the ground truth has foreground in labelled pixels, so there is no F₁."
                .to_owned();
        }
        let [precision, recall, f1] = scores(all);
        let which = if self.run_pixels.is_some() { "Pixels of all masks" } else { "Its mask" };
        let errors = match [all.false_positives(), all.misses()] {
            [0, 0] => "no errors".to_owned(),
            [alarms, misses] => format!("{} of false alarms, {} missed", pixels(alarms), pixels(misses)),
        };
        format!(" {which} against the true foreground: precision {precision}, recall {recall}, F₁ {f1}; {errors}.")
    }

    /// The result of the frame, its score, the likely cause of its errors and the parameters that reduce them.
    fn sentence(&self, t: usize, flooded: [&str; 2]) -> String {
        let blobs = count(self.blobs, "blob");
        let camera = self.of_camera(flooded);
        let Some(frame) = self.frame else {
            let mask = self.of_mask();
            return format!(" Frame {t}: {blobs}, {} of foreground.{mask}{camera}", pixels(self.foreground));
        };
        let (of, all) = match self.run {
            Some(run) => ("Run", run),
            None => ("Frame", frame),
        };
        let [precision, recall, f1] = scores(all);
        let score = match self.run {
            Some(_) => {
                format!(" {of} against the ground truth (IoU ≥ 0.5): precision {precision}, recall {recall}, F₁ {f1}.")
            }
            None => format!(
                " {of} {t}: {blobs} for {}; precision {precision}, recall {recall}, F₁ {f1} at IoU ≥ 0.5.",
                count(frame.truths, "true object")
            ),
        };
        let mask = self.of_mask();
        if camera.is_empty() {
            format!("{score}{mask}{}", self.advice(all, flooded[1]))
        } else {
            format!("{score}{mask}{camera}")
        }
    }

    /// The displacement of the background since the first frame in px, where the camera is known to have moved.
    fn camera_moved(&self) -> Option<[f32; 2]> {
        self.camera.filter(|by| by[0].hypot(by[1]) > 1.0)
    }

    /// A flooded mask with its cause, and what to use instead.
    fn of_camera(&self, [cause, advice]: [&str; 2]) -> String {
        let by = self.camera_moved();
        if self.differing < if by.is_some() { FLOODED_BY_MOTION } else { FLOODED } {
            return String::new();
        }
        let moved = by.map_or_else(String::new, |by| {
            format!(" The background is displaced by {} px since the first frame.", words::place(by))
        });
        format!(" {} of the frame differs from the background: {cause}.{moved} {advice}", percent(self.differing))
    }

    /// What to change, by the errors of the mask where its truth is known, otherwise by those of the boxes: a box that overlaps a true one
    /// by too little is a miss and a false alarm, whatever the threshold is. `instead` names what to use where the camera moves.
    fn advice(&self, boxes: Matches, instead: &str) -> String {
        if self.ghosts > 0 {
            return format!(
                " {} where an object of the first frame has left: initialise with the median, or let the model learn faster.",
                counted(self.ghosts, ["ghost remains", "ghosts remain"])
            );
        }
        let masks = self.pixels();
        let all = masks.unwrap_or(boxes);
        let number = |count| if masks.is_some() { pixels(count) } else { grouped(count) };
        let (misses, alarms) = (all.misses(), all.false_positives());
        let is_good = |matches: Matches| matches.f1().is_none_or(|f1| f1 >= GOOD_F1);
        match () {
            () if masks.is_some() && is_good(all) && !is_good(boxes) => {
                let why = match boxes.false_positives() {
                    0 => {
                        "objects without a box may be mostly hidden, joined to another or smaller than the minimum area"
                    }
                    _ if boxes.estimates > boxes.truths => {
                        "there are more blobs than objects, so objects may be split into parts: a larger closing may join them"
                    }
                    _ if boxes.estimates < boxes.truths => {
                        "there are fewer blobs than objects, so blobs may join objects that touch or hide each other"
                    }
                    _ => {
                        "the wrong boxes are blobs that join or split objects, or shapes that overlap their box by less than half"
                    }
                };
                format!(" The masks agree with the truth; {why}.")
            }
            () if is_good(all) || misses + alarms == 0 => String::new(),
            () if misses > alarms => format!(
                " Most errors are misses ({}): try a lower threshold, a smaller opening or a smaller minimum area.",
                number(misses)
            ),
            () if misses < alarms => match self.camera_moved() {
                // Neither a threshold nor an opening registers the frames.
                Some(by) => format!(
                    " Most errors are false alarms ({}), and the camera moves: the background is displaced by {} px since the first frame. \
                     A shift follows it only roughly, so edges of the background remain as foreground. {instead}",
                    number(alarms),
                    words::place(by)
                ),
                None => format!(
                    " Most errors are false alarms ({}): try a higher threshold, a larger opening or a larger minimum area.",
                    number(alarms)
                ),
            },
            () => format!(
                " {} and {}.",
                counted(misses, ["miss", "misses"]),
                counted(alarms, ["false alarm", "false alarms"])
            ),
        }
    }
}

/// A change of the gray level in words.
fn brighter(change: f32) -> String {
    let by = fixed(f64::from(change.abs()), 1);
    format!("{by} gray levels {}", if change > 0.0 { "brighter" } else { "darker" })
}

/// The change of dark and of bright pixels, where it differs.
fn by_level(transfer: &Transfer) -> String {
    let [dark, bright] = [64.0, 192.0].map(|level| transfer.change(level));
    if (dark - bright).abs() < 1.0 {
        return String::new();
    }
    format!(" ({} at level 64, {} at level 192)", signed(dark), signed(bright))
}

/// A change with its sign.
fn signed(change: f32) -> String {
    let sign = if change < 0.0 { "−" } else { "+" };
    format!("{sign}{}", fixed(f64::from(change.abs()), 1))
}

/// A count with its noun in the singular or plural.
fn counted(count: usize, [one, many]: [&str; 2]) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

fn label(detection: &Detection) -> u32 {
    detection.blob.map_or(0, |blob| blob.label)
}

fn layer(scene: &mut Scene, role: Role, meaning: &'static str, mask: Arc<Mask>) {
    scene.mark(Picture::CURRENT, role, Shape::Mask(mask));
    scene.legend(role, meaning);
}

/// Draws a mask compared with the true foreground.
fn draw_errors(scene: &mut Scene, errors: &MaskErrors) {
    layer(scene, Role::Estimate, "correct foreground", Arc::new(errors.correct.clone()));
    layer(scene, Role::Error, "false alarm", Arc::new(errors.false_positives.clone()));
    layer(scene, Role::Truth, "missed", Arc::new(errors.misses.clone()));
}

/// Draws bounding boxes.
pub(crate) fn draw_blobs(scene: &mut Scene, blobs: &[Detection], (role, meaning): (Role, &'static str)) {
    for blob in blobs {
        scene.mark(Picture::CURRENT, role, Shape::Rect { min: blob.bounds.min, max: blob.bounds.max });
    }
    scene.legend(role, meaning);
}

/// Draws centroids, ellipses and labels.
fn draw_shapes(scene: &mut Scene, blobs: &[Detection]) {
    for Detection { bounds, center, blob, .. } in blobs {
        let Some(blob) = blob else { continue };
        let ellipse = Shape::Ellipse { center: *center, radii: blob.radii, angle_rad: blob.angle_rad };
        scene.mark(Picture::CURRENT, Role::Estimate, ellipse);
        scene.legend(Role::Estimate, "ellipse of equal second moments");
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Points(vec![*center]));
        scene.legend(Role::Measured, "centroid");
        let text = Shape::Text { at: bounds.min, text: format!("{}: {}", blob.label, pixels(blob.area_px as usize)) };
        scene.mark(Picture::CURRENT, Role::Result, text);
    }
}

/// Plots of the foreground pixels and of the blobs of each frame.
pub(crate) fn plots(record: &Record, span: &Span) -> Vec<Readout> {
    let (frames, pixels) = (record.frames(), record.pixels());
    let line = |of: &dyn Fn(usize) -> f32| (0..frames.len()).map(|i| [(span.first + i) as f32, of(i)]).collect();
    let series = |title, y_label, name, line| Series {
        title,
        x_label: "frame",
        y_label,
        x_max: span.first + span.frames().unwrap_or(frames.len()) - 1,
        lines: vec![(name, Role::Result, line)],
        ..Series::default()
    };
    if frames.len() < 2 {
        return Vec::new();
    }
    vec![
        Readout::Series(series("Foreground of the final mask", "px", "foreground pixels", line(&|i| pixels[i] as f32))),
        Readout::Series(series("Blobs", "number of blobs", "blobs", line(&|i| frames[i].detections.len() as f32))),
    ]
}

/// The names of the tiles of the frame and of the background.
fn tile_labels(channel: Channel) -> [&'static str; 2] {
    match channel {
        Channel::Gray => ["Frame t", "Background"],
        Channel::Color(0) => ["Frame t, red", "Background, red"],
        Channel::Color(1) => ["Frame t, green", "Background, green"],
        Channel::Color(_) => ["Frame t, blue", "Background, blue"],
    }
}

/// The line of pseudocode of an event.
pub(super) fn stage(event: &Event) -> Name {
    match event {
        Event::Begun(_) => line::BEGIN_MODEL,
        Event::Followed(..) => line::FOLLOW_CAMERA,
        Event::Exposed(..) => line::CORRECT_EXPOSURE,
        Event::Steadied(..) => line::SUPPRESS_SHAKE,
        Event::Registered(_) => line::REGISTER,
        Event::Compared(..) => line::COMPARE,
        Event::Decided(_) => line::DECIDE,
        Event::Shadows(..) => line::REMOVE_SHADOWS,
        Event::Opened(_) => line::OPEN,
        Event::Closed(_) => line::CLOSE,
        Event::Labelled(..) => line::LABEL,
        Event::Kept(_) => line::KEEP_BLOBS,
        Event::Updated(_) => line::UPDATE_MODEL,
    }
}

impl<M: Background> Subtraction<M> {
    pub(super) fn explained_step(&self, seen: &Seen<Self>) -> Step {
        let line = seen.events.last().map_or(line::BEGIN_MODEL, stage);
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    /// The pixel that is pointed at, with its explanation.
    fn explanation(&self, seen: &Seen<Self>) -> Option<((usize, usize), Explanation)> {
        let frame = MaskHistory::new(seen.events).frame()?;
        let place = frame.luma().cell_at(seen.point()?)?;
        Some((place, self.explained_at(seen, frame, place)))
    }

    /// The model that the frame is compared with: that of the state before, shifted with the camera.
    fn compared_model(&self, seen: &Seen<Self>) -> Option<Arc<M::Model>> {
        let (model, history) = (seen.before.model.as_ref()?, MaskHistory::new(seen.events));
        Some(match (history.shift(), history.frame()) {
            ([0.0, 0.0], _) | (_, None) => Arc::clone(model),
            (by, Some(frame)) => Arc::new(self.0.moved(model, by, frame)),
        })
    }

    /// The frames up to that of the step.
    fn past(&self, seen: &Seen<Self>) -> Past {
        let now: &State<_> = seen.after.unwrap_or(seen.before);
        let at = now.camera.as_ref().map_or([0.0; 2], |camera| camera.model_at);
        let span = seen.before.span.until(seen.before.frame + 1);
        Past { clip: seen.clip.clone(), span, steady: self.0.steadiness(), at }
    }

    fn explained_at(&self, seen: &Seen<Self>, frame: &Frame, place: (usize, usize)) -> Explanation {
        let before = self.compared_model(seen);
        let before = before.as_deref();
        let after = seen.after.and_then(|after| after.model.as_deref());
        self.0.explain([before, after], frame, place)
    }

    /// The comparison of the whole frame, once it is done.
    fn comparison(&self, seen: &Seen<Self>) -> Option<FrameComparison> {
        let frame = seen.events.iter().find_map(|event| match event {
            Event::Registered(frame) | Event::Compared(frame, _) => Some(frame),
            _ => None,
        })?;
        self.0.comparison(seen.before.model.as_deref()?, frame)
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (said, number) = (Sentence::default(), seen.before.frame);
        let history = MaskHistory::new(seen.events);
        let Some(event) = seen.events.last() else {
            let reference = if self.0.get("initial").is_ok() { "a background model" } else { "the previous frame" };
            return said.text(format!(
                "Each pixel is compared with {reference}; a large {} is foreground. Opening, closing and connected components \
                 turn the mask into blobs.",
                M::COMPARED
            ));
        };
        if let Event::Updated(conclusion) = event {
            return self.updated(seen, conclusion);
        }
        let is_decided =
            !matches!(event, Event::Begun(_) | Event::Exposed(..) | Event::Registered(_) | Event::Compared(..));
        if let Some((place, Explanation { verdict, .. })) = self.explanation(seen).filter(|_| is_decided) {
            let mut all = said.ink(Role::Reference, format!("Pixel {}", pixel(place)));
            all.0.extend(verdict.0);
            all.0.extend(history.of_pixel(place).0);
            return all;
        }
        match event {
            Event::Begun(_) => said.text(match (self.0.get("initial").is_ok(), self.0.initial()) {
                (false, _) => format!("Frame {number} is the reference of frame {}.", number + 1),
                (true, Initial::FirstFrame) => format!(
                    "Frame {number} initialises the background model. Objects in it will leave ghosts: false foreground until \
                     the model has learned the background behind them."
                ),
                (true, Initial::Median) => format!(
                    "The median of frames spread evenly up to frame {} initialises the background model. An object that covers \
                     a pixel in fewer than half of these frames leaves no ghost.",
                    number + seen.before.span.frames().unwrap_or(1) - 1
                ),
            }),
            Event::Followed(by, at) => said
                .text("The camera has moved. The median displacement of textured blocks since the first frame is ")
                .ink(Role::Reference, format!("{} px", words::place(*at)))
                .text(format!(
                    ". From its position in the previous frame the model is shifted by {} px{}.",
                    words::place(*by),
                    if M::IS_REPLACED { "" } else { ", in whole px" }
                )),
            Event::Exposed(_, transfer) => said
                .text("The exposure has changed: most pixels are ")
                .ink(Role::Reference, brighter(transfer.median))
                .text(" than the background")
                .text(by_level(transfer))
                .text(". The frame is corrected for it."),
            Event::Registered(_) => self.comparison(seen).map_or(said, |whole| whole.sentence),
            Event::Compared(..) => said.text(format!(
                "{} at each pixel of frame {number}. The heat map shows {}.",
                capital(M::COMPARED),
                M::SHOWN
            )),
            Event::Decided(mask) => {
                let share = mask.count() as f64 / (mask.width() * mask.height()).max(1) as f64;
                said.ink(Role::Candidate, format!("{} of foreground", pixels(mask.count())))
                    .text(format!(" ({} of the frame): {}.", percent(share), self.0.rule()))
            }
            Event::Shadows(_, shadows) => said
                .ink(Role::Rejected, format!("Cast shadows: {} of the foreground", pixels(shadows.count())))
                .text(", darker than the background, but of the same colour, and not enclosed by foreground. They are removed."),
            Event::Steadied(_, displaced) => said
                .ink(Role::Rejected, format!("{} of the foreground fit", pixels(displaced.count())))
                .text(format!(
                    " the background of a pixel within shake = {} px: the camera has displaced it. They are removed.",
                    self.0.steadiness().map_or(0, |steady| steady.shake)
                )),
            _ => history.sentence(self.0.settings(), seen.before.picture).unwrap_or(said),
        }
    }

    /// The update of the model at the pixel that is pointed at, else at that of the largest difference, and the conclusion. The end of a
    /// run with ground truth is about its result alone, unless a pixel is pointed at.
    fn updated(&self, seen: &Seen<Self>, conclusion: &Conclusion) -> Sentence {
        let said = Sentence::default();
        let compared = seen.events.iter().find_map(|event| match event {
            Event::Compared(frame, difference) => Some((frame, difference)),
            _ => None,
        });
        let Some((frame, difference)) = compared else { return said };
        let pointed = seen.point().and_then(|point| frame.luma().cell_at(point));
        let result = conclusion.sentence(seen.before.frame, M::FLOODED);
        if pointed.is_none() && conclusion.run.is_some() {
            return said.text(result.trim_start());
        }
        let place = pointed.unwrap_or_else(|| {
            let (width, cells) = (difference.width().max(1), difference.cells().iter().enumerate());
            let known = cells.filter(|(_, value)| !value.is_nan());
            let largest = known.reduce(|a, b| if b.1 > a.1 { b } else { a }).map_or(0, |(index, _)| index);
            (largest % width, largest / width)
        });
        let which = if pointed.is_some() { "" } else { ", where the frame differs most" };
        let said = said.text("Update at ").ink(Role::Reference, format!("pixel {}", pixel(place)));
        let mut all = said.text(format!("{which}: "));
        all.0.extend(self.explained_at(seen, frame, place).update.0);
        all.text(result)
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.before;
        if seen.events.is_empty() {
            return Vec::new();
        }
        let history = MaskHistory::new(seen.events);
        let mut facts = vec![Fact::new("Frame", state.frame.to_string(), None)];
        let mut readouts = Vec::new();
        let mut whole = self.comparison(seen).unwrap_or_default();
        facts.append(&mut whole.facts);
        if let Some((place, mut explanation)) = self.explanation(seen) {
            whole.matrices.append(&mut explanation.matrices);
            facts.push(Fact::new("Pixel", pixel(place), Some(Role::Reference)));
            if let Some((frame, _)) = history.exposed() {
                let level = frame.luma()[place].to_string();
                facts.push(Fact::new("Level before the correction", level, Some(Role::Measured)));
            }
            facts.extend(explanation.facts);
            readouts.extend(Some(explanation.equation).filter(|lines| !lines.is_empty()).map(Readout::Equation));
            let matrices = std::mem::take(&mut whole.matrices);
            readouts.extend(Some(matrices).filter(|all| !all.is_empty()).map(Readout::Matrices));
            readouts.extend(self.tiles(seen, place).map(Readout::Tiles));
            if let Some((model, frame)) = self.compared_model(seen).zip(history.frame()) {
                readouts.extend(super::history::plots(&self.0, (seen.clip, state), (&*model, &**frame), place));
            }
        }
        facts.extend(history.facts());
        readouts.insert(0, Readout::Facts(facts));
        readouts.extend(Some(whole.matrices).filter(|all| !all.is_empty()).map(Readout::Matrices));
        let now: &State<_> = seen.after.unwrap_or(state);
        readouts.extend(plots(&now.record, &state.span));
        readouts
    }

    /// Tiles of the frame and the background, in the channel that decides about a pixel, and of their difference around it.
    fn tiles(&self, seen: &Seen<Self>, place: (usize, usize)) -> Option<Vec<Tile>> {
        let frame = MaskHistory::new(seen.events).frame()?;
        let model = self.compared_model(seen)?;
        let model = &*model;
        let around = |of: &dyn Fn((usize, usize)) -> f32| explain::around_with(frame.size(), place, TILE_REACH_PX, of);
        let difference = around(&|place| self.0.difference(model, frame, place));
        let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(*v));
        let channel = self.0.channel(model, frame, place);
        let [shown, background] = tile_labels(channel);
        let tile = |label, role, values, range| Tile { label, role, values, range, framed: Vec::new() };
        Some(vec![
            tile(shown, Some(Role::Measured), around(&|place| f32::from(channel.level(frame, place))), [0.0, 255.0]),
            tile(
                background,
                Some(Role::Predicted),
                around(&|place| self.0.compared_in(model, frame, place, channel)),
                [0.0, 255.0],
            ),
            tile("Difference", None, difference, [0.0, most]),
        ])
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let history = MaskHistory::new(seen.events);
        if let (Some(model), Some(frame)) = (self.compared_model(seen), history.frame()) {
            scene.pictures = self.0.pictures(&model, frame.size());
            // After the update it is the new model.
            scene.layers =
                self.0.layers(seen.after.and_then(|after| after.model.as_ref()).unwrap_or(&model), &self.past(seen));
        }
        match seen.events.last() {
            None => {}
            Some(Event::Followed(..)) => scene.legend(Role::Predicted, "background model, shifted with the camera"),
            Some(Event::Begun(_) | Event::Exposed(..)) => scene.legend(Role::Predicted, "background model"),
            Some(Event::Registered(_)) => scene.legend(Role::Predicted, "previous frame, warped by the motion"),
            Some(Event::Compared(_, difference)) => {
                let values = difference.as_ref().clone();
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
                scene.heat = Some(M::SHOWN);
                scene.legend(Role::Candidate, M::COMPARED);
            }
            Some(Event::Decided(mask)) => layer(scene, Role::Candidate, "foreground", Arc::clone(mask)),
            Some(Event::Shadows(mask, shadows)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                layer(scene, Role::Rejected, "shadow", Arc::clone(shadows));
            }
            Some(Event::Steadied(mask, displaced)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                layer(scene, Role::Rejected, "displaced background", Arc::clone(displaced));
            }
            Some(Event::Updated(conclusion)) => {
                match &conclusion.errors {
                    Some(errors) => draw_errors(scene, errors),
                    None => history.masks().next_back().into_iter().for_each(|mask| {
                        layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                    }),
                }
                history.kept().into_iter().for_each(|[kept, _]| draw_blobs(scene, kept, (Role::Result, "blob")));
            }
            _ => history.draw(scene),
        }
        if let Some((x, y)) = seen.point().and_then(|point| history.frame()?.luma().cell_at(point)) {
            let beside = scene.pictures.iter().map(|canvas| canvas.picture).filter(|on| self.0.explains(*on));
            let mut all: Vec<_> = beside.chain([Picture::CURRENT]).collect();
            all.sort();
            all.dedup();
            for on in all {
                scene.mark(on, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
            }
            scene.legend(Role::Reference, "explained pixel");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_is_for_many_errors_of_one_kind() {
        let of = |conclusion: Conclusion, truths, estimates, pairs| {
            conclusion.advice(Matches { truths, estimates, pairs }, "Compensate the motion.")
        };
        let advice = |truths, estimates, pairs| of(Conclusion::default(), truths, estimates, pairs);
        assert_eq!([advice(500, 499, 499), advice(10, 10, 10)], ["", ""]);
        assert!(advice(10, 5, 5).contains("misses (5): try a lower threshold"));
        assert!(advice(5, 10, 5).contains("false alarms (5): try a higher threshold"));
        let moved = of(Conclusion { camera: Some([-3.0, 0.5]), ..Conclusion::default() }, 5, 10, 5);
        assert!(moved.contains("the camera moves") && moved.ends_with("Compensate the motion."), "{moved}");
        assert!(!moved.contains("threshold"), "{moved}");
    }
}
