//! How background subtraction is told and drawn.

use std::sync::Arc;

use super::declare::line;
use super::{Background, Event, Explanation, Initial, State, Subtraction};
use crate::base::words::{counted as count, pixel};
use crate::data::{Detection, Frame, Mask};
use crate::methods::differential::explain;
use crate::products::Record;
use crate::run::{Seen, Span};
use crate::scene::{Fact, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

/// How far tiles reach around the pixel that is explained, in px.
const TILE_REACH_PX: usize = 4;

/// What has become of the pixels of a frame by now.
pub(crate) struct Account<'a> {
    events: &'a [Event],
}

impl<'a> Account<'a> {
    pub(crate) fn new(events: &'a [Event]) -> Self {
        Self { events }
    }

    fn frame(&self) -> Option<&'a Arc<Frame>> {
        self.events.iter().find_map(|event| match event {
            Event::Begun(frame) | Event::Compared(frame, _) => Some(frame),
            _ => None,
        })
    }

    /// The masks so far, the last one last.
    fn masks(&self) -> impl DoubleEndedIterator<Item = &'a Arc<Mask>> {
        self.events.iter().filter_map(|event| match event {
            Event::Decided(mask) | Event::Shadows(mask, _) | Event::Opened(mask) | Event::Closed(mask) => Some(mask),
            _ => None,
        })
    }

    /// The mask before the last one, and that.
    fn change(&self) -> Option<[&'a Arc<Mask>; 2]> {
        let mut masks = self.masks().rev();
        let after = masks.next()?;
        Some([masks.next()?, after])
    }

    fn kept(&self) -> Option<&'a [Vec<Detection>; 2]> {
        self.events.iter().find_map(|event| if let Event::Kept(blobs) = event { Some(&**blobs) } else { None })
    }

    /// What has become of a pixel after it was decided: what changed it, and what the last stage made of it.
    fn fate(&self, (x, y): (usize, usize)) -> Sentence {
        let mut said = Sentence::default();
        let mut was_set = false;
        for (i, event) in self.events.iter().enumerate() {
            let is_last = i + 1 == self.events.len();
            said = match event {
                Event::Shadows(_, shadows) if shadows.get(x, y) => {
                    said.text(" It is a ").ink(Role::Rejected, "shadow").text(".")
                }
                Event::Shadows(..) if is_last => said.text(" It is no shadow."),
                Event::Opened(mask) if was_set && !mask.get(x, y) => {
                    said.text(" Opening ").ink(Role::Rejected, "takes it off").text(".")
                }
                Event::Opened(_) if is_last => said.text(" Opening leaves it as it is."),
                Event::Closed(mask) if !was_set && mask.get(x, y) => {
                    said.text(" Closing ").ink(Role::Estimate, "fills it").text(".")
                }
                Event::Closed(_) if is_last => said.text(" Closing leaves it as it is."),
                Event::Labelled(labels, _) if labels[(x, y)] > 0 => said
                    .text(format!(" It belongs to component {}", labels[(x, y)]))
                    .text(match self.kept().map(|[_, dropped]| dropped.iter().any(|d| label(d) == labels[(x, y)])) {
                        None => ".",
                        Some(true) => ", which is too small.",
                        Some(false) => ", which is kept.",
                    }),
                Event::Labelled(..) if is_last => said.text(" It belongs to no component."),
                Event::Kept(_) if is_last && !was_set => said.text(" It belongs to no blob."),
                _ => said,
            };
            if let Event::Decided(mask) | Event::Shadows(mask, _) | Event::Opened(mask) | Event::Closed(mask) = event {
                was_set = mask.get(x, y);
            }
        }
        said
    }

    /// What the last stage did to the mask, or made of it.
    pub(crate) fn sentence(&self, least: usize) -> Option<Sentence> {
        let said = Sentence::default();
        let [gone, new] = self
            .change()
            .map_or([0, 0], |[before, after]| [before.without(after).count(), after.without(before).count()]);
        Some(match self.events.last()? {
            Event::Opened(_) => said
                .text("Opening takes off what is smaller than the square: ")
                .ink(Role::Rejected, count(gone, "pixel"))
                .text("."),
            Event::Closed(_) => said
                .text("Closing fills gaps that are smaller than the square: ")
                .ink(Role::Estimate, count(new, "pixel"))
                .text("."),
            Event::Labelled(_, all) => said
                .text("Pixels that touch belong together: ")
                .ink(Role::Candidate, count(*all as usize, "connected component"))
                .text("."),
            Event::Kept(blobs) => {
                let [kept, dropped] = &**blobs;
                let are = |count: usize| if count == 1 { "is" } else { "are" };
                said.ink(Role::Result, count(kept.len(), "blob"))
                    .text(format!(" of {least} px or more {} kept. ", are(kept.len())))
                    .ink(Role::Rejected, count(dropped.len(), "smaller one"))
                    .text(format!(" {} dropped.", are(dropped.len())))
            }
            _ => return None,
        })
    }

    /// Numbers about the frame so far.
    pub(crate) fn facts(&self) -> Vec<Fact> {
        let mut facts = Vec::new();
        for event in self.events {
            facts.extend(match event {
                Event::Decided(mask) => {
                    Some(Fact::new("Different", format!("{} px", mask.count()), Some(Role::Candidate)))
                }
                Event::Shadows(_, mask) => {
                    Some(Fact::new("Shadows", format!("{} px", mask.count()), Some(Role::Rejected)))
                }
                Event::Opened(mask) => Some(Fact::new("After opening", format!("{} px", mask.count()), None)),
                Event::Closed(mask) => Some(Fact::new("After closing", format!("{} px", mask.count()), None)),
                Event::Labelled(_, count) => Some(Fact::new("Components", count.to_string(), None)),
                Event::Kept(blobs) => Some(Fact::new("Blobs", blobs[0].len().to_string(), Some(Role::Result))),
                _ => None,
            });
        }
        facts
    }

    /// The last stage.
    pub(crate) fn draw(&self, scene: &mut Scene) {
        let [gone, new] = match self.change() {
            Some([before, after]) => {
                [before.without(after), after.without(before)].map(|m| (m.count() > 0).then_some(m))
            }
            None => [None, None],
        };
        match self.events.last() {
            Some(Event::Opened(mask)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                gone.into_iter().for_each(|gone| layer(scene, Role::Rejected, "taken off by opening", Arc::new(gone)));
            }
            Some(Event::Closed(mask)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                new.into_iter().for_each(|new| layer(scene, Role::Estimate, "filled by closing", Arc::new(new)));
            }
            Some(Event::Labelled(labels, _)) => {
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Labels(Arc::clone(labels)));
                scene.legend(Role::Candidate, "connected components, a colour for each");
            }
            Some(Event::Kept(blobs)) => {
                draw_blobs(scene, &blobs[1], (Role::Rejected, "too small"));
                draw_blobs(scene, &blobs[0], (Role::Result, "blob"));
                draw_shapes(scene, &blobs[0]);
            }
            _ => {}
        }
    }
}

