//! Rules for single values: the allowed values of a key in words, a reader, and a JSON schema.

use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::{RangeBounds as _, RangeInclusive};

use archrock_text::{excerpt, short};
use serde::Serialize;
use serde_json::{Value, json};

use super::document::{NOT_FINITE, kind};

/// A rule for a value.
pub(super) trait Rule {
    /// Type of the value in the program.
    type Output: Serialize;
    /// Allowed values in words.
    fn allowed(&self) -> String;
    /// Reads a value. The error is a phrase that follows the value.
    fn read(&self, value: &Value) -> Result<Self::Output, String>;
    /// Rule as a JSON schema.
    fn schema(&self) -> Value;
}

/// A finite number between two bounds, with an optional reason for the bounds. Integers are allowed.
pub(super) struct Number(Bound<f64>, Bound<f64>, Option<&'static str>);

/// Any finite number.
pub(super) const ANY_NUMBER: Number = between(Unbounded, Unbounded);

/// Rule for a number between two bounds.
pub(super) const fn between(low: Bound<f64>, high: Bound<f64>) -> Number {
    Number(low, high, None)
}

/// Rule for a number in a range.
pub(super) const fn within(range: &RangeInclusive<f64>) -> Number {
    between(Included(*range.start()), Included(*range.end()))
}

/// Rule for a number above the first bound and up to the second.
pub(super) const fn above(low: f64, high: f64) -> Number {
    between(Excluded(low), Included(high))
}

impl Number {
    /// Adds the reason for the bounds.
    pub(super) const fn because(self, why: &'static str) -> Self {
        Self(self.0, self.1, Some(why))
    }

    pub(super) fn contains(&self, x: f64) -> bool {
        (self.0, self.1).contains(&x)
    }
}

impl Rule for Number {
    type Output = f64;

    fn allowed(&self) -> String {
        let why = self.2.map_or_else(String::new, |why| format!(" ({why})"));
        let low = match self.0 {
            Included(low) => format!(" of at least {}", short(low)),
            Excluded(low) => format!(" above {}", short(low)),
            Unbounded => String::new(),
        };
        let high = match (self.0, self.1) {
            (Included(low), Included(high)) => {
                return format!("a number from {} to {}{why}", short(low), short(high));
            }
            (_, Unbounded) => return format!("a number{low}{why}"),
            (_, Included(high)) => format!("at most {}", short(high)),
            (_, Excluded(high)) => format!("below {}", short(high)),
        };
        let and = if low.is_empty() { "" } else { " and" };
        format!("a number{low}{and} {high}{why}")
    }

    fn read(&self, value: &Value) -> Result<f64, String> {
        match value {
            Value::Number(number) => number
                .as_f64()
                .filter(|x| self.contains(*x))
                .ok_or("is out of range".to_owned()),
            _ => Err(kind_phrase(value)),
        }
    }

    fn schema(&self) -> Value {
        let mut schema = json!({ "type": "number" });
        for (bound, inclusive, exclusive) in [
            (self.0, "minimum", "exclusiveMinimum"),
            (self.1, "maximum", "exclusiveMaximum"),
        ] {
            match bound {
                Included(bound) => schema[inclusive] = json!(bound),
                Excluded(bound) => schema[exclusive] = json!(bound),
                Unbounded => {}
            }
        }
        schema
    }
}

/// Reads a value. The error is a phrase that follows the value.
type ReadValue<'a, T> = Box<dyn Fn(&Value) -> Result<T, String> + 'a>;

/// A rule given by its parts: allowed values in words, JSON schema, and reader.
pub(super) struct Custom<'a, T>(
    pub(super) String,
    pub(super) Value,
    pub(super) ReadValue<'a, T>,
);

impl<T: Serialize> Rule for Custom<'_, T> {
    type Output = T;

    fn allowed(&self) -> String {
        self.0.clone()
    }

    fn read(&self, value: &Value) -> Result<T, String> {
        (self.2)(value)
    }

    fn schema(&self) -> Value {
        self.1.clone()
    }
}

/// Rule for an array whose elements follow a rule.
pub(super) fn list_of<R: Rule>(rule: &R) -> Custom<'_, Vec<R::Output>> {
    let allowed = format!("an array, each element {}", rule.allowed());
    let read = |value: &Value| {
        let elements = value.as_array().ok_or_else(|| kind_phrase(value))?;
        let read = |(element, place): (&Value, usize)| {
            let wrong = |wrong| format!("has an element (number {place}) that {wrong}");
            rule.read(element).map_err(wrong)
        };
        elements.iter().zip(1..).map(read).collect()
    };
    let schema = json!({ "type": "array", "items": rule.schema() });
    Custom(allowed, schema, Box::new(read))
}

