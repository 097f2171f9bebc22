//! Texts and pages from templates, and the format of numbers in them.

use std::any::Any;

use askama::{Template, Values, get_value};

use crate::argument;
use crate::scenario::Language;

/// Fills a template in English. The text begins with its first line, and ends with one line break.
pub(crate) fn render(template: &impl Template) -> String {
    render_in(template, Language::English)
}

/// Fills a template in a language, which its filters `it`, `shown`, `fixed` and `data` read.
pub(crate) fn render_in(template: &impl Template, language: Language) -> String {
    let text = template.render_with_values(&("language", &language as &dyn Any));
    // Writing to a string cannot fail, and the filters do not fail.
    let text = text.expect("templates are written to memory");
    format!("{}\n", text.trim_start_matches('\n').trim_end())
}

/// Returns the language of a template.
fn language(values: &dyn Values) -> Language {
    let language = get_value::<Language>(values, "language");
    language.copied().unwrap_or_default()
}

/// A number of a template; absent ones are printed as "-".
pub(crate) trait Number {
    /// Returns the value; `None` if it is absent.
    fn value(&self) -> Option<f64>;
}

impl Number for f64 {
    fn value(&self) -> Option<f64> {
        Some(*self)
    }
}

impl<N: Number> Number for Option<N> {
    fn value(&self) -> Option<f64> {
        self.as_ref()?.value()
    }
}

impl<N: Number> Number for &N {
    fn value(&self) -> Option<f64> {
        (*self).value()
    }
}

/// Limits with which a number of a template is compared; absent ones do not count.
pub(crate) trait Limits {
    /// Returns the limits.
    fn limits(&self) -> Vec<f64>;
}

impl<N: Number> Limits for N {
    fn limits(&self) -> Vec<f64> {
        self.value().into_iter().collect()
    }
}

impl Limits for [f64; 2] {
    fn limits(&self) -> Vec<f64> {
        self.to_vec()
    }
}

/// Largest number of decimals: more than any two different numbers of a check need.
const MOST_DECIMALS: usize = 30;

/// Returns the fewest decimals, at least `least`, with which a number is printed unlike every limit that it does not equal, so that
/// rounding never contradicts the verdict beside it.
fn decimals_against(number: f64, least: usize, limits: &[f64]) -> usize {
    let differ = |decimals: &usize| {
        let printed = |number| argument::format_fixed(number, *decimals);
        let mut limits = limits.iter();
        limits.all(|limit| *limit == number || printed(*limit) != printed(number))
    };
    let enough = (least..MOST_DECIMALS).find(differ);
    enough.unwrap_or(MOST_DECIMALS)
}

/// Returns an element that shows a number with these decimals and holds the full value.
fn element(number: &impl Number, values: &dyn Values, decimals: impl Fn(f64) -> usize) -> String {
    let Some(number) = number.value() else {
        return "\u{2013}".to_owned();
    };
    let shown = language(values).number(argument::format_fixed(number, decimals(number)));
    // Adding zero makes a negative zero positive.
    format!("<data value=\"{:?}\">{shown}</data>", number + 0.0)
}

/// Filters of templates, such as `{{ force_n|fixed(3)|right(12) }}`.
pub(crate) mod filters {
    use std::fmt::Display;

    use askama::filters::Safe;
    use askama::{Result, Values, filter_fn};

    use super::super::escaped;
    use super::{Limits, Number, decimals_against, element, language};
    use crate::argument;

    /// Chooses between a phrase in English and in Italian.
    #[filter_fn]
    pub fn it(english: &str, values: &dyn Values, italian: &str) -> Result<Safe<String>> {
        Ok(Safe(language(values).choose(english, italian).to_owned()))
    }

    /// Formats a number with its own digits, and the decimal mark of the language.
    #[filter_fn]
    pub fn shown(number: impl Display, values: &dyn Values) -> Result<String> {
        Ok(language(values).number(number.to_string()))
    }

    /// Formats a number with this many decimals; zero has no sign.
    #[filter_fn]
    pub fn fixed(number: impl Number, values: &dyn Values, decimals: usize) -> Result<String> {
        let fixed = |number| language(values).number(argument::format_fixed(number, decimals));
        Ok(number.value().map_or_else(|| "-".to_owned(), fixed))
    }

    /// Formats a number beside its verdict as `fixed`, with more decimals if it would be printed as a limit that it does not equal.
    #[filter_fn]
    pub fn fixed_against<L: Limits>(
        number: impl Number,
        values: &dyn Values,
        least: usize,
        limits: L,
    ) -> Result<String> {
        let text = |number| {
            let decimals = decimals_against(number, least, &limits.limits());
            language(values).number(argument::format_fixed(number, decimals))
        };
        Ok(number.value().map_or_else(|| "-".to_owned(), text))
    }

    /// Formats a number with this many decimals and a power of ten.
    #[filter_fn]
    pub fn scientific(number: impl Number, _: &dyn Values, decimals: usize) -> Result<String> {
        let text = |number: f64| format!("{number:.decimals$e}");
        Ok(number.value().map_or_else(|| "-".to_owned(), text))
    }

