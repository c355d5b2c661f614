//! The picture leaned back, and the landscape of the method that rises out of it.

use std::sync::Arc;

use eframe::egui::{self, Ui};
use motionscope_core::scene::{Footing, Picture, Readout, Role, Step, Surface};

use super::{Hand, Input, Spot, State};
use crate::paint::charts::Orbit;
use crate::paint::charts::relief::{Landscape, Lean, risen, standing};
use crate::paint::{Placement, primitive, resolve};
use crate::ui::charts::surface3d::{Renderer, Seen};
use crate::ui::drawing::primitives;

/// How long a picture leans back or folds flat, in seconds.
const SECS: f32 = 0.7;
/// How long a candidate falls, in seconds.
const FALL_SECS: f64 = 0.25;
/// Radius of a falling candidate, in points.
const BALL_PT: f32 = 6.0;
/// How far from a candidate a click may be, in points.
const REACH_PT: f32 = 14.0;

/// What the stage remembers of its landscapes.
#[derive(Clone, Default)]
pub struct Landscapes {
    /// One for each estimator.
    all: Vec<Shown>,
}

/// The landscape of one estimator.
#[derive(Clone, Default)]
struct Shown {
    /// The step whose surface it is, and that surface with all that is known of it.
    of: Option<(Arc<Step>, Surface)>,
    /// Whether untested candidates are hidden.
    hides_untested: bool,
    /// The steps of the other estimators whose best stand on it.
    beside: Vec<Arc<Step>>,
    /// When that step was shown first, in seconds.
    since: f64,
    /// Whether an iteration has moved on by one since the step that was shown before.
    rolls: bool,
    /// From 0, flat, to 1.
    amount: f32,
    renderer: Renderer,
}

