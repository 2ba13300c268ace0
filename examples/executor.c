/* executor.c -- an executor of one's own: threads that ask for a design each, take their time and tell, while the others
 * go on. The designs are the same at any number of threads.
 *
 *   cc executor.c $(pkg-config --cflags --libs imtet) -lpthread -lm -o executor && ./executor */
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#include <imtet.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>

enum { THREADS = 4, VARIABLES = 4 };

static void rest(long ms)
{
    nanosleep(&(struct timespec){.tv_nsec = ms * 1000000}, NULL);
}

static void evaluate(const double x[], double f[])
{
    rest(1 + (long)(9 * x[0])); /* some designs take longer */
    f[0] = x[0] * x[0] + fabs(x[1]);
    f[1] = (x[0] - 1) * (x[0] - 1) + x[2] * x[2] + x[3] * x[3];
}

static int complain(const imtet_error *error)
{
    fprintf(stderr, "%s\n", error->text);
    return 1;
}

/* Calls of the library exclude each other; evaluations do not. */
static void *work(void *user)
{
    imtet_search *search = user;
    imtet_search_state state = {.size = sizeof state};
    imtet_error error = {0};
    double x[VARIABLES], f[2];
    long id;
    size_t n;
    while (imtet_search_ask(search, 1, &id, x, &n, &error) == IMTET_OK) {
        if (n == 0) { /* done, or answers are to be told first */
            if (imtet_search_look(search, &state, &error) != IMTET_OK || state.done)
                break;
            rest(1);
            continue;
        }
        evaluate(x, f);
        if (imtet_search_tell(search, 1, &id, f, NULL, NULL, &error) != IMTET_OK)
            break;
    }
    if (error.status != IMTET_OK)
        complain(&error);
    return NULL;
}

int main(void)
{
    const char *const settings[] = {"search.max_evals=120", NULL};
    const imtet_search_options options = {
        .size = sizeof options, .variables = VARIABLES, .objectives = 2, .settings = settings};
    imtet_search *search;
    imtet_error error;
    pthread_t thread[THREADS];
    size_t n;
    if (imtet_search_create(&options, &search, &error) != IMTET_OK)
        return complain(&error);
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&thread[i], NULL, work, search) != 0)
            return 1;
    for (int i = 0; i < THREADS; i++)
        pthread_join(thread[i], NULL);
    if (imtet_search_designs(search, IMTET_TOLD, 0, NULL, NULL, NULL, NULL, &n, &error) != IMTET_OK)
        return complain(&error);
    printf("%zu evaluations by %d threads\n", n, THREADS);
    imtet_search_free(&search);
    return 0;
}
