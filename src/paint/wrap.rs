//! Words into lines.

use motionscope_core::scene::Sentence;

use super::primitive::Run;
use super::{Theme, fonts};

/// `runs` in lines of at most `width` points, broken at spaces only; a figure stays with its unit where both fit.
pub fn wrap(runs: &[Run], size: f32, width: f32) -> Vec<Vec<Run>> {
    let (mut lines, mut line, mut used) = (Vec::new(), Vec::new(), 0.0);
    let pieces = groups(runs).into_iter().flat_map(|group| match group.concat() {
        whole if long(&whole, size) <= width => vec![whole],
        _ => group,
    });
    for word in pieces {
        if used > 0.0 && used + long(&word, size) > width {
            lines.push(joined(std::mem::take(&mut line)));
            used = 0.0;
        }
        used += word.iter().map(|run| fonts::width(&run.text, run.face, size)).sum::<f32>();
        line.extend(word);
    }
    if !line.is_empty() {
        lines.push(joined(line));
    }
    lines
}

/// How long a word is without the space at its end.
fn long(word: &[Run], size: f32) -> f32 {
    let Some((last, others)) = word.split_last() else { return 0.0 };
    let others: f32 = others.iter().map(|run| fonts::width(&run.text, run.face, size)).sum();
    others + fonts::width(last.text.trim_end(), last.face, size)
}

/// Words that belong together: a figure and its unit, the sides of a relation.
fn groups(runs: &[Run]) -> Vec<Vec<Vec<Run>>> {
    let mut groups: Vec<Vec<Vec<Run>>> = Vec::new();
    for word in words(runs) {
        let is_next =
            |group: &&mut Vec<Vec<Run>>| group.last().is_some_and(|last| belong_together(&plain(last), &plain(&word)));
        match groups.last_mut().filter(is_next) {
            Some(group) => group.push(word),
            None => groups.push(vec![word]),
        }
    }
    groups
}

