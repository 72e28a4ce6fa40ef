/* A function of math.h, with its suffix f where real is float. */
#define NAME_MATH(name, x) (sizeof(real) == sizeof(float) ? (real)name##f((float)(x)) : (real)name((double)(x)))

static inline real NAME_abs(real x)
{
    return x < 0 ? -x : x;
}

static inline real NAME_max(real a, real b)
{
    return a > b ? a : b;
}

static inline real NAME_min(real a, real b)
{
    return a < b ? a : b;
}

static inline real NAME_sqrt(real x)
{
    return NAME_MATH(sqrt, x);
}

static inline real NAME_sin(real x)
{
    return NAME_MATH(sin, x);
}

static inline real NAME_cos(real x)
{
    return NAME_MATH(cos, x);
}

static inline real NAME_asin(real x)
{
    return NAME_MATH(asin, x);
}

static inline real NAME_acos(real x)
{
    return NAME_MATH(acos, x);
}

static inline real NAME_round(real x)
{
    return NAME_MATH(round, x);
}

static inline real NAME_ceil(real x)
{
    return NAME_MATH(ceil, x);
}

/* Calls of the shortest functions, and of those whose arguments are large, are left out unless the code is to be small. */
#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define NAME_INLINE inline __attribute__((always_inline))
#else
#define NAME_INLINE inline
#endif

/* One half with the sign of x. */
static NAME_INLINE real NAME_half(real x)
{
    return sizeof(real) == sizeof(float) ? (real)copysignf(0.5f, (float)x) : (real)copysign(0.5, (double)x);
}

/* The angle of the vector (x, y), right to three units in the last place: (atan t - t) / t^3 in powers of t^2, minimax for
   t <= tan(22.5 degrees), from the nearest multiple of 45 degrees, the angle of the vector (c, s) there. It compares nothing,
   so that compilers compute several at once; a term keeps the quotient of zeros zero. */
static NAME_INLINE real NAME_arctangent(real y, real x)
{
    const real width = NAME_MATH(fabs, x), height = NAME_MATH(fabs, y);
    const real flat = NAME_half(width - (real)0.41421356237309503 * height);
    const real steep = NAME_half((real)0.41421356237309503 * width - height);
    const real c = (real)0.5 + flat, s = (real)0.5 - steep;
    const real t = (height * c - width * s) / (width * c + height * s + (real)1e-300), z = t * t, w = z * z;
    const real even = (real)-0.3333333333333015 + w * ((real)-0.14285714195262272 + w * ((real)-0.09090782413615411
                    + w * ((real)-0.06641121339142571 + w * (real)-0.04359097351751042)));
    const real odd = (real)0.19999999999088966 + w * ((real)0.11111106653632544 + w * ((real)0.07690068317447613
                   + w * ((real)0.05692539746771612 + w * (real)0.02125986883375036)));
    const real quarter = (NAME_PI / 4) * (1 - flat - steep) + (t + t * (z * (even + z * odd)));
    const real side = NAME_half(x);
    return (NAME_PI - NAME_TAU * side + 4 * side * quarter) * NAME_half(y);
}

static NAME_INLINE real NAME_atan2(real y, real x)
{
    return sizeof(real) == sizeof(float) ? (real)atan2f((float)y, (float)x) : NAME_arctangent(y, x);
}
