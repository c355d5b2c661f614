//! What the methods that work on derivatives share: derivatives of a pair of pictures, smoothing, reading between pixels
//! and warping, fields of displacements, and how a gradient constraint is told and drawn.

mod derivatives;
pub mod explain;
pub mod field;
mod given;
mod jacobi;
mod linear;
mod multiscale;
pub mod relax;
pub mod stencil;
mod tensor;

pub use derivatives::{Derivatives, FLAT, Scheme};
pub use field::Field;
pub use given::{Given, truth};
pub use linear::{Constraints, Linear};
pub use multiscale::Multiscale;
pub use tensor::{Sums, Tensor, Texture, Weights, Window};
