//! The steps of a background subtraction in values, words and marks.

use std::cmp::Ordering;
use std::sync::Arc;

use super::declare::line;
use super::explanation::{Cases, Probe, say};
use super::exposure::Transfer;
use super::{Background, Channel, Conclusion, Event, Explanation, Initial, Past, Setup, State, Subtraction};
use crate::base::words::{capital, grouped};
use crate::data::{Detection, Frame, Mask, MaskErrors};
use crate::methods::differential::explain;
use crate::products::{Record, objects::score::Matches};
use crate::run::{Seen, Span};
use crate::scene::{Case, Decimals, Name, Picture, Readout, Role, Scene, Series, Shape, Step, Tile, Unit, Variable};

/// Radius of the tiles around the explained pixel, in px.
const TILE_REACH_PX: usize = 4;

/// The share of the picture that differs from the background where the camera or the light has changed, not objects.
const FLOODED: f64 = 0.3;
/// That share where the camera is known to have moved.
const FLOODED_BY_MOTION: f64 = 0.15;

/// From this F₁ score on the errors are too few for advice.
const GOOD_F1: f64 = 0.9;

/// A number of pixels.
const AREA: Unit = Unit::new("px", 0);
/// A change of the exposure.
const EXPOSURE: Unit = Unit::new("gray levels", 1);
const SIGNED_EXPOSURE: Unit = Unit { name: "gray levels", decimals: Decimals::Signed(1) };

