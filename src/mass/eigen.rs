//! Principal axes of a symmetric matrix.

use glam::{DMat3, DVec3};

/// Turns until nothing is left beside the diagonal; each of them halves the digits that are wrong.
const MOST_SWEEPS: usize = 30;

/// Eigenvalues, in rising order, and unit eigenvectors, right-handed, of a symmetric matrix.
///
/// Jacobi's rotations (Golub and Van Loan, *Matrix Computations*, 8.5): backward stable; vectors of
/// equal values are any basis of their space.
pub(super) fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let mut a = matrix.to_cols_array_2d();
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..MOST_SWEEPS {
        if a[0][1] == 0.0 && a[0][2] == 0.0 && a[1][2] == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    let values = order.map(|i| a[i][i]);
    let [first, second, third] = order.map(|i| DVec3::from_array(vectors[i]));
    let third = if first.cross(second).dot(third) < 0.0 { -third } else { third };
    (values.into(), DMat3::from_cols(first, second, third))
}

/// Turns the plane of two axes so that what couples them vanishes. `vectors` holds one per row.
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    // Of the two angles the smaller; huge θ gives 1/(2θ).
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    let coupled = a[p][q];
    a[p][p] -= t * coupled;
    a[q][q] += t * coupled;
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let r = 3 - p - q;
    let (rp, rq) = (a[r][p], a[r][q]);
    (a[r][p], a[r][q]) = (c * rp - s * rq, s * rp + c * rq);
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    let (vp, vq) = (vectors[p], vectors[q]);
    vectors[p] = std::array::from_fn(|k| c * vp[k] - s * vq[k]);
    vectors[q] = std::array::from_fn(|k| s * vp[k] + c * vq[k]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_diagonal_is_found_again() {
        let turn = DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(1.1);
        for diagonal in [[1.0, 2.0, 5.0], [3.0, 3.0, 1e-9], [2.0, 2.0, 2.0], [0.0, 0.0, 1.0]] {
            let matrix = turn * DMat3::from_diagonal(diagonal.into()) * turn.transpose();
            let (values, axes) = eigen(matrix);
            let mut sorted = diagonal;
            sorted.sort_by(f64::total_cmp);
            assert!((values - DVec3::from(sorted)).abs().max_element() < 1e-14, "{values}");
            assert!((axes.determinant() - 1.0).abs() < 1e-14);
            let back = axes * DMat3::from_diagonal(values) * axes.transpose() - matrix;
            assert!(back.to_cols_array().iter().all(|x| x.abs() < 1e-14), "{diagonal:?}");
        }
    }
}
