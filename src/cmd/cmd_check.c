#include <math.h>
#include <string.h>

#include "base/units.h"
#include "cmd/commands.h"
#include "simulator/subject.h"
#include "scene/building.h"
#include "scene/motion_source.h"
#include "settings/settings.h"

typedef struct {
    int n;
    Status fatal; /* no fault of the configuration: nothing more can be said about it */
} Faults;

static int note(Faults *faults, Status status, const char *key, const Err *e)
{
    if (status != STATUS_OK) {
        fprintf(stderr, "%s: %s\n", key, e->text);
        faults->n++;
        faults->fatal = status == STATUS_NO_MEMORY ? status : faults->fatal;
    }
    return status == STATUS_OK;
}

static int check_building(const Settings *s, Faults *faults)
{
    Err e = {0};
    Building b;
    if (!note(faults, building_load(&b, s->building.model, &e), "building.model", &e))
        return 0;
    printf("building  %s: %d floors, first mode %.4f Hz\n", s->building.model, b.n, b.omega[0] / (2 * M_PI));
    building_free(&b);
    return 1;
}

static int check_motion(const Settings *s, Faults *faults)
{
    Err e = {0};
    Motion m = {0};
    Status status = motion_open(&m, &s->motion, &e);
    if (status == STATUS_OK)
        status = motion_prepare(&m, s->motion.pga_g, s->motion.stretch, &e);
    if (!note(faults, status, "motion.record", &e)) {
        motion_free(&m);
        return 0;
    }
    printf("motion    %s: %zu samples, %.4g s, peak %.4g g\n", s->motion.record, m.n, (double)(m.n - 1) * m.dt_s,
           motion_peak(&m) / GRAVITY);
    if (s->sim.duration_s > (double)(m.n - 1) * m.dt_s)
        fprintf(stderr, "sim.duration_s: %g s is longer than the motion; the run ends with the motion\n",
                s->sim.duration_s);
    motion_free(&m);
    return 1;
}

static void check_scene(const Settings *s, Faults *faults)
{
    Err e = {0};
    Subject *subject;
    if (note(faults, subject_open(&subject, s, &e), "scene", &e))
        subject_close(subject);
}

static Status verdict(const Args *args, const Faults *faults, Err *err)
{
    if (faults->fatal != STATUS_OK)
        return fail(err, faults->fatal, "%s: could not be checked", args->operand);
    if (faults->n)
        return fail(err, STATUS_BAD_DATA, "%s: %d fault%s", args->operand, faults->n, faults->n == 1 ? "" : "s");
    printf("%s: everything is in order\n", args->operand);
    return STATUS_OK;
}

/* A problem that is no tower: opened as a search would; workers are not started yet. */
static Status check_other(const Args *args, const Settings *s, Faults *faults, Err *err)
{
    Err e = {0};
    Subject *subject;
    if (faults->n == 0 && note(faults, subject_open(&subject, s, &e), "problem", &e)) {
        const Schema *schema = subject_schema(subject);
        printf("problem   %zu variables, %zu objectives\n", schema->n_var, schema->n_obj);
        subject_close(subject);
    }
    return verdict(args, faults, err);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Faults faults = {0};
    const Status status = args_settings(args, &s, stderr, &faults.n, err);
    if (status == STATUS_MISSING || status == STATUS_USAGE || status == STATUS_NO_MEMORY)
        return status;
    if (s.problem.kind != PROBLEM_TOWER)
        return check_other(args, &s, &faults, err);
    const int building = check_building(&s, &faults);
    const int motion = check_motion(&s, &faults);
    if (building && motion && faults.n == 0)
        check_scene(&s, &faults);
    return verdict(args, &faults, err);
}

static const ArgOption OPTIONS[] = {OPTION_RECORD, OPTION_PGA, OPTION_STRETCH, OPTION_UNIT, OPTION_SET, OPTION_END};

const Command CMD_CHECK = {
    .name = "check",
    .operand = "CONFIG",
    .summary = "everything that is wrong with a configuration",
    .example = "imtet check configs/quick.ini",
    .details = "Reads CONFIG, the building's matrices and the ground motion and names every fault on standard error,\n"
               "not only the first. Exit status 65 if there is any.",
    .options = OPTIONS,
    .run = run,
};
