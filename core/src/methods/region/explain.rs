//! What all trackers of a region explain alike: the start, the result of a frame, the conclusion of the run.

use super::content;
use super::ending::{FAIR, GROWN};
use super::regained::Regained;
use super::start::{Origin, WHOLE};
use super::{At, Ending, Event, Explained, Outcome, RegionTracking, State, line, plots};
use crate::base::words::{counted, fixed, place};
use crate::data::Clip;
use crate::methods::numbers::{px, ratio};
use crate::products::region::{NEAR_PX, RegionError, RegionScores, Sight, area_ratio, covered, success};
use crate::products::{Region, RegionField, RegionFrame};
use crate::run::Seen;
use crate::scene::{Fact, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// The longest path that is drawn, in frames.
const TRAIL_FRAMES: usize = 30;

/// A width and a height as text.
fn size([width, height]: [f32; 2]) -> String {
    format!("{}×{} px", px(width.into()), px(height.into()))
}

/// The size of a region, and how far it is turned if it is.
fn extent(region: &Region) -> String {
    match fixed(region.angle_rad.to_degrees().into(), 0).as_str() {
        "0" => size(region.size),
        angle => format!("{}, turned by {angle}°", size(region.size)),
    }
}

impl<T: Explained> RegionTracking<T> {
    pub(super) fn line_of(&self, event: &Event<T::Event>) -> Name {
        match event {
            Event::Chosen | Event::Refused => line::CHOOSE,
            Event::Waiting => line::EACH_FRAME,
            Event::Own(event) => self.0.line(event),
            Event::Moved(_) => line::MOVE,
        }
    }

    /// The run at an event of the tracker.
    fn at<'a>(seen: &'a Seen<'_, Self>) -> Option<At<'a, T>> {
        matches!(seen.events.last()?, Event::Own(_)).then(|| Self::at_last(seen))?
    }

    /// The run at the last event of the tracker in the frame.
    fn at_last<'a>(seen: &'a Seen<'_, Self>) -> Option<At<'a, T>> {
        let own = |event: &'a Event<T::Event>| match event {
            Event::Own(event) => Some(event),
            _ => None,
        };
        let events: Vec<_> = seen.events.iter().filter_map(own).collect();
        let event = *events.last()?;
        let state = seen.before;
        let (truth, first) = (state.chosen.object.zip(seen.clip.truth()), state.span.first);
        let poses = move |index| truth.and_then(|(object, truth)| truth.pose(object, first + index).ok().flatten());
        let (pose, poses) = (poses(state.past.len()), Box::new(poses));
        Some(At { model: state.model.as_deref(), region: state.region, events, event, pose, poses })
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = seen.events.last().map_or(line::EACH_FRAME, |event| self.line_of(event));
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let said = Sentence::default();
        let state = seen.before;
        match seen.events.last() {
            None => said.text(self.0.opening()),
            Some(Event::Chosen) => chosen(state, said),
            Some(Event::Refused) => said
                .ink(Role::Error, "The region cannot be tracked")
                .text(format!(": {} The run ends.", state.refusal.as_deref().unwrap_or_default())),
            Some(Event::Waiting) => said.ink(Role::Error, format!("Frame {}: failure", state.frame)).text(
                ", as the region and the true box had nothing in common. The tracker restarts from the true box 5 frames later, once the object is wholly \
                 visible.",
            ),
            Some(Event::Own(_)) => Self::at(seen).map_or(said, |at| self.0.sentence(&at)),
            Some(Event::Moved(result)) => match seen.after.filter(|after| is_over(seen.clip, after)) {
                Some(after) => self.concluded((seen, after), result, said),
                None => self.moved(seen, result, said),
            },
        }
    }

    /// The result of a frame, beside the truth where that is known.
    fn moved(&self, seen: &Seen<Self>, result: &RegionFrame, said: Sentence) -> Sentence {
        let (state, similarity) = (seen.before, T::SIMILARITY);
        let by = [0, 1].map(|i| result.region.center[i] - state.region.center[i]);
        let value = fixed(result.similarity.into(), similarity.decimals);
        let said = if result.is_lost {
            said.text(format!("In frame {} the object is ", state.frame)).ink(Role::Error, "lost").text(format!(
                "{} ({} {value}). The region stays at {} px.",
                self.why(seen),
                similarity.name,
                place(result.region.center)
            ))
        } else {
            said.text(format!("Frame {}: the region moves by ", state.frame))
                .ink(Role::Estimate, format!("{} px", place(by)))
                .text(format!(
                    " to {} px and measures {}. {} {value}.",
                    place(result.region.center),
                    extent(&result.region),
                    similarity.label
                ))
                .text(
                    Regained::of(&state.past, result)
                        .map_or_else(String::new, |regained| regained.told(similarity, error_of_last(seen).is_some())),
                )
                .text(self.caveat(seen))
        };
        let Some(error) = error_of_last(seen) else { return said.text(unseen_here(seen).unwrap_or_default()) };
        let verdict = match (verdict(&error), error.overlap) {
            (None, _) => String::new(),
            (Some(verdict), 0.0) => format!(": {verdict}"),
            (Some(verdict), _) => format!(", below {}: {verdict}", fixed(FAIR, 1)),
        };
        said.text(format!(
            " Overlap with the true box (IoU) {}{verdict}. Centre error {} px.",
            ratio(error.overlap),
            px(error.center_px)
        ))
    }

    /// Why the object is lost in a frame, as the rest of a sentence.
    fn why(&self, seen: &Seen<Self>) -> String {
        let why = Self::at_last(seen).and_then(|at| self.0.loss(&at));
        why.map(|why| format!(": {why}")).unwrap_or_default()
    }

    /// What the result of a frame does not show, as a further sentence.
    fn caveat(&self, seen: &Seen<Self>) -> String {
        let caveat = Self::at_last(seen).and_then(|at| self.0.caveat(&at));
        caveat.map(|caveat| format!(" {caveat}")).unwrap_or_default()
    }

    /// The conclusion at the end of the run: the scores, what became of the region, and why.
    fn concluded(
        &self,
        (seen, after): (&Seen<Self>, &State<T::Model>),
        result: &RegionFrame,
        said: Sentence,
    ) -> Sentence {
        let errors = errors(seen.clip, after);
        let ending = Ending::in_clip(&after.field(), seen.clip, &errors);
        let said = match RegionScores::of(&errors) {
            Some(of) => said.text(scored(&of, ending)),
            None => said.text(format!(
                "End of the run: the object is reported as lost in {} of {} frames.",
                ending.reported,
                after.past.len()
            )),
        };
        let last = errors.last().filter(|error| error.frame + 1 == after.frame);
        let said = match last.and_then(verdict) {
            _ if result.is_lost => {
                said.text(" In the last frame it is ").ink(Role::Error, "lost").text(format!("{}.", self.why(seen)))
            }
            Some(verdict) => said.text(format!(" In the last frame {verdict}.")),
            None => said.text(self.caveat(seen)),
        };
        let said = match self.0.settings().restart {
            true => said.text(restarted(after)),
            false => said.text(regained::<T>(after, &errors).unwrap_or_default()),
        };
        let said = said.text(content::told(seen.clip, &after.mask_field(), &errors).unwrap_or_default());
        let vanished = Vanished::of(&after.field(), seen.clip);
        let said = said.text(vanished.as_ref().map_or_else(String::new, Vanished::sentence));
        let at = Self::at_last(seen);
        let said = said.text(
            at.as_ref().and_then(|at| self.0.summary(at)).map(|summary| format!(" {summary}")).unwrap_or_default(),
        );
        if ending.outcome == Outcome::Unknown {
            return said.text(format!(
                " Without true boxes, only the pictures show whether the region is on the object: {} has a high {} too.",
                T::SIMILARITY.shared_by,
                T::SIMILARITY.name
            ));
        }
        // The last regions are off because there is little or nothing to see, whatever a tracker compares.
        let tells_cause = T::JUDGES_LOSS && ending.loss.is_some();
        if vanished.is_some() && !tells_cause && !matches!(ending.outcome, Outcome::Followed | Outcome::Regained) {
            return said;
        }
        let advice = at.map(|at| self.0.advice(ending, &at));
        said.text(advice.map(|advice| format!(" {advice}")).unwrap_or_default())
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let (state, Some(event)) = (seen.before, seen.events.last()) else { return Vec::new() };
        let region = match event {
            Event::Moved(result) => result.region,
            _ => state.region,
        };
        let mut facts = vec![
            Fact::new("Frame", state.frame.to_string(), None),
            Fact::new("Region", format!("{} px, {}", place(region.center), extent(&region)), Some(Role::Reference)),
        ];
        let at = Self::at(seen);
        facts.extend(at.iter().flat_map(|at| self.0.facts(at)));
        if let Event::Moved(result) = event {
            let value = fixed(result.similarity.into(), T::SIMILARITY.decimals);
            facts.push(Fact::new(T::SIMILARITY.label, value, Some(Role::Estimate)));
            if let Some(error) = error_of_last(seen) {
                facts.push(Fact::new("Overlap (IoU)", ratio(error.overlap), Some(Role::Truth)));
                facts.push(Fact::new("Centre error", format!("{} px", px(error.center_px)), Some(Role::Error)));
            }
        }
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(at.iter().flat_map(|at| self.0.readouts(at)));
        let is_result = matches!(event, Event::Moved(_));
        readouts.extend(self.histories(seen, is_result).into_iter().map(Readout::Series));
        readouts
    }

    /// The similarity and the overlap over the frames; at the end of the run the success curve too.
    fn histories(&self, seen: &Seen<Self>, is_result: bool) -> Vec<Series> {
        let state = seen.after.filter(|_| is_result).unwrap_or(seen.before);
        if state.past.len() < 2 {
            return Vec::new();
        }
        let first = state.span.first;
        let x_max = first + state.span.frames().map_or(state.past.len(), |frames| frames - 1);
        let over =
            |title, y_label, lines| Series { title, x_label: "frame", y_label, x_max, lines, ..Series::default() };
        let line = state.past.iter().enumerate().map(|(i, frame)| [(first + i) as f32, frame.similarity]);
        let mut all = vec![over(
            T::SIMILARITY.label,
            T::SIMILARITY.symbol,
            vec![(T::SIMILARITY.symbol, Role::Estimate, line.collect())],
        )];
        let errors = errors(seen.clip, state);
        if !errors.is_empty() {
            let line = errors.iter().map(|error| [error.frame as f32, error.overlap as f32]).collect();
            all.push(over("Overlap with the true box", "IoU", vec![("IoU", Role::Truth, line)]));
        }
        if is_result && !errors.is_empty() && is_over(seen.clip, state) {
            let curve = success(&errors).into_iter().map(|point| point.map(|c| c as f32)).collect();
            all.insert(0, plots::curve("Success", ["overlap threshold", "share of frames"], ("success", curve)));
        }
        all
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let path: Vec<_> = state.past.iter().map(|frame| frame.region.center).collect();
        let path = &path[path.len().saturating_sub(TRAIL_FRAMES)..];
        if path.len() > 1 {
            let shape = Shape::Path { points: path.to_vec(), closed: false };
            scene.mark(Picture::CURRENT, Role::Result, shape);
            scene.legend(Role::Result, "path of the region");
        }
        let is_first = state.model.is_none();
        let model = state.model.as_deref().or(seen.after.and_then(|after| after.model.as_deref()));
        scene.work = model.and_then(|model| self.0.work(model)).map(|bounds| [bounds.min, bounds.max]);
        outline(scene, Role::Reference, state.region);
        scene.legend(Role::Reference, if is_first { "region of the object" } else { "region of frame t−1" });
        if let Some(at) = Self::at(seen) {
            self.0.draw(&at, scene);
        }
        let Some(Event::Moved(result)) = seen.events.last() else { return };
        let (role, meaning) = if result.is_lost { (Role::Error, "object lost") } else { (Role::Estimate, "region") };
        outline(scene, role, result.region);
        scene.legend(role, meaning);
        if let Some(model) = seen.after.and_then(|after| after.model.as_deref()) {
            self.0.draw_result(model, scene);
        }
        if let Some(RegionError { truth, .. }) = error_of_last(seen) {
            scene.mark(Picture::CURRENT, Role::Truth, Shape::Rect { min: truth.min, max: truth.max });
            scene.legend(Role::Truth, "true box");
        }
    }
}

