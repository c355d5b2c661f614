//! The panes of a step: id, title, content, and the condition under which each has content.

use std::fmt;
use std::str::FromStr;

use motionscope_core::base::Error;
use motionscope_core::products::{DenseField, Product};
use motionscope_core::run::{AnyEstimator, Info};
use motionscope_core::scene::{Chart, Cloud, Diagram, Distribution, Plane, Readout, Regions, Series, Step, Surface};

use crate::paint::charts::{
    ChartStyle, Orbit, cloud, diagram, distribution, explanation, heat_map, histogram, matrices, plane, regions,
    relief, series, stack, tiles,
};
use crate::paint::primitive::Rect;
use crate::paint::{Layer, LevelShown};

/// The viewpoints of the 3-D charts, and the sections of the displacement plane and of the pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// The cost surface.
    pub surface: Orbit,
    /// The pyramid.
    pub pyramid: Orbit,
    /// The point cloud.
    pub cloud: cloud::Viewpoint,
    /// The section of the displacement plane; all of it unless zoomed.
    pub plane: Option<plane::Window>,
    /// The visible part of the pictures in px of frame t where it was chosen by hand; otherwise the view options decide.
    pub section: Option<Rect>,
}

impl Default for Angles {
    fn default() -> Self {
        Self {
            surface: Orbit::default(),
            pyramid: stack::USUAL,
            cloud: cloud::Viewpoint::default(),
            plane: None,
            section: None,
        }
    }
}

/// The content of a step from which panes are drawn.
#[derive(Clone, Copy)]
pub struct PaneContent<'a> {
    /// The estimator.
    pub info: &'a Info,
    /// The step.
    pub step: &'a Step,
    /// The step before, where what has changed is lit.
    pub before: Option<&'a Step>,
    /// Whether the explained pixel lies at the centre of its tiles.
    pub is_centered: bool,
    /// The pyramid level shown on the stage.
    pub level: LevelShown,
    /// The viewpoints of the 3-D charts.
    pub angles: Angles,
}

