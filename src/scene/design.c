#include "scene/design.h"

#include "base/list.h"

/* -- variables ----------------------------------------------------------------------------------------------------- */

enum {
    HAS_GAPS = 1,
    HAS_THICKNESS = 2,
    HAS_BUMPER = 4,
    HAS_SIDE = 8,
    HAS_LINKS = 16,
    HAS_MASS = 32,
    HAS_FRICTION = 64
};

/* The words of design.variables as a set. */
static Status take_words(const char *list, unsigned *set, Err *err)
{
    static const char *const WORDS[] = {"gaps", "thickness", "bumper", "side", "links", "tuned_mass", "friction"};
    enum { N = N_OF(WORDS) };
    char word[64];
    *set = 0;
    for (size_t i = 0; i < list_count(list); i++) {
        int k = 0;
        if (!list_item(list, i, word, sizeof word))
            return bad_data(err, "design.variables: item %zu is empty or too long", i + 1);
        if (strcmp(word, "symmetric") == 0)
            return bad_data(
                err, "design.variables: 'symmetric' is no choice: leave the word out; design.gap_sides = both makes "
                     "every gap the same on both sides");
        while (k < N && strcmp(WORDS[k], word) != 0)
            k++;
        if (k == N)
            return fail_no_word(err, STATUS_BAD_DATA, "design.variables", word, "variable", WORDS, N);
        if (*set >> k & 1)
            return bad_data(err, "design.variables: %s stands there twice", word);
        *set |= 1U << k;
    }
    return *set & HAS_GAPS && *set & HAS_THICKNESS
               ? STATUS_OK
               : bad_data(err, "design.variables: gaps and thickness are always there; add to them");
}

static const char *const FLOOR_WORDS[] = {[FLOOR_GAP] = "gap",
                                          [FLOOR_BUMPER] = "bumper",
                                          [FLOOR_LINK] = "link",
                                          [FLOOR_FRICTION] = "friction",
                                          [FLOOR_NONE] = "none"};
enum { ROOF_MASS, ROOF_NONE, N_ROOF_DEVICES };
static const char *const ROOF_WORDS[] = {[ROOF_MASS] = "tuned_mass", [ROOF_NONE] = "none"};

/* The words of design.devices, in their order. */
static Status take_devices(DesignSpace *s, const DesignOptions *o, unsigned set, Err *err)
{
    static const unsigned NEEDS[] = {[FLOOR_GAP] = 0,
                                     [FLOOR_BUMPER] = HAS_BUMPER,
                                     [FLOOR_LINK] = HAS_LINKS,
                                     [FLOOR_FRICTION] = HAS_FRICTION,
                                     [FLOOR_NONE] = 0};
    char word[64] = "";
    unsigned seen = 0;
    s->n_words = 0;
    for (size_t i = 0; o->devices[0] && strcmp(o->devices, "all") != 0 && i < list_count(o->devices); i++) {
        int k = 0;
        const int is_word = list_item(o->devices, i, word, sizeof word);
        while (k < N_FLOOR_DEVICES && strcmp(FLOOR_WORDS[k], word) != 0)
            k++;
        if (!is_word || k == N_FLOOR_DEVICES)
            return fail_no_word(err, STATUS_BAD_DATA, "design.devices", word, "device", FLOOR_WORDS, N_FLOOR_DEVICES);
        if (seen >> k & 1)
            return bad_data(err, "design.devices: %s stands there twice", word);
        if ((set & NEEDS[k]) != NEEDS[k])
            return bad_data(err, "design.devices: %s: add %s to design.variables, which says how large it is", word,
                            k == FLOOR_LINK     ? "links"
                            : k == FLOOR_BUMPER ? "bumper"
                                                : "friction");
        seen |= 1U << k;
        s->word[s->n_words++] = (FloorDevice)k;
    }
    if (s->n_words == 1)
        return bad_data(err, "design.devices: %s alone is no choice; name two or more, or all", word);
    if (s->n_words == 0 && set & HAS_LINKS && set & HAS_FRICTION)
        return bad_data(err,
                        "design.variables: a floor has links or friction; design.devices = link, friction chooses");
    return STATUS_OK;
}

