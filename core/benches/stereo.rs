//! How fast disparities are estimated: `cargo bench -p motionscope-core --bench stereo`.
//!
//! On a synthetic pair of 450×375 px with 64 disparities. Where `MOTIONSCOPE_STEREO` names a folder with a pair of the Middlebury benchmark
//! (`im2.png`, `im6.png`, and `disp2.png` with the disparity in quarters of a px), on that pair; its errors are printed.

use std::path::Path;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::products::disparity::disparity_error;
use motionscope_core::{Clip, Disparity, DisparityField, Frame, Grid, Threads, estimator, synth};

/// A picture in 8 bits, in colour or gray.
fn picture(path: &Path) -> Frame {
    let mut decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).expect("a picture")));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    let (width, height) = (info.width as usize, info.height as usize);
    let samples = info.color_type.samples();
    let at = |x: usize, y: usize| &bytes[(y * width + x) * samples..];
    match samples {
        1 | 2 => Frame::gray(Grid::from_fn(width, height, |x, y| at(x, y)[0])),
        _ => Frame::rgb(Grid::from_fn(width, height, |x, y| [at(x, y)[0], at(x, y)[1], at(x, y)[2]])),
    }
}

/// The pair with its true disparities.
fn pair() -> (Clip, Arc<Disparity>) {
    let Some(folder) = std::env::var_os("MOTIONSCOPE_STEREO") else {
        let scene = synth::scene("still-life").expect("a scene");
        let clip = scene.clip(&synth::Difficulty { width: 450, height: 375, ..scene.difficulty() }).expect("a clip");
        let truth = clip.truth().expect("a truth").disparity(0).expect("disparities").expect("two views");
        return (clip, truth);
    };
    let [left, right, truth] = ["im2.png", "im6.png", "disp2.png"].map(|name| picture(&Path::new(&folder).join(name)));
    let clip = |frame| Clip::from_frames("pair", vec![frame]).expect("a frame");
    let truth = truth.luma().map(|&level| if level == 0 { f32::NAN } else { f32::from(level) / 4.0 });
    (clip(left).with_right(clip(right)).expect("views of one size"), Arc::new(Disparity(truth)))
}

fn whole_runs(c: &mut Criterion) {
    let (clip, truth) = pair();
    let (width, height) = clip.size();
    for (id, settings) in [
        ("semi-global-matching", &[][..]),
        ("semi-global-matching", &[("paths", "4")]),
        ("semi-global-matching", &[("fill", "off")]),
        ("block-stereo", &[]),
        ("block-stereo", &[("cost", "census")]),
    ] {
        let mut stereo = estimator(id).expect("it is there");
        settings.iter().for_each(|(name, value)| stereo.set(name, value).expect("in range"));
        for threads in [1, 2] {
            let threads = Threads::new(threads).expect("threads");
            let name = format!("{id} {settings:?} {width}×{height}, {} thread(s)", threads.count());
            c.bench_function(&name, |b| b.iter(|| stereo.run(&clip, 0, &threads).expect("a run")));
        }
        let output = stereo.run(&clip, 0, &Threads::single()).expect("a run");
        let map = &output.get::<DisparityField>().expect("disparities").map;
        let error = disparity_error(map, &truth).expect("one size").expect("compared");
        let estimated =
            Disparity(Grid::from_fn(
                width,
                height,
                |x, y| {
                    if map.at(x, y).is_some() { truth.0[(x, y)] } else { f32::NAN }
                },
            ));
        let of_estimated = disparity_error(map, &estimated).expect("one size").expect("compared");
        println!(
            "{id} {settings:?}: {:.2} % of all pixels wrong by more than 3 px, {:.2} % of the {:.1} % with a disparity; bad 1 {:.2} %, mean error {:.3} px",
            100.0 * error.bad3,
            100.0 * of_estimated.bad3,
            100.0 * error.compared as f64 / error.known as f64,
            100.0 * error.bad1,
            error.epe_px
        );
    }
}

criterion_group!(benches, whole_runs);
criterion_main!(benches);
