//! Reports impacts in words.

use std::fmt::Write as _;

use super::LinkImpact;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_link::certificate::Projection;
use crate::mechanics::four_link::impact::{Impact, ImpactModel};
use crate::mechanics::four_link::mechanism::HingeSites;
use crate::mechanics::four_link::resultant::{Extremes, Extremum};
use crate::mechanics::four_links::FourLinks;
use crate::mechanics::geometry::profile::Profile;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;
use crate::output::mechanisms::{HINGES, degrees};
use crate::scenario::Scenario;

/// The chain of mechanisms of any structure.
pub(super) fn chain_text(
    scenario: &Scenario,
    model: &dyn MechanismModel,
    first: Sway,
    count: usize,
) -> String {
    let mut text = format!(
        "impacts after a first sway to the {}, model {}{} (r = kinetic energy after / before",
        first.name(),
        scenario.motion().impact().model.name(),
        match scenario.motion().impact().restitution_factor {
            1.0 => String::new(),
            factor => format!(" times {factor:?}"),
        },
    );
    let hinges = model.hinges_after(0, first);
    let of_arch = hinges.len() == 4;
    text += match hinges.first() {
        Some(Hinge::Section { .. }) => {
            ";\nangles in degrees from the left springing; I intrados, E extrados"
        }
        Some(Hinge::Joint { .. }) => {
            ";\njoints from the left, 0 at the left base or springing; I intrados, E extrados"
        }
        _ => "",
    };
    text += ")\n\nimpact         r  sway   ";
    let names: &[&str] = if of_arch { &HINGES } else { &["turns about"] };
    for name in names {
        let _ = write!(text, "{name:>12}");
    }
    text.push('\n');
    for index in 0..=count {
        let Some(restitution) = model.restitution_from(first, index) else {
            let _ = writeln!(
                text,
                "{index:>6}  no mechanism can follow: the structure stops"
            );
            break;
        };
        let restitution = match index {
            0 => String::new(),
            _ => format!("{restitution:.6}"),
        };
        let sway = first.before(index);
        let _ = write!(text, "{index:>6}  {restitution:>8}  {:5}  ", sway.name());
        for hinge in model.hinges_after(index, sway) {
            text += &hinge_text(hinge);
        }
        text.push('\n');
    }
    text
}

/// A hinge in a column of a table.
fn hinge_text(hinge: Hinge) -> String {
    match hinge {
        Hinge::Section { angle_rad, edge } => {
            format!("{:>10.5} {}", degrees(angle_rad), initial(edge))
        }
        Hinge::Toe(side) => format!("{:>12}", format!("{} toe", side.name())),
        Hinge::Joint { joint, edge } => {
            let edge = edge.map_or("", initial);
            format!("{:>12}", format!("joint {joint} {edge}"))
        }
    }
}

/// Words for the sections of a structure.
struct Words {
    /// The structure.
    whole: &'static str,
    /// A section, in the head of a column.
    section: &'static str,
    /// The place of an extreme.
    place: &'static str,
}

impl Words {
    fn of(profile: &dyn Profile) -> Self {
        match profile.joint(0.0) {
            Some(_) => Self {
                whole: "row",
                section: "joint",
                place: "its joint",
            },
            None => Self {
                whole: "ring",
                section: "section",
                place: "its section in degrees",
            },
        }
    }
}

/// A section as in tables: its angle in degrees, or the number of its joint.
fn section_text(profile: &dyn Profile, section: f64) -> String {
    match profile.joint(section) {
        Some(joint) => joint.to_string(),
        None => format!("{:.3}", degrees(section)),
    }
}

/// The place of a section, in a sentence.
fn place_text(near: &str, profile: &dyn Profile, section: f64) -> String {
    match profile.joint(section) {
        Some(joint) => format!("at joint {joint}"),
        None => format!("{near} {:.2} deg", degrees(section)),
    }
}

fn initial(edge: Edge) -> &'static str {
    match edge {
        Edge::Intrados => "I",
        Edge::Extrados => "E",
    }
}

