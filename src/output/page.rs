//! Building blocks of HTML pages.

use serde_json::Value;

use crate::scenario::shown_lines;

/// The name and version of the program, as pages show them.
pub(crate) const PROGRAM: &str = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));

/// Formats JSON for a script of a page: nothing in the text ends the script.
pub(crate) fn script_safe(data: &Value) -> String {
    shown_lines(&data.to_string()).replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_cannot_end_its_script() {
        let text = script_safe(&serde_json::json!({ "title": "</script><b>" }));
        assert_eq!(text, r#"{"title":"\u003c/script>\u003cb>"}"#);
    }
}
