//! The style of pictures.

use archrock::output::{Figure, Height, PictureFormat};

use super::Failure;
use super::parsers::number;

/// The options of every command that draws.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct FigureOption {
    /// Draw for print at this width, such as 85mm, with text of 8 pt at that width [default: for the screen].
    #[arg(long, value_name = "WIDTH", allow_hyphen_values = true)]
    figure_width: Option<Figure>,
    /// Draw this high in print, such as 60mm [default: what fits the width; at most 120 mm below 100 mm of width].
    #[arg(
        long,
        value_name = "HEIGHT",
        requires = "figure_width",
        allow_hyphen_values = true
    )]
    figure_height: Option<Height>,
    /// Size of the text in print, in points, from 5 to 14 [default: 8].
    #[arg(long, value_name = "PT", requires = "figure_width", value_parser = text_pt, allow_hyphen_values = true)]
    font_size: Option<f64>,
    /// Draw no titles: the figure has a caption.
    #[arg(long)]
    no_title: bool,
    /// Also write every picture in this format, beside its SVG: pdf or png.
    #[arg(long, value_name = "FORMAT")]
    pub figure_format: Option<PictureFormat>,
}

impl FigureOption {
    /// Returns the layout of pictures.
    pub fn get(self) -> Result<Figure, Failure> {
        let mut figure = self.figure_width.unwrap_or(Figure::SCREEN);
        if let Some(text_pt) = self.font_size {
            let sized = figure.with_text_pt(text_pt);
            figure = sized.map_err(|wrong| Failure::Input(format!("--font-size: {wrong}")))?;
        }
        figure.height = self.figure_height;
        figure.has_title = !self.no_title;
        Ok(figure)
    }
}

fn text_pt(text: &str) -> Result<f64, String> {
    let remedy = "give a size from 5 to 14 points, such as 7";
    number(text.trim_end_matches("pt").trim(), 5.0..=14.0, remedy)
}
