//! Results hold bit for bit: what every estimator makes of bundled clips, as one number each.

use motionscope_core::{
    AnyEstimator, BlockField, Clip, DisparityField, Feature, MaskField, MatchField, ObjectField, Output, Params,
    PathField, RegionField, SegmentField, Threads, TrackField, estimators, products, products::EpipolarField, synth,
};

/// Keypoints as the line of an estimator holds them: scale, orientation and descriptor have a line of their own.
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

/// FNV-1a.
fn hash(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// A number for what `output` holds, as Rust tells it: floats in as many digits as read back the same.
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
    hash(told.bytes().chain(bits))
}

/// The same for what that leaves out, by name, as far as there is any.
fn further(output: &Output) -> Vec<(&'static str, u64)> {
    let masks = output.get::<MaskField>().map(|field| ("masks", format!("{field:?}")));
    let confidence = output.confidence().map(|confidence| {
        let bits: Vec<u32> = confidence.values.cells().iter().map(|value| value.to_bits()).collect();
        ("confidence", format!("{} {:?} {bits:?}", confidence.name, confidence.values.size()))
    });
    let keypoints = output.get::<products::PointField>().and_then(|field| {
        let told = |keypoint: &products::Keypoint| (keypoint.scale_px, keypoint.angle_rad, keypoint.descriptor.clone());
        let all: Vec<_> = field.keypoints.iter().map(told).collect();
        let has_any = all.iter().any(|told| *told != (None, None, None));
        has_any.then(|| ("keypoints", format!("{all:?}")))
    });
    let matches = output.get::<MatchField>().map(|field| ("matches", format!("{:?}", field.matches)));
    let epipolar = output.get::<EpipolarField>().map(|field| ("matrix", format!("{:?}", field.matrix)));
    let path = output.get::<PathField>().map(|field| ("path", format!("{:?} {:?}", field.motions, field.corrections)));
    let region = output.get::<RegionField>().map(|field| ("region", format!("{field:?}")));
    let disparity = output.get::<DisparityField>().map(|field| ("disparity", format!("{:?}", field.map)));
    let segments = output.get::<SegmentField>().map(|field| ("segments", format!("{field:?}")));
    let told =
        [masks, confidence, keypoints, matches, epipolar, path, region, disparity, segments].into_iter().flatten();
    told.map(|(name, told)| (name, hash(told.bytes()))).collect()
}

fn clip(scene: &str) -> Clip {
    let scene = synth::SCENES.iter().find(|other| other.id == scene).expect("a bundled scene");
    let mut difficulty = scene.difficulty();
    difficulty.set("frames", "6").expect("all have it");
    synth::make(scene.id, &difficulty).expect("a clip")
}

fn lines_of(estimator: &dyn AnyEstimator, (name, clip): (&str, &Clip)) -> String {
    let output = estimator.run(clip, 1, &Threads::new(2).expect("sound")).expect("a run");
    let id = estimator.info().id;
    let further = further(&output).into_iter().map(|(part, hash)| format!("{name} {id} {part} {hash:016x}\n"));
    format!("{name} {id} {:016x}\n{}", fingerprint(&output), further.collect::<String>())
}

/// The standard library's functions differ in their last digits from system to system.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[test]
fn results_are_those_on_record() {
    let mut lines = String::new();
    for name in ["pillar", "spin-zoom", "traffic"] {
        let clip = clip(name);
        lines.extend(estimators().iter().map(|estimator| lines_of(&**estimator, (name, &clip))));
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
