//! What a recorded command does: holds, ramps and jumps, and among them the manoeuvres that show the faults.

use std::ops::RangeInclusive;

/// The slope of a ramp, m/s: near that of section 6.3, at which the models' bias is known.
const RAMP_M_PER_S: RangeInclusive<f64> = 0.09..=0.11;
/// The most slope of a hold, m/s.
const HOLD_MAX_M_PER_S: f64 = 0.002;
/// The least height of a step, m: after a lower one the jack no longer creeps when the pressure is taken.
const STEP_MIN_M: f64 = 0.05;
/// The longest time that a step may take to rise, s.
const RISE_MAX_S: f64 = 0.3;
/// The least length of what comes before a step, s, so that its transient is over.
const SETTLED_MIN_S: f64 = 1.0;
/// How far a straight piece may stray from its chord, as a part of the command's range.
const STRAY: f64 = 3e-3;
/// A command in more pieces than this is no manoeuvre but noise, a chirp, or a sine.
const PIECES_MAX: usize = 1000;
/// The least length of a ramp whose end is steady, s.
const RAMP_MIN_S: f64 = 1.0;
/// The current's window: from and to before the ramp's end, s (section 7.2: 1.8 to 1.9 s of a ramp that ends at 2 s).
const CURRENT_WINDOW_S: (f64, f64) = (0.2, 0.1);
/// The pressure's window: its middle after the step and half its width, s (section 7.2).
const PRESSURE_WINDOW_S: (f64, f64) = (1.1, 0.01);

/// A stretch of time, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Its start, s.
    pub from_s: f64,
    /// Its end, s.
    pub to_s: f64,
}

/// A step that rises within one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// The time of the sample that ends it, s.
    pub at_s: f64,
    /// Its height, m, with its sign.
    pub height_m: f64,
}

/// Where in a trace the two features of section 6.3 are found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Manoeuvres {
    /// The end of the longest ramp, where the current is steady.
    pub current: Option<Window>,
    /// A second after the last step from rest or from a steady ramp, where the jack creeps.
    pub pressure: Option<Window>,
    /// That step, where it rises within one sample.
    pub jump: Option<Jump>,
}

/// A straight piece of a command, by the indices of its first and last sample.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    first: usize,
    last: usize,
}

/// Finds the manoeuvres in a recorded command.
#[must_use]
pub fn find(time_s: &[f64], command_m: &[f64]) -> Manoeuvres {
    let pieces = straight_pieces(time_s, command_m);
    let slope = |p: &Piece| (command_m[p.last] - command_m[p.first]) / (time_s[p.last] - time_s[p.first]);
    let length = |p: &Piece| time_s[p.last] - time_s[p.first];
    let is_ramp = |p: &&Piece| RAMP_M_PER_S.contains(&slope(p).abs()) && length(p) >= RAMP_MIN_S - step_s(time_s, p);
    let longest = pieces.iter().filter(is_ramp).max_by(|a, b| length(a).total_cmp(&length(b)));
    let current = longest.map(|ramp| {
        // The ramp ends where the next piece begins; the sample there belongs to what follows a jump.
        let end_s = time_s[ramp.last] + step_s(time_s, ramp);
        Window { from_s: end_s - CURRENT_WINDOW_S.0, to_s: end_s - CURRENT_WINDOW_S.1 }
    });
    let half_s = |p: &Piece| PRESSURE_WINDOW_S.1.max(2.5 * step_s(time_s, p));
    // A step leads from one long piece to the next, over as many short ones as its rise takes.
    let long: Vec<&Piece> = pieces.iter().filter(|p| length(p) >= SETTLED_MIN_S - step_s(time_s, p)).collect();
    let is_step = |pair: &&[&Piece]| {
        let (before, hold) = (pair[0], pair[1]);
        time_s[hold.first] - time_s[before.last] <= RISE_MAX_S
            && (command_m[hold.first] - command_m[before.last]).abs() >= STEP_MIN_M
            && slope(hold).abs() <= HOLD_MAX_M_PER_S
            && length(hold) >= PRESSURE_WINDOW_S.0 + half_s(hold)
    };
    let step = long.windows(2).rfind(is_step);
    let jump = step
        .filter(|pair| pair[1].first == pair[0].last + 1)
        .map(|pair| Jump { at_s: time_s[pair[1].first], height_m: command_m[pair[1].first] - command_m[pair[0].last] });
    let pressure = step.map(|pair| {
        let middle_s = time_s[pair[1].first] + PRESSURE_WINDOW_S.0;
        let half_s = half_s(pair[1]);
        Window { from_s: middle_s - half_s, to_s: middle_s + half_s }
    });
    Manoeuvres { current, pressure, jump }
}

/// The mean sampling step of a piece, s.
fn step_s(time_s: &[f64], piece: &Piece) -> f64 {
    (time_s[piece.last] - time_s[piece.first]) / (piece.last - piece.first) as f64
}

