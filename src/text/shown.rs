//! Makes text from outside, such as titles and file names, safe to display.

/// Escapes every character that is invisible or changes the display of other text: control and format characters, line ends, byte order marks,
/// and marks of writing direction. Escapes are those of TOML and JSON.
///
/// The joiners U+200C and U+200D are kept after letters that are not ASCII, because several scripts need them.
///
/// ```
/// use archrock_text::shown;
///
/// assert_eq!(shown("a\u{202e}b\nc\u{7}"), r"a\u202eb\nc\u0007");
/// assert_eq!(shown("mea\u{feff}n"), r"mea\ufeffn");
/// ```
pub fn shown(text: &str) -> String {
    escape(text, |_| false)
}

/// Escapes hidden characters in a text of several lines; line ends and tabs are kept.
pub fn shown_lines(text: &str) -> String {
    escape(text, |c| matches!(c, '\n' | '\t'))
}

fn escape(text: &str, is_meant: impl Fn(char) -> bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        let joins_nothing = is_joiner(c) && shown.chars().next_back().is_none_or(|c| c.is_ascii());
        match c {
            c if !(is_hidden(c) || joins_nothing) || is_meant(c) => shown.push(c),
            '\n' => shown += "\\n",
            '\r' => shown += "\\r",
            '\t' => shown += "\\t",
            // All hidden characters have codes of four digits.
            c => shown += &format!("\\u{:04x}", u32::from(c)),
        }
    }
    shown
}

/// Returns true if a character is invisible or changes the display of others.
pub fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            // Marks of writing direction.
            '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
            // Characters without width: the soft hyphen, separators, invisible operators, and the byte order mark.
            | '\u{ad}' | '\u{180e}' | '\u{200b}' | '\u{2060}'..='\u{2064}' | '\u{feff}'
            // Format characters that Unicode discourages, and marks of annotations.
            | '\u{206a}'..='\u{206f}' | '\u{fff9}'..='\u{fffb}'
            // Line and paragraph separators.
            | '\u{2028}' | '\u{2029}'
            // Noncharacters, which XML does not allow.
            | '\u{fffe}' | '\u{ffff}'
        )
}

/// True if a character joins or separates the shapes of neighbouring letters, as in several scripts.
fn is_joiner(c: char) -> bool {
    matches!(c, '\u{200c}' | '\u{200d}')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An escaped text in quotation marks, read as JSON, gives the original.
    #[test]
    fn escapes_are_those_of_json() {
        let hidden: String = (0..=0xffff)
            .filter_map(char::from_u32)
            .filter(|c| is_hidden(*c))
            .collect();
        assert!(hidden.chars().count() > 70);
        let escaped = shown(&hidden);
        assert!(escaped.is_ascii() && !escaped.contains(is_hidden));
        let read: String = serde_json::from_str(&format!("\"{escaped}\"")).unwrap();
        assert_eq!(read, hidden);
        assert!(
            (0x1_0000..=0x10_ffff)
                .filter_map(char::from_u32)
                .all(|c| !is_hidden(c))
        );
    }

    #[test]
    fn letters_of_all_scripts_stay() {
        let text = "Pont du Gard, \u{5d0}\u{5e8}\u{5db} \u{1f309} \\ \"x\"";
        assert_eq!(shown(text), text);
        assert_eq!(shown_lines("a\n\tb\r"), "a\n\tb\\r");
    }

    #[test]
    fn joiners_stay_where_scripts_need_them() {
        let persian = "\u{645}\u{6cc}\u{200c}\u{631}\u{648}\u{62f}";
        assert_eq!(shown(persian), persian);
        assert_eq!(shown("mea\u{200d}n"), r"mea\u200dn");
        assert_eq!(shown("\u{200c}"), r"\u200c");
    }
}
