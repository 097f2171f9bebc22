//! Names that readers of tables use.

pub(super) use std::ops::Bound::{Excluded, Included, Unbounded};

pub(super) use archrock_text::{ensure, plain, short, shown};
pub(super) use serde::{Serialize, Serializer};
pub(super) use serde_json::{Map, Value, json};

pub(super) use super::bounds::*;
pub(super) use super::relation::GIVE_ONE;
pub(super) use super::relation::Relation::{self, *};
pub(super) use super::rule::*;
pub(super) use super::table::{FaultRecorded, ReadResult, Reader, Table};
