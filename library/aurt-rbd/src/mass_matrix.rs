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
        mass_matrix_kg_m2.fill(0.0);
        for i in (0..joints).rev() {
            let composite = self.scratch[i].articulated;
            let joint = &self.chain.joints()[i];
            let (moment, force) = composite.along_axis(joint.kind);
            let own = on_axis(joint.kind, &moment, &force);
            mass_matrix_kg_m2[i * joints + i] = own + self.rotor_inertia_kg_m2[i];
            let (mut moment, mut force) = (moment * joint.sign, force * joint.sign);
            // The force that accelerates the links from i on, as each joint that carries them feels it.
            let mut child = i;
            while let Some(j) = self.chain.parent(child) {
                let link = &self.scratch[child];
                force = link.rotation * force;
                moment = link.rotation * moment + link.origin.cross(&force);
                let joint = &self.chain.joints()[j];
                let entry = joint.sign * on_axis(joint.kind, &moment, &force);
                mass_matrix_kg_m2[i * joints + j] = entry;
                mass_matrix_kg_m2[j * joints + i] = entry;
                child = j;
            }
            if let Some(parent) = self.chain.parent(i) {
                let carried = composite.in_previous(&self.scratch[i].rotation, &self.scratch[i].origin);
                let previous = &mut self.scratch[parent].articulated;
                previous.j += carried.j;
                previous.h += carried.h;
                previous.m += carried.m;
            }
        }
    }
}
