//! Laws of lockstep: what stands side by side is what each estimator shows alone, and nobody gets more than the others.

use motionscope_core::base::Threads;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::BlockField;
use motionscope_core::run::{AnyEstimator, Beside, CandidateCount, Cursor, Direction, Move, Pace, Walk, lockstep};
use motionscope_core::scene::{Focus, Readout, Scene, Step};
use motionscope_core::synth;

const TEAMS: [&[&str]; 4] = [
    &["full-search", "three-step", "diamond", "predictive"],
    &["diamond", "full-search"],
    &["hierarchical", "three-step", "full-search"],
    &["adaptive-rood", "hierarchical"],
];

fn clip() -> Clip {
    let texture = |x: usize, y: usize| ((x * 31 + y * 57) ^ (x * y / 3)) as u8;
    let frame = |shift: usize| Frame::gray(Grid::from_fn(44, 36, |x, y| texture(x + 4 - shift, y + shift)));
    Clip::from_frames("shift", vec![frame(0), frame(2)]).expect("frames of one size")
}

/// Parameters small enough that whole runs can be walked.
fn small(id: &str) -> Box<dyn AnyEstimator> {
    let mut estimator = estimator(id).expect("an estimator");
    for (name, value) in [("block-size", "8"), ("search-range", "3"), ("levels", "3")] {
        if estimator.get(name).is_ok() {
            estimator.set(name, value).expect("in range");
        }
    }
    estimator
}

fn team(ids: &[&str]) -> Vec<Box<dyn AnyEstimator>> {
    ids.iter().map(|id| small(id)).collect()
}

fn refused_or_run(estimators: &[Box<dyn AnyEstimator>], pace: Pace) -> Result<Box<dyn Walk>, String> {
    let estimators: Vec<_> = estimators.iter().map(|estimator| &**estimator).collect();
    lockstep::walk(&estimators, pace, (&clip(), 0), &Threads::single()).map_err(|error| error.to_string())
}

fn in_lockstep(ids: &[&str], pace: Pace) -> Box<dyn Walk> {
    refused_or_run(&team(ids), pace).expect("a run")
}

/// One stop of an estimator that walks alone.
struct Stop {
    cursor: Cursor,
    step: Step,
    scene: Scene,
    /// Candidates tested so far in all.
    tested: u64,
    ends_unit: bool,
}

/// Every stop of an estimator that walks alone.
fn alone(id: &str) -> Vec<Stop> {
    let mut walk = small(id).walk(&clip(), 0).expect("a walk");
    let stop = |walk: &dyn Walk| Stop {
        cursor: walk.cursor(),
        step: walk.step(None),
        scene: walk.scene(None),
        tested: walk.evaluated(),
        ends_unit: walk.cursor().event == walk.events(),
    };
    let mut stops = vec![stop(&*walk)];
    while !walk.at_end() {
        walk.jump(Move::Granularity(walk.info().granularities.len() - 1, Direction::Forward));
        stops.push(stop(&*walk));
    }
    stops
}

/// Where an estimator of `stops` stands that tested `candidates` candidates of the units in `way`: as late as it can
/// without ending the unit, and at the end of the last unit if it is to have tested more than there are.
fn stand<'a>(stops: &'a [Stop], way: &[usize], mut candidates: u64) -> &'a Stop {
    for unit in way {
        let inside: Vec<_> = stops.iter().filter(|stop| stop.cursor.unit == *unit && stop.cursor.event > 0).collect();
        let (before, all) = (inside[0].tested, inside[inside.len() - 1].tested);
        if candidates <= all - before {
            let late = inside.iter().rev().find(|stop| stop.tested == before + candidates && !stop.ends_unit);
            return late.expect("the unit tells more than its end");
        }
        candidates -= all - before;
    }
    let last = way.last().expect("a unit");
    stops.iter().rev().find(|stop| stop.cursor.unit == *last).expect("its end")
}

