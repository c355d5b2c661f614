//! The segments of all frames so far, with labels that stay from frame to frame.

use std::sync::Arc;

use crate::base::Error;
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::products::segments::relabel;
use crate::products::{AffineMotion, Output, SegmentField, SegmentFrame};
use crate::run::{Granularity, Progress, Span, need};

/// The frames of a run and their segments.
#[derive(Clone, Debug)]
pub struct Record {
    span: Span,
    picture: (usize, usize),
    /// The next label that no segment had.
    unused: u32,
    /// The flow of the last frame.
    flow: Option<Arc<Flow>>,
    /// The segments of each frame so far.
    pub frames: Vec<Arc<SegmentFrame>>,
}

impl Record {
    /// Begins a record of at most `count` frames of a clip, the last of which has no successor and so no flow.
    ///
    /// # Errors
    /// If there is no pair of frames.
    pub fn new(clip: &Clip, first: usize, count: usize) -> Result<Self, Error> {
        let span = Span::new(clip, first, count)?;
        Ok(Self { span, picture: clip.size(), unused: 1, flow: None, frames: Vec::new() })
    }

    /// The current frame.
    pub fn frame(&self) -> usize {
        self.span.first + self.frames.len()
    }

    /// Width and height of the picture in px.
    pub fn picture(&self) -> (usize, usize) {
        self.picture
    }

    /// The position of a run in `round` of its frame.
    pub fn place(&self, round: usize) -> Vec<Granularity> {
        let mut place = self.span.place_of_pair(self.frame());
        place.push(Granularity { index: round, of: None });
        place
    }

    /// Checks that there is memory for one more frame.
    ///
    /// # Errors
    /// If there is none.
    pub fn check(&self, clip: &Clip) -> Result<(), Error> {
        need::check_kept(clip, self.bytes())
    }

    /// Adds the segments of the current frame, with the labels that they had in the previous one. `affine` gives the affine motion of a label
    /// before it is renamed.
    pub fn add(
        &mut self,
        labels: &Grid<u32>,
        flow: &Arc<Flow>,
        affine: impl Fn(u32) -> Option<AffineMotion>,
    ) -> Arc<SegmentFrame> {
        let before = self.frames.last().zip(self.flow.as_ref());
        let before = before.map(|(frame, flow)| (&*frame.labels, &**flow));
        let renamed = relabel(labels, before, &mut self.unused);
        let mut former = vec![0; self.unused as usize];
        labels.cells().iter().zip(renamed.cells()).for_each(|(old, new)| former[*new as usize] = *old);
        let frame = Arc::new(SegmentFrame::measure(renamed, flow, |label| affine(former[label as usize])));
        self.flow = Some(Arc::clone(flow));
        self.frames.push(Arc::clone(&frame));
        frame
    }

    /// Adds the segments of the current frame with labels that stay as they are.
    pub fn add_as_labelled(&mut self, labels: Grid<u32>, flow: Flow) -> Arc<SegmentFrame> {
        let frame = Arc::new(SegmentFrame::measure(labels, &flow, |_| None));
        self.flow = Some(Arc::new(flow));
        self.frames.push(Arc::clone(&frame));
        frame
    }

    /// Whether the run goes on after the last frame added.
    pub fn progress(&self, clip: &Clip) -> Progress {
        if self.span.is_over(clip, self.frame() + 1) { Progress::Done } else { Progress::More }
    }

    /// The product so far.
    pub fn output(&self) -> Output {
        Output::of(SegmentField { picture: self.picture, first: self.span.first, frames: self.frames.clone() })
    }

    /// Size in memory in bytes.
    pub fn bytes(&self) -> usize {
        let frames: usize = self.frames.iter().map(|frame| frame.bytes()).sum();
        size_of::<Self>() + frames + self.flow.as_ref().map_or(0, |flow| size_of_val(flow.0.cells()))
    }
}
