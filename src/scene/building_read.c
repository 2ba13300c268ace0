#include "scene/building_read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/linalg.h"
#include "base/csv.h"
#include "scene/beam.h"
#include "scene/compiled_in.h"

/* ---- matrices ------------------------------------------------------------------------------------------------- */

static Status read_matrix(Table *t, const char *model, const char *file, char path[], size_t size, Err *err)
{
    const CompiledIn own = compiled_in(model, file);
    snprintf(path, size, "%s/%s", model, file);
    return own.text ? table_parse(t, path, own.text, own.length, 0, err) : table_read(t, path, 0, err);
}

static Status check_symmetric(int n, double A[], const char *path, Err *err)
{
    double largest = 0;
    for (int i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(A[i]));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) {
            double *lower = &A[i * n + j], *upper = &A[j * n + i];
            if (!(fabs(*lower - *upper) <= 1e-6 * largest))
                return fail(err, STATUS_BAD_DATA,
                            "%s: not symmetric: row %d column %d is %.9g but row %d column %d is %.9g", path, i + 1,
                            j + 1, *lower, j + 1, i + 1, *upper);
            *lower = *upper = 0.5 * (*lower + *upper);
        }
    const int pivot = linalg_indefinite_at(n, A);
    if (pivot < 0)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to factor %d x %d", path, n, n);
    if (pivot > 0)
        return fail(err, STATUS_BAD_DATA,
                    "%s: not positive definite: the leading block of %d rows is singular or worse", path, pivot);
    return STATUS_OK;
}

