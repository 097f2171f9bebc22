//! The report of impacts: the chain, its impulses and their certificate as a summary, from which the words follow, and the impulse line as a
//! table.
//!
//! Impulses are per metre of depth, for a closing rate of 1 rad/s of the mechanism before the impact.

use std::borrow::Cow;

use askama::Template;
use serde::{Deserialize, Serialize};

use super::LinkImpact;
use crate::argument::format_fixed;
use crate::mechanics::four_link::{HingeSites, Impact, ImpulseLine, Projection};
use crate::mechanics::{Edge, Profile};
use crate::output::mechanisms::{HINGES, degrees};
use crate::output::{Cell, OutputError, Table, column, filters};
use crate::scenario::Varied;
use crate::studies::report::{Report, Warnings};
use crate::{Hinge, ImpactModel, MechanismModel, Scenario, Sway};

/// Impacts of the structure of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Template)]
#[template(path = "studies/impact/words.txt")]
pub struct ImpactSummary {
    /// Impacts after a first sway to the right; of a symmetric structure, after a first sway to the chosen side.
    pub impacts: Vec<ChainImpact>,
    /// Impacts after a first sway to the left; absent unless the structure is an arch of four links that is not symmetric.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impacts_after_left: Option<Vec<ChainImpact>>,
    /// One impact by all impact models; absent unless requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub models: Option<Vec<ModelComparison>>,
    /// The largest restitution of all admissible motions; absent unless requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificate>,
    /// The warnings.
    #[serde(flatten)]
    pub warnings: Warnings,
    /// The mechanism before the first impact of each chain.
    pub starts: Vec<SwayingMechanism>,
    /// The requested number of impacts.
    pub count: usize,
    /// The impact of `models` and `certificate`, in words; absent unless the structure moves as four links.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<String>,
    /// Name of the impact model of the scenario; `back_wall` for impacts on the wall behind a column.
    pub model: Cow<'static, str>,
    /// Factor of the scenario on restitution coefficients.
    pub restitution_factor: f64,
}

/// An impact of a chain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainImpact {
    /// Number of the impact, from 1.
    pub index: usize,
    /// Kinetic energy after the impact over that before.
    pub restitution: f64,
    /// The mechanism before the impact.
    pub before: SwayingMechanism,
    /// The mechanism after the impact.
    pub after: SwayingMechanism,
    /// Impulses; absent unless the structure moves as four links.
    #[serde(flatten)]
    pub impulses: Option<Impulses>,
}

/// The impulses of an impact; null without an impulse line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impulses {
    /// The impulse at each hinge, on the part towards the crown.
    pub impulses: Option<Vec<HingeImpulse>>,
    /// Extremes of the impulse line.
    pub impulse_line: Option<LineExtremes>,
}

/// A mechanism, given by its sway and hinges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwayingMechanism {
    /// The side to which the mechanism sways.
    pub sway: Sway,
    /// Hinges of the mechanism from left to right.
    pub hinges: Vec<Hinge>,
}

/// The impulse at a hinge, per metre of depth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HingeImpulse {
    /// The hinge, from `a` on the left.
    pub hinge: char,
    /// Horizontal impulse, to the right, in N s per metre.
    pub x_n_s_per_m: f64,
    /// Vertical impulse, upwards, in N s per metre.
    pub y_n_s_per_m: f64,
}

/// The position of a section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionPosition {
    /// Joint of a row, counted from the left; absent for a ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<usize>,
    /// Angle of a ring from the left, in degrees; absent for a row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
}

/// Extremes of an impulse line. Infinite values, which mean tension, are null.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LineExtremes {
    /// True if the line is compressive and stays inside the structure.
    pub admissible: bool,
    /// The largest eccentricity over the thickness: 0.5 at the edges.
    pub largest_eccentricity_ratio: Option<f64>,
    /// The joint of a row with the largest eccentricity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_eccentricity_joint: Option<usize>,
    /// The angle of a ring at the largest eccentricity, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_eccentricity_angle_deg: Option<f64>,
    /// The least normal impulse, in N s per metre.
    pub least_normal_n_s_per_m: Option<f64>,
    /// The joint of a row with the least normal impulse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_normal_joint: Option<usize>,
    /// The angle of a ring at the least normal impulse, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_normal_angle_deg: Option<f64>,
    /// The largest ratio of the tangential to the normal impulse.
    pub largest_tangential_ratio: Option<f64>,
    /// The joint of a row with the largest ratio.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_tangential_joint: Option<usize>,
    /// The angle of a ring at the largest ratio, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_tangential_angle_deg: Option<f64>,
}

/// An impact by an impact model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelComparison {
    /// The impact model.
    pub model: Cow<'static, str>,
    /// The impact; null if no mechanism can follow by this model.
    pub impact: Option<ModelImpact>,
}

