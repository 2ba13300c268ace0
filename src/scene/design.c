#include "scene/design.h"

#include "base/list.h"
#include "base/text.h"

/* -- variables ----------------------------------------------------------------------------------------------------- */

/* The groups of variables in the order of x. */
typedef enum { GAP, WALL, BUMPER, SIDE, ANCHOR, LINK, SLIP, MASS, DEVICE, ROOF, N_GROUPS } Group;
_Static_assert((int)N_GROUPS == DESIGN_GROUPS, "a count for each group");

/* A group by floors or zones has a unit, and its names are made of the first one and that; gaps have one for each of
 * GAPS_BOTH, GAPS_LEFT, GAPS_RIGHT. Of other groups all names stand there. */
static const struct {
    const char *name[3], *unit;
    int n;            /* variables where there is no unit */
    const char *must; /* what a value has to be */
} GROUPS[N_GROUPS] = {
    [GAP] = {{"gap", "gap_left", "gap_right"}, "_m", 0, "a gap is not negative"},
    [WALL] = {{"t_base_m", "t_top_m"}, NULL, 2, "a thickness must be above 0"},
    [BUMPER] = {{"bumper"}, "_log10_n_m", 0, "it is the decimal logarithm of a stiffness in N/m, 8 for 1e8 N/m"},
    [SIDE] = {{"side_m"}, NULL, 1, "it must be above 0"},
    [ANCHOR] = {{"anchors"}, NULL, 1, "it must be 1, weight alone, or more"},
    [LINK] = {{"link"}, "_n_s_m", 0, "a dashpot is not negative; 0: there is none"},
    [SLIP] = {{"friction"}, "_n", 0, "a force is not negative; 0: there is none"},
    [MASS] = {{"tuned_mass_kg", "tuned_mass_hz", "tuned_mass_damping"}, NULL, 3, "it must be above 0"},
    [DEVICE] = {{"device"}, "", 0, "it is the place, from 0, of a word of design.devices"},
    [ROOF] = {{"device_roof"}, NULL, 1, "it is 0 for a tuned mass, 1 for none"},
};

enum { WORDS_MAX = DEVICE };
typedef struct {
    const char *key, *noun;
    int n;
    const char *word[WORDS_MAX];
} Words;

/* In the order of Group. */
static const Words VARIABLES = {"design.variables",
                                "variable",
                                DEVICE,
                                {"gaps", "thickness", "bumper", "side", "anchors", "links", "friction", "tuned_mass"}};

/* In the order of FloorDevice. */
static const Words DEVICES = {
    "design.devices", "device", N_FLOOR_DEVICES, {"gap", "bumper", "link", "friction", "none"}};

/* The places of the words of a comma list, in its order, each at most once. */
static Status read_words(const Words *w, const char *list, int places[WORDS_MAX], int *n, Err *err)
{
    char word[64];
    for (*n = 0; *n < (int)list_count(list); ++*n) {
        if (!list_item(list, *n, word, sizeof word))
            return bad_data(err, "%s: item %d is empty or too long", w->key, *n + 1);
        const int k = (int)index_of_word(word, w->word, w->n);
        if (k == w->n)
            return fail_no_word(err, STATUS_BAD_DATA, w->key, word, w->noun, w->word, w->n);
        for (int i = 0; i < *n; i++)
            if (places[i] == k)
                return bad_data(err, "%s: %s stands there twice", w->key, word);
        places[*n] = k;
    }
    return STATUS_OK;
}

enum { ROOF_MASS, ROOF_NONE, N_ROOF_DEVICES };
static const char *const ROOF_WORDS[] = {[ROOF_MASS] = "tuned_mass", [ROOF_NONE] = "none"};

