//! The commands `limit` and `check`, and what commands share.

use std::fmt::Write as _;
use std::path::Path;

use archrock::mechanics::arch::Arch;
use archrock::mechanics::chain::Chain;
use archrock::mechanics::mechanism::{FourLink, Sway};
use archrock::mechanics::ring::Ring;
use archrock::mechanics::structure::Mechanism;
use archrock::output::{mechanisms, pictures};
use archrock::scenario::{Scenario, Structure};

use super::{Failure, Format, print};

/// The arch of a scenario.
pub fn arch(scenario: &Scenario) -> Result<Arch, Failure> {
    let Structure::Arch(arch) = &scenario.structure;
    arch.build(scenario.impact)
        .map_err(|error| Failure::Input(error.to_string()))
}

pub fn check(path: &Path) -> Result<(), Failure> {
    print(&Scenario::read(path)?.to_toml())
}

pub fn limit(path: &Path, format: Format, plot: Option<&Path>) -> Result<(), Failure> {
    let scenario = Scenario::read(path)?;
    let arch = arch(&scenario)?;
    if let Some(plot) = plot {
        write_picture(plot, &pictures::limit(&arch.chain))?;
    }
    match format {
        Format::Json => print(&pretty(&mechanisms::limit(&arch.chain))),
        Format::Text => print(&limit_text(&scenario, &arch.chain)),
    }
}

/// Writes a picture to a file.
pub fn write_picture(path: &Path, picture: &str) -> Result<(), Failure> {
    std::fs::write(path, picture)
        .map_err(|error| Failure::Work(format!("cannot write {}: {error}", path.display())))
}

/// JSON for people to read as well.
pub fn pretty(value: &serde_json::Value) -> String {
    format!("{value:#}\n")
}

fn limit_text(scenario: &Scenario, chain: &Chain) -> String {
    let incipient = chain.incipient();
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    let mut text = format!(
        "incipient rocking acceleration A_L, either side: {:.8} g = {:.6} m/s2\n",
        incipient.acceleration_g,
        incipient.acceleration_g * gravity_m_s2,
    );
    for sway in [Sway::Right, Sway::Left] {
        let _ = write!(
            text,
            "\na push to the {} starts the mechanism with hinges at\n",
            sway.name()
        );
        text += &hinge_table(&incipient.mechanism, chain.ring(), sway);
    }
    if let Some(first) = chain.link(0) {
        let rotations = first.link.mechanism.rotations(first.link.critical_rad);
        let _ = write!(
            text,
            "\nswaying right it is past saving, under gravity alone, beyond rotations of\n  \
             left {:.6}, middle {:.6}, right {:.6} rad (anticlockwise)\n",
            rotations[0], rotations[1], rotations[2],
        );
    }
    text
}

fn hinge_table(mechanism: &FourLink, ring: &Ring, sway: Sway) -> String {
    let mut text = String::new();
    let hinges = mechanism.hinges_from_left(ring, sway);
    for (name, (angle_rad, edge)) in ["A", "B", "C", "D"].into_iter().zip(hinges) {
        let degrees = degrees(angle_rad);
        let _ = writeln!(
            text,
            "  {name}  {degrees:10.5} deg from the left springing, {}",
            edge.name()
        );
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
