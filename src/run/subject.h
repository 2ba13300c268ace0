/* run/subject.h -- what is searched: the tower, a simulator of somebody else, or a textbook problem, behind one
 * Problem.
 *
 *   problem.kind = tower      gaps and walls; t_top > t_base is repaired by swapping the two
 *                  external   workers that speak JSON lines (problem/external.h)
 *                  dtlz2      problem/textbook.h, with problem.noise where that is set
 *                  wfg4
 *
 * Limits of the user (search.limits = j3_g<=5,edcs_pct>=3) become constraints: g = (value - limit) / |limit| for <=.
 *
 * Life cycle  subject_open -> search on subject_problem -> subject_close
 * Verdicts    one for each simulation since the last subject_forget, in their order
 * Threads     call it from one thread */
#ifndef IMTET_RUN_SUBJECT_H
#define IMTET_RUN_SUBJECT_H

#include "moga/problem.h"
#include "run/crew.h"
#include "run/schema.h"
#include "run/world.h"

typedef struct Subject Subject;

Status subject_open(Subject **out, const Settings *s, Err *err);
void subject_close(Subject *subject); /* NULL is fine */

const Problem *subject_problem(const Subject *subject);
const Schema *subject_schema(const Subject *subject);
const World *subject_world(const Subject *subject); /* NULL: no tower */
Crew *subject_crew(const Subject *subject);         /* NULL: no tower */
int subject_threads(const Subject *subject);

const Verdict *subject_verdicts(const Subject *subject, size_t *n);
void subject_forget(Subject *subject);

/* Of a textbook problem: the objectives without noise. */
void subject_exact(const Subject *subject, const double x[], double f[]);

#endif
