//! The lesson that is open, and the page of it.

use std::ffi::{OsStr, OsString};

use motionscope_core::base::Error;
use motionscope_core::run::{Cursor, Direction};

use crate::files;
use crate::paint::charts::prose::Prose;
use crate::session::lesson::{Address, Lesson, Page, bundled};
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::watch::Watch;
use crate::view::look::Look;

/// A lesson that is open.
pub struct OpenLesson {
    lesson: Lesson,
    /// Its name, and the page.
    address: Address,
    /// Notices that its file is written, for one that is being written.
    watch: Option<Watch>,
    /// How pictures looked before the first page.
    look: Look,
    /// The name under which the clip of the page is opened.
    opened_as: OsString,
    /// Where the run is to stand on the page, and whether it does.
    landing: Cursor,
    has_arrived: bool,
    /// Whether the last page is through, so that the next step opens the next lesson.
    pub is_over: bool,
    /// Whether the teacher's notes are shown.
    pub has_notes: bool,
}

impl OpenLesson {
    /// Opens the lesson at a page, over pictures that look so; `wake` is called when its file is written.
    ///
    /// # Errors
    /// If there is no such lesson or page, or its file cannot be read.
    pub fn new(address: Address, look: Look, wake: impl Fn() + Send + 'static) -> Result<Self, Error> {
        let lesson = address.load()?;
        lesson.page(address.page)?;
        // Without a thread to spare, the lesson is just not read anew.
        let watch = address
            .file()
            .filter(|path| !files::is_in_memory(path))
            .and_then(|path| Watch::new(path.to_owned(), wake).ok());
        Ok(Self {
            lesson,
            address,
            watch,
            look,
            opened_as: OsString::new(),
            landing: Cursor::default(),
            has_arrived: false,
            is_over: false,
            has_notes: false,
        })
    }

    /// The lesson.
    pub fn lesson(&self) -> &Lesson {
        &self.lesson
    }

    /// Its name, and the page.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// The page.
    pub fn page(&self) -> &Page {
        &self.lesson.pages[self.address.page]
    }

    /// The words of the page, or the first thing that is wrong with it.
    pub fn words(&self) -> Result<&Prose, &Error> {
        self.page().session.as_ref().err().map_or(self.page().words.as_ref(), Err)
    }

    /// Whether there is no page further on that way.
    pub fn is_at(&self, way: Direction) -> bool {
        match way {
            Direction::Forward => self.address.page + 1 >= self.lesson.pages.len(),
            Direction::Back => self.address.page == 0,
        }
    }

    /// Whether a step forward still has something to show: a page, the next lesson, or that the lesson ends.
    pub fn goes_on(&self) -> bool {
        !self.is_at(Direction::Forward) || !self.is_over || self.next().is_some()
    }

    /// Goes to the next page that way, if there is one.
    pub fn turn(&mut self, way: Direction) {
        let last = self.lesson.pages.len() - 1;
        self.address.page = match way {
            Direction::Forward => (self.address.page + 1).min(last),
            Direction::Back => self.address.page.saturating_sub(1),
        };
    }

    /// Says where the run is to stand on the page that was turned to, and under which name its clip is opened.
    pub fn lands_at(&mut self, cursor: Cursor, name: OsString) {
        self.is_over = false;
        (self.landing, self.has_arrived, self.opened_as) = (cursor, false, name);
    }

    /// Where the run is to stand on the page.
    pub fn landing(&self) -> Cursor {
        self.landing
    }

    /// The name under which the clip of the page is opened.
    pub fn opened_as(&self) -> &OsStr {
        &self.opened_as
    }

    /// Notes that the run stands there.
    pub fn arrive(&mut self) {
        self.has_arrived = true;
    }

    /// Whether the run has been where the page begins.
    pub fn has_arrived(&self) -> bool {
        self.has_arrived
    }

    /// Whether the run of the page is `shown` at another step than its first.
    pub fn has_left(&self, shown: &Snapshot) -> bool {
        let session = self.page().session.as_ref().ok();
        let session = session.filter(|session| self.has_arrived && shown.subject.experiment == session.experiment);
        session.is_some_and(|session| shown.cursor != session.position.cursor.unwrap_or_default())
    }