/// Whether a run has no more frames.
fn is_over<M>(clip: &Clip, state: &State<M>) -> bool {
    state.span.is_over(clip, state.frame)
}

/// The errors of all frames so far, where the truth is known.
fn errors<M>(clip: &Clip, state: &State<M>) -> Vec<RegionError> {
    state.field().errors(clip).unwrap_or_default()
}

/// The error of the frame that has just ended, where the truth is known.
fn error_of_last<T: Explained>(seen: &Seen<RegionTracking<T>>) -> Option<RegionError> {
    let after = seen.after?;
    after.field().error_of(seen.clip, after.past.len().checked_sub(1)?).ok().flatten()
}

/// Why a frame that has just ended is not scored: by the ground truth its object cannot be seen.
fn unseen_here<T: Explained>(seen: &Seen<RegionTracking<T>>) -> Option<&'static str> {
    let after = seen.after?;
    match after.field().sight(seen.clip, after.past.len().checked_sub(1)?).ok()?? {
        Sight::Seen(_) => None,
        Sight::Hidden => Some(" By the ground truth the object is wholly hidden, so this frame is not scored."),
        Sight::Absent => Some(" By the ground truth the object is not in the picture, so this frame is not scored."),
    }
}

/// An object that cannot be seen at the end of a run.
struct Vanished {
    /// The first of the last frames in which it is not wholly visible.
    from: usize,
    /// The first of the last frames in which no part of it can be seen.
    gone: usize,
    /// Why, there.
    sight: Sight,
}

