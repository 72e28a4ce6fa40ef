//! Rows of legs that regions do not decide: the ends of every boundary, sorted, and one answer between two of them.
//!
//! In a sphere, what the middle joint of a leg leaves of a row is known without asking ([`Reach::row_arcs`]).
//!
//! A leg's feasibility along a row changes only where the row meets one of few surfaces. For one leg after the other, the
//! ends are found for many rows at once ([`Reach::row_ends`]). Where an end falls on what is left of a row, that is cut,
//! and each piece is asked for, and every pose too close to an end, again for many rows at once
//! ([`Reach::reaches_many`]).
//!
//! [`Reach::row_arcs`]: opm_core::reach::Reach::row_arcs
//! [`Reach::row_ends`]: opm_core::reach::Reach::row_ends
//! [`Reach::reaches_many`]: opm_core::reach::Reach::reaches_many

use super::Sweep;
use super::clip::ROWS;
use super::runs::Run;
use super::sheet::{Sheet, SliceBranch};
use opm_core::manipulator::{Batch, Manipulator};
use opm_core::reach::{AT_ONCE, RowArcs, RowEnds, SheetRows};

/// Poses of a row of a window, from one number up to, not including, another one. The numbers begin with the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Piece {
    /// The place of the row among those that are asked for.
    row: usize,
    from: i32,
    to: i32,
    /// Whether a leg may be unable to go from the pose before to the first one along the row, even if it reaches both.
    apart: bool,
}

/// Whether the poses that are left of a row are in the regions of all legs that have any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clipped {
    /// They are.
    Surely,
    /// They are not, or rounding could change that.
    Not,
}

/// The poses that are left of some rows, at most [`ROWS`], and what they are asked for with.
pub struct AskedRows {
    window: Run,
    /// The first coordinates of the window's poses.
    first: Vec<f64>,
    /// The numbers of the rows in the sheet, and their second coordinates.
    numbers: Vec<u64>,
    second: Vec<f64>,
    /// What regions told of each row.
    clipped: Vec<Clipped>,
    /// The poses that all legs reach, as far as they were asked, row by row, ascending and apart.
    left: Vec<Piece>,
    /// Where the pieces of each row end.
    ends: Vec<usize>,
    /// The poses that each branch of every leg reaches, in their order, where its leg was asked and has several.
    of_branch: Vec<Vec<Piece>>,
    /// Pieces of rows of which one pose answers for all.
    questions: Vec<Piece>,
    /// Poses of which rounding could change whether a leg reaches them.
    doubts: Vec<Piece>,
    cuts: Cuts,
    arcs: RowArcs,
    poses: [Vec<f64>; 2],
    answers: Vec<bool>,
    batch: Batch,
}

/// Where rows are cut.
#[derive(Default)]
struct Cuts {
    /// The second coordinates of the rows that are cut.
    second: Vec<f64>,
    ends: Vec<RowEnds>,
    /// The ends that fall on what is left of one row, or the holes of one, in order.
    of_row: Vec<[i32; 2]>,
}

impl AskedRows {
    /// Apart from a worker, which has no need of it where regions decide everything.
    pub fn new(manipulator: &Manipulator) -> Box<Self> {
        Box::new(Self {
            window: Run { from: 0, to: 0 },
            first: Vec::new(),
            numbers: Vec::new(),
            second: Vec::new(),
            clipped: Vec::new(),
            left: Vec::new(),
            ends: Vec::new(),
            of_branch: Vec::new(),
            questions: Vec::new(),
            doubts: Vec::new(),
            cuts: Cuts::default(),
            arcs: RowArcs::new(),
            poses: [Vec::new(), Vec::new()],
            answers: Vec::new(),
            batch: manipulator.batch(),
        })
    }

    /// Begins with a window of no rows.
    pub fn begin(&mut self, sweep: &Sweep<'_>, window: Run) {
        if self.window != window {
            self.window = window;
            let axis = &sweep.grid.axes()[0];
            self.first.clear();
            self.first.extend((window.from..window.to).map(|pose| axis.value(pose)));
        }
        self.numbers.clear();
        self.second.clear();
        self.clipped.clear();
        self.left.clear();
    }

