/* halcompile --install NAME_linuxcnc.c builds it and installs it, with FILE_NAME.c and FILE_NAME.h beside it. The coordinates of the
   pose are axes: COORDINATE_NAMES. The joints are, in their order: JOINT_NAMES. Lengths are millimetres and angles degrees.

   Home is the pose at home in the working mode. The module keeps to its assembly: to the mode, and to the signs of the
   determinants that are zero where held joints let the platform move. It gives -1 rather than another assembly. Joints are
   those nearest to the last ones, so that they go on past half a revolution. */

#include "kinematics.h"
#include "hal.h"
#include "rtapi.h"
#include "rtapi_app.h"

#include "FILE_NAME.c"

/* The machine's units in a metre and in a radian. */
#define NAME_LENGTH 1000.0
#define NAME_ANGLE 57.29577951308232

CONSTANTS

/* Joints that are farther away from those of a known pose than this are approached in steps, radians or sizes. */
#define NAME_STRIDE ((real)0.1)

/* The most steps. */
#define NAME_STRIDES 40

SIGNS

static int comp_id;

/* The working mode: bit i is set where sign i of opm's text is a minus. */
static int mode = HOME_MODE;
RTAPI_MP_INT(mode, "the working mode");

static const double unit[NAME_ACTUATED] = { UNITS };

/* The numbers of the actuated joints. */
static const int driven[NAME_ACTUATED] = { ACTUATED_JOINTS };

/* Which joints are angles that full revolutions do not change. */
static const int angle[NAME_JOINTS] = { ANGLES };

/* A pose, and all joints there. */
typedef struct { NAME_real pose[NAME_COORDINATES], joints[NAME_JOINTS]; } NAME_place;

/* Home; where the joints were last; where they were last sent. */
static NAME_place home, reached, sent;

/* The last joints of both. */
static NAME_real last[NAME_JOINTS];

/* The signs of the determinants at home; 0 where it is singular there, and anywhere else is right. */
static int signs[SIGN_COUNT];

static int started = 0;

static void from_world(const struct EmcPose *world, NAME_real pose[])
{
    FROM_WORLD
}

static void remember(const NAME_place *place)
{
    int i;
    for (i = 0; i < NAME_JOINTS; ++i) {
        last[i] = place->joints[i];
    }
}

/* Whether a pose is in home's assembly. */
static int is_home_assembly(const NAME_real pose[])
{
    int found[SIGN_COUNT] = { 0 }, i, right = NAME_signs(&NAME_default, pose, (unsigned)mode, found) == 0;
    for (i = 0; i < SIGN_COUNT; ++i) {
        right = right && (signs[i] == 0 || found[i] == signs[i]);
    }
    return right;
}

/* All joints at a pose, those nearest to the previous ones. It returns what NAME_inverse returns. */
static int joints_near(const NAME_real pose[], const NAME_real previous[], NAME_real joints[])
{
    NAME_real imaginary[NAME_IMAGINARY + 1];
    unsigned nearest = 0;
    int i, status = NAME_nearest(&NAME_default, pose, previous, &nearest, joints, imaginary);
    if (status == 0 && nearest == (unsigned)mode) {
        return 0;
    }
    /* Where two modes meet, another one may be nearer. */
    status = NAME_inverse(&NAME_default, pose, (unsigned)mode, joints, imaginary);
    for (i = 0; i < NAME_JOINTS && status == 0; ++i) {
        if (angle[i]) {
            joints[i] = NAME_near(joints[i], previous[i]);
        }
    }
    return status;
}

/* Home, and its signs. It returns 0 where the mode reaches the home pose. */
static int start(void)
{
    NAME_real imaginary[NAME_IMAGINARY + 1];
    int i, status;
    for (i = 0; i < SIGN_COUNT; ++i) {
        signs[i] = 0;
    }
    HOME_POSE
    status = NAME_inverse(&NAME_default, home.pose, (unsigned)mode, home.joints, imaginary);
    if (status == 0) {
        (void)NAME_signs(&NAME_default, home.pose, (unsigned)mode, signs);
        reached = sent = home;
        remember(&home);
        started = 1;
    }
    return status;
}

/* How far actuated joints are from those of a place, radians or sizes. Revolutions count: so do the angles of the pose. */
static real away(const NAME_place *place, const NAME_real actuated[])
{
    real most = 0;
    int i;
    for (i = 0; i < NAME_ACTUATED; ++i) {
        const real off = actuated[i] - place->joints[driven[i]];
        most = NAME_max(most, NAME_abs(off) / NAME_default.joint[driven[i]].size);
    }
    return most;
}

