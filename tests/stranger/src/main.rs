//! Uses the core without the rest of this repository: frames of its own, results as plain numbers, steps as text and as a drawing.

use std::sync::Arc;

use motionscope_core::data::{ClipInfo, FrameSource};
use motionscope_core::families::optical_flow::{HornSchunck, LucasKanade, Variational};
use motionscope_core::prelude::*;
use motionscope_core::scene::Shape;
use motionscope_core::synth;

const SIZE: (usize, usize) = (96, 64);

/// A camera of its own: a texture that moves by (2, 1) px per frame, for ever.
struct Pan;

impl Pan {
    fn picture(t: usize) -> Frame {
        let wave =
            |x: f32, y: f32| 128.0 + 60.0 * (x / 5.0).sin() * (y / 7.0).cos() + 40.0 * ((x + 2.0 * y) / 9.0).sin();
        let t = t as f32;
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| wave(x as f32 - 2.0 * t, y as f32 - t) as u8))
    }

    fn clip() -> Clip {
        let info = ClipInfo {
            name: "pan".into(),
            width: SIZE.0,
            height: SIZE.1,
            frames: None,
            fps: None,
            container: "memory".into(),
            codec: "none".into(),
            warnings: Vec::new(),
        };
        Clip::new(info, Arc::new(Pan))
    }
}

impl FrameSource for Pan {
    fn frame(&self, index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
        stop.check()?;
        Ok(Arc::new(Pan::picture(index)))
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }
}

/// The median of the known displacements in px/frame.
fn median(flow: &Flow) -> [f32; 2] {
    let known: Vec<_> = flow.0.cells().iter().filter(|uv| uv.iter().all(|c| c.is_finite())).collect();
    [0, 1].map(|axis| {
        let mut sorted: Vec<f32> = known.iter().map(|uv| uv[axis]).collect();
        sorted.sort_by(f32::total_cmp);
        sorted[sorted.len() / 2]
    })
}

fn check_flow(name: &str, output: &Output) -> Result<(), Error> {
    let flow = output.flow().ok_or_else(|| Error::new(format!("{name} has no flow")))?;
    let [u, v] = median(&flow);
    assert!((u - 2.0).abs() < 0.2 && (v - 1.0).abs() < 0.2, "{name}: ({u:.2}, {v:.2}) px");
    println!("{name}: ({u:.2}, {v:.2}) px per frame");
    Ok(())
}

/// A drawing of the marks of a step that are rectangles, as SVG.
fn svg(scene: &Scene) -> String {
    let shapes = scene.marks.iter().filter_map(|mark| match mark.shape {
        Shape::Rect { min: [left, top], max: [right, bottom] } => {
            Some(format!("<rect x='{left}' y='{top}' width='{}' height='{}'/>", right - left, bottom - top))
        }
        _ => None,
    });
    format!("<svg xmlns='http://www.w3.org/2000/svg'>{}</svg>", shapes.collect::<String>())
}

fn main() -> Result<(), Error> {
    let threads = Threads::all()?;
    let clip = Pan::clip();

    // Parameters as fields, of an estimator and of a model that is one in a wrapper.
    let window = LucasKanade { window: 21, ..LucasKanade::default() };
    check_flow("Lucas–Kanade", &window.run(&clip, 0, &threads)?)?;
    let smooth = Variational(HornSchunck { alpha: 4.0, ..HornSchunck::default() });
    check_flow("Horn–Schunck", &smooth.run(&clip, 3, &threads)?)?;

    // Parameters by name, and a product with its table.
    let mut search = estimator("diamond")?;
    search.set("block-size", "8")?;
    let output = search.run(&clip, 0, &threads)?;
    let blocks: &BlockField = output.get().ok_or_else(|| Error::new("a block search has block vectors"))?;
    let table = output.table().ok_or_else(|| Error::new("block vectors have a table"))?;
    assert_eq!(table.rows().count(), blocks.vectors.len());
    check_flow("Diamond search", &output)?;

    // Every step of a block as a sentence and a drawing.
    let mut walk = search.walk(&clip, 0)?;
    walk.jump(Move::To(Cursor { unit: 20, event: 0 }));
    for event in 0..=walk.events() {
        walk.jump(Move::To(Cursor { unit: 20, event }));
        let sentence = walk.step(None).sentence.plain();
        assert!(!sentence.is_empty() && svg(&walk.scene(None)).contains("<rect"));
        println!("{} {sentence}", walk.cursor());
    }

    // Exact truth, and a refusal in a sentence.
    let sample = synth::scene("pillar")?;
    let truth = sample.clip(&sample.difficulty())?;
    assert!(truth.truth().is_some());
    let refused = search.set("block-size", "1000").expect_err("blocks have at most some px");
    println!("{refused}");
    assert!(estimators().len() > 60);
    Ok(())
}
