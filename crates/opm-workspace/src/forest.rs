//! Things that belong together, by union-find (R. E. Tarjan, *Efficiency of a good but not linear set union
//! algorithm*, J. ACM 22, 1975).

/// Trees of numbered things that belong together.
pub struct Forest {
    parents: Vec<u32>,
}

impl Forest {
    /// A number of things, each in a tree of its own. There are at most 2³² of them.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// The number of things.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// The thing that stands for a tree: its first one.
    pub fn root(&mut self, mut thing: usize) -> usize {
        while self.parents[thing] as usize != thing {
            // Every node on the path to the root gets its grandparent as its parent.
            self.parents[thing] = self.parents[self.parents[thing] as usize];
            thing = self.parents[thing] as usize;
        }
        thing
    }

    /// Joins the trees of two things. The earlier root stays a root, so that the result does not depend on
    /// the order.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }
}
