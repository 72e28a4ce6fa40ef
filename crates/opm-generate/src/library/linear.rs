//! Linear equations.

use super::*;

functions! {
    /// Solves linear equations in unknowns, with right sides behind the coefficients in each row, by elimination with
    /// complete pivoting. There are at least as many equations as unknowns; those that are left over must follow from the
    /// others. Row i of x has unknown i for each right side. Coefficients are compared with one. It returns 1 where the
    /// unknowns are not determined.
    fn eliminate(a: Out<[Real]>, rows: Int, unknowns: Int, sides: Int, x: Out<[Real]>) -> Int {
        name!(width = unknowns + sides);
        let place = Array::<Int>::empty("place", 7);
        count("j", 0, unknowns, |j| {
            place.at(j).set(-1);
        });
        count("k", 0, unknowns, |k| {
            name!(row = k, column = Int::from(0));
            name!(most = 0.0);
            count("i", k, rows, |i| {
                count("j", 0, unknowns, |j| {
                    when(place.at(j).lt(0) & abs(a.at(i * width + j)).gt(most), || {
                        most.set(abs(a.at(i * width + j)));
                        row.set(i);
                        column.set(j);
                    });
                });
            });
            when(!most.gt(SINGULAR), || {
                give(1);
            });
            place.at(column).set(k);
            count("j", 0, width, |j| {
                name!(swapped = a.at(row * width + j));
                a.at(row * width + j).set(a.at(k * width + j));
                a.at(k * width + j).set(swapped);
            });
            count("i", 0, rows, |i| {
                name!(factor = a.at(i * width + column) / a.at(k * width + column));
                when(i.is_not(k), || {
                    count("j", 0, width, |j| {
                        a.at(i * width + j).decrease(factor * a.at(k * width + j));
                    });
                });
            });
        });
        count("j", 0, unknowns, |j| {
            count("i", 0, sides, |i| {
                x.at(j * sides + i)
                    .set(a.at(place.at(j) * width + unknowns + i) / a.at(place.at(j) * width + j));
            });
        });
        0
    }

    /// The determinant of a matrix, which is changed.
    fn determinant(b: Out<[Real]>, count: Int) -> Real {
        name!(product = 1.0);
        let swap = |row: Int, k: Int, j: Int| {
            name!(swapped = b.at(row * count + j));
            b.at(row * count + j).set(b.at(k * count + j));
            b.at(k * count + j).set(swapped);
        };
        super::count("k", 0, count, |k| {
            name!(row = k);
            super::count("i", k + 1, count, |i| {
                let larger = abs(b.at(i * count + k)).gt(abs(b.at(row * count + k)));
                row.set(larger.choose(i, row));
            });
            when(b.at(row * count + k).is(0.0), || give(0.0));
            product.multiply(row.is(k).choose(b.at(k * count + k), -b.at(row * count + k)));
            super::count("j", 0, count, |j| swap(row, k, j));
            super::count("i", k + 1, count, |i| {
                name!(factor = b.at(i * count + k) / b.at(k * count + k));
                super::count("j", k, count, |j| {
                    b.at(i * count + j).decrease(factor * b.at(k * count + j));
                });
            });
        });
        product
    }

    /// The sign of a determinant; 0 where it vanishes.
    fn sign_of(b: Out<[Real]>, count: Int) -> Int {
        name!(value = determinant(b, count));
        value.gt(VANISHED).choose(1, value.lt(-VANISHED).choose(-1, 0))
    }

    /// 0, or what is returned for values of which one is no number.
    fn numbers(values: In<[Real]>, count: Int) -> Int {
        super::count("i", 0, count, |i| {
            note("Not true of a number that is none.");
            when(!abs(values.at(i)).le(LARGEST), || {
                give(-COORDINATES - (i + 1));
            });
        });
        0
    }
}
