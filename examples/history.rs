//! The time history of an arch, as numbers. Run with `cargo run --release --example history`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example prints its results"
)]

use archrock::{Arch, FourLinks, ImpactModel, Model, Pulse, Request};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A semicircle of 5 m mean radius, 0.75 m thick, whose hinges may open anywhere.
    let arch = Arch::new(5.0, 0.15, 180.0)?;
    println!("A_L = {:.6} g", arch.incipient()?.acceleration_g);

    // The ground jerks to the left for 0.2 s, which pushes the arch to the right.
    let ground = Pulse::Rectangular
        .lasting_s(0.20)
        .horizontal_m_s2(-0.30 * 9.81)?;
    let model = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution)?;
    let history = model.history(&ground, &Request::default())?;

    for (time_s, impact) in history.impacts().take(5) {
        println!("impact at {time_s:.4} s, r = {:.4}", impact.restitution);
    }
    // One row per body and sample, as a caller's own plot would take them.
    let bodies = history.bodies.len();
    let rotations_rad = history.samples.rotations_rad.chunks(bodies);
    for (time_s, rotations_rad) in history.samples.time_s.iter().zip(rotations_rad).step_by(50) {
        println!("{time_s:6.3} s  {rotations_rad:9.6?} rad");
    }
    println!("{:?}", history.summary);
    Ok(())
}