static Status check_zones(const char *key, long zones, int n_floors, Err *err)
{
    return n_floors == 0 || zones <= n_floors
               ? STATUS_OK
               : bad_data(err, "%s: %ld zones, but only %d floors", key, zones, n_floors);
}

Status design_space_make(DesignSpace *space, const DesignOptions *o, CoreSection section, int n_floors, Err *err)
{
    unsigned set = HAS_GAPS | HAS_THICKNESS;
    if (o->variables[0])
        TRY(take_words(o->variables, &set, err));
    TRY(check_zones("design.gap_zones", o->gap_zones, n_floors, err));
    const int has_bumper = (set & HAS_BUMPER) != 0;
    if (has_bumper)
        TRY(check_zones("design.bumper_zones", o->bumper_zones, n_floors, err));
    if (set & (HAS_LINKS | HAS_FRICTION))
        TRY(check_zones("design.link_zones", o->link_zones, n_floors, err));
    *space = (DesignSpace){.n_floors = n_floors,
                           .n_walls = section == CORE_EFFECTIVE ? 0 : 2,
                           .gap_zones = (int)o->gap_zones,
                           .gap_sides = o->gap_sides,
                           .bumper_zones = (int)o->bumper_zones,
                           .has_side = (set & HAS_SIDE) != 0,
                           .link_zones = (int)o->link_zones,
                           .n_mass = set & HAS_MASS ? 3 : 0,
                           .device_zones = (int)o->device_zones};
    TRY(take_devices(space, o, set, err));
    if (space->n_words > 0)
        TRY(check_zones("design.device_zones", o->device_zones, n_floors, err));
    space->has_roof = space->n_words > 0 && space->n_mass > 0;
    space->n_choices = space->n_words == 0 ? 0 : space->device_zones ? space->device_zones : n_floors;
    space->n_gaps = (space->gap_sides == GAPS_EACH ? SIDES : 1) * (space->gap_zones ? space->gap_zones : n_floors);
    space->n_bumpers = !has_bumper ? 0 : space->bumper_zones ? space->bumper_zones : n_floors;
    const int n_links = space->link_zones ? space->link_zones : n_floors;
    space->n_links = set & HAS_LINKS ? n_links : 0;
    space->n_slips = set & HAS_FRICTION ? n_links : 0;
    space->n_var = space->n_gaps + space->n_walls + space->n_bumpers + space->has_side + space->n_links +
                   space->n_slips + space->n_mass + space->n_choices + space->has_roof;
    return STATUS_OK;
}

int design_space_floors(const DesignOptions *o, CoreSection section, int n_var)
{
    DesignSpace s;
    Err unused;
    for (int n = 1; n <= FLOORS_MAX; n++)
        if (design_space_make(&s, o, section, n, &unused) == STATUS_OK && s.n_var == n_var)
            return s.gap_zones && (s.n_bumpers == 0 || s.bumper_zones) &&
                           (s.n_links + s.n_slips == 0 || s.link_zones) && (s.n_choices == 0 || s.device_zones)
                       ? 0
                       : n;
    return 0;
}

/* The number of variable j among the gaps of its side; *stem: of that side. */
static int gap_number(const DesignSpace *s, int j, const char **stem)
{
    static const char *const STEM[] = {
        [GAPS_BOTH] = "gap", [GAPS_LEFT] = "gap_left", [GAPS_RIGHT] = "gap_right", [GAPS_EACH] = "gap_left"};
    const int is_second = s->gap_sides == GAPS_EACH && j >= s->n_gaps / SIDES;
    *stem = STEM[is_second ? GAPS_RIGHT : s->gap_sides];
    return is_second ? j - s->n_gaps / SIDES : j;
}

