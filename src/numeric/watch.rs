//! The watch over long work: it is told how far the work has come, and may ask for its end.

/// Looks on while something long runs. Implementations are called from any thread, often, and must be cheap.
pub trait Watch: Sync {
    /// The work has come this far, 0 to 1.
    fn progress(&self, fraction: f64);
    /// Whether the work should end early.
    fn cancelled(&self) -> bool;
}

/// A part of long work, from one fraction of it to another.
pub struct Part<'a> {
    whole: &'a dyn Watch,
    from: f64,
    to: f64,
}

impl<'a> Part<'a> {
    /// The part between two fractions of the whole.
    #[must_use]
    pub fn new(whole: &'a dyn Watch, from: f64, to: f64) -> Self {
        Self { whole, from, to }
    }
}

impl Watch for Part<'_> {
    fn progress(&self, fraction: f64) {
        self.whole.progress(self.from + (self.to - self.from) * fraction);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
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