fn label(detection: &Detection) -> u32 {
    detection.blob.map_or(0, |blob| blob.label)
}

fn layer(scene: &mut Scene, role: Role, meaning: &'static str, mask: Arc<Mask>) {
    scene.mark(Picture::CURRENT, role, Shape::Mask(mask));
    scene.legend(role, meaning);
}

/// Boxes.
pub(crate) fn draw_blobs(scene: &mut Scene, blobs: &[Detection], (role, meaning): (Role, &'static str)) {
    for blob in blobs {
        scene.mark(Picture::CURRENT, role, Shape::Rect { min: blob.bounds.min, max: blob.bounds.max });
    }
    scene.legend(role, meaning);
}

/// Centroids, ellipses and labels.
fn draw_shapes(scene: &mut Scene, blobs: &[Detection]) {
    for Detection { bounds, center, blob, .. } in blobs {
        let Some(blob) = blob else { continue };
        let ellipse = Shape::Ellipse { center: *center, radii: blob.radii, angle_rad: blob.angle_rad };
        scene.mark(Picture::CURRENT, Role::Estimate, ellipse);
        scene.legend(Role::Estimate, "ellipse with the same moments");
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Points(vec![*center]));
        scene.legend(Role::Measured, "centroid");
        let text = Shape::Text { at: bounds.min, text: format!("{}: {} px", blob.label, blob.area_px) };
        scene.mark(Picture::CURRENT, Role::Result, text);
    }
}

