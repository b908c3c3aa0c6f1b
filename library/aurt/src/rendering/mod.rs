//! Numbers, tables, running text and JSON as people read them.

pub mod joints;
pub mod json;
pub mod number;
pub mod style;
pub mod table;
pub mod text;
