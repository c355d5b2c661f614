//! Laws of lockstep: what stands side by side is what each estimator shows alone, and nobody gets more than the others.

use motionscope_core::scene::Focus;
use motionscope_core::scene::Readout;
use motionscope_core::{
    AnyEstimator, Beside, BlockField, Clip, Cursor, Direction, Frame, Grid, Lockstep, Move, Pace, Scene, Step, Threads,
    Walk, estimator,
};

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
    for (name, value) in [("block", "8"), ("range", "3"), ("levels", "3")] {
        if estimator.get(name).is_ok() {
            estimator.set(name, value).expect("in range");
        }
    }
    estimator
}

fn team(ids: &[&str]) -> Vec<Box<dyn AnyEstimator>> {
    ids.iter().map(|id| small(id)).collect()
}

fn refused_or_run(estimators: &[Box<dyn AnyEstimator>], pace: Pace) -> Result<Lockstep, String> {
    let estimators: Vec<_> = estimators.iter().map(|estimator| &**estimator).collect();
    Lockstep::new(&estimators, pace, (&clip(), 0), &Threads::single()).map_err(|error| error.to_string())
}

fn lockstep(ids: &[&str], pace: Pace) -> Lockstep {
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
fn told(mut step: Step) -> (String, Vec<usize>) {
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
    let told = told(member.step.clone()).0 == told(stop.step.clone()).0;
    member.cursor == stop.cursor && told && member.scene.same(&stop.scene) && member.candidates_in_all == stop.tested
}

fn forward(walk: &mut Lockstep) {
    walk.jump(Move::Granularity(2, Direction::Forward));
}

#[test]
fn each_shows_what_it_shows_alone_at_the_same_candidate() {
    for ids in TEAMS {
        let mut walk = lockstep(ids, Pace::Block);
        let alone: Vec<_> = ids.iter().map(|id| alone(id)).collect();
        let ways: Vec<_> = ids.iter().map(|id| small(id).walk(&clip(), 0).expect("a walk")).collect();
        assert!(walk.beside(None).iter().zip(&alone).all(|(member, stops)| shows(member, &stops[0])));
        let mut units = 0;
        while !walk.at_end() {
            forward(&mut walk);
            let Cursor { unit, event } = walk.cursor();
            units = units.max(unit + 1);
            for ((member, stops), solo) in walk.beside(None).iter().zip(&alone).zip(&ways) {
                let way = solo.way_to(unit);
                let stop = stand(stops, &way, event as u64);
                let id = member.info.id;
                assert!(shows(member, stop), "{id} at {}: {} and not {}", walk.cursor(), member.cursor, stop.cursor);
                assert_eq!(member.is_done, stop.ends_unit && stop.cursor.unit == way[way.len() - 1], "{id}");
                let leg = way.iter().position(|unit| *unit == stop.cursor.unit).expect("a unit of its way");
                assert_eq!(member.leg, (leg + 1, way.len()), "{id}");
                let named = told(member.step.clone()).1;
                assert!(named.windows(2).all(|pair| pair[0] + 1 == pair[1]), "candidates one after the other");
                assert!(named.last().is_none_or(|last| *last == member.candidates), "{id}: {named:?}");
                assert!(member.candidates == event || member.candidates < event && member.is_done, "{id}");
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
        let told = |walk: &Lockstep| format!("{} {} {:?}", walk.cursor(), walk.events(), walk.beside(None));
        let mut walk = lockstep(ids, pace);
        let mut views = vec![(walk.cursor(), told(&walk))];
        while !walk.at_end() && views.len() < 700 {
            forward(&mut walk);
            views.push((walk.cursor(), told(&walk)));
        }
        for (cursor, view) in views.iter().rev() {
            assert!(*view == told(&walk), "walking back to {cursor}");
            walk.jump(Move::Granularity(2, Direction::Back));
        }
        for i in 0..60 {
            let (cursor, view) = &views[(i * 7919 + 13) % views.len()];
            walk.go(Move::To(*cursor));
            while !walk.work(&mut || false) {}
            assert!(*view == told(&walk), "seeking {cursor} in slices");
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
        let mut walk = lockstep(ids, Pace::Budget);
        let totals: Vec<u64> = ids.iter().map(|id| alone(id).last().expect("an end").tested).collect();
        let mut budget = 0;
        while !walk.at_end() {
            forward(&mut walk);
            let beside = walk.beside(None);
            let is_told = walk.cursor().event == walk.events();
            budget += u64::from(!is_told);
            for (member, total) in beside.iter().zip(&totals) {
                assert_eq!(member.candidates_in_all, budget.min(*total), "{} at {}", member.info.id, walk.cursor());
                assert!(!member.is_done || budget >= *total);
                assert!(member.is_done || budget < *total || budget == *total && !is_told, "{}", member.info.id);
            }
        }
        assert_eq!(budget, totals[0], "the run ends where the leader's ends");
        let solo = alone(ids[1]);
        let member = &walk.beside(None)[1];
        assert!(told(member.step.clone()).1.is_empty(), "its candidates are not those of the leader's block");
        assert!(solo.iter().any(|stop| shows(member, stop)), "it shows what it shows alone");
    }
}

#[test]
fn the_end_is_what_each_finds_in_a_run() {
    for (ids, pace) in TEAMS.into_iter().flat_map(|ids| [(ids, Pace::Block), (ids, Pace::Budget)]) {
        let mut walk = lockstep(ids, pace);
        walk.jump(Move::End);
        let run = small(ids[0]).run(&clip(), 0, &Threads::single()).expect("a run");
        assert_eq!(walk.output(), run, "{ids:?}");
        for (member, id) in walk.beside(None).iter().zip(ids).filter(|(member, _)| member.is_done) {
            let Some(field) =
                small(id).run(&clip(), 0, &Threads::single()).expect("a run").get::<BlockField>().cloned()
            else {
                panic!("no blocks")
            };
            assert_eq!(member.candidates_in_all, field.candidates(), "{id}");
            assert!(shows(member, alone(id).last().expect("an end")), "{id}");
        }
    }
}

#[test]
fn what_a_run_spends_is_what_its_events_show() {
    let mut all = motionscope_core::estimators();
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
        let walk = lockstep(&["diamond", "full-search"], pace);
        assert_eq!(walk.unit_at(Focus::current([17.0, 9.0])), Some(6 + 2));
        assert_eq!(walk.unit_at(Focus::current([99.0, 9.0])), None);
    }
    assert_eq!(lockstep(&["hierarchical", "diamond"], Pace::Block).unit_at(Focus::current([17.0, 9.0])), Some(6 + 2));
}

#[test]
fn what_cannot_stand_side_by_side_is_refused_in_a_sentence() {
    let refused = |estimators: &[Box<dyn AnyEstimator>]| {
        refused_or_run(estimators, Pace::Block).err().unwrap_or_else(|| "nothing was refused".into())
    };
    assert!(refused(&team(&["diamond"])).contains("2 to 4 estimators"));
    assert!(refused(&team(&["diamond", "hexagon", "three-step", "full-search", "predictive"])).contains("not 5"));
    assert!(refused(&team(&["diamond", "hexagon", "diamond"])).contains("diamond is there twice"));
    let mut different = team(&["diamond", "diamond"]);
    different[1].set("range", "2").expect("in range");
    assert!(refused_or_run(&different, Pace::Block).is_ok(), "one estimator set differently is worth a look");
    different[1].set("block", "9").expect("in range");
    assert!(refused(&different).contains("same block size and spacing"));
    let mut high = team(&["diamond", "hierarchical"]);
    high[1].set("levels", "6").expect("in range");
    assert!(
        refused(&high).starts_with("hierarchical: with 6 levels"),
        "it is told which one cannot run: {}",
        refused(&high)
    );
}
