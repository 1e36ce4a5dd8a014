//! Messages as data: names, keys, fields and their documentation.
//!
//! [`crate::messages`] is written as one table; this is what the table becomes besides Rust types.
//! `proto/examples/generate` makes the modules of clients in other languages from it.

use crate::decode_error::DecodeError;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Largest message we decode. A scene snapshot of twenty large bodies stays below; a hostile length
/// does not get memory.
pub const MAX_BYTES: usize = 16 << 20;

/// A type that travels on the bus, with the versioned name its encoding carries.
pub trait Message: Serialize + for<'de> Deserialize<'de> {
    /// Versioned type name, for example `palpate.ToolPose.v1`.
    const NAME: &'static str;
    /// Key below `palpate/{instance}/`, for example `tool/{tool}/pose`.
    const KEY: &'static str;
    /// Greatest size of one message, bytes; longer ones are refused before they are read.
    const MAX_BYTES: usize = MAX_BYTES;
    /// All that is known about it, as data.
    const TYPE: &'static MessageType;
}

/// A message that travels on the bus under a name and a key.
#[derive(Clone, Copy, Debug)]
pub struct MessageType {
    /// Versioned name, for example `palpate.ToolPose.v1`.
    pub name: &'static str,
    /// Key below `palpate/{instance}/`; `{tool}` or `{body}` stands for an id.
    pub key: &'static str,
    /// How it is sent.
    pub delivery: Delivery,
    /// Greatest size of one message, bytes; longer ones are refused before they are read.
    pub max_bytes: usize,
    /// Its fields.
    pub layout: &'static Struct,
    /// The layout as crate `postcard-schema` describes it.
    #[cfg(test)]
    pub schema: &'static postcard_schema::schema::NamedType,
    pub(crate) to_json: fn(&[u8]) -> Result<Value, DecodeError>,
}

/// How a message is sent: its priority, and what happens to it when the network is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// Every tick: highest priority, dropped when the network is full, sent at once.
    Motion,
    /// Some ten times a second: high priority, dropped when the network is full.
    Health,
    /// Large, some sixty times a second: normal priority, dropped when the network is full.
    Net,
    /// Numbered: low interactive priority, waits when the network is full.
    Event,
    /// Once for each connection: high interactive priority, waits when the network is full.
    Announcement,
    /// Only in answers to queries.
    Answer,
}

/// A type of the table, in the order in which they are written.
#[derive(Clone, Copy, Debug)]
pub enum Item {
    /// A message.
    Message(&'static MessageType),
    /// A struct that messages contain.
    Struct(&'static Struct),
    /// A choice that messages contain.
    Choice(&'static Choice),
    /// Bits of a number.
    Flags(&'static Flags),
}

/// Fields in order.
#[derive(Clone, Copy, Debug)]
pub struct Struct {
    /// Name of the Rust type.
    pub name: &'static str,
    /// Documentation by line.
    pub doc: &'static [&'static str],
    /// Fields.
    pub fields: &'static [Field],
}

/// A field of a struct or of a case.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name.
    pub name: &'static str,
    /// Documentation by line.
    pub doc: &'static [&'static str],
    /// Type.
    pub shape: Shape,
    /// Makers of a message may leave it out: zero, or none.
    pub optional: bool,
}

/// One of several cases; on the wire the number of the case, from 0, then its fields.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Name of the Rust type.
    pub name: &'static str,
    /// Documentation by line.
    pub doc: &'static [&'static str],
    /// Cases in order of their numbers.
    pub cases: &'static [Case],
}

impl Choice {
    /// No case has fields.
    pub fn is_plain(&self) -> bool {
        self.cases.iter().all(|case| case.fields.is_empty())
    }
}

/// A case of a choice.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Name of the Rust variant.
    pub name: &'static str,
    /// Documentation by line.
    pub doc: &'static [&'static str],
    /// Fields.
    pub fields: &'static [Field],
}

/// Names for the bits of a number.
#[derive(Clone, Copy, Debug)]
pub struct Flags {
    /// Name of the group.
    pub name: &'static str,
    /// Name of the Rust module.
    pub module: &'static str,
    /// Documentation by line.
    pub doc: &'static [&'static str],
    /// Flags.
    pub flags: &'static [Flag],
    /// Clients have the names as constants of their own, not within a group.
    pub bare: bool,
}

