//! How long the reference model's load pressure takes to settle with spool and flow imposed, and the thesis's two forms
//! for it: a bell over the spool's position, and a growth of its peak with the flow.
//!
//! Source: section 5.3, figures 5.10 to 5.12: the time to within 5000 Pa of the final value.
//! Signs: docs/conventions.md.
//! Range: ±0.6 mm and ±6e-6 m³/s, as in the thesis's plots.
//! Limits: the bell knows no dent at null, where the final value is so small that 5000 Pa are soon reached; it is fitted
//! from the zero-flow curve's peak outwards. Its three constants are two in truth: c is the thesis's, so that a and b compare.

use rayon::prelude::*;
use serde::Serialize;

use super::curves::{FLOWS_M3_PER_S, grid_m};
use super::valve::Valve;
use crate::models::parameters::ParameterSet;
use crate::numeric::watch::Watch;
use crate::optimiser::polish::simplex::{self, Simplex};
use crate::optimiser::{Bounds, Search};

/// How close to its final value the pressure counts as settled, Pa.
pub const TOLERANCE_PA: f64 = 5000.0;
/// The thesis's a, b and c.
pub const THESIS_BELL: [f64; 3] = [5.6, 1.2, 4.0];
/// The thesis's growth of the peak with the flow, s/m³.
pub const THESIS_SLOPE_S_PER_M3: f64 = 0.5 / 3e-6;
/// Flow magnitudes at which the peak is taken, m³/s.
const PEAK_FLOWS_M3_PER_S: [f64; 5] = [0.0, 1.5e-6, 3e-6, 4.5e-6, 6e-6];
/// The most of b that is sought, and the search's end.
const BELL_B_MAX: f64 = 100.0;
const FIT: simplex::Settings = simplex::Settings { width: 0.1, width_min: 1e-9, iterations: 500, cost_enough: 0.0 };

/// Settling times over the spool's position at one flow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Times {
    /// The jack's flow, m³/s.
    pub jack_flow_m3_per_s: f64,
    /// Spool positions, m, rising.
    pub spool_position_m: Vec<f64>,
    /// Settling times, s; `None` where the pressure never settles.
    pub settling_s: Vec<Option<f64>>,
}

impl Times {
    /// The longest settling time, s, and where, m.
    #[must_use]
    pub fn peak(&self) -> Option<(f64, f64)> {
        let known = self.spool_position_m.iter().zip(&self.settling_s).filter_map(|(x, t)| t.map(|t| (t, *x)));
        known.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// The bell a/(b (XS/XSS)² + c), s, beside the zero-flow times.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bell {
    /// Numerator, s.
    pub a_s: f64,
    /// Factor of the squared spool position.
    pub b: f64,
    /// Constant: the thesis's.
    pub c: f64,
    /// Root of the mean squared difference, s.
    pub rms_s: f64,
    /// The largest difference, s.
    pub worst_s: f64,
    /// Where that is, m.
    pub worst_at_m: f64,
}

/// The growth 1 + a|QJ| of the peak.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// a, s/m³.
    pub slope_s_per_m3: f64,
    /// Flow magnitudes, m³/s.
    pub flow_m3_per_s: Vec<f64>,
    /// Peaks over the zero-flow peak at each of them.
    pub ratio: Vec<f64>,
    /// Root of the mean squared difference of the ratio, dimensionless.
    pub rms: f64,
    /// The largest difference of the ratio, dimensionless.
    pub worst: f64,
}

/// The map and its fits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settling {
    /// The map, a curve for each of the pressure curves' flows.
    pub times: Vec<Times>,
    /// XSS, by which the bell is drawn, m.
    pub spool_saturation_m: f64,
    /// The bell at zero flow.
    pub bell: Bell,
    /// The growth of its peak.
    pub growth: Growth,
}

/// Why there is no map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SettlingError {
    /// No settling time at a flow.
    #[error("the pressure settles nowhere between -0.6 and 0.6 mm")]
    NeverSettles,
    /// The watcher asked for an end.
    #[error("cancelled")]
    Cancelled,
}

