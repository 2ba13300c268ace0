/* report/words.h -- how pages and pictures call an objective or another measure: short title, unit, factor to that
 * unit.
 *
 *   shown = factor * natural value                    files keep their own names and units (evaluate/measures.h)
 *
 * Threads  pure functions; texts live as long as the program, or as the schema */
#pragma once

#include "evaluate/schema.h"

typedef struct {
    const char *title, *unit; /* unit "": a number */
    double factor;
} Words;

Words words_of_measure(int measure);

/* Of objective k, or of measure k - n_obj; one of another problem than the tower has its name and no unit. */
Words words_of_objective(const Schema *schema, size_t k);

/* What an objective is where it stands for several simulations: "worst of 2 records x 4 replicates"; else empty. */
enum { RULE_WORDS_MAX = 120 };
void words_of_rule(const Settings *s, char text[RULE_WORDS_MAX]);