    /// Whether no steps of the page are left from `cursor` on in that direction.
    pub fn is_through(&self, cursor: Cursor, way: Direction) -> bool {
        let page = self.page();
        let first = page.session.as_ref().ok().and_then(|session| session.position.cursor).unwrap_or_default();
        let order = |cursor: Cursor| (cursor.unit, cursor.event);
        match way {
            Direction::Forward => page.until.is_none_or(|until| order(cursor) >= order(until)),
            Direction::Back => order(cursor) <= order(first),
        }
    }

    /// How pictures look without what the page sets.
    pub fn without_page(&self, look: Look) -> Look {
        self.page().session.as_ref().map_or(look, |session| session.look.undone(look, self.look))
    }

    /// The lesson that follows in the course, if this is a bundled one with a successor.
    pub fn next(&self) -> Option<&'static Lesson> {
        let mut after = bundled::all().iter().skip_while(|lesson| Address::from(*lesson).lesson != self.address.lesson);
        after.nth(1)
    }

    /// Reads the lesson anew if its file was written since; gives whether its page has changed.
    ///
    /// # Errors
    /// If it cannot be read any more; the old one stays.
    pub fn follow(&mut self) -> Result<bool, Error> {
        if !self.watch.as_ref().is_some_and(Watch::take) {
            return Ok(false);
        }
        self.read_anew()
    }

    fn read_anew(&mut self) -> Result<bool, Error> {
        let Some(path) = self.address.file() else { return Ok(false) };
        let lesson = Lesson::load(path)?;
        let before = self.page().session.clone().ok();
        self.address.page = self.address.page.min(lesson.pages.len() - 1);
        self.lesson = lesson;
        Ok(self.page().session.as_ref().ok() != before.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const TEXT: &str = "# Title\n+++\ntitle = \"One\"\nclip = \"synth:pillar\"\nestimator = \"full-search\"\nstep = \"2.0\"\n\
        until = \"2.3\"\npicture = { view = \"blend\" }\n+++\nOne.\n+++\ntitle = \"Two\"\n+++\nTwo.\n";

    fn open(path: &Path) -> OpenLesson {
        let address = Address::parse(path.as_os_str()).expect("a lesson");
        OpenLesson::new(address, Look::default(), || {}).unwrap_or_else(|why| panic!("{why}"))
    }

    #[test]
    fn a_page_is_through_at_its_last_step() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lesson.md");
        std::fs::write(&path, TEXT).expect("a file");
        let mut open = open(&path);
        let at = |event| Cursor { unit: 1, event };
        let through = |open: &OpenLesson, event, way| open.is_through(at(event), way);
        assert!(!through(&open, 2, Direction::Forward) && through(&open, 3, Direction::Forward));
        assert!(through(&open, 0, Direction::Back) && !through(&open, 1, Direction::Back));
        assert!(open.is_at(Direction::Back) && !open.is_at(Direction::Forward));
        let set = open.page().session.as_ref().map(|session| session.look.over(Look::default()));
        let set = set.unwrap_or_else(|why| panic!("{why}"));
        assert_ne!(set, Look::default());
        assert_eq!(open.without_page(set), Look::default(), "the view goes with its page");
        open.turn(Direction::Forward);
        assert!(open.is_at(Direction::Forward) && through(&open, 0, Direction::Forward));
    }

    #[test]
    fn a_lesson_is_read_anew_when_its_file_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lesson.md");
        std::fs::write(&path, TEXT).expect("a file");
        let mut open = open(&path);
        open.turn(Direction::Forward);
        let rewrite = |open: &mut OpenLesson, text: &str| {
            std::fs::write(&path, text).expect("a file");
            open.read_anew()
        };
        assert_eq!(rewrite(&mut open, &TEXT.replace("Two.", "Three.")).ok(), Some(false), "its words alone");
        assert_eq!(open.words().map(Prose::plain).ok().as_deref(), Some("Three."));
        assert_eq!(rewrite(&mut open, &TEXT.replace("\"2.0\"", "\"4.0\"")).ok(), Some(true));
        assert!(rewrite(&mut open, "nothing").is_err());
        assert_eq!(open.page().title, "Two", "the old one stays");
    }
}
