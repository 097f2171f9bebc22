//! The results of several models of motion of one structure.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::output::Named;
use crate::scenario::ModelKind;

/// The results of several models of motion of one structure.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(deserialize = "R: DeserializeOwned"))]
pub struct Comparison<R> {
    /// The answer of the model with the fewest assumptions, in words.
    pub to_quote: Option<String>,
    /// The comparison of the models by the largest rotations of their cases or samples; absent without these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peaks: Option<Value>,
    /// The results, by the name of the model.
    #[serde(flatten)]
    models: Named<R>,
}

impl<R> Comparison<R> {
    /// Makes the comparison of these results.
    pub fn new(
        models: impl IntoIterator<Item = (&'static ModelKind, R)>,
        to_quote: Option<String>,
        peaks: Option<Value>,
    ) -> Self {
        let models = models.into_iter();
        let named = models.map(|(model, results)| (model.option.to_owned(), results));
        Self {
            to_quote,
            peaks,
            models: Named(named.collect()),
        }
    }

    /// Results of each model, in the order in which they were computed.
    pub fn models(&self) -> impl Iterator<Item = &R> {
        self.models.0.iter().map(|(_, results)| results)
    }
}
