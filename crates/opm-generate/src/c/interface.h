#ifdef __cplusplus
extern "C" {
#endif

/* The mechanism as it was when this code was written. */
extern const NAME_geometry NAME_default;

/* Every joint at a pose in a working mode. Bit i of the mode, the lowest first, is set where sign i of opm's text is a minus.
   MODE
   Angles are within half a revolution of home, or within their limits where full revolutions bring them there; limits are
   not tested. It returns 0; or the number of the first leg, from 1, that the pose is out of reach of; or -i where coordinate
   i of the pose, from 1, is no number or far too large. Unless it returns 0, nothing is written. */
int NAME_inverse(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real joints[],
                 NAME_real imaginary[]);

/* The actuated joints alone, in the same way. */
int NAME_actuated(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real actuated[]);

/* Every joint at a pose in that mode in which the joints move least from previous ones (the sum of the squares, lengths
   over the size of the mechanism), angles with the revolutions nearest to the previous ones. It writes the mode, too. Unless
   it returns 0, joints, imaginary and mode have no meaning. */
int NAME_nearest(const NAME_geometry *geometry, const NAME_real pose[], const NAME_real previous[], unsigned *mode,
                 NAME_real joints[], NAME_real imaginary[]);

/* By how much the pose is out of reach: of leg i, from 0, deficits[2 * i] of the lower section and deficits[2 * i + 1] of the
   upper one, in metres, or radians where the section is spherical; zero where it closes, infinite where it is not known. A
   section that follows another one out of reach counts as closed. It returns what NAME_inverse returns. */
int NAME_deficits(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real deficits[2 * NAME_LEGS]);

/* 0 where all joints are within their limits; otherwise the number of the first one, from 1, that is not. */
int NAME_limits(const NAME_geometry *geometry, const NAME_real joints[]);

/* The position of the platform's reference point and the platform's orientation in base coordinates: a rotation matrix, row by
   row. They depend on the mode only where coordinates follow from those of the pose. It returns what NAME_inverse returns,
   but tests no leg. */
int NAME_transform(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, NAME_real position[3],
                   NAME_real rotation[9]);

/* The rates of all joints for unit rates of the coordinates of the pose: entry i * NAME_COORDINATES + j is that of joint i by
   coordinate j, rad/s and m/s. It returns what NAME_inverse returns; or NAME_LEGS + i where leg i, from 1, is singular; or
   2 * NAME_LEGS + 1 where coordinates that follow from those of the pose have no rates. */
int NAME_jacobian(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode,
                  NAME_real jacobian[NAME_JOINTS * NAME_COORDINATES]);

/* The platform's twist for unit rates of the coordinates of the pose: the rows of the angular velocity x, y, z and of the
   velocity of the reference point x, y, z, base coordinates. It returns what NAME_transform returns; what NAME_jacobian
   returns, where coordinates follow from those of the pose. */
int NAME_twist(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode,
               NAME_real twist[6 * NAME_COORDINATES]);

/* The rates of all joints for given rates of the coordinates of the pose. It returns what NAME_jacobian returns; or
   -NAME_COORDINATES - i where rate i, from 1, is no number. */
int NAME_rates(const NAME_geometry *geometry, const NAME_real pose[], unsigned mode, const NAME_real rates[],
               NAME_real joint_rates[]);
FORWARD

#ifdef __cplusplus
}
#endif
