/* Presses the journal 40 um into the bearing and releases it within 40 ms, and prints the forces of
 * every millisecond: normal force in mN, friction force in mN, flags. */
#include "pintle_image_@NAME@.h"
#include "pintle_model.h"
#include "print.h"

/* One storage for each bearing; static, because it is too large for a small stack. */
static pintle_model model;

static int refused(int32_t status)
{
    print_text(pintle_status_text(status));
    print_text("\n");
    return 1;
}

int main(void)
{
    int32_t status = pintle_model_init(&model, pintle_image_@NAME@, sizeof pintle_image_@NAME@);
    if (status != PINTLE_OK) {
        return refused(status);
    }
    for (int32_t ms = 0; ms <= 40; ms++) {
        /* A parabola: 40 um at 20 ms, with its rate of 4 mm/s at the onset. */
        pintle_sample sample;
        pintle_estimate estimate;
        sample.radial_clearance_nm = 500000;
        sample.deformation_pm = 100000 * ms * (40 - ms);
        sample.deformation_rate_nm_s = 200000 * (20 - ms);
        sample.approach_speed_nm_s = 4000000;
        sample.sliding_speed_nm_s = 100000000;
        status = pintle_model_step(&model, &sample, &estimate);
        if (status != PINTLE_OK) {
            return refused(status);
        }
        print_integer(estimate.normal_force_mn);
        print_text(" ");
        print_integer(estimate.friction_force_mn);
        print_text((estimate.flags & PINTLE_FLAG_WARMING_UP) != 0 ? " warming up\n"
                   : estimate.flags != 0                          ? " flagged\n"
                                                                  : "\n");
    }
    return 0;
}
