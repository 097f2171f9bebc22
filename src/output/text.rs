//! Text on pictures: the characters that are drawn, and their width.

use crate::scenario::shown_lines;

/// Fonts with the widths by which texts are laid out.
pub(crate) const FONTS: &str = "Helvetica, Arial, Liberation Sans, Nimbus Sans, sans-serif";
/// Size of text in pixels.
pub(crate) const TEXT_PX: f64 = 13.0;
/// From the baseline of a line of text to that of the next.
pub(crate) const LINE_PX: f64 = 17.0;
/// Longer words are cut.
const LONGEST_WORD: usize = 130;

/// A line of text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Text {
    /// Its characters; those that would be invisible are escaped.
    pub(crate) shown: String,
    /// Its width in thousandths of the size of the text.
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
    /// Breaks a text into lines of at most this width, in pixels. A very long word is cut.
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

    /// Its width in pixels.
    pub(crate) fn px(&self) -> f64 {
        TEXT_PX * f64::from(self.thousandths) / 1000.0
    }

    /// Whether the width is known: for other scripts it is a guess.
    pub(crate) fn is_measured(&self) -> bool {
        !self.shown.is_empty() && self.shown.chars().all(|character| character <= '\u{24f}')
    }
}

/// Width of a text in pixels, in Helvetica or a font with its widths, such as Arial and Liberation Sans.
#[must_use]
pub fn text_px(text: &str) -> f64 {
    Text::from(text).px()
}

/// Text made safe to show, with its line ends and tabs, and with the special characters of XML escaped.
pub(crate) fn escaped(text: &str) -> String {
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

/// Width of a character in thousandths of the size of the text.
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
        // Digits and most small letters; of others about as much.
        '\0'..='\u{24f}' => 556,
        _ => 1000,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_as_wide_as_in_helvetica() {
        // By its published measures: H 722, e 556, l 222, l 222, o 556.
        assert!((text_px("Hello") - 13.0 * 2.278).abs() < 1e-12);
        assert!((text_px("-0.05") - 13.0 * 2.279).abs() < 1e-12);
    }

    #[test]
    fn a_word_without_end_is_cut() {
        let lines = Text::lines(&"x".repeat(1000), 100.0);
        assert!(lines.len() == 1 && lines[0].shown.len() < 140);
    }
}
