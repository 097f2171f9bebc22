//! The width of pictures.

use archrock::output::Figure;

/// The option of every command that draws.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct FigureOption {
    /// Draw for print at this width, such as 85mm, with text of 8 pt at that width [default: for the screen].
    #[arg(long, value_name = "WIDTH", allow_hyphen_values = true)]
    figure_width: Option<Figure>,
}

impl FigureOption {
    pub fn get(self) -> Figure {
        self.figure_width.unwrap_or(Figure::SCREEN)
    }
}
