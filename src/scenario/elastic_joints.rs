//! Elastic joints: `[elastic_joints]`.

use std::f64::consts::PI;
use std::ops::RangeInclusive;
use std::sync::Arc;

use super::free_hinges;
use super::model_kind::{AnyModel, ModelKind, ModelOptions, Site};
use super::prelude::*;
use super::structure::{ModelError, Structure};
use crate::argument::ArgumentError;
use crate::dynamics::{ReboundError, Variation};
use crate::mechanics::ElasticStructure;
use crate::mechanics::elastic_joint::{
    Contact, ElasticProperties, JointStiffness, Materials, RestError, Stiffness,
};
use crate::{Column, ElasticJoints, Request, RowModelError, RowOptions};

/// Converts a stiffness in GPa/m to Pa/m, and a modulus in GPa to Pa.
const GPA: f64 = 1e9;
/// Converts a strength in MPa to Pa.
const MPA: f64 = 1e6;

/// Default ratio of shear to normal stiffness: the ratio of the shear modulus to Young's modulus.
const SHEAR_RATIO: f64 = 0.4;
/// Default damping time, in seconds.
const DAMPING_TIME_S: f64 = 1e-4;
const TABLE: &[&str] = &["elastic_joints"];
/// Largest normal stiffness: stiffer joints are practically rigid.
const STIFFEST_GPA_M: f64 = 1000.0;

/// Ratios of rates that a rebound may have.
const REBOUND_RATIO: Number = between(Excluded(0.0), Excluded(1.0));
const MODULUS_GPA: Number = scale_range(&ElasticProperties::MODULUS_PA, GPA);
const ONE_POINT: &str = "one does not hold a block";
const POINTS: Count = Count(ElasticProperties::CONTACT_POINTS, ONE_POINT);

/// Range in another unit.
const fn scale_range(range: &RangeInclusive<f64>, unit: f64) -> Number {
    within(&(*range.start() / unit..=*range.end() / unit))
}

/// A row of blocks with elastic joints.
pub static ELASTIC_JOINTS: ModelKind = ModelKind {
    option: "elastic",
    name: "elastic_joints",
    table: "elastic_joints",
    label: "elastic joints",
    assumptions: "elastic joints: rigid blocks on joints with a stiffness, which is rarely known well, and without tension. After the first reversals the motion depends on the vibration of the joints, so histories are repeated with other steps",
    has_joints: true,
    has_mechanism: false,
    is_repeated: true,
    has_stiffness: true,
    has_lanes: true,
    ignored: Some("[impact] is ignored: elastic joints have no impacts"),
    lacking: Some(
        "lacks [elastic_joints] with a stiffness: give `normal_stiffness_gpa_m` there, as in --set elastic_joints.normal_stiffness_gpa_m=10; \
         the document on elastic joints explains how to choose",
    ),
    read: |table| Ok(Arc::new(ElasticTable::read(table)?)),
};

/// The contents of `[elastic_joints]`, in the units of the keys.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct ElasticTable {
    /// Normal stiffness of a joint per area, in GPa/m; `None` if it follows from moduli.
    normal_stiffness_gpa_m: Option<f64>,
    /// Shear stiffness of a joint per area, in GPa/m; `None` for the default ratio to the normal stiffness.
    shear_stiffness_gpa_m: Option<f64>,
    /// Young's modulus of the blocks, in GPa, from which the stiffness follows; `None` if the stiffness is given.
    stone_modulus_gpa: Option<f64>,
    /// Young's modulus of the mortar, in GPa; `None` without mortar.
    mortar_modulus_gpa: Option<f64>,
    /// Thickness of the mortar, in m; `None` without mortar.
    mortar_thickness_m: Option<f64>,
    /// Coulomb's coefficient of friction; `None` if joints never slip.
    friction_coefficient: Option<f64>,
    /// Damping time, in s: damping forces are this time multiplied by the rates of the elastic forces.
    damping_time_s: f64,
    /// Ratio of rates of an impact that the damping time gives; `None` if the damping is given.
    #[serde(skip)]
    rebound_ratio: Option<f64>,
    /// Reason why no damping time gives this ratio, once it has been sought.
    #[serde(skip)]
    no_rebound: Option<ReboundError>,
    /// Compressive strength of joints, in MPa; `None` if joints do not crush.
    compressive_strength_mpa: Option<f64>,
    /// Number of contact points that carry the stress; `None` for continuous contact.
    contact_points: Option<usize>,
    /// The longest time step, in s; `None` for the default.
    longest_step_s: Option<f64>,
}

