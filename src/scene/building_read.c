#include "scene/building_read.h"

#include <unistd.h>

#include "base/linalg.h"
#include "base/text.h"
#include "scene/core_beam.h"
#include "scene/sheets.h"

/* ---- matrices ------------------------------------------------------------------------------------------------- */

/* Is the matrix square, symmetric to rounding, which is removed, and positive definite? */
static Status check_matrix(Table *t, Err *err)
{
    const int n = (int)t->n_rows;
    double *A = t->values, largest = 0;
    if (t->n_rows != t->n_cols)
        return bad_data(err, "%s: %zu rows of %zu columns; a square matrix is needed", t->path, t->n_rows, t->n_cols);
    if (n > FLOORS_MAX)
        return bad_data(err, "%s: %zu floors; at most %d are supported", t->path, t->n_rows, FLOORS_MAX);
    for (int i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(A[i]));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) {
            double *lower = &A[i * n + j], *upper = &A[j * n + i];
            if (!(fabs(*lower - *upper) <= 1e-6 * largest))
                return bad_data(err, "%s: not symmetric: row %d column %d is %.9g but row %d column %d is %.9g",
                                t->path, i + 1, j + 1, *lower, j + 1, i + 1, *upper);
            *lower = *upper = 0.5 * (*lower + *upper);
        }
    const int pivot = linalg_indefinite_at(n, A);
    if (pivot < 0)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to factor %d x %d", t->path, n, n);
    return pivot == 0 ? STATUS_OK
                      : bad_data(err, "%s: not positive definite: the leading block of %d rows is singular or worse",
                                 t->path, pivot);
}

#define INCH       0.0254                   /* m */
#define KIP_PER_IN (4448.2216152605 / INCH) /* N/m; and kip s2/in in kg */

BuildingUnit building_unit(BuildingUnits units)
{
    const BuildingUnit list[] = {
        [BUILDING_AUTO] = {1, 1, 1},
        [BUILDING_N_M_KG] = {1, 1, 1},
        [BUILDING_KN_M_T] = {1e3, 1e3, 1},
        [BUILDING_KN_M_KG] = {1e3, 1, 1},
        [BUILDING_N_M_T] = {1, 1e3, 1},
        [BUILDING_MN_M_T] = {1e6, 1e3, 1},
        [BUILDING_KIP_IN] = {KIP_PER_IN, KIP_PER_IN, INCH},
        [BUILDING_N_MM_T] = {1e3, 1e3, 1e-3},
        [BUILDING_KIP_FT] = {KIP_PER_IN / 12, KIP_PER_IN / 12, 12 * INCH},
    };
    return list[units];
}

/* ---- units of a header ---------------------------------------------------------------------------------------- */

typedef struct {
    const char *word;
    double factor;
} UnitWord;

static const UnitWord WORDS[][5] = {{{"N/m", 1}, {"kN/m", 1e3}, {"MN/m", 1e6}, {"kip/in", KIP_PER_IN}, {NULL, 0}},
                                    {{"kg", 1}, {"t", 1e3}, {"kip", KIP_PER_IN}, {NULL, 0}}};

/* What the entries of a matrix are multiplied by: as the first of the words in a comment of the file says, which
 * building.units, `set`, must not contradict. */
static Status matrix_factor(const BuildingOptions *o, const char *path, const UnitWord words[], double set,
                            double *factor, Err *err)
{
    const UnitWord *unit = NULL;
    char *text;
    size_t length;
    Lines l;
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    const Status status = lines_open(&l, path, text, length, err);
    while (status == STATUS_OK && !unit && lines_next(&l))
        for (const char *p = l.from + 1; l.from < l.to && *l.from == '#' && p <= l.to && !unit;) {
            const Cell c = cell_next(&p, l.to, " ,;:=()[]");
            for (const UnitWord *w = words; w->word && !unit; w++)
                if (strlen(w->word) == (size_t)(c.to - c.from) && strncmp(c.from, w->word, strlen(w->word)) == 0)
                    unit = w;
        }
    free(text);
    *factor = unit ? unit->factor : set;
    return !unit || o->units == BUILDING_AUTO || unit->factor == set
               ? status
               : bad_data(err, "%s: says that it is in %s; leave building.units at auto", path, unit->word);
}

