/* base/clones.h -- functions compiled once per vector width; the loader chooses by the processor.
 *
 *   CLONED      x86-64-v4 (AVX-512), x86-64-v3 (AVX2), any
 *   CLONED_V3   x86-64-v3, any: kernels written in vectors of four doubles
 *
 * The choice runs before sanitizers are set up, and clang has another syntax: there, one version for any processor. */
#pragma once

#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CLONED    __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define CLONED_V3 __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define CLONED
#define CLONED_V3
#endif
