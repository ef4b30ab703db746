/* The monitoring model's large step in plain C, to measure the program's own against: 40 candidates in lock-step on the
 * diagnostic command, in a loop that the compiler makes vectors of. The same equations as src/models/monitoring/large_step.rs
 * and the same time steps as src/estimation/evaluate.rs.
 *
 * Reads from standard input its parameters in the order of struct params, the candidates (KGM and FDJ in N, one after the
 * other), the servovalve's transition matrices for the whole step and for the half, row by row, and the command at every half
 * step from 0 on. Then it answers every number of repeats that it is given: the least time of a batch in ms, and after the
 * first the features of each candidate: current and pressure of the ramp, current and pressure after the step.
 * Compile without contraction: -ffp-contract=off.
 */
#include <math.h>
#include <stdio.h>
#include <time.h>

enum { CANDIDATES = 40, VALUES = 4 };
/* In steps of 0.5 ms: the end, the two windows, and where the steps are halved. Step k ends at the time k. */
enum { END = 10221, RAMP = 3600, RAMP_END = 3801, STEP = 10180, HALF = 8000, HALF_END = 8100 };

struct params {
    double h, gain, current_max, force_gain;
    double flapper_max, spool_gain, spool_max;
    double supply, saturation, flow_gain, leakage, flow_reference, lag_scale, bell_a, bell_b, bell_c, lag_slope;
    double dead_band, area, mass, damping, static_ratio, jack_max;
};

/* On the borders of cache lines, for a vector over two of them takes twice the time. */
struct states {
    _Alignas(64) double current[CANDIDATES], flapper[CANDIDATES], flapper_speed[CANDIDATES], spool[CANDIDATES], pressure[CANDIDATES],
        jack[CANDIDATES], jack_speed[CANDIDATES];
};

struct candidates {
    _Alignas(64) double kgm[CANDIDATES], fdj[CANDIDATES];
};

static double command[2 * END - 1];
static double transition[2][3][4];

static inline double clip(double x, double limit) {
    x = x < limit ? x : limit;
    return -limit < x ? x : -limit;
}

static inline double sign_times(double x, double magnitude) {
    return x < 0.0 ? -magnitude : magnitude;
}

/* The same polynomials as src/numeric/tanh.rs. */
static inline double tangent(double x) {
    double y = clip(x, 20.0) * (1.0 / 32.0), z = y * y;
    double s = z * (1.0 / 6227020800.0) + 1.0 / 39916800.0;
    s = (s * z + 1.0 / 362880.0) * z + 1.0 / 5040.0;
    s = ((s * z + 1.0 / 120.0) * z + 1.0 / 6.0) * z + 1.0;
    double c = z * (1.0 / 87178291200.0) + 1.0 / 479001600.0;
    c = (c * z + 1.0 / 3628800.0) * z + 1.0 / 40320.0;
    c = ((c * z + 1.0 / 720.0) * z + 1.0 / 24.0) * z + 0.5;
    double sinh = y * s, cosh = c * z + 1.0;
    for (int k = 0; k < 5; k++) {
        double doubled = sinh * cosh * 2.0;
        cosh = cosh * cosh + sinh * sinh;
        sinh = doubled;
    }
    return sinh / cosh;
}

