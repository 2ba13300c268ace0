/* rbf/model.h -- what the interpolant is made of; for rbf.c (fit, prediction), tune.c and their test. */
#pragma once

#include "base/status.h"
#include "rbf/kernel.h"

typedef struct Rbf Rbf; /* as in rbf/rbf.h */

typedef enum { RBF_CONSTANT, RBF_LINEAR, RBF_QUADRATIC, RBF_N_TAILS } RbfTail;

/* How one output is modelled. */
typedef struct {
    RbfKernel kernel;
    RbfTail tail;
    double nugget; /* [-] share of the output's variance */
} RbfForm;

/* How one output sees the variables. */
typedef struct {
    double *theta;  /* (n_dim) */
    double warp[2]; /* a, b */
} Shape;

/* The model of one output. */
typedef struct {
    RbfForm form;
    size_t n;           /* centres with a weight, the first ones: all, or a few that leave no error */
    size_t n_tail;      /* columns of the tail really used: fewer when there are too few centres */
    double mean, scale; /* of F: the interpolant is built on (f - mean) / scale */
    double explained;
    int is_left_out; /* it cannot be fitted: its mean stands for it */
    Shape shape;
    double *step;   /* (n_dim + 3) of the logarithms of theta, warp and nugget, with which the last tuning ended */
    double *S;      /* (n_dim + 1, stride) centres, warped and scaled, and their squares (rbf/kernel.h) */
    double *tail;   /* (1 + 2 n_dim) coefficients b */
    double *weight; /* (n_max) w */
    double *leave_one_out; /* (n_max) [unit of f] */
} Output;

/* Work space of one thread for one output; matrices are column-major for LAPACK, lower triangles. */
typedef struct {
    double *C, *S, *Z;   /* centres of the tuning set; scaled; for gradients */
    double *by_a, *by_b; /* (n) derivatives by the warp */
    double *A;           /* (n, n) kernel matrix, its factor, its inverse */
    double *slope;       /* (n, n) of the tuning set: derivatives of the kernel by the squared distance */
    double *P;           /* (n, n_tail + 1) tail basis and data */
    double *M;           /* (n_tail, n_tail) normal matrix of the tail, factored */
    double *b;           /* (n_tail) */
    double *y, *w;       /* (n) data, weights */
    double *noise;       /* (n) variance of each value, in nuggets */
    double *q;           /* (n) diagonal of the projected inverse */
    double *log_p, *best_p, *gradient, *last_gradient, *step, *best_step; /* (n_dim + 3) log of theta, warp, nugget */
    double *theta;                                                        /* (n_dim) of the step under way */
    Shape shape, best_shape;
    RbfForm best_form;
    double min_error, likeliest[RBF_N_TAILS]; /* likeliest: minus its logarithm, of the kernels with each tail */
    size_t n_tail;                            /* columns of the tail in P */
} Worker;

struct Rbf {
    size_t n, n_max, n_dim, n_out, n_workers, n_tail_max;
    size_t stride;  /* n_max or a little more */
    size_t n_tuned; /* calls of rbf_tune */
    double *C;      /* (3, n_dim, stride) centres u, log u, log (1 - u) */
    double *F;      /* (n_out, n_max) */
    double *noise;  /* (n_out, n_max) variance of each value, in nuggets */
    Output *output;
    Worker *worker;
};

/* An output whose mean square leave-one-out error is below this share of its variance is exact, as the mass of a
 * section is: a few centres tell it. */
static const double EXACT_ERROR = 1e-9;
enum { FEW_CENTRES = 100 };

/* S (n_dim + 1, stride): n centres C (3, n_dim, stride) warped and scaled, and their squares. */
void model_scale(const Rbf *m, size_t n, const double C[], const Shape *shape, double S[]);

void model_copy_shape(const Rbf *m, Shape *to, const Shape *from);

/* Points first..first+RBF_BLOCK-1, of n: x (n_dim, RBF_BLOCK); the last one again where there are fewer. */
void model_gather(const Rbf *m, const double S[], size_t first, size_t n, double x[]);

/* Lower triangle of the kernel matrix into k->A (n, n), of centres C scaled to S, with nugget times k->noise (n) on the
 * diagonal; slope (n, n): its derivatives by the squared distances, NULL: not wanted. */
void model_matrix(const Rbf *m, Worker *k, size_t n, const double C[], const double S[], RbfForm form, double slope[]);

/* Factors that matrix in place, raising the nugget by tens where centres are too near each other to tell apart; 0 where
 * that does not help. */
int model_factor(const Rbf *m, Worker *k, size_t n, const double C[], const double S[], RbfForm *form);

/* More centres than coefficients, else a simpler tail. */
size_t model_tail(RbfTail tail, size_t n, size_t n_dim);

/* Generalised least squares for the tail, then the weights, from the factor in k->A and the data in k->y:
 *     V = L^-1 P,  z = L^-1 y,     V'V b = V'z,      L' w = z - V b.
 * Leaves V in k->P, the factor of V'V in k->M. Returns the tail columns used: a variable that no centre moves makes V'V
 * singular and the tail constant. */
size_t model_weights(const Rbf *m, Worker *k, size_t n, const double C[], size_t n_tail);

/* L := inv(L) for lower triangular L with leading dimension ld. */
void model_invert(int n, double L[], int ld);

/* Leave-one-out errors after model_weights, into k->q; spoils A and P. */
void model_leave_one_out(Worker *k, size_t n, size_t n_tail);

/* Centres and values; mean and scale of every output. */
Status model_take(Rbf *m, size_t n, const double X[], const double F[], const double noise[], Err *err);

/* Fits every output with its form and scales to what was taken. */
void model_fit(Rbf *m);
