//! Named values on a topic: flat protobuf messages, with one double for each joint or other value.
//!
//! The message type, for instance `opm.Joints`, is made for the joints of the mechanism, so that viewers
//! can plot every joint by its name: `/joints.S1`. A protobuf name has letters, digits and underscores
//! only. Every other character of a joint's name becomes an underscore (`tau.leg1` is the field
//! `tau_leg1`), and the metadata record `joints` says which joint a field is. [`crate::trajectory`] writes
//! such topics, and [`Message::values`](crate::Message::values) reads them.

use crate::RecordError;
use crate::log::{Log, Topic};

/// The package of the message types.
const PACKAGE: &str = "opm";
/// Field numbers 19000 to 19999 are protobuf's own; nobody has so many joints.
const MOST_JOINTS: usize = 18_999;

/// Wire types of protobuf.
const DOUBLE: u64 = 1;
const LENGTH: u64 = 2;

/// A topic whose messages are the values of certain joints.
pub(crate) struct JointsTopic {
    topic: Topic,
    joints: usize,
    message: Vec<u8>,
}

impl JointsTopic {
    /// Adds the topic `name` with messages of type `opm.MESSAGE`.
    pub fn new(
        log: &mut Log<'_>,
        name: &str,
        message: &str,
        joints: &[String],
    ) -> Result<Self, RecordError> {
        let fields = fields(joints)?;
        let fields: Vec<_> = fields.iter().map(|name| Field::double(name)).collect();
        let schema = descriptor(message, &fields);
        let topic = log.topic_of(name, &format!("{PACKAGE}.{message}"), &schema)?;
        Ok(Self { topic, joints: joints.len(), message: Vec::new() })
    }

    /// Writes one value for each joint, SI, in the order of the joints.
    pub fn write(
        &mut self,
        log: &mut Log<'_>,
        time: u64,
        values: &[f64],
    ) -> Result<(), RecordError> {
        if values.len() != self.joints {
            let (values, columns) = (values.len(), self.joints);
            return Err(RecordError::Row { values, columns });
        }
        self.write_all(log, time, values.iter().copied())
    }

    /// Writes NaN for each joint.
    pub fn write_unknown(&mut self, log: &mut Log<'_>, time: u64) -> Result<(), RecordError> {
        self.write_all(log, time, std::iter::repeat_n(f64::NAN, self.joints))
    }

    fn write_all(
        &mut self,
        log: &mut Log<'_>,
        time: u64,
        values: impl Iterator<Item = f64>,
    ) -> Result<(), RecordError> {
        self.message.clear();
        for (number, value) in (1..).zip(values) {
            varint(&mut self.message, number << 3 | DOUBLE);
            self.message.extend_from_slice(&value.to_le_bytes());
        }
        log.message(&mut self.topic, time, &self.message)
    }
}

/// A field name for each joint.
pub(crate) fn fields(joints: &[String]) -> Result<Vec<String>, RecordError> {
    if joints.len() > MOST_JOINTS {
        let problem = format!("{} joints, at most {MOST_JOINTS} fit a message", joints.len());
        return Err(RecordError::Layout(problem));
    }
    let mut fields: Vec<String> = Vec::with_capacity(joints.len());
    for (i, joint) in joints.iter().enumerate() {
        if joint.is_empty() {
            return Err(RecordError::Layout("a joint has no name".into()));
        }
        if joints[..i].contains(joint) {
            return Err(RecordError::Layout(format!("joint {joint} is given twice")));
        }
        let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut field: String = joint.chars().map(letter).collect();
        if field.starts_with(|c: char| c.is_ascii_digit()) {
            field.insert(0, '_');
        }
        while fields.contains(&field) {
            field.push('_');
        }
        fields.push(field);
    }
    Ok(fields)
}

/// A field of a message type. Its number is its place, from 1 on.
pub(crate) struct Field<'a> {
    name: &'a str,
    /// `FieldDescriptorProto.Label` and `FieldDescriptorProto.Type`.
    label: u64,
    kind: u64,
}

impl<'a> Field<'a> {
    /// A field with a double.
    pub fn double(name: &'a str) -> Self {
        Self { name, label: 1, kind: 1 }
    }

    /// A field with a `uint64`.
    pub fn number(name: &'a str) -> Self {
        Self { name, label: 1, kind: 4 }
    }

    /// A field with any number of `uint64`.
    pub fn numbers(name: &'a str) -> Self {
        Self { name, label: 3, kind: 4 }
    }
}

/// A `google.protobuf.FileDescriptorSet` of one file with one message type.
pub(crate) fn descriptor(message: &str, fields: &[Field<'_>]) -> Vec<u8> {
    // Field numbers of descriptor.proto.
    let mut kind = Vec::new();
    bytes(&mut kind, 1, message.as_bytes());
    for (number, field) in (1..).zip(fields) {
        let mut encoded = Vec::new();
        bytes(&mut encoded, 1, field.name.as_bytes());
        integer(&mut encoded, 3, number);
        integer(&mut encoded, 4, field.label);
        integer(&mut encoded, 5, field.kind);
        bytes(&mut encoded, 10, field.name.as_bytes()); // as it is in JSON, not in camel case
        bytes(&mut kind, 2, &encoded);
    }
    let mut file = Vec::new();
    bytes(&mut file, 1, format!("{PACKAGE}/{message}.proto").as_bytes());
    bytes(&mut file, 2, PACKAGE.as_bytes());
    bytes(&mut file, 4, &kind);
    bytes(&mut file, 12, b"proto3");
    let mut set = Vec::new();
    bytes(&mut set, 1, &file);
    set
}

fn bytes(out: &mut Vec<u8>, field: u64, value: &[u8]) {
    varint(out, field << 3 | LENGTH);
    varint(out, value.len() as u64);
    out.extend_from_slice(value);
}

fn integer(out: &mut Vec<u8>, field: u64, value: u64) {
    varint(out, field << 3);
    varint(out, value);
}

/// Writes a number in base 128, the least significant digit first.
pub(crate) fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(joints: &[&str]) -> Result<Vec<String>, RecordError> {
        fields(&joints.iter().map(ToString::to_string).collect::<Vec<_>>())
    }

    #[test]
    fn a_field_is_named_like_its_joint() {
        let found = names(&["S1", "tau.leg1", "tau_leg1", "3rd", "φ"]).unwrap();
        assert_eq!(found, ["S1", "tau_leg1", "tau_leg1_", "_3rd", "_"]);
        for wrong in [&["a", "b", "a"][..], &[""]] {
            assert!(matches!(names(wrong), Err(RecordError::Layout(_))), "{wrong:?}");
        }
    }

    /// Against Google's own encoder: what `descriptor_pb2.FileDescriptorSet` of protobuf for Python
    /// makes of `syntax = "proto3"; package opm; message M { double a = 1 [json_name = "a"]; }`.
    #[test]
    fn the_descriptor_is_that_of_a_proto_file() {
        let expected = b"\n-\n\x0bopm/M.proto\x12\x03opm\"\x11\n\x01M\x12\x0c\
            \n\x01a\x18\x01 \x01(\x01R\x01ab\x06proto3";
        assert_eq!(descriptor("M", &[Field::double("a")]), expected);
    }
}
