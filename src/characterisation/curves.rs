//! The characteristic curves: load pressure and flow over the spool's position, of the reference model's valve and of
//! the monitoring model's fluids.
//!
//! Source: sections 3.2 and 4.1.3 (figures 3.4, 4.16, 4.17), figures 5.2, 5.5, 5.8 and 5.9.
//! Signs: docs/conventions.md.
//! Range: ±0.6 mm, as in the thesis; closer points near null, where the curves bend.
//! Limits: the set's own supply. The flow is the net one into chamber 1 through the passages alone: with P1 at the return
//! pressure it vanishes while chamber 1 is open to the return, at the supply pressure while it is open to the supply,
//! which are the two horizontal segments of figure 3.4 b.

use rayon::prelude::*;
use serde::Serialize;

use super::valve::Valve;
use crate::models::monitoring::fluid::{Block, FluidModel};
use crate::models::parameters::ParameterSet;

/// The jack's flows of the pressure curves, m³/s. The thesis prints -6, -3, 0, 3 and 6 m³/s without the power of ten:
/// section 5.3 calibrates the loss at 4.5e-6 m³/s, midway between 3e-6 and 6e-6, and says that the settling time's peak
/// grows by a half at 3e-6.
pub const FLOWS_M3_PER_S: [f64; 5] = [-6e-6, -3e-6, 0.0, 3e-6, 6e-6];
/// Spool positions as (up to this one, in steps of), µm.
const GRID_UM: [(u32, u32); 3] = [(50, 1), (150, 5), (600, 25)];
/// The distance from null over which the gains are taken, m.
const GAIN_REACH_M: f64 = 1e-6;
/// The spool positions between which the open valve's flow gain is taken, m.
const OPEN_M: (f64, f64) = (0.1e-3, 0.6e-3);

/// Whose curve it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CurveModel {
    /// The reference model's valve.
    Reference,
    /// Section 5.1's fluid.
    Linear,
    /// Section 5.2's fluid.
    Evolved,
    /// Section 5.3's fluid; the lag does not show in a steady state.
    Developed,
}

impl CurveModel {
    /// Every model, the reference first.
    pub const ALL: [Self; 4] = [Self::Reference, Self::Linear, Self::Evolved, Self::Developed];
}

/// One curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// Whose.
    pub model: CurveModel,
    /// What is constant along it, in words.
    pub label: String,
    /// What is constant along it: the jack's flow, m³/s, or the pressure of chamber 1, Pa.
    pub constant: f64,
    /// Spool positions, m, rising.
    pub x: Vec<f64>,
    /// Load pressures, Pa, or flows, m³/s.
    pub y: Vec<f64>,
}

/// A model's gains at null (section 3.2, figure 3.5), as slopes over ±1 µm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gains {
    /// Whose.
    pub model: CurveModel,
    /// GP: the slope of the pressure curve at zero flow, Pa/m.
    pub pressure_gain_pa_per_m: f64,
    /// GQ: the slope of the flow curve at zero load pressure, m²/s. An overlapped valve's is small; the developed fluid's
    /// is that of a square root and depends on the reach.
    pub flow_gain_m2_per_s: f64,
    /// The mean slope of the flow curve at zero load pressure between 0.1 and 0.6 mm, m²/s.
    pub open_flow_gain_m2_per_s: f64,
}

/// All curves of a set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curves {
    /// P12 over XS at five flows, every model.
    pub pressure: Vec<Series>,
    /// QJ over XS at five pressures of chamber 1, every model.
    pub flow: Vec<Series>,
    /// The gains, every model.
    pub gains: Vec<Gains>,
}

