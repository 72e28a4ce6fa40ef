static int NAME_linearise(const NAME_geometry *g, const real pose[], unsigned mode, const real right[], QUERY real a[])
{
    DRIVEN
    UNITS
    real rates[NAME_JOINTS * UNKNOWNS];
    LOCKED
    int i, j;
    const int status = RATES;
    RETURN
    for (i = 0; i < NAME_ACTUATED; ++i) {
        const real size = g->joint[driven[i]].size;
        for (j = 0; j < UNKNOWNS; ++j) {
            a[i * WIDTH + j] = rates[driven[i] * UNKNOWNS + j] * unit[j] / size;
        }
        a[i * WIDTH + UNKNOWNS] = right[i] / size;
    }
    HELD
    return 0;
}
