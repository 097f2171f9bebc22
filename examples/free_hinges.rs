//! An arch with free hinges: any joint opens and closes. Run with `cargo run --release --example free_hinges`.

#![allow(clippy::print_stdout, reason = "an example prints its results")]

use archrock::{Arch, FreeHinges, Model, Pulse, Request};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arch = Arch::new(5.0, 0.15, 180.0)?.with_voussoirs(36)?;
    let model = FreeHinges::of_arch(&arch)?;
    let ground = Pulse::Rectangular
        .lasting_s(0.20)
        .horizontal_m_s2(-0.25 * 9.81)?;
    let own = model.simulate(&ground, &Request::default(), None)?;
    println!(
        "{:?} at {:.3} s, peak {:.4} rad",
        own.outcome,
        own.outcome_time_s,
        own.largest_rotation_rad()
    );
    // If repetitions with other steps disagree, the outcome is uncertain.
    for other in model.repetitions() {
        let summary = other.model.simulate(&ground, &Request::default(), None)?;
        println!(
            "{}: {:?}, peak {:.4} rad",
            other.name,
            summary.outcome,
            summary.largest_rotation_rad()
        );
    }
    Ok(())
}
