//! The oil's density and viscosity by temperature.
//!
//! Source: section 4.1.3, figure 4.13 (look-up tables; the thesis prints no values). Viscosities: the limits that
//! MIL-PRF-5606H and MIL-PRF-83282D set, as they are commonly quoted: the lower one at 40 °C and above, the upper one in
//! the cold. Neither specification's table was at hand, so that these eight figures are not confirmed, nor are the
//! densities (850 and 833 kg/m³ at 40 °C) and their expansions (8.3e-4 and 8.2e-4 per kelvin), which are typical values.
//! What was found agrees: a mineral oil of this kind serves from -54 to 135 °C (GJB 1177-1991), and in the cold where the
//! synthetic one is too thick (TM 1-1500-204-23-2, chapter 2).
//! Signs: none.
//! Range: the tables' temperatures; beyond, the viscosity keeps the end's value and the density goes on.
//! Limits: no effect of pressure; an oil in use differs from the limit, thicker at 40 °C and thinner in the cold.

use serde::{Deserialize, Serialize};

use crate::models::checks::Checks;

/// Which oil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Oil {
    /// The density and viscosity of `reference.fluid`, at any temperature.
    Constant,
    /// Mineral oil.
    #[serde(rename = "mil_prf_5606")]
    MilPrf5606,
    /// Synthetic hydrocarbon.
    #[serde(rename = "mil_prf_83282")]
    MilPrf83282,
}

/// The oil and how warm it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Which oil.
    pub oil: Oil,
    /// Temperature, K.
    pub temperature_k: f64,
}

/// Density, kg/m³, and kinematic viscosity, m²/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Properties {
    /// Density, kg/m³.
    pub density_kg_per_m3: f64,
    /// Kinematic viscosity, m²/s.
    pub kinematic_viscosity_m2_per_s: f64,
}

/// Temperature in °C, kinematic viscosity in mm²/s.
const MIL_PRF_5606: [(f64, f64); 4] = [(-54.0, 2500.0), (-40.0, 600.0), (40.0, 13.2), (100.0, 4.9)];
/// Temperature in °C, kinematic viscosity in mm²/s.
const MIL_PRF_83282: [(f64, f64); 4] = [(-40.0, 2200.0), (40.0, 14.0), (100.0, 3.45), (205.0, 1.0)];
const ZERO_CELSIUS_K: f64 = 273.15;

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("reference.oil.temperature_k", self.temperature_k, 213.15, 478.15, "K");
    }

    /// The oil's properties, or `constant` where they do not depend on the temperature.
    #[must_use]
    pub fn properties(&self, constant: Properties) -> Properties {
        let celsius = self.temperature_k - ZERO_CELSIUS_K;
        let (table, density_at_40, expansion_per_k) = match self.oil {
            Oil::Constant => return constant,
            Oil::MilPrf5606 => (&MIL_PRF_5606, 850.0, 8.3e-4),
            Oil::MilPrf83282 => (&MIL_PRF_83282, 833.0, 8.2e-4),
        };
        Properties {
            density_kg_per_m3: density_at_40 / (1.0 + expansion_per_k * (celsius - 40.0)),
            kinematic_viscosity_m2_per_s: viscosity_mm2_per_s(table, celsius) * 1e-6,
        }
    }
}

/// The viscosity between two entries: straight in log log (nu + 0.7) over log T, the scales of ASTM D341.
fn viscosity_mm2_per_s(table: &[(f64, f64)], celsius: f64) -> f64 {
    let celsius = celsius.max(table[0].0).min(table[table.len() - 1].0);
    let above = table.partition_point(|&(t, _)| t < celsius).clamp(1, table.len() - 1);
    let ((t0, nu0), (t1, nu1)) = (table[above - 1], table[above]);
    let scale = |nu: f64| (nu + 0.7).log10().log10();
    let place = |t: f64| (t + ZERO_CELSIUS_K).log10();
    let part = (place(celsius) - place(t0)) / (place(t1) - place(t0));
    let scaled = scale(nu0) + part * (scale(nu1) - scale(nu0));
    10f64.powf(10f64.powf(scaled)) - 0.7
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONSTANT: Properties = Properties { density_kg_per_m3: 850.0, kinematic_viscosity_m2_per_s: 1.4e-5 };

    fn at(oil: Oil, celsius: f64) -> Properties {
        Params { oil, temperature_k: celsius + ZERO_CELSIUS_K }.properties(CONSTANT)
    }

    #[test]
    fn validate_the_table_entries_come_back() {
        for (oil, table) in [(Oil::MilPrf5606, MIL_PRF_5606), (Oil::MilPrf83282, MIL_PRF_83282)] {
            for (celsius, mm2_per_s) in table {
                let nu = at(oil, celsius).kinematic_viscosity_m2_per_s * 1e6;
                assert!((nu / mm2_per_s - 1.0).abs() < 1e-9, "{oil:?} at {celsius}: {nu}");
            }
        }
    }

    #[test]
    fn beyond_its_ends_a_table_keeps_the_end_s_viscosity() {
        for (oil, table) in [(Oil::MilPrf5606, MIL_PRF_5606), (Oil::MilPrf83282, MIL_PRF_83282)] {
            let (coldest, warmest) = (table[0].0, table[table.len() - 1].0);
            let viscosity = |celsius: f64| at(oil, celsius).kinematic_viscosity_m2_per_s;
            assert_eq!(viscosity(coldest - 6.0), viscosity(coldest));
            assert_eq!(viscosity(warmest + 100.0), viscosity(warmest));
            assert!(at(oil, coldest - 6.0).density_kg_per_m3 > at(oil, coldest).density_kg_per_m3);
        }
    }

    #[test]
    fn a_warmer_oil_is_thinner_and_lighter() {
        for oil in [Oil::MilPrf5606, Oil::MilPrf83282] {
            let all: Vec<Properties> = (-4..=10).map(|tens| at(oil, 10.0 * f64::from(tens))).collect();
            for two in all.windows(2) {
                assert!(two[1].kinematic_viscosity_m2_per_s < two[0].kinematic_viscosity_m2_per_s);
                assert!(two[1].density_kg_per_m3 < two[0].density_kg_per_m3);
            }
        }
        assert_eq!(at(Oil::Constant, -40.0), CONSTANT);
    }
}
