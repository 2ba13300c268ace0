/* A study without the program: what libimtet.a (base, settings, scene, motion, sim, rbf, moga, evaluate) is linked with alone,
 * neither SQLite nor a server beside it (make lib-alone). */
#include <stdio.h>

#include "evaluate/adapter.h"
#include "settings/settings.h"

int main(void)
{
    Settings s;
    Adapter *adapter;
    Queue *q;
    Finished done;
    Err err = {0};
    settings_defaults(&s);
    s.sim.duration_s = 20;
    Status status = adapter_open(&adapter, &s, &err);
    if (status == STATUS_OK)
        status = queue_open(&q, adapter_problem(adapter), QUEUE_AS_ASKED, 0, &err);
    if (status == STATUS_OK)
        status = queue_ask(q, &(Asked){.x = adapter_problem(adapter)->upper}, &err);
    if (status == STATUS_OK)
        status = queue_next(q, &done, &err);
    if (status == STATUS_OK)
        printf("libimtet alone: %s, j1 %g m\n", outcome_word(done.evaluation->outcome), done.evaluation->f[0]);
    return status_exit_code(status);
}
