//! Encoding and saving of flow, tables, pictures and tracks. Encoders return bytes; only [`save`] writes files.

mod animation;
mod clip;
mod disparity;
mod flo;
mod guard;
mod h264;
mod kitti;
mod mark;
mod mot;
mod npy;
mod picture;
mod save;
mod written_files;

pub use animation::{AnimationFormat, Reel, Timing};
pub use clip::{clip, frame};
pub use disparity::{kitti_disparity, kitti_disparity_result, pfm};
pub use flo::flo;
pub use guard::{Conflict, InputKind, Inputs, Target, check};
pub use h264::{MP4_DESCRIPTION, video};
pub use kitti::{Kitti, kitti, kitti_result};
pub(crate) use mark::is_result;
pub use mark::save_result;
pub use mot::{mot, rect as mot_rect};
pub use npy::{npy, npy_of};
pub use picture::{Pixels, png, png_result};
pub(super) use save::cannot_write;
pub use save::{copy, fill_folder, make_folder, save};
pub use written_files::hash;
