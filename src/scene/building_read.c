#include "scene/building_read.h"

#include <unistd.h>

#include "base/linalg.h"
#include "scene/core_beam.h"
#include "scene/sheets.h"

/* ---- matrices ------------------------------------------------------------------------------------------------- */

static Status check_symmetric(int n, double A[], const char *path, Err *err)
{
    double largest = 0;
    for (int i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(A[i]));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) {
            double *lower = &A[i * n + j], *upper = &A[j * n + i];
            if (!(fabs(*lower - *upper) <= 1e-6 * largest))
                return bad_data(err, "%s: not symmetric: row %d column %d is %.9g but row %d column %d is %.9g", path,
                                i + 1, j + 1, *lower, j + 1, i + 1, *upper);
            *lower = *upper = 0.5 * (*lower + *upper);
        }
    const int pivot = linalg_indefinite_at(n, A);
    if (pivot < 0)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to factor %d x %d", path, n, n);
    if (pivot > 0)
        return bad_data(err, "%s: not positive definite: the leading block of %d rows is singular or worse", path,
                        pivot);
    return STATUS_OK;
}

static Status check_square(const Table *t, Err *err)
{
    if (t->n_rows != t->n_cols)
        return bad_data(err, "%s: %zu rows of %zu columns; a square matrix is needed", t->path, t->n_rows, t->n_cols);
    if (t->n_rows > FLOORS_MAX)
        return bad_data(err, "%s: %zu floors; at most %d are supported", t->path, t->n_rows, FLOORS_MAX);
    return check_symmetric((int)t->n_rows, t->values, t->path, err);
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

static const UnitWord STIFFNESS_WORDS[] = {{"N/m", 1}, {"kN/m", 1e3}, {"MN/m", 1e6}, {"kip/in", KIP_PER_IN}, {NULL, 0}};
static const UnitWord MASS_WORDS[] = {{"kg", 1}, {"t", 1e3}, {"kip", KIP_PER_IN}, {NULL, 0}};

/* The first of the words in a line; NULL: none of them. */
static const UnitWord *unit_in(const char *line, size_t length, const UnitWord words[])
{
    static const char APART[] = " \t\r,;:=()[]\"";
    for (const char *at = line, *end = line + length; at < end;) {
        size_t n = 0;
        while (at + n < end && !strchr(APART, at[n]))
            n++;
        for (const UnitWord *w = words; w->word; w++)
            if (strlen(w->word) == n && strncmp(at, w->word, n) == 0)
                return w;
        at += n + 1;
    }
    return NULL;
}

/* The unit that a comment of the file states; NULL: none does. */
static Status header_unit(const char *path, const UnitWord words[], const UnitWord **unit, Err *err)
{
    char *text;
    size_t length;
    Lines l;
    *unit = NULL;
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    const Status status = lines_open(&l, path, text, length, err);
    while (status == STATUS_OK && !*unit && lines_next(&l))
        if (l.from < l.to && *l.from == '#')
            *unit = unit_in(l.from + 1, (size_t)(l.to - l.from) - 1, words);
    free(text);
    return status;
}

/* What the entries of a matrix are multiplied by: as the file says, which building.units must not contradict. */
static Status matrix_factor(const BuildingOptions *o, const char *file, const UnitWord words[], double set,
                            double *factor, Err *err)
{
    char path[600];
    const UnitWord *unit;
    snprintf(path, sizeof path, "%s/%s", o->model, file);
    TRY(header_unit(path, words, &unit, err));
    *factor = unit ? unit->factor : set;
    return !unit || o->units == BUILDING_AUTO || unit->factor == set
               ? STATUS_OK
               : bad_data(err, "%s: says that it is in %s; leave building.units at auto", path, unit->word);
}

/* Of K.csv or M.csv. */
static Status take_matrix(const BuildingOptions *o, const Table *t, const char *file, const UnitWord words[],
                          double set, double A[], Err *err)
{
    double factor = 1;
    if (!model_is_built_in(o->model))
        TRY(matrix_factor(o, file, words, set, &factor, err));
    for (size_t i = 0; i < t->n_rows * t->n_rows; i++)
        A[i] = factor * t->values[i];
    return STATUS_OK;
}

static Status take_matrices(BuildingFiles *b, const BuildingOptions *o, const Table *K, const Table *M, Err *err)
{
    const BuildingUnit unit = building_unit(o->units);
    TRY(check_square(K, err));
    TRY(check_square(M, err));
    if (M->n_rows != K->n_rows)
        return bad_data(err, "%s: %zu floors, but K.csv has %zu", M->path, M->n_rows, K->n_rows);
    TRY(frame_full_make(&b->floors, (int)K->n_rows, err));
    TRY(take_matrix(o, K, "K.csv", STIFFNESS_WORDS, unit.stiffness, b->floors.K, err));
    return take_matrix(o, M, "M.csv", MASS_WORDS, unit.mass, b->floors.M, err);
}

static Status read_matrices(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    Table K, M = {0};
    TRY(model_table(&K, o->model, "K.csv", TABLE_PLAIN, err));
    Status status = model_table(&M, o->model, "M.csv", TABLE_PLAIN, err);
    if (status == STATUS_OK)
        status = take_matrices(b, o, &K, &M, err);
    table_free(&K);
    table_free(&M);
    return status;
}

static Status allocate(BuildingFiles *b, int n, Err *err)
{
    TRY(frame_full_make(&b->floors, n, err));
    b->storey_m = calloc(2 * (size_t)n, sizeof *b->storey_m);
    b->yield_drift = b->storey_m ? b->storey_m + n : NULL;
    return b->storey_m ? STATUS_OK : fail_memory(err, n, "floors");
}

/* ---- storeys -------------------------------------------------------------------------------------------------- */

typedef struct {
    double height, mass, shear, bending, yield_drift; /* [m], [kg], [N/m], [N m2], [-]; 0: not given */
} Storey;

typedef struct {
    int n;
    Storey storey[FLOORS_MAX];
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

static Status take_storey(void *storeys, const SheetRow *r, Err *err)
{
    Storeys *all = storeys;
    if (r->n_rows > FLOORS_MAX)
        return bad_data(err, "%zu storeys; at most %d are supported", r->n_rows, FLOORS_MAX);
    Storey *storey = &all->storey[all->n++];
    storey->height = r->x[0];
    if (storey->height < HEIGHT_MIN_M || storey->height > HEIGHT_MAX_M)
        return bad_data(err, "height_m is %g; a storey has %g to %g m: write metres", storey->height, HEIGHT_MIN_M,
                        HEIGHT_MAX_M);
    TRY(choose(r, 1, "mass_kg and mass_t", &storey->mass, err));
    TRY(choose(r, 3, "stiffness_n_m and stiffness_kn_m", &storey->shear, err));
    TRY(choose(r, 5, "bending_n_m2 and bending_kn_m2", &storey->bending, err));
    storey->yield_drift = r->x[7];
    if (storey->yield_drift > 1)
        return bad_data(err, "yield_drift is %g; it is drift over height, 1 at most", storey->yield_drift);
    if (!(storey->mass > 0))
        return bad_data(err, "has no mass_kg or mass_t");
    const Storey *first = all->storey;
    if ((storey->shear > 0) != (first->shear > 0) || (storey->bending > 0) != (first->bending > 0))
        return bad_data(err, "stiffness or bending is empty here and not in the row of the first storey");
    return storey->shear > 0 || storey->bending > 0
               ? STATUS_OK
               : bad_data(err, "has no stiffness_n_m, stiffness_kn_m, bending_n_m2 or bending_kn_m2");
}

static const SheetForm STOREYS = {"storeys.csv",
                                  take_storey,
                                  {{"height_m", COLUMN_ABOVE_0, NAN},
                                   {"mass_kg", COLUMN_ABOVE_0, 0},
                                   {"mass_t", COLUMN_ABOVE_0, 0},
                                   {"stiffness_n_m", COLUMN_ABOVE_0, 0},
                                   {"stiffness_kn_m", COLUMN_ABOVE_0, 0},
                                   {"bending_n_m2", COLUMN_ABOVE_0, 0},
                                   {"bending_kn_m2", COLUMN_ABOVE_0, 0},
                                   {"yield_drift", COLUMN_ABOVE_0, 0}}};

static void shear_building(int n, const Storey storey[], double K[])
{
    for (int j = 0; j < n; j++) {
        K[j * n + j] += storey[j].shear;
        if (j > 0) {
            K[(j - 1) * n + j - 1] += storey[j].shear;
            K[j * n + j - 1] = K[(j - 1) * n + j] = -storey[j].shear;
        }
    }
}

static Status read_storeys(BuildingFiles *b, const char *folder, Err *err)
{
    Storeys all = {0};
    Beam beam[FLOORS_MAX];
    TRY(sheet_take(&STOREYS, folder, &all, err));
    const int n = all.n;
    TRY(allocate(b, n, err));
    for (int j = 0; j < n; j++) {
        const Storey *s = &all.storey[j];
        beam[j] = (Beam){.EI = s->bending, .kGA = s->shear * s->height, .length = s->height};
    }
    if (all.storey[0].bending > 0)
        TRY(beam_cantilever(n, beam, NULL, b->floors.K, b->floors.M, err));
    else
        shear_building(n, all.storey, b->floors.K);
    memset(b->floors.M, 0, n * n * sizeof *b->floors.M);
    for (int j = 0; j < n; j++) {
        b->floors.M[j * n + j] = all.storey[j].mass;
        b->storey_m[j] = all.storey[j].height;
        b->yield_drift[j] = all.storey[j].yield_drift;
    }
    return STATUS_OK;
}

/* ---- frame ---------------------------------------------------------------------------------------------------- */

/* The floors alone are the first rows; what they do not miss is no model of its own. */
static Status condense_frame(BuildingFiles *b, const Frame *f, Err *err)
{
    const int n = f->n_floors;
    TRY(allocate(b, n, err));
    memcpy(b->storey_m, f->storey_m, n * sizeof *b->storey_m);
    TRY(frame_reduce(f, FRAME_FLOORS, &b->full, err));
    for (int j = 0; j < n; j++) {
        memcpy(b->floors.K + j * n, b->full.K + j * b->full.n, n * sizeof *b->floors.K);
        memcpy(b->floors.M + j * n, b->full.M + j * b->full.n, n * sizeof *b->floors.M);
    }
    if (b->full.n == n)
        frame_full_free(&b->full);
    return STATUS_OK;
}

/* Condensed unless that is there already, and in full where it is asked for. */
static Status read_frame(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    Frame f;
    TRY(frame_read(&f, o, err));
    snprintf(b->note, sizeof b->note, "%s", f.note);
    Status status = b->floors.n ? STATUS_OK : condense_frame(b, &f, err);
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
    int k = 0;
    while (k < KINDS && strcmp(name, FILES[k]) != 0)
        k++;
    return k < KINDS || frame_reads(name);
}

/* Is there one kind of model? */
static Status check_kind(const char *folder, int has[KINDS], Err *err)
{
    const char *found[KINDS + 1] = {0};
    int n = 0;
    for (int k = 0; k < KINDS; k++) {
        has[k] = k == KIND_FRAME ? frame_is(folder) : model_has(folder, FILES[k]);
        if (has[k] && !(k == KIND_M && has[KIND_K]))
            found[n++] = FILES[k];
    }
    if (n > 1)
        return bad_data(err, "%s: holds %s and %s, two kinds of model; leave one of them there", folder, found[0],
                        found[1]);
    if (n == 0 && access(folder, F_OK) == 0)
        return fail(
            err, STATUS_MISSING,
            "%s: holds no building: K.csv and M.csv, or storeys.csv, or nodes.csv, sections.csv and elements.csv",
            folder);
    return STATUS_OK;
}

static Status read_folder(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    int has[KINDS] = {0};
    if (!model_is_built_in(o->model))
        TRY(check_kind(o->model, has, err));
    if (has[KIND_FRAME])
        return read_frame(b, o, err);
    return has[KIND_STOREYS] ? read_storeys(b, o->model, err) : read_matrices(b, o, err);
}

Status building_read(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    memset(b, 0, sizeof *b);
    TRY(read_folder(b, o, err));
    if (o->modes == 0 || b->full.n)
        return STATUS_OK;
    if (!frame_is(o->model))
        return bad_data(err,
                        "building.modes: %s has no more than its floors; only a plane frame (nodes.csv) and guyan have",
                        o->model);
    return read_frame(b, o, err);
}

void building_files_free(BuildingFiles *b)
{
    free(b->storey_m);
    frame_full_free(&b->floors);
    frame_full_free(&b->full);
    memset(b, 0, sizeof *b);
}
