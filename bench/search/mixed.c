#include "bench/search/mixed.h"

static const double SIXTEENTH = 1.0 / 16.0;

/* Of steel, cast iron, aluminium, brass: allowed stress, modulus, shear modulus [psi], cost of weld and bar [1/in3]. */
static const struct {
    double strength, E, G, weld, bar;
} MATERIAL[] = {{30e3, 30e6, 12e6, 0.1047, 0.0481},
                {8e3, 14e6, 6e6, 0.0489, 0.0224},
                {5e3, 10e6, 4e6, 0.5235, 0.2405},
                {8e3, 16e6, 6e6, 0.5584, 0.2566}};

/* x: sides (0: two, 1: four), material, weld h and bar b in sixteenths, length l and height t of the weld. */
static void beam(const double x[], double f[2], double g[])
{
    const double P = 6000.0, L = 14.0, h = SIXTEENTH * x[2], b = SIXTEENTH * x[3], l = x[4], t = x[5];
    const int four = x[0] > 0.5, m = (int)x[1];
    const double length = four ? 2.0 * (l + t) : 2.0 * l, A = M_SQRT1_2 * h * length;
    const double J =
        M_SQRT1_2 * h * (l * (l * l / 6.0 + t * t / 2.0) + four * t * (t * t / 6.0 + l * l / 2.0)); /* line welds */
    const double R = 0.5 * hypot(l, t), direct = P / A, turned = P * (L + 0.5 * l) * R / J;
    const double shear = sqrt(direct * direct + turned * turned + direct * turned * l / R);
    const double bending = 6.0 * P * L / (b * t * t), E = MATERIAL[m].E, G = MATERIAL[m].G;
    const double buckling = 4.013 * t * b * b * b * sqrt(E * G) / (6.0 * L * L) * (1.0 - 0.25 * t / L * sqrt(E / G));
    f[0] = (1.0 + MATERIAL[m].weld) * h * h * 0.5 * length + MATERIAL[m].bar * t * b * (L + l);
    f[1] = 4.0 * P * L * L * L / (E * b * t * t * t);
    g[0] = shear / (0.577 * MATERIAL[m].strength) - 1.0;
    g[1] = bending / MATERIAL[m].strength - 1.0;
    g[2] = 1.0 - buckling / P;
    g[3] = h / b - 1.0;
}

/* x: width b, module m, teeth z, lengths l1, l2 and diameters d1, d2 of the shafts [cm]. */
static void reducer(const double x[], double f[2], double g[])
{
    const double b = x[0], m = x[1], z = x[2], l1 = x[3], l2 = x[4], d1 = x[5], d2 = x[6];
    const double stress1 = hypot(745.0 * l1 / (m * z), sqrt(16.9e6)) / (0.1 * d1 * d1 * d1);
    const double stress2 = hypot(745.0 * l2 / (m * z), sqrt(157.5e6)) / (0.1 * d2 * d2 * d2);
    f[0] = 0.7854 * b * m * m * (10.0 / 3.0 * z * z + 14.933 * z - 43.0934) - 1.508 * b * (d1 * d1 + d2 * d2) +
           7.477 * (d1 * d1 * d1 + d2 * d2 * d2) + 0.7854 * (l1 * d1 * d1 + l2 * d2 * d2);
    f[1] = stress1;
    g[0] = 27.0 / (b * m * m * z) - 1.0;
    g[1] = 397.5 / (b * m * m * z * z) - 1.0;
    g[2] = 1.93 * l1 * l1 * l1 / (m * z * d1 * d1 * d1 * d1) - 1.0;
    g[3] = 1.93 * l2 * l2 * l2 / (m * z * d2 * d2 * d2 * d2) - 1.0;
    g[4] = m * z / 40.0 - 1.0;
    g[5] = b / (12.0 * m) - 1.0;
    g[6] = 5.0 * m / b - 1.0;
    g[7] = (1.5 * d1 + 1.9) / l1 - 1.0;
    g[8] = (1.1 * d2 + 1.9) / l2 - 1.0;
    g[9] = stress1 / 1300.0 - 1.0;
    g[10] = stress2 / 1100.0 - 1.0;
}

/* x: plates of shell and heads in sixteenths, radius, length. */
static void vessel(const double x[], double f[2], double g[])
{
    const double shell = SIXTEENTH * x[0], head = SIXTEENTH * x[1], R = x[2], L = x[3];
    f[0] = 0.6224 * shell * R * L + 1.7781 * head * R * R + 3.1661 * shell * shell * L + 19.84 * shell * shell * R;
    f[1] = -M_PI * R * R * (L + 4.0 / 3.0 * R);
    g[0] = 0.0193 * R / shell - 1.0;
    g[1] = 0.00954 * R / head - 1.0;
}

const Mixed MIXED_BEAM = {
    beam,
    {VARIABLE_CHOICE, VARIABLE_CHOICE, VARIABLE_WHOLE, VARIABLE_WHOLE, VARIABLE_REAL, VARIABLE_REAL},
    {0, 0, 1, 1, 0.1, 2},
    {1, 3, 32, 32, 10, 20}};
const Mixed MIXED_REDUCER = {reducer,
                             {VARIABLE_REAL, VARIABLE_REAL, VARIABLE_WHOLE},
                             {2.6, 0.7, 17, 7.3, 7.3, 2.9, 5.0},
                             {3.6, 0.8, 28, 8.3, 8.3, 3.9, 5.5}};
const Mixed MIXED_VESSEL = {vessel, {VARIABLE_WHOLE, VARIABLE_WHOLE}, {1, 1, 10, 10}, {99, 99, 200, 240}};
