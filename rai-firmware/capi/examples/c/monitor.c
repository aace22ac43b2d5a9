/* Ranges in, verdict out: one epoch of seven satellites, with an error of 80 m on G05. */
#include <stdio.h>

#include "rai.h"

/* Memory of the monitor, static, so that it needs no heap and no stack. */
static rai_monitor_t monitor;

int main(void)
{
    /* Seven satellites 22,000 km away, seen from Esbjerg; all ranges except that of G05 are exact. */
    static const double positions[7][3] = {
        {15909567.8, 2365446.2, 23362131.7}, {-3367221.5, -500641.0, 26080759.6},
        {25324386.9, 3765248.4, 6140002.4},  {8390254.2, 19040938.2, 16110381.0},
        {13566911.3, -15776330.8, 16110381.0}, {922952.3, 13482327.0, 22817783.2},
        {1054936.5, -10519232.7, 24086683.9},
    };
    static rai_range_t ranges[7];
    rai_settings_t settings;
    rai_verdict_t verdict;
    rai_status_t status;
    size_t i;

    for (i = 0; i < 7; i++) {
        ranges[i].system = RAI_SYSTEM_GPS;
        ranges[i].number = (uint8_t)(i + 1);
        ranges[i].x_m = positions[i][0];
        ranges[i].y_m = positions[i][1];
        ranges[i].z_m = positions[i][2];
        ranges[i].range_m = 22e6;
        ranges[i].sigma_m = 2.0;
    }
    ranges[4].range_m += 80.0;

    settings.size = (uint32_t)sizeof settings;
    status = rai_settings_preset(&settings, RAI_PHASE_NPA);
    if (status == RAI_STATUS_OK) {
        status = rai_monitor_init(&monitor, sizeof monitor, &settings);
    }
    verdict.size = (uint32_t)sizeof verdict;
    if (status == RAI_STATUS_OK) {
        status = rai_monitor_judge(&monitor, 0.0, ranges, 7, &verdict);
    }
    if (status != RAI_STATUS_OK) {
        printf("refused: %s\n", rai_status_text(status));
        return 1;
    }
    printf("%s: %u of %u satellites, HPL %.1f m\n", rai_reason_text(verdict.reason),
           (unsigned)verdict.used, (unsigned)verdict.tracked, verdict.hpl_m);
    for (i = 0; i < verdict.excluded_count; i++) {
        printf("left out: %c%02u, off by %.1f m\n", verdict.excluded[i].system,
               (unsigned)verdict.excluded[i].number, verdict.excluded[i].bias_m);
    }
    return verdict.state == RAI_STATE_PROTECTED ? 0 : 2;
}
