//! Building blocks of HTML pages.

use serde_json::Value;

pub(crate) use super::text::escaped;
use crate::scenario::shown_lines;

/// Fills a template: each name between `%` signs is replaced by its text. Inserted texts are not searched for names.
pub(crate) fn filled(template: &str, texts: &[(&str, &str)]) -> String {
    let (mut page, mut is_name) = (String::new(), true);
    for part in template.split('%') {
        let named = texts.iter().find(|(name, _)| *name == part);
        // A sign that does not enclose a name is part of the page.
        if !is_name && named.is_none() {
            page.push('%');
        }
        page += named.map_or(part, |(_, text)| text);
        is_name = named.is_some();
    }
    page
}

/// Formats JSON for a script of a page: nothing in the text ends the script.
pub(crate) fn script_safe(data: &Value) -> String {
    shown_lines(&data.to_string()).replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_filled_once() {
        let page = filled("100 % of %A%, %B% and %C%", &[("A", "%B%"), ("B", "b")]);
        assert_eq!(page, "100 % of %B%, b and %C%");
    }

    #[test]
    fn data_cannot_end_its_script() {
        let text = script_safe(&serde_json::json!({ "title": "</script><b>" }));
        assert_eq!(text, r#"{"title":"\u003c/script>\u003cb>"}"#);
    }
}
