//! Numbers as people read them.

/// Writes a number with three digits and a prefix.
///
/// ```
/// assert_eq!(lahar_lab::numbers::with_prefix(12_345_678.0), "12.3 M");
/// ```
pub fn with_prefix(number: f64) -> String {
    let (scaled, prefix) = match number {
        n if n >= 1e9 => (n / 1e9, " G"),
        n if n >= 1e6 => (n / 1e6, " M"),
        n if n >= 1e3 => (n / 1e3, " k"),
        n => (n, ""),
    };
    let digits = if scaled >= 100.0 || scaled == 0.0 {
        0
    } else if scaled >= 10.0 {
        1
    } else {
        2
    };
    format!("{scaled:.digits$}{prefix}")
}

/// Writes a duration \[s\] for people.
///
/// ```
/// use lahar_lab::numbers::duration;
///
/// assert_eq!(duration(4.2), "4.2 s");
/// assert_eq!(duration(3725.0), "1 h 02 min");
/// ```
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(with_prefix(0.0), "0");
        assert_eq!(with_prefix(12_345_678.0), "12.3 M");
        assert_eq!(with_prefix(999.0), "999");
        assert_eq!(with_prefix(1.5e9), "1.50 G");
        assert_eq!(duration(3.25), "3.2 s");
        assert_eq!(duration(200.0), "3 min 20 s");
        assert_eq!(duration(3725.0), "1 h 02 min");
    }
}
