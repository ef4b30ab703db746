//! Units: the suffixes that column names carry, and their factors to SI.
//!
//! The factors of units outside the SI are those of NIST Special Publication 811 (2008), appendix B: the inch is
//! 0.0254 m and the pound-force 4.4482216152605 N exactly; the psi is one pound-force per square inch, rounded to
//! 13 digits; the bar is 10⁵ Pa exactly. In each table the SI unit comes first.

/// A unit as a column name ends with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// The end of the column name, without the underscore before it: `mm_per_s`.
    pub suffix: &'static str,
    factor: f64,
    divisor: f64,
}

impl Unit {
    /// A unit of `factor` SI units.
    const fn times(suffix: &'static str, factor: f64) -> Self {
        Self { suffix, factor, divisor: 1.0 }
    }

    /// A unit that is `divisor` times smaller than the SI unit. Dividing by 1000 rounds once, while a product with
    /// 0.001 rounds twice, so that 3 ms is the same number as 0.003 s.
    const fn over(suffix: &'static str, divisor: f64) -> Self {
        Self { suffix, factor: 1.0, divisor }
    }

    /// A value of this unit in SI units. Values in SI units come back bit for bit.
    #[must_use]
    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor / self.divisor
    }
}

/// Time: s.
pub const TIME: &[Unit] = &[Unit::times("s", 1.0), Unit::over("ms", 1e3)];
/// Length: m.
pub const LENGTH: &[Unit] = &[Unit::times("m", 1.0), Unit::over("mm", 1e3), Unit::times("in", 0.0254)];
/// Velocity: m/s.
pub const VELOCITY: &[Unit] =
    &[Unit::times("m_per_s", 1.0), Unit::over("mm_per_s", 1e3), Unit::times("in_per_s", 0.0254)];
/// Electric current: A.
pub const CURRENT: &[Unit] = &[Unit::times("a", 1.0), Unit::over("ma", 1e3)];
/// Pressure: Pa. Suffixes are in lower case, so `mpa` is the megapascal.
pub const PRESSURE: &[Unit] = &[
    Unit::times("pa", 1.0),
    Unit::times("kpa", 1e3),
    Unit::times("mpa", 1e6),
    Unit::times("bar", 1e5),
    Unit::times("psi", 6_894.757_293_168),
];
/// Force: N.
pub const FORCE: &[Unit] = &[Unit::times("n", 1.0), Unit::times("kn", 1e3), Unit::times("lbf", 4.448_221_615_260_5)];

/// The power of ten of an SI prefix written after a number, as LabVIEW does (`25.1m`), or `None` when the letter is
/// no such prefix.
#[must_use]
pub const fn prefix_exponent(prefix: char) -> Option<i32> {
    Some(match prefix {
        'y' => -24,
        'z' => -21,
        'a' => -18,
        'f' => -15,
        'p' => -12,
        'n' => -9,
        // A keyboard's u, the micro sign and the Greek letter.
        'u' | '\u{b5}' | '\u{3bc}' => -6,
        'm' => -3,
        'k' => 3,
        'M' => 6,
        'G' => 9,
        'T' => 12,
        'P' => 15,
        'E' => 18,
        'Z' => 21,
        'Y' => 24,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to_si(table: &[Unit], suffix: &str, value: f64) -> f64 {
        table.iter().find(|unit| unit.suffix == suffix).unwrap().to_si(value)
    }

    #[test]
    fn validate_psi_is_one_pound_force_per_square_inch() {
        let inch_m = to_si(LENGTH, "in", 1.0);
        let expected = to_si(FORCE, "lbf", 1.0) / (inch_m * inch_m);
        assert!((to_si(PRESSURE, "psi", 1.0) / expected - 1.0).abs() < 1e-13, "{expected}");
    }

    #[test]
    fn validate_one_standard_atmosphere_agrees_in_every_pressure_unit() {
        // NIST SP 811, appendix B.8: 1 atm = 101 325 Pa = 14.69595 psi.
        for (suffix, value) in [("kpa", 101.325), ("mpa", 0.101325), ("bar", 1.01325), ("psi", 14.695_948_775_5)] {
            assert!((to_si(PRESSURE, suffix, value) - 101_325.0).abs() < 1e-5, "{suffix}");
        }
    }

    #[test]
    fn milliseconds_give_the_same_number_as_the_seconds_that_a_person_writes() {
        for k in 0..10_000 {
            let written: f64 = format!("{}.{:03}", k / 1000, k % 1000).parse().unwrap();
            assert_eq!(to_si(TIME, "ms", f64::from(k)).to_bits(), written.to_bits(), "{k} ms");
        }
    }

    #[test]
    fn every_table_begins_with_the_si_unit_and_names_each_unit_once() {
        for table in [TIME, LENGTH, VELOCITY, CURRENT, PRESSURE, FORCE] {
            assert_eq!(table[0].to_si(0.1).to_bits(), 0.1f64.to_bits());
            let mut suffixes: Vec<_> = table.iter().map(|unit| unit.suffix).collect();
            suffixes.sort_unstable();
            suffixes.dedup();
            assert_eq!(suffixes.len(), table.len());
        }
    }
}
