//! A small language within Rust, in which closed forms are written.
//!
//! A number, a vector or a struct of generated code is a handle of that type. What is done with handles is not computed: it
//! becomes an expression of the tree, and [`name!`], [`when`], [`count`] and [`give`] become statements of the function that is
//! being traced on this thread.

pub mod closed_forms;
mod functions;
mod numbers;
mod structs;
pub mod whole;

pub use functions::{In, Out, Parameters, Passed, Traced, call, call_known};
pub use numbers::*;
pub use structs::{Any, Array, snake};
pub(crate) use {functions::functions, structs::structs};

use crate::tree::{Expr, Node, Op, Statement, Type, visit};
use std::cell::{Cell, RefCell};

/// What is known of the function that is being traced.
#[derive(Default)]
struct Trace {
    /// Which function of this thread it is, from 1.
    number: usize,
    nodes: Vec<Stored>,
    /// The statements of nested blocks.
    blocks: Vec<Vec<Statement>>,
}

enum Stored {
    Whole(Expr),
    Member(Id, &'static str, fn() -> Type),
}

thread_local! {
    static TRACE: RefCell<Trace> = RefCell::default();
    static TRACED: Cell<usize> = const { Cell::new(0) };
}

/// What a handle stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Id {
    /// An expression, by the numbers of the function and of the expression.
    Node(usize, usize),
    /// A constant of the code.
    Constant(&'static str),
}

fn store(stored: Stored) -> Id {
    TRACE.with_borrow_mut(|trace| {
        trace.nodes.push(stored);
        Id::Node(trace.number, trace.nodes.len() - 1)
    })
}

/// A member of a struct.
pub fn member(of: Id, name: &'static str, kind: fn() -> Type) -> Id {
    store(Stored::Member(of, name, kind))
}

fn resolved(trace: &Trace, id: Id, kind: Type) -> Expr {
    match id {
        Id::Constant(name) => Expr::new(Node::Constant(name.to_owned()), kind),
        Id::Node(function, at) => {
            assert_eq!(function, trace.number, "a handle is used in another function");
            match &trace.nodes[at] {
                Stored::Whole(expr) => expr.clone(),
                Stored::Member(of, name, kind) => {
                    let of = resolved(trace, *of, Type::Void);
                    Expr::new(Node::Member(Box::new(of), (*name).to_owned()), kind())
                }
            }
        }
    }
}

/// A value of generated code.
pub trait Handle: Copy {
    /// The handle of an expression.
    fn of(id: Id) -> Self;
    fn id(self) -> Id;
    fn kind() -> Type;