impl ElasticTable {
    /// Reads `[elastic_joints]`.
    fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        const STRENGTH_MPA: Number = scale_range(&ElasticProperties::STRENGTH_PA, MPA);
        let softest_gpa_m = *ElasticProperties::NORMAL_STIFFNESS_PA_M.start() / GPA;
        let stiffness = within(&(softest_gpa_m..=STIFFEST_GPA_M)).because("stiffer joints are as good as rigid, and take very many steps: use [free_hinges], the limit of stiff joints");
        let mortar_m = within(&ElasticProperties::MORTAR_M);
        let friction = within(&ElasticProperties::FRICTION_COEFFICIENT);
        let read = Self {
            normal_stiffness_gpa_m: table.optional("normal_stiffness_gpa_m", &stiffness),
            shear_stiffness_gpa_m: table.optional("shear_stiffness_gpa_m", &within(&(1e-5..=1e7))),
            stone_modulus_gpa: table.optional("stone_modulus_gpa", &MODULUS_GPA),
            mortar_modulus_gpa: table.optional("mortar_modulus_gpa", &MODULUS_GPA),
            mortar_thickness_m: table.optional("mortar_thickness_m", &mortar_m),
            friction_coefficient: table.optional("friction_coefficient", &friction),
            damping_time_s: read_damping(table),
            rebound_ratio: table.optional("rebound_ratio", &REBOUND_RATIO),
            no_rebound: None,
            compressive_strength_mpa: table.optional("compressive_strength_mpa", &STRENGTH_MPA),
            contact_points: table.optional("contact_points", &POINTS),
            longest_step_s: table.optional("longest_step_s", &within(&ElasticJoints::STEP_S)),
        };
        table.optional("contact", &one_of(&["continuous"]));
        table.apply_relations(RELATIONS)?;
        Ok(read)
    }

    /// Properties of the joints of a structure with this depth.
    fn properties(&self, depth_m: f64) -> ElasticProperties {
        let stiffness = match (self.normal_stiffness_gpa_m, self.stone_modulus_gpa) {
            (None, Some(stone_gpa)) => {
                let mortar = self.mortar_modulus_gpa.zip(self.mortar_thickness_m);
                Stiffness::Materials(Materials {
                    stone_modulus_pa: GPA * stone_gpa,
                    mortar: mortar.map(|(modulus_gpa, thick_m)| [GPA * modulus_gpa, thick_m]),
                    shear_ratio: SHEAR_RATIO,
                })
            }
            (normal_gpa_m, _) => {
                let normal_gpa_m = normal_gpa_m.unwrap_or(STIFFEST_GPA_M);
                let shear_gpa_m = self.shear_stiffness_gpa_m;
                Stiffness::Uniform(JointStiffness {
                    normal_pa_m: GPA * normal_gpa_m,
                    shear_pa_m: GPA * shear_gpa_m.unwrap_or(SHEAR_RATIO * normal_gpa_m),
                })
            }
        };
        ElasticProperties {
            stiffness,
            depth_m,
            friction_coefficient: self.friction_coefficient,
            damping_time_s: self.damping_time_s,
            compressive_strength_pa: self.compressive_strength_mpa.map(|mpa| MPA * mpa),
            contact: self
                .contact_points
                .map_or(Contact::Continuous, Contact::Points),
        }
    }

    /// Joints of a structure, an error if their stiffness is out of range; `None` if the structure is not a row of blocks.
    fn joints(&self, structure: &Structure) -> Option<Result<ElasticStructure, ArgumentError>> {
        let (depth_m, _) = structure.depth_and_density();
        let (row, properties) = (structure.row().ok()?, self.properties(depth_m));
        let wall = structure
            .column()
            .map(Column::wall_behind_drums)
            .transpose()
            .map(Option::flatten);
        let joints = ElasticStructure::of_row(&row, &properties);
        Some(joints.and_then(|joints| joints.with_wall(&row, wall?, &properties)))
    }

    /// Rejects time steps that are too long, or too many until the end.
    fn check_step(
        &self,
        table: &mut Table<'_>,
        joints: &ElasticStructure,
        end_s: f64,
    ) -> ReadResult<()> {
        let step_s = ElasticJoints::default_step_s(joints);
        let stable_s = joints.stable_step_s();
        match self.longest_step_s {
            Some(step_s) if step_s > stable_s => {
                let most = short(0.5 * stable_s);
                let wrong = format!(
                    "is too long: half of what is stable with these joints is {most} s; leave it out, or give that"
                );
                Err(table.reject_in(TABLE, "longest_step_s", wrong))
            }
            None if end_s > ElasticJoints::MOST_STEPS * step_s => {
                let [step, end] = [step_s, end_s].map(plain);
                let wrong = format!(
                    "makes steps of {step} s, too many for a motion of {end} s: give less damping, or a shorter [simulation] duration_s"
                );
                let given = |key: &&&str| table.has_key_in(TABLE[0], key);
                let key = ["damping_ratio", "rebound_ratio"].iter().find(given);
                Err(table.reject_in(TABLE, key.unwrap_or(&"damping_time_s"), wrong))
            }
            _ => Ok(()),
        }
    }

    /// Makes the model of a structure. An error if the structure has no joints, or cannot stand on these joints.
    fn build_model(&self, structure: &Structure, site: &Site) -> Result<ElasticJoints, ModelError> {
        let (depth_m, _) = structure.depth_and_density();
        let (gravity_m_s2, properties) = (site.gravity_m_s2, self.properties(depth_m));
        if let Some(error) = self.no_rebound {
            return Err(ModelError::ElasticJoints(error.into()));
        }
        let model = match structure.column() {
            Some(column) => ElasticJoints::of_column(gravity_m_s2, column, properties)
                .map(|model| model.keeping_rebound(column, self.rebound_ratio)),
            None => {
                let row = structure.row().map_err(RowModelError::from)?;
                ElasticJoints::under(gravity_m_s2, row, properties)
            }
        };
        model
            .and_then(|model| model.on_supports(site.supports))
            .and_then(|model| match self.longest_step_s {
                Some(step_s) => Ok(model.with_longest_step_s(step_s)?),
                None => Ok(model),
            })
            .map_err(ModelError::ElasticJoints)
    }
}

