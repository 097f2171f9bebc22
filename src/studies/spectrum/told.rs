//! Reports an overturning spectrum: its table, its summary and its words.

use super::{OverturningSpectrum, PointRow, picture};
use crate::argument::plain;
use crate::output::table::{Column, column, csv};
use crate::output::{Figure, OutputError, pretty};
use crate::studies::ending::columns::number;
use crate::studies::remarks::{self, Remark, Remarks};
use crate::studies::results::Results;

const SUMMARY: &str = "spectrum.json";

impl OverturningSpectrum<'_> {
    /// The files and words for all rows.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn tell(&self, rows: &[PointRow], figure: Figure) -> Result<Results, OutputError> {
        let title = self.scenario.title();
        let title = title.unwrap_or("Overturning spectrum");
        let remarks = remarks(rows);
        let mut summary = remarks::summary(self.scenario, rows.len(), &remarks);
        if let (Some(warnings), Some(words)) =
            (summary["warnings"].as_array_mut(), no_verdict(rows))
        {
            warnings.push(words.into());
        }
        Ok(Results {
            files: vec![
                (
                    "spectrum.svg",
                    figure
                        .fitted(|figure| picture::draw(figure, title, self, rows))
                        .into_bytes(),
                ),
                (SUMMARY, pretty(&summary).into_bytes()),
                ("spectrum.csv", csv(columns(), rows)?),
            ],
            words: words(self, rows, &remarks),
            summary,
            ..Results::default()
        })
    }
}

/// The columns for one row per point: one structure after the other, with ascending sizes.
fn columns() -> [Column<'static, PointRow>; 10] {
    let least = |row: &PointRow| row.minimum;
    [
        column("structure", |row: &PointRow| row.structure.name()),
        column("p_t", |row: &PointRow| number(row.p_t)),
        column("duration_s", |row: &PointRow| number(row.duration_s)),
        column("no_impact_over_incipient", |row: &PointRow| {
            row.no_impact_over_incipient.map(number)
        }),
        column("least_over_incipient", move |row| {
            least(row).map(|one| number(one.over_incipient))
        }),
        column("impacts_before_overturning", move |row| {
            least(row).map(|one| one.impacts)
        }),
        column("overturning_sway", move |row| {
            least(row).map(|one| one.sway.name())
        }),
        column("still_rocking", |row: &PointRow| row.still_rocking),
        column("incomplete", |row: &PointRow| row.incomplete),
        column("failed", |row: &PointRow| row.failures.len()),
    ]
}

/// The points that failed, with the reasons.
fn remarks(rows: &[PointRow]) -> Remarks {
    let mut remarks = Remarks::default();
    for row in rows {
        for failure in &row.failures {
            let what = match failure.over_incipient {
                Some(over_incipient) => format!("at {} A_L", plain(over_incipient)),
                None => "least without impact".to_owned(),
            };
            let case = format!(
                "{} with p t_p {}, {what}",
                row.structure.name(),
                plain(row.p_t)
            );
            let remark = Remark::new(case, &failure.reason);
            remarks.failures.push(remark);
        }
    }
    remarks
}

/// How many histories have no verdict; `None` if all have one.
fn no_verdict(rows: &[PointRow]) -> Option<String> {
    let points = rows.iter().filter(|row| row.incomplete > 0).count();
    let histories: usize = rows.iter().map(|row| row.incomplete).sum();
    (histories > 0).then(|| {
        format!(
            "no verdict from {histories} histories at {points} points, which keep more than a quarter of the energy barrier long after \
             their pulse: weaker pulses than the least may overturn there"
        )
    })
}

/// Counts the points by outcome, and reports what is uncertain.
fn words(spectrum: &OverturningSpectrum<'_>, rows: &[PointRow], remarks: &Remarks) -> String {
    let count = |wanted: fn(Option<usize>) -> bool| {
        let impacts = rows
            .iter()
            .map(|row| row.minimum.map(|least| least.impacts));
        impacts.filter(|impacts| wanted(*impacts)).count()
    };
    let mut text = format!(
        "{} points: the weakest pulse overturns before any impact at {}, after impacts at {}",
        rows.len(),
        count(|impacts| impacts == Some(0)),
        count(|impacts| impacts > Some(0)),
    );
    let known =
        |row: &&PointRow| row.minimum.is_none() && row.incomplete == 0 && row.failures.is_empty();
    let none = rows.iter().filter(known).count();
    if let Some(last) = spectrum.over_incipient().last()
        && none > 0
    {
        text += &format!("; at {none} no pulse up to {last} A_L overturns");
    }
    let rocking: usize = rows.iter().map(|row| row.still_rocking).sum();
    if rocking > 0 {
        text += &format!(
            "; {rocking} histories were still rocking long after their pulse, and count as survived"
        );
    }
    if let Some(words) = no_verdict(rows) {
        text += &format!("; {words}");
    }
    if let Some(words) = remarks.failed_in_words(SUMMARY) {
        text += &format!("; {words}");
    }
    if let Some(caveat) = remarks::rough_guide(spectrum.scenario) {
        text += &format!("\n  {caveat}");
    }
    text
}
