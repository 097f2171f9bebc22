//! Names that readers of tables use.

pub(super) use std::ops::Bound::{Excluded, Included, Unbounded};

pub(super) use serde::{Serialize, Serializer};
pub(super) use serde_json::{Map, Value, json};

pub(super) use super::bounds::*;
pub(super) use super::error::{ensure, excerpt};
pub(super) use super::relation::GIVE_ONE;
pub(super) use super::relation::Relation::{self, *};
pub(super) use super::rule::*;
pub(super) use super::shown;
pub(super) use super::table::{FaultRecorded, ReadResult, Reader, Table};
pub(super) use crate::argument::{plain, short};
