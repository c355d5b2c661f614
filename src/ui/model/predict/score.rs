//! The scores of questions, as a file.

use motionscope_core::scene::Question;

use super::Verdict;
use crate::ui::model::snapshot::Snapshot;

/// A question that a class has answered.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Name of the clip.
    pub clip: String,
    /// Id of the estimator.
    pub estimator: &'static str,
    /// The number of frame t.
    pub frame: usize,
    /// The step, as `UNIT.EVENT`.
    pub step: String,
    /// The question.
    pub question: &'static Question,
    /// How the guesses compare.
    pub verdict: Verdict,
}

impl Score {
    /// Returns the score of guesses about the step of `after`.
    pub fn new(after: &Snapshot, question: &'static Question, verdict: Verdict) -> Self {
        let (clip, estimator, frame) = (after.clip.to_string(), after.info.id, after.frame);
        Self { clip, estimator, frame, step: after.cursor.to_string(), question, verdict }
    }

    /// Whether more than half of the hands were right; `None` without hands.
    pub fn is_right(&self) -> Option<bool> {
        let [right, all] = self.verdict.hands;
        (all > 0).then(|| 2 * right > all)
    }

    /// Returns all scores as CSV: a row for each question.
    pub fn csv(scores: &[Self]) -> String {
        let head = "clip,estimator,frame,step,question,answer,right_hands,hands,guesses,nearest_off,unit\n";
        let rows = scores.iter().map(|score| {
            let Self { clip, estimator, frame, step, question, verdict } = score;
            let [right, all] = verdict.hands;
            let off = verdict.nearest.map_or_else(String::new, |(_, off)| format!("{:.*}", verdict.decimals, off));
            let [clip, text, answer] = [clip, question.text, &verdict.answer].map(quoted);
            let Verdict { guesses, unit, .. } = verdict;
            format!("{clip},{estimator},{frame},{step},{text},{answer},{right},{all},{guesses},{off},{unit}\n")
        });
        [head.to_owned()].into_iter().chain(rows).collect()
    }
}

/// A cell of words, in quotation marks where it needs them.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    motionscope_core::pseudocode! {
        TEST: "test",
    }

    const QUESTION: Question =
        Question::place("where", "Where, or \"whither\"?", line::TEST, motionscope_core::scene::Role::Best);

    #[test]
    fn a_row_names_its_question() {
        let verdict = Verdict {
            answer: "(1.0, 2.0)".into(),
            right: Vec::new(),
            hands: [1, 2],
            guesses: 3,
            nearest: Some((2, 0.5)),
            unit: "px".into(),
            decimals: 1,
        };
        let (clip, step) = ("waves".into(), "3.4".into());
        let score = Score { clip, estimator: "diamond", frame: 7, step, question: &QUESTION, verdict };
        assert_eq!(score.is_right(), Some(false), "half of the hands is not most of them");
        let rows = Score::csv(&[score]);
        let row = rows.lines().nth(1);
        assert_eq!(row, Some("waves,diamond,7,3.4,\"Where, or \"\"whither\"\"?\",\"(1.0, 2.0)\",1,2,3,0.5,px"));
    }
}