/* The words of design.devices, in their order. */
static Status read_devices(DesignSpace *s, const DesignOptions *o, unsigned set, Err *err)
{
    /* What says how large a device is; there always are gaps. */
    static const Group NEEDS[] = {
        [FLOOR_BUMPER] = BUMPER, [FLOOR_LINK] = LINK, [FLOOR_FRICTION] = SLIP, [FLOOR_NONE] = GAP};
    int places[WORDS_MAX];
    if (o->devices[0] && strcmp(o->devices, "all") != 0)
        TRY(read_words(&DEVICES, o->devices, places, &s->n_words, err));
    for (int i = 0; i < s->n_words; i++) {
        s->word[i] = (FloorDevice)places[i];
        if (!(set >> NEEDS[places[i]] & 1))
            return bad_data(err, "design.devices: %s: add %s to design.variables, which says how large it is",
                            DEVICES.word[places[i]], VARIABLES.word[NEEDS[places[i]]]);
    }
    if (s->n_words == 1)
        return bad_data(err, "design.devices: %s alone is no choice; name two or more, or all", o->devices);
    if (s->n_words == 0 && set >> LINK & set >> SLIP & 1)
        return bad_data(err,
                        "design.variables: a floor has links or friction; design.devices = link, friction chooses");
    return STATUS_OK;
}

Status design_space_make(DesignSpace *s, const DesignOptions *o, CoreSection section, int n_floors, Err *err)
{
    const long zones[N_GROUPS] = {[GAP] = o->gap_zones,
                                  [BUMPER] = o->bumper_zones,
                                  [LINK] = o->link_zones,
                                  [SLIP] = o->link_zones,
                                  [DEVICE] = o->device_zones};
    unsigned set = 0;
    int places[WORDS_MAX] = {GAP, WALL}, n_named = 2;
    if (o->variables[0])
        TRY(read_words(&VARIABLES, o->variables, places, &n_named, err));
    for (int i = 0; i < n_named; i++)
        set |= 1U << places[i];
    if (!(set >> GAP & set >> WALL & 1))
        return bad_data(err, "design.variables: gaps and thickness are always there; add to them");
    *s = (DesignSpace){.n_floors = n_floors, .gap_sides = o->gap_sides};
    for (int g = 0; g < N_GROUPS; g++) {
        const int by_floor = GROUPS[g].unit != NULL;
        if (g == DEVICE) {
            TRY(read_devices(s, o, set, err));
            set |= s->n_words == 0 ? 0 : set >> MASS & 1 ? 1U << DEVICE | 1U << ROOF : 1U << DEVICE;
        }
        s->zones[g] = (int)zones[g];
        s->first[g] = s->n_var;
        if (!(set >> g & 1) || (g == WALL && section == CORE_EFFECTIVE))
            continue;
        if (n_floors > 0 && zones[g] > n_floors)
            return bad_data(err, "design.%s_zones: %ld zones, but only %d floors", GROUPS[g == SLIP ? LINK : g].name[0],
                            zones[g], n_floors);
        s->count[g] = !by_floor ? GROUPS[g].n : zones[g] ? (int)zones[g] : n_floors;
        s->count[g] *= g == GAP && o->gap_sides == GAPS_EACH ? SIDES : 1;
        s->n_var += s->count[g];
    }
    return STATUS_OK;
}

int design_space_floors(const DesignOptions *o, CoreSection section, int n_var)
{
    DesignSpace s;
    Err unused;
    for (int n = 1; n <= FLOORS_MAX; n++)
        if (design_space_make(&s, o, section, n, &unused) == STATUS_OK && s.n_var == n_var) {
            for (int g = 0; g < N_GROUPS; g++)
                if (GROUPS[g].unit && s.count[g] > 0 && s.zones[g] == 0)
                    return n;
            return 0;
        }
    return 0;
}

/* Of variable j, which becomes its number in the group. */
static Group group_of(const DesignSpace *s, int *j)
{
    Group group = GAP;
    while (group < ROOF && *j >= s->first[group + 1])
        group++;
    *j -= s->first[group];
    return group;
}

/* Gaps on one side. */
static int gaps_per_side(const DesignSpace *s)
{
    return s->gap_sides == GAPS_EACH ? s->n_gaps / SIDES : s->n_gaps;
}

