//! Progress of long work: a bar on a terminal, nothing when piped.

use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::numeric::watch::Watch;

/// Ticks of a bar that shows fractions.
const TICKS: u64 = 1000;

/// A bar that shows how far one piece of work has come.
#[derive(Debug)]
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar with a word before it. It draws on standard error, and only if that is a terminal.
    pub fn new(what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(TICKS), ProgressDrawTarget::stderr());
        bar.set_style(style("{prefix:>12} [{bar:40}] {percent:>3} % {eta}"));
        bar.set_prefix(what);
        Self(bar)
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }

    /// A watch over part `index` of `parts` equal parts of the work.
    pub fn parts(&self, parts: usize) -> Parts<'_> {
        Parts { bar: self, done: Mutex::new(vec![0.0; parts]) }
    }
}

impl Watch for Bar {
    fn progress(&self, fraction: f64) {
        self.0.set_position((fraction * TICKS as f64) as u64);
    }

    fn cancelled(&self) -> bool {
        false
    }
}

/// Several pieces of work that share a bar.
#[derive(Debug)]
pub struct Parts<'a> {
    bar: &'a Bar,
    done: Mutex<Vec<f64>>,
}

/// One piece of them.
#[derive(Debug)]
pub struct Part<'a> {
    parts: &'a Parts<'a>,
    index: usize,
}

impl Parts<'_> {
    /// The watch over one piece.
    pub fn part(&self, index: usize) -> Part<'_> {
        Part { parts: self, index }
    }
}

impl Watch for Part<'_> {
    fn progress(&self, fraction: f64) {
        // A poisoned lock only means that another piece panicked; its fraction still is a number.
        let mut done = self.parts.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        done[self.index] = fraction;
        self.parts.bar.progress(done.iter().sum::<f64>() / done.len() as f64);
    }

    fn cancelled(&self) -> bool {
        false
    }
}

/// A bar's style.
pub fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the templates in this program are valid").progress_chars("=> ")
}