/// What a step tells but for where a click on its readouts leads, and the events that it names for that.
fn explained(mut step: Step) -> (String, Vec<usize>) {
    let mut named = Vec::new();
    for readout in &mut step.readouts {
        match readout {
            Readout::Series(series) => named.append(&mut series.events),
            Readout::Surface(surface) => surface.events.cells_mut().fill(None),
            _ => {}
        }
    }
    // What is not known yet is NaN, which is the same here.
    (format!("{step:?}"), named)
}

fn shows(member: &Beside, stop: &Stop) -> bool {
    let told = explained(member.step.clone()).0 == explained(stop.step.clone()).0;
    member.cursor == stop.cursor && told && member.scene.same(&stop.scene) && counted(member).in_all == stop.tested
}

fn counted(member: &Beside) -> CandidateCount {
    member.candidates.expect("block searches count their candidates")
}

fn forward(walk: &mut dyn Walk) {
    walk.jump(Move::Granularity(2, Direction::Forward));
}

#[test]
fn each_shows_what_it_shows_alone_at_the_same_candidate() {
    for ids in TEAMS {
        let mut walk = in_lockstep(ids, Pace::Block);
        let alone: Vec<_> = ids.iter().map(|id| alone(id)).collect();
        let ways: Vec<_> = ids.iter().map(|id| small(id).walk(&clip(), 0).expect("a walk")).collect();
        assert!(walk.beside(None).iter().zip(&alone).all(|(member, stops)| shows(member, &stops[0])));
        let mut units = 0;
        while !walk.at_end() {
            forward(&mut *walk);
            let Cursor { unit, event } = walk.cursor();
            units = units.max(unit + 1);
            for ((member, stops), solo) in walk.beside(None).iter().zip(&alone).zip(&ways) {
                let way = solo.way_to(unit);
                let stop = stand(stops, &way, event as u64);
                let id = member.info.id;
                assert!(shows(member, stop), "{id} at {}: {} and not {}", walk.cursor(), member.cursor, stop.cursor);
                assert_eq!(member.is_done, stop.ends_unit && stop.cursor.unit == way[way.len() - 1], "{id}");
                let leg = way.iter().position(|unit| *unit == stop.cursor.unit).expect("a unit of its way");
                assert_eq!(counted(member).leg, (leg + 1, way.len()), "{id}");
                let named = explained(member.step.clone()).1;
                assert!(named.windows(2).all(|pair| pair[0] + 1 == pair[1]), "candidates one after the other");
                assert!(named.last().is_none_or(|last| *last == counted(member).here), "{id}: {named:?}");
                let here = counted(member).here;
                assert!(here == event || here < event && member.is_done, "{id}");
            }
            let waiting = walk.beside(None).iter().any(|member| !member.is_done);
            assert_eq!(waiting, event < walk.events(), "a block ends when the last is done, and not later");
        }
        assert_eq!(units, 6 * 5, "one unit for each block of the picture");
    }
}

#[test]
fn back_is_forward_reversed_and_seeking_is_walking() {
    for (ids, pace) in TEAMS.into_iter().flat_map(|ids| [(ids, Pace::Block), (ids, Pace::Budget)]) {
        let explained = |walk: &dyn Walk| format!("{} {} {:?}", walk.cursor(), walk.events(), walk.beside(None));
        let mut walk = in_lockstep(ids, pace);
        let mut views = vec![(walk.cursor(), explained(&*walk))];
        while !walk.at_end() && views.len() < 700 {
            forward(&mut *walk);
            views.push((walk.cursor(), explained(&*walk)));
        }
        for (cursor, view) in views.iter().rev() {
            assert!(*view == explained(&*walk), "walking back to {cursor}");
            walk.jump(Move::Granularity(2, Direction::Back));
        }
        for i in 0..60 {
            let (cursor, view) = &views[(i * 7919 + 13) % views.len()];
            walk.go(Move::To(*cursor));
            while !walk.work(&mut || false) {}
            assert!(*view == explained(&*walk), "seeking {cursor} in slices");
        }
        walk.jump(Move::End);
        assert!(walk.at_end() && Some(walk.cursor().unit + 1) == walk.units());
        let end = walk.cursor();
        for granularity in 0..3 {
            walk.jump(Move::Granularity(granularity, Direction::Forward));
            assert_eq!(walk.cursor(), end, "there is nothing beyond the end");
        }
        walk.jump(Move::Granularity(1, Direction::Back));
        assert_eq!((walk.cursor().unit + 1, walk.cursor().event), (end.unit, walk.events()));
        walk.jump(Move::Granularity(0, Direction::Back));
        assert_eq!(walk.cursor(), Cursor::default());
    }
}