pub(super) fn impulses_text(model: &FourLinks, first: Sway, count: usize) -> String {
    let unit = model.impulse_unit_n_s_per_m();
    let lines = || {
        (1..=count).map_while(|index| {
            let impact = LinkImpact {
                model,
                first,
                index,
            };
            Some((impact, impact.line()?))
        })
    };
    if lines().next().is_none() {
        return String::new();
    }
    let mut text =
        "\nimpulses at these hinges on the part towards the crown, x to the right and y up,\n\
                    in N s per metre of depth for a closing rate of 1 rad/s\n\nimpact"
            .to_owned();
    for hinge in ["A", "B", "C", "D"] {
        for component in ["x", "y"] {
            let _ = write!(text, "{:>11}", format!("{hinge} {component}"));
        }
    }
    text.push('\n');
    for (impact, line) in lines() {
        let _ = write!(text, "{:>6}", impact.index);
        for impulse in line.hinge_impulses_from_left(impact.sway()) {
            let _ = write!(
                text,
                "{:>11.5e}{:>11.5e}",
                impulse.x * unit,
                impulse.y * unit
            );
        }
        text.push('\n');
    }
    let profile = model.chain_from(first).profile(0);
    let Words { section, place, .. } = Words::of(profile);
    let _ = writeln!(
        text,
        "\nimpulse line: eccentricity e (0.5 t is the edge), smallest normal impulse N in the same unit,\n\
         largest ratio of tangential impulse T to N, each with {place}\n\n\
         impact      |e|/t   {section:>7}        min N   {section:>7}      |T|/N   {section:>7}"
    );
    let at = |extremum: Extremum| section_text(profile, extremum.angle_rad);
    for (impact, line) in lines() {
        let extremes = line.extremes_from_left(impact.chain().sites, impact.sway());
        // Both are infinite if there is tension.
        let ratio = |extremum: Extremum| match extremum.value {
            value if value.is_finite() => format!("{value:>9.5}"),
            _ => format!("{:>9}", "-"),
        };
        let _ = writeln!(
            text,
            "{:>6}  {}  {:>8}  {:>11.5e}  {:>8}  {}  {:>8}  {}",
            impact.index,
            ratio(extremes.eccentricity_ratio),
            at(extremes.eccentricity_ratio),
            extremes.normal.value * unit,
            at(extremes.normal),
            ratio(extremes.friction_ratio),
            at(extremes.friction_ratio),
            verdict(&extremes, profile),
        );
    }
    text
}

fn verdict(extremes: &Extremes, profile: &dyn Profile) -> String {
    if extremes.is_admissible() {
        "admissible".to_owned()
    } else if extremes.normal.value <= 0.0 {
        "in tension".to_owned()
    } else {
        format!("leaves the {}", Words::of(profile).whole)
    }
}

pub(super) fn models_text(
    asked: &LinkImpact<'_>,
    models: &[(ImpactModel, Option<Impact>)],
) -> String {
    let mut text = format!(
        "\nimpact models compared, impact {}{}\n\n\
         model                    r   {:>12}{:>12}{:>12}{:>12}   impulse line\n",
        asked.index,
        asked.after_first(),
        "A",
        "B",
        "C",
        "D"
    );
    let (profile, sway) = (asked.profile(), asked.sway());
    for (model, impact) in models {
        let _ = write!(text, "{:<16}", model.name());
        let Some(impact) = impact else {
            text += "  no mechanism can follow\n";
            continue;
        };
        let sites = asked.chain().sites;
        let line = impact.impulse_line.as_ref();
        let line = line.map_or_else(
            || "none".to_owned(),
            |line| verdict(&line.extremes_from_left(sites, sway), profile),
        );
        let hinges = impact.mechanism.named_hinges_from_left(profile, sway);
        let _ = writeln!(
            text,
            "{:>10.6}   {}   {line}",
            impact.restitution,
            hinges.map(hinge_text).concat()
        );
    }
    text
}

