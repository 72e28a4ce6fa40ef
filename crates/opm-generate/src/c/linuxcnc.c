/* halcompile --install NAME_linuxcnc.c builds it and installs it, with NAME.c and NAME.h beside it. The coordinates of the
   pose are axes: COORDINATE_NAMES. Lengths are millimetres and angles degrees, of joints, too. */

#include "kinematics.h"
#include "hal.h"
#include "rtapi.h"
#include "rtapi_app.h"

#include "NAME.c"

/* The machine's units in a metre and in a radian. */
#define NAME_LENGTH 1000.0
#define NAME_ANGLE 57.29577951308232

static int comp_id;

/* The working mode: bit i is set where sign i of opm's text is a minus. */
static int mode = HOME_MODE;
RTAPI_MP_INT(mode, "the working mode");

static const double unit[NAME_ACTUATED] = { UNITS };

static void from_world(const struct EmcPose *world, NAME_real pose[])
{
    FROM_WORLD
}

int kinematicsInverse(const struct EmcPose *world, double *joint, const KINEMATICS_INVERSE_FLAGS *iflags,
                      KINEMATICS_FORWARD_FLAGS *fflags)
{
    NAME_real pose[NAME_COORDINATES], actuated[NAME_ACTUATED];
    int i;
    (void)iflags;
    (void)fflags;
    from_world(world, pose);
    if (NAME_actuated(&NAME_default, pose, (unsigned)mode, actuated) != 0) {
        return -1;
    }
    for (i = 0; i < NAME_ACTUATED; ++i) {
        joint[i] = (double)actuated[i] * unit[i];
    }
    return 0;
}

/* From the pose in world; from home, where that does not lead to one. */
int kinematicsForward(const double *joint, struct EmcPose *world, const KINEMATICS_FORWARD_FLAGS *fflags,
                      KINEMATICS_INVERSE_FLAGS *iflags)
{
    NAME_real pose[NAME_COORDINATES], actuated[NAME_ACTUATED], residual;
    int i, status;
    (void)fflags;
    (void)iflags;
    for (i = 0; i < NAME_ACTUATED; ++i) {
        actuated[i] = (NAME_real)(joint[i] / unit[i]);
    }
    from_world(world, pose);
    status = NAME_forward(&NAME_default, actuated, (unsigned)mode, pose, &residual);
    if (status != 0) {
        HOME_POSE
        status = NAME_forward(&NAME_default, actuated, (unsigned)mode, pose, &residual);
    }
    if (status == 0) {
        TO_WORLD
    }
    return status == 0 ? 0 : -1;
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
