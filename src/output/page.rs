//! Building blocks of HTML pages.

use serde::Serialize;

use crate::scenario::shown_lines;

/// The name and version of the program, as pages show them.
pub(crate) const PROGRAM: &str = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));

/// Scripts and styles of pages with a moving structure and curves over time. The scripts share one scope, in this order; the script of a page follows
/// them and calls `createPlayer` with its motion and its curves.
pub(crate) const BASE: &str = include_str!("page/base.js");
pub(crate) const STAGE: &str = include_str!("page/stage.js");
pub(crate) const PLOTS: &str = include_str!("page/plots.js");
pub(crate) const PLAYER: &str = include_str!("page/player.js");
pub(crate) const STYLE: &str = include_str!("page/page.css");
// uPlot, the library that draws the curves.
pub(crate) const PLOT_STYLE: &str = include_str!("../../vendor/uplot/uPlot.min.css");
pub(crate) const PLOT_SCRIPT: &str = include_str!("../../vendor/uplot/uPlot.iife.min.js");
pub(crate) const PLOT_LICENCE: &str = include_str!("../../vendor/uplot/LICENSE");

/// Formats data as JSON for a script of a page: nothing in the text ends the script.
pub(crate) fn script_safe(data: &impl Serialize) -> String {
    let json = serde_json::to_string(data).expect("data of a page have names as keys");
    shown_lines(&json).replace('<', "\\u003c")
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