crate::variables! { pub(crate) mod value;
    /// The number of the current frame.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The next frame, which is compared with the current one.
    NEXT_FRAME: "", "", Unit::WHOLE;
    /// The last frame of the median that initialises the model.
    LAST_FRAME: "", "", Unit::WHOLE;
    /// The quantity that is compared with the threshold.
    COMPARED: "", "", Unit::WHOLE;
    /// The formula of the heat map.
    SHOWN: "", "", Unit::WHOLE;
    /// The explained pixel.
    PIXEL: "Pixel", r"\mathbf{x}", Unit::WHOLE, Role::Reference;
    /// The gray level of the pixel before the exposure was corrected.
    UNCORRECTED_LEVEL: "Level before the correction", "", Unit::WHOLE, Role::Measured;
    /// The gray level of the pixel in the frame.
    GRAY_LEVEL: "Gray level", "I", Unit::WHOLE, Role::Measured;
    /// The colour of the pixel in the frame: red, green and blue.
    COLOUR: "Colour", r"\mathbf{I}", Unit::WHOLE, Role::Measured;
    /// The background that the model expects at the pixel.
    BACKGROUND: "Background", "B", Unit::FINE, Role::Predicted;
    /// The background at the pixel after the update.
    BACKGROUND_AFTER: "Background after update", "B", Unit::FINE, Role::Estimate;
    /// The difference of the pixel from the background, in colour the largest of all channels.
    DIFFERENCE: "Difference", "|I - B|", Unit::GRAY;
    /// The colour channel that decides.
    CHANNEL: "Channel", "", Unit::WHOLE;
    /// The threshold on the difference of foreground pixels.
    THRESHOLD: "Threshold", "T", Unit::GRAY;
    /// The threshold in standard deviations of the noise, where it follows from that.
    NOISE_SIGMAS: "", "", Unit::WHOLE;
    /// The level of the pixel in the channel that decides.
    LEVEL: "", "I", Unit::WHOLE, Role::Measured;
    /// The background in the channel that decides.
    EXPECTED: "", "B", Unit::FINE, Role::Predicted;
    /// The learning rate of the model.
    LEARNING_RATE: "", r"\alpha", Unit::RATIO;
    /// The displacement of the background since the first frame, by the camera.
    CAMERA: "Camera displacement", "", Unit::PX, Role::Reference;
    /// The shift of the model since the previous frame.
    SHIFT: "", "", Unit::PX;
    /// The median change of the gray levels from the background to the frame.
    EXPOSURE_CHANGE: "Change of exposure", "", SIGNED_EXPOSURE, Role::Reference;
    /// The size of the change of exposure.
    EXPOSURE_SIZE: "", "", EXPOSURE, Role::Reference;
    /// The change of dark pixels, at gray level 64.
    DARK_CHANGE: "", "", SIGNED_EXPOSURE;
    /// The change of bright pixels, at gray level 192.
    BRIGHT_CHANGE: "", "", SIGNED_EXPOSURE;
    /// The pixels that differ from the background by more than the threshold.
    FOREGROUND: "Foreground by the threshold", "", AREA, Role::Candidate;
    /// The share of the frame that differs from the background by more than the threshold.
    FOREGROUND_SHARE: "", "", Unit::PERCENT;
    /// The pixels that are cast shadows.
    SHADOWS: "Shadows", "", AREA, Role::Rejected;
    /// The foreground pixels that fit the background of a neighbour.
    DISPLACED: "Displaced background", "", AREA, Role::Rejected;
    /// The radius of the shake suppression.
    SHAKE: "", "", AREA;
    /// The area below which the area opening removes a component.
    LEAST_COMPONENT: "", "", AREA;
    /// The pixels that the openings remove.
    REMOVED: "", "", AREA, Role::Rejected;
    /// The pixels of the mask after the openings.
    AFTER_OPENING: "After opening", "", AREA;
    /// The side of the structuring element of the opening or closing.
    SIDE: "", "", Unit::WHOLE;
    /// The pixels that the closing adds.
    FILLED: "", "", AREA, Role::Estimate;
    /// The pixels of the mask after the closing.
    AFTER_CLOSING: "After closing", "", AREA;
    /// The number of neighbours that count as connected.
    CONNECTIVITY: "", "", Unit::WHOLE;
    /// The connected components of the mask.
    COMPONENTS: "Components", "", Unit::count("connected component"), Role::Candidate;
    /// The number of the component that the pixel belongs to.
    COMPONENT: "", "", Unit::WHOLE;
    /// The components of at least the minimum area.
    BLOBS: "Blobs", "", Unit::count("blob"), Role::Result;
    /// The components below the minimum area.
    SMALL_COMPONENTS: "", "", Unit::count("smaller component"), Role::Rejected;
    /// The minimum area of a blob.
    LEAST_AREA: "", "", AREA;
    /// The pixels of the final mask.
    FINAL_FOREGROUND: "", "", AREA;
    /// The share of the frame that differs from the background, without shadows.
    DIFFERING_SHARE: "", "", Unit::PERCENT;
    /// The true objects of the frame.
    TRUE_OBJECTS: "", "", Unit::count("true object");
    /// The share of the boxes that match a true one.
    BOX_PRECISION: "Box precision", "", Unit::FINE, Role::Truth;
    /// The share of the true boxes that are matched.
    BOX_RECALL: "Box recall", "", Unit::FINE, Role::Truth;
    /// The harmonic mean of precision and recall of the boxes.
    BOX_F1: "Box F₁", "", Unit::FINE, Role::Truth;
    /// The share of the foreground pixels that are true.
    MASK_PRECISION: "Mask precision", "", Unit::FINE, Role::Truth;
    /// The share of the true foreground pixels that are found.
    MASK_RECALL: "Mask recall", "", Unit::FINE, Role::Truth;
    /// The harmonic mean of precision and recall of the pixels.
    MASK_F1: "Mask F₁", "", Unit::FINE, Role::Truth;
    /// The true pixels or objects that are not found.
    MISSES: "", "", AREA;
    /// The pixels or objects that are found and not true.
    FALSE_ALARMS: "", "", AREA;
    /// The blobs on the place of an object of the first frame that has left.
    GHOSTS: "", "", Unit::count("ghost");
}

