/* bench/stability/laws.h -- the contact laws measured: rebound against r, what the clamp removes, what the floor under
 * v0 changes. */
#ifndef IMTET_BENCH_LAWS_H
#define IMTET_BENCH_LAWS_H

/* Writes the page and the curves (either may be NULL) and prints the checks; 1 when a law is not what it should be. */
int laws(const char *page, const char *csv);

#endif