#[test]
fn nobody_spends_more_than_the_leader() {
    for ids in TEAMS {
        let mut walk = in_lockstep(ids, Pace::Budget);
        let totals: Vec<u64> = ids.iter().map(|id| alone(id).last().expect("an end").tested).collect();
        let mut budget = 0;
        while !walk.at_end() {
            forward(&mut *walk);
            let beside = walk.beside(None);
            let is_told = walk.cursor().event == walk.events();
            budget += u64::from(!is_told);
            for (member, total) in beside.iter().zip(&totals) {
                assert_eq!(counted(member).in_all, budget.min(*total), "{} at {}", member.info.id, walk.cursor());
                assert!(!member.is_done || budget >= *total);
                assert!(member.is_done || budget < *total || budget == *total && !is_told, "{}", member.info.id);
            }
        }
        assert_eq!(budget, totals[0], "the run ends where the leader's ends");
        let solo = alone(ids[1]);
        let member = &walk.beside(None)[1];
        assert!(explained(member.step.clone()).1.is_empty(), "its candidates are not those of the leader's block");
        assert!(solo.iter().any(|stop| shows(member, stop)), "it shows what it shows alone");
    }
}

#[test]
fn the_end_is_what_each_finds_in_a_run() {
    for (ids, pace) in TEAMS.into_iter().flat_map(|ids| [(ids, Pace::Block), (ids, Pace::Budget)]) {
        let mut walk = in_lockstep(ids, pace);
        walk.jump(Move::End);
        let run = small(ids[0]).run(&clip(), 0, &Threads::single()).expect("a run");
        assert_eq!(walk.output(), run, "{ids:?}");
        for (member, id) in walk.beside(None).iter().zip(ids).filter(|(member, _)| member.is_done) {
            let Some(field) =
                small(id).run(&clip(), 0, &Threads::single()).expect("a run").get::<BlockField>().cloned()
            else {
                panic!("no blocks")
            };
            assert_eq!(counted(member).in_all, field.candidates(), "{id}");
            assert!(shows(member, alone(id).last().expect("an end")), "{id}");
        }
    }
}

#[test]
fn what_a_run_spends_is_what_its_events_show() {
    let mut all = motionscope_core::course::estimators();
    all.retain(|estimator| estimator.info().family == "Block matching");
    for (estimator, subpixel) in all.iter().flat_map(|one| ["none", "quarter", "parabola"].map(|fine| (one, fine))) {
        let mut estimator = small(estimator.info().id);
        estimator.set("subpixel", subpixel).expect("every block search can be refined");
        let units = estimator.evaluations(&clip(), 0, &Threads::single()).expect("a run");
        let mut walk = estimator.walk(&clip(), 0).expect("a walk");
        for (unit, &count) in units.iter().enumerate() {
            walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
            assert_eq!(walk.evaluations().len(), count as usize, "{} in unit {unit}", estimator.info().id);
        }
        assert!(walk.at_end());
    }
}

#[test]
fn a_block_is_reached_over_all_levels() {
    let walk = small("hierarchical").walk(&clip(), 0).expect("a walk");
    let units = walk.units().expect("they are known");
    for block in 0..6 * 5 {
        let way = walk.way_to(block);
        assert_eq!((way.len(), way[2]), (3, units - 6 * 5 + block), "the blocks of the picture come last");
        assert!(way.is_sorted() && way[0] < 2 * 2 && way[1] < 2 * 2 + 3 * 3, "one block of each level: {way:?}");
    }
}

