//! How numbers are written.

/// Three significant digits.
pub(super) fn digits(number: f64) -> String {
    let decimals = if number < 10.0 { 2 } else { usize::from(number < 100.0) };
    if number < 1.0 { format!("{number:.3}") } else { format!("{number:.decimals$}") }
}

/// A whole number with spaces between thousands.
pub(super) fn grouped(number: f64) -> String {
    let plain = format!("{number:.0}");
    let mut text = String::new();
    for (k, digit) in plain.chars().enumerate() {
        if k > 0 && (plain.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Three digits at most after the point, without zeros at the end.
pub(super) fn short(number: f64) -> String {
    let text = format!("{number:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// One digit after the point, with an exponent.
pub(super) fn small(number: f64) -> String {
    if number == 0.0 { "0".into() } else { format!("{number:.1e}") }
}

/// A number in some way; empty where there is none.
pub(super) fn number(value: Option<f64>, format: fn(f64) -> String) -> String {
    value.map_or_else(String::new, format)
}

/// A number as CSV has it; empty where there is none.
pub(super) fn cell<T: ToString>(number: Option<T>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}
