#include "scene/wall.h"

enum { STIFFENERS_MAX = 200 };
static const double SLENDER = 10; /* height over thickness of a bar */

double wall_buckling_pa(const CoreOptions *o, double t, double storey_m)
{
    const double b = o->width_m - 2 * t, nu = o->poisson, euler = M_PI * M_PI * o->youngs_modulus_pa;
    const double plate = 4 * euler / (12 * (1 - nu * nu));
    double most = plate * (t / b) * (t / b);
    for (int n = 1; n <= STIFFENERS_MAX && o->stiffeners > 0; n++) {
        const double width = b / (n + 1), bar = o->stiffeners * b * t / n, height = sqrt(SLENDER * bar);
        const double area = bar + width * t, apart = 0.5 * (height + t);
        const double inertia =
            (width * t * t * t + bar * height * height) / 12 + bar * width * t / area * apart * apart;
        const double column = euler * inertia / (area * storey_m * storey_m);
        most = fmax(most, fmin(column, plate * (t / width) * (t / width)));
    }
    return most;
}

/* A square tube of side and thickness 1: its second moment of area, and the distance of the compressed flange from the
 * axis, of which rho is left; webs whole up to `whole` from the opposite flange and from `again` on. */
static double square_tube(double rho, double whole, double again, double *to_flange)
{
    const double area = rho + 1 + 2 * (whole + 1 - again);
    const double axis = (rho + whole * whole + 1 - again * again) / area;
    *to_flange = 1 - axis;
    return rho + 2.0 / 3 * (pow(whole, 3) + 1 - pow(again, 3)) - area * axis * axis;
}

static double effective_width(double slenderness, double psi)
{
    const double l = slenderness;
    return l > 0.5 + sqrt(0.085 - 0.055 * psi) ? (l - 0.055 * (3 + psi)) / (l * l) : 1;
}

WallState wall_effective(double gross, double buckling_pa)
{
    static const double WHOLE = 2.0 / 3, HALF = 0.5; /* of the tube: second moment, axis to flange */
    WallState w = {gross, 1};
    for (int i = 0; i < 60; i++) { /* each halves what the logarithm of the stress is off, at least */
        const double l = sqrt(w.stress / buckling_pa), rho = effective_width(l, 1);
        double to_flange;
        square_tube(rho, 1, 1, &to_flange);
        const double psi = (to_flange - 1) / to_flange, k = 7.81 - 6.29 * psi + 9.78 * psi * psi;
        const double web = effective_width(l * sqrt(4 / k), psi) * to_flange;
        const double inertia = square_tube(rho, 1 - to_flange + 0.6 * web, 1 - 0.4 * web, &to_flange);
        w = (WallState){gross * (to_flange / HALF) * (WHOLE / inertia), inertia / WHOLE};
    }
    return w;
}
