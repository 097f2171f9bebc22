//! Words and pages from templates, and how numbers are printed in them.

use askama::Template;

/// The text of a template, which ends with one line break.
pub(crate) fn render(template: &impl Template) -> String {
    let text = template.render();
    // Writing to a string cannot fail, and neither do the filters.
    let text = text.expect("templates are written to memory");
    format!("{}\n", text.trim())
}

/// A number of a template: absent ones are printed as "-".
pub(crate) trait Number {
    /// The value, if there is one.
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

/// Filters of templates, such as `{{ force_n|fixed(3)|right(12) }}`.
pub(crate) mod filters {
    use std::fmt::Display;

    use askama::{Result, Values, filter_fn};

    use super::Number;
    use crate::argument;

    /// With this many decimals; zero has no sign.
    #[filter_fn]
    pub fn fixed(number: impl Number, _: &dyn Values, decimals: usize) -> Result<String> {
        let fixed = |number| argument::fixed(number, decimals);
        Ok(number.value().map_or_else(|| "-".to_owned(), fixed))
    }

    /// With the fewest digits that read back as the same number.
    #[filter_fn]
    pub fn exact(number: &f64, _: &dyn Values) -> Result<String> {
        Ok(format!("{number:?}"))
    }

    /// Forces in N as a list in kN.
    #[filter_fn]
    pub fn kilonewtons(forces_n: &[f64], _: &dyn Values) -> Result<String> {
        let forces = forces_n.iter().map(|force_n| 1e-3 * force_n);
        let forces = forces.map(|force_kn| format!("{} kN", argument::fixed(force_kn, 6)));
        Ok(forces.collect::<Vec<_>>().join(", "))
    }

    /// Padded with blanks on the right to a column of this width.
    #[filter_fn]
    pub fn left(text: impl Display, _: &dyn Values, width: usize) -> Result<String> {
        Ok(format!("{:<width$}", text.to_string()))
    }

    /// Padded with blanks on the left, so that it ends at the right of a column of this width.
    #[filter_fn]
    pub fn right(text: impl Display, _: &dyn Values, width: usize) -> Result<String> {
        Ok(format!("{:>width$}", text.to_string()))
    }
}