impl Vanished {
    /// Finds it in a run; `None` where the object is visible in the last frame, or its visibility is unknown.
    fn of(field: &RegionField, clip: &Clip) -> Option<Self> {
        let last: Vec<(usize, Sight)> = (1..field.frames.len())
            .rev()
            .map_while(|index| Some((field.first + index, field.sight(clip, index).ok()??)))
            .take_while(|(_, sight)| !matches!(sight, Sight::Seen(share) if *share >= WHOLE))
            .collect();
        let is_gone = |(_, sight): &&(usize, Sight)| !matches!(sight, Sight::Seen(_));
        let (gone, sight) = *last.iter().take_while(is_gone).last()?;
        Some(Self { from: last.last().map_or(gone, |(frame, _)| *frame), gone, sight })
    }

    fn sentence(&self) -> String {
        let Self { from, gone, sight } = self;
        let fading = if from < gone { format!(" disappears from frame {from} on and") } else { String::new() };
        let state = if *sight == Sight::Absent { "not in the picture" } else { "wholly hidden" };
        format!(
            " By the ground truth the object{fading} is {state} from frame {gone} on, where no tracker can see it and no frame is scored."
        )
    }
}

/// What is wrong with a region that has an overlap below 0.5.
fn verdict(error: &RegionError) -> Option<String> {
    let larger = area_ratio(error);
    match error.overlap {
        0.0 => Some("the region is not on the object".into()),
        0.0..FAIR if larger >= GROWN => {
            Some(format!("the region is {} times as large as the true box", fixed(larger, 1)))
        }
        0.0..FAIR => {
            let covered = fixed(100.0 * covered(error), 0);
            Some(format!("the region covers {covered} % of the true box"))
        }
        _ => None,
    }
}