/// Computes a set's map and fits. The same set gives the same map, whatever the number of threads.
///
/// # Errors
/// A valve whose pressure settles nowhere, or cancellation by `watch`.
pub fn settling(set: &ParameterSet, watch: &dyn Watch) -> Result<Settling, SettlingError> {
    let valve = Valve::new(set);
    let spool_saturation_m = set.monitoring_model().fluid.spool_saturation_m;
    let flows = FLOWS_M3_PER_S.into_iter().chain(PEAK_FLOWS_M3_PER_S);
    let mut maps = Vec::new();
    for (done, flow) in flows.enumerate() {
        if watch.cancelled() {
            return Err(SettlingError::Cancelled);
        }
        maps.push(times(&valve, flow));
        watch.progress((done + 1) as f64 / (FLOWS_M3_PER_S.len() + PEAK_FLOWS_M3_PER_S.len()) as f64);
    }
    let at_peaks = maps.split_off(FLOWS_M3_PER_S.len());
    Ok(Settling {
        bell: bell(&at_peaks[0], spool_saturation_m)?,
        growth: growth(&at_peaks)?,
        times: maps,
        spool_saturation_m,
    })
}

fn times(valve: &Valve, jack_flow_m3_per_s: f64) -> Times {
    let spool_position_m = grid_m();
    let settling_s =
        spool_position_m.par_iter().map(|&x| valve.settling_s(x, jack_flow_m3_per_s, TOLERANCE_PA)).collect();
    Times { jack_flow_m3_per_s, spool_position_m, settling_s }
}

/// The least squares of the bell from the peak outwards.
fn bell(at_zero: &Times, spool_saturation_m: f64) -> Result<Bell, SettlingError> {
    let (peak_s, peak_m) = at_zero.peak().filter(|peak| peak.0 > 0.0).ok_or(SettlingError::NeverSettles)?;
    let points: Vec<(f64, f64)> = at_zero
        .spool_position_m
        .iter()
        .zip(&at_zero.settling_s)
        .filter_map(|(&x, t)| t.filter(|_| x.abs() >= peak_m.abs()).map(|t| (x, t)))
        .collect();
    let c = THESIS_BELL[2];
    let value_s = |a_s: f64, b: f64, x: f64| a_s / (b * (x / spool_saturation_m).powi(2) + c);
    let mean_square = |a_s: f64, b: f64| {
        points.iter().map(|&(x, t)| (value_s(a_s, b, x) - t).powi(2)).sum::<f64>() / points.len() as f64
    };
    let bounds = Bounds::new(&[(0.1 * c * peak_s, 10.0 * c * peak_s), (0.0, BELL_B_MAX)]);
    let mut search = Simplex::new(&bounds, &[c * peak_s, 1.0], FIT);
    while search.stop().is_none() {
        let costs: Vec<f64> = search.ask().iter().map(|at| mean_square(at[0], at[1])).collect();
        search.tell(&costs);
    }
    let (a_s, b) = (search.best().candidate[0], search.best().candidate[1]);
    let off = |&(x, t): &(f64, f64)| ((value_s(a_s, b, x) - t).abs(), x);
    let (worst_s, worst_at_m) = points.iter().map(off).fold((0.0, 0.0), |w, p| if p.0 > w.0 { p } else { w });
    Ok(Bell { a_s, b, c, rms_s: mean_square(a_s, b).sqrt(), worst_s, worst_at_m })
}

/// The least squares of the peaks' growth, through one at zero flow.
fn growth(maps: &[Times]) -> Result<Growth, SettlingError> {
    let peaks: Option<Vec<f64>> = maps.iter().map(|map| map.peak().map(|peak| peak.0)).collect();
    let peaks = peaks.filter(|peaks| peaks[0] > 0.0).ok_or(SettlingError::NeverSettles)?;
    let flow_m3_per_s: Vec<f64> = maps.iter().map(|map| map.jack_flow_m3_per_s).collect();
    let ratio: Vec<f64> = peaks.iter().map(|peak| peak / peaks[0]).collect();
    let moment: f64 = flow_m3_per_s.iter().zip(&ratio).map(|(q, r)| q * (r - 1.0)).sum();
    let slope_s_per_m3 = moment / flow_m3_per_s.iter().map(|q| q * q).sum::<f64>();
    let off: Vec<f64> = flow_m3_per_s.iter().zip(&ratio).map(|(q, r)| (1.0 + slope_s_per_m3 * q - r).abs()).collect();
    let rms = (off.iter().map(|o| o * o).sum::<f64>() / off.len() as f64).sqrt();
    let worst = off.iter().copied().fold(0.0, f64::max);
    Ok(Growth { slope_s_per_m3, flow_m3_per_s, ratio, rms, worst })
}
