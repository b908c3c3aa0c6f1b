//! The tree of bodies: frames, inertias, shapes to be seen.

use std::fmt::Write;

use aurt_rbd::{INERTIAL_PARAMETERS, JointKind, LinkBody, SerialChain};

use super::joint::JointDynamics;
use crate::ExportError;
use crate::source::frames;

/// Radius of the shapes, as a share of their length and at most, m.
const SLENDER: f64 = 0.15;
const THICKEST_M: f64 = 0.05;

/// The nested `body` elements. Frame j of the chain or tree at coordinate zero is the frame of body j; its joint turns
/// about, or slides along, the frame's z axis, in the sense of the joint's sign. The last body holds `in_last` as well.
pub(super) fn tree(
    name: &str,
    names: &[String],
    chain: &SerialChain,
    standard: &[f64],
    joints: &[JointDynamics],
    in_last: &str,
) -> Result<String, ExportError> {
    let frames = frames(chain)?;
    let mut text = String::new();
    let (bodies, _) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    let on = |parent: Option<usize>| (0..frames.len()).rev().filter(move |j| chain.parent(*j) == parent);
    let mut open: Vec<usize> = on(None).collect();
    let mut depth = 0;
    while let Some(j) = open.pop() {
        // Bodies end before the next on an earlier one begins.
        let carriers = chain.path(j).len() - 1;
        end_bodies(&mut text, carriers..depth);
        depth = carriers + 1;
        open.extend(on(Some(j)));
        let (frame, dynamics) = (&frames[j], &joints[j]);
        let indent = "  ".repeat(depth + 1);
        let (p, r) = (frame.origin_m, frame.rotation);
        let axes = [r[0][0], r[1][0], r[2][0], r[0][1], r[1][1], r[2][1]];
        let _ = writeln!(
            text,
            "{indent}<body name=\"{name}_link_{j}\" pos=\"{}\" xyaxes=\"{}\">",
            numbers(&p),
            numbers(&axes)
        );
        let body = LinkBody::from_standard_parameters(&bodies[j]).ok_or(ExportError::NoBodies)?;
        let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
        let _ = writeln!(
            text,
            "{indent}  <inertial pos=\"{}\" mass=\"{:?}\" fullinertia=\"{}\"/>",
            numbers(&body.com_m),
            body.mass_kg,
            numbers(&[xx, yy, zz, xy, xz, yz])
        );
        let joint = &chain.joints()[j];
        let kind = match joint.kind {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        let _ = write!(
            text,
            "{indent}  <joint name=\"{}\" type=\"{kind}\" axis=\"0 0 {}\"",
            names[j], joint.sign
        );
        for (attribute, value) in [
            ("armature", dynamics.armature),
            ("damping", dynamics.damping),
            ("frictionloss", dynamics.friction_loss),
            ("stiffness", dynamics.stiffness),
            ("springref", dynamics.spring_ref),
        ] {
            if value != 0.0 {
                let _ = write!(text, " {attribute}=\"{value:?}\"");
            }
        }
        if let Some(range) = dynamics.range {
            let _ = write!(text, " limited=\"true\" range=\"{}\"", numbers(&range));
        }
        text.push_str("/>\n");
        if j + 1 == frames.len() && !in_last.is_empty() {
            let _ = write!(text, "{indent}  {in_last}");
        }
        // A last link ends at its centre of mass, as far as the model knows.
        let end = on(Some(j)).next_back().map_or(body.com_m, |next| frames[next].origin_m);
        let length = end.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length > 1e-3 {
            let _ = writeln!(
                text,
                "{indent}  <geom type=\"capsule\" fromto=\"0.0 0.0 0.0 {}\" size=\"{:?}\" contype=\"0\" \
                 conaffinity=\"0\" group=\"1\" mass=\"0\"/>",
                numbers(&end),
                (SLENDER * length).min(THICKEST_M)
            );
        }
    }
    end_bodies(&mut text, 0..depth);
    Ok(text)
}

fn end_bodies(text: &mut String, depths: std::ops::Range<usize>) {
    for depth in depths.rev() {
        let _ = writeln!(text, "{}</body>", "  ".repeat(depth + 2));
    }
}

pub(crate) fn numbers(values: &[f64]) -> String {
    values.iter().map(|v| format!("{:?}", if *v == 0.0 { 0.0 } else { *v })).collect::<Vec<_>>().join(" ")
}
