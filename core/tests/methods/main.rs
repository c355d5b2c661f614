//! Methods and estimators against plain references, exact truth and recorded results of others.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/crossing.rs"]
mod crossing;
#[path = "../common/rough.rs"]
mod rough;

mod active_contour;
mod background;
mod bounds;
mod chan_vese;
mod correspondence;
mod costs;
mod detection;
mod farneback;
mod features;
mod full_search;
mod hard_scenes;
mod hierarchical;
mod histogram;
mod horn_schunck;
mod hypotheses;
mod interest_points;
mod kalman;
mod kalman_filter;
mod kalman_tracker;
mod klt;
mod levels;
mod linear_systems;
mod lockstep;
mod lucas_kanade;
mod models_plain;
mod motion_segmentation;
mod moving_camera;
mod nonlinear_motion;
mod optical_flow;
mod pattern_searches;
mod point_trajectories;
mod quality;
mod rapid;
mod region_tracking;
mod registration;
mod repeatability;
mod scene_flow;
mod scores;
mod sift_plain;
mod stereo;
mod subpixel;
mod template_matching;
mod template_tracker;
mod timeline;
mod tracking;
mod trajectories;
mod variational;
