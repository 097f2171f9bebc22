//! The commands `limit` and `check`, and what commands share.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use archrock::mechanics::arch;
use archrock::mechanics::equivalent::{Block, equivalent};
use archrock::mechanics::four_link::mechanism::Sway;
use archrock::mechanics::structure::{Hinge, Mechanism, Structure as Rocks};
use archrock::output::{mechanisms, pictures};
use archrock::scenario::{Arch, Scenario, Structure};

use super::{Failure, Format, print};

/// The arch of a scenario.
pub fn build(arch: &Arch, scenario: &Scenario) -> Result<arch::Arch, Failure> {
    arch.build(scenario.impact)
        .map_err(|error| Failure::Input(error.to_string()))
}

pub fn check(path: &Path) -> Result<(), Failure> {
    print(&Scenario::read(path)?.to_toml())
}

pub fn limit(path: &Path, format: Format, plot: Option<&Path>) -> Result<(), Failure> {
    let scenario = Scenario::read(path)?;
    match &scenario.structure {
        Structure::Arch(arch) => {
            let arch = build(arch, &scenario)?;
            if let Some(plot) = plot {
                write_picture(plot, &pictures::limit(&arch.chain))?;
            }
            print_limit(&scenario, &arch, format)
        }
        Structure::Column(column) => {
            refuse_picture(plot)?;
            print_limit(&scenario, &column.build(scenario.impact), format)
        }
    }
}

/// The arch of a scenario, for what `does` with arches only.
pub fn arch(scenario: &Scenario, does: &str) -> Result<arch::Arch, Failure> {
    match &scenario.structure {
        Structure::Arch(arch) => build(arch, scenario),
        Structure::Column(_) => Err(Failure::Input(format!(
            "{does} arches only, and this is a column"
        ))),
    }
}

/// Pictures of mechanisms are of arches.
fn refuse_picture(plot: Option<&Path>) -> Result<(), Failure> {
    plot.map_or(Ok(()), |_| {
        let message = "--plot draws arches only, and this is a column: leave it out";
        Err(Failure::Input(message.to_owned()))
    })
}

fn print_limit<S: Rocks>(
    scenario: &Scenario,
    structure: &S,
    format: Format,
) -> Result<(), Failure> {
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    match format {
        Format::Json => print(&pretty(&mechanisms::limit(structure, gravity_m_s2))),
        Format::Text => print(&limit_text(structure, gravity_m_s2)),
    }
}

/// Writes a picture to the file named by `--plot`.
pub fn write_picture(path: &Path, picture: &str) -> Result<(), Failure> {
    let cannot = |error: io::Error| format!("cannot write {}: {error}", path.display());
    let mut file = File::create(path).map_err(|error| {
        Failure::Input(format!(
            "{}; choose another file with --plot",
            cannot(error)
        ))
    })?;
    file.write_all(picture.as_bytes())
        .map_err(|error| Failure::Work(cannot(error)))
}

/// JSON for people to read as well.
pub fn pretty(value: &serde_json::Value) -> String {
    format!("{value:#}\n")
}

/// Values of the bodies with their names, from left to right.
pub fn by_body<M: Mechanism>(values: &M::Rotations) -> String {
    let named = M::BODIES.iter().zip(values.as_ref());
    let texts: Vec<_> = named
        .map(|(body, value)| format!("{body} {value:.6}").trim_start().to_owned())
        .collect();
    texts.join(", ")
}

fn limit_text<S: Rocks>(structure: &S, gravity_m_s2: f64) -> String {
    let incipient_g = structure.incipient_g();
    let mut text = format!(
        "incipient rocking acceleration A_L, either side: {incipient_g:.8} g = {:.6} m/s2\n",
        incipient_g * gravity_m_s2,
    );
    for sway in [Sway::Right, Sway::Left] {
        let hinges = structure.hinges(0, sway);
        let _ = write!(
            text,
            "\na push to the {} starts the mechanism with {} at\n",
            sway.name(),
            if hinges.len() == 1 {
                "its hinge"
            } else {
                "hinges"
            },
        );
        text += &hinge_list(&hinges);
    }
    if let Some(first) = structure.link(0) {
        let rotations = first.mechanism.rotations(first.critical_rad);
        let _ = write!(
            text,
            "\nswaying right it is past saving, under gravity alone, beyond a rotation of\n  \
             {} rad (anticlockwise)\n",
            by_body::<S::Mechanism>(&rotations),
        );
    }
    if let Some(blocks) = equivalent(structure, gravity_m_s2) {
        let _ = writeln!(
            text,
            "\nthe free-standing block of the same A_L, slenderness alpha {:.6} rad, that moves alike",
            blocks.slenderness_rad,
        );
        for (where_to, block) in [
            ("from rest", blocks.at_rest),
            ("past saving", blocks.at_critical),
        ] {
            if let Some(Block {
                frequency_rad_s,
                half_diagonal_m,
            }) = block
            {
                let _ = writeln!(
                    text,
                    "  {where_to:11}  p {frequency_rad_s:.6} rad/s, half diagonal {half_diagonal_m:.6} m",
                );
            }
        }
    }
    text
}

/// Names of the hinges of an arch, from left to right.
pub const HINGES: [&str; 4] = ["A", "B", "C", "D"];

fn hinge_list(hinges: &[Hinge]) -> String {
    let mut text = String::new();
    for (name, hinge) in HINGES.iter().zip(hinges) {
        let _ = match hinge {
            Hinge::Section { angle_rad, edge } => writeln!(
                text,
                "  {name}  {:10.5} deg from the left springing, {}",
                degrees(*angle_rad),
                edge.name()
            ),
            Hinge::Toe(side) => writeln!(text, "  the {} toe", side.name()),
        };
    }
    text
}

/// Degrees, with rounding errors at the left springing removed.
pub fn degrees(angle_rad: f64) -> f64 {
    if angle_rad < 1e-12 {
        0.0
    } else {
        angle_rad.to_degrees()
    }
}
