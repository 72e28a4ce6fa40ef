/* How far beyond its reach a chain still closes, as a share of its size: rounding must not decide there. */
#define NAME_REACH ((real)(sizeof(real) == sizeof(float) ? 2e-6 : 1e-12))

/* A length or a sine below this share counts as zero. */
#define NAME_DEGENERATE ((real)(sizeof(real) == sizeof(float) ? 1e-6 : 1e-9))

/* A coefficient below this share counts as zero. */
#define NAME_VERGE ((real)(sizeof(real) == sizeof(float) ? 1e-6 : 1e-13))

/* A constraint that the platform obeys already is missed by less than this. */
#define NAME_OBEYED ((real)(sizeof(real) == sizeof(float) ? 1e-4 : 1e-9))

/* The largest coordinate of a pose: the fourth power of a larger one would overflow. */
#define NAME_LARGEST (sizeof(real) == sizeof(float) ? 1e9 : 1e75)

/* The square of the cosine of the angle from which on two axes count as well apart. */
#define NAME_BESIDE ((real)0.99)

#define NAME_PI ((real)3.14159265358979323846)

#define NAME_TAU ((real)6.28318530717958647693)

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

static inline real NAME_clamp(real x, real low, real high)
{
    return x < low ? low : x > high ? high : x;
}

/* The angle plus full revolutions, within half of one of the reference. */
static inline real NAME_near(real angle, real reference)
{
    const real revolutions = (angle - reference) / NAME_TAU;
    return NAME_abs(revolutions) <= (real)0.5 ? angle : angle - NAME_TAU * NAME_round(revolutions);
}

/* The deficit of a target out of reach: positive, and infinite where it is unknown. */
static inline real NAME_missed(real excess)
{
    return excess != excess ? (real)INFINITY : NAME_max(excess, (real)1e-37);
}

static inline NAME_complex NAME_complex_of(real re, real im)
{
    NAME_complex z;
    z.re = re;
    z.im = im;
    return z;
}

static inline NAME_complex NAME_plus(NAME_complex a, NAME_complex b)
{
    return NAME_complex_of(a.re + b.re, a.im + b.im);
}

static inline NAME_complex NAME_minus(NAME_complex a, NAME_complex b)
{
    return NAME_complex_of(a.re - b.re, a.im - b.im);
}