    fn from_expr(expr: Expr) -> Self {
        Self::of(store(Stored::Whole(expr)))
    }
    /// The expression that it stands for.
    fn expr(self) -> Expr {
        TRACE.with_borrow(|trace| resolved(trace, self.id(), Self::kind()))
    }
    /// Declares a variable without a value.
    fn empty(name: &str) -> Self {
        emit(Statement::Declare { name: name.to_owned(), kind: Self::kind(), init: None });
        Self::from_expr(Expr::variable(name, Self::kind()))
    }
    /// Assigns a value to a variable, or to a part of one.
    fn set(self, value: impl Into<Self>) {
        assign(self.expr(), None, value.into().expr());
    }
}

/// A handle, or a literal that becomes one.
pub trait Value {
    type Handle: Handle;
    fn handle(self) -> Self::Handle;
}

impl<T: Handle> Value for T {
    type Handle = T;
    fn handle(self) -> T {
        self
    }
}

/// Declares variables with their values: `name!(reach = a - b, square = inner(reach, reach))`.
macro_rules! name {
    ($($name:ident = $value:expr),+ $(,)?) => {
        $(let $name = $crate::trace::named(stringify!($name), $value);)+
    };
}
pub(crate) use name;

/// A name that no variable of the function has so far: this one, or with a number.
pub fn fresh(name: &str) -> String {
    TRACE.with_borrow(|trace| {
        let mut taken = Vec::new();
        for block in &trace.blocks {
            visit::statements(block, &mut |statement| {
                if let Statement::Declare { name, .. } = statement {
                    taken.push(name.clone());
                }
            });
        }
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        std::iter::once(name.to_owned())
            .chain(numbered)
            .find(|one| !taken.contains(one))
            .unwrap_or_default()
    })
}

/// A variable with this value: one that is declared already, if there is one in this block or around it.
pub fn once<T: Handle>(name: &str, value: T) -> T {
    let expr = value.expr();
    let known = TRACE.with_borrow(|trace| {
        let mut all = trace.blocks.iter().flatten();
        all.find_map(|statement| match statement {
            Statement::Declare { name: known, init: Some(init), .. }
                if known.starts_with(name) && *init == expr =>
            {
                Some(known.clone())
            }
            _ => None,
        })
    });
    match known {
        Some(name) => T::from_expr(Expr::variable(&name, T::kind())),
        None => named(&fresh(name), value),
    }
}

/// Declares a variable with its value.
pub fn named<T: Value>(name: &str, value: T) -> T::Handle {
    let init = Some(value.handle().expr());
    emit(Statement::Declare { name: name.to_owned(), kind: T::Handle::kind(), init });
    T::Handle::from_expr(Expr::variable(name, T::Handle::kind()))
}

fn assign(place: Expr, op: Option<Op>, value: Expr) {
    emit(Statement::Assign { place, op, value });
}

/// Adds a statement to the function that is being traced.
pub fn emit(statement: Statement) {
    TRACE.with_borrow_mut(|trace| {
        if let Some(block) = trace.blocks.last_mut() {
            block.push(statement);
        }
    });
}

/// The statements that `body` adds.
pub fn statements(body: impl FnOnce()) -> Vec<Statement> {
    TRACE.with_borrow_mut(|trace| trace.blocks.push(Vec::new()));
    body();
    TRACE.with_borrow_mut(|trace| trace.blocks.pop()).unwrap_or_default()
}

/// A comment before the next statement.
pub fn note(text: &str) {
    emit(Statement::Comment(text.to_owned()));
}

/// Statements whose names are their own.
pub fn block(body: impl FnOnce()) {
    let body = statements(body);
    emit(Statement::Block(body));
}

/// Statements for the case that a test is true; [`When::otherwise`] may follow.
pub fn when(test: Truth, body: impl FnOnce()) -> When {
    let then = statements(body);
    emit(Statement::If { test: test.expr(), then, otherwise: Vec::new() });
    When
}

/// What may follow [`when`].
pub struct When;

impl When {
    /// Statements for the other case.
    pub fn otherwise(self, body: impl FnOnce()) {
        let other = statements(body);
        TRACE.with_borrow_mut(|trace| {
            if let Some(Statement::If { otherwise, .. }) =
                trace.blocks.last_mut().and_then(|block| block.last_mut())
            {
                *otherwise = other;
            }
        });
    }
}

/// A loop over the numbers from one up to another one.
pub fn count(name: &str, from: impl Into<Int>, to: impl Into<Int>, body: impl FnOnce(Int)) {
    counting(name, from.into(), to.into(), None, body);
}

/// The same as long as a test is true.
pub fn count_while(
    name: &str,
    from: impl Into<Int>,
    to: impl Into<Int>,
    test: Truth,
    body: impl FnOnce(Int),
) {
    counting(name, from.into(), to.into(), Some(test), body);
}

/// The same over combinations of bits.
pub fn count_bits(name: &str, to: impl Into<Bits>, body: impl FnOnce(Bits)) {
    counting(name, Bits::from(0), to.into(), None, body);
}

fn counting<T: Handle>(name: &str, from: T, to: T, test: Option<Truth>, body: impl FnOnce(T)) {
    let at = T::from_expr(Expr::variable(name, T::kind()));
    let (from, to, test) = (from.expr(), to.expr(), test.map(Handle::expr));
    let body = statements(|| body(at));
    emit(Statement::For { name: name.to_owned(), from, to, test, body });
}

/// Goes on with the next number of a loop.
pub fn again() {
    emit(Statement::Continue);
}

/// Returns a value from the function.
pub fn give(value: impl Value) {
    emit(Statement::Return(Some(value.handle().expr())));
}

/// The statements of a function.
fn traced(body: impl FnOnce()) -> Vec<Statement> {
    TRACED.set(TRACED.get() + 1);
    let trace = Trace { number: TRACED.get(), ..Trace::default() };
    let outer = TRACE.replace(trace);
    let mut statements = statements(body);
    TRACE.set(outer);
    visit::flatten(&mut statements);
    statements
}
