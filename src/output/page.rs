//! Building blocks of HTML pages.

use serde_json::Value;

pub(crate) use super::text::escaped;
use crate::scenario::shown_lines;

/// Fills a template: each name between `%` signs is replaced by its text. Inserted texts are not searched for names.
pub(crate) fn fill_template(template: &str, texts: &[(&str, &str)]) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('%') {
        page += before;
        let place = after.split_once('%').and_then(|(name, after)| {
            let (_, text) = texts.iter().find(|(known, _)| *known == name)?;
            Some((text, after))
        });
        rest = match place {
            Some((text, after)) => {
                page += text;
                after
            }
            None => {
                page.push('%');
                after
            }
        };
    }
    page + rest
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
        let page = fill_template("100 % of %A%, %B% and %C%", &[("A", "%B%"), ("B", "b")]);
        assert_eq!(page, "100 % of %B%, b and %C%");
        let texts = [("A", "1"), ("B", "2")];
        assert_eq!(fill_template("half of %A", &texts), "half of %A");
        assert_eq!(fill_template("%A%B%C", &texts), "1B%C");
    }

    #[test]
    fn data_cannot_end_its_script() {
        let text = script_safe(&serde_json::json!({ "title": "</script><b>" }));
        assert_eq!(text, r#"{"title":"\u003c/script>\u003cb>"}"#);
    }
}
