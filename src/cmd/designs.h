/* cmd/designs.h -- designs and results on the command line, by the same words in every command that takes them.
 *
 *   FILE          a design file (scene/design.h), all of its rows; or a table of designs of a run (front.csv, with a
 *                 column id), of which what is no variable is left out
 *   FILE:N        one of them: that of id N, in a file without ids the N-th row
 *   RUN:ID        any design of a run, on its front or not; RUN is its folder, or run.sqlite in it
 *   RUN:knee      of its front; RUN:best_j1_m likewise; RUN alone: its knee
 *
 * Of a command on a run also ID, knee, best_NAME alone: a design of that run.
 * Errors  what is neither is named with the nearest that is there; STATUS_UNMET where a front is empty by its limits */
#pragma once

#include "base/json.h"
#include "scene/design.h"
#include "store/run.h"

#define DESIGN_WORDS  "FILE, FILE:N (row or id), RUN:ID, RUN:knee or RUN:best_NAME"
#define DESIGN_OF_RUN "an id of the run, knee or best_NAME; FILE:N, OTHER:ID"

/* A measure of an unpredictable design as the run knows it; sd 0: unknown. */
typedef struct {
    double value, sd;
} Known;
void known_of_run(const Run *run, size_t row, Known known[]);

/* The larger of sd (N_MEASURES) and the known one where the result has the known value within that: a run has simulated
 * more copies than sd comes from. */
void known_raise(const Known known[], const SimResult *r, double sd[]);

/* For design_free. space: of the building and the settings that they are for. Of a design of a run, where settings are
 * given, it is said on standard error whether a ground motion that both have has changed since; as_known: also the
 * steps by which the run knows it (run_steps), into s->sim; and known (N_MEASURES, zeroed). NULL: not wanted. */
Status designs_take(Designs *d, const char *word, const DesignSpace *space, Settings *s, int as_known, Known known[],
                    Err *err);

/* Reads one design; a file of several is refused. */
Status designs_take_one(Designs *d, const char *word, const DesignSpace *space, Settings *s, int as_known,
                        Known known[], Err *err);

/* Reads designs of another problem than the tower: a file has a column for every variable, in any order, with words of
 * choices; FILE:ROW chooses one of them. */
Status designs_of_problem(Designs *d, const char *word, const Schema *schema, Err *err);

long design_number(const Designs *d, size_t i); /* as the run numbers it, else that of its row, from 1 */

/* Label of design i in a table: "design 417" of a run or a table with ids, else "my.csv:1"; without designs "no
 * core". */
enum { DESIGN_LABEL_MAX = 160 };
void design_label(const Designs *d, const char *word, size_t i, char label[DESIGN_LABEL_MAX]);

/* A row of the run. A word that leads elsewhere (a file, another run) names that of the run's designs which has the
 * same variables; where none has, elsewhere holds the design, for design_free, and row is run->table.n.
 * elsewhere NULL: such a design is refused. */
Status design_of_run(const Run *run, const char *word, size_t *row, Designs *elsewhere, Err *err);

/* ---- results by name: NAME=NUMBER, and lists of it ------------------------------------------------------------- */

/* "NAME=NUMBER" of any result: *k counts on behind n_obj. */
Status pair_take(const Schema *schema, const char *option, const char *text, size_t *k, double *value, Err *err);

/* Into values (n_obj); those that are not named are left as they are. "NAME" alone is NAME=otherwise, and refused where
 * that is NAN. */
Status pairs_take(const Schema *schema, const char *option, const char *list, double otherwise, double values[],
                  Err *err);

/* None negative, and not all of them 0. */
Status weights_check(const Schema *schema, const char *option, const double weights[], Err *err);

/* A design of a run in a table for people, with its likely errors, or its standard deviations where it cannot be
 * predicted or has replicates. */
void figures_of_run(json_t *table, const Run *run, const char *label, size_t row);
