#include "base/linalg.h"

#include <cblas.h>
#include <lapacke.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>

/* Rows of A are columns for LAPACK: the same thing for a symmetric matrix, and no copies are made. */

/* ---- kernels --------------------------------------------------------------------------------------------------- */

/* Of OpenBLAS that is built for several processors: forget the kernels in use; choose again, by the processor or by
 * OPENBLAS_CORETYPE. */
__attribute__((weak)) void gotoblas_dynamic_quit(void);
__attribute__((weak)) void gotoblas_dynamic_init(void);

const char *linalg_kernel_name(void)
{
    return openblas_get_corename();
}

/* As the number of threads that it guards, of the process. */
static struct {
    pthread_mutex_t lock;
    int users, threads;
} single = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* The first user takes the threads of BLAS away, the last one gives them back. */
static void count_users(int change)
{
    pthread_mutex_lock(&single.lock);
    const int is_first = single.users == 0;
    single.users += change;
    if (is_first)
        single.threads = openblas_get_num_threads();
    if (single.threads > 1 && (is_first || single.users == 0))
        openblas_set_num_threads(is_first ? 1 : single.threads);
    pthread_mutex_unlock(&single.lock);
}

void linalg_begin(void)
{
    count_users(1);
}

void linalg_end(void)
{
    count_users(-1);
}

/* The variable is gone again before another process is started, whose BLAS is its own affair. */
int linalg_pin(void)
{
    static const char VARIABLE[] = "OPENBLAS_CORETYPE", PINNED[] = "Haswell";
    openblas_set_num_threads(1); /* simulations run side by side; threads below them would fight for the processors */
#ifdef __x86_64__
    const int can_choose = gotoblas_dynamic_quit && gotoblas_dynamic_init && __builtin_cpu_supports("avx2") &&
                           __builtin_cpu_supports("fma");
#else
    const int can_choose = 0;
#endif
    if (getenv(VARIABLE) || !can_choose || strcmp(linalg_kernel_name(), PINNED) == 0)
        return 1;
    if (setenv(VARIABLE, PINNED, 1) != 0)
        return 0;
    gotoblas_dynamic_quit();
    gotoblas_dynamic_init();
    unsetenv(VARIABLE);
    return 1;
}

/* ---- memory ---------------------------------------------------------------------------------------------------- */

/* Of one thread: the buffer of OpenBLAS (128 MiB), stack (8 MiB) and the C library's arena (128 MiB while it is
 * made). */
static const size_t BYTES_OF_THREAD = (size_t)264 << 20;

/* Of OpenBLAS, which keeps a buffer that was given back for the next call. */
__attribute__((weak)) void *blas_memory_alloc(int unused);
__attribute__((weak)) void blas_memory_free(void *buffer);

Status linalg_room(size_t n_threads, Err *err)
{
    enum { MOST = 64 };
    void *buffer[MOST];
    struct rlimit limit;
    const size_t more = n_threads > 1 ? n_threads - 1 : 1, size = more * BYTES_OF_THREAD;
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return STATUS_OK;
    void *room = mmap(NULL, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED)
        return fail(
            err, STATUS_NO_MEMORY,
            "the address space is limited to %zu MiB (ulimit -v), in which there is no room for the linear algebra "
            "of %zu more thread%s, %zu MiB; raise the limit%s",
            limit.rlim_cur >> 20, more, more > 1 ? "s" : "", size >> 20,
            n_threads > 1 ? ", or take fewer --threads" : "");
    munmap(room, size);
    const size_t n = !blas_memory_alloc || !blas_memory_free ? 0 : MIN_OF(n_threads, MOST);
    for (size_t i = 0; i < n; i++)
        buffer[i] = blas_memory_alloc(0);
    for (size_t i = 0; i < n; i++)
        blas_memory_free(buffer[i]);
    return STATUS_OK;
}

static int lacked_memory(int info)
{
    return info == LAPACK_WORK_MEMORY_ERROR || info == LAPACK_TRANSPOSE_MEMORY_ERROR;
}

/* From so many modes on by divide and conquer: faster, with another rounding, in twice the memory. */
enum { MODES_OF_MANY = 257 };

Status linalg_modes(int n, const double K[], const double M[], double omega[], double phi[], Err *err)
{
    const size_t nn = n * (size_t)n;
    double *A;
    TRY_ROOM(A, 2 * nn, "numbers of two matrices", err);
    double *B = A + nn;
    memcpy(A, K, nn * sizeof *A);
    memcpy(B, M, nn * sizeof *B);
    const int info = n < MODES_OF_MANY ? LAPACKE_dsygv(LAPACK_COL_MAJOR, 1, 'V', 'L', n, A, n, B, n, omega)
                                       : LAPACKE_dsygvd(LAPACK_COL_MAJOR, 1, 'V', 'L', n, A, n, B, n, omega);
    if (info == 0) {
        const double rounding = 1e-12 * fabs(omega[n - 1]);
        for (int i = 0; i < n && omega[0] >= -rounding; i++)
            omega[i] = sqrt(fmax(omega[i], 0.0));
        for (int i = 0; i < n; i++) {
            const double *mode = A + i * n;
            int largest = 0;
            for (int j = 1; j < n; j++)
                if (fabs(mode[j]) > fabs(mode[largest]))
                    largest = j;
            for (int j = 0; j < n; j++)
                phi[j * n + i] = mode[largest] < 0 ? -mode[j] : mode[j];
        }
    }
    free(A);
    if (lacked_memory(info))
        return fail(err, STATUS_NO_MEMORY, "modes: no memory for LAPACK");
    if (info > n)
        return bad_data(err, "modes: the mass matrix is not positive definite (pivot %d)", info - n);
    if (info != 0)
        return fail(err, STATUS_INTERNAL, "modes: LAPACK did not converge (info %d)", info);
    if (omega[0] < 0)
        return bad_data(err, "modes: the stiffness matrix is not positive: lowest w^2 = %g", omega[0]);
    return STATUS_OK;
}

Status linalg_solve_spd(int n, int m, double A[], double B[], Err *err)
{
    int info = LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', n, A, n);
    if (info == 0)
        info = LAPACKE_dpotrs(LAPACK_ROW_MAJOR, 'L', n, m, A, n, B, m);
    if (lacked_memory(info))
        return fail(err, STATUS_NO_MEMORY, "no memory to solve %d x %d equations", n, n);
    if (info != 0)
        return bad_data(err, "a symmetric %d x %d matrix is not positive definite (pivot %d)", n, n, info);
    return STATUS_OK;
}

int linalg_indefinite_at(int n, const double A[])
{
    const size_t nn = n * (size_t)n;
    double *copy = malloc(nn * sizeof *copy);
    if (!copy)
        return -1;
    memcpy(copy, A, nn * sizeof *copy);
    const int info = LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, copy, n);
    free(copy);
    return info;
}

int linalg_factor_band(int n, int band, double A[])
{
    const int info = LAPACKE_dpbtrf(LAPACK_COL_MAJOR, 'L', n, band, A, band + 1);
    return info < 0 ? -1 : info;
}

void linalg_solve_band(int n, int band, const double A[], int m, int stride, double B[])
{
    LAPACKE_dpbtrs(LAPACK_COL_MAJOR, 'L', n, band, m, A, band + 1, B, stride);
}

void linalg_product_of_rows(int n, int m, const double A[], const double B[], double C[])
{
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n, n, m, 1, A, m, B, m, 0, C, n);
}
