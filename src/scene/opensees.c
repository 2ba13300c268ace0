#include "scene/opensees.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/visible.h"

const char MODEL_UNITS_WORDS[] = "N_m, kN_m, N_mm, kip_in or kip_ft";

const ModelUnits *model_units(const char *word)
{
    static const double KIP = 4448.2216152605, INCH = 0.0254;
    static const ModelUnits LIST[] = {
        {"N_m", 1, 1}, {"kN_m", 1, 1e3}, {"N_mm", 1e-3, 1}, {"kip_in", INCH, KIP}, {"kip_ft", 12 * INCH, KIP}};
    for (size_t i = 0; i < sizeof LIST / sizeof LIST[0]; i++)
        if (strcmp(word, LIST[i].word) == 0)
            return &LIST[i];
    return NULL;
}

/* ---- words ---------------------------------------------------------------------------------------------------- */

enum { WORDS_MAX = 40, WORD_MAX = 200, VARIABLES_MAX = 400, TRANSFORMATIONS_MAX = 100 };

/* As in Tcl integers divide as integers. */
typedef struct {
    double value;
    int whole;
} Number;

typedef struct {
    char name[TABLE_NAME_MAX];
    Number number;
} Variable;

typedef struct {
    const char *path, *at; /* at: what is still to be read */
    int line, next_line;   /* of the command at hand; of `at` */
    int n;
    char word[WORDS_MAX][WORD_MAX]; /* (n) of the command */
    int n_variables, n_transformations, has_model;
    Variable variable[VARIABLES_MAX];
    double transformation[TRANSFORMATIONS_MAX]; /* (n_transformations) tags */
    ModelUnits units;
    Frame *frame;
    int node_room, section_room, element_room, tie_room;
    FILE *refused;
    int n_refused;
} Reader;

__attribute__((format(printf, 2, 3))) static void refuse(Reader *r, const char *format, ...)
{
    char text[400], shown[480];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    visible_text(shown, sizeof shown, text);
    fprintf(r->refused, "%s:%d: %s\n", r->path, r->line, shown);
    r->n_refused++;
}

static int ends_command(char c)
{
    return c == 0 || c == '\n' || c == ';';
}

/* Blanks inside a line; a backslash before its end continues it. */
static void skip_blanks(Reader *r)
{
    for (;;) {
        const char *after = r->at + 1 + (*r->at == '\\' && r->at[1] == '\r');
        if (*r->at == '\\' && *after == '\n') {
            r->at = after + 1;
            r->next_line++;
        } else if (*r->at && strchr(" \t\r\v\f", *r->at)) {
            r->at++;
        } else {
            return;
        }
    }
}

/* A word goes to the next blank outside brackets and braces. */
static void take_word(Reader *r)
{
    int depth = 0;
    size_t n = 0;
    char *word = r->word[r->n < WORDS_MAX ? r->n : WORDS_MAX - 1];
    while (*r->at && (depth > 0 ? *r->at != '\n' : !ends_command(*r->at) && !isspace((unsigned char)*r->at))) {
        if (*r->at == '\\' && (r->at[1] == '\n' || r->at[1] == '\r'))
            break;
        depth += (*r->at == '[' || *r->at == '{') - (*r->at == ']' || *r->at == '}');
        if (n + 1 < WORD_MAX)
            word[n++] = *r->at;
        r->at++;
    }
    word[n] = 0;
    if (n + 1 == WORD_MAX || r->n == WORDS_MAX)
        refuse(r, "the command is too long");
    r->n += r->n < WORDS_MAX;
}

