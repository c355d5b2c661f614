//! The crossing from above, seen by a hand-held camera that pans along the road.

use crate::synth::{Sample, Scenery, path::Path};

pub const SAMPLE: Sample = Sample {
    id: "hand-held",
    title: "Hand-held pan: a moving camera",
    teaches: "The camera pans, shakes and rolls: only compensating its motion stabilises the clip and shows the cars that move.",
    tune: |_| {},
    scenery: Scenery::Flat(super::traffic::layers),
    path: Path { pan: [3.0, 0.4], shake: [3.5, 3.0], roll: 0.004 },
};
