//! Numbers by rows, one for each pose, and by columns, one for each quantity.
//!
//! Four columns at a time are transposed in the processor's vectors. These hold at most four numbers
//! ([`FourWide`](crate::numeric::four_wide::FourWide)): of longer ones, pulp does not tell the order.

use super::lanes::Column;
use pulp::Simd;
use pulp::bytemuck::cast_slice;

/// Reads rows of `width` numbers each into columns; `column_of` tells which one gets a number. Lanes beyond the last row
/// get its numbers.
#[inline(always)]
pub fn read_rows<S: Simd>(
    simd: S,
    rows: &[f64],
    width: usize,
    columns: &mut [Column],
    column_of: impl Fn(usize) -> usize,
) {
    const { assert!(S::F64_LANES <= 4) };
    let fours = width / 4;
    let mut blocks = rows.chunks_exact(S::F64_LANES * width);
    let mut lane = 0;
    for rows in &mut blocks {
        for number in (0..fours).map(|four| 4 * four) {
            let mut of_rows = [[0.0; 4]; 4];
            for (row, values) in of_rows[..S::F64_LANES].iter_mut().enumerate() {
                values.copy_from_slice(&rows[row * width + number..][..4]);
            }
            let (of_rows, _) = S::as_simd_f64s(of_rows.as_flattened());
            let four =
                simd.deinterleave_shfl_f64s([of_rows[0], of_rows[1], of_rows[2], of_rows[3]]);
            for (number, values) in (number..).zip(four) {
                S::as_mut_simd_f64s(&mut columns[column_of(number)][lane..]).0[0] = values;
            }
        }
        for number in 4 * fours..width {
            let column = &mut columns[column_of(number)][lane..][..S::F64_LANES];
            for (row, to) in column.iter_mut().enumerate() {
                *to = rows[row * width + number];
            }
        }
        lane += S::F64_LANES;
    }
    for row in blocks.remainder().chunks_exact(width) {
        for (number, value) in row.iter().enumerate() {
            columns[column_of(number)][lane] = *value;
        }
        lane += 1;
    }
    for column in (0..width).map(column_of) {
        let column = &mut columns[column];
        let last = column[..lane].last().copied().unwrap_or_default();
        column[lane..].fill(last);
    }
}

/// Writes columns to rows of as many numbers.
#[inline(always)]
pub fn write_rows<S: Simd>(simd: S, columns: &[Column], rows: &mut [f64]) {
    const { assert!(S::F64_LANES <= 4) };
    let width = columns.len();
    if width == 0 {
        return;
    }
    let (fours, others) = columns.as_chunks::<4>();
    let mut blocks = rows.chunks_exact_mut(S::F64_LANES * width);
    let mut lane = 0;
    for rows in &mut blocks {
        for (number, four) in fours.iter().enumerate() {
            let four = four.each_ref().map(|column| S::as_simd_f64s(&column[lane..]).0[0]);
            let of_rows = simd.interleave_shfl_f64s(four);
            let (of_rows, _) = cast_slice(std::slice::from_ref(&of_rows)).as_chunks::<4>();
            for (row, values) in of_rows.iter().enumerate() {
                rows[row * width + 4 * number..][..4].copy_from_slice(values);
            }
        }
        for (number, column) in (4 * fours.len()..).zip(others) {
            for (row, value) in column[lane..][..S::F64_LANES].iter().enumerate() {
                rows[row * width + number] = *value;
            }
        }
        lane += S::F64_LANES;
    }
    for (row, lane) in blocks.into_remainder().chunks_exact_mut(width).zip(lane..) {
        for (to, column) in row.iter_mut().zip(columns) {
            *to = column[lane];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manipulator::batch::lanes::{LANES, Lanes};
    use crate::numeric::four_wide::FourWide;
    use pulp::WithSimd;

    fn value(row: usize, number: usize) -> f64 {
        (100 * number + row) as f64
    }

    struct Write<'a> {
        columns: &'a [Column],
        rows: &'a mut [f64],
    }

    impl WithSimd for Write<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            write_rows(simd, self.columns, self.rows);
        }
    }

    struct Read<'a> {
        rows: &'a [f64],
        width: usize,
        columns: &'a mut [Column],
    }

    impl WithSimd for Read<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self { rows, width, columns } = self;
            read_rows(simd, rows, width, columns, |number| width - number);
        }
    }

    /// Every number of rows of a block, and rows with and without a square of four numbers.
    #[test]
    fn columns_become_rows() {
        for width in 0..10 {
            let columns: Vec<Column> = (0..width)
                .map(|number| Lanes(std::array::from_fn(|row| value(row, number))))
                .collect();
            for count in 0..=LANES {
                let mut rows = vec![f64::NAN; count * width];
                FourWide::new().dispatch(Write { columns: &columns, rows: &mut rows });
                for (place, found) in rows.into_iter().enumerate() {
                    assert_eq!(found, value(place / width, place % width), "{count} x {width}");
                }
            }
        }
    }

    /// The columns are in the opposite order, between columns that stay as they are.
    #[test]
    fn rows_become_columns() {
        for width in 1..10 {
            for count in 1..=LANES {
                let rows: Vec<f64> =
                    (0..count * width).map(|i| value(i / width, i % width)).collect();
                let mut columns = vec![Lanes::all(f64::NAN); width + 2];
                let column_of = |number: usize| width - number;
                FourWide::new().dispatch(Read { rows: &rows, width, columns: &mut columns });
                for number in 0..width {
                    let expected =
                        Lanes(std::array::from_fn(|lane| value(lane.min(count - 1), number)));
                    assert_eq!(columns[column_of(number)], expected, "{count} x {width}");
                }
                let others = [&columns[0], &columns[width + 1]];
                assert!(others.into_iter().flatten().all(|value| value.is_nan()));
            }
        }
    }
}
