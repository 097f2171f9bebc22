//! Motions: engines and histories, against closed forms and other programs.

mod back_wall;
mod back_wall_elastic;
mod between_impacts;
mod column;
mod elastic_joints;
mod energy_balance;
mod equivalent_block;
mod free_hinges;
mod ground;
mod history;
mod initial_rate;
mod integration;
mod landings;
mod loads;
mod model;
mod outcomes;
mod random_histories;
mod rest;
mod sliding;
mod sliding_impacts;
mod spread;
mod ties;
mod two_feet;
mod two_feet_rigid;
mod validation;
mod vertical;
