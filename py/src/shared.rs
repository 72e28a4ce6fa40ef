//! What many results have in common, and Python gets a copy of.

use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use std::ops::Deref;
use std::sync::Arc;

/// A value that is held once.
#[derive(Clone)]
pub struct Shared<T>(Arc<T>);

impl<T> Shared<T> {
    pub fn new(value: T) -> Self {
        Self(Arc::new(value))
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<'py, T: Clone + IntoPyObject<'py>> IntoPyObject<'py> for &Shared<T> {
    type Target = T::Target;
    type Output = T::Output;
    type Error = T::Error;

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Self::Error> {
        T::clone(&self.0).into_pyobject(py)
    }
}

impl<'a, 'py, T: FromPyObjectOwned<'py>> FromPyObject<'a, 'py> for Shared<T> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> Result<Self, PyErr> {
        object.extract::<T>().map(Self::new).map_err(Into::into)
    }
}
