//! The shape of a circular arch, given by its mean radius, or by its span, as masons and surveyors measure it.
//!
//! ```toml
//! [arch]
//! span_m = 6.0
//! rise_m = 2.2                # or embrace_deg = 150.0
//! thickness_m = 0.5           # or thickness_ratio, over the mean radius
//! measured_at = "intrados"    # the line whose span and rise these are: "intrados", "mean" or "extrados"
//! ```

use super::document::Entries;
use super::prelude::*;
use crate::argument::rounded_up;
use crate::mechanics::{EMBRACE_DEG as ALLOWED_DEG, MeasuredAt};

const LINES: &str = " beside it: \"intrados\", \"mean\" or \"extrados\"";
const POSITIVE: Number = between(Excluded(0.0), Unbounded);
/// Range of spans and rises, which may be smaller than any radius.
const LENGTH: Number = within(&(1e-6..=1e6));

/// The shape of a circular arch.
pub(super) struct Circular {
    pub(super) mean_radius_m: f64,
    pub(super) thickness_ratio: f64,
    pub(super) embrace_deg: f64,
    /// The line to which the given span refers; `None` if the scenario gives no span.
    pub(super) measured_at: Option<MeasuredAt>,
}

impl Circular {
    /// Reads the keys of `[arch]` that define the shape.
    pub(super) fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let mean_radius_m = table.optional("mean_radius_m", &MAGNITUDE);
        let span_m = table.optional("span_m", &LENGTH);
        let ratio = table.optional("thickness_ratio", &THICKNESS_RATIO);
        let thickness_m = table.optional("thickness_m", &POSITIVE);
        let embrace_deg = table.optional("embrace_deg", &EMBRACE_DEG);
        let rise_m = table.optional("rise_m", &LENGTH);
        let measured_at = table.optional("measured_at", &one_of(MeasuredAt::ALL));
        let radius = format!(
            "lacks `mean_radius_m`: give {}, or `span_m` where it is `measured_at`",
            MAGNITUDE.allowed()
        );
        let needs_span = "; give that too, or `mean_radius_m` without it";
        table.check_relations(&[
            OneOf(&["mean_radius_m", "span_m"], Some(&radius)),
            OneOf(&["thickness_ratio", "thickness_m"], None),
            OneOf(&["rise_m", "embrace_deg"], None),
            Requires("rise_m", "span_m", needs_span),
            Requires("measured_at", "span_m", needs_span),
            Requires("span_m", "measured_at", LINES),
        ])?;
        let embrace_deg = match (span_m, rise_m, embrace_deg) {
            (Some(span_m), Some(rise_m), _) => checked_embrace_deg(table, span_m, rise_m)?,
            (_, _, embrace_deg) => embrace_deg.ok_or(FaultRecorded)?,
        };
        let radius_m = match (span_m, mean_radius_m) {
            (Some(span_m), _) => 0.5 * span_m / libm::sin(0.5 * embrace_deg.to_radians()),
            (None, radius_m) => radius_m.ok_or(FaultRecorded)?,
        };
        let to_mean = measured_at.unwrap_or(MeasuredAt::Mean).to_mean();
        let (mean_radius_m, thickness_ratio) = match (ratio, thickness_m) {
            (Some(ratio), _) => (radius_m / (1.0 - to_mean * ratio), ratio),
            (None, thickness_m) => {
                let thickness_m = thickness_m.ok_or(FaultRecorded)?;
                let mean_radius_m = radius_m + to_mean * thickness_m;
                (mean_radius_m, thickness_m / mean_radius_m)
            }
        };
        let [ratio, radius] = [thickness_ratio, mean_radius_m].map(plain);
        // An extrados radius below half the thickness gives a negative mean radius.
        let wrong = format!(
            "is out of range: {ratio} mean radii of {radius} m; must be at least a millionth of the mean radius and \
             below twice that"
        );
        let is_ratio = THICKNESS_RATIO.contains(thickness_ratio);
        table.refuse(!is_ratio, "thickness_m", wrong)?;
        let allowed = MAGNITUDE.allowed();
        let wrong = format!("makes a mean radius of {radius} m; that must be {allowed}");
        table.refuse(!MAGNITUDE.contains(mean_radius_m), "span_m", wrong)?;
        Ok(Self {
            mean_radius_m,
            thickness_ratio,
            embrace_deg,
            measured_at,
        })
    }
}

/// Embrace angle of the given arch, in degrees; `None` if the table gives none.
pub(super) fn given_embrace_deg(arch: &Entries) -> Option<f64> {
    let number = |key: &str| arch.get(key).and_then(Value::as_f64);
    let measured = number("span_m").zip(number("rise_m"));
    let measured_deg = measured.map(|(span_m, rise_m)| embrace_deg(span_m, rise_m));
    measured_deg.or(number("embrace_deg"))
}

/// Writes the embrace angle in place of the rise, if a new mean radius replaces the span.
pub(super) fn keep_embrace_angle(arch: &mut Entries, is_new: impl Fn(&str) -> bool) {
    let is_kept = |key| arch.contains_key(key) && !is_new(key);
    if !is_new("mean_radius_m") || !is_kept("span_m") {
        return;
    }
    let embrace_deg = given_embrace_deg(arch).filter(|_| is_kept("rise_m"));
    if !is_new("measured_at") {
        arch.shift_remove("measured_at");
    }
    if let Some(embrace_deg) = embrace_deg.filter(|_| !is_new("embrace_deg")) {
        arch.shift_remove("rise_m");
        arch.insert("embrace_deg".to_owned(), Value::from(embrace_deg));
    }
}

/// Embrace angle of an arc with this span and rise, in degrees.
fn embrace_deg(span_m: f64, rise_m: f64) -> f64 {
    let half_m = 0.5 * span_m;
    // The angle between chord and tangent at the crown is a quarter of the embrace angle.
    4.0 * libm::atan(rise_m / half_m).to_degrees()
}

/// Embrace angle of an arc with this span and rise, in degrees. A fault is recorded if it is out of range.
fn checked_embrace_deg(table: &mut Table<'_>, span_m: f64, rise_m: f64) -> ReadResult<f64> {
    let embrace_deg = embrace_deg(span_m, rise_m);
    // The rise at the smallest angle, from the inverse of the formula above.
    let least_m = 0.5 * span_m * libm::tan((0.25 * ALLOWED_DEG.start()).to_radians());
    let bound = match embrace_deg < *ALLOWED_DEG.start() {
        true => format!("at least {} m for this span", short(rounded_up(least_m))),
        false => "at most half the span".to_owned(),
    };
    let wrong = format!(
        "makes an embrace angle of {} degrees; must be from 1 to 180, which is a rise of {bound}",
        plain(embrace_deg)
    );
    table.refuse(!EMBRACE_DEG.contains(embrace_deg), "rise_m", wrong)?;
    Ok(embrace_deg)
}
