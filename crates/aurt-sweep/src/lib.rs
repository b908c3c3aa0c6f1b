//! Sweeps: many variants of an experiment, judged on what they were not fitted to.
