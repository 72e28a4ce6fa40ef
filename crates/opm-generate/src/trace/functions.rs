//! Functions: their parameters, their calls, and how they are traced.

use super::{Any, Array, Handle, emit, traced};
use crate::tree::{
    Argument, Expr, Function, Inline, Node, Parameter, Pass, Statement, Type, visit,
};
use std::marker::PhantomData;

/// A parameter that is a reference which is only read; of numbers in brackets, an array.
pub struct In<T: ?Sized>(PhantomData<T>);

/// A parameter that is written through.
pub struct Out<T: ?Sized>(PhantomData<T>);

/// How something is passed.
pub trait Passed {
    type Handle: Copy + Into<Any>;
    const PASS: Pass;
    fn passed_type() -> Type;
    fn parameter(value: Any) -> Self::Handle;
}

impl<T: Handle> Passed for T {
    type Handle = T;
    const PASS: Pass = Pass::Value;
    fn passed_type() -> Type {
        T::kind()
    }
    fn parameter(value: Any) -> T {
        value.is()
    }
}

macro_rules! references {
    ($($reference:ident $pass:ident)+) => {$(
        impl<T: Handle> Passed for $reference<T> {
            type Handle = T;
            const PASS: Pass = Pass::$pass;
            fn passed_type() -> Type {
                T::kind()
            }
            fn parameter(value: Any) -> T {
                value.is()
            }
        }

        impl<T: Handle> Passed for $reference<[T]> {
            type Handle = Array<T>;
            const PASS: Pass = Pass::$pass;
            fn passed_type() -> Type {
                Type::Array(Box::new(T::kind()), 0)
            }
            fn parameter(value: Any) -> Array<T> {
                value.array()
            }
        }
    )+};
}

references!(In Read Out Write);

/// What a function may give back.
pub trait Result {
    fn result_type() -> Type;
    /// The result of a call; of a function that gives nothing, the call is a statement.
    fn of_call(call: Expr) -> Self;
    /// Returns it from the function that is being traced.
    fn end(self);
}

impl Result for () {
    fn result_type() -> Type {
        Type::Void
    }
    fn of_call(call: Expr) {
        emit(Statement::Call(call));
    }
    fn end(self) {}
}

impl<T: Handle> Result for T {
    fn result_type() -> Type {
        T::kind()
    }
    fn of_call(call: Expr) -> T {
        T::from_expr(call)
    }
    fn end(self) {
        super::give(self);
    }
}

/// A call of a function with all that is known of it.
pub fn call<R: Result>(name: &str, arguments: Vec<(Expr, Pass)>) -> R {
    let arguments = arguments.into_iter().map(|(value, pass)| Argument { value, pass }).collect();
    R::of_call(Expr::new(Node::Call(name.to_owned(), arguments), R::result_type()))
}

/// A call of a function that is known, with a value for each of its parameters.
pub fn call_known(function: &Function, given: &[Any]) -> Any {
    let arguments = function.parameters.iter().zip(given);
    let arguments =
        arguments.map(|(p, value)| Argument { value: value.expr(), pass: p.pass }).collect();
    let call = Expr::new(Node::Call(function.name.clone(), arguments), function.result.clone());
    if function.result == Type::Void {
        emit(Statement::Call(call.clone()));
    }
    Any::from_expr(call)
}

/// Defines functions of generated code: each as a Rust function that calls it, and all of them in the function `functions`. What
/// is documented here is in the generated code.
macro_rules! functions {
    (@inline) => { $crate::tree::Inline::No };
    (@inline #[inline]) => { $crate::tree::Inline::Short };
    (@inline #[inline(always)]) => { $crate::tree::Inline::Always };
    (@result) => { () };
    (@result $result:ty) => { $result };
    ($(
        $(#[doc = $doc:literal])*
        $(#[inline $(($always:ident))?])?
        fn $name:ident($($p:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block
    )+) => {
        $(
            $(#[doc = $doc])*
            // What is defined here may be called for some mechanisms, by its name.
            #[allow(dead_code, clippy::too_many_arguments)]
            pub fn $name(
                $($p: impl Into<<$kind as $crate::trace::Passed>::Handle>),*
            ) $(-> $result)? {
                $crate::trace::call(stringify!($name), vec![$((
                    $crate::trace::Any::from(Into::<<$kind as $crate::trace::Passed>::Handle>::into($p)).expr(),
                    <$kind as $crate::trace::Passed>::PASS,
                )),*])
            }
        )+

        /// The functions of this file.
        #[allow(non_snake_case)]
        pub fn functions() -> Vec<$crate::tree::Function> {
            vec![$({
                let comment = concat!($($doc,)* "");
                let inline = $crate::trace::functions!(@inline $(#[inline $(($always))?])?);
                let function = $crate::trace::Traced::new(stringify!($name), comment).inline(inline);
                function.body(|_parameters| -> $crate::trace::functions!(@result $($result)?) {
                    $(#[allow(unused_variables)]
                    let $p = _parameters.add::<$kind>(stringify!($p));)*
                    Into::into($body)
                })
            }),+]
        }
    };
}
pub(crate) use functions;

/// The parameters of a function.
#[derive(Default)]
pub struct Parameters(Vec<Parameter>);

impl Parameters {
    /// The next one.
    pub fn add<P: Passed>(&mut self, name: &str) -> P::Handle {
        P::parameter(self.of_kind(name, P::passed_type(), P::PASS))
    }

    /// The next one, of a type that only the mechanism says.
    pub fn of_kind(&mut self, name: &str, kind: Type, pass: Pass) -> Any {
        self.0.push(Parameter { name: name.to_owned(), kind: kind.clone(), pass });
        Any::from_expr(Expr::variable(name, kind))
    }
}

/// A function before its body is traced.
pub struct Traced {
    function: Function,
}

impl Traced {
    pub fn new(name: &str, comment: &str) -> Self {
        let function = Function {
            name: name.to_owned(),
            comment: comment.trim().to_owned(),
            public: false,
            inline: Inline::No,
            parameters: Vec::new(),
            result: Type::Void,
            body: Vec::new(),
        };
        Self { function }
    }

    pub fn inline(mut self, inline: Inline) -> Self {
        self.function.inline = inline;
        self
    }

    /// A function of the interface.
    pub fn public(mut self) -> Self {
        self.function.public = true;
        self
    }

    /// Traces its body.
    pub fn body<R: Result>(self, body: impl FnOnce(&mut Parameters) -> R) -> Function {
        self.of_kind(R::result_type(), |parameters| body(parameters).end())
    }

    /// The same for a result of a type that only the mechanism says.
    pub fn giving(self, kind: Type, body: impl FnOnce(&mut Parameters) -> Any) -> Function {
        self.of_kind(kind, |parameters| emit(Statement::Return(Some(body(parameters).expr()))))
    }

    fn of_kind(mut self, kind: Type, body: impl FnOnce(&mut Parameters)) -> Function {
        let mut parameters = Parameters::default();
        let statements = traced(|| body(&mut parameters));
        self.function.parameters = parameters.0;
        self.function.result = kind;
        self.function.body = statements;
        self.function
    }
}

impl Function {
    /// The function without those of these parameters that it does not need.
    pub fn without_unused(mut self, names: &[&str]) -> Self {
        let body = &self.body;
        let used = |p: &Parameter| body.iter().any(|one| visit::mentions(one, &p.name));
        self.parameters.retain(|p| !names.contains(&&*p.name) || used(p));
        self
    }

    /// Whether it has a parameter.
    pub fn takes(&self, name: &str) -> bool {
        self.parameters.iter().any(|p| p.name == name)
    }
}
