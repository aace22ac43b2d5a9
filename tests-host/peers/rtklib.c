/* RTKLIB's single-point positioning: estpos, and where that refuses, raim_fde, as pntpos calls them.
 *
 * pntpos first computes satellites from ephemerides and ends with the velocity; neither is counted, so the file that holds
 * the two functions is included here and they are called with the satellites' positions given. Its models of the
 * atmosphere and its masks are off, and its variances are chosen so that they come to the epoch's own sigma.
 */
#include "rtklib.h"

/* Calls of trace do nothing in a build without tracing, but their arguments, times as text among them, are made. A
 * port to a microcontroller would take the calls out. */
#ifndef WITH_TRACE_CALLS
#define trace(...) ((void)0)
#endif

#include "pntpos.c"

#include "epoch.h"

/* Models that the options do not choose, and whose files are therefore not compiled: never reached. */
int iontec(gtime_t time, const nav_t *nav, const double *pos, const double *azel, int opt, double *delay, double *var)
{
    abort();
}
int sbsioncorr(gtime_t time, const nav_t *nav, const double *pos, const double *azel, double *delay, double *var)
{
    abort();
}
double sbstropcorr(gtime_t time, const double *pos, const double *azel, double *var)
{
    abort();
}
int getseleph(int sys)
{
    abort();
}

static obsd_t observations[SATELLITES];
static nav_t navigation;
static prcopt_t options;
static sol_t solution;
static double satellites_m[6 * SATELLITES], clocks_s[2 * SATELLITES], variances_m2[SATELLITES];
static double directions_rad[2 * SATELLITES], residuals_m[SATELLITES];
static int health[SATELLITES], is_used[SATELLITES];
static char message[256];
static int code;

/* Neither model nor variance for the atmosphere: the ranges are corrected. */
static void choose_options(void)
{
    memset(&options, 0, sizeof options);
    options.mode = PMODE_SINGLE;
    options.navsys = SYS_GPS | SYS_CMP;
    options.nf = 1;
    options.ionoopt = IONOOPT_EST;
    options.tropopt = TROPOPT_ZTD;
    options.maxgdop = 30.0;
    options.posopt[4] = 1; /* RAIM FDE */
}

void peer_prepare(const struct epoch *epoch, const double start_m[3])
{
    choose_options();
    memset(&solution, 0, sizeof solution);
    memset(observations, 0, sizeof observations);
    memset(satellites_m, 0, sizeof satellites_m);
    memcpy(solution.rr, start_m, 3 * sizeof *start_m);
    for (int index = 0; index < SATELLITES; index++) {
        const struct satellite *satellite = &epoch->satellites[index];
        const int is_beidou = satellite->letter == 'C';
        observations[index].time.time = 1704240000;
        observations[index].sat = (uint8_t)satno(is_beidou ? SYS_CMP : SYS_GPS, satellite->number);
        observations[index].code[0] = is_beidou ? CODE_L2I : CODE_L1P;
        observations[index].P[0] = satellite->range_m;
        memcpy(&satellites_m[6 * index], satellite->position_m, sizeof satellite->position_m);
        /* To the satellite's variance it adds that of the code's bias; its own for the range is switched off. */
        variances_m2[index] = SQR(satellite->sigma_m) - SQR(ERR_CBIAS);
    }
}

void peer_run(void)
{
    code = estpos(observations, SATELLITES, satellites_m, clocks_s, variances_m2, health, &navigation, &options, &solution,
                  directions_rad, is_used, residuals_m, message);
    if (!code && options.posopt[4]) {
        code = raim_fde(observations, SATELLITES, satellites_m, clocks_s, variances_m2, health, &navigation, &options,
                        &solution, directions_rad, is_used, residuals_m, message);
    }
}

void peer_answer(struct answer *answer)
{
    answer->code = code;
    answer->is_valid = code && solution.stat == SOLQ_SINGLE;
    memcpy(answer->position_m, solution.rr, sizeof answer->position_m);
    for (int index = 0; index < SATELLITES; index++) {
        answer->is_out[index] = (char)(code && !is_used[index]);
    }
}