static void zoned_name(char name[TABLE_NAME_MAX], const char *stem, const char *unit, int zones, int i)
{
    if (zones == 1)
        snprintf(name, TABLE_NAME_MAX, "%s_%s", stem, unit);
    else if (zones)
        snprintf(name, TABLE_NAME_MAX, "%s_zone_%d_%s", stem, i + 1, unit);
    else
        snprintf(name, TABLE_NAME_MAX, "%s_%02d_%s", stem, i + 1, unit);
}

/* The variables in their order. */
typedef enum { GAP, WALL, BUMPER, SIDE, LINK, SLIP, MASS, DEVICE, ROOF } Group;

/* Of variable j, which becomes its number in the group. */
static Group group_of(const DesignSpace *s, int *j)
{
    const int n[] = {s->n_gaps, s->n_walls, s->n_bumpers, s->has_side, s->n_links, s->n_slips, s->n_mass, s->n_choices};
    Group group = GAP;
    for (; group < ROOF && *j >= n[group]; group++)
        *j -= n[group];
    return group;
}

void design_variable_name(const DesignSpace *s, int j, char name[TABLE_NAME_MAX])
{
    const Group group = group_of(s, &j);
    const char *stem;
    if (group == GAP) {
        j = gap_number(s, j, &stem);
        zoned_name(name, stem, "m", s->gap_zones, j);
    } else if (group == BUMPER) {
        zoned_name(name, "bumper", "log10_n_m", s->bumper_zones, j);
    } else if (group == LINK) {
        zoned_name(name, "link", "n_s_m", s->link_zones, j);
    } else if (group == SLIP) {
        zoned_name(name, "friction", "n", s->link_zones, j);
    } else if (group == DEVICE) {
        snprintf(name, TABLE_NAME_MAX, s->device_zones ? "device_zone_%d" : "device_%02d", j + 1);
    } else if (group == ROOF) {
        snprintf(name, TABLE_NAME_MAX, "device_roof");
    } else if (group == MASS) {
        snprintf(name, TABLE_NAME_MAX, "tuned_mass_%s", (const char *const[]){"kg", "hz", "damping"}[j]);
    } else {
        snprintf(name, TABLE_NAME_MAX, "%s", group == SIDE ? "side_m" : j == 0 ? "t_base_m" : "t_top_m");
    }
}

const char *design_word(const DesignSpace *s, int j, double x)
{
    const Group group = group_of(s, &j);
    if (group == DEVICE)
        return x >= 0 && x < s->n_words ? FLOOR_WORDS[s->word[(int)x]] : NULL;
    return group == ROOF && x >= 0 && x < N_ROOF_DEVICES ? ROOF_WORDS[(int)x] : NULL;
}

int design_share_zone(const DesignSpace *s, int a, int b, int zones)
{
    const Group group = group_of(s, &a);
    const int n[] = {s->n_gaps, 1, s->n_bumpers, 1, s->n_links, s->n_slips, 1, s->n_choices, 1};
    const int per_side = s->gap_sides == GAPS_EACH && group == GAP ? n[GAP] / SIDES : n[group];
    return group_of(s, &b) == group && n[group] > 1 && a / per_side == b / per_side &&
           a % per_side * zones / per_side == b % per_side * zones / per_side;
}

int design_is_wall(const DesignSpace *s, int j)
{
    return j >= s->n_gaps && j < s->n_gaps + s->n_walls;
}

int design_is_log(const DesignSpace *s, int j)
{
    const Group group = group_of(s, &j);
    return group == LINK || group == SLIP || group == MASS;
}

void design_bounds(const DesignSpace *s, const DesignOptions *o, double lower[], double upper[])
{
    const NumberList *const lists[] = {&o->gap_m,      &o->thickness_m, &o->bumper_n_m, &o->width_m,     &o->link_n_s_m,
                                       &o->link_n_s_m, &o->mass_kg,     &o->mass_hz,    &o->mass_damping};
    for (int j = 0; j < s->n_var; j++) {
        int i = j;
        const Group group = group_of(s, &i);
        const double words[] = {0, (group == DEVICE ? s->n_words : N_ROOF_DEVICES) - 1.0};
        const double *l = group >= DEVICE ? words : lists[group == MASS ? (int)group + i : (int)group]->at;
        lower[j] = group == BUMPER ? log10(l[0]) : l[0];
        upper[j] = group == BUMPER ? log10(l[1]) : l[1];
    }
}