/// The result of an impact model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelImpact {
    /// Kinetic energy after the impact over that before.
    pub restitution: f64,
    /// The mechanism that follows.
    pub after: SwayingMechanism,
    /// The impulses.
    #[serde(flatten)]
    pub impulses: Impulses,
}

/// The largest restitution of all admissible motions, compared with that of the chain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Number of the impact.
    pub index: usize,
    /// Number of joints that may open.
    pub joints: usize,
    /// Restitution of the four-link mechanism; zero if no mechanism can follow.
    pub restitution_four_link: f64,
    /// The largest restitution of all admissible motions.
    pub restitution_all_fields: f64,
    /// The largest restitution of all admissible motions minus that of the four-link mechanism.
    pub gap: f64,
    /// True if the impulse line of the four-link mechanism is admissible; null without an impulse line.
    pub impulse_line_admissible: Option<bool>,
    /// Joints that open in the motion that keeps the most energy.
    pub opened_joints: Vec<OpenedJoint>,
    /// Extremes of the impulse line of the four-link mechanism; null without an impulse line.
    pub impulse_line: Option<LineExtremes>,
    /// Neighbouring joints that open, from the left springing.
    pub zones: Vec<Zone>,
}

/// A joint that opens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpenedJoint {
    /// Position of the joint.
    #[serde(flatten)]
    pub place: SectionPosition,
    /// The edge about which it opens.
    pub edge: Edge,
    /// Opening rate over the closing rate.
    pub opening_rate_ratio: f64,
}

/// Adjacent joints of a continuous ring that open about the same edge, or one joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Zone {
    /// The edge about which the joints open.
    pub edge: Edge,
    /// The first section of the zone.
    pub from: SectionPosition,
    /// The last section of the zone.
    pub to: SectionPosition,
    /// Sum of the opening rates over the closing rate.
    pub opening_rate_ratio: f64,
}

impl SwayingMechanism {
    fn of(model: &dyn MechanismModel, first: Sway, index: usize) -> Self {
        let sway = model.sway_after(first, index);
        let hinges = model.hinges_after(index, sway);
        Self { sway, hinges }
    }
}

/// Computes the first `count` impacts after a first sway to this side; fewer if an impact stops the structure.
pub fn chain(model: &dyn MechanismModel, first: Sway, count: usize) -> Vec<ChainImpact> {
    let impacts = (1..=count).map_while(|index| {
        Some(ChainImpact {
            index,
            restitution: model.restitution_from(first, index)?,
            before: SwayingMechanism::of(model, first, index - 1),
            after: SwayingMechanism::of(model, first, index),
            impulses: None,
        })
    });
    impacts.collect()
}

/// Computes the first `count` impacts of four links, with their impulses; fewer if an impact stops the structure.
pub(super) fn chain_of_four_links(one: &LinkImpact<'_>, count: usize) -> Vec<ChainImpact> {
    let mut impacts = chain(one.model, one.first, count);
    for (index, impact) in (1..).zip(&mut impacts) {
        let link = LinkImpact { index, ..*one };
        impact.impulses = Some(Impulses::of(&link, link.line()));
    }
    impacts
}

impl Impulses {
    pub(super) fn of(impact: &LinkImpact<'_>, line: Option<&ImpulseLine>) -> Self {
        let unit = impact.model.impulse_unit_n_s_per_m();
        let at_hinges = |line: &ImpulseLine| {
            let impulses = line.hinge_impulses_from_left(impact.sway());
            let names = ['a', 'b', 'c', 'd'].into_iter();
            let hinges = names.zip(impulses).map(|(hinge, impulse)| HingeImpulse {
                hinge,
                x_n_s_per_m: impulse.x * unit,
                y_n_s_per_m: impulse.y * unit,
            });
            hinges.collect()
        };
        Self {
            impulses: line.map(at_hinges),
            impulse_line: line.map(|line| LineExtremes::of(impact, line)),
        }
    }
}

impl SectionPosition {
    fn of(profile: &dyn Profile, section: f64) -> Self {
        let joint = profile.joint(section);
        Self {
            joint,
            angle_deg: joint.is_none().then(|| section.to_degrees()),
        }
    }
}

/// Section for tables: its angle in degrees, or the number of its joint.
fn cell(joint: &Option<usize>, angle_deg: &Option<f64>) -> String {
    match (joint, angle_deg) {
        (Some(joint), _) => joint.to_string(),
        (None, angle_deg) => format_fixed(angle_deg.unwrap_or_default(), 3),
    }
}

