//! `<equality>`: joints that follow others, and what ties joints in ways that models do not know.

use std::collections::HashMap;

use roxmltree::Node;

use crate::robots::RobotError;
use crate::robots::element::{Element, Source};
use crate::robots::mjcf::WORLD;
use crate::robots::tree::{Mimic, Tie, Tree};

/// Reads the constraints of a file into the joints of its tree; `references` are the coordinates `ref` of joints that have one.
///
/// A constraint `joint` is q₁ − ref₁ = Σ c_k (q₂ − ref₂)^k. Up to k = 1 joint 1 follows joint 2; all else ties the joints that it
/// acts on, which is refused where one of them moves.
pub(super) fn read<'x>(
    root: Node<'x, 'x>,
    source: &Source<'_>,
    references: &HashMap<String, f64>,
    tree: &mut Tree,
) -> Result<(), RobotError> {
    let constraints = root.children().filter(|c| c.has_tag_name("equality")).flat_map(|c| c.children());
    for node in constraints.filter(|n| n.is_element() && n.attribute("active") != Some("false")) {
        let kind = node.tag_name().name();
        let element = Element { node, what: format!("<equality>, <{kind}>"), source };
        let (joints, reason) = match kind {
            "joint" => match follows(&element, references, tree)? {
                None => continue,
                Some(tie) => tie,
            },
            "tendon" => {
                let named = ["tendon1", "tendon2"].into_iter().filter_map(|key| node.attribute(key));
                (named.flat_map(|name| of_tendon(root, name, tree)).collect(), "ties tendons".into())
            }
            _ => {
                let ends = [["body1", "site1"], ["body2", "site2"]];
                let above = ends.map(|[body, site]| {
                    let of_site = node.attribute(site).and_then(|name| body_of(root, "site", name));
                    above(tree, node.attribute(body).or(of_site).unwrap_or(WORLD))
                });
                let apart = above[0].iter().filter(|j| !above[1].contains(j));
                let apart = apart.chain(above[1].iter().filter(|j| !above[0].contains(j)));
                (apart.copied().collect(), "closes a loop of bodies".into())
            }
        };
        tree.ties.push(Tie { line: element.line(), what: element.what.clone(), reason, joints });
    }
    Ok(())
}

/// Lets a joint follow another; else the joints that a constraint ties, and how.
fn follows(
    element: &Element<'_, '_>,
    references: &HashMap<String, f64>,
    tree: &mut Tree,
) -> Result<Option<(Vec<usize>, String)>, RobotError> {
    let find = |name: &str| {
        let found = tree.joints.iter().position(|joint| joint.name == name);
        found.ok_or_else(|| element.error(format!("there is no joint `{name}`")))
    };
    let follower = element.text("joint1")?;
    let first = find(follower)?;
    // Coefficients that are left out are those of the default, joint 1 = joint 2.
    let given = element.node.attribute("polycoef").unwrap_or_default();
    let missing = "0 1 0 0 0".split(' ').skip(given.split_whitespace().count());
    let text = [given].into_iter().chain(missing).collect::<Vec<_>>().join(" ");
    let [constant, slope, curved @ ..] = element.parsed::<5>("polycoef", &text)?;
    let Some(leader) = element.node.attribute("joint2") else {
        return Ok(Some((vec![first], "holds a joint at a position; remove the joint".into())));
    };
    let second = find(leader)?;
    let reference = |name: &str| references.get(name).copied().unwrap_or(0.0);
    let reason = if curved != [0.0; 3] {
        "lets a joint follow another by a polynomial of a higher order"
    } else if slope == 0.0 {
        "holds a joint at a position; remove the joint"
    } else if tree.joints[first].mimic.is_some() {
        "is the second to tie its joint 1"
    } else {
        let offset = reference(follower) + constant - slope * reference(leader);
        let mimic = Mimic { joint: leader.to_owned(), multiplier: slope, offset };
        tree.joints[first].mimic = Some(mimic);
        return Ok(None);
    };
    Ok(Some((vec![first, second], reason.into())))
}

fn of_tendon(root: Node<'_, '_>, name: &str, tree: &Tree) -> Vec<usize> {
    let tendons = root.children().filter(|c| c.has_tag_name("tendon")).flat_map(|c| c.children());
    let tendon = tendons.into_iter().find(|t| t.attribute("name") == Some(name));
    let parts = tendon.into_iter().flat_map(|t| t.children());
    let joints = parts.flat_map(|part| {
        let named = part.attribute("joint");
        let at = named.and_then(|name| tree.joints.iter().position(|joint| joint.name == name));
        let body = ["site", "geom"].into_iter().find_map(|kind| body_of(root, kind, part.attribute(kind)?));
        at.into_iter().chain(body.map_or_else(Vec::new, |body| above(tree, body)))
    });
    joints.collect()
}

/// The body that a named site or shape is in.
fn body_of<'x>(root: Node<'x, 'x>, kind: &str, name: &str) -> Option<&'x str> {
    let mut all = root.descendants().filter(|n| n.has_tag_name(kind));
    let of = all.find(|n| n.attribute("name") == Some(name))?;
    of.ancestors().find(|n| n.has_tag_name("body"))?.attribute("name")
}

fn above(tree: &Tree, body: &str) -> Vec<usize> {
    let mut joints = Vec::new();
    let mut link = tree.links.iter().position(|link| link.name == body).unwrap_or(0);
    while let Some(joint) = tree.links[link].parent {
        joints.push(joint);
        link = tree.joints[joint].parent;
    }
    joints
}
