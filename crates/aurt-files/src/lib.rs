//! Files of users: read with bounds, and quoted without harm.
//!
//! Every reader of AURT opens its file with [`open`] and every reader of a whole text takes it from [`read_text`], so
//! that what is a device, a pipe that nobody writes to, too large, compressed or no UTF-8 is refused alike, with what
//! to do about it. What messages quote from files goes through [`clipped`], and what reaches a terminal through
//! [`harmless`]. What is being written is [`Unfinished`] until it has its name, so that an interrupted command can
//! [`abandon`] it.

mod input;
mod shown;
mod unfinished;

pub use input::{MOST_MODEL_BYTES, MOST_TEXT_BYTES, open, read_text, text_of};
pub use shown::{MOST_QUOTED, clipped, harmless, is_harmful};
pub use unfinished::{PART_PREFIX, PART_SUFFIX, Publishing, Unfinished, abandon, publishing};
