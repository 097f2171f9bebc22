//! Checks values against a JSON schema, by the keywords that the schema of scenarios has.

use serde_json::Value;

/// The violations of a schema by a value at a place; empty if the value is valid.
pub fn violations(schema: &Value, value: &Value, place: &str) -> Vec<String> {
    let mut inner = Vec::new();
    let keywords = schema.as_object().unwrap();
    let broken = keywords.iter().filter(|(keyword, rule)| {
        let rules = || rule.as_array().unwrap().iter();
        let valid = |schema: &Value| violations(schema, value, place).is_empty();
        let gives = |key: &Value| value.get(key.as_str().unwrap()).is_some();
        let bound = || rule.as_f64().unwrap();
        let number = value.as_f64();
        let holds = match keyword.as_str() {
            "$schema" | "title" | "description" | "default" | "examples" => true,
            "type" => match rule.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "integer" => value.is_i64() || value.is_u64(),
                "number" => value.is_number(),
                other => panic!("type {other}"),
            },
            "enum" => rules().any(|one| one == value),
            "minimum" => number.is_none_or(|number| number >= bound()),
            "maximum" => number.is_none_or(|number| number <= bound()),
            "exclusiveMinimum" => number.is_none_or(|number| number > bound()),
            "exclusiveMaximum" => number.is_none_or(|number| number < bound()),
            "minItems" => value
                .as_array()
                .is_none_or(|all| all.len() as f64 >= bound()),
            "items" => {
                let items = value.as_array().into_iter().flatten().enumerate();
                inner.extend(
                    items.flat_map(|(at, item)| violations(rule, item, &format!("{place}/{at}"))),
                );
                true
            }
            "properties" => {
                for (key, schema) in rule.as_object().unwrap() {
                    let value = value.get(key).into_iter();
                    inner
                        .extend(value.flat_map(|value| {
                            violations(schema, value, &format!("{place}/{key}"))
                        }));
                }
                true
            }
            // Keys with a dot belong to other tables.
            "patternProperties" => {
                let entries = value.as_object().into_iter().flatten();
                for (key, value) in entries.filter(|(key, _)| key.contains('.')) {
                    inner.extend(violations(&rule["\\."], value, &format!("{place}/{key}")));
                }
                true
            }
            "additionalProperties" => value.as_object().is_none_or(|entries| {
                let has_others = schema.get("patternProperties").is_some();
                entries.keys().all(|key| {
                    schema["properties"].get(key).is_some() || (has_others && key.contains('.'))
                })
            }),
            "required" => !value.is_object() || rules().all(gives),
            "dependencies" => rule.as_object().unwrap().iter().all(|(key, others)| {
                value.get(key).is_none() || others.as_array().unwrap().iter().all(gives)
            }),
            "allOf" => rules().all(valid),
            "anyOf" => rules().any(valid),
            "oneOf" => rules().filter(|one| valid(one)).count() == 1,
            "not" => !valid(rule),
            other => panic!("keyword {other}"),
        };
        !holds
    });
    let broken: Vec<String> = broken
        .map(|(keyword, rule)| format!("{place}: {keyword} {rule}"))
        .collect();
    inner.into_iter().chain(broken).collect()
}
