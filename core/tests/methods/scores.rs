//! Scores of tracks against recorded results of others.

use motionscope_core::geometry::Bounds;
use motionscope_core::products::objects::score::{Boxes, Scores};

/// Numbers from 0 to below 1, the same ones each time.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / f64::from(1 << 24)
    }
}

/// Forty frames of eight objects that go straight on, found with noise, under a wrong name now and then, two under each other's
/// from frame 20 on, and beside false alarms.
fn frames() -> Vec<(Boxes, Boxes)> {
    let mut chance = Chance(12_345);
    let mut next = || chance.next();
    let mut start = Vec::new();
    for i in 0..8 {
        let x = 40.0 * f64::from(i) + 200.0 * next();
        start.push([
            x,
            200.0 * next(),
            40.0 + 30.0 * next(),
            40.0 + 30.0 * next(),
            6.0 * next() - 3.0,
            6.0 * next() - 3.0,
        ]);
    }
    let bounds = |[x, y, width, height]: [f64; 4]| {
        let [x, y, width, height] = [x, y, width, height].map(|v| v as f32);
        Bounds { min: [x, y], max: [x + width, y + height] }
    };
    let mut frames = Vec::new();
    for t in 0..40 {
        let (mut truth, mut told) = (Vec::new(), Vec::new());
        for (i, [x, y, width, height, u, v]) in (0..).zip(&start) {
            let (x, y) = (x + u * f64::from(t), y + v * f64::from(t));
            if next() < 0.9 {
                truth.push((i + 1, bounds([x, y, *width, *height])));
            }
            if next() < 0.85 {
                let renamed = next() < 0.06;
                let id = match i {
                    _ if t >= 20 && i < 2 => 2 - i,
                    _ if renamed => i + 101,
                    _ => i + 1,
                };
                let (x, y) = (x + 16.0 * (next() - 0.5), y + 16.0 * (next() - 0.5));
                told.push((id, bounds([x, y, width * (0.9 + 0.2 * next()), height * (0.9 + 0.2 * next())])));
            }
        }
        if next() < 0.4 {
            told.push((90, bounds([300.0 * next(), 200.0 * next(), 50.0, 50.0])));
        }
        frames.push((truth, told));
    }
    frames
}

#[test]
fn scores_agree_with_those_of_others() {
    let found = Scores::of(&frames());
    // py-motmetrics 1.4.0, its MOTP being a distance; HOTA by the formulas of TrackEval in numpy 2.4.
    let recorded = [
        (found.mota, 0.6043956043956045),
        (found.motp, 1.0 - 0.2781121185920781),
        (found.idf1, 0.7132616487455197),
        (found.precision, 0.8175438596491228),
        (found.recall, 0.8534798534798534),
        (found.hota, 0.4691626756628416),
    ];
    assert_eq!((found.truths, found.hypotheses, found.switches), (273, 285, 16));
    for (i, (found, recorded)) in recorded.into_iter().enumerate() {
        assert!((found - recorded).abs() < 1e-6, "number {i}: {found} instead of {recorded}");
    }
}
