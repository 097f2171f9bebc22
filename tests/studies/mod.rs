//! Studies: their results, compared with single histories, parts with the whole, and published numbers.

mod capacity;
mod elastic_joints;
mod fragility;
mod free_hinges;
mod impact;
mod limit;
mod map;
mod map_accuracy;
mod map_axes;
mod outside_model;
mod peaks;
mod repeatability;
mod run_column;
mod run_drawing_data;
mod run_elastic_joints;
mod run_free_hinges;
mod run_outputs;
mod run_points;
mod runner;
mod suite;
mod survival;
mod threshold;
pub mod threshold_along;
mod uncertain;
mod verify;
mod verify_formulas;
mod verify_histories;