impl LineExtremes {
    fn of(impact: &LinkImpact<'_>, line: &ImpulseLine) -> Self {
        let extremes = line.extremes_from_left(impact.chain().sites, impact.sway());
        let at = |section: f64| SectionPosition::of(impact.profile(), section);
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let (eccentricity, normal) = (extremes.eccentricity_ratio, extremes.normal);
        let friction = extremes.friction_ratio;
        let unit = impact.model.impulse_unit_n_s_per_m();
        Self {
            admissible: extremes.is_admissible(),
            largest_eccentricity_ratio: finite(eccentricity.value),
            largest_eccentricity_joint: at(eccentricity.angle_rad).joint,
            largest_eccentricity_angle_deg: at(eccentricity.angle_rad).angle_deg,
            least_normal_n_s_per_m: finite(normal.value * unit),
            least_normal_joint: at(normal.angle_rad).joint,
            least_normal_angle_deg: at(normal.angle_rad).angle_deg,
            largest_tangential_ratio: finite(friction.value),
            largest_tangential_joint: at(friction.angle_rad).joint,
            largest_tangential_angle_deg: at(friction.angle_rad).angle_deg,
        }
    }

    /// True if a normal impulse is not compressive.
    fn is_in_tension(&self) -> bool {
        self.least_normal_n_s_per_m.is_none_or(|least| least <= 0.0)
    }

    const fn structure_name(&self) -> &'static str {
        match self.least_normal_joint {
            Some(_) => "row",
            None => "ring",
        }
    }

    fn verdict(&self) -> String {
        match (self.admissible, self.is_in_tension()) {
            (true, _) => "admissible".to_owned(),
            (false, true) => "in tension".to_owned(),
            (false, false) => format!("leaves the {}", self.structure_name()),
        }
    }
}

impl ModelComparison {
    pub(super) fn of(impact: &LinkImpact<'_>, model: ImpactModel, found: Option<Impact>) -> Self {
        let (sway, profile) = (impact.sway(), impact.profile());
        let found = found.map(|found| {
            let hinges = found.mechanism.named_hinges_from_left(profile, sway).into();
            ModelImpact {
                restitution: found.restitution,
                after: SwayingMechanism { sway, hinges },
                impulses: Impulses::of(impact, found.impulse_line.as_ref()),
            }
        });
        Self {
            model: model.name().into(),
            impact: found,
        }
    }
}

impl Certificate {
    pub(super) fn of(impact: &LinkImpact<'_>, projection: &Projection) -> Self {
        let (sway, profile) = (impact.sway(), impact.profile());
        let from_left =
            |joint: usize| sway.convert_section(profile, projection.joints[joint].angle_rad);
        let opened = projection
            .opening_joints()
            .map(|(joint, edge, rate)| OpenedJoint {
                place: SectionPosition::of(profile, from_left(joint)),
                edge,
                opening_rate_ratio: rate,
            });
        let mut opened_joints: Vec<OpenedJoint> = opened.collect();
        if sway == Sway::Left {
            opened_joints.reverse();
        }
        let is_ring = impact.chain().sites == HingeSites::Anywhere;
        let mut zones: Vec<([f64; 2], Zone)> = Vec::new();
        for edge in [Edge::Intrados, Edge::Extrados] {
            let opened: Vec<_> = projection
                .opening_joints()
                .filter(|(_, own, _)| *own == edge)
                .collect();
            for zone in opened.chunk_by(|a, b| is_ring && a.0 + 1 == b.0) {
                let mut ends = [zone[0].0, zone[zone.len() - 1].0].map(from_left);
                ends.sort_by(f64::total_cmp);
                let rate = zone.iter().map(|(.., rate)| rate).sum();
                let [from, to] = ends.map(|section| SectionPosition::of(profile, section));
                let zone = Zone {
                    edge,
                    from,
                    to,
                    opening_rate_ratio: rate,
                };
                zones.push((ends, zone));
            }
        }
        zones.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        let four_link = impact
            .mechanism_after()
            .map_or(0.0, |link| link.link.restitution);
        let line = impact.line().map(|line| LineExtremes::of(impact, line));
        Self {
            index: impact.index,
            joints: projection.joints.len(),
            restitution_four_link: four_link,
            restitution_all_fields: projection.restitution,
            gap: projection.restitution - four_link,
            impulse_line_admissible: line.map(|line| line.admissible),
            opened_joints,
            impulse_line: line,
            zones: zones.into_iter().map(|(_, zone)| zone).collect(),
        }
    }
}

impl Zone {
    /// Sections of the zone in words.
    fn sections(&self) -> String {
        let [from, to] = [self.from, self.to].map(|end| cell(&end.joint, &end.angle_deg));
        if from == to {
            from
        } else {
            format!("{from} to {to}")
        }
    }
}

impl Report for ImpactSummary {
    const IS_TABLE: bool = true;