/// A pane of the window or of a sheet.
#[derive(Debug)]
pub struct Pane {
    /// The id in commands and files.
    pub id: &'static str,
    /// The title on the screen.
    pub title: &'static str,
    /// The content, as part of a sentence.
    pub doc: &'static str,
    /// When it has content, as part of a sentence.
    pub when: &'static str,
    /// The chart that an estimator must declare to fill it; `None` if any estimator may.
    pub chart: Option<Chart>,
    /// Whether a step has content for it.
    pub is_available: fn(&Step) -> bool,
    /// How well the content fits a size in points; 1 is just enough.
    pub room: fn(PaneContent<'_>, [f32; 2], ChartStyle) -> f32,
    /// Draws the content in a rectangle; nothing if the step has none.
    pub draw: fn(PaneContent<'_>, Rect, ChartStyle) -> Vec<Layer>,
}

impl PartialEq for Pane {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

/// The frames with the marks of the step, painted with the figure.
pub const STAGE: Pane = Pane {
    id: "stage",
    title: "Stage",
    doc: "the frames with the marks of the step",
    when: "at every step",
    chart: None,
    is_available: |_| true,
    room: |_, _, _| f32::INFINITY,
    draw: |_, _, _| Vec::new(),
};

/// The explanation of the step.
pub const EXPLANATION: Pane = Pane {
    id: "explanation",
    title: "Explanation",
    doc: "the explanation of the step: sentence, formulas, numbers and pseudocode",
    when: "at every step",
    chart: None,
    is_available: |_| true,
    room: explanation_room,
    draw: |content, area, style| explanation::draw(explained(content), area, style).into_layers(),
};

/// The cost surface as a heat map.
pub const SURFACE: Pane = Pane {
    id: "surface",
    title: "Cost surface",
    doc: "the cost of every tested candidate (u, v), as a heat map",
    when: "once a candidate is tested",
    chart: Some(Chart::Surface),
    is_available: |step| find(step, surface).is_some(),
    room: |_, size, style| letters(size, [26.0, 19.0], style),
    draw: |content, area, style| {
        let draw = |surface| heat_map::draw(heat_map::HeatMap { surface, whose: content.info.name }, area, style);
        find(content.step, surface).map(|surface| draw(surface).into_layers()).unwrap_or_default()
    },
};

/// The cost surface in 3-D.
pub const SURFACE_3D: Pane = Pane {
    id: "surface-3d",
    title: "3-D",
    doc: "the cost of every tested candidate (u, v), as a 3-D surface",
    when: "once a candidate is tested",
    chart: Some(Chart::Surface),
    is_available: |step| find(step, surface).is_some(),
    room: |_, size, style| letters(size, [26.0, 18.0], style),
    draw: |content, area, style| {
        let data = |surface| relief::Relief { surface, whose: content.info.name, orbit: content.angles.surface };
        find(content.step, surface)
            .map(|found| relief::draw(data(found), area, style).into_layers())
            .unwrap_or_default()
    },
};

/// Constraint lines and estimates in the displacement plane.
pub const PLANE: Pane = Pane {
    id: "plane",
    title: "Displacements",
    doc: "constraint lines and estimates in the (u, v) plane",
    when: "when a pixel or a window is explained",
    chart: Some(Chart::Plane),
    is_available: |step| find(step, a_plane).is_some(),
    room: |_, size, style| letters(size, [31.0, 19.0], style),
    draw: |content, area, style| {
        let data = |plane| plane::Shown {
            plane,
            whose: content.info.name,
            window: content.angles.plane,
            has_names_beside: false,
        };
        find(content.step, a_plane).map(|found| plane::draw(data(found), area, style).into_layers()).unwrap_or_default()
    },
};

/// The regions of a decision in the plane of two quantities.
pub const REGIONS: Pane = Pane {
    id: "regions",
    title: "Regions",
    doc: "the regions of the decision in the plane of two quantities, with the pixel in it",
    when: "when a pixel is explained",
    chart: Some(Chart::Regions),
    is_available: |step| find(step, some_regions).is_some(),
    room: |_, size, style| letters(size, [21.0, 19.0], style),
    draw: |content, area, style| {
        let draw = |regions| regions::draw(regions::Shown { regions, whose: content.info.name }, area, style);
        find(content.step, some_regions).map(|found| draw(found).into_layers()).unwrap_or_default()
    },
};

/// A drawing of lines and nodes.
pub const DIAGRAM: Pane = Pane {
    id: "diagram",
    title: "Diagram",
    doc: "the tree of hypotheses, or the wheel of a resampling",
    when: "when hypotheses branch or particles are drawn anew",
    chart: Some(Chart::Diagram),
    is_available: |step| find(step, a_diagram).is_some(),
    room: |_, size, style| letters(size, [28.0, 19.0], style),
    draw: |content, area, style| {
        let draw = |diagram| diagram::draw(diagram::Shown { diagram, whose: content.info.name }, area, style);
        find(content.step, a_diagram).map(|found| draw(found).into_layers()).unwrap_or_default()
    },
};

/// Plots of quantities over the steps.
pub const SERIES: Pane = Pane {
    id: "series",
    title: "Plot",
    doc: "quantities over the steps, such as energy, change and error",
    when: "after the first values",
    chart: Some(Chart::Series),
    is_available: |step| all_series(step).next().is_some(),
    room: |content, size, style| series_room(all_series(content.step).count(), size, style).1,
    draw: |content, area, style| {
        let all: Vec<&Series> = all_series(content.step).collect();
        let plotted = |series| series::Plotted {
            series,
            whose: content.info.name,
            logarithmic: series.is_logarithmic,
            window: None,
        };
        let columns = series_room(all.len(), area.size(), style).0;
        let parts = cells(area, (all.len(), columns), style);
        all.into_iter()
            .zip(parts)
            .flat_map(|(series, area)| series::draw(plotted(series), area, style).into_layers())
            .collect()
    },
};

/// Small windows of pixels with their gray levels.
pub const TILES: Pane = Pane {
    id: "tiles",
    title: "Pixels",
    doc: "the compared pixels with their gray levels",
    when: "when windows of pixels are compared or a pixel is explained",
    chart: Some(Chart::Tiles),
    is_available: |step| find(step, some_tiles).is_some(),
    room: |content, size, style| {
        let Some(tiles) = find(content.step, some_tiles) else { return letters(size, [26.0, 12.0], style) };
        let places = tiles::places(whole(content, tiles), Rect::new([0.0; 2], size), style);
        let fits = (0..2).all(|i| places.size[i] <= size[i] + 1.0);
        if fits { 0.6 + 0.4 * places.cell / tiles::NUMBERS } else { 0.5 }
    },
    draw: |content, area, style| {
        let draw = |tiles| tiles::draw(whole(content, tiles), area, style);
        find(content.step, some_tiles).map(|tiles| draw(tiles).into_layers()).unwrap_or_default()
    },
};

/// The matrices of a filter.
pub const MATRICES: Pane = Pane {
    id: "matrices",
    title: "Matrices",
    doc: "the matrices of the step, with the entries that changed",
    when: "after the first step of the filter",
    chart: Some(Chart::Matrices),
    is_available: |step| find(step, some_matrices).is_some(),
    room: |content, size, style| {
        let Some(all) = find(content.step, some_matrices) else { return letters(size, [26.0, 12.0], style) };
        let needed = matrices::size(all, size[0], style);
        (size[0] / needed[0]).min(size[1] / needed[1]).min(1.3)
    },
    draw: |content, area, style| {
        find(content.step, some_matrices).map(|all| matrices::draw(all, area, style).into_layers()).unwrap_or_default()
    },
};

/// The histogram of displacements.
pub const HISTOGRAM: Pane = Pane {
    id: "histogram",
    title: "Histogram",
    doc: "the number of blocks or pixels with each displacement",
    when: "after the first block of a block search, or at the end of a run that estimates dense flow",
    // At the end of a run, the displacements of pixels are counted as well.
    chart: None,
    is_available: |step| find(step, a_histogram).is_some(),
    room: |_, size, style| letters(size, [34.0, 18.0], style),
    draw: |content, area, style| {
        let draw = |histogram| histogram::draw(histogram::Counts { histogram, whose: content.info.name }, area, style);
        find(content.step, a_histogram).map(|found| draw(found).into_layers()).unwrap_or_default()
    },
};

/// The distribution of the endpoint error.
pub const ERRORS: Pane = Pane {
    id: "errors",
    title: "Errors",
    doc: "the distribution of the endpoint error",
    when: "at the end of the run, if the true flow is known",
    chart: None,
    is_available: |step| find(step, errors).is_some(),
    room: |_, size, style| letters(size, [30.0, 15.0], style),
    draw: |content, area, style| {
        let data = |distribution| distribution::Counted { distribution, whose: content.info.name };
        find(content.step, errors)
            .map(|found| distribution::draw(data(found), area, style).into_layers())
            .unwrap_or_default()
    },
};

/// Points in space.
pub const CLOUD: Pane = Pane {
    id: "cloud",
    title: "Point cloud",
    doc: "the pixels as points in space, with their motion and the cameras",
    when: "once the depths of the pixels are known",
    chart: Some(Chart::Cloud),
    is_available: |step| find(step, a_cloud).is_some(),
    room: |_, size, style| letters(size, [30.0, 19.0], style),
    draw: |content, area, style| {
        let data = |cloud| cloud::Shown { cloud, whose: content.info.name, viewpoint: content.angles.cloud };
        find(content.step, a_cloud).map(|found| cloud::draw(data(found), area, style).into_layers()).unwrap_or_default()
    },
};

/// The levels of a pyramid.
pub const PYRAMID: Pane = Pane {
    id: "pyramid",
    title: "Pyramid",
    doc: "the levels of the pyramid with the vectors found on each",
    when: "after the first level is built",
    chart: Some(Chart::Stack),
    is_available: |step| find(step, a_stack).is_some(),
    room: |_, size, style| letters(size, [30.0, 19.0], style),
    draw: |content, area, style| {
        let Some(stack) = find(content.step, a_stack) else { return Vec::new() };
        let on_stage = content.level.of(&stack.levels);
        let data = stack::Pyramid { stack, whose: content.info.name, on_stage, orbit: content.angles.pyramid };
        stack::draw(data, area, style, &mut stack::Seen::default()).into_layers()
    },
};

/// All panes, in the order in which they are offered.
pub static PANES: [&Pane; 14] = [
    &STAGE,
    &EXPLANATION,
    &SURFACE,
    &SURFACE_3D,
    &PLANE,
    &REGIONS,
    &DIAGRAM,
    &SERIES,
    &TILES,
    &MATRICES,
    &HISTOGRAM,
    &ERRORS,
    &PYRAMID,
    &CLOUD,
];

/// The charts that a step has something for: first those of `order`, what an estimator declares, then all others.
pub fn charts(step: &Step, order: &[Chart]) -> Vec<&'static Pane> {
    let is_chart = |pane: &&'static Pane| **pane != STAGE && **pane != EXPLANATION;
    let mut charts: Vec<_> = PANES.into_iter().filter(is_chart).filter(|pane| (pane.is_available)(step)).collect();
    let place = |pane: &&Pane| pane.chart.and_then(|chart| order.iter().position(|other| *other == chart));
    charts.sort_by_key(|pane| place(pane).unwrap_or(order.len()));
    charts
}

/// The panes that stand on a picture, and from where they are looked at; without any, the stage stands alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// The panes, in the order in which they are arranged.
    pub panes: Vec<&'static Pane>,
    /// The viewpoints of the 3-D charts, and the sections that are seen.
    pub angles: Angles,
}

impl Selection {
    /// Returns these panes, each once, with default viewpoints.
    pub fn of(named: &[Named]) -> Self {
        let mut panes: Vec<&'static Pane> = Vec::new();
        for Named(pane) in named {
            if !panes.contains(pane) {
                panes.push(pane);
            }
        }
        Self { panes, angles: Angles::default() }
    }

