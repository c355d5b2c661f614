//! How often a quantity has each value: bars, and the figures that sum them up.

use eframe::egui::{self, Align2, Painter, Rect, Sense, Stroke, Ui, pos2, vec2};
use motionscope_core::Role;
use motionscope_core::scene::Distribution;

use crate::paint::{Face, Theme, grouped, number};
use crate::ui::charts::axis::Axis;
use crate::ui::drawing::{ink, primitives};

/// What is shown.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The counts.
    pub distribution: &'a Distribution,
    /// The look.
    pub theme: Theme,
}

/// The distribution in words, in one line.
pub fn summary(distribution: &Distribution) -> String {
    let Distribution { title, unit, figures, shares, .. } = distribution;
    let figures: Vec<_> = figures.iter().map(|(name, v)| format!("{name} {} {unit}", short(*v))).collect();
    let shares: Vec<_> =
        shares.iter().map(|(limit, share)| format!("R{limit:.1} {}", percent(f64::from(*share)))).collect();
    format!("{title}: {}; {}", figures.join(", "), shares.join(", "))
}

/// The shares that exceed a limit; all else stands in the picture.
fn beyond(Distribution { unit, shares, .. }: &Distribution) -> String {
    let told = |(limit, share): &(f32, f32)| format!("{limit} {unit}: {}", percent(f64::from(*share)));
    format!("Off by more than {}", shares.iter().map(told).collect::<Vec<_>>().join(" · "))
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Three digits that count are enough.
fn short(v: f32) -> String {
    if v < 1.0 { format!("{v:.3}") } else { format!("{v:.2}") }
}

/// Shows the distribution in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>) {
    let Input { distribution, theme } = input;
    let (area, response) = ui.allocate_exact_size(ui.available_size().max(vec2(80.0, 60.0)), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, summary(distribution)));
    let small = theme.sizes().small;
    let min = area.min + vec2(4.6 * small, 4.4 * small);
    let rect = Rect::from_min_max(min, (area.max - vec2(2.0 * small, 3.4 * small)).max(min + vec2(8.0, 8.0)));
    let x = Axis { values: [0.0, distribution.top], places: [rect.min.x, rect.max.x] };
    let total = f64::from(distribution.counts.iter().sum::<u32>() + distribution.beyond).max(1.0);
    let most = distribution.counts.iter().copied().max().unwrap_or(1).max(1);
    let painter = ui.painter_at(area);
    let text = ink::color(theme.chrome().text);
    let font = ink::font(Face::Sans, small);
    axes(&painter, (rect, x), input);
    let bar = |i: usize| {
        let width = distribution.top / distribution.counts.len() as f32;
        let [left, right] = [i, i + 1].map(|i| x.place(i as f32 * width));
        let height = distribution.counts[i] as f32 / most as f32 * rect.height();
        Rect::from_min_max(pos2(left, rect.max.y - height), pos2(right, rect.max.y))
    };
    let color = ink::color(theme.word(Role::Error)).gamma_multiply(0.75);
    for i in 0..distribution.counts.len() {
        painter.rect_filled(bar(i).shrink2(vec2(0.5, 0.0)), 0.0, color);
    }
    figures(&painter, (rect, x), input);
    let pointed = response.hover_pos().filter(|at| rect.contains(*at));
    let at = pointed.map(|at| {
        ((x.value(at.x) / distribution.top * distribution.counts.len() as f32) as usize)
            .min(distribution.counts.len() - 1)
    });
    let told = match at {
        Some(i) => {
            painter.rect_stroke(bar(i), 0.0, Stroke::new(1.5, text), egui::StrokeKind::Outside);
            let width = distribution.top / distribution.counts.len() as f32;
            let [from, to] = [i, i + 1].map(|i| number(i as f32 * width));
            let count = distribution.counts[i];
            let share = percent(f64::from(count) / total);
            format!("{from} to {to} {}: {} pixels, {share}", distribution.unit, grouped(count as usize))
        }
        None => beyond(distribution),
    };
    ink::line(&painter, pos2(area.min.x, area.min.y + 0.7 * small), (&told, font, text), area.width());
}