    /// Formats a number for a page, with this many decimals, in an element that holds the full value.
    #[filter_fn]
    pub fn data(number: impl Number, values: &dyn Values, decimals: usize) -> Result<Safe<String>> {
        Ok(Safe(element(&number, values, |_| decimals)))
    }

    /// Formats a number beside its verdict as `data`, with more decimals if it would be printed as a limit that it does not equal.
    #[filter_fn]
    pub fn data_against<L: Limits>(
        number: impl Number,
        values: &dyn Values,
        least: usize,
        limits: L,
    ) -> Result<Safe<String>> {
        let decimals = |number| decimals_against(number, least, &limits.limits());
        Ok(Safe(element(&number, values, decimals)))
    }

    /// Escapes text for a page: special characters of HTML and invisible characters.
    #[filter_fn]
    pub fn text(text: impl Display, _: &dyn Values) -> Result<Safe<String>> {
        Ok(Safe(escaped(&text.to_string())))
    }

    /// Formats symbols as in formulas for a page: `a_g,SLD` gets a subscript, `alpha_0` becomes a Greek letter with a subscript.
    #[filter_fn]
    pub fn typeset(text: impl Display, _: &dyn Values) -> Result<Safe<String>> {
        let words = escaped(&text.to_string()).replace("alpha_", "\u{3b1}_");
        let words = words.replace("xi\u{b2}", "\u{3be}\u{b2}");
        let mut parts = words.split('_');
        let mut set = parts.next().unwrap_or_default().to_owned();
        for after in parts {
            // Only a single letter has a subscript.
            let mut letters = set.chars().rev();
            let letter = letters.next().is_some_and(char::is_alphabetic);
            let alone = letter && !letters.next().is_some_and(char::is_alphanumeric);
            let end = after.find(|c: char| !c.is_alphanumeric() && c != ',');
            let index = after[..end.unwrap_or(after.len())].trim_end_matches(',');
            if alone && !index.is_empty() {
                set += &format!("<sub>{index}</sub>{}", &after[index.len()..]);
            } else {
                set = set + "_" + after;
            }
        }
        Ok(Safe(set))
    }

    /// Formats a fraction in percent. A limit that was not reached is not printed as reached: 99.96 % becomes "above 99.9 %".
    #[filter_fn]
    pub fn percent(part: &f64, _: &dyn Values, decimals: i32) -> Result<String> {
        let (percent, step) = (100.0 * part, 10_f64.powi(-decimals));
        let digits = decimals as usize;
        Ok(if *part < 1.0 && percent > 100.0 - 0.5 * step {
            format!("above {:.digits$} %", 100.0 - step)
        } else if decimals == 0 && percent < 1.0 {
            "below 1 %".to_owned()
        } else {
            format!("{percent:.digits$} %")
        })
    }

    /// Formats a number with the fewest digits that read back as the same number.
    #[filter_fn]
    pub fn exact(number: &f64, _: &dyn Values) -> Result<String> {
        Ok(format!("{number:?}"))
    }

    /// Formats forces in N as a list in kN.
    #[filter_fn]
    pub fn kilonewtons(forces_n: &[f64], _: &dyn Values) -> Result<String> {
        let forces = forces_n.iter().map(|force_n| 1e-3 * force_n);
        let forces = forces.map(|force_kn| format!("{} kN", argument::format_fixed(force_kn, 3)));
        Ok(forces.collect::<Vec<_>>().join(", "))
    }

    /// Pads text with blanks on the right to this width.
    #[filter_fn]
    pub fn left(text: impl Display, _: &dyn Values, width: usize) -> Result<String> {
        Ok(format!("{:<width$}", text.to_string()))
    }

    /// Pads text with blanks on the left to this width.
    #[filter_fn]
    pub fn right(text: impl Display, _: &dyn Values, width: usize) -> Result<String> {
        Ok(format!("{:>width$}", text.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use askama::Template;

    use super::filters;

    #[derive(Template)]
    #[template(source = "{{ text|typeset }}; {{ number|data(2) }}", ext = "html")]
    struct Page {
        text: &'static str,
        number: f64,
    }

    #[test]
    fn symbols_have_indices_and_numbers_keep_their_value() {
        let text = "q times a_g,SLD, alpha_0 g/e* & S_eZ; give free_standing, T_C*";
        let set = "q times a<sub>g,SLD</sub>, \u{3b1}<sub>0</sub> g/e* &amp; S<sub>eZ</sub>; give free_standing, T<sub>C</sub>*; ";
        for (number, shown) in [
            (-1e-9, "<data value=\"-1e-9\">0.00</data>"),
            (1.0 / 3.0, "<data value=\"0.3333333333333333\">0.33</data>"),
        ] {
            let page = Page { text, number }.render().unwrap();
            assert_eq!(page, format!("{set}{shown}"));
        }
    }
}
