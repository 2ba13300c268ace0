/* SimCenter events and ground-motion records (NHERI, EE-UQ, s3hark), JSON: wherever an object has a step "dT" and
 * samples "data", or "data_x", "data_y", "data_z", each list is a channel, named by "name". The unit is that of
 * "unit" or "units" beside them or above, else it is asked for. A "factor" beside the samples multiplies them, as in
 * SimCenter's IntensityMeasureComputer and in the series that it hands to OpenSees. */
#include <jansson.h>

#include "motion/formats/record.h"

enum { DEPTH_MAX = 32 };

typedef struct {
    Record *r;
    const Lines *l;
    Channel shape; /* unit, scale, warning */
    const char *name;
    double count; /* "numSteps"; 0: none is stated */
} Place;

static size_t blanks_before(const char bytes[], size_t n)
{
    size_t i = n > 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; /* UTF-8 byte order mark */
    while (i < n && bytes[i] && strchr(" \t\r\n", bytes[i]))
        i++;
    return i;
}

static int recognise(const char bytes[], size_t n)
{
    const size_t i = blanks_before(bytes, n);
    return i < n && bytes[i] == '{';
}

/* Makes a channel of a list of samples. */
static Status add_channel(const Place *place, const json_t *list, double dt, const char *axis, Err *err)
{
    Channel *c;
    const size_t n = json_array_size(list);
    if (!(dt > 0 && dt <= MOTION_STEP_MAX_S))
        return bad_data(err, "%s: SimCenter: no usable step: dT is %g", place->l->path, dt);
    if (place->count > 0 && place->count != n && place->count + 1 != n)
        return bad_data(err, "%s: SimCenter: '%s' has %zu samples, but numSteps announces %g", place->l->path,
                        place->name, n, place->count);
    TRY(record_channel(place->r, place->l, &c, err));
    const size_t first = c->first;
    *c = place->shape;
    c->first = first;
    c->dt = dt;
    c->n = n;
    channel_named(c, "%s%s%s", place->name, *place->name && *axis ? " " : "", axis);
    if (place->count + 1 == n && !c->warning)
        c->warning = "its numSteps is one less than its samples";
    for (size_t i = 0; i < n; i++) {
        const json_t *x = json_array_get(list, i);
        if (!json_is_number(x) || !isfinite(json_number_value(x)))
            return bad_data(err, "%s: SimCenter: sample %zu of '%s' is no number", place->l->path, i, c->name);
        TRY(record_add(place->r, (Row){.a = json_number_value(x), .line = 1}, err));
    }
    return STATUS_OK;
}

/* Takes unit and factor that an object states beside its samples, and refuses what is no acceleration: wind and waves
 * come as forces. Which of the factors of event and pattern multiply the samples differs from program to program. */
static Status read_shape(const Lines *l, const json_t *o, Channel *c, Err *err)
{
    static const char *const FACTORS[] = {"factor", "scale_factor", "scaleFactor", "scale"};
    const json_t *units = json_object_get(o, "units"), *factor = json_object_get(o, "factor");
    const char *text = json_string_value(json_object_get(o, "unit")),
               *type = json_string_value(json_object_get(o, "type"));
    text = text ? text : json_string_value(units);
    text = text ? text : json_string_value(json_object_get(units, "acceleration"));
    if (text && *text)
        channel_unit(c, text, text + strlen(text));
    if (type && text_is(BEGINS, type, type + strlen(type), "wind|water|wave|hydro|tsunami|surge|force"))
        return fail_sub(err, STATUS_BAD_DATA, SUB_NO_RECORD, "%s: not an acceleration: \"type\" is \"%.40s\"", l->path,
                        type);
    if (json_is_number(factor) && json_is_number(json_object_get(o, "dT")) && json_number_value(factor) != 1 &&
        isfinite(json_number_value(factor))) {
        c->scale *= json_number_value(factor);
        c->warning = "its samples are multiplied by the factor that stands beside them";
    }
    for (size_t k = 0; k < N_OF(FACTORS); k++) {
        const json_t *x = json_object_get(o, FACTORS[k]);
        if (x && !(json_is_number(x) && json_number_value(x) == 1) && c->scale == 1)
            return bad_data(err,
                            "%s: SimCenter: \"%s\" is not 1; multiply the samples by it, or leave it out and set "
                            "motion.factor",
                            l->path, FACTORS[k]);
    }
    return STATUS_OK;
}

/* Looks for lists of samples in a node and in all that it holds; what an object states holds for those inside it. */
static Status search(Place place, const json_t *node, int depth, Err *err)
{
    static const char *const LISTS[] = {"data", "data_x", "data_y", "data_z"};
    static const char *const AXES[] = {"", "x", "y", "z"};
    const char *key;
    json_t *value;
    size_t i;
    if (depth > DEPTH_MAX)
        return STATUS_OK;
    if (json_is_array(node)) {
        json_array_foreach((json_t *)node, i, value) TRY(search(place, value, depth + 1, err));
        return STATUS_OK;
    }
    if (!json_is_object(node))
        return STATUS_OK;
    const json_t *name = json_object_get(node, "name"), *dt = json_object_get(node, "dT");
    place.name = json_is_string(name) ? json_string_value(name) : place.name;
    place.count = json_number_value(json_object_get(node, "numSteps"));
    TRY(read_shape(place.l, node, &place.shape, err));
    for (size_t k = 0; k < N_OF(LISTS) && json_is_number(dt); k++)
        if (json_is_array(json_object_get(node, LISTS[k])))
            TRY(add_channel(&place, json_object_get(node, LISTS[k]), json_number_value(dt), AXES[k], err));
    json_object_foreach((json_t *)node, key, value) TRY(search(place, value, depth + 1, err));
    return STATUS_OK;
}

/* Parses the file, without what old programs put behind it. */
static Status read(Record *r, const char *path, const char *bytes, size_t n, Err *err)
{
    json_error_t why;
    const Lines l = {.path = path, .number = 1};
    const size_t begin = blanks_before(bytes, n);
    while (n > begin && strchr("\x1a", bytes[n - 1])) /* Ctrl-Z or NUL at the end */
        n--;
    json_t *root = json_loadb(bytes + begin, n - begin, 0, &why);
    if (!root)
        return bad_data(err, "%s:%d: no JSON: %s", path, why.line, why.text);
    Status status = search((Place){.r = r, .l = &l, .name = "", .shape = {.scale = 1, .stride = 1}}, root, 0, err);
    json_decref(root);
    if (status == STATUS_OK && r->n_channels == 0)
        status = bad_data(err, "%s: JSON without a step dT and samples data (SimCenter)", path);
    return status;
}

const BinaryFormat FORMAT_SIMCENTER = {"simcenter", recognise, read};
