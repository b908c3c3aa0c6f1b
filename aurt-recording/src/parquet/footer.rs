use std::io::Read;

use crate::parquet::thrift::{TRUE, Thrift};

/// Columns that a file may have; more are no recording.
const MOST_COLUMNS: usize = 100_000;

/// What a number of a column is and how it is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Truth,
    Single,
    Double,
    Int {
        bytes: usize,
        signed: bool,
    },
    /// A moment since 1970 in parts of a second, given in seconds from `origin` on.
    Stamp {
        per_second: i64,
        origin: i64,
    },
}

impl Number {
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::Truth => 1,
            Self::Single => 4,
            Self::Int { bytes, .. } => bytes,
            Self::Double | Self::Stamp { .. } => 8,
        }
    }

    /// What the bits of an integer mean.
    pub(super) const fn of_int(self, value: i64) -> f64 {
        match self {
            Self::Int { bytes: 4, signed: false } => value as u32 as f64,
            Self::Int { signed: false, .. } => value as u64 as f64,
            Self::Stamp { per_second, origin } => value.saturating_sub(origin) as f64 / per_second as f64,
            _ => value as f64,
        }
    }
}

/// A column of numbers, or of lists of numbers.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    /// Its name, with those of the structures around it.
    pub(super) name: String,
    /// Its place among all columns.
    pub(super) place: usize,
    pub(super) number: Number,
    /// Level of a number that is there; below it, it is missing.
    pub(super) defined: u32,
    /// For lists the level from which on there is a place for a number.
    pub(super) listed: Option<u32>,
}

/// A part of a column whose pages stand together.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Chunk {
    pub(super) codec: i64,
    pub(super) begin: u64,
    pub(super) bytes: u64,
}

/// What a file says of itself at its end.
#[derive(Debug, Default)]
pub(super) struct Footer {
    pub(super) leaves: Vec<Leaf>,
    pub(super) rows: u64,
    /// For each group its rows and its chunks, one for each column.
    pub(super) groups: Vec<(u64, Vec<Chunk>)>,
    /// Columns that are no numbers.
    pub(super) others: Vec<String>,
}

/// A node of the schema.
#[derive(Debug, Default)]
struct Node {
    name: String,
    physical: Option<i64>,
    repetition: i64,
    children: i64,
    converted: Option<i64>,
    /// Stamps per second.
    per_second: Option<i64>,
    unsigned: bool,
    decimal: bool,
}

impl Footer {
    /// Reads it; none if it cannot be one.
    pub(super) fn read(source: impl Read) -> Option<Self> {
        let mut footer = Self::default();
        let mut nodes = Vec::new();
        Thrift::new(source).fields(&mut |t, id, _| {
            match id {
                2 => t.list(&mut |t| {
                    nodes.push(node(t)?);
                    (nodes.len() <= MOST_COLUMNS).then_some(())
                })?,
                3 => footer.rows = u64::try_from(t.int()?).ok()?,
                4 => t.list(&mut |t| {
                    footer.groups.push(group(t)?);
                    Some(())
                })?,
                _ => return Some(false),
            }
            Some(true)
        })?;
        let mut nodes = nodes.into_iter();
        let root = nodes.next()?;
        let mut place = 0;
        for _ in 0..root.children {
            footer.descend(&mut nodes, &mut place, &Path::default(), 0)?;
        }
        footer.groups.iter().all(|(_, chunks)| chunks.len() == place).then_some(footer)
    }

    fn descend(
        &mut self,
        nodes: &mut impl Iterator<Item = Node>,
        place: &mut usize,
        above: &Path,
        depth: u32,
    ) -> Option<()> {
        let node = nodes.next()?;
        if depth > 32 {
            return None;
        }
        let mut path = above.clone();
        if above.repeated == 0 && node.repetition != 2 {
            path.names.push(node.name.clone());
        }
        path.defined += u32::from(node.repetition != 0);
        if node.repetition == 2 {
            path.repeated += 1;
            path.listed = Some(path.defined);
        }
        if node.physical.is_none() || node.children > 0 {
            for _ in 0..node.children {
                self.descend(nodes, place, &path, depth + 1)?;
            }
            return Some(());
        }
        let name = if path.names.is_empty() { node.name.clone() } else { path.names.join(".") };
        match node.number() {
            Some(number) if path.repeated <= 1 => {
                self.leaves.push(Leaf {
                    name,
                    place: *place,
                    number,
                    defined: path.defined,
                    listed: path.listed,
                });
            }
            _ => self.others.push(name),
        }
        *place += 1;
        Some(())
    }
}