    /// Adds row number `number` of the sheet, with the poses of the window that are left of it. A row without poses is left out.
    pub fn push(&mut self, sweep: &Sweep<'_>, number: u64, left: &[Run], clipped: Clipped) {
        if left.is_empty() {
            return;
        }
        let axes = &sweep.grid.axes()[..sweep.grid.lower()];
        let row = self.numbers.len();
        self.numbers.push(number);
        self.second.push(axes.get(1).map_or(0.0, |axis| axis.value(number)));
        self.clipped.push(clipped);
        let number = |pose: u64| (pose - self.window.from) as i32;
        let pieces = left.iter().map(|run| {
            let (from, to) = (number(run.from), number(run.to));
            Piece { row, from, to, apart: true }
        });
        self.left.extend(pieces);
    }

    /// The numbers of the rows in the sheet.
    pub fn numbers(&self) -> &[u64] {
        &self.numbers
    }

    /// The first coordinates of the window's poses.
    pub fn first(&self) -> &[f64] {
        &self.first
    }

    /// The second coordinates of the rows.
    pub fn second(&self) -> &[f64] {
        &self.second
    }

    /// The poses that are left: the place of the row, and from which number in the window to which.
    pub fn pieces(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        self.left.iter().map(|piece| (piece.row, piece.from as usize, piece.to as usize))
    }

    /// Leaves those poses that are `kept`: for each row, one answer for each pose of the window.
    pub fn keep(&mut self, kept: &[bool]) {
        let width = self.first.len();
        let pieces = std::mem::take(&mut self.left);
        for piece in pieces {
            let row = &kept[piece.row * width..][..width];
            let mut next = piece.from;
            while next < piece.to {
                let end = (next..piece.to).find(|&pose| row[pose as usize] != row[next as usize]);
                let end = end.unwrap_or(piece.to);
                if row[next as usize] {
                    let apart = piece.apart && next == piece.from;
                    self.left.push(Piece { from: next, to: end, apart, ..piece });
                }
                next = end;
            }
        }
        self.find_row_ends();
    }

    /// Whether any row is not clipped.
    pub fn any_unclipped(&self) -> bool {
        self.clipped.contains(&Clipped::Not)
    }

    /// The number of poses that are left of all rows.
    pub fn count(&self) -> u64 {
        self.left.iter().map(|piece| (piece.to - piece.from) as u64).sum()
    }

    /// The poses that are left of row number `row` of those that were asked for.
    pub fn runs(&self, row: usize) -> impl Iterator<Item = Run> + Clone {
        let start = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        let number = |pose: i32| self.window.from + pose as u64;
        let pieces = self.left[start..self.ends[row]].iter();
        pieces.map(move |piece| Run { from: number(piece.from), to: number(piece.to) })
    }

    /// Whether a branch of a leg that has several and was asked, by its number among all branches, reaches any of the poses
    /// that are left.
    pub fn uses(&self, branch: usize) -> bool {
        let mut own = self.of_branch[branch].iter().peekable();
        self.left.iter().any(|piece| {
            let before = |other: &&Piece| (other.row, other.to) <= (piece.row, piece.from);
            while own.next_if(before).is_some() {}
            own.peek().is_some_and(|other| other.row == piece.row && other.from < piece.to)
        })
    }

