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