    /// The same panes, with this part of the pictures; without one the view options decide.
    #[must_use]
    pub fn seeing(self, section: Option<Rect>) -> Self {
        Self { angles: Angles { section, ..self.angles }, ..self }
    }

    /// The same panes, with the charts in space turned by a share of a full turn.
    #[must_use]
    pub fn turned(&self, share: f32) -> Self {
        let turned = |yaw_rad: f32| (yaw_rad + share * std::f32::consts::TAU).rem_euclid(std::f32::consts::TAU);
        let orbit = |orbit: Orbit| Orbit { yaw_rad: turned(orbit.yaw_rad), ..orbit };
        let Angles { surface, pyramid, cloud, .. } = self.angles;
        let cloud = cloud::Viewpoint { yaw_rad: turned(cloud.yaw_rad), ..cloud };
        let angles = Angles { surface: orbit(surface), pyramid: orbit(pyramid), cloud, ..self.angles };
        Self { angles: if share == 0.0 { self.angles } else { angles }, ..self.clone() }
    }

    /// Whether one of the panes is a chart in space.
    pub fn is_in_space(&self) -> bool {
        self.panes.iter().any(|pane| [&SURFACE_3D, &PYRAMID, &CLOUD].contains(pane))
    }

    /// Refuses panes for which `estimator` never has content.
    ///
    /// # Errors
    /// As [`Pane::check`].
    pub fn check(&self, estimator: &dyn AnyEstimator) -> Result<(), Error> {
        self.panes.iter().try_for_each(|pane| pane.check(estimator))
    }