    /// Leaves what those legs reach at most that are `wanted`, have one branch, and whose lower sections move in a sphere.
    pub fn cut_arcs(
        &mut self,
        sweep: &Sweep<'_>,
        sheet: &Sheet<'_>,
        wanted: impl Fn(&[SliceBranch]) -> bool,
    ) {
        for branches in sheet.legs.iter().filter(|branches| wanted(branches)) {
            let [branch] = &branches[..] else { continue };
            if !branch.has_arcs() || self.left.is_empty() {
                continue;
            }
            if self.first.len() < 2 {
                // A pose alone is asked for.
                self.clipped.fill(Clipped::Not);
                return;
            }
            self.cuts.second.clear();
            let mut lanes = Lanes::new();
            for piece in &self.left {
                if lanes.of(piece.row).1 {
                    self.cuts.second.push(self.second[piece.row]);
                }
            }
            let rows = rows_of(sweep, sheet, &self.first, &self.cuts.second);
            sheet.reach().row_arcs(&branch.follow, &rows, &mut self.batch, &mut self.arcs);
            self.questions.clear();
            self.doubts.clear();
            lanes = Lanes::new();
            for &piece in &self.left {
                let (lane, is_first) = lanes.of(piece.row);
                let holes = &mut self.cuts.of_row;
                if is_first {
                    holes.clear();
                    holes.extend(self.arcs.holes(lane));
                    holes.sort_unstable_by_key(|hole| hole[0]);
                }
                subtract(piece, holes, &mut self.questions);
                let inside = |pose: &i32| (piece.from..piece.to).contains(pose);
                let poses = self.arcs.doubtful(lane).filter(inside);
                self.doubts.extend(poses.map(|from| Piece {
                    from,
                    to: from + 1,
                    apart: true,
                    ..piece
                }));
            }
            std::mem::swap(&mut self.left, &mut self.questions);
            self.settle_doubts(sweep, sheet, branch);
        }
    }

    /// Adds those of the doubtful poses that a branch reaches to what is left.
    fn settle_doubts(&mut self, sweep: &Sweep<'_>, sheet: &Sheet<'_>, branch: &SliceBranch) {
        if self.doubts.is_empty() {
            return;
        }
        self.doubts.sort_unstable_by_key(|piece| (piece.row, piece.from));
        self.doubts.dedup();
        std::mem::swap(&mut self.questions, &mut self.doubts);
        self.answer(sweep, sheet, branch);
        let reached = self.questions.iter().zip(&self.answers).filter(|(_, reached)| **reached);
        self.left.extend(reached.map(|(&piece, _)| piece));
        self.left.sort_unstable_by_key(|piece| (piece.row, piece.from));
    }

    /// Leaves the poses that those legs reach that are `wanted`, where regions do not tell it already.
    pub fn ask(
        &mut self,
        sweep: &Sweep<'_>,
        sheet: &Sheet<'_>,
        wanted: impl Fn(&[SliceBranch]) -> bool,
    ) {
        self.of_branch.resize_with(sheet.branches().count(), Vec::new);
        // A union of what branches reach no longer tells where a leg cannot go along.
        let all_single = sheet.legs.iter().all(|branches| branches.len() == 1);
        let unclipped = self.any_unclipped();
        let mut next = 0;
        for branches in &sheet.legs {
            let number = next;
            next += branches.len();
            let decided = match &branches[..] {
                [branch] => branch.is_decided() || branch.is_decided_by_arcs(),
                several => several.iter().all(SliceBranch::is_decided),
            };
            if !wanted(branches) || decided && !unclipped {
                continue;
            }
            match &branches[..] {
                [branch] => {
                    // What was clipped to the region of a leg's only branch, or to arcs, is where that closes.
                    let arcs = branch.has_arcs() && all_single;
                    let closes = (branch.is_clippable() || arcs) && !unclipped;
                    self.ask_branch(sweep, sheet, branch, [decided, closes]);
                    let (mut left, answers) = (std::mem::take(&mut self.left), &self.answers);
                    take_reached(&self.questions, answers, &mut left);
                    self.left = left;
                }
                several => {
                    // Which of them reaches a pose is of interest, too: none of it is known already.
                    for (branch, number) in several.iter().zip(number..) {
                        self.ask_branch(sweep, sheet, branch, [false, false]);
                        take_reached(&self.questions, &self.answers, &mut self.of_branch[number]);
                    }
                    self.left.clear();
                    for pieces in &self.of_branch[number..next] {
                        self.left.extend_from_slice(pieces);
                    }
                    join(&mut self.left);
                }
            }
        }
        self.find_row_ends();
    }

