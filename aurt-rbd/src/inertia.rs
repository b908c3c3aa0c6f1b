use nalgebra::Matrix3;

use crate::INERTIAL_PARAMETERS;

/// A link's mass distribution as data sheets and CAD give it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkBody {
    /// Mass in kg.
    pub mass_kg: f64,
    /// Centre of mass in the link frame, in m.
    pub com_m: [f64; 3],
    /// Inertia about the centre of mass along the axes of the link frame, in kg m², {XX XY XZ YY YZ ZZ};
    /// XY, XZ, YZ are the matrix entries, −∫xy dm.
    pub inertia_at_com_kg_m2: [f64; 6],
}

impl LinkBody {
    /// The ten standard parameters {XX XY XZ YY YZ ZZ mX mY mZ m}, inertia about the link frame's origin:
    /// I = I_C + m (c·c 1 − c cᵀ).
    pub fn standard_parameters(&self) -> [f64; INERTIAL_PARAMETERS] {
        let [x, y, z] = self.com_m;
        let m = self.mass_kg;
        let [xx, xy, xz, yy, yz, zz] = self.inertia_at_com_kg_m2;
        [
            xx + m * (y * y + z * z),
            xy - m * x * y,
            xz - m * x * z,
            yy + m * (x * x + z * z),
            yz - m * y * z,
            zz + m * (x * x + y * y),
            m * x,
            m * y,
            m * z,
            m,
        ]
    }

    /// The body of ten standard parameters; `None` if the mass is not positive or anything is not finite.
    pub fn from_standard_parameters(standard: &[f64; INERTIAL_PARAMETERS]) -> Option<Self> {
        let [xx, xy, xz, yy, yz, zz, mx, my, mz, m] = *standard;
        if m <= 0.0 || !standard.iter().all(|v| v.is_finite()) {
            return None;
        }
        let [x, y, z] = [mx / m, my / m, mz / m];
        Some(Self {
            mass_kg: m,
            com_m: [x, y, z],
            inertia_at_com_kg_m2: [
                xx - m * (y * y + z * z),
                xy + m * x * y,
                xz + m * x * z,
                yy - m * (x * x + z * z),
                yz + m * y * z,
                zz - m * (x * x + y * y),
            ],
        })
    }
}

/// Why a link's parameters cannot be those of a body of positive density.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum Inconsistency {
    NotFinite { link: usize },
    Mass { link: usize, mass_kg: f64 },
    Inertia { link: usize, smallest_kg_m2: f64 },
    Triangle { link: usize, excess_kg_m2: f64 },
}

impl std::fmt::Display for Inconsistency {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite { link } => write!(f, "link {link}: a parameter is not finite"),
            Self::Mass { link, mass_kg } => write!(f, "link {link}: the mass is {mass_kg} kg"),
            Self::Inertia { link, smallest_kg_m2 } => write!(
                f,
                "link {link}: the inertia about the centre of mass is not positive definite \
                 (smallest principal moment {smallest_kg_m2} kg m^2)"
            ),
            Self::Triangle { link, excess_kg_m2 } => write!(
                f,
                "link {link}: one principal moment exceeds the sum of the others by {excess_kg_m2} kg m^2"
            ),
        }
    }
}

/// Checks 10 N standard parameters for physical consistency: mass > 0, inertia about the centre of mass
/// positive definite, principal moments within the triangle inequality (Traversaro et al., IROS 2016). Up to
/// one complaint per link; empty if there are bodies that have these parameters.
///
/// Rounding of 1e-12 relative is forgiven in the triangle inequality, which flat bodies meet with equality.
///
/// Base parameters as estimated need not pass: they are combinations of the parameters of several links.
///
/// # Panics
/// If the number of parameters is no multiple of ten.
pub fn inconsistencies(standard: &[f64]) -> Vec<Inconsistency> {
    let (links, rest) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    assert!(rest.is_empty(), "ten parameters per link");
    links.iter().enumerate().filter_map(|(link, p)| inconsistency(link, p)).collect()
}