    /// Refuses panes for which a step has no content.
    ///
    /// # Errors
    /// As [`Pane::absent`].
    pub fn check_step(&self, info: &Info, step: &Step) -> Result<(), Error> {
        let absent = self.panes.iter().find(|pane| !(pane.is_available)(step));
        absent.map_or(Ok(()), |pane| {
            Err(Error::new(format!("{}; choose another --step, or remove it from --panes", pane.absent(info.id))))
        })
    }
}

/// A pane, by its id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Named(pub &'static Pane);

impl FromStr for Named {
    type Err = Error;

    fn from_str(id: &str) -> Result<Self, Error> {
        let found = PANES.iter().find(|pane| pane.id == id.trim());
        let ids: Vec<_> = PANES.iter().map(|pane| pane.id).collect();
        let refused = || Error::new(format!("there is no pane {id}; there are {}", ids.join(", ")));
        found.map(|pane| Self(pane)).ok_or_else(refused)
    }
}

impl Pane {
    /// Returns why the pane is empty at a step, and when it is not.
    pub fn absent(&self, whose: &str) -> String {
        format!("{whose} has no content for the pane {} at this step: it shows {}, {}", self.id, self.doc, self.when)
    }

    /// Refuses the pane for an estimator that never has content for it.
    ///
    /// # Errors
    /// A sentence that names the panes that it has.
    pub fn check(&self, estimator: &dyn AnyEstimator) -> Result<(), Error> {
        if self.can_be_of(estimator) {
            return Ok(());
        }
        let ids: Vec<_> = PANES.iter().filter(|pane| pane.can_be_of(estimator)).map(|pane| pane.id).collect();
        let id = estimator.info().id;
        Err(Error::new(format!("{id} never has the pane {}; its panes are {}", self.id, ids.join(", "))))
    }