/// What must stay together: everything up to a space, whatever its colours.
fn words(runs: &[Run]) -> Vec<Vec<Run>> {
    let mut words = vec![Vec::new()];
    for run in runs {
        for piece in run.text.split_inclusive(' ') {
            if let Some(word) = words.last_mut() {
                word.push(Run { text: piece.into(), ..run.clone() });
            }
            if piece.ends_with(' ') {
                words.push(Vec::new());
            }
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Units of numbers in texts and formulas; each stays with its figure.
pub const UNITS: &[&str] =
    &["%", "°", "px", "px²", "px/frame", "mm", "cm", "m", "ms", "dB", "rad", "σ", "bit", "bits", "frame", "frames"];
/// Relations that stay with both of their sides.
const RELATIONS: &[&str] = &["=", "≥", "≤", "<", ">", "±"];
/// Length of a component of a vector, with its bracket and comma, beyond which a line may break behind it.
const LONGEST_COMPONENT: usize = 12;

/// Whether no line may break between two words: a figure and its unit, the sides of a relation, the components of a vector.
fn belong_together(before: &str, after: &str) -> bool {
    let [before, after] = [before, after].map(str::trim_end);
    let unit = after.trim_end_matches([',', '.', ';', ':', ')']);
    before.ends_with(|c: char| c.is_ascii_digit()) && UNITS.contains(&unit)
        || RELATIONS.contains(&after)
        || RELATIONS.contains(&before)
        || before.starts_with('(') && before.ends_with(',') && after.contains(')') && before.len() <= LONGEST_COMPONENT
}

fn plain(word: &[Run]) -> String {
    word.iter().map(|run| run.text.as_str()).collect()
}

/// Neighbours of one look become one run; the line's last space goes.
fn joined(line: Vec<Run>) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for run in line {
        match runs.last_mut() {
            Some(last) if (last.color, last.face, last.underline) == (run.color, run.face, run.underline) => {
                last.text.push_str(&run.text)
            }
            _ => runs.push(run),
        }
    }
    if let Some(last) = runs.last_mut() {
        last.text.truncate(last.text.trim_end().len());
    }
    runs
}

/// Which of their ways to say it, from long to short, is the first that `fits` for `all`; else the shortest.
pub fn brevity<'a>(all: impl Iterator<Item = &'a [Sentence]> + Clone, fits: impl Fn(&Sentence) -> bool) -> usize {
    let most = all.clone().map(<[Sentence]>::len).max().unwrap_or(1);
    let fit = |way: &usize| all.clone().filter_map(|said| said.get(*way).or(said.last())).all(&fits);
    (0..most).find(fit).unwrap_or(most.saturating_sub(1))
}

/// A sentence in the colours of its roles.
pub fn inked(sentence: &Sentence, theme: Theme) -> Vec<Run> {
    let color = |role: Option<_>| role.map_or(theme.chrome().text, |role| theme.word(role));
    sentence.words().map(|(words, role)| Run::new(words, color(role))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::scene::Role;

    #[test]
    fn a_vector_stays_on_one_line() {
        let runs = inked(&Sentence::default().text("the update gives the new flow (u, v) here"), Theme::Dark);
        for width in [60.0, 90.0, 120.0, 150.0, 180.0, 210.0] {
            let lines = wrap(&runs, 14.0, width);
            let text = |line: &Vec<Run>| line.iter().map(|run| run.text.as_str()).collect::<String>();
            assert!(
                lines.iter().any(|line| text(line).contains("(u, v)")),
                "{:?}",
                lines.iter().map(text).collect::<Vec<_>>()
            );
        }
    }

    #[test]
    fn lines_break_at_spaces_and_lose_no_word() {
        let sentence = Sentence::default()
            .text("Candidate ")
            .ink(Role::Candidate, "(−3, 2)")
            .text(" costs 812, less than the best so far, ")
            .ink(Role::Best, "903 at (0, 1)")
            .text(".");
        let runs = inked(&sentence, Theme::Dark);
        for width in [1.0, 80.0, 150.0, 400.0, 4000.0] {
            let lines = wrap(&runs, 14.0, width);
            let text = |line: &[Run]| line.iter().map(|run| run.text.as_str()).collect::<String>();
            let whole = lines.iter().map(|line| text(line)).collect::<Vec<_>>().join(" ");
            assert_eq!(whole, sentence.plain());
            for line in &lines {
                let long: f32 = line.iter().map(|run| fonts::width(&run.text, run.face, 14.0)).sum();
                assert!(long <= width || !text(line).contains(' '), "{} is {long} wide", text(line));
            }
        }
        assert_eq!(wrap(&runs, 14.0, 4000.0).len(), 1);
    }

    #[test]
    fn a_figure_stays_with_its_unit() {
        let runs = inked(&Sentence::default().text("covers 99.3 % of it and λ₂ = 1.19, moved by 5 px."), Theme::Dark);
        for width in [90.0, 100.0, 110.0, 140.0, 200.0] {
            for line in wrap(&runs, 14.0, width) {
                let words = plain(&line);
                assert!(!["%", "=", "px", "1.19"].iter().any(|start| words.starts_with(start)), "{words}");
            }
        }
        let frames = inked(&Sentence::default().text("deletes a track after 5 frames without a match"), Theme::Dark);
        let lines = [90.0, 110.0, 130.0, 150.0, 170.0].map(|width| wrap(&frames, 14.0, width)).concat();
        assert!(lines.iter().all(|line| !plain(line).starts_with("frames")), "a unit of the worksheets as well");
        let narrow = wrap(&runs, 14.0, 1.0);
        assert!(narrow.iter().all(|line| !plain(line).contains(' ')), "where nothing fits, every space is a break");
    }

    #[test]
    fn all_are_as_brief_as_the_longest_needs() {
        let ways = |words: &[&str]| words.iter().map(|words| Sentence::default().text(*words)).collect::<Vec<_>>();
        let (one, other) = (ways(&["twelve words", "twelve", "12"]), ways(&["nine"]));
        let of =
            |most: usize| brevity([&one[..], &other[..]].into_iter(), |words| words.plain().chars().count() <= most);
        assert_eq!([of(12), of(11), of(5), of(4), of(1)], [0, 1, 2, 2, 2]);
    }
}
