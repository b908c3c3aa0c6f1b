//! Which chain of a tree is meant.

use crate::RobotError;
use crate::tree::{Freedom, Tree};

/// How many names a message lists.
const MOST_NAMES: usize = 40;

/// A chain of a tree.
#[derive(Debug)]
pub(crate) struct Selection {
    pub base: usize,
    pub tip: usize,
    /// The joints from base to tip, fixed ones among them.
    pub joints: Vec<usize>,
}

/// The chain from `base` to `tip`, each chosen by itself where there is only one choice.
pub(crate) fn select(tree: &Tree, base: Option<&str>, tip: Option<&str>) -> Result<Selection, RobotError> {
    let base = base_of(tree, base)?;
    let tip = match tip {
        Some(name) => find(tree, "tip", name)?,
        None => only_tip(tree, base)?,
    };
    let (base_name, tip_name) = (&tree.links[base].name, &tree.links[tip].name);
    let no_chain = |reason: String| RobotError::NoChain { path: tree.path.clone(), reason };
    let joints = tree.path_between(base, tip).ok_or_else(|| {
        no_chain(format!(
            "the tip `{tip_name}` does not hang on the base `{base_name}`; choose a base above it"
        ))
    })?;
    for (index, joint) in joints.iter().map(|j| (*j, &tree.joints[*j])) {
        let before = &tree.links[joint.parent].name;
        let reason = match (&joint.freedom, &joint.mimic) {
            (Freedom::Other(kind), _) => format!(
                "is {kind}, which serial chains cannot have; choose a base behind it: `{}`",
                tree.links[joint.child].name
            ),
            (_, Some(mimic)) if joint.moves() => match tree.followed(index) {
                None => format!(
                    "follows the joint {} (mimic), which is not there, does not move or follows this one in turn; correct \
                     <mimic>, or choose the tip before it: `{before}`",
                    mimic.joint
                ),
                Some(followed) if !joints.contains(&followed.joint) => format!(
                    "follows the joint {} (mimic), which is beside the chain, so that nobody knows how it moves; choose \
                     the tip before it: `{before}`",
                    tree.joints[followed.joint].name
                ),
                Some(followed) if followed.multiplier == 0.0 => {
                    "follows a joint with the multiplier 0 (mimic), and so does not move; make its type `fixed`".into()
                }
                Some(_) => continue,
            },
            _ => continue,
        };
        let what = format!("joint {}", joint.name);
        return Err(RobotError::Element { path: tree.path.clone(), line: joint.line, what, reason });
    }
    if !joints.iter().any(|j| tree.joints[*j].moves()) {
        return Err(no_chain(format!("between `{base_name}` and `{tip_name}` there is no joint that moves")));
    }
    Ok(Selection { base, tip, joints })
}

/// The base link: that of the name, or the only root.
pub(crate) fn base_of(tree: &Tree, base: Option<&str>) -> Result<usize, RobotError> {
    if let Some(name) = base {
        return find(tree, "base", name);
    }
    let roots: Vec<usize> = (0..tree.links.len()).filter(|l| tree.links[*l].parent.is_none()).collect();
    match roots[..] {
        [root] => Ok(root),
        _ => {
            let names: Vec<&str> = roots.iter().map(|l| tree.links[*l].name.as_str()).collect();
            let reason =
                format!("several links hang on no joint; choose one as the base: {}", listed(&names));
            Err(RobotError::NoTree { path: tree.path.clone(), reason })
        }
    }
}

