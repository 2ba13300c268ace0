/* ask_tell.c -- the Pareto front of a function of one's own, by 200 evaluations of it.
 *
 *   cc ask_tell.c $(pkg-config --cflags --libs imtet) -lm -o ask_tell && ./ask_tell */
#include <imtet.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { VARIABLES = 6, OBJECTIVES = 2, BATCH = 8 };

/* ZDT1: f2 = g (1 - sqrt(f1 / g)), on the front g = 1. No result for f1 of exactly 0.5, say. */
static const char *evaluate(const double x[], double f[])
{
    double g = 1.0;
    for (int j = 1; j < VARIABLES; j++)
        g += 9.0 * x[j] / (VARIABLES - 1);
    f[0] = x[0];
    f[1] = g * (1.0 - sqrt(f[0] / g));
    return x[0] == 0.5 ? "did not converge" : NULL;
}

static int complain(const imtet_error *error)
{
    fprintf(stderr, "%s\n", error->text);
    return 1;
}

int main(void)
{
    static double X[1000 * VARIABLES], F[1000 * OBJECTIVES];
    const char *const settings[] = {"search.max_evals=200", "search.seed=1", NULL}, *failed[BATCH];
    long ids[BATCH];
    size_t n;
    imtet_error error;
    imtet_search *search;
    imtet_search_options options = {
        .size = sizeof options, .variables = VARIABLES, .objectives = OBJECTIVES, .settings = settings};
    if (imtet_search_create(&options, &search, &error) != IMTET_OK)
        return complain(&error);
    while (imtet_search_ask(search, BATCH, ids, X, &n, &error) == IMTET_OK && n > 0) {
        for (size_t i = 0; i < n; i++)
            failed[i] = evaluate(X + i * VARIABLES, F + i * OBJECTIVES);
        if (imtet_search_tell(search, n, ids, F, NULL, failed, &error) != IMTET_OK)
            return complain(&error);
    }
    if (error.status != IMTET_OK ||
        imtet_search_designs(search, IMTET_FRONT, 1000, NULL, X, F, NULL, &n, &error) != IMTET_OK)
        return complain(&error);
    double worst = 0.0;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, F[i * OBJECTIVES + 1] - (1.0 - sqrt(F[i * OBJECTIVES])));
    printf("%zu designs on the front, none farther than %.3f above that of the textbook\n", n, worst);
    imtet_search_free(&search);
    return 0;
}
