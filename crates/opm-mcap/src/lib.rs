//! MCAP recordings of workspaces.
