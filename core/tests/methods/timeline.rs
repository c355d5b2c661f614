//! Time travel on a toy estimator: levels of items, an end that nobody knows beforehand, and a damaged frame.

use motionscope_core::base::{Error, Observer};
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Border, Grid};
use motionscope_core::products::{BlockField, BlockGrid, BlockVector, Output, Product, ProductKind};
use motionscope_core::run::{
    Cursor, Direction, Estimator, Footprint, Granularity, Info, Move, Need, Progress, Seen, Timeline, Walk,
};
use motionscope_core::scene::{Scene, Step};
use motionscope_core::{params, pseudocode};

params! {
    /// Counts items, level by level.
    pub struct Toy {
        /// Items in each level.
        items: usize = 7, 1..=100;
        /// Levels.
        levels: usize = 3, 1..=10;
        /// The item that cannot be done.
        damaged: usize = 1000, 1..=1000;
    }
}

pseudocode! {
    COUNT: "count",
}

impl Estimator for Toy {
    const INFO: Info = Info {
        id: "toy",
        name: "Toy",
        family: "Toys",
        summary: "Counts.",
        source: "none",
        pseudocode: line::ALL,
        granularities: &["run", "level", "item", "event"],
        frames: 1,
    };
    const PRODUCES: &'static [&'static ProductKind] = &[BlockField::KIND];
    /// Items done, and 1 KiB of ballast.
    type State = (usize, Vec<u8>);
    type Event = usize;

    fn start(&self, _: &Clip, _: usize) -> Result<Self::State, Error> {
        Ok((0, vec![7; 1024]))
    }

    fn advance(
        &self,
        _: &Clip,
        state: &mut Self::State,
        observer: &mut impl Observer<usize>,
    ) -> Result<Progress, Error> {
        if state.0 == self.damaged {
            return Err(Error::new("frame 5 is damaged"));
        }
        for event in 0..=state.0 % 3 {
            observer.see(|| event);
        }
        state.0 += 1;
        Ok(if state.0 == self.items * self.levels { Progress::Done } else { Progress::More })
    }

    fn units(&self, _: &Self::State) -> Option<usize> {
        None
    }

    fn place(&self, state: &Self::State) -> Vec<Granularity> {
        let granularity = |index| Granularity { index, of: None };
        vec![granularity(0), granularity(state.0 / self.items), granularity(state.0 % self.items)]
    }

    fn step(&self, _: &Seen<Self>) -> Step {
        Step::at(line::COUNT)
    }

    fn draw(&self, _: &Seen<Self>, _: &mut Scene) {}

    fn output(&self, state: &Self::State) -> Output {
        let blocks = BlockGrid { picture: (1, 1), size: 1, step: 1 };
        Output::of(BlockField {
            blocks,
            vectors: vec![Some(BlockVector { displacement: [0.0; 2], cost: 0.0, candidates: 1 }); state.0],
            cost: "none",
            border: Border::Replicate,
            filter: motionscope_core::data::Interpolation::Bilinear,
        })
    }
}

impl Footprint<(usize, Vec<u8>)> for Toy {
    fn need(&self, _: &Clip) -> Need {
        Need::default()
    }

    fn state_bytes(&self, state: &(usize, Vec<u8>)) -> usize {
        state.1.len()
    }
}

fn clip() -> Clip {
    Clip::from_frames("dot", vec![Frame::gray(Grid::new(1, 1, 0))]).expect("sound")
}

fn toy(items: usize, levels: usize, damaged: usize) -> Timeline<Toy> {
    Timeline::new(Toy { items, levels, damaged }, clip(), 0).expect("sound")
}

fn done(walk: &dyn Walk) -> u64 {
    let Some(field) = walk.output().get::<BlockField>().cloned() else { panic!("no blocks") };
    field.candidates()
}

fn end_of(walk: &dyn Walk, unit: usize) -> bool {
    walk.cursor() == Cursor { unit, event: walk.events() } && walk.events() == unit % 3 + 1
}

#[test]
fn the_end_is_found_where_nobody_knew_it() {
    let mut walk = toy(7, 3, 1000);
    assert_eq!((walk.units(), walk.cursor()), (None, Cursor::default()));
    walk.jump(Move::End);
    assert!(walk.at_end() && end_of(&walk, 20) && walk.units() == Some(21) && done(&walk) == 21);
    walk.jump(Move::Granularity(3, Direction::Forward));
    assert!(end_of(&walk, 20), "there is nothing beyond the end");
}