void design_variable_name(const DesignSpace *s, int j, char name[TABLE_NAME_MAX])
{
    const Group group = group_of(s, &j);
    const int zones = s->zones[group], is_second = group == GAP && j >= gaps_per_side(s);
    const char *unit = GROUPS[group].unit;
    const int side = group != GAP ? 0 : s->gap_sides != GAPS_EACH ? (int)s->gap_sides : GAPS_LEFT + is_second;
    const char *stem = GROUPS[group].name[unit ? side : j];
    j -= is_second ? gaps_per_side(s) : 0;
    if (!unit || (zones == 1 && *unit))
        snprintf(name, TABLE_NAME_MAX, "%s%s", stem, unit ? unit : "");
    else
        snprintf(name, TABLE_NAME_MAX, zones ? "%s_zone_%d%s" : "%s_%02d%s", stem, j + 1, unit);
}

const char *design_word(const DesignSpace *s, int j, double x)
{
    const Group group = group_of(s, &j);
    if (group == DEVICE)
        return x >= 0 && x < s->n_words ? DEVICES.word[s->word[(int)x]] : NULL;
    return group == ROOF && x >= 0 && x < N_ROOF_DEVICES ? ROOF_WORDS[(int)x] : NULL;
}

int design_share_zone(const DesignSpace *s, int a, int b, int zones)
{
    const Group group = group_of(s, &a);
    const int n = group == GAP ? gaps_per_side(s) : s->count[group];
    return group_of(s, &b) == group && GROUPS[group].unit && s->count[group] > 1 && a / n == b / n &&
           a % n * zones / n == b % n * zones / n;
}

int design_is_wall(const DesignSpace *s, int j)
{
    return group_of(s, &j) == WALL;
}

int design_is_log(const DesignSpace *s, int j)
{
    const Group group = group_of(s, &j);
    return group == LINK || group == SLIP || group == MASS;
}

void design_bounds(const DesignSpace *s, const DesignOptions *o, double lower[], double upper[])
{
    const NumberList anchors = {2, {1, o->anchors_max}};
    const NumberList *const lists[] = {&o->gap_m,      &o->thickness_m, &o->bumper_n_m, &o->width_m, &anchors,
                                       &o->link_n_s_m, &o->link_n_s_m,  &o->mass_kg,    &o->mass_hz, &o->mass_damping};
    for (int j = 0; j < s->n_var; j++) {
        int i = j;
        const Group group = group_of(s, &i);
        const double words[] = {0, (group == DEVICE ? s->n_words : N_ROOF_DEVICES) - 1.0};
        const double *l = group >= DEVICE ? words : lists[group == MASS ? (int)group + i : (int)group]->at;
        lower[j] = group == BUMPER ? log10(l[0]) : l[0];
        upper[j] = group == BUMPER ? log10(l[1]) : l[1];
    }
}

static const double GOLDEN_RATIO = 0.6180339887498949; /* its multiples modulo 1 are evenly spread */

void design_spread(const DesignSpace *s, const DesignOptions *o, size_t k, size_t n, double sway_m, double x[])
{
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    const int per_side = gaps_per_side(s);
    design_bounds(s, o, lower, upper);
    for (int j = 0; j < s->n_var; j++) {
        int i = j;
        const Group group = group_of(s, &i);
        const double core = isinf(sway_m) ? 0.5 : (double)(k + 1) / (double)(n + 1);
        const double share =
            group == WALL || group == SIDE ? core : fmod(GOLDEN_RATIO * (j + 1) + (double)k / (double)n, 1);
        if (group == GAP)
            upper[j] = fmax(lower[j], fmin(upper[j], sway_m * (i % per_side + 1) / per_side));
        x[j] =
            design_is_log(s, j) ? lower[j] * pow(upper[j] / lower[j], share) : lower[j] + (upper[j] - lower[j]) * share;
        if (design_word(s, j, x[j])) /* the first design has the first word everywhere, stops alone say */
            x[j] = isfinite(sway_m) && k == 0 ? 0 : round(x[j]);
    }
}

/* The value of a group for floor j: its zone's, or its own; `otherwise` where there is none. */
static double of_floor(const DesignSpace *s, Group group, const double x[], int j, double otherwise)
{
    return s->count[group] ? x[s->first[group] + j * s->count[group] / s->n_floors] : otherwise;
}