/* Which of `count` variables floor j has: its zone's, or its own. */
static int zone_of(int count, int n_floors, int j)
{
    return j * count / n_floors;
}

/* What floor j does not have by its word. */
static void leave_out(FloorDevice word, int j, Design *d)
{
    if (word >= FLOOR_LINK)
        d->gap[0][j] = d->gap[1][j] = INFINITY;
    if (word != FLOOR_LINK)
        d->link[j] = 0;
    if (word != FLOOR_FRICTION)
        d->friction[j] = 0;
    if (word == FLOOR_GAP)
        d->bumper[j] = 0;
}

void design_of(const DesignSpace *s, const double x[], Design *d)
{
    const int per_side = s->gap_sides == GAPS_EACH ? s->n_gaps / SIDES : s->n_gaps;
    const double *bumper = x + s->n_gaps + s->n_walls, *link = bumper + s->n_bumpers + s->has_side;
    const double *slip = link + s->n_links, *mass = slip + s->n_slips, *choice = mass + s->n_mass;
    const int has_mass = s->n_mass > 0 && (!s->has_roof || choice[s->n_choices] == ROOF_MASS);
    for (int j = 0; j < s->n_floors; j++) {
        const double gap = x[zone_of(per_side, s->n_floors, j)];
        d->gap[0][j] = s->gap_sides == GAPS_EACH   ? x[per_side + zone_of(per_side, s->n_floors, j)]
                       : s->gap_sides == GAPS_LEFT ? INFINITY
                                                   : gap;
        d->gap[1][j] = s->gap_sides == GAPS_RIGHT ? INFINITY : gap;
        d->bumper[j] = s->n_bumpers ? pow(10, bumper[zone_of(s->n_bumpers, s->n_floors, j)]) : -1;
        d->link[j] = s->n_links ? link[zone_of(s->n_links, s->n_floors, j)] : 0;
        d->friction[j] = s->n_slips ? slip[zone_of(s->n_slips, s->n_floors, j)] : 0;
        if (s->n_choices)
            leave_out(s->word[(int)choice[zone_of(s->n_choices, s->n_floors, j)]], j, d);
    }
    d->t_base = s->n_walls ? x[s->n_gaps] : 0;
    d->t_top = s->n_walls ? x[s->n_gaps + 1] : 0;
    d->side = s->has_side ? bumper[s->n_bumpers] : 0;
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
    for (int j = s->n_var - s->n_choices - s->has_roof; j < s->n_var; j++)
        x[j] = w;
    if (s->has_roof)
        x[s->n_var - 1] = roof;
    return w < s->n_words;
}

int design_put_links(const DesignSpace *s, double n_s_m, double x[])
{
    const int first = s->n_gaps + s->n_walls + s->n_bumpers + s->has_side;
    for (int j = first; j < first + s->n_links; j++)
        x[j] = n_s_m;
    return s->n_links > 0 && put_words(s, FLOOR_LINK, ROOF_NONE, x);
}