/* Reads K.csv and M.csv, of one size. */
static Status read_matrices(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    static const char *const NAMES[] = {"K.csv", "M.csv"};
    const BuildingUnit unit = building_unit(o->units);
    Table t[2] = {0};
    Status s = model_table(&t[0], o->model, NAMES[0], TABLE_PLAIN, err);
    THEN(s, model_table(&t[1], o->model, NAMES[1], TABLE_PLAIN, err));
    THEN(s, check_matrix(&t[0], err));
    THEN(s, check_matrix(&t[1], err));
    if (s == STATUS_OK && t[1].n_rows != t[0].n_rows)
        s = bad_data(err, "%s: %zu floors, but K.csv has %zu", t[1].path, t[1].n_rows, t[0].n_rows);
    THEN(s, frame_full_make(&b->floors, (int)t[0].n_rows, err));
    for (int i = 0; i < 2 && s == STATUS_OK; i++) {
        double *A = i ? b->floors.M : b->floors.K, factor = 1;
        if (!model_is_built_in(o->model))
            s = matrix_factor(o, t[i].path, WORDS[i], i ? unit.mass : unit.stiffness, &factor, err);
        for (size_t k = 0; k < t[i].n_rows * t[i].n_rows; k++)
            A[k] = factor * t[i].values[k];
    }
    table_free(&t[0]);
    table_free(&t[1]);
    return s;
}

static Status allocate(BuildingFiles *b, int n, Err *err)
{
    TRY(frame_full_make(&b->floors, n, err));
    TRY_ROOM(b->storey_m, 2 * n, "floors", err);
    b->yield_drift = b->storey_m + n;
    return STATUS_OK;
}

/* ---- storeys -------------------------------------------------------------------------------------------------- */

typedef struct {
    BuildingFiles *b; /* room is made at the first row */
    int shears, bends;
    Beam beam[FLOORS_MAX];
    double mass_kg[FLOORS_MAX]; /* of the floors */
} Storeys;

/* Of two columns that differ by a factor of a thousand the one that is there. */
static Status choose(const SheetRow *r, int plain, const char *names, double *value, Err *err)
{
    *value = *r->word[plain] ? r->x[plain] : 1e3 * r->x[plain + 1];
    return *r->word[plain] && *r->word[plain + 1] ? bad_data(err, "has both %s; leave one of them out", names)
                                                  : STATUS_OK;
}

/* As in building.heights_m; what is implausible within them is warned of (scene/summary.h). */
static const double HEIGHT_MIN_M = 0.1, HEIGHT_MAX_M = 100;

/* Checks a row of storeys.csv and keeps it. */
static Status add_storey(void *storeys, const SheetRow *r, Err *err)
{
    Storeys *all = storeys;
    const int n = (int)r->n_rows, j = (int)r->row;
    const double height = r->x[0];
    double shear, bending;
    if (r->n_rows > FLOORS_MAX)
        return bad_data(err, "%zu storeys; at most %d are supported", r->n_rows, FLOORS_MAX);
    if (height < HEIGHT_MIN_M || height > HEIGHT_MAX_M)
        return bad_data(err, "height_m is %g; a storey has %g to %g m: write metres", height, HEIGHT_MIN_M,
                        HEIGHT_MAX_M);
    TRY(choose(r, 1, "mass_kg and mass_t", &all->mass_kg[j], err));
    TRY(choose(r, 3, "stiffness_n_m and stiffness_kn_m", &shear, err));
    TRY(choose(r, 5, "bending_n_m2 and bending_kn_m2", &bending, err));
    if (r->x[7] > 1)
        return bad_data(err, "yield_drift is %g; it is drift over height, 1 at most", r->x[7]);
    if (!(all->mass_kg[j] > 0))
        return bad_data(err, "has no mass_kg or mass_t");
    if (j == 0) {
        TRY(allocate(all->b, n, err));
        all->shears = shear > 0;
        all->bends = bending > 0;
    }
    if ((shear > 0) != all->shears || (bending > 0) != all->bends)
        return bad_data(err, "stiffness or bending is empty here and not in the row of the first storey");
    all->b->storey_m[j] = height;
    all->b->yield_drift[j] = r->x[7];
    all->beam[j] = (Beam){.EI = bending, .kGA = shear * height, .length = height};
    storey_spring(n, j, all->bends ? 0 : shear, all->b->floors.K);
    return all->shears || all->bends
               ? STATUS_OK
               : bad_data(err, "has no stiffness_n_m, stiffness_kn_m, bending_n_m2 or bending_kn_m2");
}

static const SheetForm STOREYS = {"storeys.csv",
                                  add_storey,
                                  {{"height_m", COLUMN_ABOVE_0, NAN},
                                   {"mass_kg", COLUMN_ABOVE_0, 0},
                                   {"mass_t", COLUMN_ABOVE_0, 0},
                                   {"stiffness_n_m", COLUMN_ABOVE_0, 0},
                                   {"stiffness_kn_m", COLUMN_ABOVE_0, 0},
                                   {"bending_n_m2", COLUMN_ABOVE_0, 0},
                                   {"bending_kn_m2", COLUMN_ABOVE_0, 0},
                                   {"yield_drift", COLUMN_ABOVE_0, 0}}};