/// The way from the root to a column.
#[derive(Debug, Clone, Default)]
struct Path {
    names: Vec<String>,
    defined: u32,
    repeated: u32,
    listed: Option<u32>,
}

impl Node {
    /// How numbers are stored, if they are any.
    fn number(&self) -> Option<Number> {
        const DECIMAL: i64 = 5;
        if self.decimal || self.converted == Some(DECIMAL) {
            return None;
        }
        let per_second = self.per_second.or(match self.converted {
            Some(9) => Some(1_000),
            Some(10) => Some(1_000_000),
            _ => None,
        });
        let signed = !(self.unsigned || matches!(self.converted, Some(11..=14)));
        Some(match self.physical? {
            0 => Number::Truth,
            1 => Number::Int { bytes: 4, signed },
            2 => match per_second {
                Some(per_second) => Number::Stamp { per_second, origin: 0 },
                None => Number::Int { bytes: 8, signed },
            },
            4 => Number::Single,
            5 => Number::Double,
            _ => return None,
        })
    }
}

fn node<R: Read>(t: &mut Thrift<R>) -> Option<Node> {
    let mut node = Node::default();
    t.fields(&mut |t, id, _| {
        match id {
            1 => node.physical = Some(t.int()?),
            3 => node.repetition = t.int()?,
            4 => node.name = t.text()?,
            5 => node.children = t.int()?,
            6 => node.converted = Some(t.int()?),
            10 => logical(t, &mut node)?,
            _ => return Some(false),
        }
        Some(true)
    })?;
    Some(node)
}

/// What the numbers of a column mean: decimals, stamps, integers without sign.
fn logical<R: Read>(t: &mut Thrift<R>, node: &mut Node) -> Option<()> {
    t.fields(&mut |t, id, _| {
        match id {
            5 => {
                node.decimal = true;
                return Some(false);
            }
            8 => t.fields(&mut |t, id, _| {
                if id != 2 {
                    return Some(false);
                }
                t.fields(&mut |_, unit, _| {
                    node.per_second = match unit {
                        1 => Some(1_000),
                        2 => Some(1_000_000),
                        3 => Some(1_000_000_000),
                        _ => None,
                    };
                    Some(false)
                })?;
                Some(true)
            })?,
            10 => t.fields(&mut |_, id, kind| {
                if id == 2 {
                    node.unsigned = kind != TRUE;
                }
                Some(false)
            })?,
            _ => return Some(false),
        }
        Some(true)
    })
}

fn group<R: Read>(t: &mut Thrift<R>) -> Option<(u64, Vec<Chunk>)> {
    let (mut rows, mut chunks) = (0, Vec::new());
    t.fields(&mut |t, id, _| {
        match id {
            1 => t.list(&mut |t| {
                chunks.push(chunk(t)?);
                (chunks.len() <= MOST_COLUMNS).then_some(())
            })?,
            3 => rows = u64::try_from(t.int()?).ok()?,
            _ => return Some(false),
        }
        Some(true)
    })?;
    Some((rows, chunks))
}

fn chunk<R: Read>(t: &mut Thrift<R>) -> Option<Chunk> {
    let mut chunk = Chunk::default();
    let (mut data, mut dictionary) = (0, None);
    t.fields(&mut |t, id, _| {
        if id != 3 {
            return Some(false);
        }
        t.fields(&mut |t, id, _| {
            match id {
                4 => chunk.codec = t.int()?,
                7 => chunk.bytes = u64::try_from(t.int()?).ok()?,
                9 => data = u64::try_from(t.int()?).ok()?,
                11 => dictionary = u64::try_from(t.int()?).ok().filter(|at| *at > 0),
                _ => return Some(false),
            }
            Some(true)
        })?;
        Some(true)
    })?;
    chunk.begin = dictionary.map_or(data, |at| at.min(data));
    Some(chunk)
}
