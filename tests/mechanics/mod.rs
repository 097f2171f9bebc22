//! Mechanics without time: impacts, limit loads, joints, ties and shapes.

mod certificate;
mod elastic_joint;
mod four_link_rows;
mod held_top;
mod impact;
mod impulse_line;
mod live_loads;
mod rows;
mod shapes;
pub mod spread;
mod thrust_line;
mod ties;
