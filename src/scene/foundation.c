#include "scene/foundation.h"

#include "base/keyed.h"
#include "base/text.h"

enum {
    SOIL,
    SHEAR,
    RADIUS,
    NU,
    DENSITY,
    ROTATION,
    TRANSLATION,
    ROTATION_DASHPOT,
    TRANSLATION_DASHPOT,
    WEIGHT,
    ANCHORS,
    N_KEYS
};
static const KeyedNumber KEYS[N_KEYS] = {
    {"soil", 1, 1, 4, 1},
    {"g", 1, 1e3, 1e12, 0},
    {"radius", 1, 0.1, 200, 0},
    {"nu", 1, 1e-3, 0.5, 0},
    {"density", 1, 500, 5000, 0},
    {"rotation", 1, 1e4, 1e20, 0},
    {"translation", 1, 100, 1e20, 0},
    {"rotation_dashpot", 1, 1e-6, 1e30, 0},
    {"translation_dashpot", 1, 1e-6, 1e30, 0},
    {"weight", 1, 1e-6, 1e12, 0},
    {"anchors", 1, 1, INFINITY, 0},
};
static const double NU_OTHERWISE = 0.3, DENSITY_OTHERWISE = 2000; /* [-], [kg/m3] */

/* Site classes A to D: bounds of the velocity of shear waves [m/s], G/G0. */
static const struct {
    double from_m_s, to_m_s, reduced;
} SOILS[] = {{1500, 1500, 1}, {760, 1500, 0.95}, {360, 760, 0.75}, {180, 360, 0.5}};

Status foundation_parse(const char *text, double factor, Foundation *f, Err *err)
{
    double x[N_KEYS] = {0};
    *f = (Foundation){0};
    if (strcmp(text, "fixed") == 0)
        return STATUS_OK;
    TRY(keyed_numbers("core.foundation", text, 1, N_KEYS, KEYS, x, err));
    const double nu = x[NU] > 0 ? x[NU] : NU_OTHERWISE, rho = x[DENSITY] > 0 ? x[DENSITY] : DENSITY_OTHERWISE;
    const double r = x[RADIUS];
    double G = x[SHEAR];
    if (G > 0 && x[SOIL] > 0)
        return bad_data(err, "core.foundation: soil= and g= both give a shear modulus; leave one out");
    if (x[SOIL] > 0) {
        const int k = (int)x[SOIL] - 1;
        G = rho * SOILS[k].from_m_s * SOILS[k].to_m_s * SOILS[k].reduced;
    }
    if (G > 0 && r == 0)
        return bad_data(err, "core.foundation: soil= or g= needs radius= of the foundation [m]");

    /* The disc on the half-space. */
    if (G > 0) {
        G *= factor;
        const double v_s = sqrt(G / rho), c = nu < 1.0 / 3 ? v_s * sqrt(2 * (1 - nu) / (1 - 2 * nu)) : 2 * v_s;
        f->rotation = 8 * G * pow(r, 3) / (3 * (1 - nu));
        f->translation = 8 * G * r / (2 - nu);
        f->rotation_dashpot = rho * c * M_PI * pow(r, 4) / 4;
        f->translation_dashpot = rho * v_s * M_PI * r * r;
        f->cone_s = 9 * M_PI / 32 * (1 - nu) * pow(c / v_s, 2) * r / c;
    }

    /* Springs and dashpots that are given take its place. */
    f->rotation = x[ROTATION] > 0 ? factor * x[ROTATION] : f->rotation;
    f->translation = x[TRANSLATION] > 0 ? factor * x[TRANSLATION] : f->translation;
    if (x[ROTATION_DASHPOT] > 0) {
        f->rotation_dashpot = sqrt(factor) * x[ROTATION_DASHPOT];
        f->cone_s = 0;
    }
    if (x[TRANSLATION_DASHPOT] > 0)
        f->translation_dashpot = sqrt(factor) * x[TRANSLATION_DASHPOT];
    f->radius_m = r;
    f->weight_n = x[WEIGHT];
    f->anchors = isfinite(x[ANCHORS]) ? x[ANCHORS] : 0;
    if (f->rotation == 0 && f->translation == 0)
        return bad_data(err, "core.foundation: nothing gives way: it needs soil=A..D or g= [Pa] with "
                             "radius= [m], or rotation= [N m/rad] or translation= [N/m]; or fixed");
    if (x[ANCHORS] > 0 && (f->radius_m == 0 || f->rotation == 0))
        return bad_data(err, "core.foundation: anchors= needs radius= of the foundation [m] and a spring against "
                             "rotation: soil=, g= or rotation=");
    if ((f->rotation == 0 && f->rotation_dashpot > 0) || (f->translation == 0 && f->translation_dashpot > 0))
        return bad_data(err, "core.foundation: a dashpot needs the spring beside it: rotation= [N m/rad], "
                             "translation= [N/m]");
    return STATUS_OK;
}

double foundation_complete(char text[OPTION_TEXT_MAX], int is_stored)
{
    Foundation f;
    if (foundation_parse(text, 1, &f, NULL) != STATUS_OK)
        return 0;
    if (!is_stored && f.radius_m > 0 && f.rotation > 0 && !strstr(text, "anchors="))
        text_join(text, OPTION_TEXT_MAX, " ", "anchors=1");
    return f.anchors;
}

double foundation_uplift_nm(const Foundation *f, double weight_n)
{
    return weight_n * f->radius_m / 3;
}

double foundation_loss(double K, double C, double omega)
{
    const double ratio = K > 0 ? omega * C / K : 0;
    return C / (1 + ratio * ratio);
}

double foundation_rotation_dashpot(const Foundation *f, double omega)
{
    const double b = omega * f->cone_s;
    return f->cone_s > 0 ? f->rotation_dashpot * b * b / (1 + b * b) : f->rotation_dashpot;
}
