/* simulator/subject.h -- what is searched: the tower, a simulator of somebody else, or a textbook problem, behind one
 * Problem.
 *
 *   problem.kind = tower      gaps and walls; t_top > t_base is repaired by swapping the two; every design is as many
 *                             simulations as sim.replicates and motion.records ask for (simulator/trial.h)
 *                  external   workers that speak JSON lines (simulator/external.h)
 *                  dtlz2 ...  simulator/textbook.h, with problem.noise where that is set
 *
 * Limits of the user (search.limits = j3_g<=5,edcs_pct>=3) become constraints: g = (value - limit) / |limit| for <=.
 *
 * Life cycle  subject_open -> search on subject_problem -> subject_close
 * Observer    hears of every simulation as soon as it is done, may stop a batch, and may know results from before
 * Threads     call it from one thread; `go_on` is asked from several, calls of `done` exclude each other */
#ifndef IMTET_SIMULATOR_SUBJECT_H
#define IMTET_SIMULATOR_SUBJECT_H

#include "moga/problem.h"
#include "simulator/crew.h"
#include "simulator/schema.h"
#include "simulator/trial.h"

typedef struct Settings Settings;

typedef struct Subject Subject;

Status subject_open(Subject **out, const Settings *s, Err *err);
void subject_close(Subject *subject); /* NULL is fine */

const Problem *subject_problem(const Subject *subject);
const Schema *subject_schema(const Subject *subject);
const World *subject_world(const Subject *subject); /* NULL: no tower */
size_t subject_n_records(const Subject *subject);   /* 0: no tower */
const World *subject_record(const Subject *subject, size_t i);
Crew *subject_crew(const Subject *subject); /* NULL: no tower */
int subject_threads(const Subject *subject);

/* One finished simulation; valid during the call. */
typedef struct {
    size_t number;       /* of the design: 1, 2, ... in the order in which the search asked; asynchronous: of results */
    const double *x, *f; /* (n_var); (n_obj) in natural signs, not finite where it failed */
    const double *spread; /* (n_obj) standard deviations, NAN where not known */
    double violation;     /* of the user's limits, sum of max(0, g) */
    int ok;
    const Verdict *verdict;
} Simulation;

typedef struct {
    int (*go_on)(void *user); /* 0: what is under way is finished or dropped, and STATUS_STOPPED ends the search */
    Status (*done)(const Simulation *simulation, void *user, Err *err);
    /* Whether design `number` = x was simulated before: f (n_obj, natural) and its verdict are filled then. */
    int (*recall)(size_t number, const double x[], double f[], Verdict *verdict, void *user);
    void *user;
} Observer;

/* Any of the functions may be NULL. n_done: how many simulations were made before. The observer is copied. */
void subject_observe(Subject *subject, const Observer *observer, size_t n_done);

/* Minimised objectives F (n, n_obj) and limits G (n, n_con) of natural values. */
void subject_judge(const Subject *subject, size_t n, const double natural[], double F[], double G[]);

/* Of a textbook problem: the objectives without noise. */
void subject_exact(const Subject *subject, const double x[], double f[]);

#endif