    /// Whether some step of `estimator` may have content for the pane.
    fn can_be_of(&self, estimator: &dyn AnyEstimator) -> bool {
        let charts = estimator.charts();
        match self.chart {
            Some(chart) => charts.contains(&chart),
            // Displacements are counted by the steps, or at the end of dense flow.
            None if *self == HISTOGRAM => {
                charts.contains(&Chart::Histogram) || estimator.produces().contains(&DenseField::KIND)
            }
            None => true,
        }
    }
}

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.id)
    }
}

/// What the first readout of a kind has.
pub(super) fn find<'a, T: ?Sized>(step: &'a Step, of: impl Fn(&'a Readout) -> Option<&'a T>) -> Option<&'a T> {
    step.readouts.iter().find_map(of)
}

fn surface(readout: &Readout) -> Option<&Surface> {
    if let Readout::Surface(surface) = readout { Some(surface) } else { None }
}

fn a_plane(readout: &Readout) -> Option<&Plane> {
    if let Readout::Plane(plane) = readout { Some(plane) } else { None }
}

fn some_regions(readout: &Readout) -> Option<&Regions> {
    if let Readout::Regions(regions) = readout { Some(regions) } else { None }
}

fn a_diagram(readout: &Readout) -> Option<&Diagram> {
    if let Readout::Diagram(diagram) = readout { Some(diagram) } else { None }
}

/// Returns the quantities that have values: the others are no plots yet.
pub fn all_series(step: &Step) -> impl Iterator<Item = &Series> {
    let all = step.readouts.iter().filter_map(|readout| match readout {
        Readout::Series(series) => Some(series),
        _ => None,
    });
    all.filter(|series| series::has_values(series))
}

fn some_tiles(readout: &Readout) -> Option<&[motionscope_core::scene::Tile]> {
    if let Readout::Tiles(tiles) = readout { Some(tiles.as_slice()).filter(|tiles| !tiles.is_empty()) } else { None }
}

fn some_matrices(readout: &Readout) -> Option<&[motionscope_core::scene::Matrix]> {
    if let Readout::Matrices(all) = readout { Some(all.as_slice()).filter(|all| !all.is_empty()) } else { None }
}

fn a_histogram(readout: &Readout) -> Option<&motionscope_core::data::Histogram> {
    if let Readout::Histogram(histogram) = readout { Some(histogram) } else { None }
}

fn errors(readout: &Readout) -> Option<&Distribution> {
    if let Readout::Distribution(distribution) = readout { Some(distribution) } else { None }
}

fn a_cloud(readout: &Readout) -> Option<&Cloud> {
    if let Readout::Cloud(cloud) = readout { Some(cloud) } else { None }
}

fn a_stack(readout: &Readout) -> Option<&motionscope_core::scene::Stack> {
    if let Readout::Stack(stack) = readout { Some(stack) } else { None }
}

fn whole<'a>(content: PaneContent<'_>, tiles: &'a [motionscope_core::scene::Tile]) -> tiles::Tiles<'a> {
    tiles::Tiles { tiles, is_centered: content.is_centered, closeness: tiles::Closeness::Whole }
}

