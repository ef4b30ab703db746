//! Both models against tests/independent/actuator.c, which was written from the equations alone, with each effect
//! switched on in turn. Needs the C compiler that Rust links with.

use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;

use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::monitoring::fluid::FluidModel;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Quantity, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::watch::Unwatched;

/// How far apart the two may be, as a part of a channel's peak: rounding, which sums in another order grow by.
const APART_MAX: f64 = 1e-8;
const CHIRP: (&str, f64, &str) = ("chirp:0.03@0.2-4", 2.0, "command=4 A=0.03 F=0.2 G=4 T=2");

fn compiled(folder: &Path) -> PathBuf {
    let program = folder.join("actuator");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent/actuator.c");
    let mut cc = Command::new("cc");
    let output = cc.args(["-O2", "-ffp-contract=off", "-o"]).arg(&program).arg(source).arg("-lm").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    program
}

/// What the other program says: current (mA), load pressure, jack position, spool position, every millisecond.
fn theirs(program: &Path, model: &str, arguments: &str) -> Vec<[f64; 4]> {
    let output = Command::new(program).arg(model).args(arguments.split(' ')).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let row = |line: &str| {
        let values: Vec<f64> = line.split(' ').map(|value| value.parse().unwrap()).collect();
        values.try_into().unwrap()
    };
    text.lines().map(row).collect()
}

fn assert_alike(case: &str, ours: &Trace, theirs: &[[f64; 4]]) {
    let channels = [Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition, Channel::SpoolPosition];
    assert_eq!(ours.samples(), theirs.len());
    for (at, channel) in channels.into_iter().enumerate() {
        let unit = if channel == Channel::ServovalveCurrent { 1e3 } else { 1.0 };
        let ours = ours.channel(channel).unwrap();
        let peak = theirs.iter().map(|row| row[at].abs()).fold(0.0, f64::max);
        let apart = ours.iter().zip(theirs).map(|(x, row)| (x * unit - row[at]).abs()).fold(0.0, f64::max);
        assert!(apart <= APART_MAX * peak, "{case}: {channel:?} {apart:e} apart of {peak:e}");
    }
}

fn run(model: ModelKind, command: &str, duration_s: f64, faults: Faults, changes: &[(&str, &str)]) -> Trace {
    let changes: Vec<_> = changes.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())).collect();
    let set = ParameterSet::reference().with(&changes).unwrap();
    let recipe = Simulation::new(model, command.parse::<Drive>().unwrap(), faults, duration_s, 1000.0);
    simulate(&recipe, &set, &Unwatched).unwrap()
}

#[test]
fn validate_both_models_agree_with_the_independent_program_on_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(folder.path());
    let commands = [
        ("diagnostic", 6.0, "command=0 T=6"),
        ("step:-0.1", 1.0, "command=1 A=-0.1 T=1"),
        ("ramp:0.15", 1.0, "command=2 A=0.15 T=1"),
        ("sine:0.2@5", 1.0, "command=3 A=0.2 F=5 T=1"),
        CHIRP,
    ];
    let faults = [(0.0, 200.0), (0.13, 455.0), (0.6, 1700.0)];
    let cases: Vec<_> = commands.iter().flat_map(|command| faults.map(|pair| (*command, pair))).collect();
    cases.par_iter().for_each(|&((command, duration_s, arguments), (kgm, fdj_n))| {
        for (kind, name) in [(ModelKind::Reference, "reference"), (ModelKind::Monitoring, "monitoring")] {
            let ours = run(kind, command, duration_s, Faults { kgm, fdj_n, ..Faults::default() }, &[]);
            let theirs = theirs(&program, name, &format!("{arguments} KGM={kgm} FDJ={fdj_n}"));
            assert_alike(&format!("{name} {command} {kgm} {fdj_n}"), &ours, &theirs);
        }
    });
}

