//! At home, on singularities, on the rim of reach, beyond it, and with values that make no sense.
