/* Both models of the actuator once more, as plainly as can be: written from the equations of the thesis (chapters 3 to 5, with
 * the corrections of docs/conventions.md) and not from the sources under src/, to check those by something that shares no line with them.
 *
 *     actuator reference|monitoring NAME=VALUE...
 *
 * Names are the thesis's; SI units, but the current and its gains in mA. `command` is 0 diagnostic, 1 step A, 2 ramp A, 3 sine A
 * at F Hz, 4 chirp A from F to G Hz. Prints a line for each millisecond: current (mA), load pressure, jack position, spool position.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double command, A = 0.1, F, G, T = 1.0;
static double GAP = 523.5, GAI, GAD, CorM = 38.0, His, Ofs, threshold, GM = 0.3557, KGM;
static double MF = 3e-3, ZF = 0.6, KF = 27000.0, KSF = 6000.0, Kgioco, XFM = 30e-6, offset;
static double ASV = 2e-5, GPF0 = 4e11, GQF0 = 0.02, CS = 1.0, Kflow = 92300.0, FSS = 0.2, FDS = 0.1, XSM = 1.2e-3, Kintas;
static double PS = 20.6e6, PR = 0.6e6, PSR0 = 20e6, rho = 850.0, nu = 1.4e-5, w = 1.5e-3, HSV = 8.75e-6, Khsv = 1.0, extra, ecc;
static double OSSV = 7.3e-6, ORSV = 7.3e-6, Cd = 0.65, ReT = 260.0, Cgeo = -0.075, Bet = 1.6e9, Vol = 2e-4, Clk = 5.69e-14, PVap = 2000.0;
static double AJ = 8e-4, MJ = 10.0, CJ = 345.0, Kaer, load, FDJ = 200.0, ratio = 2.0, XJM = 0.25, BLK, quantum;
static double SNF = 3316.62, gain = 1000.0, PSR = 20e6, XSS = 43.5e-6, GQ = 0.2062, ClkM = 5.68e-14, QR = 4.5e-6;
static double bell_a = 5.6, bell_b = 1.2, bell_c = 4.0, slope = 1.66667e5, scale = 2e-3, band = 1e-5, fluid = 3.0;

#define P(name) {#name, &name}
static const struct { const char *name; double *value; } names[] = {
    P(command), P(A), P(F), P(G), P(T), P(GAP), P(GAI), P(GAD), P(CorM), P(His), P(Ofs), P(threshold), P(KGM), P(Kgioco), P(offset),
    P(Kflow), P(Kintas), P(PS), P(rho), P(nu), P(Khsv), P(extra), P(ecc), P(OSSV), P(ORSV), P(Clk), P(AJ), P(MJ), P(CJ), P(Kaer), P(load),
    P(FDJ), P(XJM), P(BLK), P(quantum), P(GQ), P(PSR), P(fluid),
};

static const double dt = 1e-5;
static double com(double t) {
    switch ((int)command) {
    case 1: return A;
    case 2: return A * t;
    case 3: return A * sin(2 * M_PI * F * t);
    case 4: return A * sin(2 * M_PI * (F * t + (G - F) * t * t / (2 * T)));
    default: return t < 2 ? 0.1 * t : t < 4 ? 0 : 0.1;
    }
}
static double clip(double x, double most) { return fmin(fmax(x, -most), most); }
static double sgn(double x) { return (x > 0) - (x < 0); }
static void stop(double *x, double *v, double most) {
    if (fabs(*x) > most) { *x = clip(*x, most); *v = 0; }
}
static double play(double width, double out, double in) { return width == 0 ? in : fmin(fmax(out, in - width / 2), in + width / 2); }

/* Section 4.1.3: the flow through a passage that is covered over X0, under a pressure drop. */
static double passage(double X0, double drop) {
    double c = HSV * Khsv + extra, covered = fmax(0, X0), open = fmax(0, -X0), s2 = c * c + open * open, mu = nu * rho;
    if (drop == 0) return 0;
    double RL = 12 * mu * covered / (w * c * c * c * (1 + 1.5 * ecc * ecc));
    double Re = 2 * sqrt(s2) * sqrt(2 * fabs(drop) / rho) / nu;
    double cd = Cd * sqrt(Re / (Re + ReT)) * (1 + Cgeo * c * c / s2);
    double RQ = rho / (2 * cd * cd * w * w * s2);
    /* The thesis's root (-RL + sqrt(RL^2 + 4 RQ |dp|)) / (2 RQ), multiplied out. */
    return sgn(drop) * 2 * fabs(drop) / (RL + sqrt(RL * RL + 4 * RQ * fabs(drop)));
}

