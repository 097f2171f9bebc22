//! Pictures and pages, read back and compared with the tables they show.

mod figures;
mod film;
mod map;
mod pictures;
mod report;
mod studies;
mod web;
