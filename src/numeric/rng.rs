//! Randomness from named streams of one seed: a new draw in one stream cannot shift another.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use sha2::{Digest, Sha256};

/// The root of all random draws of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seed(pub u64);

impl Seed {
    /// The stream of this name and index. The same three values give the same stream everywhere.
    #[must_use]
    pub fn stream(self, name: &str, index: u64) -> Xoshiro256PlusPlus {
        let digest =
            Sha256::new().chain_update(self.0.to_le_bytes()).chain_update(index.to_le_bytes()).chain_update(name);
        Xoshiro256PlusPlus::from_seed(digest.finalize().into())
    }
}

#[cfg(test)]
mod tests {
    use rand::Rng;

    use super::*;

    #[test]
    fn streams_differ_by_seed_name_and_index_and_repeat_exactly() {
        let first = |seed: u64, name: &str, index: u64| Seed(seed).stream(name, index).next_u64();
        assert_eq!(first(1, "noise", 0), first(1, "noise", 0));
        let all = [first(1, "noise", 0), first(2, "noise", 0), first(1, "mutation", 0), first(1, "noise", 1)];
        assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])), "{all:?}");
    }

    #[test]
    fn regress_the_first_draw_of_a_stream_never_changes() {
        // Frozen: a stored result is reproduced from its seed only as long as this holds.
        assert_eq!(Seed(1).stream("noise", 0).next_u64(), 14256530085150803184);
    }
}
