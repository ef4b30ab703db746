//! Units: the suffixes that column names carry, and their factors to SI.
