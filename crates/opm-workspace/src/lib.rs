//! Workspace sweeps.
