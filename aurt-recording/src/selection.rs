/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnRef {
    /// By its place, counting from 0.
    Index(usize),
    /// By its name in the header (case does not matter).
    Name(String),
}

/// The columns of a quantity, one for each joint in the order of the joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnsRef {
    /// From `first` to `last`, both included, counting from 0.
    Range {
        /// The column of joint 0.
        first: usize,
        /// The column of the last joint.
        last: usize,
    },
    /// One by one.
    List(Vec<ColumnRef>),
    /// All columns whose names are this and a joint number, e.g. `target_q` for `target_q_0`, `target_q_1`, ….
    Prefix(String),
}

/// Which columns hold what. Whatever is `None` is looked for by its usual names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ColumnSelection {
    /// Time stamps in s.
    pub time: Option<ColumnRef>,
    /// Joint angles in rad.
    pub position: Option<ColumnsRef>,
    /// Joint velocities in rad/s.
    pub velocity: Option<ColumnsRef>,
    /// Joint torques or motor currents.
    pub measurement: Option<ColumnsRef>,
}
