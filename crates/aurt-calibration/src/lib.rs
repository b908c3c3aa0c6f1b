//! Weighted least squares calibration of robot models from recordings.
