//! Bodies that can exist: mass, centre and inertia of what arm terms put on links.

use std::ops::Range;

use aurt_traits::{ColumnGroup, MeasurementUnit, RobotModel};
use nalgebra::{Matrix3, Matrix4};

use super::fitted::Fitted;
use super::pseudo_inertia::pseudo_inertia;

/// The standard parameters of a body in its link's frame, as columns are named, `XX_5`.
const SYMBOLS: [&str; 10] = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "mX", "mY", "mZ", "m"];

/// Where in its term's columns each standard parameter of a body is.
pub(crate) type Places = [Option<usize>; 10];

/// A body that an arm term puts on a link.
#[derive(Debug, Clone)]
pub(crate) struct Carried {
    /// The term's coefficients.
    pub columns: Range<usize>,
    /// Where among them each standard parameter is; the mass is there.
    pub places: Places,
    /// The link, as names have it.
    pub link: String,
}

/// The bodies that arm terms put on links.
pub(crate) fn carried(model: &RobotModel) -> Vec<Carried> {
    let mut bodies = Vec::new();
    for (group, columns) in model.groups() {
        let ColumnGroup::ArmTerm(k) = group else { continue };
        let term = &model.arm_terms()[*k];
        if !term.is_load() {
            continue;
        }
        let names = term.columns(model.joints());
        let mut links: Vec<&str> =
            names.iter().filter_map(|p| p.name.split_once('_')).map(|(_, link)| link).collect();
        links.dedup();
        for link in links {
            let place =
                |symbol: &str| names.iter().position(|p| p.name.split_once('_') == Some((symbol, link)));
            let places = SYMBOLS.map(place);
            if places[9].is_some() {
                bodies.push(Carried { columns: columns.clone(), places, link: link.to_owned() });
            }
        }
    }
    bodies
}

pub(super) fn warnings(fitted: &Fitted<'_>) -> Vec<String> {
    let bodies = carried(fitted.model);
    bodies.iter().filter_map(|b| impossible(fitted, &b.columns, &b.places, &b.link)).collect()
}

/// What is impossible about a body on a link. A body that was taken off is one with the opposite parameters.
fn impossible(fitted: &Fitted<'_>, columns: &Range<usize>, places: &Places, link: &str) -> Option<String> {
    let value = |place: usize| fitted.value(columns.start + place);
    let mass = value(places[9]?);
    let unit = fitted.unit();
    let whole: Option<Vec<usize>> = places.iter().copied().collect();
    let Some(whole) = whole.filter(|w| w.iter().all(|p| fitted.parameters[columns.start + p].excited)) else {
        // Part of the parameters alone can be of a body as long as there is mass.
        return mass.is_negative().then(|| {
            format!(
                "unphysical: the body on link {link} has a negative mass ({mass} {unit}). If a load was removed, this is its \
                 mass; otherwise the motions do not excite it, or its torque has another cause: run `aurt diagnose`"
            )
        });
    };
    let sign = if mass.is_negative() { -1.0 } else { 1.0 };
    let standard: [f64; 10] = std::array::from_fn(|i| sign * value(whole[i]).value);
    let pseudo = pseudo_inertia(&standard);
    // Scaled to a unit diagonal, so that kilogrammes and metres weigh alike.
    let scale =
        Matrix4::from_diagonal(&pseudo.diagonal().map(|d| d.abs().max(f64::MIN_POSITIVE).sqrt().recip()));
    let scaled = scale * pseudo * scale;
    // Eigenvalues of what is not finite are searched for ever.
    if !scaled.iter().all(|v| v.is_finite()) {
        return None;
    }
    let scaled = scaled.symmetric_eigen();
    let direction = scale * scaled.eigenvectors.column(scaled.eigenvalues.imin());
    let mut gradient = vec![0.0; columns.len()];
    for (i, place) in whole.iter().enumerate() {
        let mut unit = [0.0; 10];
        unit[i] = sign;
        gradient[*place] = direction.dot(&(pseudo_inertia(&unit) * direction));
    }
    if !fitted.estimated(columns.clone(), &gradient).is_negative() {
        return None;
    }
    let why = match principal_moments(&standard) {
        None => format!("its mass is {} {unit}", value(whole[9])),
        Some([least, ..]) if least < 0.0 => format!(
            "a principal moment of inertia about its centre of mass is negative ({least:.3} {unit} m²)"
        ),
        Some([least, middle, largest]) => format!(
            "of its principal moments of inertia about its centre of mass, {least:.3}, {middle:.3} and {largest:.3} {unit} m², \
             the largest exceeds the sum of the others"
        ),
    };
    let amperes = if fitted.is_in_amperes() {
        "set `torque_constants_nm_per_a`, without which the joints have no common unit, or "
    } else {
        ""
    };
    Some(format!(
        "unphysical: the estimated inertia of the body on link {link} is impossible: {why}. Mass and centre of mass may still \
         be correct; {amperes}list the parameters that these motions excite (`parameters = [\"mX\", \"mY\", \"mZ\", \"m\"]`) or \
         record faster motions with the load"
    ))
}