static inline NAME_complex NAME_times(NAME_complex a, NAME_complex b)
{
    return NAME_complex_of(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}

static inline NAME_complex NAME_conjugate(NAME_complex z)
{
    return NAME_complex_of(z.re, -z.im);
}

static inline NAME_complex NAME_scaled(NAME_complex z, real s)
{
    return NAME_complex_of(z.re * s, z.im * s);
}

/* a . b */
static inline real NAME_inner(NAME_complex a, NAME_complex b)
{
    return a.re * b.re + a.im * b.im;
}

/* a x b */
static inline real NAME_across(NAME_complex a, NAME_complex b)
{
    return a.re * b.im - a.im * b.re;
}

/* The unit vector in the direction of an angle. */
static inline NAME_complex NAME_unit(real angle)
{
    return NAME_complex_of(NAME_cos(angle), NAME_sin(angle));
}

/* The unit vector in the direction of z; that of the angle zero where z is zero. */
static inline NAME_complex NAME_normal(NAME_complex z)
{
    const real square = NAME_inner(z, z);
    return square > 0 ? NAME_scaled(z, 1 / NAME_sqrt(square)) : NAME_complex_of(1, 0);
}

/* z as a direction; where it is zero compared to size, so that its angle is free, that of the angle zero. */
static inline NAME_complex NAME_direction(NAME_complex z, real size)
{
    const real shortest = NAME_REACH * NAME_REACH * size;
    return NAME_inner(z, z) > shortest * shortest ? z : NAME_complex_of(1, 0);
}

/* The angle of a direction, within half a revolution of zero. */
static real NAME_angle(NAME_complex z)
{
    return NAME_atan2(z.im, z.re);
}

/* A rotation as the angle of a pivot, by its sense. */
static inline NAME_complex NAME_turn(NAME_complex rotation, real sense)
{
    return NAME_complex_of(rotation.re, rotation.im * sense);
}

/* The coordinates of z = m u + n v; m is computed from the rounded n, so that the sum is z. */
static inline void NAME_along(NAME_complex u, NAME_complex v, NAME_complex z, real *m, real *n)
{
    *n = NAME_across(u, z) / NAME_across(u, v);
    *m = NAME_inner(NAME_minus(z, NAME_scaled(v, *n)), u);
}

static inline NAME_vector NAME_vector_of(real x, real y, real z)
{
    NAME_vector v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

static inline real NAME_dot(NAME_vector a, NAME_vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline NAME_vector NAME_cross(NAME_vector a, NAME_vector b)
{
    return NAME_vector_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* a + s b */
static inline NAME_vector NAME_add(NAME_vector a, real s, NAME_vector b)
{
    return NAME_vector_of(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/* R v */
static inline NAME_vector NAME_rotated(NAME_rotation r, NAME_vector v)
{
    return NAME_vector_of(r.x.x * v.x + r.y.x * v.y + r.z.x * v.z, r.x.y * v.x + r.y.y * v.y + r.z.y * v.z,
                          r.x.z * v.x + r.y.z * v.y + r.z.z * v.z);
}

/* R S */
static inline NAME_rotation NAME_product(NAME_rotation r, NAME_rotation s)
{
    NAME_rotation p;
    p.x = NAME_rotated(r, s.x);
    p.y = NAME_rotated(r, s.y);
    p.z = NAME_rotated(r, s.z);
    return p;
}

static inline NAME_rotation NAME_transposed(NAME_rotation r)
{
    NAME_rotation t;
    t.x = NAME_vector_of(r.x.x, r.y.x, r.z.x);
    t.y = NAME_vector_of(r.x.y, r.y.y, r.z.y);
    t.z = NAME_vector_of(r.x.z, r.y.z, r.z.z);
    return t;
}

/* exp(a q) v, with the angle q as a unit vector */
static inline NAME_vector NAME_rotated_about(NAME_vector a, NAME_complex q, NAME_vector v)
{
    const NAME_vector across = NAME_cross(a, v);
    const real along = NAME_dot(a, v) * (1 - q.re);
    return NAME_vector_of(v.x * q.re + across.x * q.im + a.x * along, v.y * q.re + across.y * q.im + a.y * along,
                          v.z * q.re + across.z * q.im + a.z * along);
}

/* The rotation exp(a q), with the angle q as a unit vector. */
static inline NAME_rotation NAME_rotation_about(NAME_vector a, NAME_complex q)
{
    NAME_rotation r;
    r.x = NAME_rotated_about(a, q, NAME_vector_of(1, 0, 0));
    r.y = NAME_rotated_about(a, q, NAME_vector_of(0, 1, 0));
    r.z = NAME_rotated_about(a, q, NAME_vector_of(0, 0, 1));
    return r;
}

/* Rz(zeta) Ry(xi) Rz(psi) */
static inline NAME_rotation NAME_euler(real zeta, real xi, real psi)
{
    const NAME_complex z = NAME_unit(zeta), x = NAME_unit(xi), p = NAME_unit(psi);
    NAME_rotation r;
    r.x = NAME_vector_of(z.re * x.re * p.re - z.im * p.im, z.im * x.re * p.re + z.re * p.im, -x.im * p.re);
    r.y = NAME_vector_of(-z.re * x.re * p.im - z.im * p.re, -z.im * x.re * p.im + z.re * p.re, x.im * p.im);
    r.z = NAME_vector_of(z.re * x.im, z.im * x.im, x.re);
    return r;
}

/* Rx(mu) Ry(nu) */
static inline NAME_rotation NAME_tilt(real mu, real nu)
{
    const NAME_complex m = NAME_unit(mu), n = NAME_unit(nu);
    NAME_rotation r;
    r.x = NAME_vector_of(n.re, m.im * n.im, -m.re * n.im);
    r.y = NAME_vector_of(0, m.re, m.im);
    r.z = NAME_vector_of(n.im, -m.im * n.re, m.re * n.re);
    return r;
}

/* R exp(I tau), I a rotation about the third direction: the first two columns rotate. */
static inline NAME_rotation NAME_spherical_after(NAME_rotation r, NAME_complex tau)
{
    const NAME_complex e = NAME_normal(tau);
    NAME_rotation p;
    p.x = NAME_vector_of(r.x.x * e.re + r.y.x * e.im, r.x.y * e.re + r.y.y * e.im, r.x.z * e.re + r.y.z * e.im);
    p.y = NAME_vector_of(r.y.x * e.re - r.x.x * e.im, r.y.y * e.re - r.x.y * e.im, r.y.z * e.re - r.x.z * e.im);
    p.z = r.z;
    return p;
}

/* exp(I tau) R, I a rotation about the third direction: the first two rows rotate. */
static inline NAME_rotation NAME_spherical_before(NAME_rotation r, NAME_complex tau)
{
    const NAME_complex e = NAME_normal(tau);
    NAME_rotation p;
    p.x = NAME_vector_of(r.x.x * e.re - r.x.y * e.im, r.x.x * e.im + r.x.y * e.re, r.x.z);
    p.y = NAME_vector_of(r.y.x * e.re - r.y.y * e.im, r.y.x * e.im + r.y.y * e.re, r.y.z);
    p.z = NAME_vector_of(r.z.x * e.re - r.z.y * e.im, r.z.x * e.im + r.z.y * e.re, r.z.z);
    return p;
}

/* A displacement of a plane: z goes to rotation z + translation. */
typedef struct { NAME_complex rotation, translation; } NAME_planar;

/* A displacement about and along an axis; the angle counts full revolutions. */
typedef struct { real angle, advance; } NAME_cylindrical;

static inline NAME_planar NAME_planar_of(NAME_complex rotation, NAME_complex translation)
{
    NAME_planar g;
    g.rotation = rotation;
    g.translation = translation;
    return g;
}

static inline NAME_cylindrical NAME_cylindrical_of(real angle, real advance)
{
    NAME_cylindrical g;
    g.angle = angle;
    g.advance = advance;
    return g;
}

/* g z */
static inline NAME_complex NAME_apply(NAME_planar g, NAME_complex z)
{
    return NAME_plus(NAME_times(g.rotation, z), g.translation);
}

/* g h */
static inline NAME_planar NAME_planar_product(NAME_planar g, NAME_planar h)
{
    return NAME_planar_of(NAME_times(g.rotation, h.rotation), NAME_apply(g, h.translation));
}

static inline NAME_planar NAME_planar_inverse(NAME_planar g)
{
    const NAME_complex back = NAME_conjugate(g.rotation);
    return NAME_planar_of(back, NAME_scaled(NAME_times(back, g.translation), -1));
}

/* v exp(I tau), I a rotation about the origin */
static inline NAME_planar NAME_planar_after(NAME_planar v, NAME_complex tau)
{
    return NAME_planar_of(NAME_times(v.rotation, NAME_normal(tau)), v.translation);
}

/* exp(I tau) b, I a rotation about the origin */
static inline NAME_planar NAME_planar_before(NAME_planar b, NAME_complex tau)
{
    const NAME_complex e = NAME_normal(tau);
    return NAME_planar_of(NAME_times(e, b.rotation), NAME_times(e, b.translation));
}

/* v exp(I tau), I a translation */
static inline NAME_planar NAME_planar_after_slide(NAME_planar v, NAME_complex along, real tau)
{
    const NAME_complex moved = NAME_scaled(NAME_times(v.rotation, along), tau);
    return NAME_planar_of(v.rotation, NAME_plus(v.translation, moved));
}

/* exp(I tau) b, I a translation */
static inline NAME_planar NAME_planar_before_slide(NAME_planar b, NAME_complex along, real tau)
{
    return NAME_planar_of(b.rotation, NAME_plus(b.translation, NAME_scaled(along, tau)));
}

/* sin x / x */
static inline real NAME_sinc(real x)
{
    return x == 0 ? 1 : NAME_sin(x) / x;
}

/* What a joint that carries the height does in the plane: the exponential of its screw. */
static inline NAME_planar NAME_leaned(const NAME_leaning_lift *lift, real rise)
{
    const real angle = lift->rotation * rise, half = NAME_sinc(angle / 2);
    const NAME_complex factor = NAME_complex_of(NAME_sinc(angle), angle / 2 * half * half);
    const NAME_complex moved = NAME_scaled(lift->velocity, rise);
    return NAME_planar_of(NAME_unit(angle), NAME_times(factor, moved));
}

/* A pivot, displaced. */
static inline NAME_pivot NAME_carried_pivot(NAME_planar g, NAME_pivot p)
{
    p.at = NAME_apply(g, p.at);
    return p;
}

/* Two links and a wrist (RRR), by the law of cosines. The sign is + where the second link is counter-clockwise from the
   first. Angles are given as directions here and below. */
static NAME_INLINE real NAME_solve_planar_rrr(const NAME_planar_rrr *c, NAME_planar g, real sign, NAME_complex *q1, NAME_complex *q2,
                                  NAME_complex *q3)
{
    const NAME_complex first = NAME_minus(c->p2.at, c->p1.at), second = NAME_minus(c->p3.at, c->p2.at);
    const real aa = NAME_inner(first, first), bb = NAME_inner(second, second), ab = NAME_sqrt(aa * bb);
    const NAME_complex reach = NAME_minus(NAME_apply(g, c->p3.at), c->p1.at);
    const real square = NAME_inner(reach, reach), cosine = (square - aa - bb) / (2 * ab);
    if (!(NAME_abs(cosine) <= 1 + NAME_REACH) || ab <= NAME_DEGENERATE * NAME_max(aa, bb)) {
        const real a = NAME_sqrt(aa), b = NAME_sqrt(bb), distance = NAME_sqrt(square);
        return NAME_missed(NAME_max(distance - (a + b), NAME_abs(a - b) - distance));
    }
    {
        const real bend = NAME_clamp(cosine, -1, 1);
        const NAME_complex elbow = NAME_complex_of(bend, sign * NAME_sqrt(1 - bend * bend));
        const NAME_complex straighten = NAME_scaled(NAME_times(first, NAME_conjugate(second)), 1 / ab);
        const NAME_complex r2 = NAME_times(elbow, straighten), bent = NAME_plus(first, NAME_times(r2, second));
        const NAME_complex r1 = NAME_direction(NAME_times(reach, NAME_conjugate(bent)), (aa + bb) / 2);
        const NAME_complex r3 = NAME_times(g.rotation, NAME_conjugate(NAME_times(r1, r2)));
        *q1 = NAME_turn(r1, c->p1.sense);
        *q2 = NAME_turn(r2, c->p2.sense);
        *q3 = NAME_turn(r3, c->p3.sense);
    }
    return 0;
}

/* A slider and a link (PRR). The sign is + where the slider is ahead of the link's outer pivot. */
static NAME_INLINE real NAME_solve_planar_prr(const NAME_planar_prr *c, NAME_planar g, real sign, real *q1, NAME_complex *q2,
                                  NAME_complex *q3)
{
    const NAME_complex link = NAME_minus(c->p3.at, c->p2.at), outer = NAME_apply(g, c->p3.at);
    const NAME_complex local = NAME_times(NAME_minus(outer, c->p2.at), NAME_conjugate(c->d1));
    const real bb = NAME_inner(link, link), square = bb - local.im * local.im;
    if (!(square >= -2 * NAME_REACH * bb) || bb <= 0) {
        return NAME_missed(NAME_abs(local.im) - NAME_sqrt(bb));
    }
    {
        const real slider = local.re + sign * NAME_sqrt(NAME_max(square, 0));
        const NAME_complex moved = NAME_minus(NAME_minus(outer, c->p2.at), NAME_scaled(c->d1, slider));
        const NAME_complex r2 = NAME_times(moved, NAME_conjugate(link));
        *q1 = slider;
        *q2 = NAME_turn(r2, c->p2.sense);
        *q3 = NAME_turn(NAME_times(g.rotation, NAME_conjugate(r2)), c->p3.sense);
    }
    return 0;
}

/* A link whose outer pivot carries a slider (RRP): a PRR in reverse order. */
static real NAME_solve_planar_rrp(const NAME_planar_rrp *c, NAME_planar g, real sign, NAME_complex *q1, NAME_complex *q2,
                                  real *q3)
{
    NAME_planar_prr reverse;
    NAME_complex r1 = { 1, 0 }, r2 = { 1, 0 };
    real slider = 0, missed;
    reverse.d1 = c->d3;
    reverse.p2 = c->p2;
    reverse.p3 = c->p1;
    missed = NAME_solve_planar_prr(&reverse, NAME_planar_inverse(g), sign, &slider, &r2, &r1);
    if (missed > 0) {
        return missed;
    }
    *q1 = NAME_conjugate(r1);
    *q2 = NAME_conjugate(r2);
    *q3 = -slider;
    return 0;
}

/* A telescopic link between two pivots (RPR). The sign is + where the outer pivot is ahead of the foot of the
   perpendicular from the inner pivot to the slider. */
static NAME_INLINE real NAME_solve_planar_rpr(const NAME_planar_rpr *c, NAME_planar g, real sign, NAME_complex *q1, real *q2,
                                  NAME_complex *q3)
{
    const NAME_complex offset = NAME_times(NAME_minus(c->p3.at, c->p1.at), NAME_conjugate(c->d2));
    const NAME_complex reach = NAME_minus(NAME_apply(g, c->p3.at), c->p1.at);
    const real aside = offset.im * offset.im, square = NAME_inner(reach, reach) - aside;
    if (!(square >= -2 * NAME_REACH * aside)) {
        return NAME_missed(NAME_abs(offset.im) - NAME_sqrt(NAME_inner(reach, reach)));
    }
    {
        const real ahead = sign * NAME_sqrt(NAME_max(square, 0));
        const NAME_complex telescope = NAME_times(NAME_complex_of(ahead, offset.im), c->d2);
        const NAME_complex turned = NAME_times(reach, NAME_conjugate(telescope));
        const NAME_complex r1 = NAME_direction(turned, NAME_inner(offset, offset));
        *q1 = NAME_turn(r1, c->p1.sense);
        *q2 = ahead - offset.re;
        *q3 = NAME_turn(NAME_times(g.rotation, NAME_conjugate(r1)), c->p3.sense);
    }
    return 0;
}

/* A pivot that carries two sliders (RPP). The pivot's rotation is that of the target. */
static real NAME_solve_planar_rpp(const NAME_planar_rpp *c, NAME_planar g, NAME_complex *q1, real *q2, real *q3)
{
    const NAME_complex moved = NAME_minus(NAME_apply(g, c->p1.at), c->p1.at);
    if (!(NAME_abs(NAME_across(c->d2, c->d3)) > NAME_DEGENERATE)) {
        return (real)INFINITY;
    }
    NAME_along(c->d2, c->d3, NAME_times(moved, NAME_conjugate(g.rotation)), q2, q3);
    *q1 = NAME_turn(g.rotation, c->p1.sense);
    return 0;
}

/* Two sliders that carry a pivot (PPR): an RPP in reverse order. */
static real NAME_solve_planar_ppr(const NAME_planar_ppr *c, NAME_planar g, real *q1, real *q2, NAME_complex *q3)
{
    NAME_planar_rpp reverse;
    NAME_complex r3 = { 1, 0 };
    real s1 = 0, s2 = 0, missed;
    reverse.p1 = c->p3;
    reverse.d2 = c->d2;
    reverse.d3 = c->d1;
    missed = NAME_solve_planar_rpp(&reverse, NAME_planar_inverse(g), &r3, &s2, &s1);
    if (missed > 0) {
        return missed;
    }
    *q1 = -s1;
    *q2 = -s2;
    *q3 = NAME_conjugate(r3);
    return 0;
}

/* A pivot between two sliders (PRP). Where these become parallel, only targets on one line are in reach, and the first
   slider is given all of the displacement. */
static real NAME_solve_planar_prp(const NAME_planar_prp *c, NAME_planar g, real *q1, NAME_complex *q2, real *q3)
{
    const NAME_complex moved = NAME_minus(NAME_apply(g, c->p2.at), c->p2.at);
    const NAME_complex turned = NAME_times(g.rotation, c->d3);
    if (NAME_abs(NAME_across(c->d1, turned)) > NAME_REACH) {
        NAME_along(c->d1, turned, moved, q1, q3);
    } else {
        const real aside = NAME_abs(NAME_across(c->d1, moved));
        if (!(aside <= NAME_REACH * NAME_sqrt(NAME_inner(moved, moved)))) {
            return NAME_missed(aside);
        }
        *q1 = NAME_inner(moved, c->d1);
        *q3 = 0;
    }
    *q2 = NAME_turn(g.rotation, c->p2.sense);
    return 0;
}

/* Two pivots, at a displacement that the constraint of the leg allows. The first one moves the second one's axis. */
static void NAME_solve_planar_rr(const NAME_planar_rr *c, NAME_planar g, NAME_complex *q1, NAME_complex *q2)
{
    const NAME_complex link = NAME_minus(c->p2.at, c->p1.at);
    const NAME_complex moved = NAME_minus(NAME_apply(g, c->p2.at), c->p1.at);
    const NAME_complex r1 = NAME_times(moved, NAME_conjugate(link));
    *q1 = NAME_turn(r1, c->p1.sense);
    *q2 = NAME_turn(NAME_times(g.rotation, NAME_conjugate(r1)), c->p2.sense);
}

/* A slider and a pivot, at a displacement that the constraint of the leg allows. */
static void NAME_solve_planar_pr(const NAME_planar_pr *c, NAME_planar g, real *q1, NAME_complex *q2)
{
    *q1 = NAME_inner(c->d1, NAME_minus(NAME_apply(g, c->p2.at), c->p2.at));
    *q2 = NAME_turn(g.rotation, c->p2.sense);
}

/* A pivot and a slider, at a displacement that the constraint of the leg allows. */
static void NAME_solve_planar_rp(const NAME_planar_rp *c, NAME_planar g, NAME_complex *q1, real *q2)
{
    const NAME_complex moved = NAME_minus(NAME_apply(g, c->p1.at), c->p1.at);
    *q1 = NAME_turn(g.rotation, c->p1.sense);
    *q2 = NAME_inner(c->d2, NAME_times(NAME_conjugate(g.rotation), moved));
}

/* Two sliders, at a displacement that the constraint of the leg allows. */
static void NAME_solve_planar_pp(const NAME_planar_pp *c, NAME_planar g, real *q1, real *q2)
{
    const real area = NAME_across(c->d1, c->d2);
    *q1 = NAME_across(g.translation, c->d2) / area;
    *q2 = NAME_across(c->d1, g.translation) / area;
}

/* A pivot, at a displacement that the constraints of the leg allow. */
static void NAME_solve_planar_r(const NAME_planar_r *c, NAME_planar g, NAME_complex *q1)
{
    *q1 = NAME_turn(g.rotation, c->p1.sense);
}

/* A slider, at a displacement that the constraints of the leg allow. */
static void NAME_solve_planar_p(const NAME_planar_p *c, NAME_planar g, real *q1)
{
    *q1 = NAME_inner(c->d1, g.translation);
}

/* By how much the third axis, at w, is too near to the first one or too far from it. */
static real NAME_missed_spherical(const NAME_spherical_rrr *c, NAME_vector w)
{
    const real a12 = NAME_acos(NAME_clamp(NAME_dot(c->a1, c->a2), -1, 1));
    const real a23 = NAME_acos(NAME_clamp(NAME_dot(c->a2, c->a3), -1, 1));
    const real arc = NAME_acos(NAME_clamp(NAME_dot(c->a1, w), -1, 1));
    const real farthest = NAME_min(a12 + a23, NAME_TAU - a12 - a23);
    return NAME_missed(NAME_max(NAME_abs(a12 - a23) - arc, arc - farthest));
}

/* The other two angles of three revolutes about one point from the first one, a unit vector: where w = R a3 is near the first
   axis, q1 and q3 turn about nearly the same one, and q3 must follow from q1. On it q1 is free. */
static void NAME_spherical_rest(const NAME_spherical_rrr *c, NAME_rotation r, NAME_complex q1, NAME_complex *q2,
                                NAME_complex *q3)
{
    const NAME_vector n23 = NAME_cross(c->a2, c->a3), w = NAME_rotated(r, c->a3);
    const NAME_vector w1 = NAME_rotated_about(c->a1, NAME_conjugate(q1), w);
    const NAME_vector across = NAME_add(c->a3, -NAME_dot(c->a2, c->a3), c->a2);
    const NAME_complex q = NAME_normal(NAME_complex_of(NAME_dot(across, w1), NAME_dot(n23, w1)));
    /* A direction across the third axis, as the first two joints leave it. */
    const NAME_vector beside = NAME_rotated_about(c->a1, NAME_conjugate(q1), NAME_rotated(r, n23));
    const NAME_vector left = NAME_rotated_about(c->a2, NAME_conjugate(q), beside);
    *q2 = q;
    *q3 = NAME_complex_of(NAME_dot(n23, left), NAME_dot(NAME_cross(c->a3, n23), left));
}

/* Three revolutes about one point: a2 . exp(-a1 q1) w = a2 . a3 with w = R a3, that is A cos q1 + B sin q1 = D. The sign is
   that of the triple product T of the displaced axes, with which q2 turns the plane of a2 and a3; q3 is q1 of the reverse
   chain, whose w is p = R^-1 a1. */
static NAME_INLINE real NAME_solve_spherical_rrr(const NAME_spherical_rrr *c, NAME_rotation r, real sign, NAME_complex *q1,
                                                 NAME_complex *q2, NAME_complex *q3)
{
    const real c12 = NAME_dot(c->a1, c->a2), c23 = NAME_dot(c->a2, c->a3);
    const NAME_vector n12 = NAME_cross(c->a1, c->a2), n23 = NAME_cross(c->a2, c->a3), w = NAME_rotated(r, c->a3);
    const real along = NAME_dot(c->a1, w), A = NAME_dot(c->a2, w) - c12 * along, B = NAME_dot(n12, w);
    const real D = c23 - c12 * along, square = A * A + B * B, rest = square - D * D;
    const real T = sign * NAME_sqrt(NAME_max(rest, 0));
    if (rest <= 0 && !(NAME_abs(D) <= NAME_sqrt(square) + NAME_REACH)) {
        return NAME_missed_spherical(c, w);
    }
    *q1 = NAME_complex_of(A * D + B * T, B * D - A * T);
    if (along * along < NAME_BESIDE) {
        const NAME_vector p = NAME_vector_of(NAME_dot(r.x, c->a1), NAME_dot(r.y, c->a1), NAME_dot(r.z, c->a1));
        const real cosine = -NAME_dot(n12, n23), sine = NAME_dot(c->a1, n23), E = along - c12 * c23;
        const real F = NAME_dot(c->a2, p) - c23 * along, G = NAME_dot(n23, p), H = c12 - c23 * along;
        *q2 = NAME_complex_of(cosine * E + sine * T, sine * E - cosine * T);
        *q3 = NAME_complex_of(F * H + G * T, G * H - F * T);
    } else {
        *q1 = square > NAME_REACH * NAME_REACH ? NAME_normal(*q1) : NAME_complex_of(1, 0);
        NAME_spherical_rest(c, r, *q1, q2, q3);
    }
    return 0;
}

/* The direction of the angle about an axis that takes one vector to another. */
static inline NAME_complex NAME_angle_about(NAME_vector axis, NAME_vector from, NAME_vector to)
{
    const NAME_vector a = NAME_add(from, -NAME_dot(axis, from), axis), b = NAME_add(to, -NAME_dot(axis, to), axis);
    return NAME_normal(NAME_complex_of(NAME_dot(a, b), NAME_dot(axis, NAME_cross(a, b))));
}

/* Two revolutes about one point, at a rotation that the constraint of the leg allows. The first one moves the second one's
   axis. */
static void NAME_solve_spherical_rr(const NAME_spherical_rr *c, NAME_rotation r, NAME_complex *q1, NAME_complex *q2)
{
    *q1 = NAME_angle_about(c->a1, c->a2, NAME_rotated(r, c->a2));
    *q2 = NAME_angle_about(c->a2, c->a1, NAME_rotated_about(c->a1, NAME_conjugate(*q1), NAME_rotated(r, c->a1)));
}

/* A revolute, at a rotation that the constraints of the leg allow: the trace is 1 + 2 cos q, the axial vector a sin q. */
static void NAME_solve_spherical_r(const NAME_spherical_r *c, NAME_rotation r, NAME_complex *q1)
{
    const NAME_vector axial = NAME_vector_of(r.y.z - r.z.y, r.z.x - r.x.z, r.x.y - r.y.x);
    *q1 = NAME_complex_of(r.x.x + r.y.y + r.z.z - 1, NAME_dot(c->a1, axial));
}

/* What a rotation vector is of its axis, which has the sine of half the angle as its length. */
static inline real NAME_turned(real half, real sine)
{
    return 2 * half / (sine > 0 ? sine : 1);
}

/* The rotation vector of a spherical joint, from the axis and half the angle that its closed form gives. */
static inline NAME_vector NAME_rotation_vector(NAME_vector axis, NAME_complex half)
{
    return NAME_add(NAME_vector_of(0, 0, 0), NAME_turned(NAME_angle(half), half.im), axis);
}

/* A spherical joint: the axis of the rotation, in base coordinates, and half its angle, of at most a right angle, as a
   direction that has the length of the axis as its sine. The entries of R give four multiples of its quaternion, of which the
   longest is used. */
static NAME_INLINE void NAME_solve_spherical_s(const NAME_spherical_s *c, NAME_rotation r, real *q1, real *q2, real *q3,
                                               NAME_complex *half)
{
    const real wx = r.y.z - r.z.y, wy = r.z.x - r.x.z, wz = r.x.y - r.y.x;
    const real xy = r.y.x + r.x.y, xz = r.z.x + r.x.z, yz = r.z.y + r.y.z;
    const real ww = 1 + (r.x.x + r.y.y + r.z.z), xx = 1 + (r.x.x - r.y.y - r.z.z);
    const real yy = 1 + (r.y.y - r.x.x - r.z.z), zz = 1 + (r.z.z - r.x.x - r.y.y);
    NAME_vector axis = NAME_vector_of(wx, wy, wz);
    real w = ww, longest = ww, sense;
    if (xx > longest) {
        longest = xx;
        w = wx;
        axis = NAME_vector_of(xx, xy, xz);
    }
    if (yy > longest) {
        longest = yy;
        w = wy;
        axis = NAME_vector_of(xy, yy, yz);
    }
    if (zz > longest) {
        w = wz;
        axis = NAME_vector_of(xz, yz, zz);
    }
    *half = NAME_complex_of(NAME_abs(w), NAME_sqrt(NAME_dot(axis, axis)));
    sense = w < 0 ? -1 : 1;
    axis = NAME_rotated(c->axes, axis);
    *q1 = axis.x * sense;
    *q2 = axis.y * sense;
    *q3 = axis.z * sense;
}

/* Two joints on one axis: two linear equations. */
static void NAME_solve_cylindrical_two(const NAME_cylindrical_two *c, NAME_cylindrical g, real *q1, real *q2)
{
    const real determinant = c->j1.rotation * c->j2.advance - c->j2.rotation * c->j1.advance;
    *q1 = (g.angle * c->j2.advance - c->j2.rotation * g.advance) / determinant;
    *q2 = (c->j1.rotation * g.advance - g.angle * c->j1.advance) / determinant;
}

/* A joint on an axis, at a displacement that the constraint of the leg allows. */
static void NAME_solve_cylindrical_one(const NAME_cylindrical_one *c, NAME_cylindrical g, real *q1)
{
    *q1 = c->j1.rotation == 0 ? g.advance / c->j1.advance : g.angle * c->j1.rotation;
}

/* Two sliders in a plane. */
static void NAME_solve_translational_pp(const NAME_translational_pp *c, NAME_complex t, real *q1, real *q2)
{
    NAME_along(c->d1, c->d2, t, q1, q2);
}

/* A slider in a plane, at a displacement that the constraint of the leg allows. */
static void NAME_solve_translational_p(const NAME_translational_p *c, NAME_complex t, real *q1)
{
    *q1 = NAME_inner(c->d1, t);
}

/* Three sliders in space. Each is computed from the rounded ones after it, so that their sum is the target. */
static void NAME_solve_spatial_ppp(const NAME_spatial_ppp *c, NAME_vector t, real *q1, real *q2, real *q3)
{
    const NAME_vector normal = NAME_cross(c->d1, c->d2), across = NAME_cross(normal, c->d1);
    NAME_vector rest;
    *q3 = NAME_dot(normal, t) / NAME_dot(normal, c->d3);
    rest = NAME_add(t, -*q3, c->d3);
    *q2 = NAME_dot(across, rest) / NAME_dot(across, c->d2);
    *q1 = NAME_dot(c->d1, NAME_add(rest, -*q2, c->d2));
}

/* Two sliders in space, at a displacement that the constraint of the leg allows. */
static void NAME_solve_spatial_pp(const NAME_spatial_pp *c, NAME_vector t, real *q1, real *q2)
{
    const NAME_vector normal = NAME_cross(c->d1, c->d2);
    const real square = NAME_dot(normal, normal);
    *q1 = NAME_dot(NAME_cross(t, c->d2), normal) / square;
    *q2 = NAME_dot(NAME_cross(c->d1, t), normal) / square;
}

/* A slider in space, at a displacement that the constraints of the leg allow. */
static void NAME_solve_spatial_p(const NAME_spatial_p *c, NAME_vector t, real *q1)
{
    *q1 = NAME_dot(c->d1, t);
}

/* The difference of the squared distances. */
static inline real NAME_value_circle(const NAME_circle *c, NAME_planar g)
{
    const NAME_complex off = NAME_minus(NAME_apply(g, c->point), c->centre);
    return NAME_inner(off, off) - c->radius * c->radius;
}

static inline real NAME_value_line(const NAME_line *c, NAME_planar g)
{
    return NAME_inner(c->normal, NAME_apply(g, c->point)) - c->offset;
}

static inline real NAME_value_carried_line(const NAME_carried_line *c, NAME_planar g)
{
    return NAME_inner(c->normal, NAME_apply(NAME_planar_inverse(g), c->point)) - c->offset;
}

/* The sine of the angle between the rotations. */
static inline real NAME_value_heading(const NAME_heading *c, NAME_planar g)
{
    return NAME_across(c->rotation, g.rotation);
}

static inline real NAME_value_cone(const NAME_cone *c, NAME_rotation r)
{
    return NAME_dot(c->fixed, NAME_rotated(r, c->carried)) - c->cosine;
}

static inline real NAME_value_flat(const NAME_flat *c, NAME_vector sum)
{
    return NAME_dot(c->normal, sum) - c->value;
}

/* How far a condition is missed that has a value. */
static real NAME_missed_circle(const NAME_circle *c, real value)
{
    return NAME_missed(NAME_abs(NAME_sqrt(NAME_max(c->radius * c->radius + value, 0)) - c->radius));
}

static real NAME_missed_line(const NAME_line *c, real value)
{
    (void)c;
    return NAME_missed(NAME_abs(value));
}

static real NAME_missed_carried_line(const NAME_carried_line *c, real value)
{
    (void)c;
    return NAME_missed(NAME_abs(value));
}

static real NAME_missed_heading(const NAME_heading *c, real value)
{
    (void)c;
    return NAME_missed(NAME_abs(NAME_asin(NAME_clamp(value, -1, 1))));
}

static real NAME_missed_cone(const NAME_cone *c, real value)
{
    const real other = NAME_acos(NAME_clamp(c->cosine + value, -1, 1));
    return NAME_missed(NAME_abs(other - NAME_acos(NAME_clamp(c->cosine, -1, 1))));
}

static real NAME_missed_flat(const NAME_flat *c, real value)
{
    (void)c;
    return NAME_missed(NAME_abs(value));
}

/* The zero u of c0 + c1 cos u + c2 sin u at which it rises (sign +) or falls. Where it is zero everywhere, u is not changed.
   Values count as zero below the rounding of unit. Without a zero, missed is the value nearest to it, and 1 is returned. */
static int NAME_zero_harmonic(const real c[3], real sign, real unit, real *u, real *missed)
{
    const real amplitude = NAME_sqrt(c[1] * c[1] + c[2] * c[2]);
    if (amplitude <= NAME_VERGE * unit) {
        *missed = c[0];
        return !(NAME_abs(c[0]) <= NAME_REACH * unit);
    }
    if (!(NAME_abs(c[0]) <= amplitude + NAME_REACH * unit)) {
        *missed = c[0] - (c[0] < 0 ? -amplitude : amplitude);
        return 1;
    }
    *u = NAME_atan2(c[2], c[1])
       - sign * NAME_atan2(NAME_sqrt(NAME_max((amplitude - c[0]) * (amplitude + c[0]), 0)), -c[0]);
    return 0;
}

/* The same for c0 + c1 u + c2 u^2. */
static int NAME_zero_polynomial(const real c[3], real sign, real unit, real *u, real *missed)
{
    if (NAME_abs(c[2]) <= NAME_VERGE * NAME_max(NAME_abs(c[1]), unit)) {
        if (NAME_abs(c[1]) <= NAME_VERGE * unit) {
            *missed = c[0];
            return !(NAME_abs(c[0]) <= NAME_REACH * unit);
        }
        *u = -c[0] / c[1];
        return 0;
    }
    {
        const real square = c[1] * c[1] - 4 * c[2] * c[0];
        if (!(square >= -NAME_REACH * unit * unit)) {
            *missed = c[0] - c[1] * c[1] / (4 * c[2]);
            return 1;
        }
        *u = (sign * NAME_sqrt(NAME_max(square, 0)) - c[1]) / (2 * c[2]);
    }
    return 0;
}

/* The Euler angles of the rotation about s from the identity whose second angle is xi. Half angles keep their directions
   through xi = 0. */
static real NAME_axis_from_identity(NAME_vector s, real xi, real sign, real *zeta, real *psi)
{
    const real rho = NAME_sqrt(s.x * s.x + s.y * s.y), reduced = NAME_near(xi, 0);
    const real half = NAME_sin(reduced / 2) / rho;
    if (!(NAME_abs(half) <= 1 + NAME_REACH)) {
        return NAME_missed(NAME_abs(reduced) - 2 * NAME_asin(NAME_min(rho, 1)));
    }
    {
        const real clamped = NAME_clamp(half, -1, 1), sine = sign * clamped;
        const real cosine = NAME_max(NAME_sqrt((1 - clamped) * (1 + clamped)), (real)1e-30);
        const real column[2] = { s.x * s.z * sine + s.y * cosine, s.y * s.z * sine - s.x * cosine };
        const real row[2] = { s.x * s.z * sine - s.y * cosine, s.y * s.z * sine + s.x * cosine };
        *zeta = NAME_atan2(sign * column[1], sign * column[0]);
        *psi = NAME_atan2(sign * row[1], -sign * row[0]);
    }
    return 0;
}

/* The same for the rotation about s of an orientation at home: cos xi = c0 + c1 cos q + c2 sin q. */
static real NAME_axis_from_home(NAME_vector s, NAME_rotation home, real xi, real sign, real *zeta, real *psi)
{
    const NAME_vector third = home.z;
    const real c0 = s.z * NAME_dot(s, third);
    const NAME_complex z = NAME_complex_of(third.z - c0, s.x * third.y - s.y * third.x);
    const real amplitude = NAME_sqrt(NAME_inner(z, z)), part = NAME_cos(xi) - c0, reduced = NAME_near(xi, 0);
    if (!(NAME_abs(part) <= amplitude + NAME_REACH)) {
        const real nearest = NAME_acos(NAME_clamp(c0 + (part < 0 ? -amplitude : amplitude), -1, 1));
        return NAME_missed(NAME_abs(NAME_abs(reduced) - nearest));
    }
    {
        const real upper = reduced < 0 ? -1 : 1;
        const real height = NAME_sqrt(NAME_max((amplitude - part) * (amplitude + part), 0));
        const NAME_complex turn = NAME_normal(NAME_times(z, NAME_complex_of(part, sign * upper * height)));
        const NAME_rotation r = NAME_product(NAME_rotation_about(s, turn), home);
        *zeta = NAME_atan2(upper * r.z.y, upper * r.z.x);
        *psi = NAME_atan2(upper * r.y.z, -upper * r.x.z);
    }
    return 0;
}

/* The branch of a choice in a mode: -1 where its bit is set. */
static inline real NAME_sign(unsigned mode, unsigned bit)
{
    return (mode >> bit) & 1u ? -1 : 1;
}

/* The size of a limit; zero where there is none. */
static inline real NAME_end(real limit)
{
    const real size = NAME_abs(limit);
    return size < (real)INFINITY ? size : 0;
}

/* The rounding that a value at a limit may have. */
static inline real NAME_slack(const NAME_joint *joint)
{
    const real ends = NAME_max(NAME_end(joint->low), NAME_end(joint->high));
    return NAME_REACH * NAME_max(ends, NAME_max(NAME_abs(joint->home), joint->size));
}

/* Brings an angle into its limits by full revolutions, where these do. */
static real NAME_into_limits(const NAME_joint *joint, real value)
{
    const real slack = NAME_slack(joint), low = joint->low - slack, high = joint->high + slack;
    if (value < low || value > high) {
        const real past = value < low ? low - value : value - high;
        const real turns = NAME_TAU * NAME_ceil(past / NAME_TAU), moved = value < low ? value + turns : value - turns;
        return moved >= low && moved <= high ? moved : value;
    }
    return value;
}

/* The value of an angle: within half a revolution of home, or within its limits where full revolutions bring it there. */
static inline real NAME_reported(const NAME_joint *joint, real angle)
{
    const real value = joint->home + angle;
    return value >= joint->low && value <= joint->high ? value : NAME_into_limits(joint, value);
}

/* The angle of a joint that is nearest to a previous value of it. */
static inline real NAME_nearest_angle(const NAME_joint *joint, NAME_complex direction, real previous)
{
    return NAME_near(joint->home + NAME_angle(direction), previous);
}

/* The rotation vector nearest to a previous one among those of the same rotation, which differ by full revolutions. */
static inline NAME_vector NAME_nearest_rotation(NAME_vector vector, NAME_vector previous)
{
    const real angle = NAME_sqrt(NAME_dot(vector, vector)), held = NAME_sqrt(NAME_dot(previous, previous));
    const NAME_vector zero = NAME_vector_of(0, 0, 0);
    real turns;
    if (angle < NAME_REACH / 100) {
        /* Full revolutions about any axis are the identity: the nearest axis is that of the previous one. */
        turns = NAME_round(held / NAME_TAU);
        return turns > 0 ? NAME_add(zero, NAME_TAU * turns / held, previous) : vector;
    }
    turns = (NAME_dot(previous, vector) / angle - angle) / NAME_TAU;
    return NAME_abs(turns) <= (real)0.5 ? vector : NAME_add(zero, 1 + NAME_TAU * NAME_round(turns) / angle, vector);
}

/* The square of a joint's motion from a previous value, in radians or sizes of the mechanism. */
static inline real NAME_moved(const NAME_joint *joint, real value, real previous)
{
    const real moved = (value - previous) / joint->size;
    return moved * moved;
}

/* A displacement of a body: a rotation about the origin, then a translation. */
typedef struct { NAME_rotation rotation; NAME_vector translation; } NAME_body;

/* A displacement of a section in base coordinates, from its rotation and its translation in the section's frame. */
static inline NAME_body NAME_body_of(const NAME_frame *f, NAME_rotation rotation, NAME_vector translation)
{
    NAME_body g;
    const NAME_vector moved = NAME_add(f->origin, 1, NAME_rotated(f->axes, translation));
    g.rotation = NAME_product(NAME_product(f->axes, rotation), NAME_transposed(f->axes));
    g.translation = NAME_add(moved, -1, NAME_rotated(g.rotation, f->origin));
    return g;
}

/* g h */
static inline NAME_body NAME_body_product(NAME_body g, NAME_body h)
{
    NAME_body p;
    p.rotation = NAME_product(g.rotation, h.rotation);
    p.translation = NAME_add(g.translation, 1, NAME_rotated(g.rotation, h.translation));
    return p;
}

/* The velocity of a point that a twist of a section moves: w and v in the section's frame, the rest in base coordinates. */
static inline NAME_vector NAME_velocity_at(const NAME_frame *f, NAME_vector w, NAME_vector v, NAME_vector point)
{
    const NAME_vector arm = NAME_add(point, -1, f->origin);
    return NAME_add(NAME_rotated(f->axes, v), 1, NAME_cross(NAME_rotated(f->axes, w), arm));
}

/* The rotation about the third direction by a direction. */
static inline NAME_rotation NAME_about_third(NAME_complex e)
{
    NAME_rotation r;
    r.x = NAME_vector_of(e.re, e.im, 0);
    r.y = NAME_vector_of(-e.im, e.re, 0);
    r.z = NAME_vector_of(0, 0, 1);
    return r;
}

/* 0, or what is returned for a pose that has a coordinate that is no number. */
static int NAME_check(const real pose[])
{
    int i;
    for (i = 0; i < NAME_COORDINATES; ++i) {
        /* Not true of a number that is none. */
        if (!((double)NAME_abs(pose[i]) <= NAME_LARGEST)) {
            return -(i + 1);
        }
    }
    return 0;
}

/* A singular system has a pivot below this share: its rates would be rounding. */
#define NAME_SINGULAR ((real)(sizeof(real) == sizeof(float) ? 1e-4 : 1e-6))

/* Three screws of a section, in its frame: rotation and velocity of the origin in a plane, on an axis; three rotations about
   a point; two or three velocities. */
typedef struct { NAME_vector s1, s2, s3; } NAME_screws;

/* The twists of the two sections, in their frames, and the rate of the height. */
typedef struct { NAME_vector lower, upper; real rise; } NAME_twists;

static inline NAME_twists NAME_twists_of(NAME_vector lower, NAME_vector upper, real rise)
{
    NAME_twists t;
    t.lower = lower;
    t.upper = upper;
    t.rise = rise;
    return t;
}

/* Ad(g) s */
static inline NAME_vector NAME_planar_adjoint(NAME_planar g, NAME_vector s)
{
    const NAME_complex moved = NAME_times(g.rotation, NAME_complex_of(s.y, s.z));
    return NAME_vector_of(s.x, moved.re + s.x * g.translation.im, moved.im - s.x * g.translation.re);
}

/* The screw of a pivot. */
static inline NAME_vector NAME_pivot_screw(NAME_pivot p)
{
    return NAME_vector_of(p.sense, p.sense * p.at.im, -p.sense * p.at.re);
}

/* The screw of a slider. */
static inline NAME_vector NAME_slider_screw(NAME_complex d)
{
    return NAME_vector_of(0, d.re, d.im);
}

/* What a pivot does at an angle, which is given as a direction. */
static inline NAME_planar NAME_pivot_motion(NAME_pivot p, NAME_complex q)
{
    const NAME_complex turn = NAME_turn(NAME_normal(q), p.sense);
    return NAME_planar_of(turn, NAME_minus(p.at, NAME_times(turn, p.at)));
}

/* What a slider does. */
static inline NAME_planar NAME_slider_motion(NAME_complex d, real q)
{
    return NAME_planar_of(NAME_complex_of(1, 0), NAME_scaled(d, q));
}

/* A screw with its second and third component over a unit. */
static inline NAME_vector NAME_per_unit(NAME_vector s, real unit)
{
    return NAME_vector_of(s.x, s.y / unit, s.z / unit);
}

/* A vector perpendicular to another one. */
static inline NAME_vector NAME_perpendicular(NAME_vector s)
{
    const real x = NAME_abs(s.x), y = NAME_abs(s.y), z = NAME_abs(s.z);
    if (x <= y && x <= z) {
        return NAME_vector_of(0, s.z, -s.y);
    }
    return y <= z ? NAME_vector_of(-s.z, 0, s.x) : NAME_vector_of(s.y, -s.x, 0);
}

static inline NAME_vector NAME_normal_vector(NAME_vector s)
{
    const real length = NAME_sqrt(NAME_dot(s, s));
    return NAME_add(NAME_vector_of(0, 0, 0), length > 0 ? 1 / length : 0, s);
}

/* Replaces screws by their reciprocal ones: the dot product of two is 1 if they belong together, and 0 otherwise. Of the three
   screws, count are given; perpendicular ones complete them, which joints would have that the section lacks. Rotations are
   compared with velocities over the unit. It returns 1 where the screws are dependent. */
static int NAME_reciprocal(NAME_screws *s, int count, real unit)
{
    const NAME_vector third = NAME_vector_of(0, 0, 1);
    NAME_vector s1 = NAME_per_unit(s->s1, unit), s2 = NAME_per_unit(s->s2, unit), s3 = NAME_per_unit(s->s3, unit);
    NAME_vector r1, r2, r3;
    real determinant, product;
    if (count < 1) {
        s1 = third;
    }
    if (count < 2) {
        s2 = NAME_normal_vector(NAME_perpendicular(s1));
    }
    if (count < 3) {
        s3 = NAME_normal_vector(NAME_cross(s1, s2));
    }
    r1 = NAME_cross(s2, s3);
    r2 = NAME_cross(s3, s1);
    r3 = NAME_cross(s1, s2);
    determinant = NAME_dot(s1, r1);
    product = NAME_sqrt(NAME_dot(s1, s1) * NAME_dot(s2, s2) * NAME_dot(s3, s3));
    if (!(NAME_abs(determinant) > NAME_SINGULAR * product)) {
        return 1;
    }
    s->s1 = NAME_per_unit(NAME_add(NAME_vector_of(0, 0, 0), 1 / determinant, r1), unit);
    s->s2 = NAME_per_unit(NAME_add(NAME_vector_of(0, 0, 0), 1 / determinant, r2), unit);
    s->s3 = NAME_per_unit(NAME_add(NAME_vector_of(0, 0, 0), 1 / determinant, r3), unit);
    return 0;
}

/* The rows that give the rates of a rotation vector r, in base coordinates, from the angular velocity w, in the section's:
   w - r x w / 2 + c r x (r x w), c = (1 - (q / 2) cot (q / 2)) / q^2 with q = |r|. */
static void NAME_rotation_vector_rates(NAME_rotation axes, NAME_vector r, NAME_screws *rows)
{
    const NAME_rotation back = NAME_transposed(axes);
    const real square = NAME_dot(r, r), half = NAME_sqrt(square) / 2;
    /* The series, where the closed form would cancel. */
    const real series = 1 / (real)12 + square * (1 / (real)720 + square * (1 / (real)30240 + square * (1 / (real)1209600
                      + square * (1 / (real)47900160 + square * (691 / (real)1307674368000.0)))));
    const real c = half < (real)0.2 ? series : (1 - half * NAME_cos(half) / NAME_sin(half)) / square;
    const real across = 1 - c * square;
    const NAME_vector x = NAME_vector_of(across + c * r.x * r.x, c * r.x * r.y + r.z / 2, c * r.x * r.z - r.y / 2);
    const NAME_vector y = NAME_vector_of(c * r.y * r.x - r.z / 2, across + c * r.y * r.y, c * r.y * r.z + r.x / 2);
    const NAME_vector z = NAME_vector_of(c * r.z * r.x + r.y / 2, c * r.z * r.y - r.x / 2, across + c * r.z * r.z);
    rows->s1 = NAME_rotated(back, x);
    rows->s2 = NAME_rotated(back, y);
    rows->s3 = NAME_rotated(back, z);
}

/* The screws of the Euler angles. */
static inline NAME_screws NAME_euler_screws(real zeta, real xi)
{
    const NAME_complex z = NAME_unit(zeta), x = NAME_unit(xi);
    NAME_screws s;
    s.s1 = NAME_vector_of(0, 0, 1);
    s.s2 = NAME_vector_of(-z.im, z.re, 0);
    s.s3 = NAME_vector_of(z.re * x.im, z.im * x.im, x.re);
    return s;
}

/* The rotation of a rotation vector. */
static inline NAME_rotation NAME_rotation_by(NAME_vector w)
{
    return NAME_rotation_about(NAME_normal_vector(w), NAME_unit(NAME_sqrt(NAME_dot(w, w))));
}

/* Replaces three columns of rates, from the first on, which belong to rotations about the directions of a frame, by those of
   three angles with these screws. */
static void NAME_by_angles(real rates[], int rows, int columns, int first, NAME_vector s1, NAME_vector s2, NAME_vector s3)
{
    int i;
    for (i = 0; i < rows; ++i) {
        const int at = i * columns + first;
        const NAME_vector rate = NAME_vector_of(rates[at], rates[at + 1], rates[at + 2]);
        rates[at] = NAME_dot(s1, rate);
        rates[at + 1] = NAME_dot(s2, rate);
        rates[at + 2] = NAME_dot(s3, rate);
    }
}

/* The Euler angles of a rotation of which the second one is not negative. Where it is zero or half a revolution, to within
   rounding, the first one is free, and given. */
static NAME_vector NAME_euler_angles(NAME_rotation r, real first)
{
    const real sine = NAME_sqrt(r.z.x * r.z.x + r.z.y * r.z.y);
    const NAME_complex z = sine < 4 * NAME_REACH ? NAME_unit(first) : NAME_normal(NAME_complex_of(r.z.x, r.z.y));
    /* The third one is what the first one leaves. */
    const NAME_complex rest = NAME_complex_of(z.re * r.y.y - z.im * r.y.x, z.re * r.x.y - z.im * r.x.x);
    return NAME_vector_of(NAME_angle(z), NAME_atan2(sine, r.z.z), NAME_angle(rest));
}

/* One of the two triples of Euler angles of a rotation, 0 or 1, with the revolutions nearest to others. */
static NAME_vector NAME_euler_in(NAME_rotation r, NAME_vector near, int chart)
{
    const NAME_vector a = NAME_euler_angles(r, chart > 0 ? near.x + NAME_PI : near.x);
    const NAME_vector b = chart > 0 ? NAME_vector_of(a.x + NAME_PI, -a.y, a.z + NAME_PI) : a;
    return NAME_vector_of(NAME_near(b.x, near.x), NAME_near(b.y, near.y), NAME_near(b.z, near.z));
}

/* The Euler angles of a rotation nearest to others. */
static NAME_vector NAME_euler_near(NAME_rotation r, NAME_vector near)
{
    const NAME_vector a = NAME_euler_in(r, near, 0), b = NAME_euler_in(r, near, 1);
    const NAME_vector of_a = NAME_add(a, -1, near), of_b = NAME_add(b, -1, near);
    return NAME_dot(of_b, of_b) < NAME_dot(of_a, of_a) ? b : a;
}

/* The same for azimuth, tilt and torsion, which is the sum of the first and the third Euler angle. */
static NAME_vector NAME_torsion_in(NAME_rotation r, NAME_vector near, int chart)
{
    const NAME_vector a = NAME_euler_in(r, NAME_vector_of(near.x, near.y, near.z - near.x), chart);
    return NAME_vector_of(a.x, a.y, NAME_near(a.x + a.z, near.z));
}

/* The azimuth, the tilt, which is not negative, and the torsion of a rotation, nearest to others. */
static NAME_vector NAME_torsion_near(NAME_rotation r, NAME_vector near)
{
    const NAME_vector a = NAME_euler_angles(r, near.x);
    return NAME_vector_of(NAME_near(a.x, near.x), a.y, NAME_near(a.x + a.z, near.z));
}

/* How far two rotations are apart: four times the square of the sine of half the angle between them. */
static real NAME_apart(NAME_rotation r, NAME_rotation s)
{
    return 3 - NAME_dot(r.x, s.x) - NAME_dot(r.y, s.y) - NAME_dot(r.z, s.z);
}

/* Solves linear equations in unknowns, with right sides behind the coefficients in each row, by elimination with complete
   pivoting. There are at least as many equations as unknowns; those that are left over must follow from the others. Row i of x
   has unknown i for each right side. Coefficients are compared with one. It returns 1 where the unknowns are not determined. */
static int NAME_eliminate(real a[], int rows, int unknowns, int sides, real x[])
{
    const int width = unknowns + sides;
    int place[6], i, j, k;
    for (j = 0; j < unknowns; ++j) {
        place[j] = -1;
    }
    for (k = 0; k < unknowns; ++k) {
        int row = k, column = 0;
        real most = 0;
        for (i = k; i < rows; ++i) {
            for (j = 0; j < unknowns; ++j) {
                if (place[j] < 0 && NAME_abs(a[i * width + j]) > most) {
                    most = NAME_abs(a[i * width + j]);
                    row = i;
                    column = j;
                }
            }
        }
        if (!(most > NAME_SINGULAR)) {
            return 1;
        }
        place[column] = k;
        for (j = 0; j < width; ++j) {
            const real swapped = a[row * width + j];
            a[row * width + j] = a[k * width + j];
            a[k * width + j] = swapped;
        }
        for (i = 0; i < rows; ++i) {
            const real factor = a[i * width + column] / a[k * width + column];
            if (i != k) {
                for (j = 0; j < width; ++j) {
                    a[i * width + j] -= factor * a[k * width + j];
                }
            }
        }
    }
    for (j = 0; j < unknowns; ++j) {
        for (i = 0; i < sides; ++i) {
            x[j * sides + i] = a[place[j] * width + unknowns + i] / a[place[j] * width + j];
        }
    }
    return 0;
}

/* 0, or what is returned for values of which one is no number. */
static int NAME_numbers(const real values[], int count)
{
    int i;
    for (i = 0; i < count; ++i) {
        /* Not true of a number that is none. */
        if (!((double)NAME_abs(values[i]) <= NAME_LARGEST)) {
            return -NAME_COORDINATES - (i + 1);
        }
    }
    return 0;
}