crate::cases! { pub(crate) over value;
    AGAINST_MODEL: "Each pixel is compared with a background model; a large {compared} is foreground. Opening, closing and \
                    connected components turn the mask into blobs.",
    AGAINST_FRAME: "Each pixel is compared with the previous frame; a large {compared} is foreground. Opening, closing and \
                    connected components turn the mask into blobs.",
    REFERENCE: "Frame {frame} is the reference of frame {next_frame}.",
    FIRST_FRAME: "Frame {frame} initialises the background model. Objects in it will leave ghosts: false foreground until the \
                  model has learned the background behind them.",
    MEDIAN: "The median of frames spread evenly up to frame {last_frame} initialises the background model. An object that \
             covers a pixel in fewer than half of these frames leaves no ghost.",
    FOLLOWED: "The camera has moved. The median displacement of textured blocks since the first frame is {camera}. From its \
               position in the previous frame the model is shifted by {shift}",
    IN_WHOLE_PX: ", in whole px.",
    END: ".",
    BRIGHTER: "The exposure has changed: most pixels are {exposure_size} {reference|brighter} than the background",
    DARKER: "The exposure has changed: most pixels are {exposure_size} {reference|darker} than the background",
    BY_LEVEL: "({dark_change:bare} at level 64, {bright_change:bare} at level 192)",
    CORRECTED: ". The frame is corrected for it.",
    COMPARED: "{compared} at each pixel of frame {frame}. The heat map shows {shown}.",
    DECIDED: "{foreground} {candidate|of foreground} ({foreground_share} of the frame):",
    RULE: "|I − B| exceeds the threshold of {threshold}",
    ABOVE_NOISE: "exceeds {noise_sigmas} standard deviations of the noise, at least 8 gray levels",
    ABOVE_THRESHOLD: "exceeds the threshold of {threshold}",
    ANY_CHANNEL: ", in colour in any channel.",
    SHADOWS: "{rejected|Cast shadows:} {shadows} {rejected|of the foreground}, darker than the background, but of the same \
              colour, and not enclosed by foreground. They are removed.",
    DISPLACED: "{displaced} {rejected|of the foreground fit} the background of a pixel within shake = {shake}: the camera has \
                displaced it. They are removed.",
    OPENED: "Opening (erosion, then dilation with a {side}×{side} square) removed {removed} in regions narrower than the square.",
    AREA_OPENED: "Area opening removed {removed} in components of fewer than {least_component}, which are too small to be told \
                  from noise.",
    BOTH_OPENED: "Opening (erosion, then dilation with a {side}×{side} square) and area opening removed {removed} in regions \
                  narrower than the square and components of fewer than {least_component}.",
    CLOSED: "Closing (dilation, then erosion with a {side}×{side} square) filled {filled} in gaps narrower than the square.",
    LABELLED: "Labelling with {connectivity}-connectivity finds {components}.",
    KEPT: "{blobs} with at least {least_area}; {small_components} rejected as noise.",
    PIXEL: "{reference|Pixel} {pixel}",
    GRAY_LEVEL: ": gray level {gray_level}",
    COLOUR: ": colour {colour}",
    BACKGROUND: ", background {background}.",
    DIFFERENCE: "The difference {difference:bare}",
    LARGEST_DIFFERENCE: "The largest difference {difference:bare} in {channel}",
    EXCEEDS: "exceeds the threshold {threshold:bare}: foreground.",
    WITHIN: "is within the threshold {threshold:bare}: background.",
    IS_SHADOW: "It is a {rejected|cast shadow} and removed from the mask.",
    NO_SHADOW: "It is not a shadow.",
    IS_DISPLACED: "The background of a neighbour explains it: {rejected|displaced background}, removed from the mask.",
    NOT_DISPLACED: "The background of no neighbour explains it.",
    SHAKE_KEEPS: "Shake suppression does not change it.",
    OPENING_REMOVES: "Opening {rejected|removes} it.",
    OPENING_KEEPS: "Opening does not change it.",
    CLOSING_FILLS: "Closing {estimate|fills} it.",
    CLOSING_KEEPS: "Closing does not change it.",
    IN_COMPONENT: "It belongs to component {component}",
    TOO_SMALL: ", which is rejected: its area is below the minimum area.",
    IS_BLOB: ", which becomes a blob.",
    NO_COMPONENT: "It belongs to no component.",
    NO_BLOB: "It belongs to no blob.",
    UPDATE: "Update at {reference|pixel} {pixel}:",
    LARGEST_UPDATE: "Update at {reference|pixel} {pixel}, where the frame differs most:",
    MOVES_TO_LEVEL: "the background B moves from {background} to {background_after} toward the gray level {gray_level}",
    MOVES_TO_COLOUR: "the background B moves from {background} to {background_after} toward the colour {colour}",
    FRAME_RESULT: "Frame {frame}: {blobs}, {final_foreground} of foreground.",
    FRAME_SCORE: "Frame {frame}: {blobs} for {true_objects}; precision {box_precision}, recall {box_recall}, F₁ {box_f1} at IoU \
                  ≥ 0.5.",
    RUN_SCORE: "Run against the ground truth (IoU ≥ 0.5): precision {box_precision}, recall {box_recall}, F₁ {box_f1}.",
    UNLABELLED: "The ground truth labels no pixel of this frame, so its mask is not scored.",
    NO_FOREGROUND: "Neither the mask nor the ground truth has foreground in labelled pixels, so there is no F₁.",
    ALL_MASKS: "Pixels of all masks against the true foreground: precision {mask_precision}, recall {mask_recall}, F₁ {mask_f1};",
    ITS_MASK: "Its mask against the true foreground: precision {mask_precision}, recall {mask_recall}, F₁ {mask_f1};",
    NO_ERRORS: "no errors.",
    ERRORS: "{false_alarms} of false alarms, {misses} missed.",
    CAMERA_OR_LIGHT: "{differing_share} of the frame differs from the background: the camera moves, or the light has changed.",
    CAMERA_MOVED: "The background is displaced by {camera} since the first frame.",
    USE_MOTION: "This method needs a static camera and constant light. With a moving camera, compare the motion of objects with \
                 that of their surroundings (motion-compensated difference, optical flow, KLT, point trajectories).",
    GHOST: "1 ghost remains where an object of the first frame has left: initialise with the median, or let the model learn \
            faster.",
    GHOSTS: "{ghosts} remain where an object of the first frame has left: initialise with the median, or let the model learn \
             faster.",
    HIDDEN: "The masks agree with the truth; objects without a box may be mostly hidden, joined to another or smaller than the \
             minimum area.",
    SPLIT: "The masks agree with the truth; there are more blobs than objects, so objects may be split into parts: a larger \
            closing may join them.",
    JOINED: "The masks agree with the truth; there are fewer blobs than objects, so blobs may join objects that touch or hide \
             each other.",
    MISSHAPEN: "The masks agree with the truth; the wrong boxes are blobs that join or split objects, or shapes that overlap \
                their box by less than half.",
    MISSES: "Most errors are misses ({misses}): try a lower threshold, a smaller opening or a smaller minimum area.",
    FALSE_ALARMS: "Most errors are false alarms ({false_alarms}): try a higher threshold, a larger opening or a larger minimum \
                   area.",
    CAMERA_ALARMS: "Most errors are false alarms ({false_alarms}), and the camera moves: the background is displaced by \
                    {camera} since the first frame. A shift follows it only roughly, so edges of the background remain as \
                    foreground.",
    ONE_OF_EACH: "1 miss and 1 false alarm.",
    AS_MANY: "{misses:bare} misses and {false_alarms:bare} false alarms.",
}

