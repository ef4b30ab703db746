//! The fit of the monitoring model to a reference model, as chapter 5 did it.
//!
//! Source: section 5.3: GP from the zero-flow pressure curve, GQ and Clk as a compromise that agrees with the reference
//! model; section 7.2: the features' bias.
//! Signs: docs/conventions.md.
//! Range: actuators that show the diagnostic features (`diagnostic`).
//! Limits: the bell and its growth, the flow of reference and the dead band stay what they are in the set.
//!
//! XSS: least squares of PSR tanh(XS/XSS) on the reference valve's zero-flow pressure, evenly over ±0.6 mm. GQ, at any
//! Clk: the flow of the ramp at the reference model's own spool opening, so that what is left of the current is the flow
//! force that this model lacks, a ratio. Clk: least squares of the pressure feature, and enough for the fine step. The
//! lag's scale: the jack's mass on the lagged pressure is damped by a tenth of the critical on the ramp. The flow gains
//! of 5.1 and 5.2: the ramp's current, but no less than what the time step can follow. The bias: measured at levels that
//! no fit has seen, as a mean and as a surface over the levels ([`super::bias`]).

use std::sync::atomic::{AtomicUsize, Ordering};

use super::bias;
use super::derived::derived;
use super::diagnostic::{self, Features, Level, TIME_STEP_S};
use super::report::{Fitted, FluidResiduals, ZeroFlow};
use super::valve::Valve;
use crate::models::blocks::Shared;
use crate::models::checks::ParamsError;
use crate::models::monitoring::fluid::FluidModel;
use crate::models::monitoring::{self, Bias, Model, fluid};
use crate::models::parameters::ParameterSet;
use crate::numeric::watch::{Stretch, Watch};
use crate::optimiser::polish::simplex::{self, Simplex};
use crate::optimiser::{Bounds, Search};

/// The part of the progress that is made before the surface of the bias, which takes most of the runs.
const BEFORE_SURFACE: f64 = 0.35;
/// Chapter 6's levels, at which the values are fitted.
const KGM: [f64; 5] = [0.0, 0.1, 0.2, 0.3, 0.4];
/// Chapter 6's levels, N.
const FDJ_N: [f64; 5] = [200.0, 400.0, 600.0, 800.0, 1000.0];
/// The ramp of the diagnostic command, m/s.
const RAMP_M_PER_S: f64 = 0.1;
/// Damping ratio of the jack's mass on the lagged pressure on the ramp: chosen. The lag does not show in the features; less
/// damping lets the model stick and slip falsely, more makes the large step less exact.
const LAG_DAMPING_RATIO: f64 = 0.1;
/// By how much the flow gains of 5.1 and 5.2 stay above the least that the time step can follow.
const STABLE_MARGIN: f64 = 1.005;
/// Decades of Clk that are looked through, in m³/(s Pa), and the parts of a decade.
const LEAKAGE_DECADES: (i32, i32) = (-16, -11);
const PARTS_OF_DECADE: i32 = 4;
/// The search for Clk: it ends within half a part in a thousand.
const LEAKAGE: simplex::Settings =
    simplex::Settings { width: 0.25, width_min: 5e-4, iterations: 30, cost_enough: 1e-3 };
/// How far the features of the fine and the large step may differ, and how often the leakage is doubled to get there.
const STEPS_AGREE: f64 = 1e-3;
const DOUBLINGS_MAX: usize = 12;
/// The search for XSS.
const SATURATION: simplex::Settings =
    simplex::Settings { width: 0.1, width_min: 1e-7, iterations: 100, cost_enough: 0.0 };
/// The zero-flow curve's reach, m, and its points on each side of null.
const CURVE_REACH_M: f64 = 0.6e-3;
const CURVE_POINTS: i32 = 600;

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The reference model does not show the features at these levels; never empty.
    #[error("{}", first_of(.0))]
    Levels(Vec<diagnostic::LevelError>),
    /// A parameter has no value with which the models agree.
    #[error("{parameter}: no value fits: {reason}")]
    NoValue {
        /// The parameter.
        parameter: &'static str,
        /// Why.
        reason: &'static str,
    },
    /// Values that fit but are out of their ranges; never empty.
    #[error("the fitted values are no valid set: {}", first_of(.0))]
    Invalid(Vec<ParamsError>),
    /// The watcher asked for an end.
    #[error("cancelled")]
    Cancelled,
}

