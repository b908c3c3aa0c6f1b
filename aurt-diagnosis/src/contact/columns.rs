use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};

use crate::error::DiagnosisError;
use crate::recordings::rows::RecordingRows;

/// The torques of a force of 1 N on a link, at the origin of its frame, along the axes of the base frame: what the
/// drives have to add to hold against it, −Jᵀ e_k.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceColumns {
    /// `[axis][joint][row]`; a joint that does not feel the link has an empty series.
    pub axes: [Vec<Vec<f64>>; 3],
}

/// The columns of a force on each link over a recording's rows.
///
/// A unit mass at the origin of a link's frame, at rest under the gravity e_k, weighs 1 N along e_k; so the column
/// of the link's mass in the rigid-body regressor at zero velocity and acceleration is that of the force.
///
/// # Errors
/// If the rows' series do not fit together.
pub fn force_columns(
    body: &dyn RigidBodyRegressor,
    rows: &RecordingRows,
) -> Result<Vec<ForceColumns>, DiagnosisError> {
    let joints = body.joints();
    let count = rows.rows();
    let position: Vec<f64> = rows.joints.iter().flat_map(|j| j.position_rad.iter().copied()).collect();
    let still = vec![0.0; position.len()];
    let rest = Motion::new(joints, rows.time_s.clone(), position, still.clone(), still)?;
    let standard = body.standard_parameters();
    // Where joints follow others there are more links than joints that move on their own.
    let masses: Vec<usize> = (0..standard.len())
        .map_while(|link| standard.iter().position(|p| p.name == format!("m_{link}")))
        .collect();
    let mut links: Vec<ForceColumns> =
        masses.iter().map(|_| ForceColumns { axes: [const { Vec::new() }; 3] }).collect();
    for axis in 0..3 {
        let mut gravity = [0.0; 3];
        gravity[axis] = 1.0;
        let weighed = body.with_gravity(gravity);
        let mut destination = vec![RegressorTile::UNWANTED; joints * standard.len()];
        for joint in 0..joints {
            for (link, mass) in masses.iter().enumerate() {
                destination[joint * standard.len() + mass] = (joint * masses.len() + link) as u32;
            }
        }
        let mut data = vec![0.0; joints * masses.len() * count];
        let mut tile = RegressorTile::new(&destination, standard.len(), count, count, &mut data);
        weighed.evaluate(rest.view(), &mut tile);
        for (link, columns) in links.iter_mut().enumerate() {
            columns.axes[axis] = (0..joints)
                .map(|joint| {
                    if !body.loads(masses[link], joint) {
                        return Vec::new();
                    }
                    let start = (joint * masses.len() + link) * count;
                    data[start..start + count].to_vec()
                })
                .collect();
        }
    }
    Ok(links)
}
