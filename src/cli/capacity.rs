//! The command `capacity`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use archrock::mechanics::capacity::Capacity;
use archrock::output::capacity as output;
use archrock::output::pretty;
use archrock::studies::capacity::{capacity as capacities, grouping};
use nalgebra::Vector2;

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::study::say;
use super::{Failure, Format, print};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Control point in metres, such as `--point 0,5.4` [default: the crown].
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    point: Option<Vector2<f64>>,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

const PICTURE: &str = "capacity.svg";
const TABLE: &str = "capacity.csv";
/// Written last: a folder that has it is complete.
const SUMMARY: &str = "capacity.json";

fn point(text: &str) -> Result<Vector2<f64>, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.trim().parse().ok())
        .filter(|number: &f64| number.is_finite())
        .collect();
    match numbers[..] {
        [x, y] if text.matches(',').count() == 1 => Ok(Vector2::new(x, y)),
        _ => Err("give two numbers in metres with a comma between them, such as 0,5.4".to_owned()),
    }
}

pub fn capacity(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.read(None)?;
    let sides = capacities(&scenario, arguments.point)
        .map_err(|error| Failure::Input(error.to_string()))?;
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    let place = input.results(arguments.out.as_deref())?;
    let mut folder = place.open(&[PICTURE, TABLE, SUMMARY])?;
    let title = scenario.title.as_deref().unwrap_or("Capacity");
    let mut json = output::to_json(&sides, gravity_m_s2);
    let masses = grouping(&scenario.structure);
    json["masses"] = masses.clone().into();
    json["scenario"] = scenario.to_json();
    let json = pretty(&json);
    output::write_table(folder.file(TABLE), &sides)?;
    for (name, text) in [
        (
            PICTURE,
            &output::draw(arguments.figure.get(), title, &sides),
        ),
        (SUMMARY, &json),
    ] {
        folder
            .file(name)
            .write_all(text.as_bytes())
            .map_err(|error| Failure::Work(format!("cannot write {name}: {error}")))?;
    }
    let path = folder.path().to_owned();
    folder.complete()?;
    if !quiet {
        say(&format!(
            "results in {}: {PICTURE}, {TABLE}, {SUMMARY}",
            path.display()
        ));
    }
    match arguments.format {
        Format::Json => print(&json),
        Format::Text => print(&words(&sides, &masses, gravity_m_s2)),
    }
}

fn words(sides: &[Capacity; 2], masses: &str, gravity_m_s2: f64) -> String {
    // A middle that rounding has moved is still the middle.
    let control = sides[0]
        .control
        .at_m
        .map(|x| if x.abs() < 5e-5 { 0.0 } else { x });
    let mut text = format!(
        "quasi-static capacity of the first mechanism, control point at x {:.4} m, y {:.4} m\n\
         masses at the centres of {masses}; `archrock verify` takes the rigid bodies of the mechanism\n",
        control.x, control.y
    );
    for side in sides {
        let (start, end) = (side.start(), side.end());
        let _ = write!(
            text,
            "\nto the {}\n  a(0) = A_L                     {:>12.6} g\n  ultimate displacement          {:>12.6} m\n  \
             participating mass M*          {:>12.1} kg, fraction e* {:.4}\n  \
             equivalent oscillator a0*      {:>12.6} g\n  \
             equivalent oscillator d0*      {:>12.6} m\n  secant periods at",
            side.sway.name(),
            start.acceleration_g,
            end.displacement_m,
            side.participating_mass_kg,
            side.mass_fraction,
            start.oscillator_acceleration_g,
            end.oscillator_displacement_m,
        );
        for part in output::PARTS {
            let period_s = side
                .secant_period_s(part, gravity_m_s2)
                .unwrap_or(f64::INFINITY);
            let _ = write!(text, "  {part} d0*: {period_s:.4} s");
        }
        text.push('\n');
    }
    text
}
