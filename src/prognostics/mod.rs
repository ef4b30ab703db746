//! Prognosis: from the history of a fault to the distribution of the remaining useful life.
