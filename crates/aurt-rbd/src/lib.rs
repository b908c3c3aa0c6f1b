//! Rigid-body dynamics of serial manipulators: regressor, recursive Newton-Euler, forward dynamics, base inertial parameters.
