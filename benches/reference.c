/* The reference model's time loop in plain C, to measure the program's own against: the nominal actuator (fixed gain,
 * proportional controller, Borello's friction, no play, no quantizer, no noise) on the diagnostic command. Semi-implicit,
 * in the order of docs/architecture.md's models::reference.
 *
 * Reads its parameters from standard input in the order of struct params, then the number of steps and of repeats.
 * Prints the least time of a step in ns, then current, load pressure, jack position and the sum of the jack's positions
 * after the last step, so that the caller can compare them bit by bit. Compile without contraction: -ffp-contract=off.
 */
#include <math.h>
#include <stdio.h>
#include <time.h>

struct params {
    double dt, gain, current_max, force_gain;
    double flapper_mass, damping_ratio, armature_stiffness, spring_stiffness, flapper_max;
    double end_area, pressure_gain, flow_gain, spool_damping, flow_force, spool_static, spool_dynamic, spool_max, supply_ratio;
    double supply, ret, density, viscosity, width, clearance, overlap_supply, overlap_return, discharge, reynolds, correction;
    double bulk, volume, leakage, vapour;
    double area, mass, jack_damping, jack_static, jack_dynamic, jack_max;
};

static double clip(double x, double limit) {
    return x > limit ? limit : x < -limit ? -limit : x;
}

static void stop(double limit, double *x, double *v) {
    if (fabs(*x) > limit) {
        *v = 0.0;
        *x = clip(*x, limit);
    }
}

struct passage {
    double clearance2, laminar, two_over_density, two_over_viscosity, reynolds, correction, quadratic;
};

static inline double flow(const struct passage *p, double covered, double drop) {
    double magnitude = fabs(drop);
    if (magnitude < 1e-200)
        return 0.0;
    double opening = covered < 0.0 ? -covered : 0.0;
    double gap2 = p->clearance2 + opening * opening;
    double laminar = p->laminar * (covered > 0.0 ? covered : 0.0);
    double re = p->two_over_viscosity * sqrt(gap2 * (p->two_over_density * magnitude));
    double geometry = 1.0 + p->correction / gap2;
    double quadratic = p->quadratic * (re + p->reynolds) * magnitude / (re * geometry * geometry * gap2);
    return copysign(2.0 * magnitude / (laminar + sqrt(laminar * laminar + 4.0 * quadratic)), drop);
}

static double command(double t) {
    return t < 2.0 ? 0.1 * t : t < 4.0 ? 0.0 : 0.1;
}

static void run(const struct params *p, long steps, double out[4]) {
    const double dt = p->dt, per_s = round(1.0 / dt);
    const double flapper_damping =
        2.0 * p->damping_ratio * sqrt(p->flapper_mass * (p->spring_stiffness + p->armature_stiffness));
    const double open = 1.0 * p->supply_ratio;
    const double force_per_m = p->end_area * (p->pressure_gain * open);
    const double resistance =
        p->spool_damping + p->end_area * p->end_area * (p->pressure_gain / p->flow_gain * sqrt(open));
    const double c = p->clearance, discharge_width = p->discharge * p->width;
    const struct passage w = {
        c * c, 12.0 * (p->viscosity * p->density) / (p->width * (c * c * c)), 2.0 / p->density, 2.0 / p->viscosity,
        p->reynolds, p->correction * c * c, p->density / (2.0 * discharge_width * discharge_width)};
    const double stiffness = p->bulk / p->volume;
    double cor = 0, xf = 0, dxf = 0, xs = 0, dxs = 0, xj = 0, dxj = 0, qj = 0, sum = 0;
    double p1 = 0.5 * (p->supply + p->ret), p2 = p1, p1t = p1, p2t = p1;
    for (long k = 0; k < steps; k++) {
        cor = clip((command((double)k / per_s) - xj) * p->gain, p->current_max);
        double fm = cor * p->force_gain;
        double net = fm - p->spring_stiffness * (xf + xs) - p->armature_stiffness * xf - flapper_damping * dxf;
        dxf += net / p->flapper_mass * dt;
        xf += dxf * dt;
        stop(p->flapper_max, &xf, &dxf);
        double active = force_per_m * xf - p->flow_force * qj;
        if (dxs != 0.0) {
            double v = (active - copysign(p->spool_dynamic, dxs)) / resistance;
            dxs = dxs * v < 0.0 ? 0.0 : v;
        } else if (fabs(active) > p->spool_static) {
            dxs = (active - copysign(p->spool_dynamic, active)) / resistance;
        }
        xs += dxs * dt;
        stop(p->spool_max, &xs, &dxs);
        double q1s = flow(&w, p->overlap_supply - xs, p->supply - p1), q1r = flow(&w, p->overlap_return + xs, p1 - p->ret);
        double q2s = flow(&w, p->overlap_supply + xs, p->supply - p2), q2r = flow(&w, p->overlap_return - xs, p2 - p->ret);
        qj = p->area * dxj;
        double absorbed = qj + p->leakage * (p1 - p2);
        p1t += (q1s - q1r - absorbed) * (stiffness * dt);
        p2t += (absorbed - (q2r - q2s)) * (stiffness * dt);
        p1 = p1t > p->vapour ? p1t : p->vapour;
        p2 = p2t > p->vapour ? p2t : p->vapour;
        double force = (p1 - p2) * p->area - p->jack_damping * dxj;
        double friction = dxj == 0.0 ? clip(force, p->jack_static) : copysign(p->jack_dynamic, dxj);
        double v = dxj + (force - friction) / p->mass * dt;
        dxj = dxj * v < 0.0 ? 0.0 : v;
        xj += dxj * dt;
        stop(p->jack_max, &xj, &dxj);
        sum += xj;
    }
    out[0] = cor;
    out[1] = p1 - p2;
    out[2] = xj;
    out[3] = sum;
}

int main(void) {
    struct params p;
    double *values = (double *)&p, out[4] = {0};
    long steps, repeats;
    for (unsigned i = 0; i < sizeof p / sizeof *values; i++)
        if (scanf("%lf", &values[i]) != 1)
            return 2;
    if (scanf("%ld %ld", &steps, &repeats) != 2)
        return 2;
    double least = INFINITY;
    for (long r = 0; r < repeats; r++) {
        struct timespec a, b;
        clock_gettime(CLOCK_MONOTONIC, &a);
        run(&p, steps, out);
        clock_gettime(CLOCK_MONOTONIC, &b);
        least = fmin(least, (double)(b.tv_sec - a.tv_sec) * 1e9 + (double)(b.tv_nsec - a.tv_nsec));
    }
    printf("%.3f %.17g %.17g %.17g %.17g\n", least / (double)steps, out[0], out[1], out[2], out[3]);
    return 0;
}
