/* The determinant of a part of the equations of a step. */
static real determinant(const real a[], const int rows[], const int columns[], int count)
{
    real b[MOST * MOST], product = 1;
    int i, j, k;
    for (i = 0; i < count; ++i) {
        for (j = 0; j < count; ++j) {
            b[i * count + j] = a[rows[i] * WIDTH + columns[j]];
        }
    }
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

