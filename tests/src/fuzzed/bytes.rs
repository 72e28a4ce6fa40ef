//! Inputs that are made, rather than arbitrary: bytes decide what they are made of.

/// Choices, made by bytes; zeros after the last.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// One of these, of which there is at least one.
    pub fn choose<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.byte() as usize % of.len()]
    }

    /// A number from -2 to 2; most are round.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            byte if byte < 200 => f64::from(byte % 17) / 4.0 - 2.0,
            _ => f64::from(self.byte()) / 64.0 - 2.0,
        }
    }

    /// Three of them.
    pub fn vector(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.number())
    }
}