/// Cuts a command into straight pieces where it strays most from a chord (Ramer, Douglas and Peucker); none when it takes
/// too many. Of places that stray alike the middle one is cut, so that a regular command falls into halves.
fn straight_pieces(time_s: &[f64], command_m: &[f64]) -> Vec<Piece> {
    let (low, high) = command_m.iter().fold((f64::MAX, f64::MIN), |(l, h), &c| (l.min(c), h.max(c)));
    let stray_max_m = (STRAY * (high - low)).max(1e-9);
    let mut pieces = Vec::new();
    let mut open = vec![Piece { first: 0, last: time_s.len() - 1 }];
    while let Some(piece) = open.pop() {
        let Piece { first, last } = piece;
        let slope = (command_m[last] - command_m[first]) / (time_s[last] - time_s[first]);
        let stray_m = |i: usize| (command_m[i] - command_m[first] - slope * (time_s[i] - time_s[first])).abs();
        let worst_m = (first + 1..last).map(stray_m).fold(0.0, f64::max);
        if worst_m <= stray_max_m {
            pieces.push(piece);
        } else {
            let from_middle = |&i: &usize| i.abs_diff(first.midpoint(last));
            let cut = (first + 1..last).filter(|&i| stray_m(i) == worst_m).min_by_key(from_middle);
            let cut = cut.expect("the worst stray is somewhere");
            open.extend([Piece { first: cut, last }, Piece { first, last: cut }]);
        }
        if pieces.len() + open.len() > PIECES_MAX {
            return Vec::new();
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::drive::Drive;

    fn sampled(command: &str, duration_s: f64, rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
        let drive: Drive = command.parse().unwrap();
        let time_s: Vec<f64> = (0..=(duration_s * rate_hz) as usize).map(|k| k as f64 / rate_hz).collect();
        let command_m = time_s.iter().map(|&t| drive.position_m(t, duration_s)).collect();
        (time_s, command_m)
    }

    fn found(command: &str, duration_s: f64, rate_hz: f64) -> Manoeuvres {
        let (time_s, command_m) = sampled(command, duration_s, rate_hz);
        find(&time_s, &command_m)
    }

    #[test]
    fn validate_section_7_2_the_windows_of_the_diagnostic_command_are_the_thesis_s_at_any_rate() {
        for rate_hz in [200.0, 1000.0, 2500.0, 100_000.0] {
            let m = found("diagnostic", 6.0, rate_hz);
            let (current, pressure) = (m.current.unwrap(), m.pressure.unwrap());
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
            assert!(near(current.from_s, 1.8) && near(current.to_s, 1.9), "{rate_hz}: {current:?}");
            assert!(near(0.5 * (pressure.from_s + pressure.to_s), 5.1), "{rate_hz}: {pressure:?}");
            assert_eq!(m.jump, Some(Jump { at_s: 4.0, height_m: 0.1 }));
        }
    }

    #[test]
    fn idle_sine_and_short_commands_have_no_manoeuvre() {
        assert_eq!(found("step:0", 6.0, 1000.0), Manoeuvres::default());
        assert_eq!(found("sine:0.05@0.5", 6.0, 1000.0), Manoeuvres::default());
        assert_eq!(found("diagnostic", 0.9, 1000.0), Manoeuvres::default());
        assert_eq!(found("sequence:0.05@1,0@1.5", 2.0, 1000.0), Manoeuvres::default());
    }

    #[test]
    fn a_step_that_takes_a_while_to_rise_is_a_step_and_one_out_of_a_transient_is_none() {
        let filtered = |time_s: &[f64], command_m: &[f64]| -> Vec<f64> {
            let smooth = |last: &mut f64, &c: &f64| {
                *last += (c - *last) * 0.1;
                Some(*last)
            };
            assert_eq!(time_s.len(), command_m.len());
            command_m.iter().scan(0.0, smooth).collect()
        };
        let (time_s, command_m) = sampled("diagnostic", 6.0, 1000.0);
        let slow = find(&time_s, &filtered(&time_s, &command_m));
        let pressure = slow.pressure.unwrap();
        assert!((pressure.from_s - 5.09).abs() < 0.1 && slow.current.is_some(), "{slow:?}");
        assert_eq!(found("sequence:0.1@1,0.15@1.3", 4.0, 1000.0).pressure, None);
        assert_eq!(found("sequence:0.03@1.5", 4.0, 1000.0).pressure, None);
    }

    #[test]
    fn a_ramp_at_another_speed_has_no_current_window() {
        assert_eq!(found("ramp:0.05", 3.0, 1000.0).current, None);
    }

    #[test]
    fn a_noisy_or_coarse_command_keeps_its_manoeuvres() {
        let (time_s, command_m) = sampled("diagnostic", 6.0, 1000.0);
        let coarse: Vec<f64> = command_m.iter().map(|c| (c * 2e3).round() * 0.5e-3).collect();
        let found = find(&time_s, &coarse);
        assert!(found.current.is_some() && found.pressure.is_some(), "{found:?}");
    }

    #[test]
    fn a_command_that_alternates_a_million_times_is_no_manoeuvre_and_is_soon_known_to_be_none() {
        let time_s: Vec<f64> = (0..1_000_000).map(|k| f64::from(k) * 1e-4).collect();
        let command_m: Vec<f64> = (0..1_000_000).map(|k| f64::from(k % 2)).collect();
        assert_eq!(find(&time_s, &command_m), Manoeuvres::default());
    }

    #[test]
    fn a_ramp_alone_has_a_current_window_and_a_step_alone_a_pressure_window() {
        assert!(matches!(found("ramp:-0.1", 2.0, 1000.0), Manoeuvres { current: Some(_), pressure: None, .. }));
        let step = found("sequence:0.1@1", 3.0, 1000.0);
        assert!(step.current.is_none() && (step.pressure.unwrap().from_s - 2.09).abs() < 1e-9, "{step:?}");
    }
}
