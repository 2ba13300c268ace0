/* sim/cvode/vectors.h -- N_Vector operations that the compiler can vectorize; Debian's are not and take two thirds
 * of a run. Threads  no state */
#pragma once

#include <nvector/nvector_serial.h>

/* Its clones have them too. */
void vectors_use_own_loops(N_Vector v);
