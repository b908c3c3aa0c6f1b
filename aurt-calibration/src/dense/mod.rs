//! Least squares' dense loops: one source, compiled once per instruction set, chosen at run time.
//!
//! All of them are made of two: scalar products of columns, and columns to which multiples of others are added.
//! A scalar product has eight partial sums whatever the width of the registers, and they are added up in one order.
//! So [`Dispatch::Avx2`](aurt_traits::Dispatch::Avx2) and [`Dispatch::Avx512`](aurt_traits::Dispatch::Avx512) give
//! the same bits, and [`Dispatch::Baseline`](aurt_traits::Dispatch::Baseline), which rounds products before it adds
//! them, the same bits on every machine.

mod columns;
mod fold;
mod gram;
mod products;
mod project;
mod reflect;

pub(crate) use columns::LANES;
pub(crate) use fold::fold_rows;
pub(crate) use project::project_out;
pub(crate) use reflect::{dot, triangularise_below};

pub use gram::add_gram;
pub use products::products_of_columns;

/// Defines a function that runs `$body` on the instruction set of a level. The numbers are how many columns are
/// worked on at once, left and right, in scalar products and in additions: as many as registers hold the sums of.
macro_rules! dispatched {
    ($(#[$attribute:meta])* $name:ident = $body:ident($($argument:ident: $kind:ty),* $(,)?)) => {
        $(#[$attribute])*
        pub(crate) fn $name(level: aurt_traits::Dispatch, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
            fn avx512($($argument: $kind),*) {
                // Wider tiles spill where the compiler prefers registers of 256 bits, and are then four times slower.
                $body::<true, 2, 3, 4, 2>($($argument),*);
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($argument: $kind),*) {
                $body::<true, 2, 3, 4, 2>($($argument),*);
            }
            match level {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the processor has the features that the function was compiled for.
                aurt_traits::Dispatch::Avx512 if level.is_available() => unsafe { avx512($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                aurt_traits::Dispatch::Avx2 if level.is_available() => unsafe { avx2($($argument),*) },
                _ => $body::<false, 1, 3, 2, 1>($($argument),*),
            }
        }
    };
}

use dispatched;