/* The next command; 0: the text has ended. */
static int next_command(Reader *r)
{
    r->n = 0;
    while (*r->at && r->n == 0) {
        r->line = r->next_line;
        skip_blanks(r);
        if (*r->at == '#')
            while (*r->at && *r->at != '\n')
                r->at++;
        while (!ends_command(*r->at)) {
            take_word(r);
            skip_blanks(r);
        }
        r->next_line += *r->at == '\n';
        r->at += *r->at != 0;
    }
    return r->n > 0;
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

typedef struct {
    const Reader *r;
    const char *at;
    int depth, wrong;
} Expression;

static Number sum(Expression *e);

static void pass_blanks(Expression *e)
{
    while (isspace((unsigned char)*e->at))
        e->at++;
}

static Number variable(Expression *e)
{
    size_t n = 0;
    while (isalnum((unsigned char)e->at[n]) || e->at[n] == '_')
        n++;
    for (int i = 0; i < e->r->n_variables; i++)
        if (strlen(e->r->variable[i].name) == n && strncmp(e->r->variable[i].name, e->at, n) == 0) {
            e->at += n;
            return e->r->variable[i].number;
        }
    e->wrong = 1;
    return (Number){0, 0};
}

static Number inside(Expression *e, char closing)
{
    const Number a = ++e->depth < 50 ? sum(e) : (Number){0, 0};
    pass_blanks(e);
    e->wrong |= *e->at != closing || e->depth >= 50;
    e->at += *e->at == closing;
    e->depth--;
    return a;
}

static Number literal(Expression *e)
{
    char *end;
    const double value = strtod(e->at, &end);
    const size_t length = (size_t)(end - e->at);
    const Number a = {value, strspn(e->at, "0123456789") == length};
    e->wrong |= length == 0 || (a.whole && length > 1 && *e->at == '0'); /* octal, as some versions of Tcl have it */
    e->at = end;
    return a;
}

static Number atom(Expression *e)
{
    pass_blanks(e);
    const char c = *e->at;
    e->at += c && strchr("-+($[{", c) != NULL;
    if (e->wrong)
        return (Number){0, 0};
    if (c == '-' || c == '+') {
        const Number a = atom(e);
        return (Number){c == '-' ? -a.value : a.value, a.whole};
    }
    if (c == '$')
        return variable(e);
    if (c == '(' || c == '{')
        return inside(e, c == '(' ? ')' : '}');
    if (c == '[' && strncmp(e->at, "expr", 4) == 0) {
        e->at += 4;
        return inside(e, ']');
    }
    return literal(e);
}

static Number product(Expression *e)
{
    Number a = atom(e);
    for (pass_blanks(e); !e->wrong && (*e->at == '*' || *e->at == '/'); pass_blanks(e)) {
        const char sign = *e->at++;
        const Number b = atom(e);
        a.whole &= b.whole;
        a.value = sign == '*' ? a.value * b.value : a.value / b.value;
        a.value = a.whole ? floor(a.value) : a.value;
    }
    return a;
}

static Number sum(Expression *e)
{
    Number a = product(e);
    for (pass_blanks(e); !e->wrong && (*e->at == '+' || *e->at == '-'); pass_blanks(e)) {
        const char sign = *e->at++;
        const Number b = product(e);
        a.whole &= b.whole;
        a.value = sign == '+' ? a.value + b.value : a.value - b.value;
    }
    return a;
}

/* Word i as a number; refuses the command where it is none. */
static int evaluate(Reader *r, int i, Number *result)
{
    Expression e = {.r = r, .at = i < r->n ? r->word[i] : ""};
    *result = sum(&e);
    if (!e.wrong && !*e.at && isfinite(result->value))
        return 1;
    refuse(r, "%s: '%s' is no number that can be read here", r->word[0], i < r->n ? r->word[i] : "");
    return 0;
}

static int number(Reader *r, int i, double *value)
{
    Number a;
    const int ok = evaluate(r, i, &a);
    *value = ok ? a.value : 0;
    return ok;
}

/* The command has at most n words. */
static int ends_at(Reader *r, int n)
{
    if (r->n > n)
        refuse(r, "%s: '%s' is not supported", r->word[0], r->word[n]);
    return r->n <= n;
}

static int numbers(Reader *r, int first, int n, double values[])
{
    for (int i = 0; i < n; i++)
        if (!number(r, first + i, &values[i]))
            return 0;
    return 1;
}

/* ---- the parts of the frame ----------------------------------------------------------------------------------- */

static void *room(void *list, int n, int *capacity, size_t size)
{
    if (n < *capacity)
        return list;
    void *wider = realloc(list, (size_t)(2 * n + 64) * size);
    if (wider)
        *capacity = 2 * n + 64;
    return wider;
}

/* A new entry of a list of the frame, zeroed; fails the function around it where there is no memory. */
#define APPEND(entry, list, count, capacity)                                                                           \
    do {                                                                                                               \
        void *wider_ = room(list, count, &(capacity), sizeof *(list));                                                 \
        if (!wider_)                                                                                                   \
            return fail(err, STATUS_NO_MEMORY, "%s: no memory for its model", r->path);                                \
        (list) = wider_;                                                                                               \
        (entry) = &(list)[(count)++];                                                                                  \
        memset(entry, 0, sizeof *(entry));                                                                             \
    } while (0)

/* -1: there is none. */
static int node_of_name(const Frame *f, const char *name)
{
    int i = f->n_nodes - 1;
    while (i >= 0 && strcmp(f->node[i].name, name) != 0)
        i--;
    return i;
}

static int find_node(Reader *r, int word)
{
    double tag;
    char name[TABLE_NAME_MAX];
    if (!number(r, word, &tag))
        return -1;
    snprintf(name, sizeof name, "%.0f", tag);
    const int node = node_of_name(r->frame, name);
    if (node < 0)
        refuse(r, "%s: there is no node %s above", r->word[0], name);
    return node;
}

/* A later mass of a node replaces the earlier one (OpenSees: Node::setMass); that of elements adds to it at the end. */
static void set_mass(Reader *r, FrameNode *node, int first)
{
    double m[FRAME_DOFS];
    const double unit = r->units.force_n / r->units.length_m;
    if (!ends_at(r, first + FRAME_DOFS) || !numbers(r, first, FRAME_DOFS, m))
        return;
    for (int d = 0; d < FRAME_DOFS; d++) {
        if (m[d] < 0) {
            refuse(r, "%s: a mass of %g; it must not be negative", r->word[0], m[d]);
            return;
        }
        node->mass[d] = m[d] * unit * (d == FRAME_ROT ? r->units.length_m * r->units.length_m : 1);
    }
}

static Status take_node(Reader *r, Err *err)
{
    Frame *f = r->frame;
    double tag, xy[2];
    if (!number(r, 1, &tag) || !numbers(r, 2, 2, xy))
        return STATUS_OK;
    if (!r->has_model)
        refuse(r, "node: 'model BasicBuilder -ndm 2 -ndf 3' must stand above");
    r->has_model = 1; /* said once */
    FrameNode *node;
    char name[TABLE_NAME_MAX];
    snprintf(name, sizeof name, "%.0f", tag);
    if (node_of_name(f, name) >= 0) {
        refuse(r, "node: %s is there twice", name);
        return STATUS_OK;
    }
    APPEND(node, f->node, f->n_nodes, r->node_room);
    memcpy(node->name, name, sizeof name);
    node->x = xy[0] * r->units.length_m;
    node->z = xy[1] * r->units.length_m;
    if (r->n > 4 && strcmp(r->word[4], "-mass") == 0)
        set_mass(r, node, 5);
    else if (r->n > 4)
        refuse(r, "node: '%s' is not supported", r->word[4]);
    return STATUS_OK;
}

static Status take_fix(Reader *r, Err *err)
{
    (void)err;
    const int node = find_node(r, 1);
    double fixed[FRAME_DOFS];
    if (node < 0 || !ends_at(r, 2 + FRAME_DOFS) || !numbers(r, 2, FRAME_DOFS, fixed))
        return STATUS_OK;
    for (int d = 0; d < FRAME_DOFS; d++)
        r->frame->node[node].fixed[d] |= fixed[d] != 0;
    return STATUS_OK;
}

static Status take_mass(Reader *r, Err *err)
{
    (void)err;
    const int node = find_node(r, 1);
    if (node >= 0)
        set_mass(r, &r->frame->node[node], 2);
    return STATUS_OK;
}

/* Is one of these nodes tied to the other already? */
static int is_tied(const Frame *f, int a, int b, int dof)
{
    for (int i = 0; i < f->n_ties; i++) {
        const FrameTie *t = &f->tie[i];
        if (t->dof[dof] && ((t->node == a && t->same_as == b) || (t->node == b && t->same_as == a)))
            return 1;
    }
    return 0;
}

static Status take_equal(Reader *r, Err *err)
{
    Frame *f = r->frame;
    const int same_as = find_node(r, 1), node = find_node(r, 2);
    FrameTie *tie;
    if (node < 0 || same_as < 0)
        return STATUS_OK;
    if (node == same_as || r->n == 3)
        refuse(r, "equalDOF: wants two nodes and at least one degree of freedom 1 to 3");
    APPEND(tie, f->tie, f->n_ties, r->tie_room);
    tie->node = node;
    tie->same_as = same_as;
    for (int i = 3; i < r->n; i++) {
        double dof;
        if (!number(r, i, &dof) || (dof != 1 && dof != 2 && dof != 3))
            refuse(r, "equalDOF: '%s' is no degree of freedom 1 to 3", r->word[i]);
        else if (is_tied(f, node, same_as, (int)dof - 1))
            refuse(r, "equalDOF: nodes %s and %s are tied in %g already", f->node[same_as].name, f->node[node].name,
                   dof);
        else
            tie->dof[(int)dof - 1] = 1;
    }
    return STATUS_OK;
}

static Status find_section(Reader *r, const FrameSection *wanted, int *section, Err *err)
{
    Frame *f = r->frame;
    FrameSection *s;
    for (*section = 0; *section < f->n_sections; ++*section) {
        s = &f->section[*section];
        if (s->area == wanted->area && s->inertia == wanted->inertia && s->E == wanted->E &&
            s->mass_per_m == wanted->mass_per_m)
            return STATUS_OK;
    }
    APPEND(s, f->section, f->n_sections, r->section_room);
    *s = *wanted;
    snprintf(s->name, sizeof s->name, "s%d", f->n_sections);
    return STATUS_OK;
}

typedef struct {
    double mass; /* per length */
    int consistent, release;
} ElementOptions;

static int element_options(Reader *r, ElementOptions *o)
{
    *o = (ElementOptions){0};
    for (int i = 9; i < r->n; i++) {
        double value = 0;
        if (strcmp(r->word[i], "-cMass") == 0) {
            o->consistent = 1;
        } else if (strcmp(r->word[i], "-mass") == 0) {
            if (!number(r, ++i, &o->mass))
                return 0;
            if (o->mass < 0) {
                refuse(r, "element: a mass of %g; it must not be negative", o->mass);
                return 0;
            }
        } else if (strcmp(r->word[i], "-release") == 0) {
            if (!number(r, ++i, &value))
                return 0;
            o->release = value >= 0 && value <= 3 ? (int)value : -1;
            if (o->release != value) {
                refuse(r, "element: -release %g is none of 0 (none), 1 (end i), 2 (end j), 3 (both)", value);
                return 0;
            }
        } else {
            refuse(r, "element elasticBeamColumn: '%s' is not supported", r->word[i]);
            return 0;
        }
    }
    return 1;
}

static Status add_element(Reader *r, const int node[2], const double a[3], const ElementOptions *o, Err *err)
{
    Frame *f = r->frame;
    const double L = r->units.length_m, F = r->units.force_n, per_m = o->mass * F / (L * L);
    const FrameSection section = {.area = a[0] * L * L,
                                  .E = a[1] * F / (L * L),
                                  .inertia = a[2] * L * L * L * L,
                                  .mass_per_m = o->consistent ? per_m : 0};
    const FrameNode *end[2] = {&f->node[node[0]], &f->node[node[1]]};
    FrameElement *e;
    int index;
    TRY(find_section(r, &section, &index, err));
    APPEND(e, f->element, f->n_elements, r->element_room);
    snprintf(e->name, sizeof e->name, "%.47s", r->word[2]);
    e->section = index;
    e->added_mass = o->consistent ? 0 : per_m * hypot(end[1]->x - end[0]->x, end[1]->z - end[0]->z);
    for (int k = 0; k < 2; k++) {
        e->node[k] = node[k];
        e->pinned[k] = (o->release >> k) & 1;
    }
    return STATUS_OK;
}

/* The mass of an element goes to its ends in halves, as OpenSees lumps it. */
static void lump_masses(Frame *f)
{
    for (int e = 0; e < f->n_elements; e++) {
        FrameElement *element = &f->element[e];
        for (int k = 0; k < 2; k++)
            for (int d = FRAME_X; d <= FRAME_Z; d++)
                f->node[element->node[k]].mass[d] += 0.5 * element->added_mass;
        element->added_mass = 0;
    }
}

/* Is the tag of the element at hand new, and has its transformation been defined? */
static int tags_are_right(Reader *r, double transformation)
{
    int known = 0;
    for (int i = 0; i < r->n_transformations; i++)
        known |= r->transformation[i] == transformation;
    if (!known)
        refuse(r, "element %s: there is no geomTransf %g above", r->word[2], transformation);
    for (int i = 0; i < r->frame->n_elements; i++)
        if (strcmp(r->frame->element[i].name, r->word[2]) == 0) {
            refuse(r, "element %s: is there twice", r->word[2]);
            known = 0;
        }
    return known;
}

static Status take_element(Reader *r, Err *err)
{
    double tag, a[3], transformation;
    ElementOptions o;
    if (r->n < 9 || strcmp(r->word[1], "elasticBeamColumn") != 0) {
        refuse(r, "element %s: only elasticBeamColumn TAG i j A E I TRANSF is read", r->n > 1 ? r->word[1] : "");
        return STATUS_OK;
    }
    if (!number(r, 2, &tag))
        return STATUS_OK;
    snprintf(r->word[2], WORD_MAX, "%.0f", tag);
    const int node[2] = {find_node(r, 3), find_node(r, 4)};
    if (node[0] < 0 || node[1] < 0 || !numbers(r, 5, 3, a) || !number(r, 8, &transformation) ||
        !element_options(r, &o) || !tags_are_right(r, transformation))
        return STATUS_OK;
    const FrameNode *i = &r->frame->node[node[0]], *j = &r->frame->node[node[1]];
    if (a[0] > 0 && a[1] > 0 && a[2] > 0 && hypot(j->x - i->x, j->z - i->z) > 0)
        return add_element(r, node, a, &o, err);
    refuse(r, "element %s: A, E and I must be above 0, its nodes at two places", r->word[2]);
    return STATUS_OK;
}

static Status take_variable(Reader *r, Err *err)
{
    Number value;
    int i = 0;
    if (r->n != 3 || strlen(r->word[1]) >= TABLE_NAME_MAX) {
        refuse(r, "set: only NAME VALUE is read, the name of at most %d characters", TABLE_NAME_MAX - 1);
        return STATUS_OK;
    }
    if (!evaluate(r, 2, &value))
        return STATUS_OK;
    while (i < r->n_variables && strcmp(r->variable[i].name, r->word[1]) != 0)
        i++;
    if (i == VARIABLES_MAX)
        return fail(err, STATUS_BAD_DATA, "%s:%d: more than %d variables", r->path, r->line, VARIABLES_MAX);
    snprintf(r->variable[i].name, sizeof r->variable[i].name, "%.47s", r->word[1]);
    r->variable[i].number = value;
    r->n_variables += i == r->n_variables;
    return STATUS_OK;
}

static Status take_transformation(Reader *r, Err *err)
{
    double tag;
    if (r->n != 3 || strcmp(r->word[1], "Linear") != 0)
        refuse(r, "geomTransf: only Linear TAG is read; for P-delta set building.p_delta = on");
    else if (r->n_transformations == TRANSFORMATIONS_MAX)
        return fail(err, STATUS_BAD_DATA, "%s:%d: more than %d geomTransf", r->path, r->line, TRANSFORMATIONS_MAX);
    else if (number(r, 2, &tag))
        r->transformation[r->n_transformations++] = tag;
    return STATUS_OK;
}

static Status take_model(Reader *r, Err *err)
{
    (void)err;
    int dimensions = 0, unknowns = 0;
    for (int i = 1; i + 1 < r->n; i++) {
        if (strcmp(r->word[i], "-ndm") == 0)
            dimensions = atoi(r->word[i + 1]);
        if (strcmp(r->word[i], "-ndf") == 0)
            unknowns = atoi(r->word[i + 1]);
    }
    if (dimensions != 2 || unknowns != 3)
        refuse(r, "model: only -ndm 2 -ndf 3 is read");
    r->has_model = 1;
    return STATUS_OK;
}

/* OpenSees forgets what was before. */
static Status take_wipe(Reader *r, Err *err)
{
    (void)err;
    if (r->frame->n_nodes > 0)
        refuse(r, "wipe: only above the nodes; remove the model that it deletes");
    return STATUS_OK;
}

/* ---- the model ------------------------------------------------------------------------------------------------ */

static Status take_command(Reader *r, Err *err)
{
    static const struct {
        const char *word;
        Status (*take)(Reader *r, Err *err);
    } COMMANDS[] = {{"node", take_node},      {"fix", take_fix},         {"mass", take_mass},
                    {"equalDOF", take_equal}, {"element", take_element}, {"geomTransf", take_transformation},
                    {"set", take_variable},   {"model", take_model},     {"wipe", take_wipe}};
    for (size_t i = 0; i < sizeof COMMANDS / sizeof COMMANDS[0]; i++)
        if (strcmp(r->word[0], COMMANDS[i].word) == 0)
            return COMMANDS[i].take(r, err);
    refuse(r, "'%s' is outside the elastic subset that is read", r->word[0]);
    return STATUS_OK;
}

static Status read_text(Reader *r, const char *text, Err *err)
{
    Status status = STATUS_OK;
    r->at = text;
    r->next_line = 1;
    while (status == STATUS_OK && next_command(r))
        status = take_command(r, err);
    if (status == STATUS_OK && r->n_refused)
        status = fail(err, STATUS_BAD_DATA, "%s: %d command%s outside the elastic subset", r->path, r->n_refused,
                      r->n_refused == 1 ? " is" : "s are");
    if (status == STATUS_OK && r->frame->n_elements == 0)
        status = fail(err, STATUS_BAD_DATA, "%s: holds no element", r->path);
    lump_masses(r->frame);
    return status;
}

Status opensees_read(Frame *f, const char *path, const ModelUnits *units, FILE *refused, Err *err)
{
    char *text;
    size_t length;
    memset(f, 0, sizeof *f);
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    Reader *r = calloc(1, sizeof *r);
    Status status = r ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "%s: no memory to read it", path);
    if (status == STATUS_OK) {
        r->path = path;
        r->units = *units;
        r->frame = f;
        r->refused = refused;
        status = read_text(r, text, err);
    }
    free(r);
    free(text);
    if (status != STATUS_OK)
        frame_free(f);
    return status;
}