/// What the end of a run says of the region that was found again after its longest loss.
fn regained<T: Explained>(after: &State<T::Model>, errors: &[RegionError]) -> Option<String> {
    let regained = Regained::longest(&after.past)?;
    let frame = after.span.first + regained.index;
    // An object without a true box in the frame is hidden there.
    let overlap = || errors.iter().find(|error| error.frame == frame).map_or(0.0, |error| error.overlap);
    regained.concluded(T::SIMILARITY, (frame, (!errors.is_empty()).then(overlap)))
}

/// The scores of a run in words.
fn scored(of: &RegionScores, ending: Ending) -> String {
    let said = format!(
        "End of the run over {}: mean overlap {}, success (AUC) {}, precision at {} px {}, {}",
        counted(of.frames, "frame"),
        ratio(of.overlap),
        ratio(of.success),
        fixed(NEAR_PX, 0),
        ratio(of.precision),
        counted(of.failures, "failure"),
    );
    said + &match (of.failures, ending.reported) {
        (0, 0) => ".".into(),
        (_, 0) => ", no loss reported.".into(),
        (_, lost) => format!(", a loss reported in {}.", counted(lost, "frame")),
    }
}

fn chosen<M>(state: &State<M>, said: Sentence) -> Sentence {
    if !state.past.is_empty() {
        return said
            .ink(Role::Reference, format!("Restart {}", state.restarts.count + 1))
            .text(format!(": in frame {} the region is the true box, and the object is learnt again.", state.frame));
    }
    let Region { center, size: extent, .. } = state.region;
    let said = said.ink(Role::Reference, format!("Region of {}", size(extent))).text(format!(
        " around {} px in frame {}, ",
        place(center),
        state.frame
    ));
    match state.chosen.origin {
        Origin::Placed => said.text("as placed on the frame."),
        Origin::Truth => said.text("the box of a true object. Place another region to track something else."),
        Origin::Middle => said.text(
            "in the middle of the frame, because no region is placed and no true object is known. Place the region on an object.",
        ),
    }
}

/// The number of restarts, as a further sentence of the end.
fn restarted<M>(state: &State<M>) -> String {
    match state.restarts.count {
        0 => String::new(),
        count => {
            format!(" The tracker was restarted {}.", if count == 1 { "once".into() } else { counted(count, "time") })
        }
    }
}

/// Draws the outline of a region: a box, or an ellipse if it is turned.
pub(super) fn outline(scene: &mut Scene, role: Role, region: Region) {
    let shape = if region.angle_rad == 0.0 {
        let bounds = region.bounds();
        Shape::Rect { min: bounds.min, max: bounds.max }
    } else {
        let radii = region.size.map(|side| side / 2.0);
        Shape::Ellipse { center: region.center, radii, angle_rad: region.angle_rad }
    };
    scene.mark(Picture::CURRENT, role, shape);
}
