//! Enums whose variants have names in files.

/// Defines an enum whose variants have names in files. A variant, its name and its documentation
/// stay together.
#[macro_export]
macro_rules! named {
    (
        $(#[$attribute:meta])*
        $vis:vis enum $enum:ident { $($(#[$variant_attribute:meta])* $variant:ident = $name:literal,)+ }
    ) => {
        $crate::listed! {
            $(#[$attribute])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
            $vis enum $enum { $($(#[$variant_attribute])* #[serde(rename = $name)] $variant = $name,)+ }
        }
    };
}

/// Defines an enum with the list and the names of its variants. A field of a variant has its value
/// in the list.
#[macro_export]
macro_rules! listed {
    (
        $(#[$attribute:meta])*
        $vis:vis enum $enum:ident { $(
            $(#[$variant_attribute:meta])*
            $variant:ident $({ $(#[$field_attribute:meta])* $field:ident: $type:ty = $value:literal })?
            = $name:literal,
        )+ }
    ) => {
        $(#[$attribute])*
        $vis enum $enum {
            $($(#[$variant_attribute])* $variant $({ $(#[$field_attribute])* $field: $type })?,)+
        }

        impl $enum {
            /// All variants, in the order of their definition.
            pub const ALL: &[Self] = &[$(Self::$variant $({ $field: $value })?),+];

            /// Name in scenarios and results.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant { .. } => $name,)+ }
            }
        }
    };
}
