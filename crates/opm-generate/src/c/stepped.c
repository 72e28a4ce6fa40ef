/* The pose that a share of a step leads to: the orientation is rotated, and its angles are those nearest to the start's. */
static void NAME_stepped(const NAME_geometry *g, const real pose[], const real start[], const real step[], real share,
                         real next[])
{
    UNITS
    int j;
    for (j = 0; j < UNKNOWNS; ++j) {
        next[j] = pose[j] + share * unit[j] * step[j];
    }
    {
        const NAME_rotation turned = NAME_rotation_by(NAME_vector_of(STEPS));
        const NAME_rotation moved = NAME_product(turned, NAME_euler(EULER));
        const NAME_vector angles = NAME_NEAREST(moved, NAME_vector_of(NEAR));
        FOUND
    }
}
