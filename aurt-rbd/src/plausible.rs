//! Bounds that every robot keeps, so that a slip in a unit is told rather than computed with.

/// Largest length between two joints, m. Those of a table in millimetres are beyond it.
pub const LONGEST_LINK_M: f64 = 100.0;
/// Largest twist or offset, rad: two turns. Right angles in degrees are beyond it.
pub const LARGEST_ANGLE_RAD: f64 = 4.0 * std::f64::consts::PI;
/// Largest gravitational acceleration, m/s²: ten times the earth's.
pub const LARGEST_GRAVITY_M_S2: f64 = 100.0;

/// What is wrong with a length, as the rest of a sentence.
pub fn length_complaint(value_m: f64) -> Option<String> {
    if !value_m.is_finite() {
        return Some(format!("must be finite, is {value_m}"));
    }
    (value_m.abs() > LONGEST_LINK_M)
        .then(|| format!("is {value_m:e} m, more than {LONGEST_LINK_M} m; lengths are in metres"))
}

/// What is wrong with an angle, as the rest of a sentence.
pub fn angle_complaint(value_rad: f64) -> Option<String> {
    if !value_rad.is_finite() {
        return Some(format!("must be finite, is {value_rad}"));
    }
    (value_rad.abs() > LARGEST_ANGLE_RAD).then(|| {
        format!("is {value_rad:e} rad, more than two turns; angles are in radians, 90 degrees is pi/2")
    })
}

/// What is wrong with a gravity vector, as the rest of a sentence.
pub fn gravity_complaint(gravity_m_s2: [f64; 3]) -> Option<String> {
    if !gravity_m_s2.iter().all(|g| g.is_finite()) {
        return Some(format!("must be three finite numbers in m/s^2, is {gravity_m_s2:?}"));
    }
    gravity_m_s2.iter().any(|g| g.abs() > LARGEST_GRAVITY_M_S2).then(|| {
        format!("is {gravity_m_s2:?}, more than {LARGEST_GRAVITY_M_S2} m/s^2; on earth it has 9.81 m/s^2")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_that_slipped_are_told() {
        assert!(length_complaint(612.7).is_some_and(|said| said.contains("metres")));
        assert!(length_complaint(1e308).is_some() && length_complaint(f64::NAN).is_some());
        assert!(angle_complaint(-90.0).is_some_and(|said| said.contains("pi/2")));
        assert!(gravity_complaint([0.0, 0.0, -9810.0]).is_some_and(|said| said.contains("9.81")));
        assert_eq!(length_complaint(-1.3), None);
        assert_eq!(angle_complaint(-std::f64::consts::PI), None);
        assert_eq!(gravity_complaint([0.0, 0.0, -9.81]), None);
    }
}
