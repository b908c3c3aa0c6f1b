//! Masses and inertias of shapes: what MuJoCo computes of `<geom>` for a body without `<inertial>`.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::classes::Classes;
use super::settings::{Settings, WRITE_OUT, z_onto};
use crate::robots::RobotError;
use crate::robots::element::Element;
use crate::robots::pose::{Body, Pose};

/// Density of a shape that states neither mass nor density, kg/m³.
const DENSITY_KG_M3: f64 = 1000.0;
/// Shapes whose volume follows from their sizes, and the number of these without and with `fromto`.
const SOLIDS: [(&str, usize, Option<usize>); 5] = [
    ("sphere", 1, None),
    ("capsule", 2, Some(1)),
    ("cylinder", 2, Some(1)),
    ("ellipsoid", 3, Some(1)),
    ("box", 3, Some(1)),
];

/// The mass of a `<geom>`, in the frame that `frame` has the shape's frame in; none of shapes without mass.
pub(super) fn mass<'x>(
    element: &Element<'_, 'x>,
    class: Option<&str>,
    frame: &Pose,
    (classes, settings): (&Classes<'x>, &Settings),
) -> Result<Option<Body>, RobotError> {
    if let Some(name) = classes.unknown(element.node) {
        return Err(element.error(format!("there is no class `{name}` under <default>")));
    }
    let of = |name: &str| classes.attribute(element.node, class, name);
    let number = |name: &'static str| of(name).map(|text| element.parsed::<1>(name, text)).transpose();
    let kind = of("type").unwrap_or("sphere");
    let group = number("group")?.map_or(0.0, |[group]| group);
    let [first, last] = settings.mass_groups;
    if !(first..=last).contains(&group) || kind == "plane" || kind == "hfield" {
        return Ok(None);
    }
    let stated_kg = number("mass")?.map(|[mass_kg]| mass_kg);
    let density = number("density")?.map_or(DENSITY_KG_M3, |[density]| density);
    let weight = stated_kg.unwrap_or(density);
    if weight < 0.0 {
        return Err(element.error("its mass and density must not be negative"));
    }
    if weight == 0.0 {
        return Ok(None);
    }
    let unread = |what: &str| {
        let reason = format!("its mass is that of {what}, which is not computed here");
        element.error(format!("{reason}; give the body an <inertial>, or {WRITE_OUT}"))
    };
    let Some((_, alone, between)) = SOLIDS.into_iter().find(|(name, ..)| *name == kind) else {
        return Err(unread(&format!("a shape of the type `{kind}`")));
    };
    if of("mesh").is_some() {
        return Err(unread("a shape that is fitted to a mesh"));
    }
    if of("shellinertia") == Some("true") {
        return Err(unread("a shell"));
    }
    let ends = of("fromto").filter(|_| between.is_some());
    let ends = ends.map(|text| element.parsed::<6>("fromto", text)).transpose()?;
    let needed = if ends.is_some() { between.unwrap_or(alone) } else { alone };
    let mut size_m = [0.0; 3];
    for (size_m, text) in size_m.iter_mut().zip(classes.size(element.node, class)).take(needed) {
        [*size_m] = element.parsed("size", text.unwrap_or_default())?;
    }
    let pose = if let Some([ax, ay, az, bx, by, bz]) = ends {
        let (a, b) = (Vector3::new(ax, ay, az), Vector3::new(bx, by, bz));
        let half_m = (a - b).norm() / 2.0;
        size_m = if kind == "ellipsoid" || kind == "box" {
            [size_m[0], size_m[0], half_m]
        } else {
            [size_m[0], half_m, 0.0]
        };
        Pose { rotation: z_onto(&(a - b)), origin_m: (a + b) / 2.0 }
    } else {
        settings.angles.pose_by(element, &|name| classes.placing(element.node, class, name))?
    };
    if size_m.iter().take(alone).any(|size_m| *size_m <= 0.0) {
        return Err(element.error(format!("a {kind} needs {needed} `size`s above 0, in m")));
    }
    let (volume_m3, square_m2) = solid(kind, size_m);
    let mass_kg = stated_kg.unwrap_or(density * volume_m3);
    let inertia_kg_m2 = Matrix3::from_diagonal(&(Vector3::from(square_m2) * mass_kg));
    Ok(Some(Body { mass_kg, pose: frame.then(&pose), inertia_kg_m2 }))
}

/// Volume of a solid, and its moments of inertia about its centre for a mass of one.
fn solid(kind: &str, [a, b, c]: [f64; 3]) -> (f64, [f64; 3]) {
    let round = |across: f64, along: f64| [across, across, along];
    let squares = |[x, y, z]: [f64; 3], share: f64| [y + z, x + z, x + y].map(|sum| sum * share);
    let square = |of: [f64; 3]| of.map(|v: f64| v * v);
    match kind {
        "box" => (8.0 * a * b * c, squares(square([a, b, c]), 1.0 / 3.0)),
        "ellipsoid" => (4.0 / 3.0 * PI * a * b * c, squares(square([a, b, c]), 0.2)),
        "cylinder" => (2.0 * PI * a * a * b, round(a * a / 4.0 + b * b / 3.0, a * a / 2.0)),
        "capsule" => {
            // Two half balls at the ends of a cylinder: a ball's inertia, displaced.
            let balls = 2.0 * a / (2.0 * a + 3.0 * b);
            let ball = 0.4 * a * a;
            let displaced = b * (3.0 * a + 4.0 * b) / 4.0;
            let across = (1.0 - balls) * (a * a / 4.0 + b * b / 3.0) + balls * (ball + displaced);
            let along = (1.0 - balls) * a * a / 2.0 + balls * ball;
            (2.0 * PI * a * a * b + 4.0 / 3.0 * PI * a.powi(3), round(across, along))
        }
        _ => (4.0 / 3.0 * PI * a.powi(3), round(0.4 * a * a, 0.4 * a * a)),
    }
}
