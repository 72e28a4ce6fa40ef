/* The determinant of a matrix, which is changed. */
static real determinant(real b[], int count)
{
    real product = 1;
    int i, j, k;
    for (k = 0; k < count; ++k) {
        int row = k;
        for (i = k + 1; i < count; ++i) {
            row = NAME_abs(b[i * count + k]) > NAME_abs(b[row * count + k]) ? i : row;
        }
        if (b[row * count + k] == 0) {
            return 0;
        }
        product *= row == k ? b[k * count + k] : -b[row * count + k];
        for (j = 0; j < count; ++j) {
            const real swapped = b[row * count + j];
            b[row * count + j] = b[k * count + j];
            b[k * count + j] = swapped;
        }
        for (i = k + 1; i < count; ++i) {
            const real factor = b[i * count + k] / b[k * count + k];
            for (j = k; j < count; ++j) {
                b[i * count + j] -= factor * b[k * count + j];
            }
        }
    }
    return product;
}

/* The sign of a determinant; 0 where it vanishes. */
static int sign_of(real b[], int count)
{
    const real value = determinant(b, count);
    return value > NAME_VANISHED ? 1 : value < -NAME_VANISHED ? -1 : 0;
}

