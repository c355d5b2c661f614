//! Results hold bit for bit: what every estimator makes of bundled clips, as one number each.

use motionscope_core::{
    AnyEstimator, BlockField, Clip, Feature, ObjectField, Output, Params, Threads, TrackField, estimators, products,
    synth,
};

/// Keypoints as the record knows them: scale, orientation and descriptor came later.
#[derive(Debug)]
#[expect(dead_code, reason = "what is held is told")]
struct PointField<'a> {
    picture: (usize, usize),
    points: &'a [Feature],
    responses: Vec<f32>,
}

impl<'a> PointField<'a> {
    fn of(field: &'a products::PointField) -> Self {
        let responses = field.keypoints.iter().map(|keypoint| keypoint.response).collect();
        Self { picture: field.picture, points: &field.points, responses }
    }
}

/// FNV-1a over what `output` holds, as Rust tells it: floats in as many digits as read back the same.
fn fingerprint(output: &Output) -> u64 {
    let told = format!(
        "{:?}|{:?}|{:?}|{:?}",
        output.get::<BlockField>(),
        output.get().map(PointField::of),
        output.get::<TrackField>(),
        output.get::<ObjectField>()
    );
    let field = output.flow().filter(|_| output.motion().is_field());
    let cells = field.map_or(vec![[0.0; 2]], |flow| flow.0.into_cells());
    let bits = cells.iter().flatten().flat_map(|c| if c.is_nan() { u32::MAX } else { c.to_bits() }.to_le_bytes());
    told.bytes()
        .chain(bits)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

fn clip(scene: &str) -> Clip {
    let scene = synth::SCENES.iter().find(|other| other.id == scene).expect("a bundled scene");
    let mut difficulty = scene.difficulty();
    difficulty.set("frames", "6").expect("all have it");
    synth::make(scene.id, &difficulty).expect("a clip")
}

fn line(estimator: &dyn AnyEstimator, (name, clip): (&str, &Clip)) -> String {
    let output = estimator.run(clip, 1, &Threads::new(2).expect("sound")).expect("a run");
    format!("{name} {} {:016x}\n", estimator.info().id, fingerprint(&output))
}

/// The standard library's functions differ in their last digits from system to system.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[test]
fn results_are_those_on_record() {
    let mut lines = String::new();
    for name in ["pillar", "spin-zoom", "traffic"] {
        let clip = clip(name);
        lines.extend(estimators().iter().map(|estimator| line(&**estimator, (name, &clip))));
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/results.txt");
    if std::env::var_os("UPDATE_RESULTS").is_some() {
        std::fs::write(path, &lines).expect("written");
    }
    let record = std::fs::read_to_string(path).expect("a record");
    let changed: Vec<_> = lines.lines().filter(|line| !record.lines().any(|other| other == *line)).collect();
    assert_eq!(lines.lines().count(), record.lines().count(), "UPDATE_RESULTS=1 records new estimators");
    assert!(changed.is_empty(), "results have changed; if that is meant, UPDATE_RESULTS=1 records them:\n{changed:#?}");
}
