//! Numbers, tables and running text as people read them.

pub mod joints;
pub mod number;
pub mod style;
pub mod table;
pub mod text;
