//! Which chain of a tree is meant.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

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
    let chain: HashSet<usize> = joints.iter().copied().collect();
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
                Some(followed) if !chain.contains(&followed.joint) => format!(
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
    let closed = closed_paths(tree, base);
    // Of each chain its tip, its last moving joint, and whether it ends before a joint that follows one beside it.
    let mut chains: Vec<(usize, usize, bool)> = Vec::new();
    let mut chain_of: HashMap<usize, usize> = HashMap::new();
    for leaf in (0..tree.links.len()).filter(|l| tree.links[*l].children.is_empty()) {
        let joint = tree.links[leaf].parent;
        let Some(Closed { end, moving: Some(last) }) = joint.and_then(|joint| closed[joint]) else {
            continue;
        };
        let cut = end != joint;
        let tip = end.map_or(base, |end| tree.joints[end].child);
        match chain_of.entry(last) {
            // The longer of two, so that a hand on the wrist is the chain's end and not a label on the wrist.
            Entry::Occupied(known) => {
                let known = &mut chains[*known.get()];
                if cut && !known.2 {
                    *known = (tip, last, true);
                }
            }
            Entry::Vacant(new) => {
                new.insert(chains.len());
                chains.push((tip, last, cut));
            }
        }
    }
    // A leaf on fixed joints half-way along a chain ends none.
    let mut passed = vec![false; tree.joints.len()];
    for (_, last, _) in &chains {
        let above = |joint: usize| tree.links[tree.joints[joint].parent].parent;
        let mut next = above(*last);
        while let Some(joint) = next.filter(|joint| !passed[*joint]) {
            passed[joint] = true;
            next = above(joint);
        }
    }
    chains.iter().filter(|(_, last, cut)| *cut || !passed[*last]).map(|(tip, ..)| *tip).collect()
}

/// The longest beginning of a path from the base in which no joint follows one outside it.
#[derive(Debug, Clone, Copy, Default)]
struct Closed {
    /// Its last joint; none if it is empty.
    end: Option<usize>,
    /// Its last joint that is not fixed.
    moving: Option<usize>,
}

/// Of the path to every joint its closed beginning; none of joints that do not hang on the base. A walk that goes through
/// every joint once, and counts the joints on the way whose leader has not been passed.
fn closed_paths(tree: &Tree, base: usize) -> Vec<Option<Closed>> {
    let joints = tree.joints.len();
    let mut closed = vec![None; joints];
    let (mut on_path, mut waiting) = (vec![false; joints], vec![0_usize; joints]);
    let mut without_leader = 0;
    // Each with the closed beginning, and the last moving joint, of the path before it.
    let below = |link: usize, before: (Closed, Option<usize>)| {
        tree.links[link].children.iter().map(move |joint| (*joint, Some(before)))
    };
    let mut open: Vec<_> = below(base, (Closed::default(), None)).collect();
    while let Some((joint, before)) = open.pop() {
        let here = &tree.joints[joint];
        let follows = here.mimic.is_some() && here.moves();
        let leader = tree.followed(joint).filter(|f| f.multiplier != 0.0).map(|f| f.joint);
        let missing = follows && leader.is_none_or(|leader| !on_path[leader]);
        let Some((before, moving)) = before else {
            // Back from all below it.
            if missing {
                without_leader -= 1;
                leader.iter().for_each(|leader| waiting[*leader] -= 1);
            }
            on_path[joint] = false;
            without_leader += waiting[joint];
            continue;
        };
        if missing {
            without_leader += 1;
            leader.iter().for_each(|leader| waiting[*leader] += 1);
        }
        on_path[joint] = true;
        without_leader -= waiting[joint];
        let moving = if here.freedom == Freedom::Fixed { moving } else { Some(joint) };
        let beginning = if without_leader == 0 { Closed { end: Some(joint), moving } } else { before };
        closed[joint] = Some(beginning);
        open.push((joint, None));
        open.extend(below(here.child, (beginning, moving)));
    }
    closed
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
