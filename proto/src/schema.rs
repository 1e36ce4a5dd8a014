//! Layouts of the messages as data, for programs that do not know them.

use crate::layout::{Case, Field, MessageType, Shape};
use crate::messages::ALL;
use serde::Serialize;
use serde_json::{Value, json};

/// The layout of one message.
#[derive(Clone, Debug, Serialize)]
pub struct MessageSchema {
    /// Versioned name.
    #[serde(rename = "type")]
    pub name: &'static str,
    /// Greatest size of one message, bytes.
    pub max_bytes: usize,
    /// Fields in order, as crate `postcard-schema` 0.2 writes them: `{"name": …, "ty": "U64" |
    /// {"Struct": […]} | …}`.
    pub layout: Value,
}

impl From<&MessageType> for MessageSchema {
    fn from(message: &MessageType) -> Self {
        Self {
            name: message.name,
            max_bytes: message.max_bytes,
            layout: named(Shape::Struct(message.layout)),
        }
    }
}

/// All messages of the bus.
pub fn all() -> impl Iterator<Item = MessageSchema> {
    ALL.iter().map(|message| MessageSchema::from(*message))
}

fn named(shape: Shape) -> Value {
    let (name, ty) = match shape {
        Shape::U8 => ("u8", json!("U8")),
        Shape::U16 => ("u16", json!("U16")),
        Shape::U32 => ("u32", json!("U32")),
        Shape::U64 => ("u64", json!("U64")),
        Shape::F64 => ("f64", json!("F64")),
        Shape::Bool => ("bool", json!("Bool")),
        Shape::Text => ("String", json!("String")),
        Shape::Array(item, count) => ("[T; N]", json!({ "Tuple": vec![named(*item); count] })),
        Shape::List(item) => ("Vec<T>", json!({ "Seq": named(*item) })),
        Shape::Optional(value) => ("Option<T>", json!({ "Option": named(*value) })),
        Shape::Struct(layout) => (layout.name, json!({ "Struct": fields(layout.fields) })),
        Shape::Choice(choice) => {
            let cases: Vec<Value> = choice.cases.iter().map(case).collect();
            (choice.name, json!({ "Enum": cases }))
        }
    };
    json!({ "name": name, "ty": ty })
}

fn fields(fields: &[Field]) -> Vec<Value> {
    let field = |field: &Field| json!({ "name": field.name, "ty": named(field.shape) });
    fields.iter().map(field).collect()
}

fn case(case: &Case) -> Value {
    let ty = match case.fields {
        [] => json!("UnitVariant"),
        some => json!({ "StructVariant": fields(some) }),
    };
    json!({ "name": case.name, "ty": ty })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_written_as_postcard_schema_writes_them() {
        for message in ALL {
            let ours = MessageSchema::from(*message).layout;
            let theirs = serde_json::to_value(message.schema).unwrap();
            assert_eq!(ours, theirs, "{}", message.name);
        }
    }
}
