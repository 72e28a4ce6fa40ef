/* The pose that a share of a step leads to: the orientation is rotated. Of its two triples of angles, it is that with which
   the coordinates that follow lead to this orientation. It returns 1 where none does. */
static int NAME_stepped(const NAME_geometry *g, const real q[], const real start[], const real step[], real share,
                        unsigned mode, real next[])
{
    const int given[NAME_COORDINATES] = { GIVEN };
    UNITS
    real moved[UNKNOWNS], completed[UNKNOWNS], tried[NAME_COORDINATES], unmet[2] = { 0, 0 }, least = (real)INFINITY;
    int j, chart;
    const NAME_rotation turned = NAME_rotation_by(NAME_vector_of(STEPS));
    const NAME_rotation rotation = NAME_product(turned, NAME_euler(EULER));
    for (j = 0; j < UNKNOWNS; ++j) {
        moved[j] = q[j] + share * unit[j] * step[j];
    }
    for (chart = 0; chart < 2; ++chart) {
        const NAME_vector angles = NAME_CHART(rotation, NAME_vector_of(NEAR), chart);
        FOUND
        for (j = 0; j < NAME_COORDINATES; ++j) {
            tried[j] = moved[given[j]];
        }
        if (NAME_complete(g, tried, mode, completed, unmet) == 0) {
            const real off = NAME_apart(rotation, NAME_euler(COMPLETED));
            if (off < least) {
                least = off;
                for (j = 0; j < NAME_COORDINATES; ++j) {
                    next[j] = tried[j];
                }
            }
        }
    }
    return !(least < (real)INFINITY);
}
