//! Messages that consist of named doubles. They are read by the schema that comes with them.

use crate::decode::varint;

/// Wire types of protobuf.
const VARINT: u64 = 0;
const DOUBLE: u64 = 1;
const LENGTH: u64 = 2;
const SINGLE: u64 = 5;

/// The type of messages whose fields are doubles, each at most once. [`crate::joints`] writes such messages;
/// those of other programs are read, too. [`Message::values`](crate::Message::values) gives their values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flat {
    /// The names of the fields, in the order of the type's description.
    pub names: Vec<String>,
    numbers: Vec<u64>,
}

impl Flat {
    /// The encoding of schemas that can be read.
    pub(crate) const ENCODING: &'static str = "protobuf";

    /// The type `name` in a `google.protobuf.FileDescriptorSet`; `None` if it is not there, or has
    /// fields of other kinds.
    pub(crate) fn of(name: &str, descriptor: &[u8]) -> Option<Self> {
        // Field numbers of descriptor.proto.
        for file in Fields(descriptor).filter_map(|field| field.bytes(1)) {
            let package = Fields(file).find_map(|field| field.text(2)).unwrap_or_default();
            for kind in Fields(file).filter_map(|field| field.bytes(4)) {
                let message = Fields(kind).find_map(|field| field.text(1))?;
                let full = match package {
                    "" => message.to_owned(),
                    package => format!("{package}.{message}"),
                };
                if full == name {
                    return Self::of_message(kind);
                }
            }
        }
        None
    }

    fn of_message(kind: &[u8]) -> Option<Self> {
        const DOUBLE_TYPE: u64 = 1;
        const REPEATED: u64 = 3;
        let mut flat = Self { names: vec![], numbers: vec![] };
        for field in Fields(kind).filter_map(|field| field.bytes(2)) {
            let number = |wanted| Fields(field).find_map(move |field| field.number(wanted));
            if number(5)? != DOUBLE_TYPE || number(4) == Some(REPEATED) {
                return None;
            }
            flat.names.push(Fields(field).find_map(|field| field.text(1))?.to_owned());
            flat.numbers.push(number(3)?);
        }
        (!flat.names.is_empty()).then_some(flat)
    }

    /// Adds the values of a message, in the order of the names. A field that is not there is zero.
    pub(crate) fn decode(&self, message: &[u8], values: &mut Vec<f64>) -> Result<(), String> {
        let start = values.len();
        values.resize(start + self.numbers.len(), 0.0);
        let mut fields = Fields(message);
        for (expected, field) in (0..).zip(fields.by_ref()) {
            // Fields come in the order of the type, as a rule.
            let at = match self.numbers.get(expected) {
                Some(&number) if number == field.number => Some(expected),
                _ => self.numbers.iter().position(|&number| number == field.number),
            };
            match (at, field.value) {
                (Some(at), Value::Eight(bytes)) => values[start + at] = f64::from_le_bytes(bytes),
                (Some(at), _) => return Err(format!("{} is not a double", self.names[at])),
                (None, _) => {}
            }
        }
        match fields.0 {
            [] => Ok(()),
            rest => Err(format!("the last {} bytes are not protobuf", rest.len())),
        }
    }
}

/// The fields of an encoded message; ends early where it is not protobuf.
#[derive(Clone)]
struct Fields<'a>(&'a [u8]);

struct Field<'a> {
    number: u64,
    value: Value<'a>,
}

enum Value<'a> {
    Number(u64),
    Eight([u8; 8]),
    Bytes(&'a [u8]),
    Four,
}

impl<'a> Iterator for Fields<'a> {
    type Item = Field<'a>;

    fn next(&mut self) -> Option<Field<'a>> {
        let mut rest = self.0;
        let key = varint(&mut rest)?;
        let value = match key & 7 {
            VARINT => Value::Number(varint(&mut rest)?),
            DOUBLE => {
                let (bytes, tail) = rest.split_first_chunk()?;
                rest = tail;
                Value::Eight(*bytes)
            }
            LENGTH => {
                let length = usize::try_from(varint(&mut rest)?).ok()?;
                let (bytes, tail) = rest.split_at_checked(length)?;
                rest = tail;
                Value::Bytes(bytes)
            }
            SINGLE => {
                rest = rest.get(4..)?;
                Value::Four
            }
            _ => return None,
        };
        self.0 = rest;
        Some(Field { number: key >> 3, value })
    }
}

impl<'a> Field<'a> {
    fn bytes(&self, number: u64) -> Option<&'a [u8]> {
        match self.value {
            Value::Bytes(bytes) if self.number == number => Some(bytes),
            _ => None,
        }
    }

    fn text(&self, number: u64) -> Option<&'a str> {
        self.bytes(number).and_then(|bytes| std::str::from_utf8(bytes).ok())
    }

    fn number(&self, number: u64) -> Option<u64> {
        match self.value {
            Value::Number(value) if self.number == number => Some(value),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `syntax = "proto3"; package opm; message M { double a = 1 [json_name = "a"]; }`, as
    /// `descriptor_pb2.FileDescriptorSet` of protobuf for Python encodes it.
    const ONE: &[u8] = b"\n-\n\x0bopm/M.proto\x12\x03opm\"\x11\n\x01M\x12\x0c\
        \n\x01a\x18\x01 \x01(\x01R\x01ab\x06proto3";

    #[test]
    fn a_type_of_doubles_is_known_by_its_name() {
        let flat = Flat::of("opm.M", ONE).unwrap();
        assert_eq!(flat.names, ["a"]);
        assert_eq!(Flat::of("opm.N", ONE), None);
        assert_eq!(Flat::of("M", ONE), None);
        // The same with a float: TYPE_FLOAT is 2.
        let mut float = ONE.to_vec();
        let at = float.windows(2).position(|pair| pair == b"(\x01").unwrap();
        float[at + 1] = 2;
        assert_eq!(Flat::of("opm.M", &float), None);
        for length in 0..ONE.len() {
            Flat::of("opm.M", &ONE[..length]);
        }
    }

    #[test]
    fn values_come_by_their_numbers() {
        let flat = Flat { names: ["a", "b"].map(String::from).into(), numbers: vec![1, 3] };
        let decode = |message: &[u8]| {
            let mut values = vec![];
            flat.decode(message, &mut values).map(|()| values)
        };
        let double = |key: u8, value: f64| [&[key][..], &value.to_le_bytes()].concat();
        let both = [double(3 << 3 | 1, 2.5), double(1 << 3 | 1, -1.0)].concat();
        assert_eq!(decode(&both).unwrap(), [-1.0, 2.5]);
        assert_eq!(decode(&[]).unwrap(), [0.0, 0.0]);
        // A field that the type does not have.
        assert_eq!(decode(&[&[2 << 3, 7][..], &both].concat()).unwrap(), [-1.0, 2.5]);
        assert!(decode(&both[..10]).unwrap_err().contains("not protobuf"));
        assert!(decode(&[1 << 3, 7]).unwrap_err().contains("a is not a double"));
    }
}
