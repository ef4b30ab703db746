//! Optimisers: they minimise a cost and have never heard of valves.