#[test]
fn validate_every_effect_of_the_reference_model_agrees_with_the_independent_program() {
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(folder.path());
    let none = Faults::default();
    let faults = [
        (Faults { clearance_m: 2e-5, ..none }, "extra=2e-5"),
        (Faults { clogging: 0.4, ..none }, "Kintas=0.4"),
        (Faults { feedback_backlash_m: 2e-5, ..none }, "Kgioco=2e-5"),
        (Faults { jack_backlash_m: 1e-3, ..none }, "BLK=1e-3"),
        (Faults { current_offset_a: 5e-4, ..none }, "Ofs=0.5"),
        (Faults { hysteresis_a: 3e-4, ..none }, "His=0.3"),
    ];
    let parameters: [(&[(&str, &str)], &str); 13] = [
        (
            &[("controller.integral_gain_a_per_m_s", "0.3"), ("controller.derivative_gain_a_s_per_m", "0.002")],
            "GAI=300 GAD=2",
        ),
        (&[("torque_motor.current_max_a", "0.008")], "CorM=8"),
        (&[("reference.torque_motor.threshold_a", "4e-4")], "threshold=0.4"),
        (&[("reference.second_stage.hydraulic_offset_m", "1e-6")], "offset=1e-6"),
        (&[("reference.fluid.supply_pressure_pa", "15e6")], "PS=15e6"),
        (&[("reference.fluid.overlap_supply_m", "0"), ("reference.fluid.overlap_return_m", "0")], "OSSV=0 ORSV=0"),
        (
            &[("reference.fluid.overlap_supply_m", "-1e-5"), ("reference.fluid.overlap_return_m", "-2e-5")],
            "OSSV=-1e-5 ORSV=-2e-5",
        ),
        (
            &[("reference.fluid.eccentricity_ratio", "0.5"), ("reference.fluid.clearance_factor", "1.5")],
            "ecc=0.5 Khsv=1.5",
        ),
        (&[("reference.fluid.kinematic_viscosity_m2_per_s", "2e-4")], "nu=2e-4"),
        (&[("reference.fluid.leakage_m3_per_s_per_pa", "2e-12")], "Clk=2e-12"),
        (&[("jack.aerodynamic_stiffness_n_per_m", "2e4"), ("jack.external_load_n", "500")], "Kaer=2e4 load=500"),
        (&[("jack.position_max_m", "0.02")], "XJM=0.02"),
        (&[("jack.position_quantum_m", "1e-4")], "quantum=1e-4"),
    ];
    let cases = faults.iter().map(|&(faults, argument)| (faults, [].as_slice(), argument));
    let cases: Vec<_> = cases.chain(parameters.iter().map(|&(set, argument)| (none, set, argument))).collect();
    let (command, duration_s, arguments) = CHIRP;
    cases.par_iter().for_each(|&(faults, changes, argument)| {
        let ours = run(ModelKind::Reference, command, duration_s, faults, changes);
        assert_alike(argument, &ours, &theirs(&program, "reference", &format!("{arguments} {argument}")));
    });
    // What is switched on has an effect, or the comparison would show nothing.
    let plain = run(ModelKind::Reference, command, duration_s, none, &[]);
    cases.par_iter().for_each(|&(faults, changes, argument)| {
        assert_ne!(run(ModelKind::Reference, command, duration_s, faults, changes), plain, "{argument}");
    });
}

#[test]
fn validate_the_monitoring_model_s_fluids_supply_and_load_agree_with_the_independent_program() {
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(folder.path());
    let own = ParameterSet::reference().monitoring_model().fluid;
    let (command, duration_s, arguments) = CHIRP;
    for (fluid, argument) in [
        (FluidModel::Linear, format!("fluid=1 GQ={}", own.linear_flow_gain_m2_per_s)),
        (FluidModel::Evolved, format!("fluid=2 GQ={} PSR=13400000 load=300", own.evolved_flow_gain_m2_per_s)),
        (FluidModel::Developed, "PSR=20e6 load=-250".into()),
    ] {
        let mut recipe =
            Simulation::new(ModelKind::Monitoring, command.parse().unwrap(), Faults::default(), duration_s, 1000.0);
        recipe.fluid = Some(fluid);
        match fluid {
            FluidModel::Evolved => {
                recipe.supply_pressure_pa = Some(Quantity::Constant(14e6));
                recipe.external_load_n = Some(Quantity::Constant(300.0));
            }
            FluidModel::Developed => recipe.external_load_n = Some(Quantity::Constant(-250.0)),
            _ => {}
        }
        let ours = simulate(&recipe, &ParameterSet::reference(), &Unwatched).unwrap();
        assert_alike(&argument, &ours, &theirs(&program, "monitoring", &format!("{arguments} {argument}")));
    }
}