#[test]
fn a_click_leads_to_the_block_there() {
    for pace in [Pace::Block, Pace::Budget] {
        let walk = in_lockstep(&["diamond", "full-search"], pace);
        assert_eq!(walk.unit_at(Focus::current([17.0, 9.0])), Some(6 + 2));
        assert_eq!(walk.unit_at(Focus::current([99.0, 9.0])), None);
    }
    assert_eq!(
        in_lockstep(&["hierarchical", "diamond"], Pace::Block).unit_at(Focus::current([17.0, 9.0])),
        Some(6 + 2)
    );
}

#[test]
fn what_cannot_stand_side_by_side_is_refused_in_a_sentence() {
    let refused = |estimators: &[Box<dyn AnyEstimator>]| {
        refused_or_run(estimators, Pace::Block).err().unwrap_or_else(|| "nothing was refused".into())
    };
    assert!(refused(&team(&["diamond"])).contains("2 to 4 estimators"));
    assert!(refused(&team(&["diamond", "hexagon", "three-step", "full-search", "predictive"])).contains("not 5"));
    assert!(refused(&team(&["diamond", "harris", "kalman-tracker"])).contains("Kalman tracker on a whole clip"));
    assert!(refused(&team(&["diamond", "horn-schunck"])).contains("by block; choose result"));
    let mut different = team(&["diamond", "diamond"]);
    different[1].set("search-range", "2").expect("in range");
    assert!(refused_or_run(&different, Pace::Block).is_ok(), "one estimator set differently is worth a look");
    different[1].set("block-size", "9").expect("in range");
    assert!(refused(&different).contains("same block size and spacing"));
    let mut high = team(&["diamond", "hierarchical"]);
    high[1].set("levels", "6").expect("in range");
    assert!(
        refused(&high).starts_with("hierarchical: with 6 levels"),
        "it is told which one cannot run: {}",
        refused(&high)
    );
}

/// A clip on which all estimators that step through frames, iterations or levels have something to do.
fn moving() -> Clip {
    let scene = synth::scene("traffic").expect("bundled");
    let mut difficulty = scene.difficulty();
    for (name, value) in [("width", "96"), ("height", "64"), ("frames", "4")] {
        motionscope_core::params::Params::set(&mut difficulty, name, value).expect("in range");
    }
    synth::make("traffic", &difficulty).expect("a clip")
}

/// Every estimator beside the next ones of the registry that can go with it, at every pace.
fn teams() -> Vec<(Vec<Box<dyn AnyEstimator>>, Pace)> {
    let all = estimators();
    let mut teams = Vec::new();
    for (i, leader) in all.iter().enumerate() {
        let others = all.iter().cycle().skip(i + 1).take(all.len() - 1);
        for pace in Pace::ALL.into_iter().filter(|pace| !pace.counts_candidates()) {
            let suits = |other: &&dyn AnyEstimator| lockstep::paces(&[&**leader, *other]).contains(&pace);
            let Some(other) = others.clone().map(|other| &**other).find(suits) else { continue };
            teams.push((vec![leader.boxed_clone(), other.boxed_clone()], pace));
        }
    }
    teams
}

/// The same run as `member`, at its place by itself.
fn by_itself(estimator: &dyn AnyEstimator, clip: &Clip, cursor: Cursor) -> Box<dyn Walk> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    walk.jump(Move::To(cursor));
    walk
}

