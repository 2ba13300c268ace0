/* base/denormal.h -- numbers too small to be normal count as zero between denormal_off and denormal_restore.
 *
 * A response that has died away passes through them, and arithmetic on them is many times slower.
 * Threads  the mode belongs to the calling thread; other processors than x86-64 keep theirs */
#pragma once

/* Returns the mode before, for denormal_restore. */
static inline unsigned denormal_off(void)
{
#ifdef __x86_64__
    enum { FLUSH_TO_ZERO = 0x8000, DENORMALS_ARE_ZERO = 0x0040 };
    const unsigned before = __builtin_ia32_stmxcsr();
    __builtin_ia32_ldmxcsr(before | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO);
    return before;
#else
    return 0;
#endif
}

static inline void denormal_restore(unsigned before)
{
#ifdef __x86_64__
    __builtin_ia32_ldmxcsr(before);
#else
    (void)before;
#endif
}
