//! Block matching: one displacement per block. One file per estimator; the shared parts are in `block_search`.

mod full_search;

pub use full_search::{FullSearch, Order};
