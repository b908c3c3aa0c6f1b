//! Which part of a tree is meant.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use aurt_files::suggestion::likely;

use crate::MOST_JOINTS;
use crate::robots::RobotError;
use crate::robots::description::Part;
use crate::robots::tree::{Freedom, Tie, Tree};

const MOST_NAMES: usize = 40;

#[derive(Debug)]
pub(crate) struct Selection {
    pub base: usize,
    /// The link at which a chain ends, none of a tree.
    pub tip: Option<usize>,
    /// The joints from the base to all that move, fixed ones among them; each comes after those before it.
    pub joints: Vec<usize>,
    /// Of every joint of the tree, whether it is one of these.
    pub on_path: Vec<bool>,
    /// Of every joint of the tree, whether it is one of these and moves.
    pub moves: Vec<bool>,
}

/// The part of a tree on the base of the given name, or the only root.
pub(crate) fn select(tree: &Tree, base: Option<&str>, part: &Part) -> Result<Selection, RobotError> {
    let base = base_of(tree, base)?;
    let one_degree = |joint: usize| tree.joints[joint].moves();
    let (ends, moves): (Vec<usize>, Vec<bool>) = match part {
        Part::All => match tips(tree, base)[..] {
            [] => return Err(nothing_moves(tree, base)),
            [tip] => return of_chain(tree, base, tip),
            _ => {
                let all: Vec<usize> = (0..tree.joints.len()).filter(|joint| one_degree(*joint)).collect();
                (all.iter().map(|joint| tree.joints[*joint].child).collect(), vec![true; tree.joints.len()])
            }
        },
        Part::Tips(tips) => {
            match &tips.iter().map(|tip| find_link(tree, "the tip", tip)).collect::<Result<Vec<_>, _>>()?[..]
            {
                [tip] => return of_chain(tree, base, *tip),
                several => (several.to_vec(), vec![true; tree.joints.len()]),
            }
        }
        Part::Joints(names) => {
            let named = names.iter().map(|name| find_joint(tree, name)).collect::<Result<Vec<_>, _>>()?;
            let moves: Vec<bool> = (0..tree.joints.len())
                .map(|joint| {
                    let leader = tree.followed(joint).map(|followed| followed.joint);
                    named.contains(&joint) || leader.is_some_and(|leader| named.contains(&leader))
                })
                .collect();
            let follows = |joint: &usize| moves[*joint] && one_degree(*joint) && !named.contains(joint);
            let chosen = named.iter().copied().chain((0..tree.joints.len()).filter(follows));
            (chosen.map(|joint| tree.joints[joint].child).collect(), moves)
        }
    };
    // Where joints branch, those come first that lead to the end that is named first, and in the file's order without names.
    let mut first_end: Vec<Option<usize>> = vec![None; tree.joints.len()];
    for (rank, end) in ends.into_iter().enumerate() {
        let rank = if *part == Part::All { 0 } else { rank };
        let mut link = end;
        while link != base {
            match tree.links[link].parent {
                Some(joint) if first_end[joint].is_some() => break,
                Some(joint) => {
                    first_end[joint] = Some(rank);
                    link = tree.joints[joint].parent;
                }
                // Of all joints, those that do not hang on the base are none of the robot.
                None if *part == Part::All => break,
                None => return Err(beside(tree, base, end)),
            }
        }
    }
    let mut joints = Vec::new();
    let mut open = vec![base];
    while let Some(link) = open.pop() {
        joints.extend(tree.links[link].parent.filter(|_| link != base));
        let children = tree.links[link].children.iter();
        let mut ranked: Vec<(usize, usize)> =
            children.filter_map(|joint| Some((first_end[*joint]?, tree.joints[*joint].child))).collect();
        ranked.sort_by_key(|(rank, _)| *rank);
        open.extend(ranked.iter().rev().map(|(_, child)| *child));
    }
    checked(tree, (base, None), joints, &moves)
}

fn of_chain(tree: &Tree, base: usize, tip: usize) -> Result<Selection, RobotError> {
    let joints = tree.path_between(base, tip).ok_or_else(|| beside(tree, base, tip))?;
    checked(tree, (base, Some(tip)), joints, &vec![true; tree.joints.len()])
}

fn beside(tree: &Tree, base: usize, tip: usize) -> RobotError {
    let (base, tip) = (&tree.links[base].name, &tree.links[tip].name);
    let reason = format!("the tip `{tip}` does not hang on the base `{base}`; choose a base above it");
    RobotError::NoChain { path: tree.path.clone(), reason }
}

fn nothing_moves(tree: &Tree, base: usize) -> RobotError {
    let reason = format!("no joint that moves hangs on the base `{}`", tree.links[base].name);
    RobotError::NoChain { path: tree.path.clone(), reason }
}