impl ModelOptions for ElasticTable {
    fn to_json(&self) -> Value {
        json!(self)
    }

    fn model(&self, structure: &Structure, site: &Site) -> AnyModel {
        Ok(Box::new(self.build_model(structure, site)?))
    }

    /// Finds the damping time that gives the rebound.
    fn for_structure(&self, structure: &Structure, site: &Site) -> Option<Arc<dyn ModelOptions>> {
        let rate_ratio = self.rebound_ratio?;
        let (depth_m, _) = structure.depth_and_density();
        let properties = self.properties(depth_m);
        let found = match structure.column() {
            Some(column) => ElasticJoints::damping_time_of_rebound_s(
                site.gravity_m_s2,
                column,
                &properties,
                rate_ratio,
            ),
            None => Err(ReboundError::SeveralBlocks.into()),
        };
        let mut resolved = *self;
        match found {
            Ok(time_s) => resolved.damping_time_s = time_s,
            Err(RowModelError::Rebound(error)) => resolved.no_rebound = Some(error),
            // A fault of the structure or its joints, which every model reports.
            Err(_) => {}
        }
        Some(Arc::new(resolved))
    }

    /// Makes models with other stiffness and contact, and one with rigid joints, unless a wall stands behind the structure.
    fn variations(&self, structure: &Structure, site: &Site) -> Result<Vec<Variation>, ModelError> {
        let mut variations = self.build_model(structure, site)?.variations();
        if structure.wall_behind().is_some() {
            return Ok(variations);
        }
        let rigid = RowOptions {
            friction_coefficient: self.friction_coefficient,
            ..RowOptions::default()
        };
        variations.push(Variation {
            name: "rigid joints (free hinges)".to_owned(),
            model: match free_hinges::model(rigid, structure, site) {
                Ok(rigid) => Ok(Box::new(rigid)),
                Err(error) => Err(error.to_string()),
            },
        });
        Ok(variations)
    }

    fn friction_coefficient(&self) -> Option<f64> {
        self.friction_coefficient
    }

    fn compressive_strength_mpa(&self) -> Option<f64> {
        self.compressive_strength_mpa
    }

    fn longest_step_s(&self, structure: &Structure, _: &Site, _: &Request) -> Option<f64> {
        let joints = self.joints(structure)?.ok()?;
        let default_s = ElasticJoints::default_step_s(&joints);
        Some(self.longest_step_s.unwrap_or(default_s))
    }

