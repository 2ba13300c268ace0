/* tests/fuzz/targets.h -- what reads bytes that somebody else wrote, one function for each door.
 *
 * Each takes any bytes; whatever they are, it must come back soon, with memory bounded by their number, and with
 * nothing broken or leaked. `make fuzz` drives them by libFuzzer, tests/test_fuzz_corpus.c replays the corpus without
 * it. */
#pragma once

#include <stddef.h>
#include <stdint.h>

void fuzz_settings(const uint8_t *data, size_t size);   /* a settings file */
void fuzz_motion(const uint8_t *data, size_t size);     /* a ground motion of any kind, told by its content */
void fuzz_instrument(const uint8_t *data, size_t size); /* the same with a gain: miniSEED, SAC; then processed */
void fuzz_archive(const uint8_t *data, size_t size);    /* the same, from zip, tar and what packs them */
void fuzz_table(const uint8_t *data, size_t size);      /* CSV: numbers with and without a header, and designs */
void fuzz_worker(const uint8_t *data, size_t size);     /* first line: a command; the rest: what a worker answers */

void fuzz_database(const uint8_t *data, size_t size); /* the database of a run */
void fuzz_cells(const uint8_t *data, size_t size);    /* what its cells hold, parted by bytes of 30 */

#define FUZZ_LIST(X)                                                                                                   \
    X(settings)                                                                                                        \
    X(motion)                                                                                                          \
    X(instrument)                                                                                                      \
    X(archive)                                                                                                         \
    X(table)                                                                                                           \
    X(worker)                                                                                                          \
    X(database)                                                                                                        \
    X(cells)
