//! Structured text as it is executed: every variable is a range of cells of one number each.

/// A type. All arrays begin at zero.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    Bool,
    Dint,
    Dword,
    Lreal,
    Array(Box<Kind>, usize),
    /// A struct, or a function block, by its place.
    Struct(usize),
    Block(usize),
}

/// A variable of a unit, or a member of a struct.
#[derive(Clone, Debug)]
pub struct Variable {
    pub name: String,
    pub kind: Kind,
    pub section: Section,
    /// The first of its cells; that of its address for a reference.
    pub cell: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    Input,
    Output,
    InOut,
    Local,
    Constant,
}

/// A struct, a function or a function block.
#[derive(Clone, Debug, Default)]
pub struct Unit {
    pub name: String,
    pub variables: Vec<Variable>,
    /// The cells of a new one.
    pub initial: Vec<f64>,
    /// Of a function: its type; its cells are the first ones.
    pub result: Option<Kind>,
    pub body: Vec<Step>,
}

#[derive(Clone, Debug)]
pub enum Step {
    Assign(Place, Value),
    Do(Value),
    /// A function block at a place.
    Run(Place, usize, Vec<(Variable, Passed)>),
    If(Vec<(Value, Vec<Step>)>, Vec<Step>),
    For {
        counter: Place,
        from: Value,
        to: Value,
        body: Vec<Step>,
    },
    Return,
    Exit,
    Continue,
}

/// An argument: a value, or the variable that it is.
#[derive(Clone, Debug)]
pub enum Passed {
    Value(Value),
    Place(Place),
}

/// A variable or a part of one.
#[derive(Clone, Debug)]
pub struct Place {
    pub kind: Kind,
    pub section: Section,
    /// The variable's cell; for a reference, that of the address.
    pub cell: usize,
    /// What is added to it, and the indices: each with the number of elements and the cells of one.
    pub offset: usize,
    pub indices: Vec<(Value, usize, usize)>,
    pub line: usize,
}

/// A value with its type.
#[derive(Clone, Debug)]
pub struct Value {
    pub kind: Kind,
    pub node: Node,
    pub line: usize,
}

#[derive(Clone, Debug)]
pub enum Node {
    Number(f64),
    Of(Box<Place>),
    Negative(Box<Value>),
    Not(Box<Value>),
    Binary(&'static str, Box<Value>, Box<Value>),
    /// A function of the standard.
    Standard(String, Vec<Value>),
    /// A function of the text, by its place.
    Call(usize, Vec<(Variable, Passed)>),
}
