//! The explanation shared by all multi-object trackers.

pub(crate) use super::drawing::{
    ShownTrack, draw_arrows, draw_detections, draw_progress, label, number_detections, rect, role, series, trail,
    work_at, work_on,
};
pub(crate) use super::tables::Names;

use super::drawing::of_status;
use super::gating::MOST_NEAR;
use super::lifecycle::Rules;
use super::tracker_run::Conclusion;
use super::vocabulary::{case, value};
use crate::base::words::{rounded, whole_heading_deg};
use crate::methods::kalman::Filter;
use crate::products::{
    ObjectFrame, TrackStatus,
    objects::score::{Matches, Scores},
};
use crate::scene::{Case, Number, Step, Unit, Value};

/// The most detections of tracks that a sentence lists.
const LISTED: usize = 4;

/// Tells the number of detections of the frame, and of those discarded by the minimum score.
pub(crate) fn tell_detections(
    step: Step,
    (detections, unit): (usize, Unit),
    (discarded, min_score): (usize, f32),
) -> Step {
    let step = step.put_value(value::DETECTIONS.is(detections).in_unit(unit)).say(case::DETECTED);
    let step = step.put(value::DISCARDED, discarded).put(value::MIN_SCORE, min_score);
    step.say_if(discarded > 0, case::DISCARDED).say(case::END)
}

/// Puts the gate, its pairs, and the pairs of all tracks and detections.
pub(crate) fn put_gates(step: Step, gated: usize, [tracks, detections]: [usize; 2], (gate, share): (f64, f32)) -> Step {
    let step = step.put(value::GATED, gated).put(value::PAIRS, tracks * detections);
    step.put(value::GATE, gate).put(value::GATE_PROBABILITY, 100.0 * share)
}

/// Tells the number of pairs inside the gate by a case of the tracker, if there are pairs.
pub(crate) fn tell_gate(step: Step, case_of_pairs: &'static Case) -> Step {
    let is_any = step.real(value::PAIRS) > 0.0;
    step.say(if is_any { case_of_pairs } else { case::NONE_TO_GATE })
}

/// Tells for how many tracks only the nearest detections are compared.
pub(crate) fn tell_crowding(step: Step, tracks: usize) -> Step {
    step.put(value::CROWDED, tracks).put(value::MOST_NEAR, MOST_NEAR).say_if(tracks > 0, case::CROWDED)
}

pub(crate) fn add_velocity(step: Step, velocity: [f64; 2]) -> Step {
    let step = step.put(value::HEADING, whole_heading_deg(velocity));
    step.fact_as(value::SPEED.is(velocity[0].hypot(velocity[1])), case::VELOCITY)
}

/// The standard deviations of the position along x and y, or the one that both have.
pub(crate) fn deviation(filter: &Filter) -> Number {
    let [[xx, _], [_, yy]] = filter.place_covariance();
    let [x, y] = [xx, yy].map(|variance| variance.max(0.0).sqrt());
    if rounded(x, 2) == rounded(y, 2) { x.into() } else { [x, y].into() }
}

pub(crate) fn add_track(step: Step, track: &ShownTrack, rules: Rules) -> Step {
    let ShownTrack { id, filter, age, .. } = track;
    let step = step.fact(value::TRACK, *id).fact(value::STATUS, age.status.name()).fact(value::HITS, age.hits);
    let step = add_velocity(step, filter.velocity()).fact(value::DEVIATION, deviation(filter));
    let step = step.put(value::POSITION, filter.place()).put(value::MISSED, age.missed);
    step.put(value::MIN_HITS, rules.min_hits).put(value::MAX_AGE, rules.max_age)
}

/// Puts the place and the deviation of a track before its update.
pub(crate) fn put_prediction(step: Step, filter: &Filter) -> Step {
    step.put(value::POSITION_BEFORE, filter.place()).put(value::DEVIATION_BEFORE, deviation(filter))
}

/// Tells why a track is deleted.
pub(crate) fn tell_deletion(step: Step, track: &ShownTrack, rules: Rules) -> Step {
    step.say(match track.age.status {
        TrackStatus::Tentative => case::DELETED_TENTATIVE,
        _ if track.age.missed < rules.max_age => case::DELETED_OUTSIDE,
        _ => case::DELETED_OLD,
    })
}

/// Tells until when a new track is tentative, if it is.
pub(crate) fn tell_tentative(step: Step, status: TrackStatus, rules: Rules) -> Step {
    let step = step.put_value(value::MIN_HITS.is(rules.min_hits).in_unit(Unit::count("hit")));
    step.say_if(status == TrackStatus::Tentative, case::TENTATIVE_UNTIL)
}

/// Tells the number of consecutive misses of a track.
pub(crate) fn tell_misses(step: Step, missed: usize) -> Step {
    step.say_if(missed > 1, case::IN_A_ROW).say(case::MAX_AGE)
}

