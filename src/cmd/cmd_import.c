#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd/commands.h"
#include "scene/building.h"
#include "scene/opensees.h"
#include "settings/settings.h"

/* A fault of the sheets is one of the model, whose tags they have as names: "FOLDER/SHEET:LINE: " becomes "MODEL: ". */
static Status blame(const char *model, const char *folder, const Err *found, Err *err)
{
    const int of_frame = strncmp(found->text, "frame: ", strlen("frame: ")) == 0;
    const int of_sheets = strncmp(found->text, folder, strlen(folder)) == 0;
    const char *text = of_frame || of_sheets ? strstr(found->text + (of_sheets ? strlen(folder) : 0), ": ") : NULL;
    return fail(err, found->code, "%s: %s", model, text ? text + strlen(": ") : found->text);
}

/* What was written, read back as a study reads it. */
static Status sum_up(const char *model, const Frame *f, const char *folder, Err *err)
{
    Settings s;
    Building b;
    Err found = {0};
    settings_defaults(&s);
    snprintf(s.building.model, sizeof s.building.model, "%s", folder);
    if (building_load(&b, &s.building, &found) != STATUS_OK)
        return blame(model, folder, &found, err);
    printf("%s: %d nodes, %d elements, %d sections, %d ties\n", folder, f->n_nodes, f->n_elements, f->n_sections,
           f->n_ties);
    printf("%d floor%s, first period %.4g s; `imtet building %s` has more\n", b.n, b.n == 1 ? "" : "s",
           2 * M_PI / b.omega[0], folder);
    building_free(&b);
    return STATUS_OK;
}

/* Of what an import that failed has made. */
static void remove_folder(const char *folder)
{
    static const char *const SHEETS[] = {"nodes.csv", "sections.csv", "elements.csv", "masses.csv", "ties.csv"};
    for (size_t i = 0; i < sizeof SHEETS / sizeof SHEETS[0]; i++) {
        char path[OPTION_TEXT_MAX + 16];
        snprintf(path, sizeof path, "%s/%s", folder, SHEETS[i]);
        unlink(path);
    }
    rmdir(folder);
}

static Status fill_folder(const char *model, const Frame *f, const char *folder, Err *err)
{
    TRY(frame_write(f, folder, err));
    return sum_up(model, f, folder, err);
}

static Status write_folder(const char *model, const Frame *f, const char *folder, Err *err)
{
    if (strlen(folder) >= OPTION_TEXT_MAX)
        return fail(err, STATUS_USAGE, "%.60s...: the path is too long", folder);
    const int is_new = mkdir(folder, 0777) == 0;
    if (!is_new && errno != EEXIST)
        return fail(err, STATUS_IO, "%s: %s", folder, strerror(errno));
    const Status status = fill_folder(model, f, folder, err);
    if (status != STATUS_OK && is_new)
        remove_folder(folder);
    return status;
}

static Status run(const Args *args, Err *err)
{
    const char *out = args_value(args, "--out"), *word = args_value(args, "--units");
    const ModelUnits *units = word ? model_units(word) : NULL;
    Frame f;
    if (!out)
        return fail(err, STATUS_USAGE, "--out FOLDER is missing");
    if (!units)
        return fail(err, STATUS_USAGE, "--units %s: an OpenSees model says none; give %s", word ? word : "is missing",
                    MODEL_UNITS_WORDS);
    TRY(opensees_read(&f, args->operand, units, stderr, err));
    const Status status = write_folder(args->operand, &f, out, err);
    frame_free(&f);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--out", "FOLDER", NULL, 0, "where nodes.csv, sections.csv, elements.csv ... are written; none may be there"},
    {"--units", "WORD", NULL, 0, "of the model: N_m, kN_m, N_mm, kip_in or kip_ft"},
    OPTION_END,
};

const Command CMD_IMPORT = {
    .name = "import",
    .operand = "MODEL",
    .summary = "an OpenSees model as a plane frame",
    .example = "imtet import model.tcl --units kip_in --out my-tower",
    .details =
        "Reads the elastic part of an OpenSees model in Tcl (2 dimensions, 3 unknowns per node): model, node, fix,\n"
        "mass, equalDOF, geomTransf Linear, element elasticBeamColumn (-mass, -cMass, -release), set, [expr ...] with\n"
        "+ - * / and parentheses. Every other command is refused with its line: remove loads, recorders and\n"
        "analysis first. The folder is what building.model takes (docs/building.md).",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
