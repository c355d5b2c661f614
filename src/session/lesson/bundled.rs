//! The bundled lessons, in the order of the course.

use std::path::Path;
use std::sync::OnceLock;

use motionscope_core::base::{Error, words};
use motionscope_core::course::glossary::Chapter;

use super::Lesson;

macro_rules! lessons {
    ($($file:literal: $chapter:ident),+ $(,)?) => {
        /// Names and texts of the files in `assets/lessons`.
        static FILES: &[(&str, &str)] = &[$(($file, include_str!(concat!("../../../assets/lessons/", $file, ".md")))),+];
        /// The chapter that each of them belongs to.
        const CHAPTERS: &[(&str, Chapter)] = &[$(($file, Chapter::$chapter)),+];
    };
}

lessons! {
    "01-dynamic-scene-analysis": DynamicScenes,
    "02-sequential-search": MotionVectors,
    "03-logarithmic-search": MotionVectors,
    "04-hierarchical-search": MotionVectors,
    "05-gradient-constraint": DifferentialMethods,
    "06-lucas-kanade": DifferentialMethods,
    "07-horn-schunck": DifferentialMethods,
    "08-interest-points": InterestPoints,
    "09-correspondence": InterestPoints,
    "10-point-tracking": Trajectories,
    "11-background-subtraction": MovingObjects,
    "12-kalman-filter": KalmanFilters,
    "13-tracking-many-objects": MultipleObjects,
    "14-model-based-tracking": Trajectories,
    "15-motion-segmentation": MovingObjects,
    "16-stereo-and-scene-flow": DynamicScenes,
}

/// The bundled lessons, in the order of the course; each is read once.
pub fn all() -> &'static [Lesson] {
    static LESSONS: OnceLock<Vec<Lesson>> = OnceLock::new();
    LESSONS.get_or_init(|| {
        let read = |(file, text): &(&str, &str)| Lesson::parse(slug(file), text, Path::new(".")).ok();
        FILES.iter().filter_map(read).collect()
    })
}

/// The bundled lessons by chapter, in the order in which the course comes to them.
pub fn chapters() -> Vec<(Chapter, Vec<&'static Lesson>)> {
    let mut chapters: Vec<(Chapter, Vec<&'static Lesson>)> = Vec::new();
    for (file, chapter) in CHAPTERS {
        let Some(lesson) = all().iter().find(|lesson| lesson.slug == slug(file)) else { continue };
        match chapters.iter_mut().find(|(other, _)| other == chapter) {
            Some((_, lessons)) => lessons.push(lesson),
            None => chapters.push((*chapter, vec![lesson])),
        }
    }
    chapters
}

/// The name of a file without its number.
fn slug(file: &str) -> &str {
    file.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start_matches('-')
}

/// The bundled lesson `slug`.
///
/// # Errors
/// If there is none of that name.
pub(super) fn find(slug: &str) -> Result<&'static Lesson, Error> {
    let unknown = || {
        let known: Vec<_> = all().iter().map(|lesson| lesson.slug.as_str()).collect();
        Error::new(words::there_is_no("lesson", &Error::short_name(slug).to_string(), &known))
    };
    all().iter().find(|lesson| lesson.slug == slug).ok_or_else(unknown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::charts::formula::typeset;
    use crate::paint::charts::prose::Part;

    #[test]
    fn every_file_of_the_folder_is_a_lesson_without_faults() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/lessons");
        let entries = std::fs::read_dir(folder).expect("the folder of the lessons");
        let mut files: Vec<_> = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
        files.sort();
        assert_eq!(files, FILES.iter().map(|(file, _)| format!("{file}.md")).collect::<Vec<_>>());
        for (file, text) in FILES {
            let lesson = Lesson::parse(slug(file), text, Path::new(".")).unwrap_or_else(|why| panic!("{file}: {why}"));
            let faults: Vec<_> = lesson.faults().map(|(page, why)| format!("page {page}: {why}")).collect();
            assert!(faults.is_empty(), "{file}: {}", faults.join("; "));
            assert!(!lesson.summary.is_empty() && lesson.pages.iter().all(|page| !page.title.is_empty()), "{file}");
        }
    }

    #[test]
    fn every_formula_is_drawn_with_characters_that_the_fonts_have() {
        for (lesson, page) in all().iter().flat_map(|lesson| lesson.pages.iter().map(move |page| (lesson, page))) {
            let words = page.words.as_ref().expect("words");
            let formulas =
                words.0.iter().filter_map(|part| if let Part::Formula(math) = part { Some(math) } else { None });
            for math in formulas {
                let missing = typeset(math, 16.0, 400.0).missing();
                assert!(missing.is_empty(), "{}, {}: {missing:?} of {}", lesson.slug, page.title, math.plain());
            }
        }
    }

    #[test]
    fn every_lesson_belongs_to_one_chapter() {
        let chapters = chapters();
        let listed: usize = chapters.iter().map(|(_, lessons)| lessons.len()).sum();
        assert_eq!(listed, all().len());
        assert!(chapters.len() > 5 && chapters.iter().all(|(_, lessons)| lessons.len() <= 4));
    }

    #[test]
    fn links_lead_somewhere() {
        let is_known = |to: &str| {
            let as_session = || crate::session::Named::find(to.as_ref(), Default::default());
            (to.starts_with("lesson:") || to.starts_with("example:")) && as_session().is_ok()
        };
        let links = all().iter().flat_map(|lesson| lesson.pages.iter().map(move |page| (lesson, page)));
        for (lesson, page) in links {
            let words = page.words.as_ref().expect("words");
            let wrong: Vec<_> = words.links().filter(|to| !is_known(to)).collect();
            assert!(wrong.is_empty(), "{}, {}: {wrong:?}", lesson.slug, page.title);
        }
    }
}
