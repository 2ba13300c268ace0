/* evaluate/cluster.h -- processes on other machines, as an executor: none in the ordinary program (alone.c), ranks of
 * MPI in imtet_mpi, which is linked with src/mpi instead.
 *
 *   rank 0       is the program: searches, stores, prints
 *   every other  opens the problems of rank 0 again, each from its recipe (evaluate/problem.h), and does their tasks on
 *                threads of its own
 *
 * Life cycle  cluster_join, first thing in main -> executors, or cluster_disband -> cluster_leave, last thing
 * Threads     one executor of the cluster at a time
 * Errors      another version of the program, or another command, on a rank is refused, host and rank named */
#pragma once

#include "evaluate/problem.h"

/* The problem that the recipe is of, with workers of this process; the recipe stays where it is until it is closed. */
typedef Status (*ReopenFn)(Problem *p, const void *recipe, size_t size, Err *err);

enum { CLUSTER_VERSION_MAX = 128 };

/* serves 1: this process was a rank that evaluates, and rank 0 has ended; there is nothing left to do. version: the
 * same bytes in every process that may work with this one. */
Status cluster_join(int *argc, char ***argv, const char version[CLUSTER_VERSION_MAX], ReopenFn reopen, int *serves,
                    Err *err);
void cluster_leave(int exit_code);

/* Rank 0 has nothing to evaluate: all others end, this process goes on alone. */
void cluster_disband(void);

/* NULL: this process is alone, or no rank 0. n_ranks: those that evaluate. */
const Executor *cluster_executor(size_t *n_ranks);
