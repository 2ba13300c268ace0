/* store/provenance.h -- what a run was made of: program, compiler, libraries, machine, inputs.
 * Threads  call it from one thread. */
#pragma once

#include <jansson.h>

#include "evaluate/adapter.h"

typedef struct Settings Settings;

const char *program_version(void);  /* 0.2.0 */
const char *program_revision(void); /* as git describes it, or unknown */

/* Version and revision, instruction set, and a hash of compiler, flags and libraries: where two are the same, so are
 * the numbers of both. */
void program_identity(size_t n, char text[]);

/* Version, revision, compiler and its flags, libraries. NULL: out of memory. */
json_t *program_description(void);

/* As JSON, to be freed by the caller. model: how it was chosen, which is taken; NULL: it was given. */
Status provenance_text(char **out, const Settings *s, const Adapter *adapter, json_t *model, Err *err);

/* Inputs of a run beside its settings: hashes of the first record, of all records together, of the forces, and of
 * the matrices; 0 where there are none. */
typedef struct {
    uint64_t record, records, forces, matrices;
} Inputs;

/* The hash of several files in their order, from the hash of each: FNV-1a, a word at a time; begins with 0. */
uint64_t provenance_add_hash(uint64_t so_far, uint64_t file_hash);
uint64_t provenance_hash(const char *provenance, const char *input); /* in that JSON; 0: none */
void provenance_blas(const char *provenance, char name[32]);         /* linalg_kernel_name then; empty: unknown */
Status provenance_inputs(Inputs *out, const Adapter *adapter, Err *err);
