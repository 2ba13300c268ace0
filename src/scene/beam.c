#include "scene/beam.h"

static void mirror(double a[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            a[i][j] = a[j][i];
}

static void stiffness(const Beam *b, double phi, double k[4][4])
{
    const double l = b->length, scale = b->EI / (l * l * l * (1 + phi));
    const double shape[4][4] = {{12, 6 * l, -12, 6 * l},
                                {0, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l},
                                {0, 0, 12, -6 * l},
                                {0, 0, 0, (4 + phi) * l * l}};
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            k[i][j] = scale * shape[i][j];
    mirror(k);
}

static void mass(const Beam *b, double phi, double m[4][4])
{
    const double l = b->length, over = 1 / ((1 + phi) * (1 + phi));
    const double w0 = 70 * phi * phi + 147 * phi + 78, w1 = 35 * phi * phi + 63 * phi + 27;
    const double c0 = (35 * phi * phi + 77 * phi + 44) * l / 4, c1 = (35 * phi * phi + 63 * phi + 26) * l / 4;
    const double r0 = (7 * phi * phi + 14 * phi + 8) * l * l / 4, r1 = (7 * phi * phi + 14 * phi + 6) * l * l / 4;
    const double moved[4][4] = {{w0, c0, w1, -c1}, {0, r0, c1, -r1}, {0, 0, w0, -c0}, {0, 0, 0, r0}};
    const double d = (15 * phi - 3) * l, e0 = (10 * phi * phi + 5 * phi + 4) * l * l,
                 e1 = (5 * phi * phi - 5 * phi - 1) * l * l;
    const double turned[4][4] = {{36, -d, -36, -d}, {0, e0, d, e1}, {0, 0, 36, d}, {0, 0, 0, e0}};
    const double along = b->mass_per_m * l / 210 * over, about = b->rotary_kg_m / (30 * l) * over;
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            m[i][j] = along * moved[i][j] + about * turned[i][j];
    mirror(m);
}

void beam_element(const Beam *b, double k[4][4], double m[4][4])
{
    const double phi = b->kGA > 0 ? 12 * b->EI / (b->kGA * b->length * b->length) : 0;
    stiffness(b, phi, k);
    mass(b, phi, m);
}
