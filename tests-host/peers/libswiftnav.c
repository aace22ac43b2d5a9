/* libswiftnav's single-epoch solver: calc_PVT, with its RAIM.
 *
 * It takes no start: each solution begins at the centre of the earth. Its noise model is a variance per constellation,
 * plus a term of the signal strength and one of the elevation; each satellite stands at the zenith here, locked for long,
 * with the strength at which the model gives the epoch's own sigma. Ranges come corrected, as it wants them.
 */
#include <math.h>
#include <string.h>

#include <swiftnav/single_epoch_solver.h>

#include "epoch.h"

static navigation_measurement_t measurements[SATELLITES];
static gps_time_t received = {.tow = 86400.0, .wn = 2295};
static gnss_solution solution;
static gnss_sid_set_t removed;
static s8 code;

/* Variance that the model has of a signal at the zenith, m², before the strength. */
static double nominal_m2(char letter)
{
    return letter == 'C' ? 0.5 + 0.1 : 0.4 + 0.1;
}

/* Strength at which the model's variance, which adds 780 m² exp(-strength / 6.5 dBHz), is that of the epoch, dBHz. */
static double strength_dbhz(const struct satellite *satellite)
{
    const double rest_m2 = satellite->sigma_m * satellite->sigma_m - nominal_m2(satellite->letter);
    return 6.5 * log(780.0 / rest_m2);
}

void peer_prepare(const struct epoch *epoch, const double start_m[3])
{
    (void)start_m;
    memset(measurements, 0, sizeof measurements);
    memset(&solution, 0, sizeof solution);
    memset(&removed, 0, sizeof removed);
    for (int index = 0; index < SATELLITES; index++) {
        const struct satellite *satellite = &epoch->satellites[index];
        navigation_measurement_t *measurement = &measurements[index];
        measurement->raw_pseudorange = satellite->range_m;
        memcpy(measurement->sat_pos, satellite->position_m, sizeof measurement->sat_pos);
        measurement->cn0 = strength_dbhz(satellite);
        measurement->lock_time = 100.0;
        measurement->elevation = 90.0;
        measurement->tot = received;
        measurement->sid.sat = (u16)satellite->number;
        measurement->sid.code = satellite->letter == 'C' ? CODE_BDS2_B1 : CODE_GPS_L1CA;
        measurement->flags = NAV_MEAS_FLAG_CODE_VALID | NAV_MEAS_FLAG_PHASE_VALID | NAV_MEAS_FLAG_CN0_VALID;
    }
}

void peer_run(void)
{
    static const obs_mask_config_t no_mask = {.cn0_mask = {.enable = false}};
    const bool disable_raim = false, disable_velocity = true;
    dops_t dops;
    code = calc_PVT(SATELLITES, measurements, &received, disable_raim, disable_velocity, &no_mask, ALL_CONSTELLATIONS,
                    &solution, &dops, &removed);
}

void peer_answer(struct answer *answer)
{
    answer->code = code;
    answer->is_valid = code >= 0 && solution.valid;
    memcpy(answer->position_m, solution.pos_ecef, sizeof answer->position_m);
    for (int index = 0; index < SATELLITES; index++) {
        answer->is_out[index] = (char)sid_set_contains(&removed, measurements[index].sid);
    }
}
