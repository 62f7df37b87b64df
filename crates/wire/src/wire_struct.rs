//! Message structs and the table of their fields, made of one definition: what the C header says cannot differ from what is sent.

use crate::Text;

/// A field of a message, as other languages need it.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its type in C, without what follows the name.
    pub c_type: String,
    /// What follows the name in C: `[4]`.
    pub c_suffix: String,
    /// What it is made of: `u16`, `u32`, `u64`, `f64`, `text` (bytes of UTF-8), or the name of a message.
    pub element: &'static str,
    /// How many of those there are, outermost first; of one, nothing.
    pub shape: Vec<usize>,
    /// Bytes before it.
    pub offset: usize,
    /// What it is.
    pub meaning: String,
}

/// A message, as other languages need it.
#[derive(Clone, Debug)]
pub struct MessageTable {
    /// The name of its type on the wire.
    pub name: &'static str,
    /// Its name in C.
    pub c_name: String,
    /// What it is.
    pub meaning: String,
    /// Its size in bytes.
    pub size: usize,
    /// Its fields, in order.
    pub fields: Vec<Field>,
}

/// A struct that travels, with its table.
pub trait Message {
    /// Its table.
    fn table() -> MessageTable;
}

/// What a field's type is in C, and elsewhere.
pub(crate) trait CType {
    /// The type, and what follows the name.
    fn c_type() -> (String, String);

    /// See [`Field::element`].
    const ELEMENT: &'static str;

    /// See [`Field::shape`].
    fn shape() -> Vec<usize> {
        Vec::new()
    }
}

macro_rules! plain {
    ($($rust:ty => $c:literal),*) => {
        $(impl CType for $rust {
            const ELEMENT: &'static str = stringify!($rust);

            fn c_type() -> (String, String) {
                ($c.to_owned(), String::new())
            }
        })*
    };
}

plain! { u16 => "uint16_t", u32 => "uint32_t", u64 => "uint64_t", f64 => "double" }

impl<T: CType, const N: usize> CType for [T; N] {
    const ELEMENT: &'static str = T::ELEMENT;

    fn shape() -> Vec<usize> {
        std::iter::once(N).chain(T::shape()).collect()
    }

    fn c_type() -> (String, String) {
        let (base, suffix) = T::c_type();
        (base, format!("[{N}]{suffix}"))
    }
}

impl<const N: usize> CType for Text<N> {
    const ELEMENT: &'static str = "text";

    fn shape() -> Vec<usize> {
        vec![N]
    }

    fn c_type() -> (String, String) {
        ("char".to_owned(), format!("[{N}]"))
    }
}

/// `whirl.RecorderStatus` as C has it: `whirl_recorder_status`.
pub(crate) fn c_name(name: &str) -> String {
    let mut made = String::new();
    for letter in name.trim_start_matches("whirl.").chars() {
        if letter.is_ascii_uppercase() {
            made.push('_');
        }
        made.push(letter.to_ascii_lowercase());
    }
    format!("whirl{made}")
}

/// Lines of a doc comment as one text.
pub(crate) fn joined(lines: &[&str]) -> String {
    lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ")
}

/// A message: a struct as it travels, laid out as C does, and its table.
macro_rules! message {
    ($type:literal $(#[doc = $doc:literal])* pub struct $name:ident {
        $($(#[doc = $meaning:literal])* pub $field:ident: $of:ty,)*
    }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
        #[type_name($type)]
        #[repr(C)]
        pub struct $name {
            $($(#[doc = $meaning])* pub $field: $of,)*
        }

        impl $crate::wire_struct::Message for $name {
            fn table() -> $crate::wire_struct::MessageTable {
                use $crate::wire_struct::{CType, Field, MessageTable, c_name, joined};
                MessageTable {
                    name: $type,
                    c_name: c_name($type),
                    meaning: joined(&[$($doc),*]),
                    size: size_of::<$name>(),
                    fields: vec![$({
                        let (c_type, c_suffix) = <$of as CType>::c_type();
                        Field {
                            name: stringify!($field),
                            c_type,
                            c_suffix,
                            element: <$of as CType>::ELEMENT,
                            shape: <$of as CType>::shape(),
                            offset: std::mem::offset_of!($name, $field),
                            meaning: joined(&[$($meaning),*]),
                        }
                    },)*],
                }
            }
        }

        impl $crate::wire_struct::CType for $name {
            const ELEMENT: &'static str = $type;

            fn c_type() -> (String, String) {
                (format!("struct {}", $crate::wire_struct::c_name($type)), String::new())
            }
        }
    };
}

pub(crate) use message;
