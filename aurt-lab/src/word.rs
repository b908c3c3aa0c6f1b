/// Declares an enum whose values have a word each, in files and on tables.
macro_rules! words {
    ($(#[$about:meta])* $type:ident { $($(#[$of:meta])* $value:ident = $word:literal,)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
        pub enum $type {
            $($(#[$of])* #[serde(rename = $word)] $value,)+
        }

        impl $type {
            /// All, in the order of tables.
            pub const ALL: [Self; [$($word),+].len()] = [$(Self::$value),+];

            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $word),+
                }
            }
        }
    };
}
