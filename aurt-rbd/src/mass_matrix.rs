use crate::ChainDynamics;
use crate::dynamics::on_axis;

impl ChainDynamics {
    /// The joint-space mass matrix M(q), N × N, row after row, rotor inertias on its diagonal, in kg m² (kg m where a
    /// revolute joint meets a prismatic one, kg among prismatic ones), by
    /// the composite-rigid-body algorithm (Featherstone, section 6.2). Entries of two joints neither of which carries the
    /// other are zero (section 6.3).
    ///
    /// # Panics
    /// If `q_rad` does not have N entries or `mass_matrix_kg_m2` N².
    pub fn mass_matrix(&mut self, q_rad: &[f64], mass_matrix_kg_m2: &mut [f64]) {
        let joints = self.joints();
        assert_eq!(mass_matrix_kg_m2.len(), joints * joints, "entries of the mass matrix");
        self.place(q_rad);
        for (link, body) in self.scratch.iter_mut().zip(&self.links) {
            link.articulated = body.articulated();
        }
        if !self.chain.is_serial() {
            mass_matrix_kg_m2.fill(0.0);
        }
        let (all, scratch) = (self.chain.joints(), &mut self.scratch[..]);
        for (i, joint) in all.iter().enumerate().rev() {
            let composite = scratch[i].articulated;
            let (moment, force) = composite.along_axis(joint.kind);
            let own = on_axis(joint.kind, &moment, &force);
            mass_matrix_kg_m2[i * joints + i] = own + self.rotor_inertia_kg_m2[i];
            let (mut moment, mut force) = (moment * joint.sign, force * joint.sign);
            // The force that accelerates the links from i on, as each joint that carries them feels it.
            for step in self.chain.path(i).windows(2).rev() {
                let (j, link, joint) = (step[0], &scratch[step[1]], &all[step[0]]);
                force = link.rotation * force;
                moment = link.rotation * moment + link.origin.cross(&force);
                let entry = joint.sign * on_axis(joint.kind, &moment, &force);
                mass_matrix_kg_m2[i * joints + j] = entry;
                mass_matrix_kg_m2[j * joints + i] = entry;
            }
            if let Some(parent) = joint.parent.of(i) {
                let carried = composite.in_previous(&scratch[i].rotation, &scratch[i].origin);
                let previous = &mut scratch[parent].articulated;
                previous.j += carried.j;
                previous.h += carried.h;
                previous.m += carried.m;
            }
        }
    }
}
