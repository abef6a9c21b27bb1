//! Numbers brought into ranges.

/// `value` clamped to `low..=high`; `fallback` replaces NaN.
pub fn within(value: f32, low: f32, high: f32, fallback: f32) -> f32 {
    if value.is_nan() { fallback } else { value.clamp(low, high) }
}

#[cfg(test)]
mod tests {
    use super::within;

    #[test]
    fn values_are_clamped_and_nan_is_replaced() {
        assert_eq!(within(0.5, 0.0, 1.0, 0.25), 0.5);
        assert_eq!(within(-1.0, 0.0, 1.0, 0.25), 0.0);
        assert_eq!(within(f32::INFINITY, 0.0, 1.0, 0.25), 1.0);
        assert_eq!(within(f32::NAN, 0.0, 1.0, 0.25), 0.25);
    }
}
