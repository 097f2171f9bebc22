//! Ascending numbers: a list, or a range with a count.

use super::prelude::*;

named! {
    /// Spacing of the numbers of a range.
    pub enum Spacing {
        /// Equal differences.
        Linear = "linear",
        /// Equal ratios.
        Logarithmic = "logarithmic",
    }
}

/// Ascending numbers, one for each case of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Sequence {
    /// `{ from = 0.1, to = 2.0, count = 20, spacing = "logarithmic" }`: includes the ends; the default spacing is linear.
    Range {
        /// The first number.
        from: f64,
        /// The last number, above the first.
        to: f64,
        /// Number of values, at least 2.
        count: usize,
        /// Spacing of the numbers between the ends.
        spacing: Spacing,
    },
    /// `[0.1, 0.5, 2.0]`: at least one number.
    List(Vec<f64>),
}

/// Rule for an array of ascending numbers.
fn ascending(number: &Number) -> Custom<'_, Vec<f64>> {
    let allowed = format!(
        "an array of ascending numbers or {{ from = ..., to = ..., count = ... }}, each {}",
        number.allowed()
    );
    let read = |value: &Value| {
        ensure(!value.is_number(), || "is a single number")?;
        let values = list_of(number).read(value)?;
        ensure(!values.is_empty(), || "is empty")?;
        ensure(ascend(&values), || "does not ascend")?;
        Ok(values)
    };
    let schema = json!({ "type": "array", "items": number.schema(), "minItems": 1 });
    Custom(allowed, schema, Box::new(read))
}

fn ascend(values: &[f64]) -> bool {
    values.is_sorted_by(|earlier, later| earlier < later)
}

/// Largest number of values in a range.
const COUNT: Count = Count(2..=10_000, "the ends");

impl Sequence {
    /// Numbers.
    pub fn values(&self) -> Vec<f64> {
        match self {
            Self::List(values) => values.clone(),
            Self::Range {
                from,
                to,
                count,
                spacing,
            } => (0..*count)
                .map(|index| number_at(*from, *to, index, count - 1, *spacing))
                .collect(),
        }
    }

    /// True if the axis of these values, multiples of the numbers, is logarithmic.
    pub fn is_logarithmic(&self, values: &[f64]) -> bool {
        self.spacing() == Spacing::Logarithmic && values.iter().all(|value| *value > 0.0)
    }

    /// Spacing of the axis on which the numbers are drawn.
    pub const fn spacing(&self) -> Spacing {
        match self {
            Self::Range { spacing, .. } => *spacing,
            Self::List(_) => Spacing::Linear,
        }
    }

    /// Reads the numbers of a key; each must follow `rule`. `None` if the key is not given or wrong.
    pub(super) fn read(table: &mut Table<'_>, key: &str, rule: &Number) -> Option<Self> {
        if table.has_table(key) || table.describes() {
            let range = table.table(key, |table| Self::read_range(table, rule));
            if !table.describes() {
                return range;
            }
        }
        table.optional(key, &ascending(rule)).map(Self::List)
    }

    fn read_range(table: &mut Table<'_>, rule: &Number) -> ReadResult<Self> {
        let from = table.read_required("from", rule);
        let to = table.read_required("to", rule);
        let count = table.read_required("count", &COUNT);
        let spacing = table.or("spacing", &one_of(Spacing::ALL), Spacing::Linear);
        table.check_faultless()?;
        let wrong = format!("is not above `from`; must be above {}", short(from));
        table.refuse(to <= from, "to", wrong)?;
        let crosses_zero = spacing == Spacing::Logarithmic && from <= 0.0 && to >= 0.0;
        let wrong = "needs numbers of one sign; use \"linear\" here";
        table.refuse(crosses_zero, "spacing", wrong)?;
        let range = Self::Range {
            from,
            to,
            count,
            spacing,
        };
        let wrong = "exceeds the number of floating-point numbers in the range; give a smaller one";
        table.refuse(!ascend(&range.values()), "count", wrong)?;
        Ok(range)
    }
}

/// Rounds a number as people would write it: 0.12 instead of 0.12000000000000002. The largest number has twelve digits; there are more decimals
/// if a millionth of a step needs them.
fn round_readably(value: f64, largest: f64, step: f64) -> f64 {
    let digits = (12.0 - libm::log10(largest).floor())
        .max(6.0 - libm::log10(step).floor())
        .clamp(0.0, 340.0) as usize;
    let rounded: f64 = format!("{value:.digits$}").parse().unwrap_or(value);
    // Turns negative zero into zero.
    rounded + 0.0
}

/// Number of a range. The ends are exact, and so is every number with few digits.
fn number_at(from: f64, to: f64, index: usize, last: usize, spacing: Spacing) -> f64 {
    let part = index as f64 / last as f64;
    match spacing {
        _ if index == 0 => from,
        _ if index == last => to,
        Spacing::Linear => {
            let (largest, step) = (from.abs().max(to.abs()), (to - from) / last as f64);
            round_readably(from * (1.0 - part) + to * part, largest, step)
        }
        Spacing::Logarithmic => from * libm::pow(to / from, part),
    }
}
