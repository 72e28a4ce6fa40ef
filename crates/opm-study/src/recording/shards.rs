//! All shards of a workspace: checked, and joined to the result of a single sweep.

use super::describe::described;
use super::shard::{ShardCount, StoredShard};
use super::{Attachment, PROGRAM};
use crate::error::{MissingShards, ShardError, ShardProblem, StudyError};
use crate::poses::{PoseSource, ShardPoses};
use crate::workspace::Workspace;
use opm_core::manipulator::Manipulator;
use opm_workspace::{ConditioningIndex, Count};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// The shards of one workspace.
pub struct Shards {
    /// The files, in the order of their numbers; one or more.
    parts: Vec<StoredShard>,
}

impl Shards {
    /// The shards of these files, in any order.
    ///
    /// # Errors
    /// There are none, or another program wrote them.
    pub fn new(mut parts: Vec<StoredShard>) -> Result<Self, StudyError> {
        parts.sort_by_key(StoredShard::shard);
        let first = parts.first().ok_or(StudyError::NoShards)?;
        match first.run().get("program") {
            Some(program) if program == PROGRAM => Ok(Self { parts }),
            // Another program may count or record differently.
            other => {
                let by = other.map_or("an unknown program", |program| program).to_owned();
                Err(first.wrong(ShardProblem::Program { by, this: PROGRAM }).into())
            }
        }
    }

    /// The file with the lowest number.
    pub fn first(&self) -> &StoredShard {
        &self.parts[0]
    }

    /// The files.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(StoredShard::path)
    }

    /// The mechanism file that is attached to the first shard, and the name of the mechanism.
    ///
    /// # Errors
    /// No mechanism file is attached.
    pub fn mechanism(&self) -> Result<(Attachment<'_>, &str), ShardError> {
        let attached = self.first().mechanism()?;
        Ok((attached, self.first().mechanism_label().unwrap_or(attached.name)))
    }

    /// The workspace that they are parts of.
    ///
    /// # Errors
    /// They belong to another manipulator.
    pub fn workspace(
        &self,
        manipulator: impl Into<Arc<Manipulator>>,
    ) -> Result<Workspace, ShardError> {
        let workspace = described(self.first().run(), manipulator.into());
        workspace.ok_or_else(|| self.first().wrong(ShardProblem::UnknownRun))
    }

    /// The joined result of all shards, if they are the parts of one workspace, each of them once.
    ///
    /// # Errors
    /// They are not, or some are missing.
    pub fn join(&self, workspace: &Workspace) -> Result<ShardCount, StudyError> {
        let first = self.first();
        let mechanism = first.mechanism()?.text;
        for part in &self.parts {
            part.expect_run(first.run(), mechanism)?;
        }
        let of = first.shard().count();
        for pair in self.parts.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let (first, shard, file) = (a.shard(), b.shard(), a.path().to_owned());
            if shard.count() != of {
                let problem = ShardProblem::OtherNumber { shard, file, first };
                return Err(b.wrong(problem).into());
            }
            if shard == first {
                return Err(b.wrong(ShardProblem::Repeated { shard, file }).into());
            }
        }
        let there: BTreeSet<u64> = self.parts.iter().map(|part| part.shard().number()).collect();
        if (there.len() as u64) < of {
            return Err(MissingShards::new(&there, of).into());
        }
        let conditioning = workspace.conditioning_length().map(ConditioningIndex::nothing);
        let mut all = ShardCount { count: Count::nothing(&workspace.manipulator), conditioning };
        for part in &self.parts {
            let ShardCount { count, conditioning } = part.count(workspace)?;
            all.count = all.count.merge(&count);
            if let (Some(sum), Some(index)) = (&mut all.conditioning, &conditioning) {
                sum.add(index);
            }
        }
        Ok(all)
    }

    /// The poses of the workspace, from the files.
    pub fn poses<'a>(&self, workspace: &'a Workspace) -> PoseSource<'a> {
        let files = self.paths().map(Path::to_owned).collect();
        PoseSource::Shards(ShardPoses::new(workspace.grid(), files))
    }
}
