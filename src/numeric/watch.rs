//! The watch over long work: it is told how far the work has come, and may ask for its end.

/// Looks on while something long runs. Implementations are called from any thread, often, and must be cheap.
pub trait Watch: Sync {
    /// The work has come this far, 0 to 1.
    fn progress(&self, fraction: f64);
    /// Whether the work should end early.
    fn cancelled(&self) -> bool;
}

/// Nobody looks on.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn progress(&self, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        false
    }
}

/// A part of longer work: its progress runs between two fractions of the whole.
pub struct Stretch<'a> {
    /// Who looks on at the whole.
    pub watch: &'a dyn Watch,
    /// Where the part begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

impl Watch for Stretch<'_> {
    fn progress(&self, fraction: f64) {
        self.watch.progress(self.from + (self.to - self.from) * fraction);
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }
}