/// Principal moments of inertia about the centre of mass, ascending; none without mass.
fn principal_moments(p: &[f64; 10]) -> Option<[f64; 3]> {
    let [xx, xy, xz, yy, yz, zz, mx, my, mz, m] = *p;
    // Steiner: I_c = I_o − (cᵀc 1 − c cᵀ) m with c = (mX, mY, mZ) / m.
    let (xy, xz, yz) = (xy + mx * my / m, xz + mx * mz / m, yz + my * mz / m);
    let (xx, yy, zz) =
        (xx - (my * my + mz * mz) / m, yy - (mx * mx + mz * mz) / m, zz - (mx * mx + my * my) / m);
    let about_centre = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    if m <= 0.0 || !about_centre.iter().all(|v| v.is_finite()) {
        return None;
    }
    let mut moments = about_centre.symmetric_eigenvalues();
    moments.as_mut_slice().sort_by(f64::total_cmp);
    Some(moments.into())
}

impl Fitted<'_> {
    fn is_in_amperes(&self) -> bool {
        self.unit_of_measurement == MeasurementUnit::Ampere
    }

    const fn unit(&self) -> &'static str {
        match self.unit_of_measurement {
            MeasurementUnit::NewtonMetre => "kg",
            MeasurementUnit::Ampere => "A/Nm kg",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 2.8 kg, 0.1 × 0.1 × 0.2 m, its centre at (0.01, 0.02, 0.1) in the link's frame.
    fn load() -> [f64; 10] {
        let (m, [x, y, z]): (f64, [f64; 3]) = (2.8, [0.01, 0.02, 0.1]);
        let side = |a: f64, b: f64| m * (a * a + b * b) / 12.0;
        [
            side(0.1, 0.2) + m * (y * y + z * z),
            -m * x * y,
            -m * x * z,
            side(0.1, 0.2) + m * (x * x + z * z),
            -m * y * z,
            side(0.1, 0.1) + m * (x * x + y * y),
            m * x,
            m * y,
            m * z,
            m,
        ]
    }

    #[test]
    fn a_box_can_exist_and_has_its_own_moments() {
        assert!(pseudo_inertia(&load()).symmetric_eigenvalues().min() > 0.0);
        let expected = [2.8 * 0.02 / 12.0, 2.8 * 0.05 / 12.0, 2.8 * 0.05 / 12.0];
        for (found, wanted) in principal_moments(&load()).unwrap().into_iter().zip(expected) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }

    #[test]
    fn moments_that_break_the_triangle_inequality_are_of_no_body() {
        let mut flat = load();
        flat[5] += 0.03;
        let moments = principal_moments(&flat).unwrap();
        assert!(moments[0] > 0.0 && moments[2] > moments[0] + moments[1], "{moments:?}");
        assert!(pseudo_inertia(&flat).symmetric_eigenvalues().min() < 0.0);
    }

    #[test]
    fn what_has_no_mass_has_no_moments() {
        assert_eq!(principal_moments(&[0.0; 10]), None);
        let mut lifted = load();
        lifted[9] = -1.0;
        assert_eq!(principal_moments(&lifted), None);
    }
}
