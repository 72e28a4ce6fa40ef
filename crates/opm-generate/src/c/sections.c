/* The rates of imaginary joints by what moves the platform, a row for each, from poses beside this one. It returns 0 if these
   are in reach. */
static int imaginary_rates(const NAME_real pose[], real rates[])
{
    const int numbers[TAUS] = { NUMBERS }, turns[TAUS] = { TURNS };
    const real beside = (real)(sizeof(real) == sizeof(float) ? 1e-3 : 1e-6);
    NAME_real joints[NAME_JOINTS], here[NAME_IMAGINARY], there[NAME_IMAGINARY], next[NAME_COORDINATES];
    int i, j, found = NAME_inverse(&NAME_default, pose, (unsigned)mode, joints, here);
    for (j = 0; j < UNKNOWNS && found == 0; ++j) {
        real step[UNKNOWNS] = { 0 }, way = beside;
        step[j] = 1;
        STEPPED
        found = NAME_inverse(&NAME_default, next, (unsigned)mode, joints, there);
        if (found != 0) {
            way = -beside;
            STEPPED
            found = NAME_inverse(&NAME_default, next, (unsigned)mode, joints, there);
        }
        for (i = 0; i < TAUS && found == 0; ++i) {
            const real off = there[numbers[i]] - here[numbers[i]];
            rates[i * UNKNOWNS + j] = (turns[i] ? NAME_near(off, 0) : off / NAME_default.size) / way;
        }
    }
    return found;
}

/* The signs of the determinants of both sections, whose joints are the actuated ones and the imaginary ones: those that follow
   from the upper section move the lower one. */
static int signs_of_sections(const real a[], const NAME_real pose[], int found[])
{
    const int lower[LOWER] = { LOWER_ROWS }, moved[LOWER] = { MOVED }, upper[UPPER_COUNT] = { UPPER_ROWS };
    real taus[TAUS * UNKNOWNS], of_lower[LOWER * LOWER], of_upper[UPPER * UPPER];
    int i, j, k;
    const int status = imaginary_rates(pose, taus);
    if (status != 0) {
        return status;
    }
    for (i = 0; i < LOWER; ++i) {
        for (k = 0; k < TAUS; ++k) {
            real along = 0, square = 0;
            for (j = BELOW; j < UNKNOWNS; ++j) {
                along += a[lower[i] * WIDTH + j] * taus[k * UNKNOWNS + j];
                square += taus[k * UNKNOWNS + j] * taus[k * UNKNOWNS + j];
            }
            of_lower[i * LOWER + BELOW + k] = moved[i] == k && square > 0 ? along / square : 0;
        }
        for (j = 0; j < BELOW; ++j) {
            of_lower[i * LOWER + j] = a[lower[i] * WIDTH + j];
        }
    }
    for (i = 0; i < UPPER; ++i) {
        for (j = 0; j < UPPER; ++j) {
            of_upper[i * UPPER + j] = i < TAUS ? taus[i * UNKNOWNS + BELOW + j] : a[upper[i - TAUS] * WIDTH + BELOW + j];
        }
    }
    found[0] = sign_of(of_lower, LOWER);
    found[1] = sign_of(of_upper, UPPER);
    return 0;
}