pub(super) fn certificate_text(
    scenario: &Scenario,
    asked: &LinkImpact<'_>,
    projection: &Projection,
) -> String {
    let four_link = asked.after().map_or(0.0, |link| link.link.restitution);
    let gap = projection.restitution - four_link;
    let (profile, sway) = (asked.profile(), asked.sway());
    let whole = Words::of(profile).whole;
    let mut text = format!(
        "\ncertificate of impact {}{}: largest restitution of any motion that opens joints and closes none\n\
         (any number of hinges; {} joints)\n\n\
         r, four hinges, model {:<16} {four_link:>12.8}\n\
         r, any number of hinges                {:>12.8}\n\
         gap                                    {gap:>12.8}\n\n",
        asked.index,
        asked.after_first(),
        projection.joints.len(),
        scenario.motion().impact().model.name(),
        projection.restitution,
    );
    if let Some(line) = asked.line() {
        let extremes = line.extremes_from_left(asked.chain().sites, sway);
        let eccentricity = extremes.eccentricity_ratio;
        let _ = if extremes.is_admissible() {
            writeln!(
                text,
                "The impulse line of the four hinges is compressive and inside the {whole}: no admissible motion\n\
                 keeps more energy, so the four hinges are certified."
            )
        } else if extremes.normal.value <= 0.0 {
            writeln!(
                text,
                "The impulse line of the four hinges is in tension {}: more hinges keep more energy.",
                place_text("near", profile, extremes.normal.angle_rad)
            )
        } else {
            writeln!(
                text,
                "The impulse line of the four hinges leaves the {whole} by {:.2} % of the thickness {}: \
                 other\nhinges keep more energy, {}.",
                100.0 * (eccentricity.value - 0.5),
                place_text("at", profile, eccentricity.angle_rad),
                if gap > 1e-6 {
                    "by the gap above"
                } else {
                    "but these joints are too few to show it"
                }
            )
        };
    }
    if gap < -1e-6 {
        let _ = writeln!(
            text,
            "Model {} keeps more energy than any admissible motion can.",
            scenario.motion().impact().model.name()
        );
    }
    if projection.opened().next().is_none() {
        text += "No motion keeps any energy: the impact stops the arch.\n";
        return text;
    }
    text += match profile.joint(0.0) {
        Some(_) => "The motion that keeps the most energy opens at joints, counted from the left\n",
        None => {
            "The motion that keeps the most energy opens at, in degrees from the left springing\n"
        }
    };
    for zone in zones(asked, projection) {
        let mut place = section_text(profile, zone.from);
        if zone.from != zone.to {
            place += &format!(" to {}", section_text(profile, zone.to));
        }
        let _ = writeln!(
            text,
            "  {place:>20}  {}  by {:.5} rad per rad of closing",
            initial(zone.edge),
            zone.rate
        );
    }
    text
}

/// Neighbouring joints of a continuous ring that open about the same edge, or one joint.
struct Zone {
    edge: Edge,
    from: f64,
    to: f64,
    /// Sum of their rotation rates.
    rate: f64,
    /// The last of these joints.
    joint: usize,
}

/// The zones that open, in order from the left springing.
fn zones(asked: &LinkImpact<'_>, projection: &Projection) -> Vec<Zone> {
    let mut zones: Vec<Zone> = Vec::new();
    for (joint, edge, rate) in projection.opened() {
        let section = projection.joints[joint].angle_rad;
        let section = asked.sway().from_left(asked.profile(), section);
        let continues = |zone: &&mut Zone| {
            asked.chain().sites == HingeSites::Anywhere
                && zone.edge == edge
                && zone.joint + 1 == joint
        };
        match zones.iter_mut().find(continues) {
            Some(zone) => {
                zone.from = zone.from.min(section);
                zone.to = zone.to.max(section);
                zone.rate += rate;
                zone.joint = joint;
            }
            None => zones.push(Zone {
                edge,
                from: section,
                to: section,
                rate,
                joint,
            }),
        }
    }
    zones.sort_by(|a, b| a.from.total_cmp(&b.from));
    zones
}