static Status load_matrix(const char *model, const char *file, double **A, int *n, Err *err)
{
    Table t;
    char path[600];
    TRY(read_matrix(&t, model, file, path, sizeof path, err));
    Status s = STATUS_OK;
    if (t.n_rows != t.n_cols)
        s = fail(err, STATUS_BAD_DATA, "%s: %zu rows of %zu columns; a square matrix is needed", path, t.n_rows,
                 t.n_cols);
    else if (t.n_rows > FLOORS_MAX)
        s = fail(err, STATUS_BAD_DATA, "%s: %zu floors; at most %d are supported", path, t.n_rows, FLOORS_MAX);
    else
        s = check_symmetric((int)t.n_rows, t.values, path, err);
    if (s == STATUS_OK) {
        *A = t.values;
        *n = (int)t.n_rows;
        t.values = NULL;
    }
    table_free(&t);
    return s;
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

static void multiply(int n, double A[], double factor)
{
    for (int i = 0; i < n * n && factor != 1; i++)
        A[i] *= factor;
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
    *unit = NULL;
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    for (const char *line = text, *stop = text + length; line < stop && !*unit;) {
        const char *end = memchr(line, '\n', (size_t)(stop - line));
        end = end ? end : stop;
        const char *from = line + (stop - line > 3 && memcmp(line, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
        while (from < end && (*from == ' ' || *from == '\t'))
            from++;
        if (from < end && *from == '#')
            *unit = unit_in(from + 1, (size_t)(end - from - 1), words);
        line = end + 1;
    }
    free(text);
    return STATUS_OK;
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
               : fail(err, STATUS_BAD_DATA, "%s: says that it is in %s; leave building.units at auto", path,
                      unit->word);
}

static Status read_matrices(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    double stiffness = 1, mass = 1;
    int n_mass = 0;
    TRY(load_matrix(o->model, "K.csv", &b->K, &b->n, err));
    TRY(load_matrix(o->model, "M.csv", &b->M, &n_mass, err));
    if (n_mass != b->n)
        return fail(err, STATUS_BAD_DATA, "%s/M.csv: %d floors, but K.csv has %d", o->model, n_mass, b->n);
    if (is_compiled_in(o->model))
        return STATUS_OK;
    TRY(matrix_factor(o, "K.csv", STIFFNESS_WORDS, building_unit(o->units).stiffness, &stiffness, err));
    TRY(matrix_factor(o, "M.csv", MASS_WORDS, building_unit(o->units).mass, &mass, err));
    multiply(b->n, b->K, stiffness);
    multiply(b->n, b->M, mass);
    return STATUS_OK;
}

static Status allocate(BuildingFiles *b, int n, Err *err)
{
    const size_t nn = (size_t)n * (size_t)n;
    b->n = n;
    b->K = calloc(nn, sizeof *b->K);
    b->M = calloc(nn, sizeof *b->M);
    b->storey_m = calloc((size_t)n, sizeof *b->storey_m);
    return b->K && b->M && b->storey_m ? STATUS_OK
                                       : fail(err, STATUS_NO_MEMORY, "building: no memory for %d floors", n);
}

/* The sheets that say which kind of model a folder holds. */
enum { KIND_FRAME, KIND_STOREYS, KIND_K, KIND_M, KINDS };
static const char *const SHEETS[KINDS] = {"nodes.csv", "storeys.csv", "K.csv", "M.csv"};

enum { PATH_SIZE = 600 };
static void sheet_path(const char *folder, int kind, char path[PATH_SIZE])
{
    snprintf(path, PATH_SIZE, "%s/%s", folder, SHEETS[kind]);
}

/* ---- storeys -------------------------------------------------------------------------------------------------- */

typedef struct {
    double height, mass, shear, bending; /* [m], [kg], [N/m], [N m2]; 0: not given */
} Storey;

/* The column that is there, of two that differ by a factor of a thousand; 0: none is. */
static Status read_quantity(const Sheet *s, size_t row, const char *plain, const char *thousands, double *value,
                            Err *err)
{
    const int in_thousands = table_column(s, plain) < 0;
    const char *column = in_thousands ? thousands : plain;
    *value = 0;
    if (strcmp(plain, thousands) != 0 && !in_thousands && table_column(s, thousands) >= 0)
        return fail(err, STATUS_BAD_DATA, "%s: has both %s and %s; leave one of them out", s->path, plain, thousands);
    if (table_column(s, column) < 0)
        return STATUS_OK;
    TRY(sheet_number(s, row, column, NAN, value, err));
    if (!(*value > 0))
        return fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; it must be above 0", s->path, s->line[row], column, *value);
    *value *= in_thousands ? 1e3 : 1;
    return STATUS_OK;
}

static Status read_storey(Storey *storey, const Sheet *s, size_t row, Err *err)
{
    TRY(read_quantity(s, row, "height_m", "height_m", &storey->height, err));
    TRY(read_quantity(s, row, "mass_kg", "mass_t", &storey->mass, err));
    TRY(read_quantity(s, row, "stiffness_n_m", "stiffness_kn_m", &storey->shear, err));
    TRY(read_quantity(s, row, "bending_n_m2", "bending_kn_m2", &storey->bending, err));
    if (!(storey->mass > 0))
        return fail(err, STATUS_BAD_DATA, "%s: has no column mass_kg or mass_t", s->path);
    if (!(storey->shear > 0 || storey->bending > 0))
        return fail(err, STATUS_BAD_DATA,
                    "%s: has no column stiffness_n_m, stiffness_kn_m, bending_n_m2 or bending_kn_m2", s->path);
    return STATUS_OK;
}

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

static Status bending_building(int n, const Storey storey[], double K[], double M[], Err *err)
{
    Beam beam[FLOORS_MAX];
    for (int j = 0; j < n; j++)
        beam[j] =
            (Beam){.EI = storey[j].bending, .kGA = storey[j].shear * storey[j].height, .length = storey[j].height};
    return beam_cantilever(n, beam, K, M, err);
}

static Status take_storeys(BuildingFiles *b, const Sheet *s, Err *err)
{
    Storey storey[FLOORS_MAX];
    TRY(sheet_expect(s, "height_m", "mass_kg mass_t stiffness_n_m stiffness_kn_m bending_n_m2 bending_kn_m2", err));
    if (s->n_rows > FLOORS_MAX)
        return fail(err, STATUS_BAD_DATA, "%s: %zu storeys; at most %d are supported", s->path, s->n_rows, FLOORS_MAX);
    TRY(allocate(b, (int)s->n_rows, err));
    for (int j = 0; j < b->n; j++)
        TRY(read_storey(&storey[j], s, (size_t)j, err));
    if (storey[0].bending > 0)
        TRY(bending_building(b->n, storey, b->K, b->M, err));
    else
        shear_building(b->n, storey, b->K);
    memset(b->M, 0, (size_t)(b->n * b->n) * sizeof *b->M);
    for (int j = 0; j < b->n; j++) {
        b->M[j * b->n + j] = storey[j].mass;
        b->storey_m[j] = storey[j].height;
    }
    return STATUS_OK;
}

static Status read_storeys(BuildingFiles *b, const char *folder, Err *err)
{
    Sheet s;
    char path[PATH_SIZE];
    sheet_path(folder, KIND_STOREYS, path);
    TRY(sheet_read(&s, path, err));
    const Status status = take_storeys(b, &s, err);
    table_free(&s);
    return status;
}

/* ---- frame ---------------------------------------------------------------------------------------------------- */

static Status reduce_frame(BuildingFiles *b, const Frame *f, const BuildingOptions *o, FrameKept kept, Err *err)
{
    frame_full_free(&b->full);
    TRY(frame_reduce(f, o->rigid_floors, kept, &b->full, err));
    TRY(check_symmetric(b->full.n, b->full.K, o->model, err));
    return check_symmetric(b->full.n, b->full.M, o->model, err);
}

/* The floors alone are the first rows; what they do not miss is no model of its own. */
static Status condense_frame(BuildingFiles *b, const Frame *f, const BuildingOptions *o, Err *err)
{
    TRY(allocate(b, f->n_floors, err));
    memcpy(b->storey_m, f->storey_m, (size_t)b->n * sizeof *b->storey_m);
    TRY(reduce_frame(b, f, o, FRAME_FLOORS, err));
    for (int j = 0; j < b->n; j++) {
        memcpy(b->K + j * b->n, b->full.K + j * b->full.n, (size_t)b->n * sizeof *b->K);
        memcpy(b->M + j * b->n, b->full.M + j * b->full.n, (size_t)b->n * sizeof *b->M);
    }
    if (b->full.n == b->n)
        frame_full_free(&b->full);
    return STATUS_OK;
}

/* Condensed unless that is there already, and in full where it is asked for. */
static Status read_frame(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    Frame f;
    TRY(frame_read(&f, o, err));
    snprintf(b->note, sizeof b->note, "%s", f.note);
    Status status = b->K ? STATUS_OK : condense_frame(b, &f, o, err);
    if (status == STATUS_OK && o->modes > 0)
        status = reduce_frame(b, &f, o, FRAME_FULL, err);
    frame_free(&f);
    return status;
}

/* ---- the folder ----------------------------------------------------------------------------------------------- */

int building_reads(const char *name)
{
    for (int k = 0; k < KINDS; k++)
        if (strcmp(name, SHEETS[k]) == 0)
            return 1;
    return frame_reads(name);
}

/* Is there one kind of model? */
static Status check_kind(const char *folder, int has[KINDS], Err *err)
{
    for (int k = 0; k < KINDS; k++) {
        char path[PATH_SIZE];
        sheet_path(folder, k, path);
        has[k] = k == KIND_FRAME ? frame_is(folder) : access(path, F_OK) == 0;
    }
    const int matrices = has[KIND_K] || has[KIND_M];
    const char *matrix = has[KIND_K] ? SHEETS[KIND_K] : SHEETS[KIND_M];
    if (has[KIND_FRAME] + has[KIND_STOREYS] + matrices > 1)
        return fail(err, STATUS_BAD_DATA, "%s: holds %s and %s, two kinds of model; leave one of them there", folder,
                    SHEETS[has[KIND_FRAME] ? KIND_FRAME : KIND_STOREYS],
                    has[KIND_FRAME] && has[KIND_STOREYS] ? SHEETS[KIND_STOREYS] : matrix);
    if (!has[KIND_FRAME] && !has[KIND_STOREYS] && !matrices && access(folder, F_OK) == 0)
        return fail(
            err, STATUS_MISSING,
            "%s: holds no building: K.csv and M.csv, or storeys.csv, or nodes.csv, sections.csv and elements.csv",
            folder);
    return STATUS_OK;
}

static Status read_folder(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    int has[KINDS];
    if (is_compiled_in(o->model))
        return read_matrices(b, o, err);
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
        return fail(err, STATUS_BAD_DATA,
                    "building.modes: %s has no more than its floors; only a plane frame (nodes.csv) and guyan have",
                    o->model);
    return read_frame(b, o, err);
}

void building_files_free(BuildingFiles *b)
{
    free(b->K);
    free(b->M);
    free(b->storey_m);
    frame_full_free(&b->full);
    memset(b, 0, sizeof *b);
}
