//! Files: those of users read with bounds and quoted without harm, those of results written together ([`output`]).
//!
//! Every reader of AURT opens its file with [`open`] and every reader of a whole text takes it from [`read_text`], so
//! that what is a device, a pipe that nobody writes to, too large, compressed or no UTF-8 is refused alike, with what
//! to do about it; commands do not write over what was opened ([`protect_inputs`]). What messages quote from files goes
//! through [`clipped`], and what reaches a terminal, a page or a comment through [`harmless`]; paths that are written into
//! experiments go through [`escaped`]. Names that are not known are answered with the one that was probably meant ([`suggestion`]).

mod input;
pub mod output;
mod protected;
mod shown;
pub mod suggestion;
mod tables;

pub use input::{
    MOST_MODEL_BYTES, MOST_TEXT_BYTES, open, open_regular, read_bytes, read_pieces, read_regular, read_text,
    text_of,
};
pub use protected::{is_input, protect_inputs};
pub use shown::{MOST_QUOTED, clipped, escaped, harmless, harmless_json, is_harmful};
pub use tables::{MOST_TABLES, table_beyond};
