/* A point or a direction of a plane. */
typedef struct { NAME_real re, im; } NAME_complex;

/* A point or a direction of space. */
typedef struct { NAME_real x, y, z; } NAME_vector;

/* A rotation matrix: its three columns. */
typedef struct { NAME_vector x, y, z; } NAME_rotation;

/* A joint coordinate: its value at home, its lowest and highest values (infinite without limits), and the size that
   rounding is compared with: 1 for an angle, the mechanism's for a length. */
typedef struct { NAME_real home, low, high, size; } NAME_joint;

/* A revolute joint of a plane: its position, and its sense, 1 counter-clockwise or -1 clockwise. */
typedef struct { NAME_complex at; NAME_real sense; } NAME_pivot;

/* Three pivots of a plane. */
typedef struct { NAME_pivot p1, p2, p3; } NAME_planar_rrr;

/* A slider of a plane, then two pivots. The slider's direction is a unit vector, as all directions here are. */
typedef struct { NAME_complex d1; NAME_pivot p2, p3; } NAME_planar_prr;

/* Two pivots of a plane, then a slider. */
typedef struct { NAME_pivot p1, p2; NAME_complex d3; } NAME_planar_rrp;

/* A slider between two pivots of a plane. */
typedef struct { NAME_pivot p1; NAME_complex d2; NAME_pivot p3; } NAME_planar_rpr;

/* A pivot of a plane, then two sliders. */
typedef struct { NAME_pivot p1; NAME_complex d2, d3; } NAME_planar_rpp;

/* Two sliders of a plane, then a pivot. */
typedef struct { NAME_complex d1, d2; NAME_pivot p3; } NAME_planar_ppr;

/* A pivot between two sliders of a plane. */
typedef struct { NAME_complex d1; NAME_pivot p2; NAME_complex d3; } NAME_planar_prp;

/* Two pivots of a plane. */
typedef struct { NAME_pivot p1, p2; } NAME_planar_rr;

/* A slider of a plane, then a pivot. */
typedef struct { NAME_complex d1; NAME_pivot p2; } NAME_planar_pr;

/* A pivot of a plane, then a slider. */
typedef struct { NAME_pivot p1; NAME_complex d2; } NAME_planar_rp;

/* Two sliders of a plane. */
typedef struct { NAME_complex d1, d2; } NAME_planar_pp;

/* A pivot of a plane. */
typedef struct { NAME_pivot p1; } NAME_planar_r;

/* A slider of a plane. */
typedef struct { NAME_complex d1; } NAME_planar_p;

/* Three revolute axes through one point: unit directions at home. */
typedef struct { NAME_vector a1, a2, a3; } NAME_spherical_rrr;

/* Two revolute axes through one point. */
typedef struct { NAME_vector a1, a2; } NAME_spherical_rr;

/* A revolute axis. */
typedef struct { NAME_vector a1; } NAME_spherical_r;

/* A spherical joint: the directions of the frame of its section, in base coordinates. */
typedef struct { NAME_rotation axes; } NAME_spherical_s;

/* A joint on an axis: the rotation and the advance for a unit of its coordinate. */
typedef struct { NAME_real rotation, advance; } NAME_coaxial;

/* Two joints on one axis. */
typedef struct { NAME_coaxial j1, j2; } NAME_cylindrical_two;

/* A joint on an axis. */
typedef struct { NAME_coaxial j1; } NAME_cylindrical_one;

/* Two sliders in a plane. */
typedef struct { NAME_complex d1, d2; } NAME_translational_pp;

/* A slider in a plane. */
typedef struct { NAME_complex d1; } NAME_translational_p;

/* Three sliders in space. */
typedef struct { NAME_vector d1, d2, d3; } NAME_spatial_ppp;

/* Two sliders in space. */
typedef struct { NAME_vector d1, d2; } NAME_spatial_pp;

/* A slider in space. */
typedef struct { NAME_vector d1; } NAME_spatial_p;

/* A slider that is the part in the plane of an inclined imaginary joint: its displacement for a unit of the joint's. */
typedef struct { NAME_real rate; } NAME_part;

/* A joint that carries the height: its displacement for a unit of height. */
typedef struct { NAME_real rate; } NAME_lift;

/* A joint that carries the height and moves its leg in the plane: its displacement for a unit of height, and what it does
   in the plane for one: a rotation, and the velocity of the origin. */
typedef struct { NAME_real rate, rotation; NAME_complex velocity; } NAME_leaning_lift;

/* A leg demands that a point of the body is at a distance from a point of the base. */
typedef struct { NAME_complex point, centre; NAME_real radius; } NAME_circle;

/* A leg demands that a point of the body is on a line of the base: its normal, and its distance along that. */
typedef struct { NAME_complex point, normal; NAME_real offset; } NAME_line;

/* A leg demands that a point of the base is on a line of the body. */
typedef struct { NAME_complex point, normal; NAME_real offset; } NAME_carried_line;

/* A leg demands a rotation. */
typedef struct { NAME_complex rotation; } NAME_heading;

/* A leg demands an angle, by its cosine, between a direction of the base and one of the body. */
typedef struct { NAME_vector fixed, carried; NAME_real cosine; } NAME_cone;

/* A leg demands a linear equation of the displacement. */
typedef struct { NAME_vector normal; NAME_real value; } NAME_flat;

/* The frame of a section: its origin, and its directions, in base coordinates. */
typedef struct { NAME_vector origin; NAME_rotation axes; } NAME_frame;
