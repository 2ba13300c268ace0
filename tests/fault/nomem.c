/* Preloaded into the program under test: the NOMEM_AT-th request for memory after main began is refused, all others are
 * served. With NOMEM_COUNT=FILE the number of requests is written there at the end, behind it the number of refusals.
 *
 * Requests of libgomp, OpenBLAS and the loader are not counted: these end the process by themselves, and no program can
 * have a say in it. Nor are those of SUNDIALS (the engines to compare with), whose N_VClone 6.4 uses what it did not
 * get. */
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

enum { SPARED_MAX = 32 };
static struct {
    uintptr_t from, to;
} spared[SPARED_MAX];
static int n_spared, armed;
static atomic_long count, refused;
static long refuse_at;

static int note_library(struct dl_phdr_info *info, size_t size, void *user)
{
    static const char *const NAMES[] = {"libgomp", "openblas", "ld-linux", "libblas", "liblapack.so", "libsundials"};
    (void)size;
    (void)user;
    for (size_t i = 0; i < sizeof NAMES / sizeof NAMES[0]; i++)
        for (int k = 0; strstr(info->dlpi_name, NAMES[i]) && k < info->dlpi_phnum && n_spared < SPARED_MAX; k++)
            if (info->dlpi_phdr[k].p_type == PT_LOAD && info->dlpi_phdr[k].p_flags & PF_X) {
                spared[n_spared].from = info->dlpi_addr + info->dlpi_phdr[k].p_vaddr;
                spared[n_spared].to = spared[n_spared].from + info->dlpi_phdr[k].p_memsz;
                n_spared++;
            }
    return 0;
}

static int is_refused(const void *caller)
{
    const uintptr_t at = (uintptr_t)caller;
    if (!armed)
        return 0;
    for (int i = 0; i < n_spared; i++)
        if (at >= spared[i].from && at < spared[i].to)
            return 0;
    if (atomic_fetch_add(&count, 1) + 1 != refuse_at)
        return 0;
    atomic_fetch_add(&refused, 1);
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size)
{
    return is_refused(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    return is_refused(__builtin_return_address(0)) ? NULL : __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
    return is_refused(__builtin_return_address(0)) ? NULL : __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return is_refused(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    if (is_refused(__builtin_return_address(0)))
        return ENOMEM;
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}

static int (*real_main)(int, char **, char **);

static int counted_main(int argc, char **argv, char **environment)
{
    const char *at = getenv("NOMEM_AT");
    refuse_at = at ? strtol(at, NULL, 10) : 0;
    unsetenv("LD_PRELOAD"); /* Chromium and workers are served */
    dl_iterate_phdr(note_library, NULL);
    armed = 1;
    const int code = real_main(argc, argv, environment);
    armed = 0;
    return code;
}

typedef int StartFn(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void), void (*)(void),
                    void *);

int __libc_start_main(int (*main)(int, char **, char **), int argc, char **argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void *stack_end);

int __libc_start_main(int (*main)(int, char **, char **), int argc, char **argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void *stack_end)
{
    void *symbol = dlsym(RTLD_NEXT, "__libc_start_main");
    StartFn *start;
    memcpy(&start, &symbol, sizeof start);
    real_main = main;
    return start(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

__attribute__((destructor)) static void tell(void)
{
    const char *path = getenv("NOMEM_COUNT");
    armed = 0;
    FILE *f = path ? fopen(path, "w") : NULL;
    if (!f)
        return;
    fprintf(f, "%ld %ld\n", atomic_load(&count), atomic_load(&refused));
    fclose(f);
}
