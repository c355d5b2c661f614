//! Placing lines, zones, contours or points on the picture with the mouse.

use eframe::egui::{
    Align, Button, Color32, Label, Layout, Painter, Pos2, RichText, Shape, Stroke, TextStyle, Ui, WidgetInfo, vec2,
};
use motionscope_core::params::{Figure, Placed, Spec, Spot};
use motionscope_core::scene::{Picture, PictureRole};

use super::{Input, Lens, Response, State};
use crate::paint::Theme;
use crate::ui::drawing::style;

/// How near to a handle one has to press to take it, in points.
const NEAR_PT: f32 = 12.0;
/// How large a handle is, in points.
const HANDLE_PT: f32 = 5.0;

/// A parameter that is being placed on the picture.
#[derive(Clone, Debug)]
pub struct Placing {
    /// Which one of the estimator.
    pub index: usize,
    /// Its declaration.
    pub spec: &'static Spec,
    /// What it is now.
    pub now: Placed,
    /// The frame in which points are placed.
    pub frame: usize,
    /// Whether a place in one frame is followed by the next.
    pub is_by_frame: bool,
}

impl Placing {
    /// The same on `picture`, if it can be placed there: points of one frame are not those of the next, while a line or a zone
    /// is the same in all frames.
    pub fn on(&self, picture: Picture) -> Option<Self> {
        let is_shared = self.is_by_frame || self.now.figure() != Figure::Spots;
        let frame = self.frame.checked_add_signed(picture.time as isize)?;
        let fits = picture.role == PictureRole::Frame && picture.is_aligned_with(Picture::CURRENT);
        (fits && (is_shared || picture == Picture::CURRENT)).then(|| Self { frame, ..self.clone() })
    }
}

/// What became of placing in a frame of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gesture {
    /// Nothing.
    #[default]
    None,
    /// It stays as it is now.
    Settled,
    /// It does, and the next frame is to follow.
    SettledFrame,
    /// No more is placed.
    Done,
}

/// What the mouse holds.
#[derive(Clone, Debug)]
pub enum Grip {
    /// A handle of what was there when it was taken.
    Handle(usize, Placed),
    /// The far end of something that began at a place, beside what was there.
    New([f32; 2], Placed),
}

/// What to do, and the way out: in the line below the pictures, so that they stay where they are.
pub fn tools(ui: &mut Ui, input: &Input<'_>, response: &mut Response) {
    let Some(placing) = input.placing else { return };
    let what = placing.spec.label.to_lowercase();
    let message = match placing.now.figure() {
        Figure::Spots if !placing.is_by_frame => {
            "A click adds a point, dragging moves it, a right-click removes it.".to_owned()
        }
        Figure::Spots => {
            format!(
                "Click the object in frame {}; the next frame follows. A right-click removes a point.",
                placing.frame
            )
        }
        Figure::Lines => "Dragging adds a line or moves an end; a right-click on an end removes its line.".to_owned(),
        Figure::Zones => {
            "Dragging adds a zone or moves a corner; a right-click on a corner removes its zone.".to_owned()
        }
        Figure::Contour => {
            "Drag a box for an ellipse, or a corner; a click beside an edge adds a corner, a right-click removes it."
                .to_owned()
        }
        Figure::Zone => {
            format!("Drag from corner to corner of the {what}, or move a corner. A right-click removes it.")
        }
    };
    let size = vec2(ui.available_width(), style::line_height(input.theme()));
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        let done = ui.add(Button::new(RichText::new("Done").small()).small());
        done.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::Button, true, format!("Done placing {what}")));
        if done.on_hover_text("Esc").clicked() {
            response.placing = Gesture::Done;
        }
        // The whole of it comes on hover where it is cut.
        ui.add(Label::new(RichText::new(message).text_style(TextStyle::Small)).truncate());
    });
}

/// Takes what the mouse does on a picture; gives whether it holds something.
pub fn act(
    ui: &Ui,
    sensed: &eframe::egui::Response,
    (lens, placing): (&Lens, &Placing),
    state: &mut State,
    response: &mut Response,
) -> bool {
    let Placing { now, frame, .. } = placing;
    let handle_at = |at: Pos2| {
        let far = |handle: [f32; 2]| lens.to_screen(handle).distance(at);
        let handles = now.handles(*frame).into_iter().enumerate();
        let nearest = handles.min_by(|(_, a), (_, b)| far(*a).total_cmp(&far(*b)))?;
        (far(nearest.1) <= NEAR_PT).then_some(nearest.0)
    };
    let at = sensed.interact_pointer_pos();
    if sensed.drag_started()
        && let Some(origin) = ui.input(|i| i.pointer.press_origin())
    {
        let new = || (now.figure() != Figure::Spots).then(|| Grip::New(place(lens, origin), now.clone()));
        state.grip = handle_at(origin).map(|index| Grip::Handle(index, now.clone())).or_else(new);
    }
    if let (Some(grip), Some(at)) = (&state.grip, at) {
        let to = place(lens, at);
        response.placed = Some(match grip {
            Grip::Handle(index, from) => from.moved(*frame, *index, to),
            Grip::New(from, before) => before.extended(*from, to),
        });
    }
    let is_gripped = state.grip.is_some();
    if sensed.drag_stopped() && state.grip.take().is_some() {
        response.placing = Gesture::Settled;
    }
    if let Some(at) = at.filter(|_| sensed.secondary_clicked())
        && let Some(index) = handle_at(at)
    {
        response.placed = Some(now.without(*frame, index));
        response.placing = Gesture::Settled;
    }
    if let Some(at) = at.filter(|at| sensed.clicked() && now.figure().grows_by_clicks() && lens.pixel_at(*at).is_some())
    {
        response.placed = Some(now.with(Spot { frame: *frame, at: place(lens, at) }));
        let is_followed = placing.is_by_frame && now.figure() == Figure::Spots;
        response.placing = if is_followed { Gesture::SettledFrame } else { Gesture::Settled };
    }
    is_gripped
}

/// The place under the mouse, to a tenth of a pixel: a hand is no steadier.
fn place(lens: &Lens, at: Pos2) -> [f32; 2] {
    lens.to_image(at).map(|c| (c * 10.0).round() / 10.0)
}

/// Draws what is placed with the handles by which it is moved; of points also those of other frames, smaller.
pub fn paint(painter: &Painter, lens: &Lens, placing: &Placing, theme: Theme) {
    let (chrome, under) = (theme.chrome(), Color32::from_black_alpha(150));
    let accent = style::color(chrome.accent);
    let line = |points: Vec<Pos2>, closed: bool| {
        for stroke in [Stroke::new(4.0, under), Stroke::new(2.0, accent)] {
            let points = points.clone();
            painter.add(if closed { Shape::closed_line(points, stroke) } else { Shape::line(points, stroke) });
        }
    };
    let handles: Vec<Pos2> = placing.now.handles(placing.frame).into_iter().map(|at| lens.to_screen(at)).collect();
    match &placing.now {
        Placed::Lines(_) => handles.chunks(2).for_each(|ends| line(ends.to_vec(), false)),
        Placed::Zone(_) | Placed::Zones(_) => handles.chunks(4).for_each(|corners| line(corners.to_vec(), true)),
        Placed::Contour(_) => line(handles.clone(), true),
        Placed::Spots(spots) => {
            for spot in spots.all().iter().filter(|spot| spot.frame != placing.frame) {
                painter.circle_filled(lens.to_screen(spot.at), 2.5, accent.gamma_multiply(0.7));
            }
        }
    }
    for at in handles {
        painter.circle(at, HANDLE_PT, accent, Stroke::new(2.0, under));
    }
}
