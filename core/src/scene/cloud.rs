//! Points in space with their motion, as data that is computed when a chart shows it.

use std::fmt;
use std::sync::{Arc, OnceLock};

use super::Role;

/// A point in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Position in m in the coordinates of the left camera of frame t: X to the right, Y down, Z forwards.
    pub at: [f32; 3],
    /// Its colour in the picture.
    pub color: [u8; 3],
    /// Its role, in place of its colour.
    pub role: Option<Role>,
    /// Its pixel in frame t.
    pub pixel: [u16; 2],
}

/// A displacement in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudLine {
    /// Its role.
    pub role: Role,
    /// Start and end in m.
    pub ends: [[f32; 3]; 2],
}

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudCamera {
    /// Its role.
    pub role: Role,
    /// Its centre, and the corners of its picture some way before it, in m.
    pub corners: [[f32; 3]; 5],
}

/// The content of a cloud.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CloudData {
    /// The points up to the depth that is shown.
    pub points: Vec<CloudPoint>,
    /// Displacements of some of them.
    pub lines: Vec<CloudLine>,
    /// The cameras.
    pub cameras: Vec<CloudCamera>,
    /// The depth in m up to which points are shown.
    pub depth_m: f32,
}

type Make = dyn Fn() -> CloudData + Send + Sync;

/// A cloud of points.
#[derive(Clone)]
pub struct Cloud {
    /// Its title.
    pub title: &'static str,
    /// The meaning of the roles in it.
    pub legend: Vec<(Role, &'static str)>,
    /// The points in m that the step is about, with their roles.
    pub marked: Vec<(Role, [f32; 3])>,
    data: Arc<OnceLock<CloudData>>,
    make: Arc<Make>,
}

impl Cloud {
    /// A cloud of what `make` computes when it is looked at.
    pub fn new(title: &'static str, make: impl Fn() -> CloudData + Send + Sync + 'static) -> Self {
        Self { title, legend: Vec::new(), marked: Vec::new(), data: Arc::default(), make: Arc::new(make) }
    }

    /// Its points, lines and cameras.
    pub fn data(&self) -> &CloudData {
        self.data.get_or_init(|| (self.make)())
    }
}

impl PartialEq for Cloud {
    fn eq(&self, other: &Self) -> bool {
        let same = (self.title, &self.legend, &self.marked) == (other.title, &other.legend, &other.marked);
        same && (Arc::ptr_eq(&self.data, &other.data) || self.data() == other.data())
    }
}

impl fmt::Debug for Cloud {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cloud").field("title", &self.title).field("marked", &self.marked).finish_non_exhaustive()
    }
}