fn inconsistency(link: usize, standard: &[f64; INERTIAL_PARAMETERS]) -> Option<Inconsistency> {
    if !standard.iter().all(|v| v.is_finite()) {
        return Some(Inconsistency::NotFinite { link });
    }
    let Some(body) = LinkBody::from_standard_parameters(standard) else {
        return Some(Inconsistency::Mass { link, mass_kg: standard[INERTIAL_PARAMETERS - 1] });
    };
    let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
    let mut moments = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues();
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let [smallest, middle, largest] = [moments[0], moments[1], moments[2]];
    if smallest <= 0.0 {
        return Some(Inconsistency::Inertia { link, smallest_kg_m2: smallest });
    }
    let excess = largest - smallest - middle;
    (excess > 1e-12 * standard[0].abs().max(standard[3].abs()).max(largest))
        .then_some(Inconsistency::Triangle { link, excess_kg_m2: excess })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of mass 2 kg and edges 0.2, 0.3, 0.4 m, centred at (0.1, −0.2, 0.3).
    const BOX: LinkBody = LinkBody {
        mass_kg: 2.0,
        com_m: [0.1, -0.2, 0.3],
        inertia_at_com_kg_m2: [
            2.0 / 12.0 * (0.09 + 0.16),
            0.0,
            0.0,
            2.0 / 12.0 * (0.04 + 0.16),
            0.0,
            2.0 / 12.0 * (0.04 + 0.09),
        ],
    };

    #[test]
    fn steiner_by_hand_and_back() {
        let standard = BOX.standard_parameters();
        assert!((standard[0] - (2.0 * 0.25 / 12.0 + 2.0 * (0.04 + 0.09))).abs() < 1e-15);
        assert!((standard[1] - 2.0 * 0.1 * 0.2).abs() < 1e-15, "XY is −m x y");
        assert_eq!(standard[6..], [0.2, -0.4, 0.6, 2.0]);
        let back = LinkBody::from_standard_parameters(&standard).unwrap();
        assert!((back.com_m[2] - 0.3).abs() < 1e-15);
        for (a, b) in back.inertia_at_com_kg_m2.iter().zip(BOX.inertia_at_com_kg_m2) {
            assert!((a - b).abs() < 1e-15);
        }
        let mut massless = standard;
        massless[9] = 0.0;
        assert_eq!(LinkBody::from_standard_parameters(&massless), None);
    }

    #[test]
    fn bodies_that_cannot_be_are_named() {
        let with = |change: &dyn Fn(&mut [f64; INERTIAL_PARAMETERS])| {
            let mut standard = BOX.standard_parameters();
            change(&mut standard);
            inconsistencies(&[BOX.standard_parameters(), standard].concat())
        };
        assert_eq!(with(&|_| ()), []);
        assert!(matches!(with(&|p| p[9] = -1.0)[..], [Inconsistency::Mass { link: 1, mass_kg: -1.0 }]));
        assert!(matches!(with(&|p| p[0] = f64::NAN)[..], [Inconsistency::NotFinite { link: 1 }]));
        // With more mass at the same first moment, the inertia at the centre of mass grows; with less it is
        // used up.
        assert!(matches!(with(&|p| p[9] = 1.0)[..], [Inconsistency::Inertia { link: 1, .. }]));
        assert!(matches!(with(&|p| p[5] += 1.0)[..], [Inconsistency::Triangle { link: 1, .. }]));
        let words = with(&|p| p[5] += 1.0)[0].to_string();
        assert!(
            words.starts_with("link 1: one principal moment exceeds the sum of the others by 0.9"),
            "{words}"
        );
        // A flat plate meets the triangle inequality with equality.
        let plate = LinkBody { inertia_at_com_kg_m2: [0.01, 0.0, 0.0, 0.02, 0.0, 0.03], ..BOX };
        assert_eq!(inconsistencies(&plate.standard_parameters()), []);
    }
}
