// The preconditioner's factor (theory.md, 5, Combination): Q = L L^T = w(M) sum Q_k / q_k^2 and T = L^{-T}.
//
// Each constraint is a sum of rows, Q_k / q_k^2 = sum_r w_r w_r^T, and L takes them one by one: a rank-one update of a
// Cholesky factor. Q itself, whose condition number is the square of L's, is never formed: in float32 that would lose the
// wide directions from a ratio of scales of 3000 on. L is stored by columns, eight entries to a float8.
#ifndef PYLMC_FACTOR
#define PYLMC_FACTOR

#include "charts/tangent.cl"

typedef struct {
    real8 column[COLUMNS][COLUMN_BLOCKS];
    int n;            // coordinates in use
    int constraints;  // M, the constraints present
} Factor;

// A row over all coordinates: one function of the path, differentiated, divided by its width q.
typedef struct {
    real8 block[COLUMN_BLOCKS];
} Row;

real row_entry(const Row *row, int k) { return real8_at(row->block, k); }
real factor_entry(const Factor *factor, int i, int k) { return real8_at(factor->column[k], i); }

// L L^T += row row^T, for a row that is zero before coordinate `first` and a factor whose later columns it may reach.
void factor_add_row(Factor *factor, Row *row, int first) {
    int blocks = (factor->n + LANES - 1) / LANES;
    for (int k = first; k < factor->n; k++) {
        real w = row_entry(row, k);
        if (w == 0.0) continue;
        real diagonal = factor_entry(factor, k, k);
        real updated = sqrt(diagonal * diagonal + w * w);
        // a rotation of (column, row): the row's rest is not taken from the new column, which loses all digits for w >> diagonal
        real s = w / updated, c = diagonal / updated;
        for (int b = k / LANES; b < blocks; b++) {
            real8 column = factor->column[k][b];
            factor->column[k][b] = c * column + s * row->block[b];
            row->block[b] = c * row->block[b] - s * column;
        }
    }
}

// w(M) of the combination rule, and log |det T| = -sum log L_kk.
void factor_finish(Factor *factor) {
#if RULE != RULE_SUM
    real m = (real)max(factor->constraints, 1);
    real weight = RULE == RULE_MEAN ? rsqrt(m) : rsqrt(sqrt(m));  // on L, the root of that on Q
    int blocks = (factor->n + LANES - 1) / LANES;
    for (int k = 0; k < factor->n; k++)
        for (int b = 0; b < blocks; b++) factor->column[k][b] *= weight;
#endif
}

real factor_log_determinant(const Factor *factor) {
    real product_log = 0.0;
    for (int k = 0; k < factor->n; k++) product_log += log(factor_entry(factor, k, k));
    return product_log;
}

// delta = L^{-T} xi: back-substitution.
void factor_solve_transposed(const Factor *factor, const real *xi, real *delta) {
    for (int k = factor->n - 1; k >= 0; k--) {
        real sum = xi[k];
        for (int i = k + 1; i < factor->n; i++) sum -= factor_entry(factor, i, k) * delta[i];
        delta[k] = sum / factor_entry(factor, k, k);
    }
}

// xi = L^T delta.
void factor_apply_transposed(const Factor *factor, const real *delta, real *xi) {
    for (int k = 0; k < factor->n; k++) {
        real sum = 0.0;
        for (int i = k; i < factor->n; i++) sum += factor_entry(factor, i, k) * delta[i];
        xi[k] = sum;
    }
}

// y = L^{-1} g: forward substitution.
void factor_solve(const Factor *factor, const Row *g, real *y) {
    for (int i = 0; i < factor->n; i++) {
        real sum = row_entry(g, i);
        for (int k = 0; k < i; k++) sum -= factor_entry(factor, i, k) * y[k];
        y[i] = sum / factor_entry(factor, i, i);
    }
}

#endif
