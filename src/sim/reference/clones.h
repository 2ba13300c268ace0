/* sim/reference/clones.h -- CLONED: a function compiled once per vector width and chosen when the program is loaded, so
 * that the reference engines' loops are not held back by a portable build. */
#ifndef IMTET_SIM_REFERENCE_CLONES_H
#define IMTET_SIM_REFERENCE_CLONES_H

#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CLONED __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CLONED
#endif

#endif