fn axes(painter: &Painter, (rect, x): (Rect, Axis), Input { distribution, theme }: Input<'_>) {
    let chrome = theme.chrome();
    let (dim, text) = (ink::color(chrome.dim), ink::color(chrome.text));
    let small = theme.sizes().small;
    let font = ink::font(Face::Sans, small);
    painter.hline(rect.x_range(), rect.max.y, Stroke::new(1.0, dim));
    for tick in x.ticks(5.0 * small, 0.0) {
        let at = x.place(tick);
        painter.vline(at, rect.max.y..=rect.max.y + 4.0, Stroke::new(1.0, dim));
        painter.text(pos2(at, rect.max.y + 6.0), Align2::CENTER_TOP, number(tick), font.clone(), dim);
    }
    let below = rect.max.y + 6.0 + 1.3 * small;
    let name = format!("{}, {}", distribution.title.to_lowercase(), distribution.unit);
    painter.text(pos2(rect.max.x, below), Align2::RIGHT_TOP, name, font.clone(), text);
    if distribution.beyond > 0 {
        let total = f64::from(distribution.counts.iter().sum::<u32>() + distribution.beyond);
        let beyond = percent(f64::from(distribution.beyond) / total);
        let words = format!("{beyond} lie beyond {}", number(distribution.top));
        painter.text(pos2(rect.min.x, below), Align2::LEFT_TOP, words, font.clone(), dim);
    }
    let most = distribution.counts.iter().copied().max().unwrap_or(0);
    painter.text(rect.left_top() - vec2(7.0, 0.0), Align2::RIGHT_CENTER, grouped(most as usize), font, dim);
}

/// A line for each figure, with its name above, as far as they do not stand on each other.
fn figures(painter: &Painter, (rect, x): (Rect, Axis), Input { distribution, theme }: Input<'_>) {
    let chrome = theme.chrome();
    let font = ink::font(Face::Sans, theme.sizes().small);
    let mut order: Vec<_> = distribution.figures.iter().enumerate().collect();
    order.sort_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
    let mut taken = [f32::NEG_INFINITY; 2];
    for (i, (name, value)) in order {
        let (at, dash): (f32, &[f32]) = (x.place(*value), [&[][..], &[4.0, 3.0], &[1.5, 2.5]][i % 3]);
        let stroke = Stroke::new(1.5, ink::color(chrome.text));
        painter.extend(primitives::line(&[pos2(at, rect.min.y), pos2(at, rect.max.y)], stroke, dash));
        let galley = painter.layout_no_wrap(format!("{name} {}", short(*value)), font.clone(), stroke.color);
        // On the lower of two lines, or on the upper where its neighbour is too close.
        let row = if taken[0] < at { 0 } else { 1 };
        let left = (at - 2.0).max(taken[row]).min(rect.max.x - galley.size().x);
        taken[row] = left + galley.size().x + 8.0;
        let up = (row + 1) as f32 * 1.25 * theme.sizes().small;
        painter.galley(pos2(left, rect.min.y - up - 2.0), galley, stroke.color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distribution_tells_itself_in_one_line() {
        let distribution = Distribution {
            title: "Endpoint error",
            unit: "px",
            top: 2.0,
            counts: vec![4, 3, 2, 1],
            beyond: 0,
            figures: vec![("mean", 0.61), ("median", 0.5), ("95 %", 1.75)],
            shares: vec![(0.5, 0.6), (1.0, 0.3)],
        };
        assert_eq!(
            summary(&distribution),
            "Endpoint error: mean 0.610 px, median 0.500 px, 95 % 1.75 px; R0.5 60.0 %, R1.0 30.0 %"
        );
        assert_eq!(beyond(&distribution), "Off by more than 0.5 px: 60.0 % · 1 px: 30.0 %");
    }
}