/// A bit with a name.
#[derive(Clone, Copy, Debug)]
pub struct Flag {
    /// Name.
    pub name: &'static str,
    /// Documentation by line.
    pub doc: &'static [&'static str],
    /// Place of the bit, from 0.
    pub bit: u32,
}

/// A type on the wire.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// One byte.
    U8,
    /// Varint.
    U16,
    /// Varint.
    U32,
    /// Varint.
    U64,
    /// Eight bytes, little-endian.
    F64,
    /// One byte, 0 or 1.
    Bool,
    /// Count of bytes, then UTF-8.
    Text,
    /// So many items, without a count.
    Array(&'static Shape, usize),
    /// A count, then the items.
    List(&'static Shape),
    /// 0, or 1 and the value.
    Optional(&'static Shape),
    /// Its fields in order.
    Struct(&'static Struct),
    /// Number of the case, then its fields.
    Choice(&'static Choice),
}

/// A type that messages may be made of.
pub trait Described {
    /// What it looks like on the wire.
    const SHAPE: Shape;
}

macro_rules! described {
    ($($type:ty => $shape:ident),*) => {
        $( impl Described for $type { const SHAPE: Shape = Shape::$shape; } )*
    };
}

described!(u8 => U8, u16 => U16, u32 => U32, u64 => U64, f64 => F64, bool => Bool, String => Text);

impl<T: Described, const N: usize> Described for [T; N] {
    const SHAPE: Shape = Shape::Array(&T::SHAPE, N);
}

impl<T: Described> Described for Vec<T> {
    const SHAPE: Shape = Shape::List(&T::SHAPE);
}

impl<T: Described> Described for Option<T> {
    const SHAPE: Shape = Shape::Optional(&T::SHAPE);
}

/// Turns the table of messages into types, their descriptions and the lists of them.
///
/// ```text
/// message NAME [: DERIVE + …] = "palpate.NAME.v1" on "key" as DELIVERY [, at most (BYTES)] { fields }
/// struct NAME { fields }      choice NAME { cases }      flags NAME in module { NAME = bit }
/// field: Type,                field: Type = left out,    // makers of the message may leave it out
/// ```
macro_rules! messages {
    (@ [$($all:ident)*] [$($item:expr,)*]) => {
        /// All messages of the bus.
        pub static ALL: &[&$crate::layout::MessageType] = &[$(<$all as Message>::TYPE),*];
        /// Everything in the table, in order.
        pub static TABLE: &[$crate::layout::Item] = &[$($item,)*];
    };
    (@ [$($all:ident)*] [$($item:expr,)*]
        $(#[doc = $doc:literal])*
        message $name:ident $(: $first:ident $(+ $derive:ident)*)? = $wire:literal on $key:literal
            as $delivery:ident $(, at most ($most:expr))? { $($fields:tt)* }
        $($rest:tt)*
    ) => {
        $crate::layout::structure! { [$($doc)*] [$($first $($derive)*)?] $name { $($fields)* } }
        impl Message for $name {
            const NAME: &'static str = $wire;
            const KEY: &'static str = $key;
            $( const MAX_BYTES: usize = $most; )?
            const TYPE: &'static $crate::layout::MessageType = &$crate::layout::MessageType {
                name: $wire,
                key: $key,
                delivery: $crate::layout::Delivery::$delivery,
                max_bytes: Self::MAX_BYTES,
                layout: match <Self as $crate::layout::Described>::SHAPE {
                    $crate::layout::Shape::Struct(layout) => layout,
                    _ => unreachable!(),
                },
                #[cfg(test)]
                schema: <Self as postcard_schema::Schema>::SCHEMA,
                to_json: $crate::codec::decode_to_json::<Self>,
            };
        }
        $crate::layout::messages! { @ [$($all)* $name]
            [$($item,)* $crate::layout::Item::Message(<$name as Message>::TYPE),] $($rest)* }
    };
    (@ [$($all:ident)*] [$($item:expr,)*]
        $(#[doc = $doc:literal])*
        struct $name:ident $(: $first:ident $(+ $derive:ident)*)? { $($fields:tt)* }
        $($rest:tt)*
    ) => {
        $crate::layout::structure! { [$($doc)*] [$($first $($derive)*)?] $name { $($fields)* } }
        $crate::layout::messages! { @ [$($all)*]
            [$($item,)* match <$name as $crate::layout::Described>::SHAPE {
                $crate::layout::Shape::Struct(layout) => $crate::layout::Item::Struct(layout),
                _ => unreachable!(),
            },] $($rest)* }
    };
    (@ [$($all:ident)*] [$($item:expr,)*]
        $(#[doc = $doc:literal])*
        choice $name:ident $(: $first:ident $(+ $derive:ident)*)? { $(
            $(#[doc = $case_doc:literal])*
            $case:ident $({ $( $(#[doc = $field_doc:literal])* $field:ident: $type:ty, )* })?,
        )* }
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize $(, $first $(, $derive)*)?)]
        #[cfg_attr(test, derive(postcard_schema::Schema))]
        pub enum $name { $(
            $(#[doc = $case_doc])*
            $case $({ $( $(#[doc = $field_doc])* $field: $type, )* })?,
        )* }
        impl $crate::layout::Described for $name {
            const SHAPE: $crate::layout::Shape =
                $crate::layout::Shape::Choice(&$crate::layout::Choice {
                    name: stringify!($name),
                    doc: &[$($doc),*],
                    cases: &[$( $crate::layout::Case {
                        name: stringify!($case),
                        doc: &[$($case_doc),*],
                        fields: &[$($( $crate::layout::Field {
                            name: stringify!($field),
                            doc: &[$($field_doc),*],
                            shape: <$type as $crate::layout::Described>::SHAPE,
                            optional: false,
                        } ),*)?],
                    } ),*],
                });
        }
        $crate::layout::messages! { @ [$($all)*]
            [$($item,)* match <$name as $crate::layout::Described>::SHAPE {
                $crate::layout::Shape::Choice(choice) => $crate::layout::Item::Choice(choice),
                _ => unreachable!(),
            },] $($rest)* }
    };
    (@ [$($all:ident)*] [$($item:expr,)*]
        $(#[doc = $doc:literal])*
        flags $name:ident in $module:ident $(, $bare:ident)? { $(
            $(#[doc = $flag_doc:literal])* $flag:ident = $bit:literal,
        )* }
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        pub mod $module { $(
            $(#[doc = $flag_doc])*
            pub const $flag: u32 = 1 << $bit;
        )*
            /// Every bit with its name, lowest first.
            pub const NAMES: &[(u32, &str)] = &[$( ($flag, stringify!($flag)) ),*];
        }
        $crate::layout::messages! { @ [$($all)*]
            [$($item,)* $crate::layout::Item::Flags(&$crate::layout::Flags {
                name: stringify!($name),
                module: stringify!($module),
                doc: &[$($doc),*],
                flags: &[$( $crate::layout::Flag {
                    name: stringify!($flag),
                    doc: &[$($flag_doc),*],
                    bit: $bit,
                } ),*],
                bare: false $(|| !stringify!($bare).is_empty())?,
            }),] $($rest)* }
    };
    (@ [$($all:ident)*] [$($item:expr,)*] $($rest:tt)*) => {
        compile_error!(concat!("not an item of the table: ", stringify!($($rest)*)));
    };
    ($($table:tt)*) => {
        $crate::layout::messages! { @ [] [] $($table)* }
    };
}

/// A struct of the table.
macro_rules! structure {
    ([$($doc:literal)*] [$($derive:ident)*] $name:ident { $(
        $(#[doc = $field_doc:literal])* $field:ident: $type:ty $(= $left:ident $out:ident)?,
    )* }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize $(, $derive)*)]
        #[cfg_attr(test, derive(postcard_schema::Schema))]
        pub struct $name { $( $(#[doc = $field_doc])* pub $field: $type, )* }
        impl $crate::layout::Described for $name {
            const SHAPE: $crate::layout::Shape =
                $crate::layout::Shape::Struct(&$crate::layout::Struct {
                    name: stringify!($name),
                    doc: &[$($doc),*],
                    fields: &[$( $crate::layout::Field {
                        name: stringify!($field),
                        doc: &[$($field_doc),*],
                        shape: <$type as $crate::layout::Described>::SHAPE,
                        optional: false $(|| !stringify!($left $out).is_empty())?,
                    } ),*],
                });
        }
    };
}

pub(crate) use {messages, structure};
