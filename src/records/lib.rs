//! Reads recorded ground motion: bytes and a [`Layout`] in, samples ([`Contents`]) or the first fault with its line ([`LineFault`]) out.
//!
//! A layout describes a file: its [`Format`]; for files of several channels, the channel; for tables, the columns, their unit and their decimal
//! mark. [`Layout::parse`] also subtracts a [`Baseline`] and filters, if the layout demands it.
//!
//! ```
//! use archrock_records::{Format, Layout, TableColumn, Times, Unit};
//!
//! let bytes = b"Station X\nSTRONG MOTION RECORD\nUNITS OF CM/S/S\nNPTS= 3, DT= .01 SEC\n 0.5 -1.25 0.75\n";
//! assert_eq!(Format::of_contents(bytes), Some(Format::AT2));
//! let contents = Layout::new(Format::AT2).parse(bytes)?;
//! assert_eq!(contents.samples, [(0.0, 0.5), (0.01, -1.25), (0.02, 0.75)]);
//! assert_eq!(contents.unit, Unit::CentimetrePerS2);
//!
//! let layout = Layout {
//!     acceleration_column: Some(TableColumn::Name("up".to_owned())),
//!     ..Layout::table(Times::Column(TableColumn::Number(1)), Unit::Gravity)
//! };
//! assert_eq!(layout.parse(b"time,north,up\n0,1,2\n0.5,3,4\n")?.samples, [(0.0, 2.0), (0.5, 4.0)]);
//!
//! let fault = Layout::new(Format::AT2).parse(b"NPTS= 4, DT= .01 SEC\n1 2 3\n").unwrap_err();
//! assert_eq!(fault.to_string(), "2: the number of samples is 3: line 1 announces 4 (NPTS)");
//! # Ok::<(), archrock_records::LineFault>(())
//! ```
//!
//! Messages name the fields of the layout as serde writes them: [`Times`] is `time_column` or `dt_s`.
//!
//! A format is one constant in the file of its reader: its names, how it is recognized, and its parser. Most parsers only find the histories
//! that a header describes; `histories` chooses one of them, reads its numbers, and compares them with the header.
// Tests compare with tolerances.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

#[macro_use]
extern crate archrock_text;

mod afad;
mod asc;
mod at2;
mod correction;
mod cosmos;
mod csmip;
mod csmnc;
mod csv;
mod cwb;
mod format;
mod geonet;
mod histories;
mod history;
mod knet;
mod layout;
mod networks;
mod plain_text;
mod reader;
mod samples;
mod sampling;
mod smc;
#[cfg(test)]
mod tests;
mod unam;
mod unit;

pub use correction::Baseline;
pub use layout::{Decimal, Format, Layout, TableColumn, Times};
pub use plain_text::{binary_kind, not_plain};
pub use reader::numbers;
pub use samples::{Contents, LineFault, MAX_TIME_S, MIN_STEP_S};
pub use sampling::{Sampling, mean};
pub use unit::{RecordedQuantity, Unit};
