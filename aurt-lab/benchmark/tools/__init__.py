"""Tools of the benchmark, one module each: `NAME`, `version()`, `solve(case)`."""
