//! Encoding of the numbers of a page in base 64, with the precision of a picture.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};

use crate::output::{Piece, Scene};
use crate::{OpenHinge, Sample};

/// Largest integer of an encoded rotation or displacement.
pub(super) const LARGEST_I16: f64 = 32767.0;

/// Distinct sets of hinges of the frames, and the index of the set of each frame. Rows have one empty set, because their joints are
/// encoded in each frame.
pub(super) fn layouts<'a>(
    scene: &Scene,
    frames: &[&'a Sample],
) -> (Vec<&'a [OpenHinge]>, Vec<u16>) {
    let is_row = scene.joint(0).is_some();
    let same = |one: &[OpenHinge], other: &[OpenHinge]| {
        let hinges = |open: &OpenHinge| open.hinge;
        Iterator::eq(one.iter().map(hinges), other.iter().map(hinges))
    };
    let mut layouts: Vec<&[OpenHinge]> = Vec::new();
    let layout_of = frames
        .iter()
        .map(|frame| {
            let open = if is_row { &[][..] } else { &frame.hinges };
            let known = layouts.iter().position(|layout| same(layout, open));
            let layout = known.unwrap_or_else(|| {
                layouts.push(open);
                layouts.len() - 1
            });
            u16::try_from(layout).expect("there are fewer layouts than frames")
        })
        .collect();
    (layouts, layout_of)
}

/// The body and the outline of a piece, in units of the page.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct DrawnPiece {
    body: i64,
    outline: Vec<i64>,
}

/// Piece in units of the page.
pub(super) fn piece(piece: &Piece, unit_m: f64) -> DrawnPiece {
    let corners = piece.outline_m.iter();
    let coordinates = corners.flat_map(|corner| [corner.x, corner.y]);
    DrawnPiece {
        body: body_number(piece.body),
        outline: coordinates.map(|x| (x / unit_m).round() as i64).collect(),
    }
}

/// Number of a body; -1 for parts that do not move.
pub(super) fn body_number(body: Option<usize>) -> i64 {
    body.and_then(|body| i64::try_from(body).ok()).unwrap_or(-1)
}

/// Encodes a fraction from 0 to 1 as a byte from 0 to 255, rounded up: only zero becomes zero.
pub(super) fn byte_rounded_up(part: f64) -> u8 {
    (255.0 * part).ceil().clamp(0.0, 255.0) as u8
}

/// Encodes values as integer multiples of a unit. Returns the encoded values and the unit, with which the largest value just fits.
pub(super) fn quantized(values: impl Iterator<Item = f64> + Clone) -> (String, f64) {
    let most = values
        .clone()
        .fold(0.0, |most: f64, value| most.max(value.abs()));
    let unit = if most > 0.0 { most / LARGEST_I16 } else { 1.0 };
    let quantized = values.map(|value| ((value / unit).round() as i16).to_le_bytes());
    (encoded(quantized), unit)
}

pub(super) fn encoded<const N: usize>(values: impl Iterator<Item = [u8; N]>) -> String {
    BASE64_STANDARD.encode(values.flatten().collect::<Vec<u8>>())
}

pub(super) fn encoded_f32(values: impl Iterator<Item = f64>) -> String {
    encoded(values.map(|value| (value as f32).to_le_bytes()))
}

/// Encodes the times of a curve, followed by its values.
pub(super) fn curve(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let (times_s, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    encoded_f32(times_s.into_iter().chain(values))
}