    /// Finds where the pieces of each row end.
    fn find_row_ends(&mut self) {
        self.ends.clear();
        let mut end = 0;
        for row in 0..self.numbers.len() {
            while self.left.get(end).is_some_and(|piece| piece.row == row) {
                end += 1;
            }
            self.ends.push(end);
        }
    }

    /// Asks for what is left of the rows, of which regions may have `decided` all that are clipped. Where the branch
    /// `closes` at all of it, only its limits matter.
    fn ask_branch(
        &mut self,
        sweep: &Sweep<'_>,
        sheet: &Sheet<'_>,
        branch: &SliceBranch,
        [decided, closes]: [bool; 2],
    ) {
        self.find_ends(sweep, sheet, branch, [decided, closes]);
        self.cut(decided);
        self.answer(sweep, sheet, branch);
        if decided {
            for (answer, piece) in self.answers.iter_mut().zip(&self.questions) {
                *answer |= self.clipped[piece.row] == Clipped::Surely;
            }
        }
    }

    /// Answers each question for a branch by its middle pose.
    fn answer(&mut self, sweep: &Sweep<'_>, sheet: &Sheet<'_>, branch: &SliceBranch) {
        let [first, second] = &mut self.poses;
        first.clear();
        second.clear();
        for &Piece { row, from, to, .. } in &self.questions {
            first.push(self.first[((from + to - 1) / 2) as usize]);
            second.push(self.second[row]);
        }
        self.answers.clear();
        self.answers.resize(self.questions.len(), false);
        let poses = first.chunks(AT_ONCE).zip(second.chunks(AT_ONCE));
        for ((first, second), answers) in poses.zip(self.answers.chunks_mut(AT_ONCE)) {
            let (others, batch) = (others_of_sheet(sweep, sheet), &mut self.batch);
            sheet.reach().reaches_many(&branch.follow, [first, second], others, batch, answers);
        }
    }

    /// Finds the ends of what a branch reaches in the rows that are asked for it.
    fn find_ends(
        &mut self,
        sweep: &Sweep<'_>,
        sheet: &Sheet<'_>,
        branch: &SliceBranch,
        [decided, closes]: [bool; 2],
    ) {
        let Cuts { second, ends, .. } = &mut self.cuts;
        second.clear();
        ends.clear();
        let mut last = usize::MAX;
        for &Piece { row, .. } in &self.left {
            if row != last && (!decided || self.clipped[row] == Clipped::Not) {
                second.push(self.second[row]);
            }
            last = row;
        }
        if second.is_empty() {
            return;
        }
        let (reach, count) = (sheet.reach(), self.first.len() as u64);
        let surfaces = branch.transitions.get_or_init(|| reach.transitions(&branch.follow));
        match surfaces.as_ref().filter(|_| count > 1) {
            Some(surfaces) => {
                let rows = rows_of(sweep, sheet, &self.first, second);
                let batch = &mut self.batch;
                reach.row_ends(&branch.follow, surfaces, &rows, !closes, batch, ends);
            }
            None => ends.push(RowEnds::everything(count)),
        }
    }

    /// Cuts what is left of the rows at the ends, and makes each part a question.
    fn cut(&mut self, decided: bool) {
        let Cuts { ends, of_row, .. } = &mut self.cuts;
        // In most rows, no end is where poses are left.
        let (mut from, mut to, mut is_cut) = ([0; ROWS], [0; ROWS], [0; ROWS]);
        let mut lanes = Lanes::new();
        for piece in &self.left {
            if decided && self.clipped[piece.row] == Clipped::Surely {
                continue;
            }
            let (lane, is_first) = lanes.of(piece.row);
            if is_first {
                from[lane] = piece.from;
            }
            to[lane] = piece.to;
        }
        for end in &*ends {
            end.meet(&from, &to, &mut is_cut);
        }
        self.questions.clear();
        lanes = Lanes::new();
        for &piece in &self.left {
            if decided && self.clipped[piece.row] == Clipped::Surely {
                self.questions.push(piece);
                continue;
            }
            let (lane, is_first) = lanes.of(piece.row);
            if is_cut[lane] == 0 {
                self.questions.push(piece);
                continue;
            }
            if is_first {
                of_row.clear();
                let all = ends.iter().map(|end| end.of(lane));
                of_row.extend(all.filter(|cut| cut[0] < to[lane] && cut[1] > from[lane]));
                of_row.sort_unstable_by_key(|cut| cut[0]);
            }
            cut_piece(piece, of_row, &mut self.questions);
        }
    }
}