/// The masks and components of a frame up to a step.
pub(crate) struct MaskHistory<'a> {
    events: &'a [Event],
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
        self.events.iter().filter_map(masked)
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

    /// Tells the effect of each stage after the threshold on a pixel, and that of the last stage in any case.
    fn of_pixel(&self, mut step: Step, (x, y): (usize, usize)) -> Step {
        let mut was_set = false;
        for (i, event) in self.events.iter().enumerate() {
            let is_last = i + 1 == self.events.len();
            step = match event {
                Event::Shadows(_, shadows) if shadows.get(x, y) => step.say(case::IS_SHADOW),
                Event::Shadows(..) => step.say_if(is_last, case::NO_SHADOW),
                Event::Steadied(_, displaced) if displaced.get(x, y) => step.say(case::IS_DISPLACED),
                Event::Steadied(..) => {
                    step.say_if(is_last, if was_set { case::NOT_DISPLACED } else { case::SHAKE_KEEPS })
                }
                Event::Opened(mask) if was_set && !mask.get(x, y) => step.say(case::OPENING_REMOVES),
                Event::Opened(_) => step.say_if(is_last, case::OPENING_KEEPS),
                Event::Closed(mask) if !was_set && mask.get(x, y) => step.say(case::CLOSING_FILLS),
                Event::Closed(_) => step.say_if(is_last, case::CLOSING_KEEPS),
                Event::Labelled(labels, _) if labels[(x, y)] > 0 => {
                    let component = labels[(x, y)];
                    let is_small = self.kept().map(|[_, dropped]| dropped.iter().any(|d| label(d) == component));
                    let becomes = is_small.map_or(case::END, |is| if is { case::TOO_SMALL } else { case::IS_BLOB });
                    step.put(value::COMPONENT, component).say(case::IN_COMPONENT).say(becomes)
                }
                Event::Labelled(..) => step.say_if(is_last, case::NO_COMPONENT),
                Event::Kept(_) => step.say_if(is_last && !was_set, case::NO_BLOB),
                _ => step,
            };
            was_set = masked(event).map_or(was_set, |mask| mask.get(x, y));
        }
        step
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

/// The mask of an event.
fn masked(event: &Event) -> Option<&Arc<Mask>> {
    match event {
        Event::Decided(mask)
        | Event::Shadows(mask, _)
        | Event::Steadied(mask, _)
        | Event::Opened(mask)
        | Event::Closed(mask) => Some(mask),
        _ => None,
    }
}

/// Puts the components of at least the minimum area, and the number of the others.
pub(crate) fn put_blobs(step: Step, [kept, dropped]: &[Vec<Detection>; 2], least_area: usize) -> Step {
    let step = step.fact(value::BLOBS, kept.len()).put(value::SMALL_COMPONENTS, dropped.len());
    step.put(value::LEAST_AREA, least_area)
}

/// Puts precision, recall and F₁ score.
fn put_scores(step: Step, all: Matches, of: [&'static Variable; 3]) -> Step {
    let scores = of.into_iter().zip([all.precision(), all.recall(), all.f1()]);
    scores.fold(step, |step, (of, score)| step.fact(of, score.unwrap_or(f64::NAN)))
}

/// Puts the errors of pixels or of boxes.
fn put_errors(step: Step, all: Matches, unit: Unit) -> Step {
    let step = step.put_value(value::MISSES.is(all.misses()).in_unit(unit));
    step.put_value(value::FALSE_ALARMS.is(all.false_positives()).in_unit(unit))
}

impl Conclusion {
    /// The pixels of all masks compared with the truth at the end of the run, of this one before.
    fn pixels(&self) -> Option<Matches> {
        self.run_pixels.or_else(|| self.errors.as_ref().map(Matches::of_pixels))
    }

    /// Tells the result of the frame, its score, the likely cause of its errors and the parameters that reduce them.
    fn tell(&self, step: Step, [cause, instead]: [&'static Case; 2]) -> Step {
        const BOXES: [&Variable; 3] = [value::BOX_PRECISION, value::BOX_RECALL, value::BOX_F1];
        let step =
            step.put(value::FINAL_FOREGROUND, self.foreground).put(value::DIFFERING_SHARE, 100.0 * self.differing);
        let step = match (self.frame, self.run) {
            (None, _) => step.say(case::FRAME_RESULT),
            (_, Some(run)) => put_scores(step, run, BOXES).say(case::RUN_SCORE),
            (Some(frame), None) => {
                put_scores(step.put(value::TRUE_OBJECTS, frame.truths), frame, BOXES).say(case::FRAME_SCORE)
            }
        };
        let (step, has_moved) = (self.of_mask(step), self.camera_moved().is_some());
        let step = match self.camera {
            Some(moved) => step.put(value::CAMERA, moved),
            None => step,
        };
        if self.differing >= if has_moved { FLOODED_BY_MOTION } else { FLOODED } {
            return step.say(cause).say_if(has_moved, case::CAMERA_MOVED).say(instead);
        }
        match self.run.or(self.frame) {
            Some(boxes) => self.advice(step, boxes, instead),
            None => step,
        }
    }

    /// Tells the quality of the mask against the true foreground.
    fn of_mask(&self, step: Step) -> Step {
        const MASKS: [&Variable; 3] = [value::MASK_PRECISION, value::MASK_RECALL, value::MASK_F1];
        let Some(all) = self.pixels() else { return step };
        let step = put_errors(put_scores(step, all, MASKS), all, AREA);
        if self.run_pixels.is_none() && self.errors.as_ref().is_some_and(|errors| errors.labelled == 0) {
            return step.say(case::UNLABELLED);
        }
        if all.f1().is_none() {
            return step.say(case::NO_FOREGROUND);
        }
        let has_errors = all.misses() + all.false_positives() > 0;
        let step = step.say(if self.run_pixels.is_some() { case::ALL_MASKS } else { case::ITS_MASK });
        step.say(if has_errors { case::ERRORS } else { case::NO_ERRORS })
    }

    /// The displacement of the background since the first frame in px, where the camera is known to have moved.
    fn camera_moved(&self) -> Option<[f32; 2]> {
        self.camera.filter(|by| by[0].hypot(by[1]) > 1.0)
    }

    /// Tells what to change, by the errors of the mask where its truth is known, otherwise by those of the boxes: a box that overlaps a true
    /// one by too little is a miss and a false alarm, whatever the threshold is. `instead` names what to use where the camera moves.
    fn advice(&self, step: Step, boxes: Matches, instead: &'static Case) -> Step {
        if self.ghosts > 0 {
            return step.put(value::GHOSTS, self.ghosts).say(if self.ghosts == 1 { case::GHOST } else { case::GHOSTS });
        }
        let masks = self.pixels();
        let all = masks.unwrap_or(boxes);
        let step = put_errors(step, all, if masks.is_some() { AREA } else { Unit::WHOLE });
        let is_good = |matches: Matches| matches.f1().is_none_or(|f1| f1 >= GOOD_F1);
        match (all.misses(), all.false_positives()) {
            _ if masks.is_some() && is_good(all) && !is_good(boxes) => {
                let shape = match boxes.estimates.cmp(&boxes.truths) {
                    Ordering::Greater => case::SPLIT,
                    Ordering::Less => case::JOINED,
                    Ordering::Equal => case::MISSHAPEN,
                };
                step.say(if boxes.false_positives() == 0 { case::HIDDEN } else { shape })
            }
            (0, 0) => step,
            _ if is_good(all) => step,
            (misses, alarms) if misses > alarms => step.say(case::MISSES),
            // Neither a threshold nor an opening registers the frames.
            (misses, alarms) if misses < alarms && self.camera_moved().is_some() => {
                step.say(case::CAMERA_ALARMS).say(instead)
            }
            (misses, alarms) if misses < alarms => step.say(case::FALSE_ALARMS),
            (1, _) => step.say(case::ONE_OF_EACH),
            _ => step.say(case::AS_MANY),
        }
    }
}

/// Puts a change of the exposure; returns with it the cases that tell it.
fn put_exposure(step: Step, transfer: &Transfer) -> (Step, Cases) {
    let [dark, bright] = [64.0, 192.0].map(|level| transfer.change(level));
    let step = step.fact(value::EXPOSURE_CHANGE, transfer.median).put(value::EXPOSURE_SIZE, transfer.median.abs());
    let step = step.put(value::DARK_CHANGE, dark).put(value::BRIGHT_CHANGE, bright);
    let mut cases = vec![if transfer.median > 0.0 { case::BRIGHTER } else { case::DARKER }];
    // They are told where they differ.
    cases.extend(((dark - bright).abs() >= 1.0).then_some(case::BY_LEVEL));
    cases.push(case::CORRECTED);
    (step, cases)
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
        let text =
            Shape::Text { at: bounds.min, text: format!("{}: {} px", blob.label, grouped(blob.area_px as usize)) };
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
        let (state, history) = (seen.before, MaskHistory::new(seen.events));
        let Some(event) = seen.events.last() else {
            let against = if self.0.setup().initial.is_some() { case::AGAINST_MODEL } else { case::AGAINST_FRAME };
            return Step::at(line::BEGIN_MODEL).put(value::COMPARED, M::COMPARED).say(against);
        };
        let (mut step, mut cases) = (Step::at(stage(event)).fact(value::FRAME, state.frame), Vec::new());
        for end in 1..=seen.events.len() {
            (step, cases) = self.put_event(step, seen, &seen.events[..end]);
        }
        let place = history.frame().and_then(|frame| frame.luma().cell_at(seen.point()?));
        let Explanation { step, verdict, update } = match place {
            Some(place) => self.explain_pointed(step, seen, place),
            None => Explanation::of(step),
        };
        let step = match (event, place) {
            (Event::Updated(conclusion), _) => self.updated(step, seen, (conclusion, place.map(|_| update))),
            (Event::Begun(_) | Event::Exposed(..) | Event::Registered(_) | Event::Compared(..), _) | (_, None) => {
                say(step, &cases)
            }
            (_, Some(place)) => history.of_pixel(say(step.say(case::PIXEL), &verdict), place),
        };
        step.show_all(plots(&seen.after.unwrap_or(state).record, &state.span))
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
        Past { clip: seen.clip.clone(), span, steady: self.0.setup().steady, at }
    }

    /// The explanation of a pixel, without charts that all models have.
    fn explained_at(&self, step: Step, seen: &Seen<Self>, (frame, place): (&Frame, (usize, usize))) -> Explanation {
        let Some(before) = self.compared_model(seen) else { return Explanation::of(step) };
        let after = seen.after.and_then(|after| after.model.as_deref());
        self.0.explain(step, &Probe { before: &before, after, frame, place })
    }

    /// The explanation of the pixel that is pointed at.
    fn explain_pointed(&self, step: Step, seen: &Seen<Self>, place: (usize, usize)) -> Explanation {
        let (step, history) = (step.fact(value::PIXEL, place), MaskHistory::new(seen.events));
        let step = step.fact_if(value::UNCORRECTED_LEVEL, history.exposed().map(|(frame, _)| frame.luma()[place]));
        let Some((model, frame)) = self.compared_model(seen).zip(history.frame()) else { return Explanation::of(step) };
        let Explanation { step, verdict, update } = self.explained_at(step, seen, (frame, place));
        let step = step.show(Readout::Tiles(self.tiles(&model, frame, place)));
        let plots = super::history::plots(&self.0, (seen.clip, seen.before), (&*model, &**frame), place);
        Explanation { step: step.show_all(plots), verdict, update }
    }

    /// Puts the values of the last of some events; returns with them the cases that tell it.
    fn put_event(&self, step: Step, seen: &Seen<Self>, events: &[Event]) -> (Step, Cases) {
        let (Setup { settings, initial, steady }, state) = (self.0.setup(), seen.before);
        let [gone, new] = MaskHistory::new(events)
            .change()
            .map_or([0, 0], |[before, after]| [before.without(after).count(), after.without(before).count()]);
        let Some(event) = events.last() else { return (step, Vec::new()) };
        match event {
            Event::Begun(_) => {
                let last = state.frame + state.span.frames().unwrap_or(1) - 1;
                let begun = match initial {
                    None => case::REFERENCE,
                    Some(Initial::FirstFrame) => case::FIRST_FRAME,
                    Some(Initial::Median) => case::MEDIAN,
                };
                (step.put(value::NEXT_FRAME, state.frame + 1).put(value::LAST_FRAME, last), vec![begun])
            }
            Event::Followed(by, at) => {
                let end = if M::IS_REPLACED { case::END } else { case::IN_WHOLE_PX };
                (step.fact(value::CAMERA, *at).put(value::SHIFT, *by), vec![case::FOLLOWED, end])
            }
            Event::Exposed(_, transfer) => put_exposure(step, transfer),
            Event::Registered(frame) => match &state.model {
                Some(model) => self.0.comparison(step, model, frame),
                None => (step, Vec::new()),
            },
            Event::Compared(..) => {
                (step.put(value::COMPARED, capital(M::COMPARED)).put(value::SHOWN, M::SHOWN), vec![case::COMPARED])
            }
            Event::Decided(mask) => {
                let share = mask.count() as f64 / (mask.width() * mask.height()).max(1) as f64;
                let step = step.fact(value::FOREGROUND, mask.count()).put(value::FOREGROUND_SHARE, 100.0 * share);
                let (step, mut rule) = self.0.rule(step);
                rule.insert(0, case::DECIDED);
                (step, rule)
            }
            Event::Shadows(_, shadows) => (step.fact(value::SHADOWS, shadows.count()), vec![case::SHADOWS]),
            Event::Steadied(_, displaced) => {
                let shake = steady.map_or(0, |steady| steady.shake);
                (step.fact(value::DISPLACED, displaced.count()).put(value::SHAKE, shake), vec![case::DISPLACED])
            }
            Event::Opened(mask) => {
                let opened = match (settings.opening, settings.area_opening) {
                    (0, _) => case::AREA_OPENED,
                    (_, 0 | 1) => case::OPENED,
                    _ => case::BOTH_OPENED,
                };
                let step = step.put(value::SIDE, 2 * settings.opening + 1).put(value::REMOVED, gone);
                let step = step.put(value::LEAST_COMPONENT, settings.area_opening);
                (step.fact(value::AFTER_OPENING, mask.count()), vec![opened])
            }
            Event::Closed(mask) => {
                let step = step.put(value::SIDE, 2 * settings.closing + 1).put(value::FILLED, new);
                (step.fact(value::AFTER_CLOSING, mask.count()), vec![case::CLOSED])
            }
            Event::Labelled(_, count) => {
                let step = step.put(value::CONNECTIVITY, settings.connectivity.label());
                (step.fact(value::COMPONENTS, *count), vec![case::LABELLED])
            }
            Event::Kept(blobs) => (put_blobs(step, blobs, settings.least_area(state.picture)), vec![case::KEPT]),
            Event::Updated(_) => (step, Vec::new()),
        }
    }

    /// Tells the update of the model at the pixel that is pointed at, else at that of the largest difference, and the conclusion. The end of
    /// a run with ground truth is about its result alone, unless a pixel is pointed at.
    fn updated(&self, step: Step, seen: &Seen<Self>, (conclusion, pointed): (&Conclusion, Option<Cases>)) -> Step {
        let compared = seen.events.iter().find_map(|event| match event {
            Event::Compared(frame, difference) => Some((frame, difference)),
            _ => None,
        });
        let Some((frame, difference)) = compared else { return step };
        let step = match pointed {
            Some(update) => say(step.say(case::UPDATE), &update),
            None if conclusion.run.is_some() => step,
            None => {
                let (width, cells) = (difference.width().max(1), difference.cells().iter().enumerate());
                let known = cells.filter(|(_, value)| !value.is_nan());
                let largest = known.reduce(|a, b| if b.1 > a.1 { b } else { a }).map_or(0, |(index, _)| index);
                let place = (largest % width, largest / width);
                // Its numbers are no facts of the frame.
                let Explanation { step: at, update, .. } = self.explained_at(Step::at(step.line), seen, (frame, place));
                let step = at.values.into_iter().fold(step.put(value::PIXEL, place), Step::put_value);
                say(step.say(case::LARGEST_UPDATE), &update)
            }
        };
        conclusion.tell(step, M::FLOODED)
    }

    /// Tiles of the frame and the background, in the channel that decides about a pixel, and of their difference around it.
    fn tiles(&self, model: &M::Model, frame: &Frame, place: (usize, usize)) -> Vec<Tile> {
        let around = |of: &dyn Fn((usize, usize)) -> f32| explain::around_with(frame.size(), place, TILE_REACH_PX, of);
        let difference = around(&|place| self.0.difference(model, frame, place));
        let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(*v));
        let channel = self.0.channel(model, frame, place);
        let [shown, background] = tile_labels(channel);
        let tile = |label, role, values, range| Tile { label, role, values, range, framed: Vec::new() };
        let (level, expected) = (
            around(&|place| f32::from(channel.level(frame, place))),
            around(&|place| self.0.compared_in(model, frame, place, channel)),
        );
        vec![
            tile(shown, Some(Role::Measured), level, [0.0, 255.0]),
            tile(background, Some(Role::Predicted), expected, [0.0, 255.0]),
            tile("Difference", None, difference, [0.0, most]),
        ]
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
            let step = Step::at(line::UPDATE_MODEL).put(value::CAMERA, conclusion.camera.unwrap_or_default());
            conclusion.advice(step, Matches { truths, estimates, pairs }, case::USE_MOTION).sentence.plain()
        };
        let advice = |truths, estimates, pairs| of(Conclusion::default(), truths, estimates, pairs);
        assert_eq!([advice(500, 499, 499), advice(10, 10, 10)], ["", ""]);
        assert!(advice(10, 5, 5).contains("misses (5): try a lower threshold"));
        assert!(advice(5, 10, 5).contains("false alarms (5): try a higher threshold"));
        let moved = of(Conclusion { camera: Some([-3.0, 0.5]), ..Conclusion::default() }, 5, 10, 5);
        assert!(moved.contains("the camera moves") && moved.ends_with(case::USE_MOTION.text), "{moved}");
        assert!(!moved.contains("threshold"), "{moved}");
    }
}