static inline __attribute__((always_inline)) void advance(const struct params *restrict p, const struct candidates *restrict f,
                                                          struct states *restrict s, const double t[3][4], double h, double com) {
    const double per_saturation = 1.0 / p->saturation, per_reference = 1.0 / p->flow_reference;
    const double flow_per_pressure = p->flow_gain / (p->supply / p->saturation), lag_numerator = p->lag_scale * p->bell_a;
    const double spool_gain = p->spool_gain * h;
    for (int i = 0; i < CANDIDATES; i++) {
        double jack = s->jack[i], speed = s->jack_speed[i], xf = s->flapper[i], dxf = s->flapper_speed[i], xs = s->spool[i];
        double cor = clip((com - jack) * p->gain, p->current_max);
        double force = cor * p->force_gain * (1.0 - f->kgm[i]);
        double free = xf * t[0][0] + dxf * t[0][1] + xs * t[0][2] + force * t[0][3];
        double free_speed = xf * t[1][0] + dxf * t[1][1] + xs * t[1][2] + force * t[1][3];
        double free_spool = xf * t[2][0] + dxf * t[2][1] + xs * t[2][2] + force * t[2][3];
        free_speed = p->flapper_max < fabs(free) ? 0.0 : free_speed;
        double flapper = clip(free, p->flapper_max);
        double against_stop = xs + flapper * spool_gain;
        double spool = clip(p->flapper_max < fabs(free) ? against_stop : free_spool, p->spool_max);
        double u = spool * per_saturation, u2 = u * u;
        double loss = per_reference / (u2 * flow_per_pressure + p->leakage);
        double lag = lag_numerator / (u2 * p->bell_b + p->bell_c);
        double commanded = tangent(u) * p->supply;
        double flow = speed * p->area, magnitude = fabs(flow);
        double weight = h / (lag * (magnitude * p->lag_slope + 1.0) + h);
        double kept = s->pressure[i] + (commanded - s->pressure[i]) * weight;
        double slope = weight * loss * magnitude;
        double free_pressure = kept + slope * flow;
        double per_speed = slope * (2.0 * p->area);
        double resting = kept * p->area, driving = free_pressure * p->area;
        double inertia = (per_speed * p->area + p->damping) * h + p->mass;
        double most = f->fdj[i] * p->static_ratio;
        int sliding = p->dead_band < fabs(speed);
        double friction = sliding ? sign_times(speed, f->fdj[i]) : clip(resting, most);
        double moved = (speed * p->mass + (driving - friction) * h) / inertia;
        double let_go = most < fabs(resting) ? moved : 0.0;
        double turned = moved * speed < 0.0 ? 0.0 : moved;
        moved = sliding ? turned : let_go;
        s->pressure[i] = fabs(moved) < 2.2250738585072014e-308 ? kept : free_pressure - per_speed * moved;
        double position = jack + moved * h;
        s->jack_speed[i] = p->jack_max < fabs(position) ? 0.0 : moved;
        s->jack[i] = clip(position, p->jack_max);
        s->current[i] = cor;
        s->flapper[i] = flapper;
        s->flapper_speed[i] = free_speed;
        s->spool[i] = spool;
    }
}

static void add(const struct states *s, double *current, double *pressure) {
    for (int i = 0; i < CANDIDATES; i++) {
        current[i] += s->current[i];
        pressure[i] += s->pressure[i];
    }
}

static void run(const struct params *restrict p, const struct candidates *restrict f, double out[VALUES][CANDIDATES]) {
    struct states s = {0};
    for (int v = 0; v < VALUES; v++)
        for (int i = 0; i < CANDIDATES; i++)
            out[v][i] = 0.0;
    for (int k = 0; k < END; k++) {
        if (HALF <= k && k < HALF_END)
            for (int half = 1; half >= 0; half--)
                advance(p, f, &s, transition[1], 0.5 * p->h, command[2 * k - half]);
        else
            advance(p, f, &s, transition[0], p->h, command[2 * k]);
        if (RAMP <= k && k < RAMP_END)
            add(&s, out[0], out[1]);
        if (STEP <= k)
            add(&s, out[2], out[3]);
    }
    for (int v = 0; v < VALUES; v++)
        for (int i = 0; i < CANDIDATES; i++)
            out[v][i] *= 1.0 / (v < 2 ? RAMP_END - RAMP : END - STEP);
}

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

int main(void) {
    struct params p;
    struct candidates f;
    static _Alignas(64) double out[VALUES][CANDIDATES];
    double *values = (double *)&p;
    for (unsigned i = 0; i < sizeof p / sizeof *values; i++)
        if (scanf("%lf", &values[i]) != 1)
            return 2;
    for (int i = 0; i < CANDIDATES; i++)
        if (scanf("%lf %lf", &f.kgm[i], &f.fdj[i]) != 2)
            return 2;
    for (int i = 0; i < 2 * 3 * 4; i++)
        if (scanf("%lf", &transition[i / 12][i / 4 % 3][i % 4]) != 1)
            return 2;
    for (int i = 0; i < 2 * END - 1; i++)
        if (scanf("%lf", &command[i]) != 1)
            return 2;
    int repeats, told = 0;
    while (scanf("%d", &repeats) == 1) {
        double least = INFINITY;
        for (int r = 0; r < repeats; r++) {
            double started = now_ms();
            run(&p, &f, out);
            least = fmin(least, now_ms() - started);
        }
        printf("%.6f\n", least);
        for (int v = 0; v < VALUES && !told; v++)
            for (int i = 0; i < CANDIDATES; i++)
                printf("%.17g\n", out[v][i]);
        told = 1;
        fflush(stdout);
    }
    return 0;
}