void design_of(const DesignSpace *s, const double x[], Design *d)
{
    const int n = gaps_per_side(s);
    const double *wall = x + s->first[WALL], *mass = x + s->first[MASS];
    const int has_mass = s->n_mass > 0 && (!s->has_roof || x[s->first[ROOF]] == ROOF_MASS);
    for (int j = 0; j < s->n_floors; j++) {
        const double *gap = &x[j * n / s->n_floors];
        d->gap[0][j] = s->gap_sides == GAPS_LEFT ? INFINITY : gap[s->n_gaps - n];
        d->gap[1][j] = s->gap_sides == GAPS_RIGHT ? INFINITY : *gap;
        d->bumper[j] = s->n_bumpers ? pow(10, of_floor(s, BUMPER, x, j, 0)) : -1;
        d->link[j] = of_floor(s, LINK, x, j, 0);
        d->friction[j] = of_floor(s, SLIP, x, j, 0);
        if (s->n_choices == 0)
            continue;

        /* What the floor does not have by its word is left out. */
        const FloorDevice word = s->word[(int)of_floor(s, DEVICE, x, j, 0)];
        if (word >= FLOOR_LINK)
            d->gap[0][j] = d->gap[1][j] = INFINITY;
        if (word != FLOOR_LINK)
            d->link[j] = 0;
        if (word != FLOOR_FRICTION)
            d->friction[j] = 0;
        if (word == FLOOR_GAP)
            d->bumper[j] = -1;
    }
    d->t_base = s->n_walls ? wall[0] : 0;
    d->t_top = s->n_walls ? wall[1] : 0;
    d->side = s->has_side ? x[s->first[SIDE]] : 0;
    d->anchors = s->has_anchors ? x[s->first[ANCHOR]] : 0;
    d->mass_kg = has_mass ? mass[0] : 0;
    d->mass_hz = has_mass ? mass[1] : 0;
    d->mass_damping = has_mass ? mass[2] : 0;
}

/* Every floor gets that word of design.devices, the roof its own; 0: there is no choice of it. */
static int put_words(const DesignSpace *s, FloorDevice floors, int roof, double x[])
{
    int w = 0;
    while (w < s->n_words && s->word[w] != floors)
        w++;
    for (int j = s->first[DEVICE]; j < s->first[ROOF]; j++)
        x[j] = w;
    if (s->has_roof)
        x[s->first[ROOF]] = roof;
    return w < s->n_words;
}

int design_put_links(const DesignSpace *s, double n_s_m, double x[])
{
    for (int j = 0; j < s->n_links; j++)
        x[s->first[LINK] + j] = n_s_m;
    return s->n_links > 0 && put_words(s, FLOOR_LINK, ROOF_NONE, x);
}

int design_put_mass(const DesignSpace *s, double kg, double hz, double damping, double x[])
{
    memcpy(x + s->first[MASS], (double[]){kg, hz, damping}, s->n_mass * sizeof *x);
    return s->n_mass > 0 && put_words(s, FLOOR_NONE, ROOF_MASS, x);
}

const char *design_protection(const DesignSpace *s, const Design *d, char text[PROTECTION_MAX])
{
    int stops = 0, links = 0;
    for (int j = 0; j < s->n_floors; j++) {
        stops |= design_gap(d, j) < DESIGN_OPEN_M;
        links |= design_has_link(d, j);
    }
    const char *mass = d->mass_kg > 0 ? "a tuned mass" : "";
    snprintf(text, PROTECTION_MAX, "%s%s%s%s%s", stops ? "impacts" : "", stops && links ? " and " : "",
             links ? "links" : "", stops + links && *mass ? " and " : "",
             stops + links || *mass ? mass : "the core alone");
    return text;
}

int design_has_link(const Design *d, int j)
{
    return d->link[j] > 0 || d->friction[j] > 0;
}

double design_gap(const Design *d, int j)
{
    return fmin(d->gap[0][j], d->gap[1][j]);
}

double design_thickness(const DesignSpace *s, const Design *d, int j)
{
    return s->n_floors > 1 ? d->t_base + (d->t_top - d->t_base) * j / (s->n_floors - 1) : d->t_base;
}

/* -- files --------------------------------------------------------------------------------------------------------- */