    /// Rejects joints on which the structure cannot stand, and time steps that are too long or too many.
    fn check(
        &self,
        table: &mut Table<'_>,
        structure: &Structure,
        site: &Site,
        end_s: Option<f64>,
    ) -> ReadResult<()> {
        // Other users of the row report its faults.
        let Some((joints, end_s)) = self.joints(structure).zip(end_s) else {
            return Ok(());
        };
        let stiffness = match self.stone_modulus_gpa {
            Some(_) => "stone_modulus_gpa",
            None => "normal_stiffness_gpa_m",
        };
        let joints = joints
            .map_err(|error| {
                let (name, value, allowed) = (error.argument, plain(error.value), error.allowed);
                let wrong = format!("gives a joint `{name} = {value}`, which must be {allowed}");
                table.reject_in(TABLE, stiffness, wrong)
            })?
            .on_supports(site.supports.displacements());
        let Err(error) = joints.rest([0.0, -site.gravity_m_s2]) else {
            if let Some(error) = self.no_rebound {
                return Err(table.reject_in(TABLE, "rebound_ratio", error.to_string()));
            }
            return self.check_step(table, &joints, end_s);
        };
        let key = match error {
            RestError::Friction => "friction_coefficient",
            RestError::Strength => "compressive_strength_mpa",
            RestError::Points => "contact_points",
            RestError::Tie(index) => {
                return Err(table.reject_element("tie", index, format!("does not fit: {error}")));
            }
            RestError::TieDuringMovement(tie, part) => {
                let wrong = format!(
                    "breaks at {:.2} % of the movement of [supports], with these joints: give a larger `breaks_at_strain`, or less \
                     movement",
                    1e2 * part
                );
                return Err(table.reject_element("tie", tie, wrong));
            }
            RestError::Supports(part) => {
                let wrong = format!(
                    "makes the arch fall at {:.2} % of this movement, with joints as soft as these: reduce it, or give stiffer joints",
                    1e2 * part
                );
                return Err(table.reject("supports", wrong));
            }
            // Too soft, or not found.
            _ => stiffness,
        };
        let wrong = format!("is not possible here: {error}");
        Err(table.reject_in(TABLE, key, wrong))
    }
}

const NO_STIFFNESS: &str = "lacks a stiffness: give `normal_stiffness_gpa_m`, or `stone_modulus_gpa` from which it follows. \
                            Published discrete-element models of arches take about 10 GPa/m, tables of rock joints 50; \
                            the document on elastic joints explains how to choose";
const OF_MODULI: &str = "goes with `normal_stiffness_gpa_m`: from moduli both follow; leave it out";
const OF_STONE: &str = "goes with `stone_modulus_gpa`, and `normal_stiffness_gpa_m` is that of the whole joint; leave it out";
const OF_CRITICAL: &str = " beside it: it is a part of critical damping at a frequency";
const OF_CRUSHING: &str = "cannot be combined with `rebound_ratio`: joints that crush lose other energy at each impact; give `damping_time_s`";
const RELATIONS: &[Relation<'_>] = &[
    OneOf(
        &["normal_stiffness_gpa_m", "stone_modulus_gpa"],
        Some(NO_STIFFNESS),
    ),
    Excludes("stone_modulus_gpa", "shear_stiffness_gpa_m", OF_MODULI),
    Together(&["mortar_modulus_gpa", "mortar_thickness_m"]),
    Excludes("normal_stiffness_gpa_m", "mortar_modulus_gpa", OF_STONE),
    AtMostOne(
        &["damping_time_s", "damping_ratio", "rebound_ratio"],
        GIVE_ONE,
    ),
    AtMostOne(&["damping_time_s", "damping_frequency_hz"], GIVE_ONE),
    AtMostOne(&["rebound_ratio", "damping_frequency_hz"], GIVE_ONE),
    Excludes("rebound_ratio", "compressive_strength_mpa", OF_CRUSHING),
    Requires("damping_ratio", "damping_frequency_hz", OF_CRITICAL),
    Requires("damping_frequency_hz", "damping_ratio", " beside it"),
    AtMostOne(&["contact", "contact_points"], GIVE_ONE),
];

/// Reads the damping time, or computes it from a fraction of critical damping at a frequency.
fn read_damping(table: &mut Table<'_>) -> f64 {
    let range_s = within(&ElasticProperties::DAMPING_TIME_S);
    let default_s = table.or("damping_time_s", &range_s, DAMPING_TIME_S);
    let ratio = table.optional("damping_ratio", &within(&(0.0..=1.0)));
    let frequency_hz = table.optional("damping_frequency_hz", &within(&(1e-3..=1e6)));
    let Some((ratio, frequency_hz)) = ratio.zip(frequency_hz) else {
        return default_s;
    };
    let time_s = ratio / (PI * frequency_hz);
    let wrong = format!(
        "at {frequency_hz:?} Hz is a damping time of {} s; must be at most {} s",
        short(time_s),
        short(*ElasticProperties::DAMPING_TIME_S.end())
    );
    let _ = table.refuse(!range_s.contains(time_s), "damping_ratio", wrong);
    time_s
}