fn explained(content: PaneContent<'_>) -> explanation::Explained<'_> {
    explanation::Explained { info: content.info, step: content.step, before: content.before }
}

/// Returns how well a chart of `least` letters of small type across and down fits.
fn letters(size: [f32; 2], least: [f32; 2], style: ChartStyle) -> f32 {
    let fits = [0, 1].map(|i| size[i] / (least[i] * style.small()));
    fits[0].min(fits[1])
}

fn explanation_room(content: PaneContent<'_>, [width, height]: [f32; 2], style: ChartStyle) -> f32 {
    let across = width / (21.0 * style.theme.sizes().body);
    let [least, whole] = explanation::heights(explained(content), width, style);
    let down = match height {
        height if height >= whole => 1.3,
        height if height >= least => 1.0 + 0.3 * (height - least) / (whole - least),
        height => height / least,
    };
    across.min(down)
}

/// Returns the number of columns in which plots fit best, and how well.
fn series_room(count: usize, [width, height]: [f32; 2], style: ChartStyle) -> (usize, f32) {
    let count = count.max(1);
    let rated = (1..=count).map(|columns| {
        let size = [width / columns as f32, height / count.div_ceil(columns) as f32];
        (columns, letters(size, [26.0, 13.0], style))
    });
    rated.reduce(|best, other| if other.1 > best.1 { other } else { best }).unwrap_or((1, 1.0))
}

/// Divides a rectangle into equal cells, row by row.
fn cells(area: Rect, (count, columns): (usize, usize), style: ChartStyle) -> Vec<Rect> {
    let (gap, rows) = (0.6 * style.small(), count.div_ceil(columns.max(1)));
    let share = |i: usize, parts: usize| (area.size()[i] - gap * parts.saturating_sub(1) as f32) / parts.max(1) as f32;
    let size = [share(0, columns), share(1, rows)];
    let cell = |i: usize| {
        let at = [i % columns, i / columns];
        Rect::new([0, 1].map(|axis| area.min[axis] + at[axis] as f32 * (size[axis] + gap)), size)
    };
    (0..count).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::estimators;
    use motionscope_core::products::Motion;

    use super::*;

    #[test]
    fn panes_are_called_by_their_ids() {
        for pane in PANES {
            assert_eq!(pane.id.parse::<Named>().ok(), Some(Named(pane)));
        }
        let error = "serie".parse::<Named>().expect_err("there is none").to_string();
        assert!(error.starts_with("there is no pane serie; there are stage, explanation, surface"), "{error}");
    }

    #[test]
    fn charts_in_space_turn_once_around() {
        let panes = Selection::of(&[Named(&STAGE), Named(&CLOUD)]);
        assert!(panes.is_in_space() && !Selection::of(&[Named(&STAGE), Named(&SERIES)]).is_in_space());
        let yaw = |share: f32| panes.turned(share).angles.cloud.yaw_rad;
        let quarter = (yaw(0.25) - yaw(0.0)).rem_euclid(std::f32::consts::TAU);
        assert!((quarter - std::f32::consts::FRAC_PI_2).abs() < 1e-5, "{quarter}");
        assert!(panes.turned(0.0) == panes && (yaw(1.0) - yaw(0.0)).sin().abs() < 1e-5);
        assert_eq!(panes.turned(0.3).angles.cloud.pitch_rad, panes.angles.cloud.pitch_rad);
    }

    #[test]
    fn displacements_of_single_points_have_no_histogram() {
        let of = |motion: Motion| {
            let is_of = |estimator: &dyn AnyEstimator| estimator.produces().iter().all(|kind| kind.motion == motion);
            estimators().into_iter().find(|estimator| is_of(&**estimator)).unwrap()
        };
        assert_eq!(HISTOGRAM.check(&*of(Motion::Blocks)).map_err(|error| error.to_string()), Ok(()));
        let error = HISTOGRAM.check(&*of(Motion::Points)).unwrap_err().to_string();
        let (refused, panes) = error.split_once("; its panes are ").unwrap();
        assert!(refused.ends_with("never has the pane histogram") && !panes.contains("histogram"), "{error}");
    }

    #[test]
    fn quantities_without_a_value_are_no_plots() {
        let series = |y: f32| {
            let lines = vec![("NIS", motionscope_core::scene::Role::Measured, vec![[1.0, y]])];
            Readout::Series(Series { title: "NIS", lines, ..Series::default() })
        };
        let step = |readouts: Vec<Readout>| {
            let info = motionscope_core::course::estimator("kalman-filter").unwrap().info();
            Step { values: Vec::new(), line: info.pseudocode[0].name, sentence: Default::default(), readouts }
        };
        assert!(charts(&step(vec![series(f32::NAN), Readout::Tiles(Vec::new())]), &[]).is_empty());
        assert_eq!(charts(&step(vec![series(f32::NAN), series(2.0)]), &[]), [&SERIES]);
        assert_eq!(all_series(&step(vec![series(f32::NAN), series(2.0)])).count(), 1);
    }

    #[test]
    fn every_chart_of_an_estimator_has_a_pane() {
        for chart in Chart::ALL.iter().filter(|chart| **chart != Chart::Histogram) {
            assert!(PANES.iter().any(|pane| pane.chart == Some(*chart)), "{chart:?}");
        }
    }
}