/// Rule for a value that follows a rule, or a non-empty array of such values.
pub(super) fn one_or_more<R: Rule>(rule: &R) -> Custom<'_, Vec<R::Output>> {
    let allowed = format!("{} or an array of at least one", rule.allowed());
    let (one, list) = (rule.schema(), list_of(rule));
    let read = move |value: &Value| match value {
        Value::Array(elements) if elements.is_empty() => Err("is empty".to_owned()),
        Value::Array(_) => list.read(value),
        _ => Ok(vec![rule.read(value)?]),
    };
    let schema = json!({ "anyOf": [one, { "type": "array", "items": one, "minItems": 1 }] });
    Custom(allowed, schema, Box::new(read))
}

/// Rule for true or false.
pub(super) fn switch() -> Custom<'static, bool> {
    value_of_kind("true or false", "boolean", Value::as_bool)
}

/// Rule for any string.
pub(super) fn text() -> Custom<'static, String> {
    let read = |value: &Value| string(value).map(str::to_owned);
    value_of_kind("a string", "string", read)
}

/// Rule for any value of a JSON type.
fn value_of_kind<T: 'static>(
    allowed: &str,
    kind: &str,
    read: fn(&Value) -> Option<T>,
) -> Custom<'static, T> {
    let read = move |value: &Value| read(value).ok_or_else(|| kind_phrase(value));
    Custom(allowed.to_owned(), json!({ "type": kind }), Box::new(read))
}

/// Rule for a value that is named by a string.
pub(super) fn one_of<T: Copy + Serialize>(all: &[T]) -> Custom<'_, T> {
    let names: Vec<_> = all.iter().map(|one| json!(one)).collect();
    let quoted: Vec<_> = names.iter().map(Value::to_string).collect();
    let allowed = format!("one of {}", quoted.join(", "));
    let schema = json!({ "enum": names });
    let read = move |value: &Value| {
        let text = string(value).ok_or_else(|| kind_phrase(value))?;
        let index = names.iter().position(|name| *name == text);
        let unknown = || {
            format!(
                "is unknown{}",
                did_you_mean(text, names.iter().filter_map(Value::as_str))
            )
        };
        index.map(|index| all[index]).ok_or_else(unknown)
    };
    Custom(allowed, schema, Box::new(read))
}

/// A whole number in a range, with the reason for the lower bound.
pub(super) struct Count(pub(super) RangeInclusive<usize>, pub(super) &'static str);

impl Rule for Count {
    type Output = usize;

    fn allowed(&self) -> String {
        let (low, high) = (self.0.start(), self.0.end());
        format!("a whole number from {low} ({}) to {high}", self.1)
    }

    fn read(&self, value: &Value) -> Result<usize, String> {
        let count = value.as_u64().and_then(|whole| usize::try_from(whole).ok());
        let is_whole = value.is_i64() || value.as_f64().is_some_and(|number| number.abs() > 9e18);
        match count.filter(|count| self.0.contains(count)) {
            Some(count) => Ok(count),
            None if is_whole => Err("is out of range".to_owned()),
            None => Err(kind_phrase(value)),
        }
    }

    fn schema(&self) -> Value {
        json!({ "type": "integer", "minimum": self.0.start(), "maximum": self.0.end() })
    }
}

/// String of a value; `None` for other values, and for a number that is not finite.
pub(super) fn string(value: &Value) -> Option<&str> {
    value.as_str().filter(|text| !text.starts_with(NOT_FINITE))
}

/// Phrase with the kind of a value: `is a string`.
fn kind_phrase(value: &Value) -> String {
    format!("is {}", kind(value))
}

/// Suggestion of the known name nearest to `name`; empty if none is near.
pub(super) fn did_you_mean<'k>(name: &str, known: impl Iterator<Item = &'k str>) -> String {
    // At least half of the name must agree: this finds names with a missing unit or prefix, but no unrelated names.
    const NEAR: f64 = 0.5;
    let name = excerpt(name);
    known
        .map(|known| (strsim::normalized_damerau_levenshtein(&name, known), known))
        .filter(|(likeness, _)| *likeness > NEAR)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, known)| format!(" (did you mean `{known}`?)"))
        .unwrap_or_default()
}