/// How many pixels are foreground in each frame, as a share, and how many blobs there are.
pub(crate) fn plots(record: &Record, span: &Span) -> Vec<Readout> {
    let (frames, pixels) = (record.frames(), record.pixels());
    let line = |of: &dyn Fn(usize) -> f32| (0..frames.len()).map(|i| [(span.first + i) as f32, of(i)]).collect();
    let series = |title, y_label, name, line| Series {
        title,
        x_label: "frame",
        y_label,
        x_max: span.first + span.frames().unwrap_or(frames.len()) - 1,
        lines: vec![(name, Role::Result, line)],
        ..Series::default()
    };
    if frames.len() < 2 {
        return Vec::new();
    }
    vec![
        Readout::Series(series("Foreground", "px", "foreground", line(&|i| pixels[i] as f32))),
        Readout::Series(series("Blobs", "blobs", "blobs", line(&|i| frames[i].detections.len() as f32))),
    ]
}

impl<M: Background> Subtraction<M> {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Begun(_)) => line::BEGIN_MODEL,
            Some(Event::Compared(..)) => line::COMPARE,
            Some(Event::Decided(_)) => line::DECIDE,
            Some(Event::Shadows(..)) => line::REMOVE_SHADOWS,
            Some(Event::Opened(_)) => line::OPEN,
            Some(Event::Closed(_)) => line::CLOSE,
            Some(Event::Labelled(..)) => line::LABEL,
            Some(Event::Kept(_)) => line::KEEP_BLOBS,
            Some(Event::Updated) => line::UPDATE_MODEL,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    /// The pixel that is pointed at, and how it is decided.
    fn explanation(&self, seen: &Seen<Self>) -> Option<((usize, usize), Explanation)> {
        let frame = Account::new(seen.events).frame()?;
        let place = frame.luma().cell_at(seen.point()?)?;
        let before = seen.before.model.as_deref();
        let after = seen.after.and_then(|after| after.model.as_deref());
        Some((place, self.0.explain([before, after], frame, place)))
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (said, number) = (Sentence::default(), seen.before.frame);
        let account = Account::new(seen.events);
        let Some(event) = seen.events.last() else {
            return said.text(
                "Where nothing moves, a pixel looks as it did before. What looks different from that background belongs to \
                 something that moves.",
            );
        };
        let is_decided = !matches!(event, Event::Begun(_) | Event::Compared(..));
        if let Some((place, Explanation { verdict, .. })) = self.explanation(seen).filter(|_| is_decided) {
            let mut all = said.ink(Role::Reference, format!("Pixel {}", pixel(place)));
            all.0.extend(verdict.0);
            all.0.extend(account.fate(place).0);
            return match event {
                Event::Updated => all.text(format!(" {}.", self.0.update())),
                _ => all,
            };
        }
        match event {
            Event::Begun(_) => said.text(match self.0.initial() {
                Initial::FirstFrame => {
                    format!("Frame {number} is the first one: all of it is taken for the background.")
                }
                Initial::Median => {
                    "The median of frames from all over the run is the initial background: what moves covers a pixel \
                     in less than half of them."
                        .to_owned()
                }
            }),
            Event::Compared(..) => said.text(format!(
                "Each pixel of frame {number} is compared with what is expected there: the heat shows {}.",
                M::SHOWN
            )),
            Event::Decided(mask) => said
                .ink(Role::Candidate, count(mask.count(), "pixel"))
                .text(format!(" counted as foreground: those that {}.", self.0.rule())),
            Event::Shadows(_, shadows) => said
                .ink(Role::Rejected, format!("{} of them", shadows.count()))
                .text(" are darker and of the same colour: shadows, which are taken off."),
            Event::Updated => said.text(format!("{}.", self.0.update())),
            _ => account.sentence(self.0.settings().min_area).unwrap_or(said),
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.before;
        if seen.events.is_empty() {
            return Vec::new();
        }
        let account = Account::new(seen.events);
        let mut facts = vec![Fact::new("Frame", state.frame.to_string(), None)];
        let mut readouts = Vec::new();
        if let Some((place, explanation)) = self.explanation(seen) {
            facts.push(Fact::new("Pixel", pixel(place), Some(Role::Reference)));
            facts.extend(explanation.facts);
            readouts.extend(Some(explanation.equation).filter(|lines| !lines.is_empty()).map(Readout::Equation));
            readouts.extend(Some(explanation.matrices).filter(|all| !all.is_empty()).map(Readout::Matrices));
            readouts.extend(self.tiles(seen, place).map(Readout::Tiles));
        }
        facts.extend(account.facts());
        readouts.insert(0, Readout::Facts(facts));
        let now: &State<_> = seen.after.unwrap_or(state);
        readouts.extend(plots(&now.record, &state.span));
        readouts
    }

    /// The frame, what is expected there and the difference around a pixel.
    fn tiles(&self, seen: &Seen<Self>, place: (usize, usize)) -> Option<Vec<Tile>> {
        let frame = Account::new(seen.events).frame()?;
        let model = seen.before.model.as_deref()?;
        let around = |of: &dyn Fn((usize, usize)) -> f32| explain::around_with(frame.size(), place, TILE_REACH_PX, of);
        let difference = around(&|place| self.0.difference(model, frame, place));
        let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(*v));
        let tile = |label, role, values, range| Tile { label, role, values, range };
        Some(vec![
            tile("Frame t", Some(Role::Measured), around(&|place| f32::from(frame.luma()[place])), [0.0, 255.0]),
            tile(
                "Background",
                Some(Role::Predicted),
                around(&|place| self.0.compared_with(model, frame, place)),
                [0.0, 255.0],
            ),
            tile("Difference", None, difference, [0.0, most]),
        ])
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let account = Account::new(seen.events);
        if let (Some(model), Some(frame)) = (&seen.before.model, account.frame()) {
            scene.pictures = self.0.pictures(model, frame.size());
        }
        match seen.events.last() {
            None => {}
            Some(Event::Begun(_)) => scene.legend(Role::Predicted, "background: all of this frame"),
            Some(Event::Compared(_, difference)) => {
                let values = difference.as_ref().clone();
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
                scene.heat = Some(M::SHOWN);
                scene.legend(Role::Candidate, M::COMPARED);
            }
            Some(Event::Decided(mask)) => layer(scene, Role::Candidate, "foreground", Arc::clone(mask)),
            Some(Event::Shadows(mask, shadows)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                layer(scene, Role::Rejected, "shadow", Arc::clone(shadows));
            }
            Some(Event::Updated) => {
                account.masks().next_back().into_iter().for_each(|mask| {
                    layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                });
                account.kept().into_iter().for_each(|[kept, _]| draw_blobs(scene, kept, (Role::Result, "blob")));
            }
            _ => account.draw(scene),
        }
        if let Some((x, y)) = seen.point().and_then(|point| account.frame()?.luma().cell_at(point)) {
            let beside = scene.pictures.iter().map(|canvas| canvas.picture).filter(|on| self.0.explains(*on));
            let mut all: Vec<_> = beside.chain([Picture::CURRENT]).collect();
            all.sort();
            all.dedup();
            for on in all {
                scene.mark(on, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
            }
            scene.legend(Role::Reference, "pixel");
        }
    }
}
