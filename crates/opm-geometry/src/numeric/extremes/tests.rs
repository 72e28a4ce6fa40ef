use super::*;
use crate::numeric::svd::singular_values;
use nalgebra::DMatrix;

/// Rounding of some dozen operations, in units of the largest singular value. Entries are that uncertain, too, and so a
/// smallest value is uncertain by as much.
const ROUNDING: f64 = 1e-14;

/// Numbers in [0, 1), the same in every run.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() * end as f64) as usize
    }

    /// A rotation or a reflection: the orthogonal factor of a random matrix.
    fn orthogonal(&mut self, n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |_, _| self.next() - 0.5).qr().q()
    }
}

/// The extremes of one matrix of at most six rows and columns.
fn of(a: &DMatrix<f64>) -> [f64; 3] {
    let mut m = [[[0.0]; 6]; 6];
    for i in 0..a.nrows() {
        for j in 0..a.ncols() {
            m[j][i] = [a[(i, j)]];
        }
    }
    let Extremes { largest: [largest], smallest: [smallest], product: [product] } =
        extremes(&mut m, [a.nrows(), a.ncols()]);
    [largest, smallest, product]
}

/// Compares with Jacobi rotations and with nalgebra's QR iterations.
fn check(a: &DMatrix<f64>) {
    let [largest, smallest, product] = of(a);
    for values in [singular_values(a.clone()), a.singular_values().iter().copied().collect()] {
        let high = values.iter().copied().fold(0.0, f64::max);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let volume: f64 = values.iter().product();
        assert!((largest - high).abs() <= ROUNDING * high, "{a}{largest:?} {values:?}");
        assert!((smallest - low).abs() <= ROUNDING * high, "{a}{smallest:?} {values:?}");
        let most: f64 = values.iter().map(|value| value + ROUNDING * high).product();
        assert!((product - volume).abs() <= most - volume, "{a}{product:?} {volume:?}");
    }
}

#[test]
fn random_matrices() {
    let mut draw = Draw(1);
    for _ in 0..20_000 {
        let columns = 1 + draw.below(6);
        let rows = columns + draw.below(7 - columns);
        check(&DMatrix::from_fn(rows, columns, |_, _| draw.next() - 0.5));
    }
}

/// Matrices of small integers with many zeros and with equal or opposite columns.
#[test]
fn structured_matrices() {
    let mut draw = Draw(2);
    for _ in 0..20_000 {
        let columns = 1 + draw.below(6);
        let rows = columns + draw.below(7 - columns);
        let entries = [0.0, 0.0, 0.0, 1.0, -1.0, 0.5_f64.sqrt(), 1e-9];
        let mut a = DMatrix::from_fn(rows, columns, |_, _| entries[draw.below(7)]);
        let (from, to) = (draw.below(columns), draw.below(columns));
        if draw.below(3) == 0 {
            let copy = a.column(from) * [1.0, -1.0, 0.0][draw.below(3)];
            a.set_column(to, &copy);
        }
        check(&a);
    }
}

/// Given singular values: equal ones, nearly equal ones, tiny ones and zeros.
#[test]
fn given_values() {
    let mut draw = Draw(3);
    for round in 0..20_000 {
        let n = 1 + draw.below(6);
        let kinds = [
            1.0,
            1.0,
            1.0 + 1e-15,
            1.0 + 1e-12,
            1.0 - 1e-9,
            1.0 + 1e-6,
            0.3,
            1e-3,
            1e-6,
            1e-10,
            0.0,
        ];
        let few = if round % 2 == 0 { kinds.len() } else { 6 };
        let values: Vec<f64> = (0..n).map(|_| kinds[draw.below(few)]).collect();
        let diagonal = DMatrix::from_fn(n, n, |i, j| if i == j { values[i] } else { 0.0 });
        let a = draw.orthogonal(n) * diagonal * draw.orthogonal(n);
        let scale = [1.0, 1e-7, 1e9][draw.below(3)];
        let [largest, smallest, _] = of(&(&a * scale));
        let high = values.iter().copied().fold(0.0, f64::max);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((largest / scale - high).abs() <= ROUNDING * high, "{largest:?} {values:?}");
        assert!((smallest / scale - low).abs() <= ROUNDING * high, "{smallest:?} {values:?}");
        check(&a);
    }
}

/// A bidiagonal matrix has its small values to all digits, though its largest one is many orders larger.
#[test]
fn small_values_of_bidiagonal_matrices() {
    let mut draw = Draw(4);
    for _ in 0..2_000 {
        let n = 2 + draw.below(5);
        let mut a = DMatrix::zeros(n, n);
        for i in 0..n {
            a[(i, i)] = 10_f64.powf(-6.0 * draw.next());
            if i + 1 < n {
                a[(i, i + 1)] = 10_f64.powf(-6.0 * draw.next());
            }
        }
        let [_, smallest, _] = of(&a);
        // The inverse of a bidiagonal matrix is exact but for rounding, entry by entry, and so is its largest value.
        let inverse = a.clone().try_inverse().expect("regular");
        let expected = inverse.singular_values().max().recip();
        assert!((smallest / expected - 1.0).abs() < 1e-13, "{a}{smallest:?} {expected:?}");
    }
}

/// The result for a matrix does not depend on those beside it, to the bit, nor on the room around it.
#[test]
fn lanes_are_independent() {
    let mut draw = Draw(5);
    for _ in 0..500 {
        let all: Vec<DMatrix<f64>> = (0..16)
            .map(|_| match draw.below(4) {
                0 => draw.orthogonal(5),
                1 => DMatrix::zeros(5, 5),
                2 => DMatrix::from_element(5, 5, f64::NAN),
                _ => DMatrix::from_fn(5, 5, |_, _| draw.next() - 0.5),
            })
            .collect();
        let mut m: Matrices<5, 16> = [[[0.0; 16]; 5]; 5];
        for (lane, a) in all.iter().enumerate() {
            for i in 0..5 {
                for j in 0..5 {
                    m[j][i][lane] = a[(i, j)];
                }
            }
        }
        let found = extremes(&mut m, [5, 5]);
        for (lane, a) in all.iter().enumerate() {
            let together = [found.largest[lane], found.smallest[lane], found.product[lane]];
            assert_eq!(together.map(f64::to_bits), of(a).map(f64::to_bits), "{a}");
        }
    }
}

#[test]
fn what_is_not_finite_has_no_finite_largest_value() {
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let mut a =
            DMatrix::from_fn(4, 4, |i, j| f64::from(i as u32 + 1) / f64::from(j as u32 + 2));
        a[(2, 1)] = bad;
        assert!(!of(&a)[0].is_finite(), "{bad}");
    }
    assert_eq!(of(&DMatrix::zeros(3, 3)), [0.0; 3]);
}
