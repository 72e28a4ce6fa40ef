//! Figures as files: what an XML parser and a PNG decoder find in them.

mod picture;
mod seen;
mod tiles;
mod time;
