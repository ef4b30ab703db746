//! Swarms: candidates that move, each by what it and the others have seen.

mod dragonflies;
mod particles;
mod wolves;

pub use dragonflies::Dragonflies;
pub use particles::Particles;
pub use wolves::Wolves;
