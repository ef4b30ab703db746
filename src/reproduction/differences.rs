//! Where ours differ from what the thesis prints, and why.

/// One difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Difference {
    /// Where in the thesis.
    pub place: &'static str,
    /// What it says there.
    pub thesis: &'static str,
    /// What we do or find.
    pub here: &'static str,
    /// Why.
    pub reason: &'static str,
}

const fn difference(place: &'static str, thesis: &'static str, here: &'static str, reason: &'static str) -> Difference {
    Difference { place, thesis, here, reason }
}

/// The differences, in the order of the thesis.
pub const DIFFERENCES: [Difference; 12] = [
    difference(
        "3.2.4",
        "Coulomb's equations stand where Borello's should",
        "The velocity is zero in the step in which its sign would change, and leaves zero only against more than the static \
         friction",
        "The text around the equations describes this",
    ),
    difference("4.1.3", "X02S is defined twice", "The second is X02R = ORSV − XS", "Figure 4.10 has four passages"),
    difference("4.1.3", "The root of Q2S holds ps − p1", "ps − p2", "Its own sign term has ps − p2"),
    difference("4.1", "CF = 2 ZF √MF (KSF + KF)", "CF = 2 ZF √(MF (KSF + KF))", "Only this has the unit of a damping"),
    difference(
        "5.3",
        "τ, fitted to settling times, is the lag of the monitoring model",
        "The same bell, scaled to 2 ms",
        "A settling time to 5 kPa is several lags long; used as the lag it lets the model stick and slip falsely",
    ),
    difference(
        "6.2",
        "200 to 1000 N are called static friction",
        "They are the dynamic friction FDJ, half of the static one",
        "P12 is FDJ over the jack's area while the jack still creeps",
    ),
    difference(
        "6.2.2",
        "On a ramp nothing shows the friction",
        "P12 shows FDJ over the jack's area",
        "The jack moves against its friction all the time",
    ),
    difference(
        "6.2.4, 6.3",
        "P12 in MPa",
        "P12 in kPa",
        "250.972 kPa on 8 cm² are 200.8 N; the same number of MPa would be 200 kN",
    ),
    difference("6.3", "KGM 70.3 in case 18", "0.3", "A slip of the pen between 0.3 and 0.3"),
    difference(
        "7.2",
        "The current's mean over the last 0.01 s",
        "Over 0.1 s",
        "The printed code takes 10 000 steps of 10 µs",
    ),
    difference(
        "7.2",
        "The models' currents differ by 0.15 mA",
        "They differ by a ratio",
        "In table 6.3 Cor (1 − KGM) is constant, so the difference grows with KGM and no constant fits",
    ),
    difference(
        "7.2, third test",
        "A clearance of 30 µm hardly shifts KGM",
        "With 30 µm more of radial clearance KGM is read too high",
        "The leak asks for more current, as a weaker torque motor does, and the monitoring model has no leak. The thesis says \
         neither whether its clearance is radial nor whether it is added",
    ),
];