fn find(tree: &Tree, which: &'static str, name: &str) -> Result<usize, RobotError> {
    if let Some(link) = tree.links.iter().position(|l| l.name == name) {
        return Ok(link);
    }
    let distance = |link: &str| strsim::osa_distance(&link.to_lowercase(), &name.to_lowercase());
    let names = tree.links.iter().map(|l| l.name.as_str());
    let meant = names.clone().min_by_key(|l| distance(l)).filter(|l| distance(l) <= 1 + name.len() / 4);
    let mut known: Vec<String> = names.take(MOST_NAMES).map(Into::into).collect();
    if tree.links.len() > MOST_NAMES {
        known.push(format!("and {} more", tree.links.len() - MOST_NAMES));
    }
    Err(RobotError::UnknownLink {
        path: tree.path.clone(),
        which,
        name: name.into(),
        meant: meant.map(Into::into),
        known,
    })
}

/// The links at which the moving chains end, in the file's order: the leaves, and the links that carry a joint that
/// follows one beside the chain. Chains that differ by fixed joints alone count once.
pub(crate) fn tips(tree: &Tree, base: usize) -> Vec<usize> {
    // Of each chain its tip, its last moving joint, and whether it ends before a joint that follows one beside it.
    let mut chains: Vec<(usize, usize, bool)> = Vec::new();
    for leaf in (0..tree.links.len()).filter(|l| tree.links[*l].children.is_empty()) {
        let Some(mut path) = tree.path_between(base, leaf) else { continue };
        let (mut tip, mut cut) = (leaf, None);
        // A cut can take away what a joint before it follows.
        while let Some(at) = path.iter().position(|j| follows_another_beside(tree, *j, &path)) {
            (tip, cut) = (tree.joints[path[at]].parent, Some(at));
            path.truncate(at);
        }
        let moving = |j: &usize| tree.joints[*j].freedom != Freedom::Fixed;
        let Some(last) = path.into_iter().rfind(moving) else { continue };
        match chains.iter_mut().find(|(_, other, _)| *other == last) {
            // The longer of two, so that a hand on the wrist is the chain's end and not a label on the wrist.
            Some(known) if cut.is_some() && !known.2 => *known = (tip, last, true),
            Some(_) => (),
            None => chains.push((tip, last, cut.is_some())),
        }
    }
    // A leaf on fixed joints half-way along a chain ends none.
    let passed = |last: usize| {
        chains.iter().any(|(_, other, _)| {
            *other != last && tree.path_between(tree.joints[last].child, tree.joints[*other].child).is_some()
        })
    };
    chains.iter().filter(|(_, last, cut)| *cut || !passed(*last)).map(|(tip, ..)| *tip).collect()
}

/// Whether a joint of a path follows one that is not on it.
fn follows_another_beside(tree: &Tree, joint: usize, path: &[usize]) -> bool {
    let follows = tree.joints[joint].mimic.is_some() && tree.joints[joint].moves();
    follows && tree.followed(joint).is_none_or(|f| !path.contains(&f.joint) || f.multiplier == 0.0)
}

fn only_tip(tree: &Tree, base: usize) -> Result<usize, RobotError> {
    let base_name = &tree.links[base].name;
    match tips(tree, base)[..] {
        [tip] => Ok(tip),
        [] => Err(RobotError::NoChain {
            path: tree.path.clone(),
            reason: format!("no joint that moves hangs on the base `{base_name}`"),
        }),
        ref several => {
            let moving = |tip: usize| {
                let path = tree.path_between(base, tip).unwrap_or_default();
                let own = |j: &&usize| tree.joints[**j].moves() && tree.joints[**j].mimic.is_none();
                path.iter().filter(own).count()
            };
            let mut tips: Vec<String> = several
                .iter()
                .take(MOST_NAMES)
                .map(|tip| format!("{} ({} joints)", tree.links[*tip].name, moving(*tip)))
                .collect();
            if several.len() > MOST_NAMES {
                tips.push(format!("and {} more", several.len() - MOST_NAMES));
            }
            Err(RobotError::Tips { path: tree.path.clone(), base: base_name.clone(), tips })
        }
    }
}

fn listed(names: &[&str]) -> String {
    names.iter().take(MOST_NAMES).copied().collect::<Vec<_>>().join(", ")
}
