//! A column on a ground motion that is given as an array. Run with
//! `cargo run --release --example own_ground_motion`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example prints its results"
)]
#![allow(
    clippy::disallowed_methods,
    reason = "digits of an example may depend on the machine"
)]

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use archrock::{Column, GroundMotion, ImpactModel, Model, Request, RockingColumn, Sample};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Twelve seconds of a 1 Hz wave that swells and fades, 100 samples a second, in m/s2.
    let step_s = 0.01;
    let samples: Vec<(f64, f64)> = (0..1200)
        .map(|index| {
            let time_s = f64::from(index) * step_s;
            (
                time_s,
                4.0 * (TAU * time_s / 24.0).sin() * (TAU * time_s).sin(),
            )
        })
        .collect();
    // Horizontal samples, no vertical ones, from time zero on.
    let ground = GroundMotion::record(&samples, &[], 0.0)?;

    let column = Column::new(4.0, 0.8)?;
    let model = RockingColumn::new(&column, ImpactModel::MaxRestitution)?;
    let request = Request {
        end_s: 30.0,
        ..Request::default()
    };
    // Samples can be used during the computation without storing any, and the history can be ended at any time.
    let mut largest_rad = 0.0_f64;
    let mut watch = |sample: &Sample| {
        largest_rad = largest_rad.max(sample.rotations_rad[0].abs());
        ControlFlow::Continue(())
    };
    let summary = model.simulate(&ground, &request, Some(&mut watch))?;
    println!(
        "{} at {:.3} s after {} impacts; largest sampled rotation {largest_rad:.4} rad",
        summary.outcome.name(),
        summary.outcome_time_s,
        summary.impacts,
    );
    Ok(())
}
