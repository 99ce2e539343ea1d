#include "tests/firmware/visit/decision_rig.h"

#include "tests/firmware/rigs/cmocka_headers.h"

struct iso_decision decision;
struct iso_verdict verdict;

int decision_rig_setup(void **state)
{
    const struct iso_decision_options options = {
        .threshold = 4,
        .margin = 0.5,
        .agree = 2,
        .max_frames = 5,
        .attack_frames = 2,
        .gap_ns = 1500 * MS,
        .refractory_ns = 8000 * MS,
        .stale_ns = 1000 * MS,
    };
    (void)state;
    iso_decision_init(&decision, &options);
    verdict = (struct iso_verdict){.allow = true, .frames = -1}; /* shows whether it was written */
    return 0;
}

bool face(int64_t t_ms, int64_t person, double score, double second, bool valid)
{
    const struct iso_decision_frame frame = {t_ms * MS, person, score, second, valid, 1};
    assert_false(iso_decision_time(&decision, t_ms * MS, &verdict));
    return iso_decision_face(&decision, &frame, &verdict);
}

bool attack(int64_t t_ms, enum iso_capture cue)
{
    assert_false(iso_decision_time(&decision, t_ms * MS, &verdict));
    return iso_decision_attack(&decision, cue, t_ms * MS, &verdict);
}
