//! The watch over one attempt, shared between the thread that computes and the task that supervises it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::numeric::watch::Watch;

/// How far an attempt has come, and whether it should end.
#[derive(Debug, Default)]
pub(super) struct Watching {
    progress_bits: AtomicU64,
    ended: AtomicBool,
}

impl Watching {
    /// How far the work has come, 0 to 1.
    pub(super) fn fraction(&self) -> f64 {
        f64::from_bits(self.progress_bits.load(Ordering::Relaxed))
    }

    /// Asks for an early end.
    pub(super) fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}

impl Watch for Watching {
    fn progress(&self, fraction: f64) {
        self.progress_bits.store(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}
