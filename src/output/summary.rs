//! Summaries as JSON, from the types of results.

use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};
use serde_value::Value as Exact;

use super::OutputError;

/// Converts a result to JSON. The keys are the fields of its type, in their order.
///
/// # Errors
/// When a number is not finite: JSON would contain null instead.
pub(crate) fn summary_of(result: &impl Serialize) -> Result<Value, OutputError> {
    let failed = OutputError::NotFinite;
    let json = serde_json::to_value(result).map_err(|error| failed(error.to_string()))?;
    let exact = serde_value::to_value(result).map_err(|error| failed(error.to_string()))?;
    not_finite(&exact).map_or(Ok(json), |path| Err(failed(path)))
}

/// Values with names, which become the keys of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<V>(pub Vec<(String, V)>);

impl<V: Serialize> Serialize for Named<V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl<'de, V: DeserializeOwned> Deserialize<'de> for Named<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let entries = Map::deserialize(deserializer)?.into_iter();
        let read = entries.map(|(name, value)| Ok((name, V::deserialize(value)?)));
        let read = read.collect::<Result<_, serde_json::Error>>();
        read.map(Self).map_err(D::Error::custom)
    }
}

/// Returns the path to a number that is not finite; `None` if all numbers are finite.
fn not_finite(value: &Exact) -> Option<String> {
    match value {
        Exact::F64(number) => (!number.is_finite()).then(String::new),
        Exact::Option(Some(inner)) | Exact::Newtype(inner) => not_finite(inner),
        Exact::Seq(items) => items
            .iter()
            .enumerate()
            .find_map(|(at, item)| Some(format!("[{at}]{}", not_finite(item)?))),
        Exact::Map(entries) => entries.iter().find_map(|(name, item)| match name {
            Exact::String(name) => Some(format!(".{name}{}", not_finite(item)?)),
            _ => not_finite(item),
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Inner {
        force_n: Option<f64>,
    }

    #[derive(Serialize)]
    struct Outer {
        sides: [Inner; 2],
    }

    #[test]
    fn a_number_that_is_not_finite_is_named() {
        let outer = |force_n| Outer {
            sides: [
                Inner { force_n: None },
                Inner {
                    force_n: Some(force_n),
                },
            ],
        };
        let json = summary_of(&outer(1.5)).unwrap();
        assert_eq!(json["sides"][1]["force_n"], 1.5);
        for wrong in [f64::NAN, f64::INFINITY] {
            let error = summary_of(&outer(wrong)).unwrap_err();
            assert!(error.to_string().contains(".sides[1].force_n"), "{error}");
        }
    }
}