/// The lanes of rows, one after the other as they come.
struct Lanes {
    next: usize,
    row: usize,
}

impl Lanes {
    fn new() -> Self {
        Self { next: 0, row: usize::MAX }
    }

    /// The lane of a row, and whether it is a new one.
    fn of(&mut self, row: usize) -> (usize, bool) {
        let is_first = row != self.row;
        self.next += usize::from(is_first);
        self.row = row;
        (self.next - 1, is_first)
    }
}

/// The rows with these second coordinates, of poses with these first ones.
fn rows_of<'s>(
    sweep: &Sweep<'_>,
    sheet: &'s Sheet<'_>,
    first: &[f64],
    second: &'s [f64],
) -> SheetRows<'s> {
    SheetRows {
        first: first[0],
        step: sheet.scale.step,
        count: first.len() as u64,
        extent: sheet.scale.extent,
        second,
        others: others_of_sheet(sweep, sheet),
    }
}

/// Adds what some holes leave of a piece. They are in order, and may overlap, or lie between two poses.
fn subtract(piece: Piece, holes: &[[i32; 2]], parts: &mut Vec<Piece>) {
    let (mut next, mut apart) = (piece.from, piece.apart);
    let inside = |[from, to]: &&[i32; 2]| *to >= piece.from && *from <= piece.to;
    for &[from, to] in holes.iter().filter(inside) {
        if from > next {
            parts.push(Piece { from: next, to: from.min(piece.to), apart, ..piece });
        }
        next = next.max(from).max(to);
        apart = true;
    }
    if next < piece.to {
        parts.push(Piece { from: next, apart, ..piece });
    }
}

/// Cuts a piece at some places, which are in order, and adds the parts, and each pose of these places apart.
fn cut_piece(piece: Piece, cuts: &[[i32; 2]], parts: &mut Vec<Piece>) {
    let mut next = piece.from;
    let mut add = |from: i32, to: i32| {
        let apart = piece.apart && from == piece.from;
        parts.push(Piece { from, to, apart, ..piece });
    };
    for &[from, to] in cuts {
        let (from, to) = (from.min(piece.to), to.min(piece.to));
        if from > next {
            add(next, from);
            next = from;
        }
        (next..to).for_each(|pose| add(pose, pose + 1));
        next = next.max(to);
    }
    if next < piece.to {
        add(next, piece.to);
    }
}

/// Takes the pieces for which the answer is yes, those that touch each other as one.
fn take_reached(questions: &[Piece], answers: &[bool], reached: &mut Vec<Piece>) {
    reached.clear();
    for (&piece, _) in questions.iter().zip(answers).filter(|(_, reached)| **reached) {
        match reached.last_mut() {
            Some(last) if !piece.apart && (last.row, last.to) == (piece.row, piece.from) => {
                last.to = piece.to;
            }
            _ => reached.push(piece),
        }
    }
}

/// Brings pieces into order, and joins those that overlap or touch each other.
fn join(pieces: &mut Vec<Piece>) {
    pieces.sort_unstable_by_key(|piece| (piece.row, piece.from));
    pieces.dedup_by(|next, piece| {
        let joined = next.row == piece.row && next.from <= piece.to;
        if joined {
            piece.to = piece.to.max(next.to);
        }
        joined
    });
}

/// The coordinates of the lower section that a sheet's poses share.
fn others_of_sheet<'s>(sweep: &Sweep<'_>, sheet: &'s Sheet<'_>) -> &'s [f64] {
    sheet.others.get(1..sweep.grid.lower().saturating_sub(1)).unwrap_or_default()
}
