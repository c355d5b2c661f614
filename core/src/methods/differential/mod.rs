//! Common parts of differential methods: derivatives of a pair of frames, gradient constraints, image warping, structure
//! tensors, relaxation, flow fields, and how these are explained.
//!
//! A [`Scheme`] takes derivatives from frame t and from frame t + 1 warped by the current flow. Outside the picture the
//! derivatives are NaN and excluded from every window; for filtering, images are extrapolated linearly beyond their borders
//! (`filter::Beyond`).

mod conclusion;
mod derivatives;
pub mod explain;
pub mod field;
mod frame_pair;
mod jacobi;
mod linear;
mod multiscale;
pub mod numbers;
pub mod relax;
pub mod sor;
pub mod stencil;
mod tensor;

pub use conclusion::{Advice, Conclusion};
pub use derivatives::{Derivatives, FLAT, Scheme};
pub use field::Field;
pub use frame_pair::{FramePair, truth};
pub use linear::{Constraints, Linear};
pub use multiscale::{Multiscale, mean_change, unit_of};
pub use tensor::{EDGE_RATIO, Sums, Tensor, Texture, Weights, Window};