#[test]
fn every_family_goes_in_lockstep_and_shows_what_each_shows_alone() {
    let clip = moving();
    let mut paces = Vec::new();
    for (team, pace) in teams() {
        let all: Vec<_> = team.iter().map(|estimator| &**estimator).collect();
        let ids: Vec<_> = all.iter().map(|estimator| estimator.info().id).collect();
        let mut walk = match lockstep::walk(&all, pace, (&clip, 0), &Threads::single()) {
            Ok(walk) => walk,
            Err(error) => panic!("{ids:?} {pace:?}: {error}"),
        };
        paces.push(pace);
        assert_eq!((walk.cursor(), walk.at_end()), (Cursor::default(), false), "{ids:?} {pace:?}");
        // Some stops, forward and inside, the end, and back.
        let moves =
            [(2, Direction::Forward), (2, Direction::Forward), (1, Direction::Forward), (2, Direction::Forward)];
        let mut seen = Vec::new();
        for (granularity, direction) in moves.into_iter().chain([(0, Direction::Forward), (2, Direction::Back)]) {
            walk.jump(Move::Granularity(granularity, direction));
            assert!(walk.failure().is_none(), "{ids:?} {pace:?}: {:?}", walk.failure());
            seen.push(walk.cursor());
            for (estimator, member) in all.iter().zip(walk.beside(None)) {
                let alone = by_itself(*estimator, &clip, member.cursor);
                let what = format!("{ids:?} {pace:?} at {}: {}", walk.cursor(), estimator.info().id);
                assert_eq!(alone.cursor(), member.cursor, "{what}");
                assert!(explained(alone.step(None)).0 == explained(member.step.clone()).0, "{what}");
                assert!(alone.scene(None).same(&member.scene) && alone.output() == member.output, "{what}");
            }
        }
        let end = seen[4];
        assert!(seen[..4].iter().all(|cursor| *cursor <= end) && seen[5] < end, "{ids:?} {pace:?}: {seen:?}");
        // Going there at once, and in slices, leads to the same place.
        let view = |walk: &dyn Walk| format!("{} {} {:?}", walk.cursor(), walk.events(), walk.beside(None));
        let mut again = lockstep::walk(&all, pace, (&clip, 0), &Threads::single()).expect("a run");
        for cursor in [seen[1], seen[5], seen[2], end] {
            walk.jump(Move::To(cursor));
            again.go(Move::To(cursor));
            while !again.work(&mut || false) {}
            assert_eq!(again.cursor(), cursor, "{ids:?} {pace:?}");
            assert!(view(&*walk) == view(&*again), "{ids:?} {pace:?} at {cursor}");
        }
        assert!(walk.at_end() && walk.units() == Some(end.unit + 1), "{ids:?} {pace:?}: {:?}", walk.units());
        walk.jump(Move::Granularity(2, Direction::Forward));
        assert_eq!(walk.cursor(), end, "there is nothing beyond the end");
        walk.jump(Move::Granularity(0, Direction::Back));
        assert_eq!(walk.cursor(), Cursor::default());
    }
    for pace in [Pace::Frame, Pace::Iteration, Pace::Level, Pace::Stage, Pace::Result] {
        assert!(paces.contains(&pace), "no team goes by {pace:?}");
    }
}

#[test]
fn background_models_stand_at_the_same_stage_of_the_same_frame() {
    let (clip, mut compared) = (moving(), 0);
    let models: Vec<_> = estimators().into_iter().filter(|one| one.info().id.ends_with("background")).collect();
    let mixture = estimator("mixture-of-gaussians").expect("bundled");
    for model in models {
        let team: [&dyn AnyEstimator; 2] = [&*model, &*mixture];
        let mut walk = lockstep::walk(&team, Pace::Frame, (&clip, 0), &Threads::single()).expect("a run");
        while !walk.at_end() {
            forward(&mut *walk);
            let beside = walk.beside(None);
            let own: Vec<_> =
                team.iter().zip(&beside).map(|(one, member)| by_itself(*one, &clip, member.cursor)).collect();
            assert!(own.iter().all(|own| own.at_frame() == walk.at_frame()), "at {}", walk.cursor());
            let [first, second] = [0, 1].map(|i| own[i].stages()[..beside[i].cursor.event].last().copied());
            let names = [own[0].stages(), own[1].stages()];
            let is_shared = |name| names.iter().all(|names| names.contains(&name));
            // Where they differ, one of them waits while the other does what it has not.
            let waits = [first, second].into_iter().flatten().any(|name| !is_shared(name));
            assert!(first == second || waits, "{first:?} beside {second:?} at {}", walk.cursor());
            compared += usize::from(first == second);
        }
    }
    assert!(compared > 40, "{compared} stages");
}
