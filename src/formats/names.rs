//! What the names of columns mean.

use crate::models::trace::Channel;
use crate::units::{self, Unit};

/// What a column of a file holds.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Role {
    Time,
    Channel(Channel),
    /// The pressure in port 1 or 2.
    Port(usize),
    /// A quantity that is kept, and not interpreted, under this name.
    Other(String),
}

impl Role {
    /// The name of the column in a trace.
    pub(super) fn column(&self) -> &str {
        match self {
            Self::Time => "time_s",
            Self::Channel(channel) => channel.column(),
            Self::Port(1) => "port_1_pressure_pa",
            Self::Port(_) => "port_2_pressure_pa",
            Self::Other(name) => name,
        }
    }
}

pub(super) const TIME: Role = Role::Time;
pub(super) const COMMAND: Role = Role::Channel(Channel::PositionCommand);
pub(super) const CURRENT: Role = Role::Channel(Channel::ServovalveCurrent);
pub(super) const LOAD_PRESSURE: Role = Role::Channel(Channel::LoadPressure);

/// The names that elevon knows, without their units, and the units they may have.
pub(super) const KNOWN: [(&str, Role, &[Unit]); 11] = [
    ("time", TIME, units::TIME),
    ("position_command", COMMAND, units::LENGTH),
    ("servovalve_current", CURRENT, units::CURRENT),
    ("load_pressure", LOAD_PRESSURE, units::PRESSURE),
    ("port_1_pressure", Role::Port(1), units::PRESSURE),
    ("port_2_pressure", Role::Port(2), units::PRESSURE),
    ("jack_position", Role::Channel(Channel::JackPosition), units::LENGTH),
    ("jack_velocity", Role::Channel(Channel::JackVelocity), units::VELOCITY),
    ("spool_position", Role::Channel(Channel::SpoolPosition), units::LENGTH),
    ("external_load", Role::Channel(Channel::ExternalLoad), units::FORCE),
    ("supply_pressure", Role::Channel(Channel::SupplyPressure), units::PRESSURE),
];

/// What a name means.
pub(super) enum Meaning {
    Known(Role, Unit),
    /// A known quantity in a unit that is not one of its own.
    UnknownUnit(Role, &'static str, &'static [Unit]),
    Unknown,
}

/// Finds what a name means. What follows a known quantity counts as its unit when it looks like one, which is one
/// word or a quotient: `time_of_day` is another quantity, `load_pressure_furlong` is a load pressure.
pub(super) fn meaning(name: &str) -> Meaning {
    for (stem, role, units) in KNOWN {
        let Some(tail) = name.strip_prefix(stem) else { continue };
        if let Some(unit) = units.iter().find(|unit| tail.strip_prefix('_') == Some(unit.suffix)) {
            return Meaning::Known(role, *unit);
        }
        let word = tail.strip_prefix('_').is_some_and(|unit| !unit.contains('_') || unit.contains("_per_"));
        if tail.is_empty() || word {
            return Meaning::UnknownUnit(role, stem, units);
        }
    }
    Meaning::Unknown
}

/// The names of a quantity in all its units: `time_s or time_ms`.
pub(super) fn accepted(stem: &str, units: &[Unit]) -> String {
    units.iter().map(|unit| format!("{stem}_{}", unit.suffix)).collect::<Vec<_>>().join(" or ")
}

/// The names of a known quantity in all its units.
pub(super) fn accepted_for(role: &Role) -> String {
    KNOWN.iter().filter(|known| known.1 == *role).map(|known| accepted(known.0, known.2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_has_a_name_whose_si_form_is_its_column() {
        let known: Vec<_> = KNOWN.iter().map(|(_, role, _)| role.clone()).collect();
        assert!(Channel::ALL.into_iter().all(|channel| known.contains(&Role::Channel(channel))));
        for (stem, role, units) in KNOWN {
            assert_eq!(role.column(), format!("{stem}_{}", units[0].suffix));
        }
    }

    #[test]
    fn a_known_quantity_in_an_unknown_unit_is_not_another_quantity() {
        for name in
            ["load_pressure_furlong", "load_pressure", "time_", "jack_velocity_km_per_h", "servovalve_current_mA"]
        {
            assert!(matches!(meaning(name), Meaning::UnknownUnit(..)), "{name}");
        }
        for name in ["oil_temperature_k", "time_of_day", "jack_position_2_m", "timer", "Time_s", ""] {
            assert!(matches!(meaning(name), Meaning::Unknown), "{name}");
        }
    }
}