    fn verdict(&self) -> String {
        let first = self.impacts.first();
        first.map_or(
            "no mechanism can follow the first impact".to_owned(),
            |first| {
                let restitution = format_fixed(first.restitution, 4);
                format!("energy after the first impact over that before: {restitution}")
            },
        )
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

impl ImpactSummary {
    pub(super) fn new(
        scenario: &Scenario,
        model: &dyn MechanismModel,
        (sides, count): (&[Sway], usize),
        chain: impl Fn(Sway) -> Vec<ChainImpact>,
    ) -> Self {
        let impact = scenario.motion.impact();
        let is_prescribed = impact.model.is_prescribed();
        let model_name = match scenario.structure.wall_behind() {
            Some(_) if !is_prescribed => "back_wall",
            _ => impact.model.name(),
        };
        let starts = sides
            .iter()
            .map(|side| SwayingMechanism::of(model, *side, 0));
        Self {
            impacts: chain(sides[0]),
            impacts_after_left: sides.get(1).map(|side| chain(*side)),
            models: None,
            certificate: None,
            warnings: Warnings::new(scenario.unlikely_in(&Varied::default()), []),
            starts: starts.collect(),
            count,
            chosen: None,
            model: model_name.into(),
            restitution_factor: impact.restitution_factor,
        }
    }

    /// Chains, each with the mechanism before its first impact.
    fn chains(&self) -> impl Iterator<Item = (&SwayingMechanism, &[ChainImpact])> {
        let left = self.impacts_after_left.as_deref();
        let chains = [Some(&*self.impacts), left].into_iter().flatten();
        self.starts.iter().zip(chains)
    }

    /// Impacts with an impulse line: number, impulses at the hinges, and extremes of the line.
    fn lines<'a>(
        &self,
        chain: &'a [ChainImpact],
    ) -> Vec<(usize, &'a [HingeImpulse], &'a LineExtremes)> {
        let lines = chain.iter().map_while(|impact| {
            let all = impact.impulses.as_ref()?;
            let impulses = all.impulses.as_deref()?;
            Some((impact.index, impulses, all.impulse_line.as_ref()?))
        });
        lines.collect()
    }

    fn initial(&self, edge: &Edge) -> &'static str {
        match edge {
            Edge::Intrados => "I",
            Edge::Extrados => "E",
        }
    }

    /// Hinge for the column of a table.
    fn hinge(&self, hinge: &Hinge) -> String {
        match hinge {
            Hinge::Section { angle_rad, edge } => {
                format!("{:>10.5} {}", degrees(*angle_rad), self.initial(edge))
            }
            Hinge::Toe(side) | Hinge::Face { side, .. } => {
                format!("{:>12}", format!("{} toe", side.name()))
            }
            Hinge::Joint { joint, edge } => {
                let edge = edge.map_or("", |edge| self.initial(&edge));
                format!("{:>12}", format!("joint {joint} {edge}"))
            }
        }
    }
}
/// Smallest number of parts of a ring in the table of an impulse line.
const LINE_PARTS: usize = 720;

impl LinkImpact<'_> {
    /// Makes the table of the impulse line, from the left springing; `None` if there is no impulse line. A ring has rows at the sections of
    /// a fine division, at joints of voussoirs and at hinges; a row of blocks has a row at each joint. The eccentricity is empty if no impulse
    /// crosses the section.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn line_table(&self) -> Option<Result<Vec<u8>, OutputError>> {
        let line = self.line()?;
        let unit = self.model.impulse_unit_n_s_per_m();
        let (profile, sway) = (self.profile(), self.sway());
        let mut sections = profile.sections(match self.chain().sites {
            HingeSites::Anywhere => LINE_PARTS,
            HingeSites::Voussoirs(count) => LINE_PARTS.next_multiple_of(count),
        });
        let hinges = self
            .mechanism_after()?
            .mechanism
            .hinges_from_left(profile, sway);
        sections.extend(hinges.map(|(section, _)| section));
        sections.sort_by(f64::total_cmp);
        sections.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        let at = |section: &f64| line.section_from_left(*section, sway);
        let name = profile.joint(0.0).map_or("angle_deg", |_| "joint");
        let columns = [
            column(name, |section: &f64| {
                let SectionPosition { joint, angle_deg } = SectionPosition::of(profile, *section);
                joint.map_or_else(|| Cell::from(angle_deg), Cell::from)
            }),
            column("eccentricity_ratio", |place| {
                Some(at(place).eccentricity_ratio).filter(|ratio| ratio.is_finite())
            }),
            column("normal_n_s_per_m", |place| at(place).normal * unit),
            column("tangential_n_s_per_m", |place| at(place).tangential * unit),
        ];
        Some(Table::new(columns, &sections).map(|table| table.csv))
    }
}
