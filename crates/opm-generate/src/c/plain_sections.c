/* The signs of the determinants of both sections: of their actuated joints. */
static int signs_of_sections(const real a[], const NAME_real pose[], int found[])
{
    const int lower[LOWER] = { LOWER_ROWS }, upper[UPPER] = { UPPER_ROWS };
    real of_lower[LOWER * LOWER], of_upper[UPPER * UPPER];
    int i, j;
    (void)pose;
    for (i = 0; i < LOWER; ++i) {
        for (j = 0; j < LOWER; ++j) {
            of_lower[i * LOWER + j] = a[lower[i] * WIDTH + j];
        }
    }
    for (i = 0; i < UPPER; ++i) {
        for (j = 0; j < UPPER; ++j) {
            of_upper[i * UPPER + j] = a[upper[i] * WIDTH + BELOW + j];
        }
    }
    found[0] = sign_of(of_lower, LOWER);
    found[1] = sign_of(of_upper, UPPER);
    return 0;
}

