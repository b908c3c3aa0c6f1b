//! Reading and preprocessing robot recordings: formats, clocks, filters.