/// A selection whose joints are such that models know them.
fn checked(
    tree: &Tree,
    (base, tip): (usize, Option<usize>),
    joints: Vec<usize>,
    chosen: &[bool],
) -> Result<Selection, RobotError> {
    let (mut on_path, mut moves) = (vec![false; tree.joints.len()], vec![false; tree.joints.len()]);
    for joint in &joints {
        on_path[*joint] = true;
        moves[*joint] = chosen[*joint] && tree.joints[*joint].moves();
    }
    let moving = moves.iter().filter(|moves| **moves).count();
    if moving > MOST_JOINTS {
        return Err(RobotError::TooManyJoints { path: tree.path.clone(), joints: moving, most: MOST_JOINTS });
    }
    for (index, joint) in joints.iter().map(|j| (*j, &tree.joints[*j])) {
        let before = &tree.links[joint.parent].name;
        let reason = match (&joint.freedom, &joint.mimic) {
            (Freedom::Other(kind), _) => format!(
                "is {kind}, and models have joints of one degree of freedom on a fixed base (one that moves would need its \
                 pose and the forces of its contacts); choose a base behind it: `{}`",
                tree.links[joint.child].name
            ),
            (_, Some(mimic)) if moves[index] => match tree.followed(index) {
                None => format!(
                    "follows the joint {} (mimic), which is not there, does not move or follows this one in turn; correct \
                     <mimic>, or choose the tip before it: `{before}`",
                    mimic.joint
                ),
                Some(followed) if !moves[followed.joint] => format!(
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
    let tied = |tie: &&Tie| tie.joints.iter().any(|joint| moves[*joint]);
    if let Some(tie) = tree.ties.iter().find(tied) {
        let of = tie.joints.iter().find(|joint| moves[**joint]).map_or("", |j| &tree.joints[*j].name);
        let reason = format!(
            "{}, which models do not know; leave out the joint `{of}`, or remove the element",
            tie.reason
        );
        return Err(RobotError::Element {
            path: tree.path.clone(),
            line: tie.line,
            what: tie.what.clone(),
            reason,
        });
    }
    if moves.contains(&true) {
        return Ok(Selection { base, tip, joints, on_path, moves });
    }
    let Some(tip) = tip else { return Err(nothing_moves(tree, base)) };
    let (base, tip) = (&tree.links[base].name, &tree.links[tip].name);
    let reason = format!("between `{base}` and `{tip}` there is no joint that moves");
    Err(RobotError::NoChain { path: tree.path.clone(), reason })
}

/// The base link: that of the name, or the only root.
pub(crate) fn base_of(tree: &Tree, base: Option<&str>) -> Result<usize, RobotError> {
    if let Some(name) = base {
        return find_link(tree, "the base", name);
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

fn find_link(tree: &Tree, which: &'static str, name: &str) -> Result<usize, RobotError> {
    find(tree, ("link", which, name), tree.links.iter().map(|link| link.name.as_str()))
}

fn find_joint(tree: &Tree, name: &str) -> Result<usize, RobotError> {
    let found = find(tree, ("joint", "`joints`", name), tree.joints.iter().map(|joint| joint.name.as_str()))?;
    let joint = &tree.joints[found];
    let (line, what) = (joint.line, format!("joint {name}"));
    let kind = match &joint.freedom {
        Freedom::Turns(_) | Freedom::Slides(_) => return Ok(found),
        Freedom::Fixed => "fixed",
        Freedom::Other(kind) => kind,
    };
    let reason = format!("is {kind}, and `joints` are those that turn or slide; leave it out");
    Err(RobotError::Element { path: tree.path.clone(), line, what, reason })
}

fn find<'n>(
    tree: &Tree,
    (kind, which, name): (&'static str, &'static str, &str),
    names: impl ExactSizeIterator<Item = &'n str> + Clone,
) -> Result<usize, RobotError> {
    if let Some(found) = names.clone().position(|known| known == name) {
        return Ok(found);
    }
    let meant = likely(name, names.clone());
    let count = names.len();
    let mut known: Vec<String> = names.take(MOST_NAMES).map(Into::into).collect();
    if count > MOST_NAMES {
        known.push(format!("and {} more", count - MOST_NAMES));
    }
    Err(RobotError::Unknown {
        path: tree.path.clone(),
        kind,
        which,
        name: name.into(),
        meant: meant.map(Into::into),
        known: known.into(),
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

fn listed(names: &[&str]) -> String {
    names.iter().take(MOST_NAMES).copied().collect::<Vec<_>>().join(", ")
}
