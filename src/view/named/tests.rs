use std::sync::atomic::{AtomicUsize, Ordering};

use motionscope_core::geometry::Grid;

use super::*;

fn at(event: usize) -> Cursor {
    Cursor { unit: 3, event }
}

#[test]
fn a_picture_is_made_once_for_a_step() {
    let count = Arc::new(AtomicUsize::new(0));
    // A step makes its canvases anew whenever it is looked at.
    let canvases = || {
        let count = Arc::clone(&count);
        let make = move || {
            count.fetch_add(1, Ordering::Relaxed);
            Frame::gray(Grid::new(4, 4, 7))
        };
        [Canvas::of_clip(Picture::CURRENT), Canvas::made(Picture::REFERENCE, make)]
    };
    let frame = Arc::new(Frame::gray(Grid::new(4, 4, 0)));
    let read = |_| Ok(Arc::clone(&frame));
    let last = LastNamed::default();
    let first = last.of(at(1), &canvases(), read);
    for _ in 0..5 {
        let again = last.of(at(1), &canvases(), read);
        assert!(Arc::ptr_eq(&first.frames[1].1, &again.frames[1].1), "one upload serves them all");
    }
    assert_eq!(count.load(Ordering::Relaxed), 1);
    last.of(at(2), &canvases(), read);
    assert_eq!(count.load(Ordering::Relaxed), 2);
    assert_eq!(last.of(at(2), &canvases()[..1], read).frames.len(), 1, "another choice of pictures");
}

#[test]
fn a_cut_is_made_anew_along_another_row() {
    let cut =
        |row: usize| [Canvas::made(Picture::REFERENCE, move || Frame::gray(Grid::new(4, 4, row as u8))).along(row)];
    let read = |_| Err(Error::new("no frame of the clip"));
    let last = LastNamed::default();
    let shade = |row: usize| last.of(at(1), &cut(row), read).frames[0].1.luma()[(0, 0)];
    assert_eq!([shade(3), shade(7), shade(7), shade(3)], [3, 7, 7, 3]);
}

#[test]
fn what_cannot_be_read_is_reported_and_the_rest_is_shown() {
    let canvases = [Picture::at(-2), Picture::PREVIOUS, Picture::CURRENT].map(Canvas::of_clip);
    let frame = Arc::new(Frame::gray(Grid::new(4, 4, 0)));
    let read = |picture: Picture| {
        if picture == Picture::PREVIOUS { Err(Error::new("it is damaged")) } else { Ok(Arc::clone(&frame)) }
    };
    let named = LastNamed::default().of(at(1), &canvases, read);
    let shown: Vec<Picture> = named.frames.iter().map(|(picture, _)| *picture).collect();
    assert_eq!(shown, [Picture::at(-2), Picture::CURRENT]);
    let (picture, error) = named.missing.expect("it is told");
    assert_eq!((picture, error.to_string()), (Picture::PREVIOUS, "it is damaged".to_owned()));
}
