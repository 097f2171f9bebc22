//! Charts and drawings as SVG, and as PDF, PNG and films. Nothing here knows what is drawn: structures and their motion are drawn by `archrock`.
//!
//! From the bottom up:
//!
//! - [`Drawing`]: shapes and texts as SVG, in pixels, y downwards. Hidden characters of texts are escaped ([`archrock_text::shown`]), and texts have the
//!   computed width ([`Text`]) in every font.
//! - [`Figure`]: the size of a picture, on the screen or in print.
//! - [`Sheet`]: a picture as parts below one another: titles, legends, plots, captions. It stretches the plots to the height of the figure.
//! - [`Scale`] and [`Axes`]: values on an axis, ticks, labels.
//! - [`Chart`]: scales, [`Mark`]s in the units of the axes, and a legend; [`Panels`]: charts over a common time axis; [`Envelope`] and [`Thinned`]:
//!   long series in as many points as a picture shows.
//! - [`PictureFormat`]: a finished SVG as PDF or PNG; [`Reel`]: pictures as a film. Both need the feature `print`.
//!
//! ```
//! use archrock_draw::{CURVES, Chart, Figure, Mark};
//!
//! let wave = (0..=100).map(|i| 0.1 * f64::from(i)).map(|time_s| (time_s, time_s.sin()));
//! let curves = vec![Mark::curve("wave", CURVES[0], wave)];
//! let figure: Figure = "85mm".parse()?;
//! let chart = Chart::around(figure, 300.0, ["Time (s)", "Height (m)"], curves);
//! let svg = chart.draw(figure, "A wave");
//! assert!(svg.starts_with("<svg") && svg.contains("data-name=\"wave\""));
//! # Ok::<(), String>(())
//! ```
// Tests compare with tolerances.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod axes;
mod chart;
mod envelope;
mod figure;
mod film;
mod panels;
mod print;
mod sheet;
mod svg;
mod text;

pub use axes::{Axes, Scale};
pub use chart::{BELOW_PX, Chart, LEFT_PX, Mark, Shape};
pub use envelope::{COLUMNS, Envelope, Thinned};
pub use figure::{Figure, Height};
pub use film::{FilmFormat, Reel};
pub use panels::{Panels, scale_around};
pub use print::{PictureFormat, PrintError};
pub use sheet::{FinishedSheet, Key, PartHeight, Sheet, Sign};
pub use svg::{Anchor, Background, CURVES, Drawing, Frame, Stroke, Symbol, color};
pub use text::{TEXT_PX, Text, escaped, text_px};
