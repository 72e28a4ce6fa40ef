int NAME_forward(const NAME_geometry *g, const NAME_real actuated[], unsigned mode, NAME_real pose[], NAME_real *residual)
{
    real values[NAME_ACTUATED], off[NAME_ACTUATED], next[NAME_COORDINATES], a[ROWS * WIDTH], step[UNKNOWNS];
    STATE
    int j, iteration, closer = 1;
    int status = NAME_numbers(actuated, NAME_ACTUATED);
    *residual = (real)INFINITY;
    RETURN
    status = NAME_actuated(g, pose, mode, values);
    RETURN
    START
    *residual = NAME_off(g, actuated, values, off);
    for (iteration = 0; iteration < 50 && closer && *residual > NAME_REACH; ++iteration) {
        real longest = 0, share;
        int halvings;
        status = NAME_linearise(g, pose, mode, off, QUERIED a);
        RETURN
        if (NAME_eliminate(a, ROWS, UNKNOWNS, 1, step)) {
            return 2 * NAME_LEGS + 1;
        }
        for (j = 0; j < UNKNOWNS; ++j) {
            longest = NAME_max(longest, NAME_abs(step[j]));
        }
        /* Half of the step, until it leads closer. A long one leads astray. */
        share = (real)0.5 / NAME_max(longest, (real)0.5);
        closer = 0;
        for (halvings = 0; halvings < 30 && !closer; ++halvings) {
            STEP
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
