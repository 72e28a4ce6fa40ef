//! Closed forms as a tree, from which each language is printed.
//!
//! The closed forms are described once: structs of numbers, functions with values, constant and changed parameters, `if`,
//! counting `for`, `return`, with the type of every expression. They are traced ([`crate::trace`]); a language is a printer of
//! the tree, and a frame of its own around it.

pub mod flow;
pub mod lower;
pub mod visit;

/// The code of one mechanism.
#[derive(Clone, Debug, Default)]
pub struct Code {
    /// Names of numbers: how many there are of each, the joints, the coordinates.
    pub enums: Vec<Enum>,
    pub constants: Vec<Constant>,
    pub structs: Vec<Struct>,
    pub functions: Vec<Function>,
    /// The geometry of the mechanism.
    pub default: Value,
}

impl Code {
    /// The members of a struct.
    pub fn members(&self, name: &str) -> &[Member] {
        let known = self.structs.iter().find(|known| known.name == name);
        known.map_or(&[], |known| &known.members)
    }

    /// The number that has a name.
    pub fn number(&self, name: &str) -> Option<usize> {
        let mut entries = self.enums.iter().flat_map(|names| &names.entries);
        entries.find(|entry| entry.name == name).map(|entry| entry.value)
    }
}

/// Names of the numbers from 0, or of counts.
#[derive(Clone, Debug)]
pub struct Enum {
    pub comment: String,
    pub entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
pub struct Entry {
    pub name: String,
    pub value: usize,
    pub comment: String,
}

/// A number with a name. Tolerances depend on the type of numbers.
#[derive(Clone, Debug)]
pub struct Constant {
    pub name: String,
    pub comment: String,
    pub double: String,
    pub float: String,
}

#[derive(Clone, Debug)]
pub struct Struct {
    pub name: String,
    pub comment: String,
    pub members: Vec<Member>,
}

#[derive(Clone, Debug)]
pub struct Member {
    pub name: String,
    pub kind: Type,
    pub comment: String,
}

/// A constant of a struct's type, number by number.
#[derive(Clone, Debug)]
pub enum Value {
    Number(f64),
    List(Vec<Value>),
}

impl Default for Value {
    fn default() -> Self {
        Self::List(Vec::new())
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Type {
    Void,
    Bool,
    Int,
    /// A working mode, or bits of one.
    Bits,
    Real,
    Struct(String),
    /// The elements, and how many there are; 0 where a parameter does not say.
    Array(Box<Type>, usize),
}

impl Type {
    pub fn is_array(&self) -> bool {
        matches!(self, Self::Array(..))
    }

    /// The name of the struct that it is, or that its elements are.
    pub fn into_struct(self) -> Option<String> {
        match self {
            Self::Struct(name) => Some(name),
            Self::Array(of, _) => of.into_struct(),
            _ => None,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Function {
    pub name: String,
    pub comment: String,
    /// Whether it belongs to the interface.
    pub public: bool,
    pub inline: Inline,
    pub parameters: Vec<Parameter>,
    pub result: Type,
    pub body: Vec<Statement>,
}

/// What compilers of C are told to do with calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inline {
    /// To decide.
    No,
    /// To leave them out, if they think so.
    Short,
    /// To leave them out, unless the code is to be small: of the shortest functions, and of those whose arguments are large.
    Always,
}

#[derive(Clone, Debug)]
pub struct Parameter {
    pub name: String,
    pub kind: Type,
    pub pass: Pass,
}

/// How an argument is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// A copy.
    Value,
    /// A reference that is only read.
    Read,
    /// A reference that is written.
    Write,
}

#[derive(Clone, Debug)]
pub enum Statement {
    Comment(String),
    Declare {
        name: String,
        kind: Type,
        init: Option<Expr>,
    },
    /// `place = value`, or `place op= value`.
    Assign {
        place: Expr,
        op: Option<Op>,
        value: Expr,
    },
    Call(Expr),
    If {
        test: Expr,
        then: Vec<Statement>,
        otherwise: Vec<Statement>,
    },
    /// `for (i = from; i < to && test; ++i)`
    For {
        name: String,
        from: Expr,
        to: Expr,
        test: Option<Expr>,
        body: Vec<Statement>,
    },
    Block(Vec<Statement>),
    Return(Option<Expr>),
    Continue,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub node: Node,
    pub kind: Type,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// As it is written in C, without a suffix.
    Number(String),
    /// A constant, or an entry of an enum.
    Constant(String),
    /// The number that is larger than all others.
    Infinity,
    Variable(String),
    Member(Box<Expr>, String),
    Index(Box<Expr>, Box<Expr>),
    Negative(Box<Expr>),
    Not(Box<Expr>),
    Binary(Op, Box<Expr>, Box<Expr>),
    /// The second where the first is true, else the third.
    Choice(Box<Expr>, Box<Expr>, Box<Expr>),
    /// Of a function, or of one of [`BUILT_IN`].
    Call(String, Vec<Argument>),
    /// A struct from all of its members, or an array from its elements.
    Made(Vec<Expr>),
    /// The conversion to the expression's type.
    Cast(Box<Expr>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    pub value: Expr,
    pub pass: Pass,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Op {
    Or,
    And,
    Equal,
    Unequal,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    BitOr,
    BitAnd,
    ShiftLeft,
    ShiftRight,
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
}

impl Op {
    /// How closely it binds, as in C.
    pub fn strength(self) -> u8 {
        match self {
            Self::Or => 1,
            Self::And => 2,
            Self::BitOr => 3,
            Self::BitAnd => 4,
            Self::Equal | Self::Unequal => 5,
            Self::Less | Self::LessEqual | Self::Greater | Self::GreaterEqual => 6,
            Self::ShiftLeft | Self::ShiftRight => 7,
            Self::Add | Self::Subtract => 8,
            Self::Multiply | Self::Divide | Self::Remainder => 9,
        }
    }

    pub fn is_comparison(self) -> bool {
        matches!(self.strength(), 5 | 6)
    }

    pub fn in_c(self) -> &'static str {
        match self {
            Self::Or => "||",
            Self::And => "&&",
            Self::Equal => "==",
            Self::Unequal => "!=",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::BitOr => "|",
            Self::BitAnd => "&",
            Self::ShiftLeft => "<<",
            Self::ShiftRight => ">>",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Remainder => "%",
        }
    }
}

/// Functions of numbers that every language has.
pub const BUILT_IN: [&str; 11] =
    ["abs", "max", "min", "sqrt", "sin", "cos", "asin", "acos", "round", "ceil", "atan2"];

impl Expr {
    pub fn new(node: Node, kind: Type) -> Self {
        Self { node, kind }
    }

    pub fn variable(name: &str, kind: Type) -> Self {
        Self::new(Node::Variable(name.to_owned()), kind)
    }

    /// Whether it is a number as it is written.
    pub fn is_number(&self) -> bool {
        match &self.node {
            Node::Number(_) => true,
            Node::Negative(of) => of.is_number(),
            _ => false,
        }
    }

    /// The variable that a place is in.
    pub fn root(&self) -> Option<&str> {
        match &self.node {
            Node::Variable(name) => Some(name),
            Node::Member(of, _) | Node::Index(of, _) => of.root(),
            _ => None,
        }
    }
}