int design_put_mass(const DesignSpace *s, double kg, double hz, double damping, double x[])
{
    const double mass[] = {kg, hz, damping};
    memcpy(x + s->n_gaps + s->n_walls + s->n_bumpers + s->has_side + s->n_links + s->n_slips, mass,
           s->n_mass * sizeof *mass);
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

static Status check_names(const Table *t, const char *path, const DesignSpace *s, Err *err)
{
    char name[TABLE_NAME_MAX], first[TABLE_NAME_MAX], last[TABLE_NAME_MAX];
    const size_t n_var = s->n_var;
    for (size_t j = 0; j < n_var && j < t->n_cols; j++) {
        design_variable_name(s, (int)j, name);
        if (strcmp(t->names[j], name) != 0)
            return bad_data(
                err, "%s: column %zu of the header is '%s'; a design of %d floors has %s there (design.variables)",
                path, j + 1, t->names[j], s->n_floors, name);
    }
    design_variable_name(s, 0, first);
    design_variable_name(s, s->n_var - 1, last);
    if (t->n_cols != n_var)
        return bad_data(
            err,
            "%s: the header has %zu columns; a design of %d floors has %zu: %s..%s (design.variables, core.section)",
            path, t->n_cols, s->n_floors, n_var, first, last);
    return STATUS_OK;
}

Status design_check(const DesignSpace *space, int j, double value, const char *where, Err *err)
{
    static const char *const MUST[] = {
        [GAP] = "a gap is not negative",
        [WALL] = "a thickness must be above 0",
        [BUMPER] = "it is the decimal logarithm of a stiffness in N/m, 8 for 1e8 N/m",
        [SIDE] = "it must be above 0",
        [LINK] = "a dashpot is not negative; 0: there is none",
        [SLIP] = "a force is not negative; 0: there is none",
        [MASS] = "it must be above 0",
        [DEVICE] = "it is the place, from 0, of a word of design.devices",
        [ROOF] = "it is 0 for a tuned mass, 1 for none",
    };
    char name[TABLE_NAME_MAX];
    design_variable_name(space, j, name);
    const int is_word = design_word(space, j, value) && value == floor(value);
    const Group group = group_of(space, &j);
    if (group >= DEVICE                                  ? is_word
        : group == GAP || group == LINK || group == SLIP ? value >= 0
                                                         : value > 0 && (group != BUMPER || value < 15))
        return STATUS_OK;
    return bad_data(err, "%s: %s is %g; %s", where, name, value, MUST[group]);
}

static Status check_values(const Designs *d, const char *path, Err *err)
{
    const size_t n_var = d->space.n_var;
    char where[320];
    for (size_t i = 0; i < d->n * n_var; i++) {
        const int line = d->line[i / n_var], j = (int)(i % n_var);
        if (isnan(d->x[i]))
            return bad_data(err, "%s:%d: column %d of %zu is missing", path, line, j + 1, n_var);
        snprintf(where, sizeof where, "%s:%d", path, line);
        TRY(design_check(&d->space, j, d->x[i], where, err));
    }
    return STATUS_OK;
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

/* Numbers in the place of words; other columns keep those that they have. */
static Status take_words_of_table(Table *t, const DesignSpace *s, Err *err)
{
    char name[TABLE_NAME_MAX];
    TRY_ROOM(t->values, t->n_rows * t->n_cols + 1, "numbers", err);
    for (size_t i = 0; i < t->n_rows * t->n_cols; i++)
        t->values[i] = strtod(t->text + t->cell[i], NULL);
    for (int j = 0; j < s->n_var; j++) {
        design_variable_name(s, j, name);
        const int column = table_column(t, name);
        for (size_t i = 0; column >= 0 && i < t->n_rows; i++)
            TRY(design_cell(s, j, t, i, &t->values[i * t->n_cols + (size_t)column], err));
    }
    return STATUS_OK;
}

Status design_table_read(Table *t, const char *path, const DesignSpace *space, Err *err)
{
    TRY(table_read(t, path, space->n_choices > 0 ? TABLE_WORDS : TABLE_HEADED, err));
    const Status status = space->n_choices > 0 ? take_words_of_table(t, space, err) : STATUS_OK;
    if (status != STATUS_OK)
        table_free(t);
    return status;
}

Status design_of_table(Designs *d, Table *t, const char *path, const DesignSpace *space, Err *err)
{
    memset(d, 0, sizeof *d);
    TRY(check_names(t, path, space, err));
    if (t->n_rows == 0)
        return bad_data(err, "%s: holds no designs", path);
    *d = (Designs){.n = t->n_rows, .space = *space, .x = t->values, .line = t->line};
    t->values = NULL;
    t->line = NULL;
    const Status status = check_values(d, path, err);
    if (status != STATUS_OK)
        design_free(d);
    return status;
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
