int NAME_forward(const NAME_geometry *g, const NAME_real actuated[], unsigned mode, NAME_real pose[], NAME_real *residual)
{
    DRIVEN
    UNITS
    const int width = NAME_COORDINATES + 1;
    real values[NAME_ACTUATED], off[NAME_ACTUATED], next[NAME_COORDINATES], step[NAME_COORDINATES];
    real jacobian[NAME_JOINTS * NAME_COORDINATES], a[NAME_ACTUATED * (NAME_COORDINATES + 1)];
    int i, j, iteration, closer = 1;
    int status = NAME_numbers(actuated, NAME_ACTUATED);
    *residual = (real)INFINITY;
    RETURN
    status = NAME_actuated(g, pose, mode, values);
    RETURN
    *residual = NAME_off(g, actuated, values, off);
    for (iteration = 0; iteration < 50 && closer && *residual > NAME_REACH; ++iteration) {
        real share = 1;
        int halvings;
        status = NAME_jacobian(g, pose, mode, jacobian);
        RETURN
        for (i = 0; i < NAME_ACTUATED; ++i) {
            const real size = g->joint[driven[i]].size;
            for (j = 0; j < NAME_COORDINATES; ++j) {
                a[i * width + j] = jacobian[driven[i] * NAME_COORDINATES + j] * unit[j] / size;
            }
            a[i * width + NAME_COORDINATES] = off[i] / size;
        }
        if (NAME_eliminate(a, NAME_ACTUATED, NAME_COORDINATES, 1, step)) {
            return 2 * NAME_LEGS + 1;
        }
        /* Half of the step, until it leads closer. */
        closer = 0;
        for (halvings = 0; halvings < 30 && !closer; ++halvings) {
            for (j = 0; j < NAME_COORDINATES; ++j) {
                next[j] = pose[j] + share * unit[j] * step[j];
            }
            if (NAME_actuated(g, next, mode, values) == 0) {
                const real distance = NAME_off(g, actuated, values, off);
                if (distance < *residual) {
                    closer = 1;
                    *residual = distance;
                    for (j = 0; j < NAME_COORDINATES; ++j) {
                        pose[j] = next[j];
                    }
                }
            }
            share /= 2;
        }
    }
    /* Rounding of the joints may be more than that of a chain's reach. */
    return *residual <= 100 * NAME_REACH ? 0 : 2 * NAME_LEGS + 2;
}
