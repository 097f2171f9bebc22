//! Readers of whole files.

use archrock_text::ensure;

use crate::layout::{Decimal, Format, Layout, Parser, TableColumn, Times};
use crate::plain_text::not_plain;
use crate::samples::{Contents, LineFault, Parsed};
use crate::{correction, csv, histories, samples};

impl Layout {
    /// Parses the bytes of a file.
    ///
    /// # Errors
    /// The first fault in the bytes.
    pub fn parse(&self, bytes: &[u8]) -> Result<Contents, LineFault> {
        let text = decode_text(bytes)?;
        let contents = match self.format.parser {
            Parser::Record(parse, _) => parse(&text, self),
            Parser::History(find) | Parser::Channels(find) => histories::read(&text, self, find),
        }?;
        self.corrected(contents)
    }

    /// Checks samples that a program has in place of a table of times and values, and corrects them. `None` if this layout does not describe such a
    /// table.
    ///
    /// # Errors
    /// The first fault, with the number of its sample in place of a line.
    pub fn parse_samples(&self, samples: &[(f64, f64)]) -> Option<Result<Contents, LineFault>> {
        let of_samples = Self {
            times: Some(Times::Column(TableColumn::Number(1))),
            unit: self.unit,
            quantity: self.quantity,
            baseline: self.baseline,
            high_pass_hz: self.high_pass_hz,
            ..Self::new(Format::CSV)
        };
        let unit = self.unit.filter(|_| *self == of_samples)?;
        let contents = samples::checked(samples, unit);
        Some(contents.and_then(|contents| self.corrected(contents)))
    }

    /// Returns the layout of each channel of a file: this layout alone if it chooses a channel, or if there is only one.
    ///
    /// # Errors
    /// The first fault in the headers of channels.
    pub fn by_channel(&self, bytes: &[u8]) -> Result<Vec<Self>, LineFault> {
        let count = match self.format.parser {
            Parser::Channels(find) if self.channel.is_none() => {
                histories::count(&decode_text(bytes)?, self, find)?
            }
            _ => 1,
        };
        if count < 2 {
            return Ok(vec![self.clone()]);
        }
        let channel = |number| Self {
            channel: Some(TableColumn::Number(number)),
            ..self.clone()
        };
        Ok((1..=count).map(channel).collect())
    }

    /// Checks the unit of samples, and corrects them as the layout demands.
    fn corrected(&self, mut contents: Contents) -> Parsed<Contents> {
        let unit = contents.unit;
        ensure(unit.quantity() == self.quantity, || {
            let (unit, other) = (unit.name(), unit.other_quantity());
            LineFault::on(1)(format!("the unit is {unit:?}, {other}"))
        })?;
        if let Some(baseline) = self.baseline {
            baseline.subtract(&mut contents.samples);
        }
        if let Some(corner_hz) = self.high_pass_hz {
            contents.samples = correction::high_pass(&contents.samples, corner_hz)?;
        }
        Ok(contents)
    }
}

/// Reads a table that is no record: rows of exactly `N` numbers within 1e6 of zero. Returns each with its line. The first row may contain names.
///
/// # Errors
/// The first fault in the bytes.
pub fn numbers<const N: usize>(
    bytes: &[u8],
    decimal: Decimal,
) -> Result<Vec<(usize, [f64; N])>, LineFault> {
    csv::numbers(&decode_text(bytes)?, decimal)
}

/// Returns the text of a file. Headers may have any encoding with the digits of ASCII.
fn decode_text(bytes: &[u8]) -> Parsed<String> {
    not_plain(bytes).map_or(Ok(()), |wrong| Err(LineFault::on(1)(wrong)))?;
    let text = String::from_utf8_lossy(bytes);
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}
