/* base/filter.h -- Butterworth filter of fourth order without phase shift.
 *
 *   low-pass    |G(f)| = 1 / (1 + (W / Wc)^8)       W = tan(pi f dt): bilinear transform, frequencies warped beforehand
 *   high-pass   |G(f)| = 1 / (1 + (Wc / W)^8)       1/2 at the cutoff; f against fc instead of W where f dt is small
 *
 * two biquads, run forward and then backward: each pass has the root of that gain, their phases cancel.
 *
 * Shapes   x[n][width]: `width` signals side by side, at rest before the first row; rows of zeros behind the signal,
 *          filter_padding of them, take up what rings on (else the end is filtered as if it broke off there)
 * Memory   none is allocated.  Threads  no state
 * Errors   STATUS_BAD_DATA: the cutoff is not between 0 and half the sampling rate
 * Source   A. V. Oppenheim and R. W. Schafer, Discrete-Time Signal Processing, 3rd ed., sections 7.2 and 5.6 */
#pragma once

#include "base/status.h"

enum { FILTER_ORDER = 4, FILTER_SECTIONS = FILTER_ORDER / 2 };

typedef enum { FILTER_LOW_PASS, FILTER_HIGH_PASS } FilterKind;

/* y_k = b0 x_k + b1 x_k-1 + b2 x_k-2 - a1 y_k-1 - a2 y_k-2 */
typedef struct {
    double b0, b1, b2, a1, a2;
} Biquad;

typedef struct {
    Biquad section[FILTER_SECTIONS];
    double cutoff_dt; /* [-] cutoff frequency times step */
} Filter;

Status filter_butterworth(Filter *f, FilterKind kind, double cutoff_hz, double dt_s, Err *err);

/* Rows after which what rings on has decayed to 6e-7: 1.5 FILTER_ORDER / (fc dt), the slowest pole has the decay rate
 * 2 pi fc sin(pi / 8). */
size_t filter_padding(const Filter *f);

/* In place. */
void filter_zero_phase(const Filter *f, size_t n, size_t width, double x[]);

/* Both sections (transposed direct form II) on one value or vector of values; s: their states. */
#define FILTER_STEP(f, x, s)                                                                                           \
    _Pragma("GCC unroll 2") for (int k_ = 0; k_ < FILTER_SECTIONS; k_++)                                               \
    {                                                                                                                  \
        const Biquad *const q_ = &(f)->section[k_];                                                                    \
        const __typeof__(x) in_ = x;                                                                                   \
        x = q_->b0 * in_ + s[k_][0];                                                                                   \
        s[k_][0] = q_->b1 * in_ - q_->a1 * x + s[k_][1];                                                               \
        s[k_][1] = q_->b2 * in_ - q_->a2 * x;                                                                          \
    }
