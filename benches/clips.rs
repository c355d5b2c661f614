//! How fast clips open and are seeked in: `cargo bench --bench clips`.
//!
//! The clip is `benches/900.mp4`: 900 frames of ffmpeg's `testsrc2`, 320×180, H.264 with B-frames and a key frame
//! every 60 frames (`ffmpeg -f lavfi -i testsrc2=s=320x180:r=30:d=30 -c:v libx264 -preset fast -crf 42 -g 60`). Name
//! another in the environment variable `CLIP`.

use std::path::{Path, PathBuf};

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use motionscope::media::{Open, open};
use motionscope_core::data::Clip;

fn path() -> PathBuf {
    let bundled = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/900.mp4");
    std::env::var_os("CLIP").map_or(bundled, PathBuf::from)
}

fn fresh() -> Clip {
    open(&path(), &Open::default()).expect("the clip opens").clip
}

fn first_picture(c: &mut Criterion) {
    c.bench_function("open a clip to its first picture", |b| {
        b.iter(|| fresh().frame(0).expect("the first frame"));
    });
}

fn seek(c: &mut Criterion) {
    let frames = fresh().info().frames.expect("a known length");
    c.bench_function("seek to the last frame of a clip just opened", |b| {
        b.iter_batched(fresh, |clip| clip.frame(frames - 1).expect("the last frame"), BatchSize::PerIteration);
    });
    c.bench_function("step back one frame after a seek", |b| {
        let sought = || {
            let clip = fresh();
            clip.frame(frames / 2).expect("a frame");
            clip
        };
        b.iter_batched(sought, |clip| clip.frame(frames / 2 - 1).expect("a frame"), BatchSize::PerIteration);
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = first_picture, seek
}
criterion_main!(benches);
