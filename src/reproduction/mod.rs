//! The thesis's tables and figures, made again: ours beside the thesis's, what it says of them judged, and where we differ.
//!
//! A [`table::Table`] is data; [`text`] tells it on a terminal, [`report`] as a page for a browser.

pub mod claims;
pub mod coverage;
mod curves;
pub mod differences;
mod estimates;
pub mod figure;
pub mod methods;
pub mod plot;
pub mod report;
mod responses;
mod runs;
mod steady;
pub mod table;
pub mod text;
pub mod thesis;

use std::str::FromStr;

use thiserror::Error;

use crate::characterisation::settling::SettlingError;
use crate::estimation::EstimationError;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::SimulationError;
use crate::numeric::watch::{Stretch, Watch};

use table::Table;

/// A table, or a family of figures, of the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Name {
    /// Section 6.3: the steady current and pressure at 25 pairs of faults.
    Table63,
    /// Section 7.2, first table: KGM alone.
    SingleKgm,
    /// Section 7.2, second table: FDJ alone.
    SingleFdj,
    /// Section 7.2, third table: both faults.
    Table72,
    /// Section 7.2, fourth table: both faults through noise.
    TableNoise,
    /// Section 7.2, fifth table: both faults with a clearance that the monitoring model does not have.
    TableClearance,
    /// Sections 3.2, 4.1.3 and chapter 5: characteristic curves and settling times.
    Curves,
    /// Chapters 5 and 6: responses to a step, a ramp and a sine, with tables 6.1.4 and 6.2.4.
    Responses,
    /// No table of the thesis: how often the truth lies within the standard deviations.
    Coverage,
}

/// Why a table could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReproductionError {
    /// A model run failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The settling times have no map.
    #[error(transparent)]
    Settling(#[from] SettlingError),
    /// An estimation failed.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
}

impl Name {
    /// Every table of the thesis, in the order in which they are told.
    pub const ALL: [Self; 8] = [
        Self::Table63,
        Self::SingleKgm,
        Self::SingleFdj,
        Self::Table72,
        Self::TableNoise,
        Self::TableClearance,
        Self::Curves,
        Self::Responses,
    ];

    /// Every table that can be asked for: the thesis's, and our own.
    pub const EVERY: [Self; 9] = {
        let mut every = [Self::Coverage; 9];
        let mut at = 0;
        while at < Self::ALL.len() {
            every[at] = Self::ALL[at];
            at += 1;
        }
        every
    };

    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Table63 => "table-6.3",
            Self::SingleKgm => "single-kgm",
            Self::SingleFdj => "single-fdj",
            Self::Table72 => "table-7.2",
            Self::TableNoise => "table-noise",
            Self::TableClearance => "table-clearance",
            Self::Curves => "curves",
            Self::Responses => "responses",
            Self::Coverage => "coverage",
        }
    }

    /// How long the table takes, in model runs.
    const fn runs(self) -> usize {
        match self {
            Self::SingleKgm | Self::SingleFdj => 5,
            Self::Table63 | Self::Table72 => 25,
            Self::TableClearance => 50,
            Self::TableNoise => 325,
            Self::Coverage => 200,
            Self::Curves => 40,
            Self::Responses => 60,
        }
    }

    /// Makes the table with a parameter set.
    ///
    /// # Errors
    /// A run that failed, or cancellation by `watch`.
    pub fn reproduce(self, set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
        match self {
            Self::Table63 => steady::table(set, watch),
            Self::SingleKgm => estimates::single_kgm(set, watch),
            Self::SingleFdj => estimates::single_fdj(set, watch),
            Self::Table72 => estimates::both(set, watch),
            Self::TableNoise => estimates::through_noise(set, watch),
            Self::TableClearance => estimates::with_clearance(set, watch),
            Self::Curves => curves::table(set, watch),
            Self::Responses => responses::table(set, watch),
            Self::Coverage => coverage::table(set, watch),
        }
    }
}

impl FromStr for Name {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let all = Self::EVERY.map(Self::name).join(", ");
        Self::EVERY.into_iter().find(|name| name.name() == text).ok_or(format!("expected one of {all}"))
    }
}

/// Makes tables one after the other, each on every core. `made` is told of each as soon as it is there.
///
/// # Errors
/// The first run that failed, or cancellation by `watch`.
pub fn reproduce(
    names: &[Name],
    set: &ParameterSet,
    watch: &dyn Watch,
    mut made: impl FnMut(&mut Table),
) -> Result<Vec<Table>, ReproductionError> {
    let all: usize = names.iter().map(|name| name.runs()).sum();
    let mut before = 0;
    let mut tables = Vec::with_capacity(names.len());
    for name in names {
        let after = before + name.runs();
        let stretch = Stretch { watch, from: before as f64 / all as f64, to: after as f64 / all as f64 };
        let mut table = name.reproduce(set, &stretch)?;
        made(&mut table);
        tables.push(table);
        before = after;
    }
    Ok(tables)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back_and_another_is_refused_with_all_of_them() {
        for name in Name::EVERY {
            assert_eq!(name.name().parse(), Ok(name));
        }
        let refused = "table-9".parse::<Name>().unwrap_err();
        assert!(Name::EVERY.iter().all(|name| refused.contains(name.name())), "{refused}");
    }
}