#[test]
fn levels_end_where_they_end_in_both_directions() {
    let mut walk = toy(7, 3, 1000);
    for unit in [6, 13, 20] {
        walk.jump(Move::Granularity(1, Direction::Forward));
        assert!(end_of(&walk, unit), "{}", walk.cursor());
    }
    for unit in [13, 6] {
        walk.jump(Move::Granularity(1, Direction::Back));
        assert!(end_of(&walk, unit), "{}", walk.cursor());
    }
    walk.jump(Move::Granularity(2, Direction::Forward));
    walk.jump(Move::Granularity(1, Direction::Back));
    assert!(end_of(&walk, 6), "from the middle of a level to the end of the one before");
    walk.jump(Move::Granularity(1, Direction::Back));
    assert_eq!(walk.cursor(), Cursor::default());
    walk.jump(Move::To(Cursor { unit: 9, event: 1 }));
    walk.jump(Move::Granularity(1, Direction::Forward));
    assert!(end_of(&walk, 13), "out of the middle of a level to its end");
}

#[test]
fn a_damaged_frame_ends_the_run_and_what_was_done_stays() {
    for to in [Move::End, Move::To(Cursor { unit: 12, event: 1 }), Move::To(Cursor { unit: 15, event: 0 })] {
        let mut walk = toy(7, 3, 12);
        walk.jump(to);
        assert!(end_of(&walk, 11) && walk.at_end() && done(&walk) == 12);
        assert_eq!(walk.failure().unwrap().to_string(), "frame 5 is damaged");
        walk.jump(Move::Granularity(3, Direction::Back));
        assert_eq!(walk.cursor(), Cursor { unit: 11, event: 2 });
    }
    assert!(Timeline::new(Toy { items: 2, levels: 1, damaged: 1 }, clip(), 0).is_ok());
}

#[test]
fn checkpoints_keep_to_their_budget() {
    let mut walk = toy(100, 10, 1000).with_budget(20 << 10);
    walk.jump(Move::End);
    assert!(walk.checkpoint_bytes() <= 20 << 10 && walk.checkpoint_bytes() >= 10 << 10);
    for unit in [500, 3, 999, 998, 0, 731] {
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        assert!(end_of(&walk, unit) && done(&walk) == unit as u64 + 1);
        let mut slices = 0;
        walk.go(Move::Granularity(2, Direction::Back));
        while !walk.work(&mut || false) {
            slices += 1;
        }
        assert!(slices <= 64, "a step back runs at most one stride again, not {slices} units");
    }
}

#[test]
fn a_new_move_replaces_an_unfinished_one() {
    let mut walk = toy(100, 10, 1000);
    walk.go(Move::To(Cursor { unit: 900, event: 1 }));
    assert!(!walk.work(&mut || false));
    walk.jump(Move::Granularity(3, Direction::Forward));
    assert_eq!(walk.cursor(), Cursor { unit: 0, event: 1 });
}

#[test]
fn a_jump_ends_where_it_is_no_longer_wanted() {
    let mut walk = toy(100, 10, 1000);
    let (units, asked) = (900, std::cell::Cell::new(0));
    let wanted_until = |last: usize| {
        asked.set(0);
        let asked = &asked;
        move || {
            asked.set(asked.get() + 1);
            asked.get() <= last
        }
    };
    let to = Move::To(Cursor { unit: units, event: 1 });
    for last in [0, 1, 20] {
        assert!(!walk.jump_while(to, &wanted_until(last)));
        assert_eq!(walk.cursor(), Cursor::default(), "it stays where it was");
        assert!(asked.get() <= last + 2, "it ends at once, not after being asked {} times", asked.get());
    }
    assert!(walk.jump_while(to, &wanted_until(usize::MAX)));
    assert_eq!(walk.cursor(), Cursor { unit: units, event: 1 });
}

#[test]
fn cursors_are_read_as_they_are_written() {
    let cursor = Cursor { unit: 34, event: 412 };
    assert_eq!((cursor.to_string().as_str(), "35.412".parse()), ("35.412", Ok(cursor)));
    assert_eq!("35".parse(), Ok(Cursor { unit: 34, event: usize::MAX }));
    for start in ["0", "0.0"] {
        assert_eq!(start.parse(), Ok(Cursor::default()));
    }
    assert_eq!(Cursor { unit: 34, event: usize::MAX }.to_string(), "35");
    assert_eq!(Cursor::default().to_string(), "0");
    for text in ["", ".", "1.", "-1", "a.2", "1.2.3", "0.1"] {
        assert!(text.parse::<Cursor>().is_err(), "{text}");
    }
}