Status design_check(const DesignSpace *space, int j, double value, const char *where, Err *err)
{
    char name[TABLE_NAME_MAX];
    design_variable_name(space, j, name);
    const int is_word = design_word(space, j, value) && value == floor(value);
    const Group group = group_of(space, &j);
    if (group >= DEVICE                                  ? is_word
        : group == GAP || group == LINK || group == SLIP ? value >= 0
        : group == ANCHOR                                ? value >= 1
                                                         : value > 0 && (group != BUMPER || value < 15))
        return STATUS_OK;
    return bad_data(err, "%s: %s is %g; %s", where, name, value, GROUPS[group].must);
}

Status design_cell(const DesignSpace *s, int j, const Table *t, size_t row, double *x, Err *err)
{
    char name[TABLE_NAME_MAX], where[sizeof t->path + TABLE_NAME_MAX + 16], *end;
    const char *words[N_FLOOR_DEVICES];
    int n = 0;
    design_variable_name(s, j, name);
    const char *text = sheet_text(t, row, name);
    const double number = strtod(text, &end);
    for (; (words[n] = design_word(s, j, n)); n++)
        if (strcmp(text, words[n]) == 0 || (end > text && !*end && number == n)) {
            *x = n;
            return STATUS_OK;
        }
    if (n == 0)
        return sheet_number(t, row, name, NAN, x, err);
    snprintf(where, sizeof where, "%s:%d: %s", t->path, t->line[row], name);
    return fail_no_word(err, STATUS_BAD_DATA, where, text, "device", words, n);
}

Status design_table_read(Table *t, const char *path, const DesignSpace *s, Err *err)
{
    char name[TABLE_NAME_MAX];
    TRY(table_read(t, path, s->n_choices > 0 ? TABLE_WORDS : TABLE_HEADED, err));
    Status status = STATUS_OK;
    for (int j = 0; j < s->n_var && s->n_choices > 0; j++) {
        design_variable_name(s, j, name);
        const int column = table_column(t, name);
        for (size_t i = 0; column >= 0 && i < t->n_rows; i++)
            THEN(status, design_cell(s, j, t, i, &t->values[i * t->n_cols + column], err));
    }
    if (status != STATUS_OK)
        table_free(t);
    return status;
}

Status design_of_table(Designs *d, Table *t, const char *path, const DesignSpace *space, Err *err)
{
    const size_t n_var = space->n_var;
    char name[TABLE_NAME_MAX], last[TABLE_NAME_MAX], where[320];
    memset(d, 0, sizeof *d);
    for (size_t j = 0; j < n_var && j < t->n_cols; j++) {
        design_variable_name(space, (int)j, name);
        if (strcmp(t->names[j], name) != 0)
            return bad_data(
                err, "%s: column %zu of the header is '%s'; a design of %d floors has %s there (design.variables)",
                path, j + 1, t->names[j], space->n_floors, name);
    }
    design_variable_name(space, 0, name);
    design_variable_name(space, space->n_var - 1, last);
    if (t->n_cols != n_var)
        return bad_data(
            err,
            "%s: the header has %zu columns; a design of %d floors has %zu: %s..%s (design.variables, core.section)",
            path, t->n_cols, space->n_floors, n_var, name, last);
    if (t->n_rows == 0)
        return bad_data(err, "%s: holds no designs", path);
    for (size_t i = 0; i < t->n_rows * n_var; i++) {
        const int line = t->line[i / n_var], j = (int)(i % n_var);
        if (isnan(t->values[i]))
            return bad_data(err, "%s:%d: column %d of %zu is missing", path, line, j + 1, n_var);
        snprintf(where, sizeof where, "%s:%d", path, line);
        TRY(design_check(space, j, t->values[i], where, err));
    }
    *d = (Designs){.n = t->n_rows, .space = *space, .x = t->values, .line = t->line};
    t->values = NULL;
    t->line = NULL;
    return STATUS_OK;
}

Status design_read(Designs *d, const char *path, const DesignSpace *space, Err *err)
{
    Table t;
    memset(d, 0, sizeof *d);
    TRY(design_table_read(&t, path, space, err));
    const Status status = design_of_table(d, &t, path, space, err);
    table_free(&t);
    return status;
}

void design_free(Designs *d)
{
    free(d->x);
    free(d->line);
    free(d->id);
    memset(d, 0, sizeof *d);
}