/// Computes a set's curves. The same set gives the same curves, whatever the number of threads.
#[must_use]
pub fn curves(set: &ParameterSet) -> Curves {
    let models = CurveModel::ALL.map(|model| Source::new(set, model));
    let grid = grid_m();
    let each = |constants: &[f64], label: fn(f64) -> String, y: fn(&Source, f64, f64) -> f64| {
        let all: Vec<(&Source, f64)> = models.iter().flat_map(|m| constants.iter().map(move |&c| (m, c))).collect();
        all.par_iter()
            .map(|&(source, constant)| Series {
                model: source.model,
                label: label(constant),
                constant,
                x: grid.clone(),
                y: grid.iter().map(|&x| y(source, x, constant)).collect(),
            })
            .collect()
    };
    Curves {
        pressure: each(&FLOWS_M3_PER_S, |q| format!("QJ = {:.0}e-6 m3/s", q * 1e6), Source::load_pressure_pa),
        flow: each(&port_1_pressures_pa(set), |pa| format!("P1 = {:.1} MPa", pa * 1e-6), Source::flow_m3_per_s),
        gains: models.iter().map(Source::gains).collect(),
    }
}

/// The pressures of chamber 1 for the flow curves, Pa: from return to supply in quarters.
#[must_use]
pub fn port_1_pressures_pa(set: &ParameterSet) -> [f64; 5] {
    let fluid = &set.reference_model().fluid;
    let quarter_pa = (fluid.supply_pressure_pa - fluid.return_pressure_pa) / 4.0;
    [0.0, 1.0, 2.0, 3.0, 4.0].map(|quarters| fluid.return_pressure_pa + quarters * quarter_pa)
}

/// The spool positions, m.
#[must_use]
pub fn grid_m() -> Vec<f64> {
    let mut positive_um = Vec::new();
    let mut at_um = 0;
    for (end_um, step_um) in GRID_UM {
        while at_um < end_um {
            at_um += step_um;
            positive_um.push(at_um);
        }
    }
    let negative = positive_um.iter().rev().map(|&um| -f64::from(um));
    let positive = positive_um.iter().map(|&um| f64::from(um));
    negative.chain([0.0]).chain(positive).map(|um| um * 1e-6).collect()
}

/// Where a model's curves come from.
struct Source {
    model: CurveModel,
    valve: Valve,
    fluid: Option<Block>,
}

impl Source {
    fn new(set: &ParameterSet, model: CurveModel) -> Self {
        let fluid = match model {
            CurveModel::Reference => None,
            CurveModel::Linear => Some(FluidModel::Linear),
            CurveModel::Evolved => Some(FluidModel::Evolved),
            CurveModel::Developed => Some(FluidModel::Developed),
        };
        let fluid = fluid.map(|fluid| Block::new(&set.monitoring_model().fluid, fluid));
        Self { model, valve: Valve::new(set), fluid }
    }

    fn load_pressure_pa(&self, spool_position_m: f64, jack_flow_m3_per_s: f64) -> f64 {
        match &self.fluid {
            None => self.valve.steady(spool_position_m, jack_flow_m3_per_s).load_pressure_pa(),
            Some(fluid) => fluid.steady_pa(spool_position_m, jack_flow_m3_per_s, 1.0),
        }
    }

    fn flow_m3_per_s(&self, spool_position_m: f64, port_1_pa: f64) -> f64 {
        match &self.fluid {
            None => self.valve.flow_m3_per_s(spool_position_m, port_1_pa),
            Some(fluid) => fluid.flow_m3_per_s(spool_position_m, 2.0 * port_1_pa - self.valve.pressure_sum_pa()),
        }
    }

    fn gains(&self) -> Gains {
        let centre_pa = 0.5 * self.valve.pressure_sum_pa();
        let slope = |of: &dyn Fn(f64) -> f64, from_m: f64, to_m: f64| (of(to_m) - of(from_m)) / (to_m - from_m);
        let pressure = |x: f64| self.load_pressure_pa(x, 0.0);
        let flow = |x: f64| self.flow_m3_per_s(x, centre_pa);
        Gains {
            model: self.model,
            pressure_gain_pa_per_m: slope(&pressure, -GAIN_REACH_M, GAIN_REACH_M),
            flow_gain_m2_per_s: slope(&flow, -GAIN_REACH_M, GAIN_REACH_M),
            open_flow_gain_m2_per_s: slope(&flow, OPEN_M.0, OPEN_M.1),
        }
    }
}
