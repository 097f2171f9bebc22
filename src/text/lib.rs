//! Text of messages: names of enum variants ([`named!`]), numbers in few digits, excerpts of files, and hidden characters made visible.
//!
//! ```
//! use archrock_text::{excerpt, plain};
//!
//! let cell = "1.5\u{202e}g";
//! assert_eq!(
//!     format!("`{}` is no number, but above {}", excerpt(cell), plain(0.1 + 0.02)),
//!     r"`1.5\u202eg` is no number, but above 0.12"
//! );
//! ```

mod line;
mod message;
mod names;
mod number;
mod shown;

pub use line::{LINE, length, wrapped};
pub use message::{ensure, excerpt};
pub use number::{format_fixed, plain, short};
pub use shown::{is_hidden, shown, shown_lines};
