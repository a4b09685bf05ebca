//! Printing of metrics.

use crate::cli::common::Common;
use crate::cli::output::{print_json, print_styled};
use serde::Serialize;

/// Prints JSON, or a text for people.
pub(super) fn print_found(
    common: &Common,
    found: &impl Serialize,
    text: impl FnOnce() -> String,
) -> anyhow::Result<()> {
    if common.json {
        return print_json(found, false);
    }
    print_styled(&text())
}

/// A number with four significant digits.
pub(super) fn digits(value: f64) -> String {
    let whole = digits_before_the_point(value.abs());
    format!("{value:.*}", 4usize.saturating_sub(whole))
}

/// Digits before the point.
fn digits_before_the_point(mut value: f64) -> usize {
    let mut count = 0;
    while value >= 1.0 && count < 20 {
        value /= 10.0;
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let shown = [0.0, 0.00123, 0.5, 1.0, 12.3456, -123.456, 98765.4].map(digits);
        assert_eq!(shown, ["0.0000", "0.0012", "0.5000", "1.000", "12.35", "-123.5", "98765"]);
    }
}
