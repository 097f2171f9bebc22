//! Summaries as JSON, from the types of results.

use rmpv::Value as Number;
use rmpv::ext::to_value as numbers_of;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};

use super::OutputError;

/// Converts a result to JSON. The keys are the fields of its type, in their order.
///
/// # Errors
/// When a number is not finite: JSON would contain null instead.
pub(crate) fn summary_of(result: &impl Serialize) -> Result<Value, OutputError> {
    let failed = OutputError::NotFinite;
    let json = serde_json::to_value(result).map_err(|error| failed(error.to_string()))?;
    let numbers = numbers_of(result).map_err(|error| failed(error.to_string()))?;
    not_finite(&numbers, &json).map_or(Ok(json), |path| Err(failed(path)))
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

/// Returns the path to a number that is not finite, with the names of the JSON; `None` if all numbers are finite.
fn not_finite(numbers: &Number, json: &Value) -> Option<String> {
    let items: Vec<&Number> = match numbers {
        Number::F64(number) => return (!number.is_finite()).then(String::new),
        Number::Array(items) => items.iter().collect(),
        Number::Map(entries) => entries.iter().map(|(_, item)| item).collect(),
        _ => return None,
    };
    let names: Vec<(String, &Value)> = match json {
        Value::Object(fields) => fields
            .iter()
            .map(|(key, item)| (format!(".{key}"), item))
            .collect(),
        Value::Array(list) => list
            .iter()
            .enumerate()
            .map(|(at, item)| (format!("[{at}]"), item))
            .collect(),
        _ => Vec::new(),
    };
    let unnamed = (String::new(), &Value::Null);
    items.into_iter().enumerate().find_map(|(at, item)| {
        let (name, json) = names.get(at).unwrap_or(&unnamed);
        Some(format!("{name}{}", not_finite(item, json)?))
    })
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
