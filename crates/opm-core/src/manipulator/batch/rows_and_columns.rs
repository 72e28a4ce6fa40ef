//! Numbers by rows, one for each pose, and by columns, one for each quantity.

use super::lanes::Column;

/// Reads rows of `width` numbers each into columns; `column_of` tells which one gets a number. Lanes beyond the last row
/// get its numbers.
#[inline(always)]
pub fn read_rows(
    rows: &[f64],
    width: usize,
    columns: &mut [Column],
    column_of: impl Fn(usize) -> usize,
) {
    for number in 0..width {
        let column = &mut columns[column_of(number)];
        let mut last = 0.0;
        for (to, row) in column.iter_mut().zip(rows.chunks_exact(width)) {
            last = row[number];
            *to = last;
        }
        column[rows.len() / width..].fill(last);
    }
}

/// Writes columns to rows of as many numbers. Squares of four rows and four columns are transposed in the processor's
/// vectors.
#[inline(always)]
pub fn write_rows(columns: &[Column], rows: &mut [f64]) {
    let width = columns.len();
    if width == 0 {
        return;
    }
    let (fours, others) = columns.as_chunks::<4>();
    let mut four_rows = rows.chunks_exact_mut(4 * width);
    let mut lane = 0;
    for rows in &mut four_rows {
        for (number, [a, b, c, d]) in fours.iter().enumerate() {
            let (a, b, c, d) =
                (&a[lane..lane + 4], &b[lane..lane + 4], &c[lane..lane + 4], &d[lane..lane + 4]);
            for i in 0..4 {
                let to = &mut rows[i * width + 4 * number..][..4];
                to.copy_from_slice(&[a[i], b[i], c[i], d[i]]);
            }
        }
        for (number, column) in others.iter().enumerate() {
            let first = 4 * fours.len() + number;
            for (i, value) in column[lane..lane + 4].iter().enumerate() {
                rows[i * width + first] = *value;
            }
        }
        lane += 4;
    }
    for (row, lane) in four_rows.into_remainder().chunks_exact_mut(width).zip(lane..) {
        for (to, column) in row.iter_mut().zip(columns) {
            *to = column[lane];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manipulator::batch::lanes::LANES;

    fn value(row: usize, number: usize) -> f64 {
        (100 * number + row) as f64
    }

    /// Every number of rows of a block, and rows with and without a square of four numbers.
    #[test]
    fn columns_become_rows() {
        for width in 0..10 {
            let columns: Vec<Column> =
                (0..width).map(|number| std::array::from_fn(|row| value(row, number))).collect();
            for count in 0..=LANES {
                let mut rows = vec![f64::NAN; count * width];
                write_rows(&columns, &mut rows);
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
                let mut columns = vec![[f64::NAN; LANES]; width + 2];
                let column_of = |number: usize| width - number;
                read_rows(&rows, width, &mut columns, column_of);
                for number in 0..width {
                    let expected: Column =
                        std::array::from_fn(|lane| value(lane.min(count - 1), number));
                    assert_eq!(columns[column_of(number)], expected, "{count} x {width}");
                }
                let others = [&columns[0], &columns[width + 1]];
                assert!(others.into_iter().flatten().all(|value| value.is_nan()));
            }
        }
    }
}
