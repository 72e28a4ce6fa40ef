//! Whether a leg reaches a target, with no more joints than that takes: over several poses at once, and over boxes of poses.

use super::element::{Element, Kind};
use super::equation::Roots;
use super::program::{Program, Run, SIGNS};
use super::roots::General;
use super::{CLOSURE, MOST_FREEDOMS, WholeLeg};
use crate::numbers::Real;
use crate::numbers::pack::{Pack, PackJoint, PackRotation};
use nalgebra::Isometry3;

/// A number under a root that is more negative than this, as a share of its scale, is out of reach beyond doubt: far more than
/// the rounding that the closed form of a single pose mends.
const BEYOND: f64 = 1e-5;

/// Where all roots are real, the loop is closed to within this.
const CLOSED: f64 = 1e-6;

/// Those steps of a leg's closed form that decide on reach, and on the limits of some joints.
///
/// Where all roots are real, the leg closes: [`WholeLeg::reach`] has tested that.
#[derive(Clone, Debug, PartialEq)]
pub struct LegReach {
    elements: Vec<Element>,
    program: Program,
    size: f64,
}

/// What is known of a leg at some poses, and room to find it.
#[derive(Clone, Debug)]
pub struct PackReach {
    run: Run<Pack>,
    free: Pack,
    off: Pack,
    negative: Pack,
}

impl PackReach {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        let zero = Pack::constant(0.0);
        Self { run: Run::new(), free: zero, off: zero, negative: zero }
    }

    /// Whether the leg reaches a pose.
    #[inline(always)]
    pub fn holds(&self, pose: usize) -> bool {
        self.free.0[pose] + self.off.0[pose] + self.negative.0[pose] <= CLOSURE * CLOSURE
    }

    /// Whether a pose is certainly out of reach. Where neither holds, it has to be decided by itself.
    #[inline(always)]
    pub fn is_beyond(&self, pose: usize) -> bool {
        (self.negative.0[pose] > 2.0 * BEYOND) & (self.free.0[pose] <= CLOSURE * CLOSURE)
    }

    /// The displacement of a freedom that was asked for.
    #[inline(always)]
    pub fn displacement(&self, freedom: usize) -> &PackJoint {
        &self.run.joints[freedom]
    }
}

impl Default for PackReach {
    fn default() -> Self {
        Self::new()
    }
}

impl WholeLeg {
    /// The steps that decide on reach, and give the joints whose freedoms are `asked` for. `None` where these are spherical
    /// joints, and where real roots do not mean that the loop is closed.
    pub fn reach(&self, asked: impl Fn(usize) -> bool) -> Option<LegReach> {
        let Self { elements, program, size, .. } = self;
        let wanted = |joint: usize| {
            let element = &elements[joint];
            (element.slot..element.slot + element.freedoms()).any(&asked)
        };
        let ball = (0..elements.len()).any(|i| elements[i].kind == Kind::Ball && wanted(i));
        (!ball && self.real_closes).then(|| LegReach {
            elements: elements.clone(),
            program: program.reduced(wanted),
            size: *size,
        })
    }

    /// Whether the loop closes at all targets at which roots are real, of which there are some.
    pub(super) fn closes_where_real(&self, targets: &[Isometry3<f64>]) -> bool {
        let mut real = 0;
        let closed = targets.iter().all(|target| {
            let g = (target.rotation.to_rotation_matrix().into_inner(), target.translation.vector);
            self.branches().all(|branches| {
                let (mut roots, [first, second, ..]) = (General::new(self.size), branches);
                let signs = [first.sign(), second.sign()];
                let run = self.run::<f64>(g, signs, &mut roots);
                let general = roots.free + roots.negative <= CLOSURE * CLOSURE;
                real += usize::from(general);
                let open = roots.off + run.open();
                !general || open <= CLOSED * CLOSED
            })
        });
        closed && real > 0
    }
}

impl LegReach {
    /// A length of the leg, metres.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// The displacements of the joints that were asked for, by their freedoms.
    pub(crate) fn displacements<T: Real>(
        &self,
        g: (T::Rotation, T::Space),
        signs: [T::Sign; 2],
        roots: &mut impl Roots<T>,
    ) -> [T::Joint; MOST_FREEDOMS] {
        let mut run = Run::new();
        self.run::<T>(g, signs, roots, &mut run);
        run.joints
    }

    #[inline(always)]
    fn run<T: Real>(
        &self,
        g: (T::Rotation, T::Space),
        [first, second]: [T::Sign; 2],
        roots: &mut impl Roots<T>,
        run: &mut Run<T>,
    ) {
        let signs: [T::Sign; SIGNS] = [first, second, first, second];
        self.program.run::<T>((&self.elements, self.size), g, signs, roots, run);
    }

    /// Decides some poses.
    // In the explorer's page, which has one set of instructions, there is one copy of this code.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    #[cfg_attr(target_arch = "wasm32", inline(never))]
    pub fn decide(
        &self,
        (rotation, translation): (&PackRotation, &[Pack; 3]),
        signs: [f64; 2],
        found: &mut PackReach,
    ) {
        let mut roots = General::new(self.size);
        self.run::<Pack>((*rotation, *translation), signs, &mut roots, &mut found.run);
        (found.free, found.off, found.negative) = (roots.free, roots.off, roots.negative);
    }
}