/// The first error, and how many more there are.
fn first_of(errors: &[impl ToString]) -> String {
    let first = errors.first().map(ToString::to_string).unwrap_or_default();
    if errors.len() > 1 { format!("{first} (and {} more)", errors.len() - 1) } else { first }
}

/// Fits a set's monitoring model to its reference model. The same set gives the same fit, whatever the number of threads.
///
/// # Errors
/// A reference model without the features, values without a fit or out of range, or cancellation by `watch`.
pub fn fit(set: &ParameterSet, watch: &dyn Watch) -> Result<Fitted, FitError> {
    let fitting = KGM.iter().flat_map(|&kgm| FDJ_N.map(|fdj_n| Level { kgm, fdj_n })).collect::<Vec<_>>();
    let checking = diagnostic::levels();
    let all: Vec<Level> = fitting.iter().chain(&checking).copied().collect();
    let watch = &Stretch { watch, from: 0.0, to: BEFORE_SURFACE };
    let done = AtomicUsize::new(0);
    let tell = || watch.progress(0.5 * (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / all.len() as f64);
    let mut own = derived(set);
    let (saturation_m, zero_flow) = fit_saturation(set, own.fluid.supply_pressure_differential_pa)?;
    own.fluid.spool_saturation_m = saturation_m;
    let mut shown = diagnostic::reference(set, &all, tell).map_err(FitError::Levels)?;
    let shown_checking = shown.split_off(fitting.len());
    let goal = Goal { shared: set.shared(), levels: fitting, shown };
    own.fluid = goal.fit_developed(&own, watch)?;
    let modelled = goal.soften(&mut own, &checking)?;
    let limited = goal.fit_simple(&mut own)?;

    let residuals = |fluid: FluidModel, modelled: &[Features]| {
        FluidResiduals::new(fluid, limited.contains(&fluid), &checking, &shown_checking, modelled)
    };
    let mut fluids = vec![residuals(FluidModel::Developed, &modelled)];
    for fluid in [FluidModel::Evolved, FluidModel::Linear] {
        watch.progress(0.8 + 0.2 * fluids.len() as f64 / 3.0);
        if watch.cancelled() {
            return Err(FitError::Cancelled);
        }
        let model = Model::with_fluid(&goal.shared, &own, fluid);
        fluids.push(residuals(fluid, &diagnostic::monitoring(&model, &checking)));
    }
    let set = with_bias(set, own, &fluids[0], watch.watch)?;
    Ok(Fitted { set, zero_flow, fluids })
}

/// Measures the bias of a set's monitoring model as it is, without fitting that.
///
/// # Errors
/// A reference model without the features, or cancellation by `watch`.
pub fn measure_bias(set: &ParameterSet, watch: &dyn Watch) -> Result<ParameterSet, FitError> {
    let checking = diagnostic::levels();
    let shown = diagnostic::reference(set, &checking, || ()).map_err(FitError::Levels)?;
    let own = set.monitoring_model().clone();
    let modelled = diagnostic::monitoring(&Model::new(&set.shared(), &own), &checking);
    watch.progress(BEFORE_SURFACE);
    let developed = FluidResiduals::new(FluidModel::Developed, false, &checking, &shown, &modelled);
    with_bias(set, own, &developed, watch)
}

/// The set with this monitoring model and the bias that it has.
fn with_bias(
    set: &ParameterSet,
    mut own: monitoring::Params,
    developed: &FluidResiduals,
    watch: &dyn Watch,
) -> Result<ParameterSet, FitError> {
    let model = Model::new(&set.shared(), &own);
    let surface = bias::learn(set, &model, &Stretch { watch, from: BEFORE_SURFACE, to: 1.0 })?;
    own.bias = Bias { surface: Some(surface), ..mean_bias(developed) };
    let mut parameters = set.to_json();
    parameters["monitoring"] = serde_json::to_value(own).expect("plain numbers serialise");
    ParameterSet::from_json(set.name(), &parameters).map_err(FitError::Invalid)
}

/// XSS, m, and what is left of the zero-flow curve.
fn fit_saturation(set: &ParameterSet, supply_pa: f64) -> Result<(f64, ZeroFlow), FitError> {
    let reach_m = CURVE_REACH_M.min(set.reference_model().second_stage.spool_position_max_m);
    let valve = Valve::new(set);
    let x: Vec<f64> =
        (-CURVE_POINTS..=CURVE_POINTS).map(|i| f64::from(i) / f64::from(CURVE_POINTS) * reach_m).collect();
    let y: Vec<f64> = valve.zero_flow_pa(&x);
    // A first guess: where the curve passes tanh 1 of the supply.
    let passed = x.iter().zip(&y).find(|(x, y)| **x > 0.0 && **y >= 1f64.tanh() * supply_pa);
    let Some((&guess_m, _)) = passed else {
        let reason = "the reference valve's pressure at zero flow does not come near the supply's";
        return Err(FitError::NoValue { parameter: "monitoring.fluid.spool_saturation_m", reason });
    };
    let value_pa = |saturation_m: f64, x: f64| supply_pa * (x / saturation_m).tanh();
    let mean_square = |saturation_m: f64| {
        x.iter().zip(&y).map(|(&x, y)| (value_pa(saturation_m, x) - y).powi(2)).sum::<f64>() / x.len() as f64
    };
    let bounds = Bounds::new(&[(0.1 * guess_m, 10.0 * guess_m)]);
    let saturation_m = minimum(Simplex::new(&bounds, &[guess_m], SATURATION), |at| mean_square(at[0]))[0];
    let off = x.iter().zip(&y).map(|(&x, y)| (x, (value_pa(saturation_m, x) - y).abs()));
    let (worst_at_m, worst_pa) = off.fold((0.0, 0.0), |worst, at| if at.1 > worst.1 { at } else { worst });
    let rms_pa = mean_square(saturation_m).sqrt();
    Ok((saturation_m, ZeroFlow { rms_pa, rms_of_supply: rms_pa / supply_pa, worst_pa, worst_at_m, reach_m }))
}

/// Where a search ends.
fn minimum(mut search: Simplex, cost: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    while search.stop().is_none() {
        let costs: Vec<f64> = search.ask().iter().map(|at| cost(at)).collect();
        search.tell(&costs);
    }
    search.best().candidate.clone()
}

/// What the monitoring model is to show.
struct Goal {
    shared: Shared,
    levels: Vec<Level>,
    shown: Vec<Features>,
}

impl Goal {
    /// The mean over the levels of what each asks for.
    fn mean(&self, of: impl Fn(&Level, &Features) -> f64) -> f64 {
        self.levels.iter().zip(&self.shown).map(|(level, shown)| of(level, shown)).sum::<f64>()
            / self.levels.len() as f64
    }

    fn ramp_flow_m3_per_s(&self) -> f64 {
        self.shared.jack.area_m2 * RAMP_M_PER_S
    }

    /// GQ, Clk and the lag's scale.
    fn fit_developed(&self, own: &monitoring::Params, watch: &dyn Watch) -> Result<fluid::Params, FitError> {
        let at = |exponent: f64| self.developed_at(&own.fluid, 10f64.powf(exponent));
        let cost = |exponent: f64| {
            let candidate = monitoring::Params { fluid: at(exponent), ..own.clone() };
            if !candidate.fluid.flow_gain_m2_per_s.is_finite() || candidate.fluid.flow_gain_m2_per_s <= 0.0 {
                return f64::INFINITY;
            }
            let modelled = diagnostic::monitoring_fast(&Model::new(&self.shared, &candidate), &self.levels);
            let square = |(own, other): (&Features, &Features)| (own.load_pressure_pa - other.load_pressure_pa).powi(2);
            (modelled.iter().zip(&self.shown).map(square).sum::<f64>() / self.levels.len() as f64).sqrt()
        };
        let parts = LEAKAGE_DECADES.0 * PARTS_OF_DECADE..=LEAKAGE_DECADES.1 * PARTS_OF_DECADE;
        let count = parts.clone().count() as f64;
        let mut best = (f64::INFINITY, 0.0);
        for (tried, part) in parts.enumerate() {
            if watch.cancelled() {
                return Err(FitError::Cancelled);
            }
            let exponent = f64::from(part) / f64::from(PARTS_OF_DECADE);
            let told = cost(exponent);
            if told < best.0 {
                best = (told, exponent);
            }
            watch.progress(0.5 + 0.2 * (tried + 1) as f64 / count);
        }
        if !best.0.is_finite() {
            let reason = "at the spool opening of the reference model's ramp the developed fluid has no pressure left";
            return Err(FitError::NoValue { parameter: "monitoring.fluid.flow_gain_m2_per_s", reason });
        }
        let part = 1.0 / f64::from(PARTS_OF_DECADE);
        let bounds = Bounds::new(&[(best.1 - part, best.1 + part)]);
        let exponent = minimum(Simplex::new(&bounds, &[best.1], LEAKAGE), |at| cost(at[0]))[0];
        watch.progress(0.8);
        Ok(at(exponent))
    }

    /// Adds as much leakage as the developed fluid's fine step needs, and gives its features. Next to none makes it so stiff at null that
    /// the fine step, which takes the flow as it was, sticks and slips where the large one, which solves for it, does not.
    fn soften(&self, own: &mut monitoring::Params, levels: &[Level]) -> Result<Vec<Features>, FitError> {
        for _ in 0..DOUBLINGS_MAX {
            let model = Model::new(&self.shared, own);
            let (fine, large) = (diagnostic::monitoring(&model, levels), diagnostic::monitoring_fast(&model, levels));
            let near = |one: f64, other: f64| (one / other - 1.0).abs() < STEPS_AGREE;
            let agree = |(fine, large): (&Features, &Features)| {
                near(fine.servovalve_current_a, large.servovalve_current_a)
                    && near(fine.load_pressure_pa, large.load_pressure_pa)
            };
            if fine.iter().zip(&large).all(agree) {
                return Ok(fine);
            }
            own.fluid = self.developed_at(&own.fluid, 2.0 * own.fluid.leakage_m3_per_s_per_pa);
        }
        let reason = "with any of them the fine and the large step of the model disagree";
        Err(FitError::NoValue { parameter: "monitoring.fluid.leakage_m3_per_s_per_pa", reason })
    }

    /// The developed fluid with a leakage, and GQ and the lag's scale that go with it; not finite where there are none.
    fn developed_at(&self, fluid: &fluid::Params, leakage_m3_per_s_per_pa: f64) -> fluid::Params {
        let flow = self.ramp_flow_m3_per_s();
        let (gain, supply_pa) = (fluid.pressure_gain_pa_per_m(), fluid.supply_pressure_differential_pa);
        // P12 = PSR tanh u - QJ²/(Qref (u² GQ/GP + Clk)), solved for GQ.
        let flow_gain_m2_per_s = self.mean(|_, shown| {
            let u = shown.spool_position_m / fluid.spool_saturation_m;
            let lost_pa = supply_pa * u.tanh() - shown.ramp_pressure_pa;
            if lost_pa <= 0.0 {
                return f64::NAN;
            }
            (flow * flow / fluid.flow_reference_m3_per_s / lost_pa - leakage_m3_per_s_per_pa) * gain / (u * u)
        });
        // MJ v' = AJ P12 and tau P12' = P - P12 with dP/dQJ = -2 QJ loss: damping ratio 1/2 sqrt(MJ/(tau k)).
        let u = self.shown[0].spool_position_m / fluid.spool_saturation_m;
        let loss = 1.0 / fluid.flow_reference_m3_per_s / (u * u * flow_gain_m2_per_s / gain + leakage_m3_per_s_per_pa);
        let resistance_n_s_per_m = 2.0 * flow * loss * self.shared.jack.area_m2.powi(2);
        let lag_s = self.shared.jack.mass_kg / (4.0 * LAG_DAMPING_RATIO.powi(2) * resistance_n_s_per_m);
        let bell = fluid.lag_bell_a / (fluid.lag_bell_b * u * u + fluid.lag_bell_c);
        let lag_scale_s = lag_s / (bell * (1.0 + fluid.lag_flow_slope_s_per_m3 * flow));
        fluid::Params { flow_gain_m2_per_s, leakage_m3_per_s_per_pa, lag_scale_s, ..*fluid }
    }

    /// The flow gains of sections 5.1 and 5.2; the fluids whose gain the time step limits.
    fn fit_simple(&self, own: &mut monitoring::Params) -> Result<Vec<FluidModel>, FitError> {
        let (flow, p) = (self.ramp_flow_m3_per_s(), own.fluid);
        let (supply_pa, gain, leakage) =
            (p.supply_pressure_differential_pa, p.pressure_gain_pa_per_m(), p.leakage_m3_per_s_per_pa);
        let spring_n_per_m = own.first_stage.feedback_spring_stiffness_n_per_m;
        // The spool opening at which this model would draw the reference model's current.
        let opening_m = |level: &Level, shown: &Features| {
            let force_n = self.shared.torque_motor.force_gain_n_per_a * (1.0 - level.kgm) * shown.servovalve_current_a;
            force_n / spring_n_per_m
        };
        let linear = self.mean(|level, shown| flow / (opening_m(level, shown) - shown.ramp_pressure_pa / gain));
        let evolved = self.mean(|level, shown| {
            let (opening_m, load_pa) = (opening_m(level, shown), shown.ramp_pressure_pa);
            let driving = supply_pa * opening_m - load_pa * opening_m.max(p.spool_saturation_m);
            supply_pa * (flow + load_pa * leakage) / driving
        });
        // The jack's velocity follows itself through the pressure from step to step by 1 - dt (AJ² dP/dQ + CJ)/MJ, which
        // must stay above -1.
        let jack = &self.shared.jack;
        let most_n_s_per_m = 2.0 * jack.mass_kg / TIME_STEP_S - jack.damping_n_s_per_m;
        if most_n_s_per_m <= 0.0 {
            let reason = "the jack's damping is too much for its mass at a time step of 1e-5 s";
            return Err(FitError::NoValue { parameter: "monitoring.fluid.linear_flow_gain_m2_per_s", reason });
        }
        let least = jack.area_m2.powi(2) * supply_pa / most_n_s_per_m / p.spool_saturation_m;
        let leak = supply_pa * leakage / p.spool_saturation_m;
        let mut limited = Vec::new();
        let mut at_least = |wanted: f64, least: f64, fluid| {
            let least = STABLE_MARGIN * least;
            if wanted.is_nan() || wanted < least {
                limited.push(fluid);
            }
            wanted.max(least)
        };
        own.fluid.linear_flow_gain_m2_per_s = at_least(linear, least, FluidModel::Linear);
        own.fluid.evolved_flow_gain_m2_per_s = at_least(evolved, least - leak, FluidModel::Evolved);
        Ok(limited)
    }
}

/// The bias of the developed fluid's features: the mean ratio of the currents, and what covers the furthest level.
fn mean_bias(developed: &FluidResiduals) -> Bias {
    let ratios: Vec<f64> = developed.levels.iter().map(|level| 1.0 / (1.0 + 0.01 * level.current_percent)).collect();
    let current_ratio = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let furthest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    Bias {
        current_ratio,
        current_ratio_std: furthest(&mut ratios.iter().map(|ratio| ratio - current_ratio)),
        load_pressure_std_pa: furthest(&mut developed.levels.iter().map(|level| 1e3 * level.pressure_kpa)),
        surface: None,
    }
}
