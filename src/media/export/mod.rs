//! What leaves the program as a file: flow, tables, pictures, tracks. Encoders make bytes; [`save`] alone writes them.

mod clip;
mod flo;
mod kitti;
mod ledger;
mod mot;
mod npy;
mod objects;
mod picture;
mod save;
mod table;
mod vectors;

pub use clip::{clip, frame};
pub use flo::flo;
pub use kitti::{Kitti, kitti};
pub use mot::mot;
pub use npy::{npy, objects_npy};
pub use objects::{TrackFormat, mask_name, masks, tracks, write_masks};
pub use picture::{Pixels, png};
pub use save::{make_folder, save};
pub use table::{Cell, Table};
pub use vectors::{FlowFormat, csv, flow};
