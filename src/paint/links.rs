//! Lines between pictures, such as matches.

use motionscope_core::scene::{Link, Picture, Scene};

use super::primitive::{Point, Primitive, Rect, Stroke};
use super::{Color, Look, Panel, Placement};

/// A picture in its place: lines end inside its pane.
#[derive(Clone, Copy, Debug)]
pub struct LinkSite {
    /// The panel.
    pub panel: Panel,
    /// Where its picture lies.
    pub place: Placement,
    /// What of the sheet it takes.
    pub pane: Rect,
}

/// Thinner than marks: there are many.
const WIDTH: f32 = 1.25;
/// Radius of an end.
const END: f32 = 2.0;
/// Opacity, and where there are many, so that the pictures below are seen.
const ALPHA: u8 = 0xd8;
const FAINT: u8 = 0x70;
const MANY: usize = 60;

impl LinkSite {
    fn point(&self, at: [f32; 2]) -> Option<Point> {
        let point = self.place.at(at);
        let is_inside = (0..2).all(|i| (self.pane.min[i]..=self.pane.max[i]).contains(&point[i]));
        is_inside.then_some(point)
    }
}

/// The lines of `scene` over the pictures of its estimator. Where the picture of one end is not shown, the line is a displacement on the
/// other picture.
pub fn links(scene: &Scene, look: &Look, sites: &[LinkSite]) -> Vec<Primitive> {
    let alpha = if scene.links.len() > MANY { FAINT } else { ALPHA };
    scene.links.iter().filter_map(|link| line(link, (look, alpha), sites)).flatten().collect()
}

fn line(link: &Link, (look, alpha): (&Look, u8), sites: &[LinkSite]) -> Option<Vec<Primitive>> {
    let [(first, from), (second, to)] = link.ends;
    let site = |picture: Picture| sites.iter().find(|site| site.panel.shows(picture));
    let (here, there) = (site(first).or(site(second))?, site(second).or(site(first))?);
    let points = [here.point(from)?, there.point(to)?];
    let ink = look.theme.ink(link.role);
    let Color([r, g, b, _]) = ink.color;
    let stroke = Stroke { width: WIDTH, color: Color([r, g, b, alpha]), dash: &[] };
    let line = Primitive::Polyline { points: points.to_vec(), closed: false, stroke };
    let end = |center| Primitive::Disc { center, radius: END, color: ink.color };
    Some(vec![line, end(points[0]), end(points[1])])
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Role;

    use super::*;
    use crate::paint::Style;

    fn site(panel: Panel, x: f32) -> LinkSite {
        let pane = Rect { min: [x, 0.0], max: [x + 100.0, 80.0] };
        LinkSite { panel, place: Placement::new([x, 0.0], 2.0), pane }
    }

    #[test]
    fn a_line_goes_from_picture_to_picture_or_stays_on_one() {
        let ends = [(Picture::CURRENT, [10.0, 5.0]), (Picture::NEXT, [12.0, 6.0])];
        let scene = Scene { links: vec![Link { role: Role::Result, ends }], ..Scene::default() };
        let look = Look::new(&scene, Style::default());
        let ends_on = |sites: &[LinkSite]| match &links(&scene, &look, sites)[..] {
            [Primitive::Polyline { points, .. }, Primitive::Disc { .. }, Primitive::Disc { .. }] => points.clone(),
            other => panic!("{other:?}"),
        };
        let both = [site(Panel::Of(Picture::CURRENT), 0.0), site(Panel::NEXT, 110.0)];
        assert_eq!(ends_on(&both), [[21.0, 11.0], [135.0, 13.0]]);
        assert_eq!(ends_on(&both[..1]), [[21.0, 11.0], [25.0, 13.0]]);
        let far = [(Picture::CURRENT, [60.0, 5.0]), (Picture::NEXT, [12.0, 6.0])];
        let outside = Scene { links: vec![Link { role: Role::Result, ends: far }], ..Scene::default() };
        assert!(links(&outside, &look, &both).is_empty(), "what is not seen has no line");
    }
}
