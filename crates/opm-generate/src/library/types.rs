//! The types of a geometry.

use super::*;

structs! {
    /// A point or a direction of a plane.
    Complex { re: Real, im: Real }
    /// A point or a direction of space.
    Vector { x: Real, y: Real, z: Real }
    /// A rotation matrix: its three columns.
    Rotation { x: Vector, y: Vector, z: Vector }
    /// A joint coordinate: its value at home, its lowest and highest values (infinite without limits), and the size
    /// that rounding is compared with: 1 for an angle, the mechanism's for a length.
    Joint { home: Real, low: Real, high: Real, size: Real }
    /// A revolute joint of a plane: its position, and its sense, 1 counter-clockwise or -1 clockwise.
    Pivot { at: Complex, sense: Real }
    /// Three pivots of a plane.
    PlanarRrr { p1: Pivot, p2: Pivot, p3: Pivot }
    /// A slider of a plane, then two pivots. The slider's direction is a unit vector, as all directions here are.
    PlanarPrr { d1: Complex, p2: Pivot, p3: Pivot }
    /// Two pivots of a plane, then a slider.
    PlanarRrp { p1: Pivot, p2: Pivot, d3: Complex }
    /// A slider between two pivots of a plane.
    PlanarRpr { p1: Pivot, d2: Complex, p3: Pivot }
    /// A pivot of a plane, then two sliders.
    PlanarRpp { p1: Pivot, d2: Complex, d3: Complex }
    /// Two sliders of a plane, then a pivot.
    PlanarPpr { d1: Complex, d2: Complex, p3: Pivot }
    /// A pivot between two sliders of a plane.
    PlanarPrp { d1: Complex, p2: Pivot, d3: Complex }
    /// Two pivots of a plane.
    PlanarRr { p1: Pivot, p2: Pivot }
    /// A slider of a plane, then a pivot.
    PlanarPr { d1: Complex, p2: Pivot }
    /// A pivot of a plane, then a slider.
    PlanarRp { p1: Pivot, d2: Complex }
    /// Two sliders of a plane.
    PlanarPp { d1: Complex, d2: Complex }
    /// A pivot of a plane.
    PlanarR { p1: Pivot }
    /// A slider of a plane.
    PlanarP { d1: Complex }
    /// Three revolute axes through one point: unit directions at home.
    SphericalRrr { a1: Vector, a2: Vector, a3: Vector }
    /// Two revolute axes through one point.
    SphericalRr { a1: Vector, a2: Vector }
    /// A revolute axis.
    SphericalR { a1: Vector }
    /// A spherical joint: the directions of the frame of its section, in base coordinates.
    SphericalS { axes: Rotation }
    /// A joint on an axis: the rotation and the advance for a unit of its coordinate.
    Coaxial { rotation: Real, advance: Real }
    /// Two joints on one axis.
    CylindricalTwo { j1: Coaxial, j2: Coaxial }
    /// A joint on an axis.
    CylindricalOne { j1: Coaxial }
    /// Two sliders in a plane.
    TranslationalPp { d1: Complex, d2: Complex }
    /// A slider in a plane.
    TranslationalP { d1: Complex }
    /// Three sliders in space.
    SpatialPpp { d1: Vector, d2: Vector, d3: Vector }
    /// Two sliders in space.
    SpatialPp { d1: Vector, d2: Vector }
    /// A slider in space.
    SpatialP { d1: Vector }
    /// A slider that is the part in the plane of an inclined imaginary joint: its displacement for a unit of the
    /// joint's.
    Part { rate: Real }
    /// A joint that carries the height: its displacement for a unit of height.
    Lift { rate: Real }
    /// A joint that carries the height and moves its leg in the plane: its displacement for a unit of height, and
    /// what it does in the plane for one: a rotation, and the velocity of the origin.
    LeaningLift { rate: Real, rotation: Real, velocity: Complex }
    /// A leg demands that a point of the body is at a distance from a point of the base.
    Circle { point: Complex, centre: Complex, radius: Real }
    /// A leg demands that a point of the body is on a line of the base: its normal, and its distance along that.
    Line { point: Complex, normal: Complex, offset: Real }
    /// A leg demands that a point of the base is on a line of the body.
    CarriedLine { point: Complex, normal: Complex, offset: Real }
    /// A leg demands a rotation.
    Heading { rotation: Complex }
    /// A leg demands an angle, by its cosine, between a direction of the base and one of the body.
    Cone { fixed: Vector, carried: Vector, cosine: Real }
    /// A leg demands a linear equation of the displacement.
    Flat { normal: Vector, value: Real }
    /// The frame of a section: its origin, and its directions, in base coordinates.
    Frame { origin: Vector, axes: Rotation }
}
