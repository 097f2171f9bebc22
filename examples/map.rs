//! An overturning map in a caller's own program, with its own progress display. Run with
//! `cargo run --release --example map`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "an example prints its results"
)]

use std::ops::ControlFlow;

use archrock::{Ending, NoHistory, Outcome, OverturningMap, Runner, Scenario};

const SCENARIO: &str = r#"
[arch]
mean_radius_m = 5.0
thickness_ratio = 0.15
embrace_deg = 180.0

[ground.one_cosine]
amplitude_g = 0.5
duration_s = 0.8

[map]
duration_s = { from = 0.2, to = 1.6, count = 36 }
amplitude_g = { from = 0.15, to = 2.4, count = 18, spacing = "logarithmic" }
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = Scenario::parse(SCENARIO, "the scenario of the example")?;
    let map = OverturningMap::of(&scenario)?;
    // Uses all processors; a break would end the work.
    let cells = Runner::default().rows(&map, |progress| {
        eprintln!("{} of {} cells", progress.done, progress.all);
        ControlFlow::Continue(())
    })?;
    // Cells go along y first; the strongest pulses come on top.
    let [_, amplitudes_g] = &map.values;
    for (row, amplitude_g) in amplitudes_g.iter().enumerate().rev() {
        let symbols = cells[row..].iter().step_by(amplitudes_g.len());
        let symbols: String = symbols.map(|cell| symbol(&cell.result)).collect();
        println!("{amplitude_g:6.3} g  {symbols}");
    }
    println!("# overturns without impact, + after impacts, . comes to rest");
    Ok(())
}

fn symbol(result: &Result<Ending, NoHistory>) -> char {
    match result {
        Ok(ending) => match (ending.outcome, ending.impacts) {
            (Outcome::Overturned(_), Some(0)) => '#',
            (Outcome::Overturned(_), _) => '+',
            (Outcome::NeverMoved, _) => ' ',
            _ => '.',
        },
        Err(_) => '?',
    }
}