impl Shown {
    /// Takes the surface of a step at a time in seconds, unless it has it, with the best of the steps `beside` it on it.
    fn take(&mut self, step: &Arc<Step>, (beside, hides_untested): (Vec<(&'static str, &Arc<Step>)>, bool), time: f64) {
        let is_known = self.hides_untested == hides_untested
            && self.of.as_ref().is_some_and(|(known, _)| Arc::ptr_eq(known, step));
        let are_known = beside.len() == self.beside.len()
            && beside.iter().zip(&self.beside).all(|((_, step), known)| Arc::ptr_eq(step, known));
        if is_known && are_known {
            return;
        }
        let Some(mut surface) = risen(step, beside.iter().map(|(name, step)| (*name, &***step))) else { return };
        if hides_untested {
            surface.ahead = None;
        }
        if !is_known {
            let before = self.of.as_ref().map_or(&[][..], |(_, before)| &before.trail);
            let has_grown = !before.is_empty() && surface.trail.len() == before.len() + 1;
            (self.rolls, self.since) = (has_grown && surface.trail.starts_with(before), time);
        }
        self.of = Some((Arc::clone(step), surface));
        self.hides_untested = hides_untested;
        self.beside = beside.into_iter().map(|(_, step)| Arc::clone(step)).collect();
    }

    /// The share of its way that the candidate of the step has fallen.
    fn fallen(&self, ui: &Ui) -> f32 {
        ((ui.input(|i| i.time) - self.since) / FALL_SECS).clamp(0.0, 1.0) as f32
    }
}

impl Landscapes {
    /// Takes note of the step behind the spots of one estimator, and leans its picture back or folds it flat.
    pub(super) fn follow(&mut self, ui: &Ui, spots: &[Spot<'_>], input: &Input<'_>) {
        let Some(member) = spots.first().map(|spot| spot.member) else { return };
        if self.all.len() <= member {
            self.all.resize_with(member + 1, Shown::default);
        }
        let (shown, time) = (&mut self.all[member], ui.input(|i| i.time));
        let is_seen = |footing: &Footing| spots.iter().any(|spot| spot.panel.shows(footing.on));
        let rises = |step: &&Arc<Step>| standing(step).and_then(Readout::footing).is_some_and(is_seen);
        let found = input.step_of(member).filter(rises);
        if let Some(step) = found
            && (input.look.landscape || shown.amount > 0.0)
        {
            let beside = if input.hides_untested { Vec::new() } else { input.beside(member) };
            shown.take(step, (beside, input.hides_untested), if input.animate { time } else { f64::NEG_INFINITY });
        }
        // Nothing is drawn or placed on a picture that leans.
        let is_free = input.placing.is_none() && !matches!(input.presenting.hand, Hand::Draw(_));
        let secs = if input.animate { SECS } else { 0.0 };
        let id = ui.scope_id().with(("landscape", member));
        shown.amount = ui.ctx().animate_bool_with_time(id, input.look.landscape && is_free && found.is_some(), secs);
    }

    /// The picture that leans back, or is about to; none in lockstep, where each estimator has one.
    pub(super) fn picture(&self) -> Option<Picture> {
        let [Shown { of, amount, .. }] = &self.all[..] else { return None };
        let (_, surface) = of.as_ref().filter(|_| *amount > 0.0)?;
        surface.footing.as_ref().map(|footing| footing.on)
    }

    /// The landscape on the picture of a spot; none while it is flat.
    fn on<'a>(&'a self, spot: &Spot<'_>, orbit: Orbit) -> Option<Landscape<'a>> {
        let Shown { of, amount, .. } = self.all.get(spot.member)?;
        let (_, surface) = of.as_ref().filter(|_| *amount > 0.0 && !spot.is_small)?;
        let footing = surface.footing.as_ref().filter(|footing| spot.panel.shows(footing.on))?;
        Some(Landscape::new((surface, footing), (flat(spot), pane(spot)), Lean { amount: *amount, orbit }))
    }

    /// Whether the picture of a spot leans, so that its pixels are not where its lens has them.
    pub(super) fn leans(&self, spot: &Spot<'_>) -> bool {
        let footing =
            |shown: &Shown| shown.of.as_ref().and_then(|(_, surface)| surface.footing.as_ref()).map(|of| of.on);
        let shown = self.all.get(spot.member).filter(|shown| shown.amount > 0.0 && !spot.is_small);
        shown.and_then(footing).is_some_and(|on| spot.panel.shows(on))
    }

    /// The displacement that was clicked in the landscape of a spot.
    pub(super) fn clicked(&self, spot: &Spot<'_>, sensed: &egui::Response, orbit: Orbit) -> Option<[i32; 2]> {
        // A double click returns to the usual view.
        let at = sensed.interact_pointer_pos().filter(|_| sensed.clicked() && !sensed.double_clicked())?;
        let landscape = self.on(spot, orbit).filter(Landscape::has_events)?;
        landscape.displacement_at(at.into(), REACH_PT)
    }
}

fn flat(spot: &Spot<'_>) -> Placement {
    Placement::new(spot.lens.picture_rect().min.into(), spot.lens.scale)
}

fn pane(spot: &Spot<'_>) -> primitive::Rect {
    primitive::Rect { min: spot.lens.pane.min.into(), max: spot.lens.pane.max.into() }
}

/// Paints the picture of a spot with its marks as the ground, and what rises from it.
pub(super) fn paint(ui: &Ui, spot: &Spot<'_>, input: &Input<'_>, state: &mut State) {
    let painter = &ui.painter_at(spot.lens.pane);
    let look = state.marks.look(input);
    let Some(landscape) = state.landscapes.on(spot, input.orbit) else { return };
    let size = spot.panel.frames(&spot.pictures)[0].size();
    state.pictures.lay(painter, spot.panel, (&spot.lens, &spot.pictures), &landscape.picture(size));
    let marks = spot.scene.marks.iter().filter(|mark| spot.panel.shows(mark.on) && !mark.shape.is_layer());
    let paint = |of: &[primitive::Primitive]| painter.extend(primitives::shapes(painter, of));
    paint(&landscape.laid(resolve(marks, &look, flat(spot))));
    let [behind, before] = landscape.stand(input.theme());
    paint(&behind);
    let (theme, colors) = (input.theme(), input.look.colors);
    let (fallen, rolls) =
        state.landscapes.all.get(spot.member).map_or((1.0, false), |shown| (shown.fallen(ui), shown.rolls));
    let ball = if rolls { landscape.rolling(fallen) } else { landscape.falling(fallen) };
    let ball = ball.filter(|_| fallen < 1.0 && landscape.rise == 1.0);
    match input.gpu {
        Some(card) => {
            let Landscape { screen, eye, rise, .. } = landscape;
            let Some(Shown { of: Some((_, surface)), renderer, .. }) = state.landscapes.all.get_mut(spot.member) else {
                return;
            };
            let seen = Seen { screen: &screen, eye, opacity: (4.0 * rise).min(1.0) };
            renderer.paint(painter, seen, surface, (theme, colors), card);
        }
        None => paint(&landscape.polygons((theme, colors, painter.pixels_per_point()))),
    }
    paint(&before);
    if let Some(center) = ball {
        let ink = theme.ink(Role::Candidate);
        let disc = |radius, color| primitive::Primitive::Disc { center, radius, color };
        paint(&[disc(BALL_PT + ink.halo_width, ink.halo), disc(BALL_PT, ink.color)]);
        ui.ctx().request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;
    use motionscope_core::scene::Sentence;

    use super::*;

    /// A step of an iteration that has come so far.
    fn step(trail: &[[f32; 2]]) -> Arc<Step> {
        let surface = Surface {
            footing: Some(Footing::new(Picture::CURRENT, [20.0; 2])),
            trail: trail.to_vec(),
            ..Surface::new("cost", [-2, -2], Grid::new(5, 5, 1.0), Grid::new(5, 5, None))
        };
        let line = motionscope_core::course::estimators()[0].info().pseudocode[0].name;
        Arc::new(Step {
            values: Vec::new(),
            line,
            sentence: Sentence::default(),
            readouts: vec![Readout::Landscape(surface)],
        })
    }

    #[test]
    fn a_ball_rolls_only_where_an_iteration_has_moved_on_by_one() {
        let path = [[-2.0, -2.0], [-1.0, 0.0], [0.0, 0.0], [1.0, 1.0]];
        let mut shown = Shown::default();
        let mut rolls = |step: &Arc<Step>, time: f64| {
            shown.take(step, (Vec::new(), false), time);
            (shown.rolls, shown.since)
        };
        let [one, two, four] = [1, 2, 4].map(|length| step(&path[..length]));
        assert_eq!(rolls(&one, 1.0), (false, 1.0), "it begins");
        assert_eq!(rolls(&two, 2.0), (true, 2.0));
        assert_eq!(rolls(&two, 3.0), (true, 2.0), "the same step again does not begin anew");
        assert_eq!(rolls(&one, 4.0), (false, 4.0), "a step back");
        assert_eq!(rolls(&four, 5.0), (false, 5.0), "a jump ahead");
        let other = step(&[path[0], [0.5, 0.5]]);
        rolls(&one, 6.0);
        assert_eq!(rolls(&other, 7.0), (true, 7.0), "another way from the same place");
        assert_eq!(rolls(&step(&path[1..]), 8.0), (false, 8.0), "the path of another pixel");
    }
}