/// Tells the origins of detections: the track of each with the case of its kind, then the number of false alarms.
pub(crate) fn tell_origins(step: Step, all: &[(usize, Option<(u32, &'static Case)>)]) -> Step {
    let of_tracks: Vec<_> = all.iter().filter_map(|(detection, of)| Some((*detection, (*of)?))).collect();
    let others = of_tracks.len().saturating_sub(LISTED);
    let clutter = all.len() - of_tracks.len();
    let step = of_tracks.iter().take(LISTED).enumerate().fold(step, |step, (i, (detection, (id, kind)))| {
        let step = step.say_if(i > 0, case::COMMA).put(value::DETECTION, detection + 1).put(value::ORIGIN, *id);
        step.say(case::DETECTION_IS).say(kind)
    });
    let step = step.put(value::OTHERS, others).put(value::CLUTTER, clutter);
    let step = step.say_if(others > 0, case::COMMA).say_if(others > 0, case::OTHERS);
    step.say_if(clutter > 0 && !of_tracks.is_empty(), case::COMMA).say_if(clutter > 0, case::CLUTTER)
}

/// Tells the conclusion of a frame, and at its end of the run: counts, scores, the kind of error and the remedy.
pub(crate) fn tell_conclusion(step: Step, frame: &ObjectFrame, conclusion: &Conclusion) -> Step {
    let of = |status| of_status(frame, status);
    let step = step.put(value::CONFIRMED, of(TrackStatus::Confirmed)).put(value::COASTING, of(TrackStatus::Coasting));
    let step = step.put(value::TENTATIVE, of(TrackStatus::Tentative)).say(case::COUNTS);
    let run = conclusion.run.filter(|run| run.truths > 0);
    let step = match run {
        Some(run) => tell_scores(step, run, conclusion),
        None => {
            let step = conclusion.frame.into_iter().fold(step, tell_matches);
            conclusion.tracks.into_iter().fold(step, |step, all| step.put(value::RUN_TRACKS, all).say(case::RUN_TRACKS))
        }
    };
    let step = conclusion.overconfidence().into_iter().fold(step, |step, test| test.tell(step, false));
    let step = run.and_then(|run| advice(run, conclusion)).into_iter().fold(step, Step::say);
    step.put(value::STATIONARY, conclusion.stationary).say_if(conclusion.stationary > 0, case::STATIONARY)
}

/// Tells the scores of a run, with those in real time if they differ, and its worst frames.
fn tell_scores(step: Step, run: Scores, conclusion: &Conclusion) -> Step {
    let hindsight = [value::MOTA.is(run.mota), value::IDF1.is(run.idf1), value::SWITCHES.is(run.switches)];
    let of = |live: Scores| {
        let [mota, idf1] = [value::LIVE_MOTA.is(live.mota), value::LIVE_IDF1.is(live.idf1)];
        [mota, idf1, value::LIVE_SWITCHES.is(live.switches)]
    };
    let differs = |live: &[Value; 3]| live.iter().map(Value::bare).ne(hindsight.iter().map(Value::bare));
    let live = conclusion.live.map(of).filter(differs);
    let step = hindsight.into_iter().fold(step, Step::put_value);
    let step = step.say(if live.is_some() { case::RUN_WITH_HINDSIGHT } else { case::RUN });
    let step = step.put(value::PRECISION, run.precision).put(value::RECALL, run.recall).say(case::RATES);
    let step = match live {
        Some(live) => live.into_iter().fold(step, Step::put_value).say(case::IN_REAL_TIME),
        None => step,
    };
    tell_worst_frames(step, &conclusion.worst)
}

/// The remedy of the most frequent kind of error.
fn advice(run: Scores, conclusion: &Conclusion) -> Option<&'static Case> {
    let (misses, alarms) = (run.truths - run.matches, run.hypotheses - run.matches);
    Some(match conclusion.hidden {
        _ if run.switches + misses + alarms == 0 => return None,
        _ if run.switches > misses.max(alarms) => case::MOST_SWITCHES,
        _ if conclusion.overconfidence().is_some() => case::SMALL_GATES,
        Some(hidden) if misses > alarms && 2 * hidden > misses && conclusion.is_interpolated => {
            case::MISSES_INTERPOLATED
        }
        Some(hidden) if misses > alarms && 2 * hidden > misses => case::MISSES_OF_OCCLUDED,
        Some(_) if misses > alarms => case::MISSES_OF_VISIBLE,
        None if misses > alarms => case::MOST_MISSES,
        _ if misses == alarms => case::AS_MANY,
        _ => case::MOST_FALSE_ALARMS,
    })
}

/// Tells the frames with the most errors.
fn tell_worst_frames(step: Step, worst: &[(usize, Matches)]) -> Step {
    let Some((first, all)) = worst.first() else { return step };
    let (misses, alarms) = (all.misses(), all.false_positives());
    let step = step.put(value::WORST_FRAME, *first).put(value::WORST_FRAMES, worst.len());
    let step = step.put(value::WORST_MISSES, misses).put(value::WORST_FALSE_ALARMS, alarms);
    let step = step.put(value::ERRORS, misses + alarms);
    match worst {
        [_] => step.say(case::WORST_FRAME),
        [_, (second, _)] => step.put(value::SECOND_FRAME, *second).say(case::TWO_WORST_FRAMES),
        _ => step.say(case::WORST_FRAMES),
    }
}

/// Tells the number of true objects of a frame that are matched.
fn tell_matches(step: Step, all: Matches) -> Step {
    let alarms = all.false_positives();
    let step = step.put(value::TRUTHS, all.truths).put(value::MATCHED, all.pairs).put(value::FALSE_ALARMS, alarms);
    step.say(match all.misses() + alarms {
        0 if all.truths == 0 => case::NO_TRUE_OBJECTS,
        0 => case::ALL_MATCHED,
        _ => case::SOME_MATCHED,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::line_names!(CONCLUDE);

    #[test]
    fn all_frames_with_the_most_errors_are_named() {
        let two = Matches { truths: 5, estimates: 3, pairs: 3 };
        let said = |worst: &[(usize, Matches)]| tell_worst_frames(Step::at(CONCLUDE), worst).sentence.plain();
        assert_eq!(said(&[]), "");
        assert_eq!(said(&[(21, two)]), "Frame 21 has the most errors: 2 misses, 0 false alarms.");
        assert_eq!(said(&[(21, two), (23, two)]), "Frames 21 and 23 have the most errors: 2 errors each.");
        let said = said(&[(21, two), (22, two), (23, two)]);
        assert_eq!(said, "The most errors in a frame are 2, in 3 frames, first in frame 21.");
    }
}