void storey_spring(int n, int j, double spring, double K[])
{
    K[j * n + j] += spring;
    if (j > 0) {
        K[(j - 1) * n + j - 1] += spring;
        K[j * n + j - 1] -= spring;
        K[(j - 1) * n + j] -= spring;
    }
}

/* Makes the matrices of a shear building, or of a cantilever where storeys bend. */
static Status read_storeys(BuildingFiles *b, const char *folder, Err *err)
{
    Storeys all = {.b = b};
    TRY(sheet_read(&STOREYS, folder, &all, err));
    const int n = b->floors.n;
    if (all.bends)
        TRY(beam_cantilever(n, all.beam, NULL, b->floors.K, b->floors.M, err));
    memset(b->floors.M, 0, n * n * sizeof *b->floors.M);
    for (int j = 0; j < n; j++)
        b->floors.M[j * n + j] = all.mass_kg[j];
    return STATUS_OK;
}

/* ---- frame ---------------------------------------------------------------------------------------------------- */

/* Condensed unless that is there already, and in full where it is asked for. */
static Status read_frame(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    Frame f;
    TRY(frame_read(&f, o, err));
    const int n = f.n_floors;
    Status status = STATUS_OK;
    text_copy(b->note, f.note);
    if (b->floors.n == 0) {
        status = allocate(b, n, err);
        if (status == STATUS_OK) {
            memcpy(b->storey_m, f.storey_m, n * sizeof *b->storey_m);
            status = frame_reduce(&f, FRAME_FLOORS, &b->full, err);
        }

        /* The floors alone are the first rows; what they do not miss is no model of its own. */
        for (int j = 0; j < n && status == STATUS_OK; j++) {
            memcpy(b->floors.K + j * n, b->full.K + j * b->full.n, n * sizeof *b->floors.K);
            memcpy(b->floors.M + j * n, b->full.M + j * b->full.n, n * sizeof *b->floors.M);
        }
        if (b->full.n == n)
            frame_full_free(&b->full);
        if (f.has_no_heights) {
            free(b->storey_m);
            b->storey_m = b->yield_drift = NULL;
        }
    }
    if (status == STATUS_OK && o->modes > 0) {
        frame_full_free(&b->full);
        status = frame_reduce(&f, FRAME_FULL, &b->full, err);
    }
    frame_free(&f);
    return status;
}

/* ---- the folder ----------------------------------------------------------------------------------------------- */

/* The files that say which kind of model a folder holds. */
enum { KIND_FRAME, KIND_STOREYS, KIND_K, KIND_M, KINDS };
static const char *const FILES[KINDS] = {"nodes.csv", "storeys.csv", "K.csv", "M.csv"};

int building_reads(const char *name)
{
    return index_of_word(name, FILES, KINDS) < KINDS || frame_reads(name);
}

Status building_read(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    const char *folder = o->model, *found[KINDS + 1] = {0};
    int has[KINDS] = {0}, n = 0;
    memset(b, 0, sizeof *b);

    /* Is there one kind of model? */
    for (int k = 0; k < KINDS && !model_is_built_in(folder); k++) {
        has[k] = k == KIND_FRAME ? frame_is(folder) : model_has(folder, FILES[k]);
        if (has[k] && !(k == KIND_M && has[KIND_K]))
            found[n++] = FILES[k];
    }
    if (n > 1)
        return bad_data(err, "%s: holds %s and %s, two kinds of model; leave one of them there", folder, found[0],
                        found[1]);
    if (n == 0 && !model_is_built_in(folder) && access(folder, F_OK) == 0)
        return fail(
            err, STATUS_MISSING,
            "%s: holds no building: K.csv and M.csv, or storeys.csv, or nodes.csv, sections.csv and elements.csv",
            folder);
    TRY(has[KIND_FRAME]     ? read_frame(b, o, err)
        : has[KIND_STOREYS] ? read_storeys(b, folder, err)
                            : read_matrices(b, o, err));
    if (o->modes == 0 || b->full.n)
        return STATUS_OK;
    if (!frame_is(folder))
        return bad_data(err,
                        "building.modes: %s has no more than its floors; only a plane frame (nodes.csv) and guyan have",
                        folder);
    return read_frame(b, o, err);
}

void building_files_free(BuildingFiles *b)
{
    free(b->storey_m);
    frame_full_free(&b->floors);
    frame_full_free(&b->full);
    memset(b, 0, sizeof *b);
}
