//! Results hold bit for bit: what every estimator makes of bundled clips, as one number for each product.

use motionscope_core::base::Threads;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Detection, PackedMask};
use motionscope_core::params::Params;
use motionscope_core::products::{
    AnyProduct, Cell, Descriptor, EpipolarField, MaskField, ObjectField, ObjectFrame, PathField, PointField,
    SegmentField, Table,
};
use motionscope_core::run::AnyEstimator;
use motionscope_core::synth;

/// FNV-1a over values: renaming a field does not change it.
struct Fingerprint(u64);

impl Fingerprint {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    fn reals(&mut self, values: impl IntoIterator<Item = f64>) {
        for value in values {
            self.bytes(&if value.is_nan() { u64::MAX } else { value.to_bits() }.to_le_bytes());
        }
    }

    fn singles<'a>(&mut self, values: impl IntoIterator<Item = &'a f32>) {
        self.reals(values.into_iter().map(|value| f64::from(*value)));
    }

    fn table(&mut self, table: &Table) {
        for cell in table.rows().flatten() {
            match cell {
                Cell::Int(value) => self.bytes(&value.to_le_bytes()),
                Cell::Real(value) => self.reals([*value]),
                Cell::Single(value) => self.singles([value]),
                Cell::Word(word) => self.bytes(word.as_bytes()),
                Cell::Empty => self.bytes(&[0]),
            }
        }
    }

    fn frames<'a>(&mut self, frames: impl IntoIterator<Item = &'a ObjectFrame>) {
        for ObjectFrame { mask, detections, .. } in frames {
            for mask in mask.iter().map(PackedMask::unpacked) {
                let (width, height) = mask.size();
                let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
                let bits: Vec<_> = pixels.map(|(x, y)| u8::from(mask.get(x, y))).collect();
                self.bytes(&bits);
            }
            for Detection { bounds, center, score, .. } in detections {
                self.singles([bounds.min, bounds.max, *center].as_flattened().iter().chain([score]));
            }
        }
    }

    /// Candidates, masks, detections, labels, descriptors and matrices, which no table has.
    fn beyond_tables(&mut self, product: &dyn AnyProduct) {
        let product = product.as_any();
        if let Some(field) = product.downcast_ref::<MaskField>() {
            self.frames(field.frames.iter().map(AsRef::as_ref));
        } else if let Some(field) = product.downcast_ref::<ObjectField>() {
            self.frames(field.frames.iter().map(AsRef::as_ref));
        } else if let Some(field) = product.downcast_ref::<SegmentField>() {
            for label in field.frames.iter().flat_map(|frame| frame.labels.cells()) {
                self.bytes(&label.to_le_bytes());
            }
        } else if let Some(field) = product.downcast_ref::<PointField>() {
            for descriptor in field.keypoints.iter().filter_map(|keypoint| keypoint.descriptor.as_ref()) {
                match descriptor {
                    Descriptor::Reals(values) => self.singles(values.iter()),
                    Descriptor::Bits(words) => words.iter().for_each(|word| self.bytes(&word.to_le_bytes())),
                }
            }
        } else if let Some(field) = product.downcast_ref::<EpipolarField>() {
            self.reals(field.matrix.iter().flat_map(|matrix| matrix.as_flattened().to_vec()));
        } else if let Some(field) = product.downcast_ref::<PathField>() {
            self.reals(field.corrections.iter().flat_map(|correction| correction.as_flattened().to_vec()));
        }
    }

    /// The hash of no bytes.
    const EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

    fn of(product: &dyn AnyProduct) -> Self {
        let mut all = Self(Self::EMPTY);
        product.table().iter().for_each(|table| all.table(table));
        product.flow().iter().for_each(|flow| all.singles(flow.0.cells().iter().flatten()));
        product.confidence().iter().for_each(|confidence| all.singles(confidence.values.cells()));
        for tested in product.tested().iter().flatten().flatten() {
            all.bytes(&tested.candidates.to_le_bytes());
        }
        all.beyond_tables(product);
        all
    }
}
fn clip(scene: &str) -> Clip {
    let scene = synth::SCENES.iter().find(|other| other.id == scene).expect("a bundled scene");
    let mut difficulty = scene.difficulty();
    difficulty.set("frames", "6").expect("all have it");
    synth::make(scene.id, &difficulty).expect("a clip")
}

fn lines_of(estimator: &dyn AnyEstimator, (name, clip): (&str, &Clip)) -> String {
    let output = estimator.run(clip, 1, &Threads::new(2).expect("sound")).expect("a run");
    let line = |product: &dyn AnyProduct| {
        // A product without any value holds nothing: a scene flow needs a second camera.
        let Fingerprint(hash) = Fingerprint::of(product);
        (hash != Fingerprint::EMPTY)
            .then(|| format!("{name} {} {} {hash:016x}\n", estimator.info().id, product.kind().id))
    };
    output.products().filter_map(line).collect()
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
    // Only here do both cameras see motion in space.
    let scene_flow = estimator("scene-flow").expect("in the registry");
    lines.push_str(&lines_of(&*scene_flow, ("drive", &clip("drive"))));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/results.txt");
    if std::env::var_os("UPDATE_RESULTS").is_some() {
        std::fs::write(path, &lines).expect("written");
    }
    let record = std::fs::read_to_string(path).expect("a record");
    let changed: Vec<_> = lines.lines().filter(|line| !record.lines().any(|other| other == *line)).collect();
    assert_eq!(lines.lines().count(), record.lines().count(), "UPDATE_RESULTS=1 records new estimators");
    assert!(changed.is_empty(), "results have changed; if that is meant, UPDATE_RESULTS=1 records them:\n{changed:#?}");
}
