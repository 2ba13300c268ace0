#include "study/run_simulator.h"

#include "settings/options.h"

void run_simulator_close(RunSimulator *r)
{
    queue_close(r->queue);
    adapter_close(r->adapter);
    *r = (RunSimulator){0};
}

Status run_simulator_open(RunSimulator *r, const Settings *s, const SimOptions *sim, int (*go_on)(void *user),
                          void *user, Err *err)
{
    Settings settings = *s;
    settings.sim = *sim;
    run_simulator_close(r);
    TRY(adapter_open(&r->adapter, &settings, err));
    adapter_observe(r->adapter, &(Observer){.go_on = go_on, .user = user});
    return queue_open(&r->queue, adapter_problem(r->adapter), err);
}
