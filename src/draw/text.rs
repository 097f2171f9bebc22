//! Text on pictures: drawn characters and their width.

use archrock_text::shown_lines;

/// Fonts whose widths the layout uses.
pub(crate) const FONTS: &str = "Helvetica, Arial, Liberation Sans, Nimbus Sans, sans-serif";
/// Size of text in pixels.
pub const TEXT_PX: f64 = 13.0;
/// Distance between the baselines of two lines of text, in pixels.
pub(crate) const LINE_PX: f64 = 17.0;
/// Largest number of characters of a word; the rest is omitted.
const LONGEST_WORD: usize = 130;

/// A line of text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// Characters of the line; invisible ones are escaped.
    pub(crate) shown: String,
    /// Width in thousandths of the size of the text.
    thousandths: u32,
}

impl<T: AsRef<str>> From<T> for Text {
    fn from(text: T) -> Self {
        let shown = shown_lines(text.as_ref());
        let thousandths = shown.chars().map(advance).sum();
        Self { shown, thousandths }
    }
}

impl Text {
    /// Divides a text into lines of at most this width, in pixels. Very long words are cut.
    pub(crate) fn lines(text: &str, width_px: f64) -> Vec<Self> {
        let mut lines: Vec<Self> = Vec::new();
        for word in text.split_whitespace() {
            let mut shown: String = word.chars().take(LONGEST_WORD).collect();
            if shown.len() < word.len() {
                shown.push_str("...");
            }
            match lines.last_mut() {
                Some(line) if Self::from(format!("{} {shown}", line.shown)).px() <= width_px => {
                    *line = format!("{} {shown}", line.shown).into();
                }
                _ => lines.push(shown.into()),
            }
        }
        lines
    }

    /// Returns the width in pixels.
    pub fn px(&self) -> f64 {
        TEXT_PX * f64::from(self.thousandths) / 1000.0
    }

    /// Returns true if the width is exact; for other scripts than Latin it is an estimate.
    pub(crate) fn is_measured(&self) -> bool {
        !self.shown.is_empty() && self.shown.chars().all(|character| character <= '\u{24f}')
    }
}

/// Returns the width of a text in pixels, in Helvetica or a font with equal widths, such as Arial and Liberation Sans.
pub fn text_px(text: &str) -> f64 {
    Text::from(text).px()
}

/// Escapes hidden characters and the special characters of XML; keeps line ends and tabs.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in shown_lines(text).chars() {
        match character {
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '&' => escaped += "&amp;",
            '"' => escaped += "&quot;",
            character => escaped.push(character),
        }
    }
    escaped
}

/// Returns the width of a character in thousandths of the size of the text.
const fn advance(character: char) -> u32 {
    match character {
        'i' | 'j' | 'l' | '\'' => 222,
        '|' => 260,
        ' ' | '!' | ',' | '.' | '/' | ':' | ';' | 'I' | '[' | '\\' | ']' | 'f' | 't' => 278,
        '(' | ')' | '-' | 'r' | '`' | '{' | '}' => 333,
        '"' => 355,
        '*' => 389,
        '^' => 469,
        'J' | 'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' => 500,
        '+' | '<' | '=' | '>' | '~' => 584,
        'F' | 'T' | 'Z' => 611,
        '&' | 'A' | 'B' | 'E' | 'K' | 'P' | 'S' | 'V' | 'X' | 'Y' => 667,
        'C' | 'D' | 'H' | 'N' | 'R' | 'U' | 'w' => 722,
        'G' | 'O' | 'Q' => 778,
        'M' | 'm' => 833,
        '%' => 889,
        'W' => 944,
        '@' => 1015,
        // Exact for digits and most lower-case letters, an estimate for the others.
        '\0'..='\u{24f}' => 556,
        _ => 1000,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_as_wide_as_in_helvetica() {
        // Published widths of the letters: H 722, e 556, l 222, l 222, o 556.
        assert!((text_px("Hello") - 13.0 * 2.278).abs() < 1e-12);
        assert!((text_px("-0.05") - 13.0 * 2.279).abs() < 1e-12);
    }

    #[test]
    fn a_word_without_end_is_cut() {
        let lines = Text::lines(&"x".repeat(1000), 100.0);
        assert!(lines.len() == 1 && lines[0].shown.len() < 140);
    }
}
