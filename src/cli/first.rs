//! The option `--first`: the side to which a structure sways first.

use archrock::mechanics::sway::Sway;
use clap::ValueEnum;

/// The option of commands that describe one chain of mechanisms: an asymmetric structure has two.
#[derive(clap::Args, Clone, Copy)]
pub struct FirstOption {
    /// The side to which the structure sways first, for results and pictures that show one side only.
    #[arg(long, value_enum, value_name = "SIDE", default_value_t)]
    first: Side,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum Side {
    #[default]
    Right,
    Left,
}

impl FirstOption {
    pub const fn get(self) -> Sway {
        match self.first {
            Side::Right => Sway::Right,
            Side::Left => Sway::Left,
        }
    }
}