/* The pose of actuated joints in home's assembly, from a place, in as many steps as needed, up to a number. It returns 0 if
   there is one. */
static int approach(const NAME_place *from, const NAME_real actuated[], int most, NAME_real pose[])
{
    NAME_real way[NAME_ACTUATED], between[NAME_ACTUATED], residual;
    int i, stride, strides = 1;
    for (i = 0; i < NAME_COORDINATES; ++i) {
        pose[i] = from->pose[i];
    }
    for (i = 0; i < NAME_ACTUATED; ++i) {
        const real off = actuated[i] - from->joints[driven[i]];
        real needed;
        way[i] = angle[driven[i]] ? NAME_near(off, 0) : off;
        needed = 1 + NAME_abs(way[i]) / NAME_default.joint[driven[i]].size / NAME_STRIDE;
        if (needed > (real)strides) {
            strides = needed < (real)most ? (int)needed : most;
        }
    }
    for (stride = 1; stride <= strides; ++stride) {
        for (i = 0; i < NAME_ACTUATED; ++i) {
            between[i] = actuated[i] - way[i] * (real)(strides - stride) / (real)strides;
        }
        if (NAME_forward(&NAME_default, between, (unsigned)mode, pose, &residual) != 0 || !is_home_assembly(pose)) {
            return -1;
        }
    }
    return 0;
}

int kinematicsInverse(const struct EmcPose *world, double *joint, const KINEMATICS_INVERSE_FLAGS *iflags,
                      KINEMATICS_FORWARD_FLAGS *fflags)
{
    NAME_place to;
    int i;
    (void)iflags;
    (void)fflags;
    if (!started && start() != 0) {
        return -1;
    }
    from_world(world, to.pose);
    if (joints_near(to.pose, last, to.joints) != 0 || !is_home_assembly(to.pose)) {
        return -1;
    }
    for (i = 0; i < NAME_ACTUATED; ++i) {
        joint[i] = (double)to.joints[driven[i]] * unit[i];
    }
    sent = to;
    remember(&to);
    return 0;
}

/* From that of the known poses whose joints are nearest; what is in world does not matter. */
int kinematicsForward(const double *joint, struct EmcPose *world, const KINEMATICS_FORWARD_FLAGS *fflags,
                      KINEMATICS_INVERSE_FLAGS *iflags)
{
    const NAME_place *from[3];
    NAME_place at;
    NAME_real actuated[NAME_ACTUATED], previous[NAME_JOINTS];
    int i, j, status = -1;
    (void)fflags;
    (void)iflags;
    if (!started && start() != 0) {
        return -1;
    }
    for (i = 0; i < NAME_ACTUATED; ++i) {
        actuated[i] = (NAME_real)(joint[i] / unit[i]);
        if (actuated[i] - actuated[i] != 0) {
            return -1;
        }
    }
    from[0] = &sent;
    from[1] = &reached;
    from[2] = &home;
    for (i = 0; i < 3; ++i) {
        for (j = i + 1; j < 3; ++j) {
            if (away(from[j], actuated) < away(from[i], actuated)) {
                const NAME_place *nearer = from[j];
                from[j] = from[i];
                from[i] = nearer;
            }
        }
    }
    for (i = 0; i < 3 && status != 0; ++i) {
        status = approach(from[i], actuated, NAME_STRIDES, at.pose);
        if (status != 0) {
            status = approach(from[i], actuated, 1, at.pose);
        }
    }
    if (status != 0) {
        return -1;
    }
    for (i = 0; i < NAME_JOINTS; ++i) {
        previous[i] = last[i];
    }
    for (i = 0; i < NAME_ACTUATED; ++i) {
        previous[driven[i]] = actuated[i];
    }
    if (joints_near(at.pose, previous, at.joints) != 0) {
        return -1;
    }
    reached = at;
    remember(&at);
    TO_WORLD
    return 0;
}

KINEMATICS_TYPE kinematicsType(void)
{
    return KINEMATICS_BOTH;
}

KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
MODULE_LICENSE("GPL");

int rtapi_app_main(void)
{
    if (start() != 0) {
        rtapi_print_msg(RTAPI_MSG_ERR, "NAME_linuxcnc: the home pose is out of reach in mode %d\n", mode);
        return -1;
    }
    comp_id = hal_init("NAME_linuxcnc");
    if (comp_id < 0) {
        return comp_id;
    }
    hal_ready(comp_id);
    return 0;
}

void rtapi_app_exit(void)
{
    hal_exit(comp_id);
}
