//! Poses of rigid objects in space.

/// The rotation and translation that take an object's coordinates to those of the camera: X to the right, Y down, Z forwards, in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation matrix, row by row.
    pub rotation: [[f64; 3]; 3],
    /// The object's origin in the coordinates of the camera, in m.
    pub translation: [f64; 3],
}

/// The product of two 3×3 matrices, row by row.
fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| [0, 1, 2].map(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

impl Pose {
    /// The pose of an object whose coordinates are those of the camera.
    pub const IDENTITY: Self =
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// A pose by the sine and cosine of its angles: the object turns about its vertical axis Y, then its top is tilted towards the camera about X.
    pub fn tilted(turn: (f64, f64), tilt: (f64, f64), translation: [f64; 3]) -> Self {
        let (sin, cos) = turn;
        let about_y = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
        let (sin, cos) = tilt;
        let about_x = [[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]];
        Self { rotation: product(&about_x, &about_y), translation }
    }

    /// The coordinates of the camera of a point of the object.
    pub fn moved(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.turned(point);
        [0, 1, 2].map(|i| turned[i] + self.translation[i])
    }

    /// A direction of the object as one of the camera.
    pub fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| row[0] * direction[0] + row[1] * direction[1] + row[2] * direction[2])
    }

    /// A direction of the camera as one of the object.
    pub fn turned_back(&self, direction: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|j| (0..3).map(|i| self.rotation[i][j] * direction[i]).sum())
    }

    /// The pose that applies `inner` first: of an object in the coordinates of another one, in those of the camera.
    #[must_use]
    pub fn of(&self, inner: &Self) -> Self {
        Self { rotation: product(&self.rotation, &inner.rotation), translation: self.moved(inner.translation) }
    }

    /// The pose that takes coordinates of the camera back to those of the object.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.rotation[j][i]));
        Self { rotation, translation: self.turned_back(self.translation).map(|c| -c) }
    }

    /// The angle of its rotation in rad, from 0 to π.
    pub fn angle_rad(&self) -> f64 {
        vector_of(&self.rotation).iter().map(|c| c * c).sum::<f64>().sqrt()
    }

    /// The pose after a rotation vector in rad about the object's origin, along the axes of the camera, and a translation in m.
    #[must_use]
    pub fn after(&self, [rotation, translation]: [[f64; 3]; 2]) -> Self {
        let turned = product(&rotation_of(rotation), &self.rotation);
        Self { rotation: turned, translation: [0, 1, 2].map(|i| self.translation[i] + translation[i]) }
    }

    /// The motion that leads to another pose, as of [`Pose::after`].
    pub fn motion_to(&self, other: &Self) -> [[f64; 3]; 2] {
        let back = [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.rotation[j][i]));
        let between = product(&other.rotation, &back);
        [vector_of(&between), [0, 1, 2].map(|i| other.translation[i] - self.translation[i])]
    }
}

/// The rotation matrix of a rotation vector (Rodrigues' formula).
fn rotation_of(vector: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = vector;
    let square = x * x + y * y + z * z;
    let angle = square.sqrt();
    // Near zero sin(a)/a and (1 − cos a)/a² have their limits.
    let (a, b) = if angle < 1e-6 { (1.0, 0.5) } else { (angle.sin() / angle, (1.0 - angle.cos()) / square) };
    [
        [1.0 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y],
        [b * x * y + a * z, 1.0 - b * (x * x + z * z), b * y * z - a * x],
        [b * x * z - a * y, b * y * z + a * x, 1.0 - b * (x * x + y * y)],
    ]
}

/// The rotation vector of a rotation by less than half a turn.
fn vector_of(m: &[[f64; 3]; 3]) -> [f64; 3] {
    let twice = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    let sin = twice.iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0;
    let cos = (m[0][0] + m[1][1] + m[2][2] - 1.0) / 2.0;
    let scale = if sin < 1e-9 { 0.5 } else { sin.atan2(cos) / (2.0 * sin) };
    twice.map(|c| c * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_are_those_between_poses() {
        let pose = Pose::tilted((0.5, 0.75f64.sqrt()), (0.6, 0.8), [0.1, -0.2, 1.5]);
        let motion = [[0.2, -0.5, 0.3], [0.01, 0.02, -0.3]];
        let found = pose.motion_to(&pose.after(motion));
        let off = found.as_flattened().iter().zip(motion.as_flattened()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12, "{found:?}");
        let at = [0.3, -0.1, 0.2];
        let other = Pose::tilted((0.8, 0.6), (-0.28, 0.96), [1.0, 0.5, -2.0]);
        let (both, one) = (other.of(&pose).moved(at), other.moved(pose.moved(at)));
        let home = pose.inverse().moved(pose.moved(at));
        assert!((0..3).all(|i| (both[i] - one[i]).abs() < 1e-12 && (home[i] - at[i]).abs() < 1e-12));
        assert!((Pose::IDENTITY.after([[0.0, 0.3, 0.4], [0.0; 3]]).angle_rad() - 0.5).abs() < 1e-12);
        let back = pose.turned_back(pose.turned(at));
        assert!(at.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
        // A quarter turn about Y takes the object's right side to the front.
        let quarter = Pose::tilted((1.0, 0.0), (0.0, 1.0), [0.0; 3]);
        assert_eq!(quarter.turned([1.0, 0.0, 0.0]), [0.0, 0.0, -1.0]);
        // Tilted, the top is seen.
        assert!(Pose::tilted((0.0, 1.0), (0.6, 0.8), [0.0; 3]).turned([0.0, -1.0, 0.0])[2] < 0.0);
    }
}
