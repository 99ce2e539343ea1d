#include "sim/lab/measure/calibration.h"

int sim_calibration_of(const struct sim_scores *scores, uint32_t n_people, double distinct,
                       struct sim_calibration *out)
{
    struct sim_calibration c = {.known = scores->n_mated > 0 && scores->n_non_mated > 0};
    *out = (struct sim_calibration){.known = false};
    if (!c.known) {
        return 0;
    }
    c.cllr = sim_cllr(scores);
    int error = sim_cllr_min(scores, &c.cllr_min);
    if (!error) {
        error = sim_detection_costs_of(scores, c.cost);
    }
    if (!error) {
        error = sim_promise_curve_of(scores, n_people, distinct, c.promise);
    }
    if (!error) {
        *out = c;
    }
    return error;
}