static void reference(long k, double out[4]) {
    static double integral, before, asked_before, h, acting, XF, DXF, XS, DXS, P1T, P2T, P1, P2, QJ, XJ, DXJ, surface;
    if (k == 0) P1 = P2 = P1T = P2T = (PS + PR) / 2;
    double measured = quantum > 0 ? round(surface / quantum) * quantum : surface;
    double error = com(k / 1e5) - measured;
    integral += GAI * error * dt;
    double asked = GAP * error + integral + GAD * (error - before) / dt;
    before = error;
    h = asked > asked_before ? 1 : asked < asked_before ? -1 : h;
    asked_before = asked;
    double Cor = clip(asked - His * h + Ofs, CorM);
    acting = play(threshold, acting, Cor);

    double bent = XF + XS, d = bent - clip(bent, Kgioco / 2), CF = 2 * ZF * sqrt(MF * (KSF + KF));
    DXF += (GM * acting * (1 - KGM) - KSF * d - KF * XF - CF * DXF) / MF * dt;
    XF += DXF * dt;
    stop(&XF, &DXF, XFM);

    double intas = 1 - Kintas, supply = (PS - PR) / PSR0, GPF = GPF0 * intas * supply, GQF = GQF0 * sqrt(intas * supply);
    double Fa = ASV * GPF * (XF + offset) - Kflow * QJ, resistance = CS + ASV * ASV * GPF / GQF, v;
    if (DXS == 0) v = fabs(Fa) <= FSS ? 0 : (Fa - sgn(Fa) * FDS) / resistance;
    else { v = (Fa - sgn(DXS) * FDS) / resistance; if (v * DXS < 0) v = 0; }
    DXS = v;
    XS += DXS * dt;
    stop(&XS, &DXS, XSM);

    double Q1S = passage(OSSV - XS, PS - P1), Q1R = passage(ORSV + XS, P1 - PR);
    double Q2S = passage(OSSV + XS, PS - P2), Q2R = passage(ORSV - XS, P2 - PR);
    QJ = AJ * DXJ;
    double QM = QJ + Clk * (P1 - P2);
    P1T += (Q1S - Q1R - QM) * Bet / Vol * dt;
    P2T += (QM - (Q2R - Q2S)) * Bet / Vol * dt;
    P1 = fmax(PVap, P1T);
    P2 = fmax(PVap, P2T);

    double Fj = AJ * (P1 - P2) - CJ * DXJ - Kaer * XJ - load;
    double FF = DXJ == 0 ? clip(Fj, ratio * FDJ) : FDJ * sgn(DXJ);
    v = DXJ + (Fj - FF) / MJ * dt;
    DXJ = v * DXJ < 0 ? 0 : v;
    XJ += DXJ * dt;
    stop(&XJ, &DXJ, XJM);
    surface = play(BLK, surface, XJ);
    out[0] = Cor;
    out[1] = P1 - P2;
    out[2] = quantum > 0 ? round(surface / quantum) * quantum : surface;
    out[3] = XS;
}

static void monitoring(long k, double out[4]) {
    static double XF, DXF, XS, P12, XJ, DXJ;
    double Cor = clip(GAP * (com(k / 1e5) - XJ), CorM), torque = GM * Cor * (1 - KGM) - KSF * XS;
    DXF += (SNF * SNF * (torque / (KF + KSF) - XF) - 2 * ZF * SNF * DXF) * dt;
    XF += DXF * dt;
    stop(&XF, &DXF, XFM);
    XS = clip(XS + gain * XF * dt, XSM);
    /* GPQ does not vary with the supply (section 5.2). */
    double QJ = AJ * DXJ, GP = PSR / XSS, u = XS / XSS, GPQ = PSR0 / XSS / GQ;
    if (fluid == 1) P12 = clip(GP * (XS - QJ / GQ), PSR);
    else if (fluid == 2) P12 = (PSR * XS - GPQ * XSS * QJ) / (fmax(fabs(XS), XSS) + GPQ * XSS * ClkM);
    else {
        double steady = PSR * tanh(u) - QJ * fabs(QJ) / QR / (u * u * GQ / GP + ClkM);
        double tau = scale * bell_a / (bell_b * u * u + bell_c) * (1 + slope * fabs(QJ));
        P12 += (steady - P12) * dt / (tau + dt);
    }
    double Fj = AJ * P12 - CJ * DXJ - Kaer * XJ - load;
    if (fabs(DXJ) <= band) DXJ = fabs(Fj) <= ratio * FDJ ? 0 : DXJ + (Fj - clip(Fj, ratio * FDJ)) / MJ * dt;
    else DXJ += (Fj - FDJ * sgn(DXJ)) / MJ * dt;
    XJ += DXJ * dt;
    stop(&XJ, &DXJ, XJM);
    out[0] = Cor;
    out[1] = P12;
    out[2] = XJ;
    out[3] = XS;
}

int main(int count, char **arguments) {
    void (*step)(long, double[4]) = count > 1 && !strcmp(arguments[1], "monitoring") ? monitoring : reference;
    for (int i = 2; i < count; i++) {
        size_t n = 0;
        while (n < sizeof names / sizeof *names && strncmp(names[n].name, arguments[i], strcspn(arguments[i], "="))) n++;
        char *value = strchr(arguments[i], '=');
        if (!value || n == sizeof names / sizeof *names || strlen(names[n].name) != (size_t)(value - arguments[i])) {
            fprintf(stderr, "actuator: found %s, expected NAME=VALUE of a known name\n", arguments[i]);
            return 2;
        }
        *names[n].value = atof(value + 1);
    }
    double out[4];
    for (long k = 0; k <= lround(T / dt); k++) {
        step(k, out);
        if (k % 100 == 0) printf("%.12g %.12g %.12g %.12g\n", out[0], out[1], out[2], out[3]);
    }
    return 0;
}
