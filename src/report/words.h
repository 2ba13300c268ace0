/* report/words.h -- how pages call an objective of any problem (of a measure: evaluate/measures.h), and a rule.
 *
 * Threads  pure functions; texts live as long as the program, or as the schema */
#pragma once

#include "evaluate/schema.h"

/* Of objective k, or of measure k - n_obj; one of another problem than the tower has its name and no unit. */
Words words_of_objective(const Schema *schema, size_t k);

/* What an objective is where it stands for several simulations: "worst of 2 records x 4 replicates"; else empty. */
enum { RULE_WORDS_MAX = 120 };
void words_of_rule(const Settings *s, char text[RULE_WORDS_MAX]);
