//! What leaves the program as a file: flow, tables, pictures, tracks. Encoders make bytes; [`save`] alone writes them.

mod clip;
mod flo;
mod kitti;
mod ledger;
mod mot;
mod npy;
mod picture;
mod save;

pub use clip::{clip, frame};
pub use flo::flo;
pub use kitti::{Kitti, kitti};
pub use mot::{mot, rect as mot_rect};
pub use npy::{npy, npy_of};
pub use picture::{Pixels, png};
pub use save::{make_folder, save};
