//! Arrow keys among things that lie in rows and columns.

use eframe::egui::{Key, Rangef, Rect, Vec2, vec2};

/// The direction of the arrow key that was pressed, if one was.
pub fn pressed(mut is_pressed: impl FnMut(Key) -> bool) -> Option<Vec2> {
    let ways = [
        (Key::ArrowLeft, vec2(-1.0, 0.0)),
        (Key::ArrowRight, vec2(1.0, 0.0)),
        (Key::ArrowUp, vec2(0.0, -1.0)),
        (Key::ArrowDown, vec2(0.0, 1.0)),
    ];
    ways.into_iter().find(|(key, _)| is_pressed(*key)).map(|(_, way)| way)
}

/// What lies nearest to `from` that way: what is off to the side counts as twice as far.
pub fn nearest<T: Copy>(items: &[(T, Rect)], from: Rect, way: Vec2) -> Option<T> {
    let gap = |a: Rangef, b: Rangef| (b.min - a.max).max(a.min - b.max).max(0.0);
    let cost = |rect: &Rect| {
        let across = [gap(from.x_range(), rect.x_range()), gap(from.y_range(), rect.y_range())];
        let (along, off) = if way.x == 0.0 { (across[1], across[0]) } else { (across[0], across[1]) };
        along + 2.0 * off
    };
    let lies_there = |rect: &Rect| {
        (rect.center() - from.center()).dot(way) > 0.0 && {
            // Beyond the edge, not only a little further on.
            let (edge, near) = (from.center() + way * from.size() / 2.0, rect.center() - way * rect.size() / 2.0);
            (near - edge).dot(way) > -2.0
        }
    };
    let there = items.iter().filter(|(_, rect)| lies_there(rect));
    there.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b))).map(|(item, _)| *item)
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    #[test]
    fn arrows_go_to_what_lies_next_to_where_they_start() {
        let at = |x: f32, y: f32, width: f32| Rect::from_min_size(pos2(x, y), vec2(width, 20.0));
        // Two cards above two rows of lessons, which begin further right.
        let rects = [
            at(0.0, 0.0, 90.0),
            at(100.0, 0.0, 90.0),
            at(150.0, 50.0, 60.0),
            at(220.0, 50.0, 60.0),
            at(150.0, 72.0, 40.0),
        ];
        let items: Vec<(usize, Rect)> = rects.into_iter().enumerate().collect();
        let next = |from: usize, x: f32, y: f32| nearest(&items, rects[from], vec2(x, y));
        assert_eq!((next(0, 1.0, 0.0), next(1, -1.0, 0.0)), (Some(1), Some(0)));
        assert_eq!((next(0, 0.0, 1.0), next(1, 0.0, 1.0)), (Some(2), Some(2)), "the first row of lessons");
        assert_eq!((next(2, 0.0, 1.0), next(3, 0.0, 1.0), next(4, 0.0, -1.0)), (Some(4), Some(4), Some(2)));
        assert_eq!((next(2, 1.0, 0.0), next(2, 0.0, -1.0)), (Some(3), Some(1)));
        assert_eq!((next(0, -1.0, 0.0), next(4, 0.0, 1.0)), (None, None));
    }
}
