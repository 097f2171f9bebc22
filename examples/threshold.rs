//! The pulses that overturn a column, by four links and by free hinges. Run with
//! `cargo run --release --example threshold`.

#![allow(clippy::print_stdout, reason = "an example prints its results")]

use std::ops::ControlFlow;

use archrock::{
    Column, Directions, Factors, FreeHinges, ImpactModel, Model, Pulse, Request, RockingColumn,
    Runner, threshold,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let column = Column::new(4.0, 0.8)?;
    let rocking = RockingColumn::new(&column, ImpactModel::MaxRestitution)?;
    let drums = FreeHinges::of_column(&column.with_drums(4)?)?;
    let models: [(&str, &dyn Model); 2] = [("one block", &rocking), ("four drums", &drums)];
    let ground = Pulse::OneSine.lasting_s(0.5).horizontal_m_s2(0.2 * 9.81)?;
    // From the pulse itself to twenty times as strong, in strides of 5 %.
    let (factors, request) = (Factors::new(1.0, 20.0, 0.05)?, Request::default());
    let go_on = |_| ControlFlow::Continue(());
    for model in models {
        let found = threshold(
            model,
            (Directions::Both, &ground),
            &request,
            &factors,
            &Runner::default(),
            go_on,
        )?;
        for band in found.bands() {
            println!(
                "{} overturns from {:.4} to {:.4} g",
                found.model,
                0.2 * band.from,
                0.2 * band.to
            );
        }
    }
    Ok(())
}
