//! Tests that span the crates: random mechanisms, golden vectors, the command as a user runs it.
